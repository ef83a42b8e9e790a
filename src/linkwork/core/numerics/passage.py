"""Across change points, block by block: each on its own side, driven by the blocks before it.

Where several loops can close in two ways at one input, the equations as a whole lose more than one
rank, but each block only one: with its known variables given as a motion y(t), a block is a
small system of its own, whose crossing is located by itself. Its motion on the chosen
branch then drives the later blocks. So any number of crossings can lie at one input or next to
each other.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import CLOSER_TANGENT, Array, IndexArray
from linkwork.core.foundation.statuses import CONVERGED
from linkwork.core.numerics.block_solver import Block, BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Node, follow, node_at
from linkwork.core.numerics.change_point import (
    ChangePoint,
    KnownJet,
    at_one_input,
    is_at,
    less_sharp,
    locate_crossing,
    tangents_behind_kink,
)

# of the path's size, to both sides, in this order; the last ones for blocks that are driven slowly
_HALVES = (1e-2, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 3e-2, 1e-1)
_STEPS = (4, 16)  # in which a block that does not cross is followed; more where it turns quickly
_OFF = 1e-3  # weighted: how far such a step may end from its prediction
# condition times that distance: next to a crossing both branches lie within 1 / condition of each
# other, and Newton-Raphson may reach either of them (Newton-Kantorovich: at most 1/2)
_CERTAIN = 0.02
_REGULAR = 3e6  # condition from which on branches are as good as crossing, as in tracks
_BESIDE = 0.1  # of the way to the next kink: a crossing so near to a kink is taken together with it


@dataclass(frozen=True, kw_only=True, eq=False)
class Passage:
    """The way from before some change points to beyond them.

    ``crossings``: in the order of travel, those at one input together. ``node``: beyond them.
    """

    crossings: tuple[tuple[ChangePoint, ...], ...]
    node: Node
    motion: _Motion

    @property
    def side(self) -> float:
        """+1 if t is growing on the way, -1 if it is falling."""
        return math.copysign(1.0, self.motion.end - self.motion.begin)

    def position(self, t: float) -> tuple[Array, Array]:
        """The variables and their rates by t, (N,) each, at a value of t on the way."""
        return self.motion.jet(t, self.motion.end)[:2]


def pass_change_points(
    solver: BlockSolver,
    path: InputPath,
    nodes: Sequence[Node],
    near: float,
    side: float,
    turn: bool,
) -> Passage | None:
    """Follow all blocks from the last nodes of a track across the change points ahead.

    Parameters
    ----------
    nodes : sequence of Node
        In the order of travel; the track could not be followed beyond the last one.
    near : float
        Value of t at which a block crosses another branch.
    side : float
        +1 if t is growing, -1 if it is falling.
    turn : bool
        At each change point take the branch that crosses instead of going straight on.

    Returns
    -------
    Passage or None
        ``None`` where it is not certain that a block is on the side that was asked for.
    """
    for half in _HALVES:
        begin, end = near - side * half * path.size, near + side * half * path.size
        before = [node for node in nodes if side * (begin - node.t) >= 0.0]
        if not before:
            continue
        start = before[-1]
        reached, stopped = follow(solver, path, start, begin)
        if stopped is not None:
            continue
        here = reached[-1] if reached else start
        found = _Walk(solver, path, here, end, near, turn).run()
        if found is not None:
            return found
    return None


@dataclass(frozen=True, kw_only=True, eq=False)
class _Piece:
    """Polynomials of s = (t - begin) / (end - begin), coefficients (K, m) by rising powers."""

    begin: float
    end: float
    coefficients: Array

    def jet(self, t: float) -> tuple[Array, Array, Array]:
        """Values with first and second derivatives by t, (m,) each."""
        h = self.end - self.begin
        s, c = (t - self.begin) / h, self.coefficients
        powers = np.arange(len(c))
        up = s**powers
        first = powers[1:] * up[:-1]
        second = powers[2:] * powers[1:-1] * up[:-2]
        return up @ c, first @ c[1:] / h, second @ c[2:] / h**2


def _through(
    begin: float, at_begin: Sequence[Array], end: float, at_end: Sequence[Array]
) -> _Piece:
    """The polynomials with these derivatives, the values first, at both ends."""
    h, count = end - begin, len(at_begin) + len(at_end)
    rows, right = [], []
    for s, jet in ((0.0, at_begin), (1.0, at_end)):
        for order, value in enumerate(jet):
            # a row of the confluent Vandermonde matrix: the derivative of every power at s
            powers = np.arange(count)
            falling = np.prod([powers - k for k in range(order)], axis=0) if order else 1.0
            rows.append(
                falling * np.where(powers >= order, s ** np.maximum(powers - order, 0), 0.0)
            )
            right.append(value * h**order)
    coefficients = np.linalg.solve(np.array(rows), np.array(right))
    return _Piece(begin=begin, end=end, coefficients=coefficients)


class _Motion:
    """The motions of all blocks solved so far, between two values of t."""

    def __init__(self, solver: BlockSolver, path: InputPath, begin: float, end: float) -> None:
        self.solver, self.path, self.begin, self.end = solver, path, begin, end
        self.pieces: list[tuple[IndexArray, list[_Piece]]] = []

    def jet(self, t: float, towards: float) -> tuple[Array, Array, Array]:
        """Variables with first and second derivatives, (N,) each, at a kink on one side of it."""
        n = self.solver.unknowns
        value, first, second = (np.zeros(self.solver.variables) for _ in range(3))
        value[n:], first[n:] = self.path.at(t), self.path.rate
        # a point just inside the side that is asked for decides which piece holds at a kink
        inside = t + 1e-9 * (towards - t)
        for unknowns, pieces in self.pieces:
            piece = next(
                (p for p in pieces if (p.begin - inside) * (p.end - inside) <= 0), pieces[-1]
            )
            value[unknowns], first[unknowns], second[unknowns] = piece.jet(t)
        return value, first, second


@dataclass(frozen=True, kw_only=True, eq=False)
class _Step:
    """A position of a block with its rates by t, (n,) each."""

    t: float
    x: Array
    first: Array
    second: Array

    @property
    def jet(self) -> tuple[Array, Array, Array]:
        return self.x, self.first, self.second


class _Walk:
    """One try to lead every block from one value of t to another."""

    def __init__(
        self, solver: BlockSolver, path: InputPath, start: Node, end: float, near: float, turn: bool
    ) -> None:
        self.solver, self.path, self.start, self.end = solver, path, start, end
        self.near, self.turn = near, turn
        self.side = math.copysign(1.0, end - start.t)
        self.motion = _Motion(solver, path, start.t, end)
        self.kinks = [start.t, end]
        self.found: list[ChangePoint] = []
        self.options = replace(solver.options, largest_turn=math.inf)

    def run(self) -> Passage | None:
        """Block after block; ``None`` where one of them cannot be led."""
        for number, block in enumerate(self.solver.blocks):
            pieces = self._lead_block(number, block)
            if pieces is None:
                return None
            self.motion.pieces.append((block.unknowns, pieces))
        if not self.found:
            return None
        v = self.motion.jet(self.end, self.start.t)[0]
        node = node_at(self.solver, self.path, self.end, v)
        if not node.nearness < _REGULAR:
            return None
        return Passage(crossings=tuple(self._groups()), node=node, motion=self.motion)

    def _groups(self) -> Iterator[tuple[ChangePoint, ...]]:
        """The crossings in the order of travel, those at one input together."""
        waiting = sorted(self.found, key=lambda point: self.side * point.t)
        while waiting:
            earliest = waiting[0]
            same = [point for point in waiting if at_one_input(earliest, point)]
            same.sort(key=lambda point: point.block)  # the first one is known best
            whole = self.motion.jet(same[0].t, self.start.t)[0]
            yield tuple(replace(point, v=whole) for point in same)
            waiting = [point for point in waiting if point not in same]

    def _lead_block(self, number: int, block: Block) -> list[_Piece] | None:
        """The pieces of a block's motion, each from one kink of its known variables to the next."""
        x = self.start.v[block.unknowns]
        pieces: list[_Piece] = []
        # a copy: crossings found on the way add kinks for later blocks only
        kinks = list(self.kinks)
        while len(kinks) > 1:
            steps = self._follow(block, kinks[0], kinks[1], x)
            if steps is not None:
                pairs = itertools.pairwise(steps)
                pieces += [_through(a.t, a.jet, b.t, b.jet) for a, b in pairs]
                del kinks[0]
            else:
                across = self._across(number, block, kinks, x)
                if across is None:
                    return None
                pieces += across
                del kinks[: kinks.index(across[-1].end)]
            x = pieces[-1].jet(kinks[0])[0]
        return pieces

    def _known(self, block: Block, t: float, towards: float) -> tuple[Array, Array, Array]:
        known = block.variables[len(block.unknowns) :]
        value, first, second = self.motion.jet(t, towards)
        return value[known], first[known], second[known]

    def _step(self, block: Block, t: float, x: Array, towards: float) -> tuple[_Step, int, float]:
        """A solved position with its rates, the sign of det J, and the condition of J."""
        y, y1, y2 = self._known(block, t, towards)
        rates = block.alone.rates(np.append(x, y)[None, :], y1, y2)
        first, second = (part[0, : len(x)] for part in (rates.first, rates.second))
        step = _Step(t=t, x=x, first=first, second=second)
        return step, int(rates.orientation[0, 0]), float(rates.condition[0])

    def _solve(self, block: Block, t: float, guess: Array, towards: float) -> Array | None:
        v = np.concatenate([guess, self._known(block, t, towards)[0]])
        done = block.alone.solve(v[None, :], self.options)
        return done.v[0, : len(guess)] if done.status[0] == CONVERGED else None

    def _follow(self, block: Block, begin: float, end: float, x: Array) -> list[_Step] | None:
        """The block led from one value of t to another; ``None`` if it comes near a crossing."""
        tries = (self._follow_in(count, block, begin, end, x) for count in _STEPS)
        return next((steps for steps in tries if steps is not None), None)

    def _follow_in(
        self, count: int, block: Block, begin: float, end: float, x: Array
    ) -> list[_Step] | None:
        weights = block.system.variable_scale[: len(x)]
        here, sign, condition = self._step(block, begin, x, end)
        if not (condition < _REGULAR and sign):
            return None
        steps = [here]
        for t in np.linspace(begin, end, count + 1)[1:].tolist():
            h = t - here.t
            guess = here.x + h * here.first + 0.5 * h * h * here.second  # eq. (17)
            x_new = self._solve(block, t, guess, begin)
            if x_new is None:
                return None
            off = float(np.abs((x_new - guess) / weights).max())
            here, its_sign, condition = self._step(block, t, x_new, begin)
            if not (off <= _OFF and condition * off <= _CERTAIN):
                return None
            if not (condition < _REGULAR and its_sign == sign):
                return None
            steps.append(here)
        return steps

    def _across(
        self, number: int, block: Block, kinks: Sequence[float], x: Array
    ) -> list[_Piece] | None:
        """Lead the block across the change point ahead, to the next kink or the kink after that."""
        begin, end = kinks[0], kinks[1]
        before, _, condition = self._step(block, begin, x, end)
        point = self._locate(number, block, before) if condition < _REGULAR else None
        if point is None:
            return None
        ahead = self.side * (end - point.t)
        if len(kinks) > 2 and abs(ahead) < _BESIDE * abs(kinks[2] - end):
            return self._at_kink(block, before, point, end, kinks[2])
        if ahead <= 0.0 or self.side * (point.t - begin) <= 0.0:
            return None
        at = point.v[block.unknowns]
        chosen, left = self._ways(point.onward[block.unknowns], point.other[block.unknowns])
        after = self._beyond(block, point.t, at, chosen, left, end)
        if after is None:
            return None
        self._keep(point)
        if not self.turn:
            return [_through(begin, before.jet, end, after.jet)]
        return [
            _through(begin, before.jet, point.t, (at, point.onward[block.unknowns])),
            _through(point.t, (at, chosen), end, after.jet),
        ]

    def _at_kink(
        self, block: Block, before: _Step, point: ChangePoint, kink: float, end: float
    ) -> list[_Piece] | None:
        """Lead the block across a change point that lies at a kink of its known variables."""
        if not is_at(point, kink):
            return None  # so near to each other that nothing is resolved in between
        sides = (before.t, end)
        known = [self._known(block, kink, towards) for towards in sides]
        both = tangents_behind_kink(self.solver, point, known[0], known[1])
        if both is None:
            return None
        at = point.v[block.unknowns]
        chosen, left = self._ways(*both)
        after = self._beyond(block, kink, at, chosen, left, end)
        if after is None:
            return None
        self._keep(replace(point, t=kink))
        return [
            _through(before.t, before.jet, kink, (at, point.onward[block.unknowns])),
            _through(kink, (at, chosen), end, after.jet),
        ]

    def _locate(self, number: int, block: Block, before: _Step) -> ChangePoint | None:
        """The crossing of a block near the crossing that was met first."""
        known = KnownJet(lambda t: self._known(block, t, before.t))
        h = self.near - before.t
        guess = before.x + h * before.first + 0.5 * h * h * before.second  # eq. (17)
        own = before.first + h * before.second
        return locate_crossing(self.solver, number, known, guess, self.near, own)

    def _ways(self, onward: Array, other: Array) -> tuple[Array, Array]:
        """The rates of the branch that was chosen, and of the other branch."""
        return (other, onward) if self.turn else (onward, other)

    def _keep(self, point: ChangePoint) -> None:
        self.found.append(less_sharp(point) if self.found else point)
        if self.turn:
            self.kinks = sorted({*self.kinks, point.t}, key=lambda t: self.side * t)

    def _beyond(
        self, block: Block, t: float, at: Array, chosen: Array, left: Array, end: float
    ) -> _Step | None:
        """The position at ``end`` on the branch with a tangent; it counts only if it lies much
        nearer to that tangent than to the other one.
        """
        if not np.isfinite(chosen).all():
            return None  # the branch keeps t
        h, weights = end - t, block.system.variable_scale[: len(at)]
        guess = at + h * chosen
        x = self._solve(block, end, guess, t)
        if x is None:
            return None
        apart = float(np.abs((chosen - left) / weights).max())
        gap = abs(h) * apart if np.isfinite(apart) else abs(h)
        after, _, condition = self._step(block, end, x, t)
        # the position may have jumped to the branch that was left
        close = bool(float(np.abs((x - guess) / weights).max()) <= CLOSER_TANGENT * gap)
        return after if close and condition < _REGULAR else None
