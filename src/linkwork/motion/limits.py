"""Where a branch ends: dead points and change points, with the loop that locks and its links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.drive import Drive
from linkwork.motion.lined_up import links_in_line
from linkwork.motion.model import Model
from linkwork.numerics.change_point import (
    ChangePoint,
    Crossing,
    locate_change_point,
    most_singular,
)
from linkwork.numerics.curve import Leg
from linkwork.numerics.leaders import Led
from linkwork.numerics.proof import prove
from linkwork.numerics.proven_curve import leg_is_proved, same_solution
from linkwork.numerics.track import End, Node, Track
from linkwork.numerics.turning_point import TurningPoint, turn_beyond
from linkwork.results.motion import Limit, LimitKind

__all__ = [
    "BranchEnd",
    "change_point_limit",
    "dead_point_limit",
    "end_at_dead_point",
    "ends_of",
    "slack_at",
]

_MOVES = 1e-7  # weighted: a direction along which the input moves at all
_SOUND = 1e4  # condition up to which a node is as good as any
_SAME_INPUT = 1e-11  # relative: a value asked for at a limit is that limit's
_TOUCHING = 1e-12  # residual at a located crossing, where Newton-Raphson must not take a step


@dataclass(frozen=True, kw_only=True, eq=False)
class BranchEnd:
    """One end of a branch: what is told of it, and its place if it was found.

    ``side``: +1 at the upper end, -1 at the lower. ``t``: of the path. ``v`` (N,): the position.
    ``first`` (N,): derivatives there, NaN where they do not exist. ``crossing``: if branches cross
    there. ``led``, ``node``: a dead point as another leader sees it. ``radius``, ``unique``: of
    its proof.
    """

    side: float
    limit: Limit
    t: float
    v: Array | None = None
    first: Array | None = None
    crossing: ChangePoint | None = None
    led: Led | None = None
    node: Node | None = None
    certification: Certification = Certification.NOT_ASKED
    radius: float = np.nan
    unique: float = np.nan

    def named(self, value: float) -> BranchEnd:
        """The end with its limit at the input value of its row in a table, whole turns away."""
        low, high = self.limit.bracket
        shift = value - self.limit.input
        limit = replace(self.limit, input=value, bracket=(low + shift, high + shift))
        return replace(self, limit=limit) if shift else self

    def is_at(self, t: float) -> bool:
        """Whether a value of the path that was asked for is this end's, and a position is there."""
        return self.v is not None and abs(t - self.t) <= slack_at(t)

    def demoted(self, standing: Certification) -> BranchEnd:
        """The end with what the way to its branch is worth, if it is proved on it."""
        if self.certification is not Certification.CERTIFIED:
            return self
        return replace(self, certification=standing)


def slack_at(t: float) -> float:
    """How far values of the path near t may be apart and yet mean one place."""
    return _SAME_INPUT * max(1.0, abs(t))


def ends_of(drive: Drive, track: Track, certify: bool = False) -> tuple[BranchEnd, ...]:
    """The ends that a track met before its goals, lower one first."""
    found = []
    for end, side in ((track.below, -1.0), (track.above, 1.0)):
        if end is not None:
            nodes = track.nodes if side > 0 else track.nodes[::-1]
            found.append(_end(drive, nodes, end, side, certify))
    return tuple(found)


def _end(drive: Drive, nodes: Sequence[Node], end: End, side: float, certify: bool) -> BranchEnd:
    if end.status is not Status.START_SINGULAR:
        crossing = locate_change_point(drive.solver, drive.path, nodes[-1], side)
        if crossing is not None:
            return _crossing_end(drive, crossing, side, certify)
        # first from a node that is proved with the others; rounding is worst at the very last ones
        sound = (node for node in reversed(nodes) if node.nearness < _SOUND)
        for last in (next(sound, nodes[-1]), nodes[-1]):
            turning = turn_beyond(drive.leads, last.v, last.first, side)
            if turning is not None:
                return _dead_end(drive, last, turning, side, certify)
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


def _dead_end(
    drive: Drive, last: Node, turning: tuple[Leg, TurningPoint], side: float, certify: bool
) -> BranchEnd:
    leg, turn = turning
    own = drive.leads.by(drive.leads.parameter)
    joined = certify and own is not None and same_solution(own, leg.led, last.v)
    joined = joined and leg_is_proved(leg)
    return replace(end_at_dead_point(drive, turn, leg.led, certify, joined), side=side)


def end_at_dead_point(
    drive: Drive, turn: TurningPoint, led: Led | None, certify: bool, joined: bool = False
) -> BranchEnd:
    """The end of a branch at a dead point, seen by the leader ``led``.

    ``joined``: whether the branch is proved to lead to it.
    """
    found = BranchEnd(
        side=0.0,
        limit=dead_point_limit(drive, turn),
        t=turn.t,
        v=turn.v,
        first=np.full(len(turn.v), np.nan),
        led=led,
        node=turn.node,
    )
    if not certify or led is None:
        return found
    if not all(block.system.bends_boundedly for block in led.solver.blocks):
        return replace(found, certification=Certification.NO_BOUND)
    proof = prove(led.solver, turn.node.v[None, :], np.zeros((1, 1)))
    if not proof.holds[0]:
        return replace(found, certification=Certification.POSITION_NOT_PROVED)
    off = float(proof.each[0, led.place(drive.leads.parameter)]) / drive.unit
    low, high = found.limit.bracket
    return replace(
        found,
        limit=replace(found.limit, bracket=(low - off, high + off)),
        certification=Certification.CERTIFIED if joined else Certification.MOTION_NOT_PROVED,
        radius=float(proof.radius[0]),
        unique=float(proof.alone_within[0]),
    )


def dead_point_limit(drive: Drive, turn: TurningPoint) -> Limit:
    """What is told of a dead point, everyday units."""
    return _located(drive, turn, LimitKind.DEAD_POINT, most_singular(drive.solver, turn.v))


def change_point_limit(drive: Drive, crossing: Crossing) -> Limit:
    """What is told of a change point between two curves, everyday units."""
    leads = drive.leads
    p, block = leads.parameter, most_singular(drive.solver, crossing.v)
    rates = []
    for direction in crossing.directions:
        moving = abs(float(direction[p] / leads.scale[p])) > _MOVES
        rates.append(direction / direction[p] if moving else np.full(len(direction), np.nan))
    taking_part = np.any(crossing.directions != 0.0, axis=0)
    onward, other = (_rates(drive.model, np.where(taking_part, rate, np.nan)) for rate in rates)
    limit = _located(drive, crossing, LimitKind.CHANGE_POINT, block)
    return replace(limit, onward=onward, other=other)


def _crossing_end(drive: Drive, crossing: ChangePoint, side: float, certify: bool) -> BranchEnd:
    solver, model = drive.solver, drive.model
    limit = replace(
        _located(drive, crossing, LimitKind.CHANGE_POINT, crossing.block),
        onward=_rates(model, crossing.onward),
        other=_rates(model, crossing.other),
    )
    start = crossing.v.copy()
    done = solver.solve(
        start[None, :], replace(solver.options, equation_tolerance=_TOUCHING, max_steps=8)
    )
    first = crossing.onward.copy()
    first[solver.unknowns :] = drive.path.rate
    return BranchEnd(
        side=side,
        limit=limit,
        t=crossing.t,
        v=done.v[0] if done.status[0] == Status.CONVERGED.code else None,
        first=first,
        crossing=crossing,
        certification=Certification.POSITION_NOT_PROVED if certify else Certification.NOT_ASKED,
    )


class _Place(Protocol):
    """A singular position (N,) at a value of the path's parameter, with a bracket around it."""

    @property
    def t(self) -> float: ...
    @property
    def v(self) -> Array: ...
    @property
    def bracket(self) -> tuple[float, float]: ...
    @property
    def located(self) -> bool: ...


def _located(drive: Drive, place: _Place, kind: LimitKind, block: int | None) -> Limit:
    """What is told of it: ``block`` is the number of the one that locks."""
    model = drive.model
    low, high = (edge / drive.unit for edge in place.bracket)
    short = round(place.t / drive.unit, 9)
    status = Status.OUT_OF_REACH if kind is LimitKind.DEAD_POINT else Status.CHANGE_POINT
    equations = () if block is None else drive.solver.blocks[block].equations
    return Limit(
        kind=kind,
        input=float(short if low <= short <= high else place.t / drive.unit) + 0.0,
        bracket=(float(low), float(high)),
        located=bool(place.located),
        status=status,
        loops=tuple(model.equations.labels[e] for e in equations),
        in_line=() if block is None else links_in_line(model, block, place.v),
    )


def _rates(model: Model, rates: Array) -> dict[str, float]:
    """Derivatives of the unknowns that take part, by name."""
    return {
        variable.name: float(rate)
        for variable, rate in zip(model.equations.unknowns, rates, strict=False)
        if np.isfinite(rate)
    }
