"""Paths of inputs, and interpolation of positions along them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    REGULAR_CONDITION,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    IndexArray,
    StatusArray,
)
from linkwork.core.foundation.statuses import CONVERGED, Status
from linkwork.core.foundation.units import FULL_TURN, within_half_a_turn
from linkwork.core.numerics.block_solver import BlockSolver, SingleSolution
from linkwork.core.numerics.marching import Attempt, StepBounds, by_error, march
from linkwork.core.numerics.newton import SolvedRows, sharp, unlimited
from linkwork.core.numerics.position_proof import (
    Place,
    Proof,
    expansions,
    prove,
    reach,
    rounding_of_inputs,
    steps_connected,
)


@dataclass(frozen=True, kw_only=True)
class InputPath:
    """Inputs as u(t) = origin + t · rate, both (p,).

    ``size``: natural size of t, one radian for an angle, a length of the mechanism for a length.
    """

    origin: Array
    rate: Array
    size: float = 1.0

    @cached_property
    def rates(self) -> list[float]:
        """``rate`` as a list."""
        return list(map(float, self.rate))

    @cached_property
    def origins(self) -> list[float]:
        """``origin`` as a list."""
        return list(map(float, self.origin))

    def at(self, t: float | Array) -> Array:
        """u(t), (p,) or (B, p)."""
        inputs: Array = self.origin + np.multiply.outer(np.asarray(t), self.rate)
        return inputs


def quintic_coefficients(h: Array, left: SolvedRows, right: SolvedRows) -> tuple[Array, ...]:
    """Of the polynomials in fractions of steps of length h (B or 1, 1) through both ends."""
    a1, b1 = left.first * h, right.first * h
    a2, b2 = left.second * h * h, right.second * h * h
    rise = right.v - left.v
    c3 = 10 * rise - 6 * a1 - 4 * b1 - 1.5 * a2 + 0.5 * b2  # eq. (20)
    c4 = -15 * rise + 8 * a1 + 7 * b1 + 1.5 * a2 - b2
    c5 = 6 * rise - 3 * a1 - 3 * b1 - 0.5 * a2 + 0.5 * b2
    return left.v, a1, 0.5 * a2, c3, c4, c5


def quintic(s: Array, h: Array, left: SolvedRows, right: SolvedRows) -> Array:
    """The polynomials through both ends of steps of length h (B or 1, 1), at the fractions s."""
    c0, c1, c2, c3, c4, c5 = quintic_coefficients(h, left, right)
    value: Array = c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))))  # eq. (20)
    return value


# ----------------------------------------------------------------------
# Following one branch of solutions along a path of inputs, with steps as short as safety demands.
#
# Predictor: second-order Taylor. Corrector: Newton-Raphson. A step is taken only if the corrector
# contracts fast, stays near the prediction, keeps the sign of det J in every block, and arrives
# with the rate that was predicted; otherwise the step is halved.


_FAST = 5.0  # rate of a variable, weighted, from which on a dead point may be ahead
_APPROACH = 0.75  # of the estimated distance to a dead point: the largest step
_RISEN = 100.0  # condition from which on a singular position may be ahead
_ONWARD = 0.8  # of the estimated distance to it: the largest step,
_LAST = 0.7  # up to this part of the largest condition
_END = 0.5  # of that condition, and of the distance: behind such a step it would be too large
_OTHER_RATES = 30.0  # times the correction: rates so far from those predicted are another branch's,
_LEVEL_RATES = 1e-3  # unless they differ by no more than this over the step
_NODE_TOLERANCE = 1e-7  # a correction this small leaves an error of its square


@dataclass(frozen=True, kw_only=True)
class TrackOptions:
    """How careful a step is.

    ``largest_correction`` [weighted]: how far Newton may move a prediction. ``aim`` is the
    correction the step size aims at. ``contraction``: largest ratio of successive corrections.
    ``rate_error``: how far the rate times the step may be from its prediction [weighted].
    ``largest_condition``: nearness to a singular position. Beyond, rounding hides on which
    of two crossing branches a position lies: ‖J⁻¹‖² times the rounding of the equations must stay
    small (Newton-Kantorovich), and 3e6² · 1e-14 is a tenth.
    ``sharp``: whether residuals of nodes next to singular positions are rounded once.
    ``smallest_step``: relative to the path's natural length, below which the track ends.
    """

    largest_correction: float = 0.1
    aim: float = 0.03
    contraction: float = 0.25
    rate_error: float = 0.2
    largest_condition: float = 3e6
    first_step: float = 0.1
    largest_step: float = 0.8
    smallest_step: float = 1e-13
    most_steps: int = 100_000
    sharp: bool = False

    def bounds(self, size: float) -> StepBounds:
        """Of the steps along a path of the natural length ``size``."""
        return StepBounds(
            size=size,
            first=self.first_step,
            largest=self.largest_step,
            smallest=self.smallest_step,
            attempts=self.most_steps,
        )


#: For tracks that are proved afterwards: about half the steps, none of them safe by itself.
BOLD = TrackOptions(
    largest_correction=0.3, aim=0.1, contraction=0.5, rate_error=0.6, first_step=0.2
)


@dataclass(frozen=True, kw_only=True)
class Node:
    """A solved position on a track with its derivatives by t; ``v`` etc. are (N,).

    ``condition``, ``nearness``: see :class:`SolvedRows`. ``iterations``: of Newton-Raphson in the
    step that arrived here.
    """

    t: float
    v: Array
    first: Array
    second: Array
    orientation: StatusArray
    condition: float
    nearness: float
    iterations: int = 0

    @cached_property
    def rows(self) -> tuple[list[float], list[float], list[float], list[int]]:
        """``v``, ``first``, ``second`` and ``orientation`` as lists."""
        return (
            self.v.tolist(),
            self.first.tolist(),
            self.second.tolist(),
            self.orientation.tolist(),
        )


@dataclass(frozen=True, kw_only=True)
class End:
    """Why a track ended before its goal: the last t reached and the first t that failed."""

    reached: float
    failed: float
    status: Status


@dataclass(frozen=True, kw_only=True)
class Track:
    """Nodes in the order of increasing t, and the ends at both sides if the goal was not met.

    ``start`` is the place of the node that the track was begun from.
    """

    nodes: tuple[Node, ...]
    start: int
    below: End | None = None
    above: End | None = None

    @property
    def ends(self) -> tuple[End, ...]:
        """The ends that were met before a goal."""
        return tuple(end for end in (self.below, self.above) if end is not None)

    @property
    def first_t(self) -> float:
        """Smallest t reached."""
        return self.nodes[0].t

    @property
    def last_t(self) -> float:
        """Largest t reached."""
        return self.nodes[-1].t


#: Called with both nodes of every step; the track is finished where it returns true.
Watch = Callable[[Node, Node], bool]


def node_at(solver: BlockSolver, path: InputPath, t: float, v: Array, iterations: int = 0) -> Node:
    """The node of a converged position."""
    return _node_at_row(solver, path, t, v.tolist(), iterations)


def _node_at_row(
    solver: BlockSolver, path: InputPath, t: float, row: list[float], iterations: int
) -> Node:
    if solver.is_recorded:
        unknown = [0.0] * solver.unknowns
        first, second = unknown + path.rates, unknown + [0.0] * len(path.rates)
        condition, nearness, signs = solver.rates_row(row, first, second)
        return _node_of_rows(t, (row, first, second, signs), condition, nearness, iterations)
    v = np.array(row)
    rates = solver.rates(v[None, :], path.rate)
    return Node(
        t=t,
        v=v,
        first=rates.first[0],
        second=rates.second[0],
        orientation=rates.orientation[0],
        condition=float(rates.condition[0]),
        nearness=float(rates.nearness[0]),
        iterations=iterations,
    )


def _node_of_rows(
    t: float,
    rows: tuple[list[float], list[float], list[float], list[int]],
    condition: float,
    nearness: float,
    iterations: int,
) -> Node:
    v, first, second, signs = rows
    node = Node(
        t=t,
        v=np.array(v),
        first=np.array(first),
        second=np.array(second),
        orientation=np.array(signs, dtype=np.int8),
        condition=condition,
        nearness=nearness,
        iterations=iterations,
    )
    vars(node)["rows"] = rows
    return node


def rows_of_nodes(nodes: Sequence[Node]) -> SolvedRows:
    """Positions and derivatives of nodes."""
    parts = np.array([node.rows[:3] for node in nodes])
    v, first, second = np.ascontiguousarray(parts.transpose(1, 0, 2))
    return SolvedRows(t=np.array([node.t for node in nodes]), v=v, first=first, second=second)


def predict(here: Node, t: float) -> Array:
    """The second-order Taylor polynomial of a node at t, (N,)."""
    h = t - here.t
    value: Array = here.v + h * here.first + (0.5 * h * h) * here.second  # eq. (17)
    return value


def follow(
    solver: BlockSolver,
    path: InputPath,
    start: Node,
    goal: float,
    options: TrackOptions | None = None,
    watch: Watch | None = None,
) -> tuple[list[Node], End | None]:
    """Follow the branch of ``start`` to ``t = goal``, or until ``watch`` has seen enough.

    Returns
    -------
    nodes, end
        The nodes after ``start`` in the order reached; ``None`` if it was not cut short.
    """
    opt = options or TrackOptions()
    if goal == start.t:
        return [], None
    if not (start.nearness <= opt.largest_condition and np.isfinite(start.second).all()):
        return [], End(reached=start.t, failed=start.t, status=Status.START_SINGULAR)
    trial = _Trial(solver, path, opt)
    with np.errstate(all="ignore"):  # a step too far for floats is refused
        nodes, stop = march(trial, start, goal, opt.bounds(path.size), watch)
    if stop is None:
        return nodes, None
    lost = stop.exhausted
    status = Status.LOST if lost else _kind_of_end(solver, start, stop.node, path.size)
    return nodes, End(reached=stop.node.t, failed=stop.failed, status=status)


class _Trial:
    """A step by second-order Taylor and Newton-Raphson, taken only if all its checks succeed."""

    def __init__(self, solver: BlockSolver, path: InputPath, options: TrackOptions) -> None:
        self.solver, self.path, self.options = solver, path, options
        # a prediction that needs more steps was too far: halving costs less
        self.quick = unlimited(solver.options, 6, _NODE_TOLERANCE)
        self.weights: list[float] = solver.variable_scale.tolist()
        self.before: Node | None = None

    def room(self, here: Node, sign: float) -> float:
        """How far a step may go towards a singular position.

        Rates grow like 1/√distance from a dead point: there x'/2x'' of the fastest variable is the
        distance. The condition grows like 1/distance from a change point. Elsewhere there is no
        limit.
        """
        dead = self._dead_point_ahead(here, sign)
        if here.condition < _RISEN:
            return dead
        last = _LAST * self.options.largest_condition
        part = _END if self._is_last(here) else min(_ONWARD, 1.0 - here.nearness / last)
        return min(dead, part * self._singular_ahead(here))

    def _is_last(self, here: Node) -> bool:
        """Whether a track that goes on towards a singular position ends at a node."""
        return here.nearness > _END * self.options.largest_condition

    def _singular_ahead(self, here: Node) -> float:
        """How far it is to where 1/condition is zero, extrapolated from the last step."""
        before = self.before
        if before is None:
            return self.path.size / here.condition
        if here.condition <= before.condition:
            return math.inf
        return abs(here.t - before.t) * before.condition / (here.condition - before.condition)

    def _dead_point_ahead(self, here: Node, sign: float) -> float:
        """How far a step may go towards a dead point."""
        _, rates, bends, _ = here.rows
        speed = [abs(x) / w for x, w in zip(rates, self.weights, strict=True)]
        fastest = max(speed)
        if fastest * self.path.size < _FAST:
            return math.inf
        k = speed.index(fastest)
        # rates that shrink lead away from a dead point
        if not sign * rates[k] * bends[k] > 0.0:
            return math.inf
        return _APPROACH * abs(rates[k] / (2.0 * bends[k]))  # eq. (24)

    def attempt(self, here: Node, t: float) -> Attempt[Node]:
        """A step; where it is refused, how far a shorter one may go."""
        found, away, h = self._try(here, t), self._singular_ahead(here), abs(t - here.t)
        if found.node is not None:
            self.before = here
        elif self._is_last(here) and self.before is not None and away < math.inf:
            # halved down to rounding in front of a dead point, which may not be located otherwise
            if self._dead_point_ahead(here, math.copysign(1.0, t - here.t)) == math.inf:
                return Attempt(None, 0.0)
        elif found.factor is None and away < h:
            return Attempt(None, _ONWARD * away / h)
        return found

    def _try(self, here: Node, t: float) -> Attempt[Node]:
        """Predict, correct and judge."""
        solver, path, opt, h = self.solver, self.path, self.options, t - here.t
        row, rates, bends, signs = here.rows
        q, n = 0.5 * h * h, solver.unknowns
        guess = [
            x + h * a + q * b  # eq. (17)
            for x, a, b in zip(row[:n], rates, bends, strict=False)
        ]
        guess += [o + t * a for o, a in zip(path.origins, path.rates, strict=True)]
        v, found = self._solve(guess)
        correction = found.first_step
        # eq. (22): Taylor's error of second order grows like h³
        factor = by_error(correction, opt.aim, 3)
        if found.status != CONVERGED or found.contraction > opt.contraction:
            # a first correction says how long the step should have been only if Newton did not
            # merely stall
            too_far = correction > opt.largest_correction
            return Attempt(None, factor if too_far else None)
        if correction > opt.largest_correction:
            return Attempt(None, factor)
        node = _node_at_row(solver, path, t, v, found.iterations)
        # det J changes its sign at a dead point and at a change point: another branch
        if node.rows[3] != signs:
            return Attempt(None)
        if not node.nearness <= opt.largest_condition:
            return Attempt(None)
        turn = max(  # eq. (23)
            [
                abs((after - before - h * bend) * h) / w
                for after, before, bend, w in zip(
                    node.rows[1], rates, bends, self.weights, strict=True
                )
            ]
        )
        if not turn <= opt.rate_error:
            return Attempt(None)
        # eq. (23): by Taylor's theorem about three times the correction; on another branch nearby,
        # whose positions may be close to the prediction, rates are others
        if turn > max(_OTHER_RATES * correction, _LEVEL_RATES):
            return Attempt(None)
        factor = min(factor, by_error(turn, 0.5 * opt.rate_error, 3))
        # so that rounding leaves it on the branch
        if opt.sharp and node.nearness > REGULAR_CONDITION:
            node = node_at(solver, path, t, solver.sharpen(node.v[None, :])[0], found.iterations)
        return Attempt(node, factor)

    def _solve(self, guess: list[float]) -> tuple[list[float], SingleSolution]:
        """Newton-Raphson from a guess (N,): where it ended, and how."""
        solver = self.solver
        if solver.is_recorded:
            found = solver.solve_row(guess, self.quick)
            return guess, found
        done = solver.solve(np.array([guess]), self.quick)
        return done.v[0].tolist(), SingleSolution(
            status=int(done.status[0]),
            iterations=int(done.iterations[0]),
            first_step=float(done.first_step[0]),
            contraction=float(done.contraction[0]),
        )


def _kind_of_end(solver: BlockSolver, start: Node, here: Node, scale: float) -> Status:
    """Rates that grow without bound are the mark of a dead point; otherwise nothing is claimed."""
    weights = solver.variable_scale
    # at a dead point rates are infinite; the last node shows it by rates far above those of the
    # start
    with np.errstate(over="ignore"):
        fast = scale * float(np.abs(here.first / weights).max())
        usual = scale * float(np.abs(start.first / weights).max())
    return Status.OUT_OF_REACH if fast > 1e3 * max(usual, 1.0) else Status.LOST


def rows_on_track(solver: BlockSolver, path: InputPath, track: Track, t: Array) -> SolvedRows:
    """Positions at the values ``t`` (B,), all inside the track, as many lanes at once.

    Starts from quintic interpolation between the track's nodes. A row that ends elsewhere than
    predicted, or with another sign of det J, is followed again from its node step by step.
    """
    guess, left = interpolate(rows_of_nodes(track.nodes), t)
    guess[:, solver.unknowns :] = path.at(t)
    found = solver.solve(guess, unlimited(solver.options, 12, solver.options.solution_tolerance))
    v, status = found.v.copy(), found.status.copy()
    rates = solver.rates(found.v, path.rate)
    weights = solver.variable_scale
    # a row so far from its interpolation may lie on another branch: it is followed step by step
    moved = np.abs((v - guess) / weights).max(axis=1)
    expected = np.array([node.rows[3] for node in track.nodes], dtype=np.int8)[left]
    doubtful = (status != CONVERGED) | ~(moved <= 0.1) | (rates.orientation != expected).any(axis=1)
    residual, iterations = found.residual.copy(), found.iterations.copy()
    for row in np.flatnonzero(doubtful):
        node = _nearest(track, int(left[row]), float(t[row]))
        nodes, end = follow(solver, path, node, float(t[row]))
        arrived = nodes[-1] if nodes else node
        if end is not None:
            status[row] = Status.LOST.code
            continue
        v[row] = arrived.v
        status[row] = CONVERGED
        residual[row] = solver.residual(arrived.v[None, :])[0]
    if doubtful.any():
        rates = solver.rates(v, path.rate)
    return rates.with_columns(t=t, status=status, iterations=iterations, residual=residual)


def _nearest(track: Track, left: int, t: float) -> Node:
    right = min(left + 1, len(track.nodes) - 1)
    return min(track.nodes[left], track.nodes[right], key=lambda node: abs(node.t - t))


def interpolate(nodes: SolvedRows, t: Array) -> tuple[Array, IndexArray]:
    """Quintic Hermite values at t (B, N) and the index of the node at the left of each."""
    times = nodes.t
    if len(nodes) == 1:
        return np.repeat(nodes.v, len(t), axis=0), np.zeros(len(t), dtype=np.intp)
    left = np.searchsorted(times[1:-1], t, side="right")  # the last node belongs to the last step
    h = times[1:] - times[:-1]
    begin, end = nodes.take(slice(None, -1)), nodes.take(slice(1, None))
    coefficients = np.stack(quintic_coefficients(h[:, None], begin, end), axis=2)[left]
    powers = ((t - times[left]) / h[left])[:, None] ** np.arange(6.0)
    value: Array = np.einsum("bnk,bk->bn", coefficients, powers)
    return value, left


# ----------------------------------------------------------------------
# Following a branch with every step proved before the next is taken.


_MOST_ATTEMPTS = 300  # about a second; half as many lead past a place where branches nearly cross
_GROWTH = 1.5  # of steps that are proved one by one


def follow_with_proof(
    solver: BlockSolver, path: InputPath, start: Node, goal: float, watch: Watch
) -> list[Node]:
    """The branch of ``start`` towards ``t = goal``, every step proved before the next is taken.

    The proof determines the step size: many short steps near a crossing of branches, and none
    that could come onto the other one. Ends where ``watch`` has seen enough or nothing is proved.
    """
    bounds = StepBounds(
        size=path.size, first=0.01, largest=math.inf, smallest=1e-13, attempts=_MOST_ATTEMPTS
    )
    nodes, _ = march(_ProvedTrial(solver, path, start), start, goal, bounds, watch)
    return nodes


class _ProvedTrial:
    """A step that is taken only if it is proved, with residuals that are rounded once."""

    def __init__(self, solver: BlockSolver, path: InputPath, start: Node) -> None:
        self.solver, self.path = solver, path
        self.here, self.places = self._proof(start.v[None, :])

    def _proof(self, v: Array) -> tuple[Proof, list[Place]]:
        places = expansions(self.solver, v, exact=True)
        return prove(self.solver, v, rounding_of_inputs(v, self.solver.unknowns), places), places

    def room(self, here: Node, sign: float) -> float:
        """The proof bounds the step, nothing else."""
        return math.inf

    def attempt(self, here: Node, t: float) -> Attempt[Node]:
        """Predict, correct, prove the position and the step to it."""
        solver = self.solver
        guess = predict(here, t)  # eq. (17)
        guess[solver.unknowns :] = self.path.at(t)
        found = solver.solve(guess[None, :])
        if found.status[0] != CONVERGED:
            return Attempt(None)
        v = solver.sharpen(found.v)
        known = rounding_of_inputs(v, solver.unknowns)
        proof, places = self._proof(v)
        input_radius = np.abs(v - here.v)[:, solver.unknowns :] * (1.0 + 8.0 * UNIT_ROUNDOFF)
        reached = reach(solver, here.v[None, :], input_radius + 2.0 * known, self.places)
        # the position at either end may be off by its error
        both = np.maximum(proof.error_bound, self.here.error_bound)
        # eq. (33)
        if not (proof.holds[0] and steps_connected(here.v[None, :], v, reached, both)[0]):
            return Attempt(None)
        self.here, self.places = proof, places
        return Attempt(node_at(solver, self.path, t, v[0]), _GROWTH)


# ----------------------------------------------------------------------
# Leaders: the variables of a curve of positions that can be taken as known, one at a time.


_COINCIDE = 1e-6  # weighted: rounding of places that are ill-conditioned
_NEAR = 1e-3  # weighted: positions further apart are not looked at
_ON_VALUE = 1e-9  # of the parameter, weighted: positions at different values are different
_ROUNDINGS = 8.0  # times the unit and the condition: how far two solutions that are one may be


@dataclass(frozen=True, kw_only=True, eq=False)
class Parametrization:
    """The equations with the variable ``lead`` known.

    ``order`` (N,): the variables of the whole in the solver's order, the leading one last.
    """

    lead: int
    solver: BlockSolver
    order: IndexArray

    @property
    def path(self) -> InputPath:
        """The leading variable is its own path."""
        size = float(self.solver.variable_scale[-1])
        return InputPath(origin=np.zeros(1), rate=np.ones(1), size=size)

    @property
    def provable(self) -> bool:
        """Whether proofs know bounds for the equations."""
        return self.solver.is_provable

    def node(self, v: Array) -> Node:
        """The node of a position (N,) given in the whole's order."""
        return node_at(self.solver, self.path, float(v[self.lead]), v[self.order])

    def place(self, variable: int) -> int:
        """The index of a variable of the whole in the solver's order."""
        return int(np.flatnonzero(self.order == variable)[0])

    def whole(self, part: Array) -> Array:
        """Variables (..., N) of the solver's order in the whole's order."""
        found = np.empty_like(part)
        found[..., self.order] = part
        return found


class Parametrizations(Protocol):
    """Equations that can be solved with any variable in the lead."""

    parameter: int
    scale: Array
    is_angle: BoolArray

    def with_parameter(self, lead: int) -> Parametrization | None:
        """The equations led by one variable; ``None`` if it does not determine the others."""

    def repeats_after(self, turns: Array) -> bool:
        """Whether variables (N,) moved by this many whole turns satisfy the same equations."""


def fastest_leader(
    leads: Parametrizations,
    v: Array,
    speed: Array,
    avoid: int | None = None,
    first: int | None = None,
) -> tuple[Parametrization, Node] | None:
    """The fastest variable that determines all others at a position, and the node it gives."""
    by_speed = [int(k) for k in np.argsort(-speed, kind="stable")]  # eq. (35)
    for lead in by_speed if first is None else [first, *by_speed]:
        led = leads.with_parameter(lead) if lead != avoid and speed[lead] > 0.0 else None
        if led is not None:
            node = led.node(v)
            # a leader with a singular Jacobian determines nothing
            if np.isfinite(node.second).all():
                return led, node
    return None


def apart(leads: Parametrizations, a: Array, b: Array) -> Array:
    """b - a with angles reduced to half a turn, (..., N)."""
    return within_half_a_turn(b - a, leads.is_angle)


def whole_turns(leads: Parametrizations, a: Array, b: Array) -> Array:
    """How many whole turns (N,) angles have made on the way from a position to another."""
    return np.where(leads.is_angle, np.round((b - a) / FULL_TURN), 0.0)


def coincide(leads: Parametrizations, a: Array, b: Array) -> bool:
    """Whether two places that are known to rounding, such as limits, agree, modulo whole turns."""
    return bool(np.abs(apart(leads, a, b) / leads.scale).max() < _COINCIDE)


def near(
    leads: Parametrizations, places: Sequence[Array], v: Array, within: float = _NEAR
) -> list[int]:
    """The numbers of places (N,) that are near a position, modulo whole turns."""
    if not places:
        return []
    gaps = np.abs(apart(leads, v, np.stack(places)) / leads.scale).max(axis=1)
    return [int(k) for k in np.flatnonzero(gaps <= within)]


def same_position(leads: Parametrizations, a: Array, b: Array, gained: Array | None = None) -> bool:
    """Whether two positions at one value of the parameter are one, modulo whole turns.

    ``gained`` (N,): turns from a to b, and what lengths have gained in units of 2π.

    Both are iterated down to rounding with the parameter in the lead. Then it is a matter of proof:
    one lies where only the other is, or both lie apart. Where neither is proved, they agree if they
    do to rounding.
    """
    turns, p = whole_turns(leads, a, b) if gained is None else gained, leads.parameter
    # the equations are the same whole turns away, but the numbers have to agree
    there = b - FULL_TURN * turns
    gap = np.abs(there - a) / leads.scale
    own = leads.with_parameter(p)
    if own is None or gap.max() > _NEAR or gap[p] > _ON_VALUE or not leads.repeats_after(turns):
        return False
    both = np.stack([a, there])
    rounding = 8.0 * EPSILON * max(1.0, abs(float(a[p])), abs(float(b[p])))
    size = 1.0 + np.abs(both / leads.scale).max()
    # equal numbers need no proof
    if gap.max() <= _ROUNDINGS * EPSILON * size:
        return True
    # both at exactly one value of the parameter, so that only one branch is compared with the other
    both[:, p] = a[p]
    done = own.solver.solve(both[:, own.order], sharp(own.solver.options))
    found = own.solver.sharpen(done.v)
    off = np.abs(found[1] - found[0])
    if own.provable:
        input_radius = np.full((1, 1), rounding)
        places = [expansions(own.solver, v, exact=True) for v in (found[:1], found[1:])]
        first, second = (
            reach(own.solver, found[:1], input_radius, places[0]),
            prove(own.solver, found[1:], input_radius, places[1]),
        )
        if first.holds[0] and second.holds[0]:
            errors = second.error_bound[0, :-1]
            if (off[:-1] + errors < first.isolation_radius[0]).all():
                return True
            if (off[:-1] > errors + first.error_bound[0, :-1]).any():
                return False
    rates = own.solver.rates(found, own.path.rate)
    allowed = min(_COINCIDE, _ROUNDINGS * EPSILON * float(rates.condition.max()) * size)
    close = (off / own.solver.variable_scale).max() <= allowed
    # two roots that a dead point joins have opposite signs of det J
    return bool(close and np.array_equal(rates.orientation[0], rates.orientation[1]))
