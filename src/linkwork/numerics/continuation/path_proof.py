"""Proving that a row of positions lies on one branch: many steps at once, halved where needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, CountArray, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.foundation.status import CONVERGED
from linkwork.numerics.block_solver import BlockSolver, Linearised
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.proof.kantorovich import Expansion
from linkwork.numerics.proof.position_proof import (
    Proof,
    expansions,
    prove,
    reach,
    rounding_of_inputs,
    steps_connected,
)
from linkwork.numerics.rows import SolvedRows

__all__ = ["ProvenPath", "prove_path"]

_ROUNDS = 45  # halvings of one step before it counts as not proved
_MOST = 30_000  # positions solved in between for the proof of one path
_MOST_EACH = 8  # and this many more for each of its own positions
_PIECE = 1024  # positions proved together: arrays that fit the cache
_LANES = 1024  # steps halved together


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvenPath:
    """``position``: the proofs of K positions. ``connected`` (K-1,): which steps are proved.
    ``pieces`` (K-1,): into how many steps each was divided for that. ``given_up`` (K-1,): which
    are not proved because that would have taken too many.
    """

    position: Proof
    connected: BoolArray
    pieces: CountArray
    given_up: BoolArray

    def connected_to(self, anchor: int) -> BoolArray:
        """The positions joined to one of them by proved steps and proved themselves, (K,)."""
        return _connected_outwards(self.connected, anchor) & self.position.holds

    def given_up_before(self, anchor: int) -> BoolArray:
        """The positions whose first step without a proof, on the way from one, was given up."""
        joined = _connected_outwards(self.connected, anchor)
        as_if = _connected_outwards(self.connected | self.given_up, anchor)
        first_broken = as_if & ~joined
        # beyond a step that was given up others may be broken for other reasons
        right = np.logical_or.accumulate(first_broken[anchor:])
        left = np.logical_or.accumulate(first_broken[: anchor + 1][::-1])[::-1]
        return np.concatenate([left[:-1], right])


def _connected_outwards(connected: BoolArray, anchor: int) -> BoolArray:
    """Which of K positions are joined to one of them, (K,)."""
    right = np.logical_and.accumulate(connected[anchor:])
    left = np.logical_and.accumulate(connected[:anchor][::-1])[::-1]
    return np.concatenate([left, [True], right])


def prove_path(
    solver: BlockSolver,
    path: InputPath,
    points: SolvedRows,
    *,
    anchor: int | None = None,
    most: int | None = None,
    exact: bool = False,
    progress: Callable[[float], None] | None = None,
) -> ProvenPath:
    """Prove every position and every step between neighbours.

    Parameters
    ----------
    points : SolvedRows
        In the order of t, with ``first``, ``second`` and ``input_radius``.
    anchor : int, optional
        The point that the others have to be joined to: steps near it are proved first, and those
        beyond one that cannot be proved are left alone. Without it all steps count alike.
    most : int, optional
        How many positions in between may be solved for the proof of the whole path; by default a
        number that grows with the path's own.
    exact : bool
        Take residuals that are rounded once: slower, for places where branches nearly cross.
    progress : callable, optional
        Called with the finished fraction.

    Notes
    -----
    A step that is not proved from its left end is tried from its right end, then halved at a
    position solved in between. Many open steps are worked on together.
    """
    count = len(points.t)
    prover = _Prover(solver, path, exact)
    allowance = _Allowance(_MOST + _MOST_EACH * count if most is None else most)
    begins = list(range(0, max(count - 1, 1), _PIECE))
    if anchor is not None:
        # near the anchor first: beyond a step that is not proved no other one is of use
        begins.sort(key=lambda begin: abs(begin + _PIECE // 2 - anchor))
    found: dict[int, ProvenPath] = {}
    for k, begin in enumerate(begins, start=1):
        part = points.take(slice(begin, begin + _PIECE + 1))
        inside = None if anchor is None else min(max(anchor - begin, 0), len(part.t) - 1)
        found[begin] = _piece(prover, part, inside, allowance)
        if progress is not None:
            progress(k / len(begins))
    pieces = [found[begin] for begin in sorted(begins)]
    if len(pieces) == 1:
        return pieces[0]
    # neighbouring pieces share one position
    proofs = [pieces[0].position, *[_behind_first(piece.position) for piece in pieces[1:]]]
    return ProvenPath(
        position=Proof(
            holds=np.concatenate([p.holds for p in proofs]),
            existence_radius=np.concatenate([p.existence_radius for p in proofs]),
            uniqueness_radius=np.concatenate([p.uniqueness_radius for p in proofs]),
            error_bound=np.concatenate([p.error_bound for p in proofs]),
        ),
        connected=np.concatenate([piece.connected for piece in pieces]),
        pieces=np.concatenate([piece.pieces for piece in pieces]),
        given_up=np.concatenate([piece.given_up for piece in pieces]),
    )


class _Allowance:
    """How many positions may still be solved in between."""

    def __init__(self, left: int) -> None:
        self.left = left

    def take(self, wanted: int) -> int:
        """As many as there are, at most ``wanted``."""
        given = min(wanted, self.left)
        self.left -= given
        return given


def _behind_first(p: Proof) -> Proof:
    return Proof(
        holds=p.holds[1:],
        existence_radius=p.existence_radius[1:],
        uniqueness_radius=p.uniqueness_radius[1:],
        error_bound=p.error_bound[1:],
    )


@dataclass(frozen=True)
class _Prover:
    """The equations of a path; ``exact``: with residuals that are rounded once."""

    solver: BlockSolver
    path: InputPath
    exact: bool

    def expansions(
        self, v: Array, linear: Sequence[Linearised] | None = None
    ) -> list[Expansion | None]:
        """What proofs need of positions (B, N)."""
        return expansions(self.solver, v, linear, exact=self.exact)


def _piece(
    prover: _Prover,
    points: SolvedRows,
    anchor: int | None,
    allowance: _Allowance,
) -> ProvenPath:
    solver, places = prover.solver, prover.expansions(points.v)
    position = prove(solver, points.v, points.input_radius, places)
    steps = len(points.t) - 1
    nothing = np.zeros(steps, dtype=bool)
    pieces = np.ones(steps, dtype=np.int64)
    if not steps:
        return ProvenPath(position=position, connected=nothing, pieces=pieces, given_up=nothing)
    left, right = points.take(slice(None, -1)), points.take(slice(1, None))
    near = np.maximum(position.error_bound[1:], position.error_bound[:-1])
    connected = _steps(solver, left, right, near, _take_expansions(places, slice(None, -1)))
    connected &= position.holds[1:] & position.holds[:-1]
    open_ = np.flatnonzero(~connected & position.holds[1:] & position.holds[:-1])
    if len(open_):
        # a step towards a change point is often proved from its far end only
        back = _take_expansions(places, open_ + 1)
        connected[open_] = _steps(solver, right.take(open_), left.take(open_), near[open_], back)
        open_ = open_[~connected[open_]]
    if not len(open_):
        return ProvenPath(position=position, connected=connected, pieces=pieces, given_up=nothing)
    work = _Halving(prover, steps, anchor, position.holds)
    work.run(
        _Open(left=left.take(open_), right=right.take(open_), near=near[open_], owner=open_),
        allowance,
    )
    connected[open_] = work.proved[open_]
    return ProvenPath(
        position=position, connected=connected, pieces=pieces + work.pieces, given_up=work.given_up
    )


def _take_expansions(
    places: Sequence[Expansion | None], index: IndexArray | slice
) -> list[Expansion | None]:
    return [None if place is None else place.take(index) for place in places]


def _steps(
    solver: BlockSolver,
    start: SolvedRows,
    goal: SolvedRows,
    near: Array,
    places: Sequence[Expansion | None] | None = None,
) -> BoolArray:
    """Which steps are proved from their start, for all inputs from those of one end to the other's.

    The inputs are taken from the positions: those of a row may differ from the path's by rounding.
    """
    # the factor covers the rounding of the difference
    input_radius = np.abs(goal.v - start.v)[:, solver.unknowns :] * (1.0 + 8.0 * UNIT_ROUNDOFF)
    input_radius += start.input_radius + goal.input_radius
    return steps_connected(start.v, goal.v, reach(solver, start.v, input_radius, places), near)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Open:
    """Steps to be proved (L,): their ends, how far the true positions may be from these (L, N),
    and the number of the step of the path that they are a part of.
    """

    left: SolvedRows
    right: SolvedRows
    near: Array
    owner: IndexArray

    def take(self, index: IndexArray | slice) -> _Open:
        return _Open(
            left=self.left.take(index),
            right=self.right.take(index),
            near=self.near[index],
            owner=self.owner[index],
        )

    def with_(self, other: _Open) -> _Open:
        return _Open(
            left=SolvedRows.concatenate([self.left, other.left]),
            right=SolvedRows.concatenate([self.right, other.right]),
            near=np.concatenate([self.near, other.near]),
            owner=np.concatenate([self.owner, other.owner]),
        )


class _Halving:
    """Steps of a path (K,) halved as often as their proof needs.

    ``proved``, ``given_up`` (K,): their outcome. ``pieces`` (K,): how many positions were
    solved in between.
    """

    def __init__(self, prover: _Prover, steps: int, anchor: int | None, holds: BoolArray) -> None:
        self.prover, self.anchor = prover, anchor
        self.proved = np.ones(steps, dtype=bool)
        self.given_up = np.zeros(steps, dtype=bool)
        self.pieces = np.zeros(steps, dtype=np.int64)
        # beyond a step that cannot be proved no other is of use
        self.cut = np.flatnonzero(~(holds[1:] & holds[:-1]))
        self.width = np.zeros(steps)

    def run(self, queue: _Open, allowance: _Allowance) -> None:
        """Prove all steps of a queue as far as the allowance goes."""
        self.width[queue.owner] = queue.right.t - queue.left.t
        while True:
            queue = self._of_use(queue)
            if not len(queue.owner):
                return
            now = allowance.take(min(len(queue.owner), _LANES))
            if not now:
                self.proved[queue.owner] = False
                self.given_up[queue.owner] = True
                return
            queue = self._halve(queue.take(slice(None, now))).with_(queue.take(slice(now, None)))

    def _of_use(self, queue: _Open) -> _Open:
        """The steps that may still be proved, nearest to the anchor first."""
        hopeful = self.proved[queue.owner]
        if self.anchor is None:
            return queue if hopeful.all() else queue.take(np.flatnonzero(hopeful))
        below, above = queue.owner < self.anchor, queue.owner >= self.anchor
        lowest = max(self.cut[self.cut < self.anchor], default=-1)
        highest = min(self.cut[self.cut >= self.anchor], default=len(self.proved))
        moot = (below & (queue.owner < lowest)) | (above & (queue.owner > highest))
        self.proved[queue.owner[moot]] = False
        keep = np.flatnonzero(hopeful & ~moot)
        away = np.abs(queue.owner[keep] + 0.5 - self.anchor)
        return queue.take(keep[np.argsort(away, kind="stable")])

    def _halve(self, lanes: _Open) -> _Open:
        """Halve some steps once more; return the halves that are not proved."""
        solver = self.prover.solver
        np.add.at(self.pieces, lanes.owner, 1)
        middle, found, places = _between(self.prover, lanes.left, lanes.right)
        proof = prove(solver, middle.v, middle.input_radius, places)
        good = found & proof.holds
        # no number is left between the ends
        good &= (lanes.left.t < middle.t) & (middle.t < lanes.right.t)
        # a step that has shrunk to nothing is not going to be proved
        good &= (lanes.right.t - lanes.left.t) > self.width[lanes.owner] * 2.0**-_ROUNDS
        lost = np.flatnonzero(np.bincount(lanes.owner[~good]))
        if len(lost):
            self.proved[lost] = False
            self.cut = np.union1d(self.cut, lost)
        keep = np.flatnonzero(self.proved[lanes.owner])
        if not len(keep):
            return lanes.take(keep)
        lanes, middle, places = lanes.take(keep), middle.take(keep), _take_expansions(places, keep)
        near = np.maximum(lanes.near, proof.error_bound[keep])
        halves = [
            _Open(left=lanes.left, right=middle, near=near, owner=lanes.owner),
            _Open(left=middle, right=lanes.right, near=near, owner=lanes.owner),
        ]
        # both halves from the middle, where everything is computed
        for k, ends in enumerate((lanes.left, lanes.right)):
            open_ = ~_steps(solver, middle, ends, near, places)
            halves[k] = halves[k].take(np.flatnonzero(open_))
        return halves[0].with_(halves[1])


def _between(
    prover: _Prover, left: SolvedRows, right: SolvedRows
) -> tuple[SolvedRows, BoolArray, list[Expansion | None]]:
    """Positions halfway in t, started from the quintic through both ends; which were found; their
    expansions for proofs.
    """
    solver, path = prover.solver, prover.path
    h = (right.t - left.t)[:, None]
    guess = 0.5 * (left.v + right.v) + 5.0 / 32.0 * h * (left.first - right.first)  # eq. (21)
    guess += h * h / 64.0 * (left.second + right.second)
    t = 0.5 * (left.t + right.t)
    guess[:, solver.unknowns :] = path.at(t)
    done = solver.solve(guess)
    v = solver.sharpen(done.v) if prover.exact else done.v
    linear = solver.linearise(v)
    rates = solver.rates(v, path.rate, linear)
    input_radius = rounding_of_inputs(v, solver.unknowns)
    points = SolvedRows(t=t, v=v, first=rates.first, second=rates.second, input_radius=input_radius)
    return points, done.status == CONVERGED, prover.expansions(v, linear)
