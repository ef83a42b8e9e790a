"""Dead points block by block: where several blocks lock at one input, equal to rounding.

There the equations as a whole lose one rank for each such block, and whichever variable leads,
curves cross. With the blocks that it depends on each of them is a mechanism of its own with an
ordinary dead point: no branch goes on beyond the first of these.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.arrays import EPSILON, Array
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import Model
from linkwork.core.numerics.block_solver import Block
from linkwork.core.numerics.branch_tracking import End, InputPath, Node, Parametrization, Track
from linkwork.core.numerics.change_point import (
    ChangePoint,
    Crossing,
    crossing_near,
    locate_change_point,
    most_singular,
    singular_blocks,
)
from linkwork.core.numerics.decomposition import closure_of
from linkwork.core.numerics.passage import Passage, pass_change_points
from linkwork.core.numerics.path_proof import same_solution
from linkwork.core.numerics.turning_point import TurnAhead, TurningPoint, turn_beyond
from linkwork.core.results.failure import Limit, LimitKind
from linkwork.core.table.loop_table import TableSplitter

# Condition up to which a node is far enough from a dead point to begin the search for it. Nodes
# must be proved up to 1e5 (motion.proving) and exist up to 3e6 (TrackOptions): a tenth of the first
# leaves no doubt that this one is proved.
_SOUND = 1e4
_APART = 16.0 * EPSILON  # relative: dead points nearer to each other are at one input


@dataclass(frozen=True, kw_only=True, eq=False)
class Lock:
    """A value ``t`` of the path at which blocks lock, within ``bracket``, proved; ``v`` (N,): the
    position, as it was before for all variables that these blocks do not need.
    """

    t: float
    bracket: tuple[float, float]
    v: Array


def locks_ahead(drive: Drive, nodes: Sequence[Node], side: float) -> Lock | None:
    """The first dead point ahead of a track's last node, if several blocks are singular there.

    ``None`` if that is no more than one, or none is proved to have a dead point.
    """
    blocks = singular_blocks(drive.solver, nodes[-1].v)
    if len(blocks) < 2:
        return None
    # next to a change point, in its own loops or in those that drive it, rounding makes a dead
    # point of a crossing
    locking = [
        block
        for block in blocks
        if set(closure_of(drive.solver, block)).isdisjoint({*blocks} - {block})
        and crossing_near(drive.solver, drive.path, block, nodes[-1].v) is None
    ]
    found = [lock for block in locking if (lock := _lock(drive, nodes, block, side)) is not None]
    found.sort(key=lambda lock: side * lock.t)
    if not found:
        return None
    low, high = found[0].bracket
    v = found[0].v.copy()
    for lock in found:
        slack = _APART * max(1.0, abs(lock.t))
        if lock.bracket[0] > high + slack or lock.bracket[1] < low - slack:
            break
        low, high = min(low, lock.bracket[0]), max(high, lock.bracket[1])
        moved = lock.v != nodes[-1].v
        v[moved] = lock.v[moved]
    t = found[0].t
    v[drive.solver.unknowns :] = drive.path.at(t)
    return Lock(t=t, bracket=(low, high), v=v)


def _lock(drive: Drive, nodes: Sequence[Node], block: int, side: float) -> Lock | None:
    """The dead point of one block with those that it depends on; ``None`` if none is proved."""
    solver, path = drive.solver, drive.path
    members = [solver.blocks[k] for k in closure_of(solver, block)]
    equations = [e for member in members for e in member.equations]
    unknowns = [int(k) for member in members for k in member.unknowns]
    table, known = TableSplitter(drive.model.compiled.table).part(equations, unknowns)
    inputs = [k - solver.unknowns for k in known]
    moving = [k for k in inputs if path.rate[k]]
    if not moving:
        return None
    lead = drive.lead if drive.lead in moving else moving[0]
    own = InputPath(origin=path.origin[inputs], rate=path.rate[inputs], size=path.size)
    leads = ParametrizedTable(table, own, inputs.index(lead))
    order, rate, origin = np.array([*unknowns, *known]), path.rate[lead], path.origin[lead]
    for node in sound_nodes(nodes):
        way = math.copysign(1.0, side * rate)
        ahead = turn_beyond(leads, node.v[order], node.first[order] / rate, way)
        if ahead is None or not ahead.located:
            continue
        t, *edges = ((x - origin) / rate for x in (ahead.turn.t, *ahead.turn.bracket))
        v = nodes[-1].v.copy()
        v[order] = ahead.turn.v
        return Lock(t=float(t), bracket=(min(edges), max(edges)), v=v)
    return None


def sound_nodes(nodes: Sequence[Node]) -> list[Node]:
    """The nodes of a track from which a dead point ahead is looked for: the last one that is proved
    with the others, since rounding is worst at the very last one, and that one.
    """
    sound = next((node for node in reversed(nodes) if node.nearness < _SOUND), nodes[-1])
    return [sound, nodes[-1]] if sound is not nodes[-1] else [sound]


# ----------------------------------------------------------------------
# The links that are in line at a singular position.


def links_in_line(model: Model, number: int, v: Array) -> tuple[str, ...]:
    """The links of a block that have all their joints of one loop on one line, at v (N,).

    Two unknown vectors of a loop are in line if they are parallel and follow each other: as the
    only two of the loop, or as links with a common pin. Links that are merely parallel are not.
    """
    block = model.compiled.solver.blocks[number]
    names: set[str] = set()
    for vectors in _vectors(model, block, v):
        for (a, one), (b, other) in combinations(vectors.items(), 2):
            if not (len(vectors) == 2 or _pinned(model, a, b)):
                continue
            product = one.conjugate() * other
            if product and abs(math.remainder(math.atan2(product.imag, product.real), math.pi)) < (
                _IN_LINE
            ):
                names |= {a, b}
    return tuple(sorted(names))


def _vectors(model: Model, block: Block, v: Array) -> list[dict[str, complex]]:
    """Per loop of a block, the vectors that turn with one unknown angle of the block each.

    A loop with a vector that turns with several of them is left out.
    """
    equations = model.equations
    value = {variable.symbol: float(x) for variable, x in zip(equations.variables, v, strict=True)}
    mine = {equations.unknowns[int(k)].symbol: equations.unknowns[int(k)] for k in block.unknowns}
    found = []
    for number in block.equations:
        if number >= len(equations.loops):
            continue
        vectors: dict[str, complex] = {}
        for term in equations.loops[number].terms:
            unknown = [name for name, _ in term.phase if name in mine]
            if not unknown:
                continue
            if len(term.phase) > 1:
                vectors = {}
                break
            turn = sum(weight * value[name] for name, weight in term.phase)
            length = 1.0 if term.length is None else value[term.length]
            vector = term.value * length * complex(math.cos(turn), math.sin(turn))
            name = mine[unknown[0]].name
            vectors[name] = vectors.get(name, 0j) + vector
        found.append(vectors)
    return found


def _pinned(model: Model, a: str, b: str) -> bool:
    description = model.description
    if not isinstance(description, Linkage) or not {a, b} <= description.links.keys():
        return False
    return not set(description.links[a]).isdisjoint(description.links[b])


# ----------------------------------------------------------------------
# Limits of a branch: dead points and change points, with the locking loop and its links.


_MOVES = 1e-7  # weighted: a direction along which the input moves at all
# Ratio of singular values up to which a block locks with another: it grows with the root of the
# distance from a dead point, so that sides that differ by rounding keep it below.
_IN_LINE = 1e-6
_TOUCHING = 1e-12  # residual at a located crossing, where Newton-Raphson must not take a step


@dataclass(frozen=True, kw_only=True, eq=False)
class BranchEnd:
    """One end of a branch: its limit, and its place if it was found.

    ``side``: +1 at the upper end, -1 at the lower. ``t``: of the path; ``slack``: how far a value
    that is meant to be this end's may be from it. ``v`` (N,): the position. ``first`` (N,):
    derivatives there, NaN where they do not exist. ``crossings``: if branches cross there, with
    ``nodes``, the track that led there in the order of travel, and the ``passage`` straight on.
    ``led``, ``node``: a dead point as another leader sees it; ``ahead``: the way to it from the
    last position that the input leads to well.
    ``radius``, ``uniqueness_radius``: of its proof.
    """

    side: float
    limit: Limit
    t: float
    slack: float = 0.0
    v: Array | None = None
    first: Array | None = None
    crossings: tuple[ChangePoint, ...] = ()
    nodes: tuple[Node, ...] = ()
    passage: Passage | None = None
    led: Parametrization | None = None
    node: Node | None = None
    ahead: TurnAhead | None = None
    certification: Certification = Certification.NOT_ASKED
    radius: float = np.nan
    uniqueness_radius: float = np.nan

    def with_input_named(self, value: float) -> BranchEnd:
        """The end with its limit at the input value of its row in a table, whole turns away."""
        low, high = self.limit.bracket
        shift = value - self.limit.input
        # the bracket must still hold the limit after it is moved
        rounding = EPSILON * (abs(value) + abs(shift))  # whole turns in radians are no floats
        bracket = (low + shift - rounding, high + shift + rounding)
        limit = replace(self.limit, input=value, bracket=bracket)
        return replace(self, limit=limit) if shift else self

    def is_at(self, t: float, rounding: float) -> bool:
        """Whether a value of the path that was asked for is this end's, and a position is there."""
        return self.v is not None and abs(t - self.t) <= self.slack + rounding

    def demote(self, standing: Certification) -> BranchEnd:
        """The end with the certification of the way to its branch, if it is proved on it."""
        if self.certification is not Certification.CERTIFIED:
            return self
        return replace(self, certification=standing)


def ends_of(drive: Drive, track: Track, certify: bool = False) -> tuple[BranchEnd, ...]:
    """The ends that a track met before its goals, lower one first."""
    found = []
    for end, side in ((track.below, -1.0), (track.above, 1.0)):
        if end is not None:
            nodes = track.nodes if side > 0 else track.nodes[::-1]
            with np.errstate(all="ignore"):  # rates and conditions may be infinite there
                found.append(_end(drive, nodes, end, side, certify))
    return tuple(found)


def _end(drive: Drive, nodes: Sequence[Node], end: End, side: float, certify: bool) -> BranchEnd:
    if end.status is not Status.START_SINGULAR:
        crossing = locate_change_point(drive.solver, drive.path, nodes[-1], side)
        ahead = None if crossing is not None else _turn_ahead(drive, nodes, side)
        if ahead is None or not ahead.located:
            lock = locks_ahead(drive, nodes, side)
            # another block may cross branches where one locks: the branch ends all the same
            if lock is not None and (crossing is None or not _is_before(crossing, lock, side)):
                return _locked_end(drive, lock, side, certify)
        if crossing is not None:
            return _crossing_end(drive, nodes, crossing, side, certify)
        if ahead is not None:
            return _dead_end(drive, nodes[-1], ahead, side, certify)
    edges = sorted((end.reached, end.failed))
    return BranchEnd(
        side=side,
        t=float(end.reached),
        limit=Limit(
            kind=LimitKind.UNKNOWN,
            input=float(end.reached / drive.unit),
            bracket=(float(edges[0] / drive.unit), float(edges[1] / drive.unit)),
            located=False,
            status=end.status,
        ),
    )


def _turn_ahead(drive: Drive, nodes: Sequence[Node], side: float) -> TurnAhead | None:
    """The dead point ahead of a track's last nodes."""
    best: TurnAhead | None = None
    for last in sound_nodes(nodes):
        # the last nodes are ill-conditioned; a node somewhat earlier gives the same dead point
        ahead = turn_beyond(drive.leads, last.v, last.first, side)
        if ahead is not None and (best is None or ahead.located):
            best = ahead
        if best is not None and best.located:
            break
    return best


def _is_before(crossing: ChangePoint, lock: Lock, side: float) -> bool:
    """Whether a change point is met before blocks lock."""
    ends = [sorted(side * edge for edge in place.bracket) for place in (crossing, lock)]
    return ends[0][1] < ends[1][0]


def _locked_end(drive: Drive, lock: Lock, side: float, certify: bool) -> BranchEnd:
    """The end of a branch where blocks lock at one input, each proved by itself."""
    low, high = lock.bracket
    return BranchEnd(
        side=side,
        limit=_limit_at(drive, LimitKind.DEAD_POINT, lock.t, lock.v, lock.bracket),
        t=lock.t,
        slack=max(high - lock.t, lock.t - low),
        v=_touching(drive, lock.v),
        first=np.full(len(lock.v), np.nan),
        certification=Certification.POSITION_NOT_PROVED if certify else Certification.NOT_ASKED,
    )


def _dead_end(drive: Drive, last: Node, ahead: TurnAhead, side: float, certify: bool) -> BranchEnd:
    first, own = ahead.legs[0], drive.leads.with_parameter(drive.leads.parameter)
    begin = first.led.whole(first.nodes[0].v)
    joined = ahead.located and own is not None and same_solution(own, first.led, begin)
    turn = ahead.turn
    if not ahead.located:  # not known to be on this branch, which ended at the last node
        edges = sorted((last.t, *turn.bracket))
        turn = replace(turn, proof=None, bracket=(edges[0], edges[-1]))
    end = end_at_dead_point(drive, turn, ahead.legs[-1].led, certify, joined)
    return replace(end, side=side, ahead=ahead)


def end_at_dead_point(
    drive: Drive, turn: TurningPoint, led: Parametrization, certify: bool, joined: bool = False
) -> BranchEnd:
    """The end of a branch at a dead point, seen by the leader ``led``.

    ``joined``: whether the branch is proved to lead to it.
    """
    low, high = turn.bracket
    found = BranchEnd(
        side=0.0,
        limit=dead_point_limit(drive, turn),
        t=turn.t,
        # a value within the bracket may be the limit itself
        slack=max(high - turn.t, turn.t - low) if turn.located else 0.0,
        v=turn.v,
        first=np.full(len(turn.v), np.nan),
        led=led,
        node=turn.node,
    )
    if not certify:
        return found
    if turn.proof is None:
        return replace(found, certification=Certification.POSITION_NOT_PROVED)
    return replace(
        found,
        certification=Certification.CERTIFIED if joined else Certification.MOTION_NOT_PROVED,
        radius=turn.proof.radius,
        uniqueness_radius=turn.proof.uniqueness_radius,
    )


def dead_point_limit(drive: Drive, turn: TurningPoint) -> Limit:
    """The limit at a dead point, in file units."""
    kind = LimitKind.DEAD_POINT
    return _limit_at(drive, kind, turn.t, turn.v, turn.bracket, located=turn.located)


def _locking(drive: Drive, v: Array) -> tuple[int, ...]:
    """The numbers of the blocks that lock at a position (N,): the one nearest to a singular
    position, and those that are as good as singular, too.
    """
    block = most_singular(drive.solver, v)
    if block is None:
        return ()
    return tuple(sorted({block, *singular_blocks(drive.solver, v, _IN_LINE)}))


def kind_of_crossing(leads: ParametrizedTable, crossing: Crossing) -> LimitKind:
    """Where curves cross along both of which the input turns back, several blocks lock at once."""
    p = leads.parameter
    moves = np.abs(crossing.directions[:, p] / leads.scale[p]) > _MOVES
    return LimitKind.CHANGE_POINT if moves.any() else LimitKind.DEAD_POINT


def change_point_limit(drive: Drive, crossing: Crossing) -> Limit:
    """The limit at a change point between two curves, in file units."""
    leads = drive.leads
    p = leads.parameter
    rates = []
    for direction in crossing.directions:
        moving = abs(float(direction[p] / leads.scale[p])) > _MOVES
        # a branch that keeps the input has no derivative by it
        rates.append(direction / direction[p] if moving else np.full(len(direction), np.nan))
    taking_part = np.any(crossing.directions != 0.0, axis=0)
    onward, other = (_rates(drive.model, np.where(taking_part, rate, np.nan)) for rate in rates)
    kind, located = LimitKind.CHANGE_POINT, bool(crossing.located)
    limit = _limit_at(drive, kind, crossing.t, crossing.v, crossing.bracket, located=located)
    return replace(limit, onward=onward, other=other)


def _crossing_end(
    drive: Drive, nodes: Sequence[Node], first: ChangePoint, side: float, certify: bool
) -> BranchEnd:
    """The end of a branch at the change point of a block, and of all that cross at that input."""
    passage = pass_change_points(drive.solver, drive.path, nodes, first.t, side, turn=False)
    if passage is None:
        rates = first.onward.copy()
        rates[drive.solver.unknowns :] = drive.path.rate
        end = end_at_change_point(drive, (first,), first.v, rates, side, certify)
    else:
        group = passage.crossings[0]
        end = end_at_change_point(drive, group, *passage.position(group[0].t), side, certify)
    return replace(end, passage=passage, nodes=tuple(nodes))


def end_at_change_point(
    drive: Drive,
    crossings: tuple[ChangePoint, ...],
    v: Array,
    first: Array,
    side: float,
    certify: bool,
) -> BranchEnd:
    """The end of a branch where blocks cross other branches, all at one input.

    ``v``, ``first`` (N,): the position, and its derivatives on the branch that was followed.
    """
    model, t = drive.model, crossings[0].t
    low = min(crossing.bracket[0] for crossing in crossings)
    high = max(crossing.bracket[1] for crossing in crossings)
    limit = _limit_at(
        drive,
        LimitKind.CHANGE_POINT,
        t,
        v,
        (low, high),
        located=all(crossing.located for crossing in crossings),
        blocks=[crossing.block for crossing in crossings],
    )
    onward: dict[str, float] = {}
    other: dict[str, float] = {}
    for crossing in crossings:
        onward |= _rates(model, crossing.onward)
        other |= _rates(model, crossing.other)
    return BranchEnd(
        side=side,
        limit=replace(limit, onward=onward, other=other),
        t=t,
        slack=max(high - t, t - low),
        v=_touching(drive, v),
        first=first,
        crossings=crossings,
        certification=Certification.POSITION_NOT_PROVED if certify else Certification.NOT_ASKED,
    )


def _touching(drive: Drive, v: Array) -> Array | None:
    """A position (N,) at which blocks are singular, if all equations hold there."""
    done = drive.solver.solve(
        # a step of Newton-Raphson would lead away, so only residuals are checked
        v[None, :],
        replace(drive.solver.options, equation_tolerance=_TOUCHING, max_steps=8),
    )
    return done.v[0] if done.status[0] == Status.CONVERGED.code else None


def _limit_at(
    drive: Drive,
    kind: LimitKind,
    t: float,
    v: Array,
    bracket: tuple[float, float],
    *,
    located: bool = True,
    blocks: Sequence[int] | None = None,
) -> Limit:
    """The limit at a position v (N,) at a value t of the path.

    ``blocks``: the numbers of the blocks that lock, by default those that are singular there.
    """
    low, high = (edge / drive.unit for edge in bracket)
    status = Status.OUT_OF_REACH if kind is LimitKind.DEAD_POINT else Status.CHANGE_POINT
    blocks = _locking(drive, v) if blocks is None else blocks
    equations = [e for block in blocks for e in drive.solver.blocks[block].equations]
    return Limit(
        kind=kind,
        input=float(t / drive.unit) + 0.0,
        # outwards: the division by the unit has rounded both ends
        bracket=(math.nextafter(low, -math.inf), math.nextafter(high, math.inf)),
        located=located,
        status=status,
        loops=tuple(drive.model.equations.labels[e] for e in equations),
        in_line=tuple(dict.fromkeys(n for b in blocks for n in links_in_line(drive.model, b, v))),
    )


def _rates(model: Model, rates: Array) -> dict[str, float]:
    """Derivatives of the unknowns that take part, by name."""
    return {
        variable.name: float(rate)
        for variable, rate in zip(model.equations.unknowns, rates, strict=False)
        if np.isfinite(rate)
    }
