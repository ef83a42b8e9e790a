"""Halving steps of a path until each part is proved, many of them together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from linkwork.core.foundation.arrays import (
    REGULAR_CONDITION,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    CountArray,
    IndexArray,
)
from linkwork.core.foundation.statuses import CONVERGED
from linkwork.core.numerics.block_solver import FEW, BlockSolver
from linkwork.core.numerics.branch_tracking import (
    InputPath,
    Parametrization,
    Parametrizations,
    apart,
    quintic,
    rows_of_nodes,
    whole_turns,
)
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.numerics.position_proof import (
    Place,
    Proof,
    expansions,
    prove,
    reach,
    recorded_places,
    rounding_of_inputs,
    steps_connected,
    steps_disproved,
)
from linkwork.core.numerics.proved_rows import StepProver, radii_of

if TYPE_CHECKING:
    from linkwork.core.numerics.curve_tracing import Curve, Leg

_HALVINGS = 45  # of one step, at most
_QUICK = 5  # before weights are fitted to it
_LANES = 1024  # steps halved together
_HALFWAY = np.array([0.5])


class Allowance:
    """How many positions may still be solved in between."""

    def __init__(self, left: int) -> None:
        self.left = left

    def take(self, wanted: int) -> int:
        """As many as there are, at most ``wanted``."""
        given = min(wanted, self.left)
        self.left -= given
        return given


@dataclass(frozen=True)
class Prover:
    """The equations of a path; ``exact``: with residuals that are rounded once.

    ``halvings`` of one step before it counts as not proved; ``fitted``: whether weights are fitted
    to each step.
    """

    solver: BlockSolver
    path: InputPath
    exact: bool
    halvings: int = _HALVINGS
    fitted: bool = True

    def places(self, v: Array) -> list[Place]:
        """What proofs need of positions (B, N)."""
        if self.exact or self.fitted:
            return expansions(self.solver, v, exact=self.exact)
        return recorded_places(self.solver, v)


def take_expansions(places: Sequence[Place], index: IndexArray | slice) -> list[Place]:
    return [None if place is None else place.take(index) for place in places]


def prove_steps(
    solver: BlockSolver,
    start: SolvedRows,
    goal: SolvedRows,
    near: Array,
    places: Sequence[Place] | None = None,
) -> tuple[BoolArray, BoolArray]:
    """Which steps are proved from their start, for all inputs from those of one end to the other's,
    and which are proved to lead to another branch.

    The inputs are taken from the positions: those of a row may differ from the path's by rounding.
    """
    # the factor covers the rounding of the difference
    input_radius = np.abs(goal.v - start.v)[:, solver.unknowns :] * (1.0 + 8.0 * UNIT_ROUNDOFF)
    input_radius += start.input_radius + goal.input_radius
    reached = reach(solver, start.v, input_radius, places)
    ends = start.v, goal.v, reached, near
    return steps_connected(*ends), steps_disproved(*ends)


@dataclass(frozen=True, kw_only=True, eq=False)
class OpenSteps:
    """Steps to be proved (L,): their ends, how far the true positions may be from these (L, N),
    and the number of the step of the path that they are a part of.
    """

    left: SolvedRows
    right: SolvedRows
    near: Array
    owner: IndexArray

    def take(self, index: IndexArray | slice) -> OpenSteps:
        return OpenSteps(
            left=self.left.take(index),
            right=self.right.take(index),
            near=self.near[index],
            owner=self.owner[index],
        )

    def with_(self, other: OpenSteps) -> OpenSteps:
        return OpenSteps(
            left=SolvedRows.concatenate([self.left, other.left]),
            right=SolvedRows.concatenate([self.right, other.right]),
            near=np.concatenate([self.near, other.near]),
            owner=np.concatenate([self.owner, other.owner]),
        )


@dataclass(frozen=True, kw_only=True)
class Strand:
    """Points ``begin`` to ``end``, without that one, of one curve among those of others.

    ``anchor``: the point that the others have to be joined to, if there is one.
    """

    begin: int
    end: int
    anchor: int | None


class Halving:
    """Steps of strands (K,) halved as often as their proof needs.

    ``proved``, ``given_up`` (K,): their outcome. ``pieces`` (K,): how many positions were
    solved in between.
    """

    def __init__(self, prover: Prover, strands: Sequence[Strand], holds: BoolArray) -> None:
        steps = len(holds) - 1
        self.prover, self.strands = prover, strands
        self.proved = np.ones(steps, dtype=bool)
        self.given_up = np.zeros(steps, dtype=bool)
        self.pieces = np.zeros(steps, dtype=np.int64)
        # beyond a step that cannot be proved no other is of use
        self.cut = np.flatnonzero(~(holds[1:] & holds[:-1]))
        self.width = np.zeros(steps)

    def lose(self, steps: IndexArray) -> None:
        """Note steps that are not going to be proved."""
        if len(steps):
            self.proved[steps] = False
            self.cut = np.union1d(self.cut, steps)

    def run(self, queue: OpenSteps, allowance: Allowance) -> None:
        """Prove all steps of a queue as far as the allowance goes."""
        self.width[queue.owner] = queue.right.t - queue.left.t
        while True:
            queue = self.of_use(queue)
            if not len(queue.owner):
                return
            now = allowance.take(min(len(queue.owner), _LANES))
            if not now:
                self.proved[queue.owner] = False
                self.given_up[queue.owner] = True
                return
            queue = self._halve(queue.take(slice(None, now))).with_(queue.take(slice(now, None)))

    def of_use(self, queue: OpenSteps) -> OpenSteps:
        """The steps that may still be proved, nearest to their anchors first."""
        owner = queue.owner
        hopeful = self.proved[owner]
        away = np.zeros(len(owner))
        for strand in self.strands:
            if strand.anchor is None:
                continue
            here = (owner >= strand.begin) & (owner < strand.end - 1)
            cut = self.cut[(self.cut >= strand.begin) & (self.cut < strand.end - 1)]
            lowest = cut[cut < strand.anchor].max(initial=-1)
            highest = cut[cut >= strand.anchor].min(initial=len(self.proved))
            moot = here & ((owner < lowest) | (owner > highest))
            self.proved[owner[moot]] = False
            hopeful &= ~moot
            away[here] = np.abs(owner[here] + 0.5 - strand.anchor)
        keep = np.flatnonzero(hopeful)
        return queue.take(keep[np.argsort(away[keep], kind="stable")])

    def _halve(self, lanes: OpenSteps) -> OpenSteps:
        """Halve some steps once more; return the halves that are not proved."""
        solver = self.prover.solver
        np.add.at(self.pieces, lanes.owner, 1)
        middle, found, places = _between(self.prover, lanes.left, lanes.right, _HALFWAY)
        proof = prove(solver, middle.v, middle.input_radius, places)
        good = found & proof.holds
        # no number is left between the ends
        good &= (lanes.left.t < middle.t) & (middle.t < lanes.right.t)
        # a step that has shrunk to nothing is not going to be proved
        good &= (lanes.right.t - lanes.left.t) > self.width[
            lanes.owner
        ] * 2.0**-self.prover.halvings
        self.lose(np.flatnonzero(np.bincount(lanes.owner[~good])))
        keep = np.flatnonzero(self.proved[lanes.owner])
        if not len(keep):
            return lanes.take(keep)
        lanes, middle, places = lanes.take(keep), middle.take(keep), take_expansions(places, keep)
        near = np.maximum(lanes.near, proof.error_bound[keep])
        # both halves from the middle, where everything is computed
        both = np.tile(np.arange(len(keep)), 2)
        halves = OpenSteps(
            left=SolvedRows.concatenate([lanes.left, middle]),
            right=SolvedRows.concatenate([middle, lanes.right]),
            near=near[both],
            owner=lanes.owner[both],
        )
        ends = SolvedRows.concatenate([lanes.left, lanes.right])
        held, apart = prove_steps(
            solver, middle.take(both), ends, halves.near, take_expansions(places, both)
        )
        self.lose(halves.owner[apart])
        return halves.take(np.flatnonzero(~held))


def _between(
    prover: Prover, left: SolvedRows, right: SolvedRows, share: Array
) -> tuple[SolvedRows, BoolArray, list[Place]]:
    """Positions at shares (L,) of steps in t, started from the quintic through both ends; which
    were found; their expansions for proofs.
    """
    solver, path = prover.solver, prover.path
    guess = quintic(share[:, None], (right.t - left.t)[:, None], left, right)
    t = left.t + share * (right.t - left.t)
    guess[:, solver.unknowns :] = path.at(t)
    done = solver.solve(guess)
    v = solver.sharpen(done.v) if prover.exact else done.v
    rates = solver.rates(v, path.rate)
    input_radius = rounding_of_inputs(v, solver.unknowns)
    points = SolvedRows(t=t, v=v, first=rates.first, second=rates.second, input_radius=input_radius)
    return points, done.status == CONVERGED, prover.places(v)


# ----------------------------------------------------------------------
# Proving that a row of positions lies on one branch: many steps at once, halved where needed.


_MOST = 30_000  # positions solved in between for the proof of one path
_MOST_EACH = 8  # and this many more for each of its own positions


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

    Notes
    -----
    A step that is not proved from its left end is tried from its right end, then halved at a
    position solved in between. Many open steps are worked on together.
    """
    count = len(points.t)
    if not exact and solver.goes_singly(count):
        few = _prove_few(solver, path, points)
        if few is not None:
            return few
    prover = Prover(solver, path, exact, fitted=exact or not solver.is_recorded)
    allowance = Allowance(_MOST + _MOST_EACH * count if most is None else most)
    strand = Strand(begin=0, end=count, anchor=anchor)
    return _prove_strands(prover, points, [strand], allowance)


def _prove_few(solver: BlockSolver, path: InputPath, points: SolvedRows) -> ProvenPath | None:
    """:func:`prove_path` on floats; ``None`` if a position or a step is not proved so."""
    prover = StepProver(solver, path)
    found = prover.places(points, range(len(points.t)))
    places = [place for place in found if place is not None]
    if len(places) < len(found):
        return None
    pieces = []
    for one, other in pairwise(places):
        before = prover.inserted
        if not prover.joins(one, other):
            return None
        pieces.append(1 + prover.inserted - before)
    existence, unique, errors = radii_of(places)
    steps = len(pieces)
    return ProvenPath(
        position=Proof(
            holds=np.ones(len(places), dtype=bool),
            existence_radius=existence,
            uniqueness_radius=unique,
            error_bound=errors,
        ),
        connected=np.ones(steps, dtype=bool),
        pieces=np.array(pieces, dtype=np.int64),
        given_up=np.zeros(steps, dtype=bool),
    )


def prove_paths(
    solver: BlockSolver,
    path: InputPath,
    paths: Sequence[SolvedRows],
    *,
    anchors: Sequence[int],
    most: int,
    halvings: int | None = None,
) -> list[ProvenPath]:
    """:func:`prove_path` of several paths together, each with an anchor of its own.

    ``halvings`` of one step, at most; the usual number by default.
    """
    fitted = not solver.is_recorded
    prover, allowance = Prover(solver, path, False, fitted=fitted), Allowance(most)
    prover = prover if halvings is None else replace(prover, halvings=halvings)
    if not paths:
        return []
    ends = np.cumsum([len(points.t) for points in paths]).tolist()
    strands = [
        Strand(begin=begin, end=end, anchor=begin + anchor)
        for begin, end, anchor in zip([0, *ends], ends, anchors, strict=False)
    ]
    whole = _prove_strands(prover, SolvedRows.concatenate(paths), strands, allowance)
    return [
        ProvenPath(
            position=whole.position.take(slice(strand.begin, strand.end)),
            connected=whole.connected[strand.begin : strand.end - 1],
            pieces=whole.pieces[strand.begin : strand.end - 1],
            given_up=whole.given_up[strand.begin : strand.end - 1],
        )
        for strand in strands
    ]


def _prove_strands(
    prover: Prover,
    points: SolvedRows,
    strands: Sequence[Strand],
    allowance: Allowance,
) -> ProvenPath:
    """Strands one after the other; what lies between two of them is no step."""
    solver, places = prover.solver, prover.places(points.v)
    position = prove(solver, points.v, points.input_radius, places)
    steps = len(points.t) - 1
    nothing = np.zeros(steps, dtype=bool)
    pieces = np.ones(steps, dtype=np.int64)
    if not steps:
        return ProvenPath(position=position, connected=nothing, pieces=pieces, given_up=nothing)
    left, right = points.take(slice(None, -1)), points.take(slice(1, None))
    near = np.maximum(position.error_bound[1:], position.error_bound[:-1])
    # steps from one strand to the next are none
    hold = position.holds[1:] & position.holds[:-1]
    hold[[strand.begin - 1 for strand in strands[1:]]] = False
    connected, apart, given_up = np.zeros((3, steps), dtype=bool)
    stages = [prover]
    if not prover.fitted:  # some steps are proved in fitted weights only
        quick = replace(prover, halvings=min(prover.halvings, _QUICK))
        stages = [quick, replace(prover, fitted=True)]
    for stage in stages:
        # a step towards a change point is often proved from its far end only
        for begin, end, shift in ((left, right, 0), (right, left, 1)):
            open_ = np.flatnonzero(hold & ~connected & ~apart)
            if not len(open_):
                return ProvenPath(
                    position=position, connected=connected, pieces=pieces, given_up=given_up
                )
            here = begin.take(open_)
            known = take_expansions(places, open_ + shift)
            if stage is not stages[0]:
                known = stage.places(here.v)
            connected[open_], apart[open_] = prove_steps(
                solver, here, end.take(open_), near[open_], known
            )
        open_ = np.flatnonzero(hold & ~connected & ~apart)
        if not stage.fitted and len(open_) <= FEW:
            for k, inserted in _proved_singly(stage, points, open_):
                connected[k] = True
                pieces[k] += inserted
            open_ = open_[~connected[open_]]
        work = Halving(stage, strands, position.holds)
        work.lose(np.flatnonzero(apart))
        work.run(work.of_use(_open_steps(left, right, near, open_)), allowance)
        connected[open_] = work.proved[open_]
        pieces += work.pieces
        given_up = work.given_up
    return ProvenPath(position=position, connected=connected, pieces=pieces, given_up=given_up)


def _proved_singly(
    prover: Prover, points: SolvedRows, steps: IndexArray
) -> Iterator[tuple[int, int]]:
    """The steps that are proved on floats, and how many positions each takes in between."""
    singly = StepProver(prover.solver, prover.path)
    for k in steps.tolist():
        before = singly.inserted
        one, other = singly.places(points, (k, k + 1))
        if one is not None and other is not None and singly.joins(one, other):
            yield k, singly.inserted - before


def _open_steps(left: SolvedRows, right: SolvedRows, near: Array, steps: IndexArray) -> OpenSteps:
    return OpenSteps(left=left.take(steps), right=right.take(steps), near=near[steps], owner=steps)


# ----------------------------------------------------------------------
# Proof that a traced curve is one curve: every leg, every change of leader, the closure.


_MOST_STEPS = 20_000  # of a proof: a length on its way to infinity takes steps without end
_MOST_EXACT = 400  # of those with residuals that are rounded once, which take far longer


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvenCurve:
    """``legs`` (L,): every step of the leg. ``junctions`` (L-1,): from a leg to the next.
    ``closed``: that the last position is the first one again. ``steps``: how many were proved.
    ``broken``: the leg, and the node behind it, of the first step that is not proved.
    """

    legs: BoolArray
    junctions: BoolArray
    closed: bool
    steps: int
    broken: tuple[int, int] | None = None

    @property
    def whole(self) -> bool:
        """Whether the curve is proved from its first to its last position."""
        return bool(self.legs.all() and self.junctions.all())


def prove_curve(leads: Parametrizations, curve: Curve, most: int = _MOST_STEPS) -> ProvenCurve:
    """Prove every step of a curve; of very many steps only about ``most``."""
    return prove_curves(leads, [curve], most)[0]


def prove_curves(
    leads: Parametrizations,
    curves: Sequence[Curve],
    most: int = _MOST_STEPS,
    halvings: int | None = None,
) -> list[ProvenCurve]:
    """Prove curves together: few large arrays take far less time than many small ones.

    ``halvings`` of one step, at most; the usual number by default.
    """
    provable = [all(leg.led.provable for leg in curve.legs) for curve in curves]
    legs = [leg for curve, good in zip(curves, provable, strict=True) if good for leg in curve.legs]
    proofs = dict(zip(map(id, legs), _prove_legs(legs, most * len(curves), halvings), strict=True))
    return [
        _prove(leads, curve, [proofs[id(leg)] for leg in curve.legs] if good else [])
        for curve, good in zip(curves, provable, strict=True)
    ]


def _prove(leads: Parametrizations, curve: Curve, proofs: Sequence[ProvenPath]) -> ProvenCurve:
    """A curve with the proofs of its legs, if these can be proved: junctions and the closure."""
    legs = np.zeros(len(curve.legs), dtype=bool)
    junctions = np.zeros(max(len(curve.legs) - 1, 0), dtype=bool)
    steps, broken = 0, None
    for k, proof in enumerate(proofs):
        # from its first position, which the previous leg has proved
        joined = _joined(curve.legs[k], proof)
        legs[k] = joined.all()
        if broken is None and not legs[k]:
            broken = (k, int(np.argmin(joined)) - 1)
        steps += int(proof.pieces.sum())
    for k in range(len(proofs) - 1):
        leg, following = curve.legs[k : k + 2]
        last = leg.v[-1]
        junctions[k] = np.array_equal(last, following.v[0]) and _goes_on(leads, leg, following)
        junctions[k] &= same_solution(leg.led, following.led, last)
    own = leads.with_parameter(leads.parameter)
    closed = False
    if curve.end.closed and own is not None and own.provable:
        last = curve.legs[-1]
        first = curve.legs[0]
        closed = same_solution(own, first.led, first.v[0])
        closed = closed and same_solution(last.led, own, last.v[-1])
        closed = closed and _meets(leads, own, first.v[0], last.v[-1])
    return ProvenCurve(legs=legs, junctions=junctions, closed=closed, steps=steps, broken=broken)


def _goes_on(leads: Parametrizations, leg: Leg, following: Leg) -> bool:
    """Whether the next leg leaves in the direction in which a leg arrives."""
    arrival, departure = (
        np.sign(part.nodes[-1].t - part.nodes[0].t) * part.first[place] / leads.scale
        for part, place in ((leg, -1), (following, 0))
    )
    # a leg that turned around would prove the way back, not the way on
    return bool(arrival @ departure > 0.0)


def legs_are_proved(legs: Sequence[Leg]) -> list[bool]:
    """Whether every position and every step of legs is proved."""
    proofs = _prove_legs(legs, _MOST_STEPS)
    return [bool(_joined(leg, proof).all()) for leg, proof in zip(legs, proofs, strict=True)]


def _joined(leg: Leg, proof: ProvenPath) -> BoolArray:
    """Which nodes of a leg are joined to its first one, in its order, (K,)."""
    falls = leg.nodes[-1].t < leg.nodes[0].t
    return proof.connected_to(len(leg.nodes) - 1)[::-1] if falls else proof.connected_to(0)


def _prove_legs(legs: Sequence[Leg], most: int, halvings: int | None = None) -> list[ProvenPath]:
    """Every position and step of legs, joined to their first nodes, in the order of rising t; with
    exact residuals where branches nearly cross.
    """
    found: list[ProvenPath | None] = [None] * len(legs)
    groups: dict[int, list[int]] = {}
    for k, leg in enumerate(legs):
        groups.setdefault(id(leg.led), []).append(k)
    for members in groups.values():
        led = legs[members[0]].led
        rows, anchors = [], []
        for k in members:
            nodes = legs[k].nodes
            # a leg may be traced downwards; proofs take rising values
            falls = nodes[-1].t < nodes[0].t
            points = rows_of_nodes(nodes[::-1] if falls else nodes)
            rows.append(points.with_columns(input_radius=np.zeros((len(nodes), 1))))
            anchors.append(len(nodes) - 1 if falls else 0)
        proofs = prove_paths(
            led.solver, led.path, rows, anchors=anchors, most=most, halvings=halvings
        )
        for k, points, anchor, proof in zip(members, rows, anchors, proofs, strict=True):
            nearly = any(node.nearness > REGULAR_CONDITION for node in legs[k].nodes)
            if nearly and not proof.connected_to(anchor).all():
                few = min(most, _MOST_EXACT)
                proof = prove_path(
                    led.solver, led.path, points, anchor=anchor, most=few, exact=True
                )
            found[k] = proof
    return [proof for proof in found if proof is not None]


def same_solution(one: Parametrization, other: Parametrization, v: Array) -> bool:
    """Whether two leaders prove the same position near v (N,).

    The first position may differ from v in the other's leader by at most its proved error; the
    second is proved for all those values, and is the only one in its box. Where residuals as
    computed do not suffice, those that are rounded once may.
    """
    if one.lead == other.lead:
        return True
    return any(_same_solution(one, other, v, exact) for exact in (False, True))


def _same_solution(one: Parametrization, other: Parametrization, v: Array, exact: bool) -> bool:
    mine, theirs = v[one.order][None, :], v[other.order][None, :]
    place = expansions(one.solver, mine, exact=exact)
    first = prove(one.solver, mine, np.zeros((1, 1)), place)
    if not first.holds[0]:
        return False
    off = one.whole(first.error_bound[0])[other.order]
    place = expansions(other.solver, theirs, exact=exact)
    second = reach(other.solver, theirs, off[None, -1:], place)
    return bool(second.holds[0] and (off[:-1] < second.isolation_radius[0]).all())


def _meets(leads: Parametrizations, own: Parametrization, start: Array, end: Array) -> bool:
    """Whether two proved positions at one value of the parameter are one, modulo whole turns."""
    if not leads.repeats_after(whole_turns(leads, start, end)):
        return False
    gap = apart(leads, start, end)
    # whole turns are no floats: the gap includes their rounding
    left = np.abs(gap) + 8.0 * UNIT_ROUNDOFF * np.maximum(np.abs(end), np.abs(start))
    left = left[own.order]
    first = reach(own.solver, start[own.order][None, :], left[None, -1:])
    last = prove(own.solver, end[own.order][None, :], left[None, -1:])
    if not (first.holds[0] and last.holds[0]):
        return False
    return bool((left[:-1] + last.error_bound[0, :-1] < first.isolation_radius[0]).all())
