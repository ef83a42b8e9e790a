"""Sweep the whole circuit: the rows of the branches beyond the dead points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.circuits.arcs import Arc, Explorer, is_regular, positions_at_value
from linkwork.circuits.branches import CurveBranch, TracedCurve, branches_of, trace_with_proof
from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.statuses import CONVERGED, Certification, CircuitEnd, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.branch_rows import Asked, BranchRows, Report, rows_of_branch
from linkwork.core.motion.following import Drive, track_to
from linkwork.core.motion.limits import BranchEnd, end_at_dead_point
from linkwork.core.motion.model import FITS, Model, misfit
from linkwork.core.numerics.branch_tracking import node_at, rows_on_track, same_position


@dataclass(frozen=True, kw_only=True, eq=False)
class FurtherBranch:
    """A branch beyond a dead point: the values asked for, its rows, its ends, its name.

    ``window``: smallest and largest value of t on it. ``standing``: the certification of rows
    that are proved on it.
    """

    asked: Asked
    window: tuple[float, float]
    found: BranchRows
    ends: tuple[BranchEnd, ...]
    standing: Certification
    name: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Around:
    """The further branches of the start's circuit, its dead points, and how it ends.

    ``windows``: smallest and largest value of t on every branch, the first one among them.
    """

    branches: tuple[FurtherBranch, ...]
    dead_points: tuple[BranchEnd, ...]
    windows: tuple[tuple[float, float], ...]
    end: CircuitEnd

    def leaves_out(self, t: Array, free: bool) -> BoolArray:
        """Which values of t (B,) no branch of a closed circuit passes, (B,).

        ``free``: whether values whole turns away are the same.
        """
        missed = np.full(len(t), self.end.closed)
        for low, high in self.windows:
            turns = np.ceil((low - t) / FULL_TURN) if free else 0.0
            here = t + turns * FULL_TURN
            missed &= (here < low) | (here > high)
        return missed


def further_branches(
    drive: Drive, start: Array, asked: Asked, report: Report, certify: bool
) -> Around:
    """Trace the circuit of a position (N,) and solve the rows asked for on its other branches.

    A closed circuit is followed once around, upwards first; an open one to both of its ends.
    """
    leads = drive.leads
    walks = [trace_with_proof(leads, start, 1.0, certify)]
    if not walks[0].curve.end.closed:
        walks.append(trace_with_proof(leads, start, -1.0, certify))
    ways = [(walk, branches_of(leads, walk)) for walk in walks if walk.curve.legs]
    pieces = [(walk, branch) for walk, branches in ways for branch in branches[1:]]
    found = []
    for number, (walk, branch) in enumerate(pieces, start=2):
        rows = _rows(drive, walk, branch, asked, report, certify)
        if rows is not None:
            found.append(replace(rows, name=_branch_name(drive.model, number)))
    return Around(
        branches=tuple(found),
        dead_points=tuple(
            end_at_dead_point(drive, turn, walk.curve.legs[turn.leg].led, certify)
            for walk in walks
            for turn in walk.turns
        ),
        windows=tuple(branch.range(leads.parameter) for _, branches in ways for branch in branches),
        # of its two ends the less certain one
        end=max((walk.curve.end for walk in walks), key=list(CircuitEnd).index),
    )


def _branch_name(model: Model, number: int) -> str:
    """Branches are counted from that of the guess if it is the first one of its circuit."""
    if model.branch == f"{model.circuit} branch 1":
        return f"{model.circuit} branch {number}"
    return f"{model.circuit}, branch {number} from there"


def _rows(
    drive: Drive,
    walk: TracedCurve,
    branch: CurveBranch,
    asked: Asked,
    report: Report,
    certify: bool,
) -> FurtherBranch | None:
    leads = drive.leads
    mine = _rows_on_branch(branch, asked, leads.parameter, drive.free)
    anchor = branch.anchor
    node = node_at(drive.solver, drive.path, float(anchor[leads.parameter]), anchor)
    if not len(mine.t):
        return None
    found = rows_of_branch(drive, node, mine, report, certify)
    joined = branch.is_joined(leads)
    standing = Certification.CERTIFIED if joined else Certification.MOTION_NOT_PROVED
    found = replace(found, rows=found.rows.demote(standing))
    ends = tuple(
        end_at_dead_point(drive, turn, walk.curve.legs[turn.leg].led, certify, joined)
        for turn in (branch.begin, branch.end)
        if turn is not None
    )
    return FurtherBranch(
        asked=mine,
        window=branch.range(leads.parameter),
        found=found,
        ends=ends,
        standing=standing,
        name="",
    )


def _rows_on_branch(branch: CurveBranch, asked: Asked, parameter: int, free: bool) -> Asked:
    """The rows of the table that lie on a branch, in the direction of travel.

    With a freely turning input a row is met once in every turn.
    """
    low, high = branch.range(parameter)
    row: IndexArray = np.arange(len(asked.t))
    turns: Array = np.zeros(len(row))
    if free:
        first = np.ceil((low - asked.t) / FULL_TURN)
        most = int(np.max(np.floor((high - asked.t) / FULL_TURN) - first)) + 1
        turns = (first[:, None] + np.arange(float(max(most, 1)))).ravel()
        row = np.repeat(row, max(most, 1))
    t = asked.t[row] + turns * FULL_TURN
    inside = np.flatnonzero((t >= low) & (t <= high))
    order = inside[np.argsort(branch.side * t[inside], kind="stable")]
    if len(order):  # 0 and 360 degrees are one row here
        keep = np.concatenate([[True], np.abs(np.diff(t[order])) > 1e-12])
        order = order[keep]
    in_file_units = asked.in_file_units[row[order]]
    inputs = asked.inputs[row[order]]
    return asked.with_columns(t=t[order], inputs=inputs, in_file_units=in_file_units)


# ----------------------------------------------------------------------
# The circuit of one position, followed only as far as a question about it needs.


@dataclass(frozen=True, kw_only=True, eq=False)
class StraightWay:
    """A branch over some values of the input, followed without turning back.

    ``v`` (K, N): the positions at the values, NaN where the branch ends before; ``low`` and
    ``high``: the input at its dead points, infinite where it was not followed to one.
    """

    v: Array
    low: float
    high: float


def straight_way(drive: Drive, start: Array, values: Sequence[float]) -> StraightWay | None:
    """The branch of a position (N,) between the least and the greatest of K values of the input.

    ``None`` if it was lost on the way or ends at a change point, if a position at a value was not
    found, or if redundant links do not fit along it.
    """
    solver, t = drive.solver, np.array(values)
    node = node_at(solver, drive.path, float(start[drive.leads.parameter]), start)
    track = track_to(solver, drive.path, node, values)
    if any(end.status is not Status.OUT_OF_REACH for end in track.ends):
        return None
    v = np.full((len(t), len(start)), np.nan)
    inside = np.flatnonzero((t >= track.first_t) & (t <= track.last_t))
    if len(inside):
        rows = rows_on_track(solver, drive.path, track, t[inside])
        if not (rows.status == CONVERGED).all():
            return None
        v[inside] = rows.v
    way = np.concatenate([np.stack([node.v for node in track.nodes]), v[inside]])
    if (misfit(drive.model.equations, way) > FITS).any():
        return None
    low = -np.inf if track.below is None else track.first_t
    high = np.inf if track.above is None else track.last_t
    return StraightWay(v=v, low=low, high=high)


def explorer_of(drive: Drive) -> Explorer:
    """The arcs that all circuits of a question have in common, none followed yet."""
    return Explorer(drive, certify=False, prove_turns=False)


class FollowedCircuit:
    """The circuit through a position at which the input can lead.

    Parameters
    ----------
    explorer : Explorer
        With the arcs that other circuits have followed: each is followed once.
    start : (N,)

    Attributes
    ----------
    arcs, known : list of Arc, list of CurveBranch
        Its curves between change points, and their branches, as far as they are followed.
    """

    def __init__(self, explorer: Explorer, start: Array) -> None:
        self.leads = explorer.leads
        self.arcs: list[Arc] = []
        self.known: list[CurveBranch] = []
        self._explorer = explorer
        self._first = explorer.arc_through(start)
        self._seen: set[int] = set()
        self._crossings: dict[int, None] = {}
        self.join_arcs()

    def follow_next(self) -> bool:
        """Take over one more of the arcs that change points may join; whether there was one."""
        known = len(self.arcs)
        # in case that another circuit has followed it
        self.join_arcs()
        if len(self.arcs) > known:
            return True
        found = any(self._explorer.branch_off(number) for number in self._crossings)
        self.join_arcs()
        return found

    def join_arcs(self) -> None:
        """Take over the arcs that meet those of the circuit: none through an arc that does not fit,
        on which nothing can move.
        """
        joined = True
        while joined:
            joined = False
            for number, arc in enumerate(self._explorer.arcs):
                meets = number == self._first or not self._crossings.keys().isdisjoint(
                    arc.crossings
                )
                if meets and number not in self._seen:
                    self._seen.add(number)
                    if self._explorer.fits(arc):
                        self.arcs.append(arc)
                        self.known += arc.branches
                        self._crossings.update(dict.fromkeys(arc.crossings))
                        joined = True

    def branches(self) -> Iterator[CurveBranch]:
        """All branches; those behind a change point are followed when they are asked for."""
        number = 0
        while number < len(self.known) or self.follow_next():
            yield from self.known[number : number + 1]
            number = min(number + 1, len(self.known))

    @property
    def ended(self) -> bool:
        """Whether no other arc is left to follow."""
        return not any(self._explorer.half_branches(number) for number in self._crossings)

    @property
    def is_open(self) -> bool:
        """Whether a curve of the circuit, as far as it is followed, was given up on its way."""
        given_up = (CircuitEnd.NEVER_CLOSES, CircuitEnd.SINGULAR)
        return any(arc.end in given_up for arc in self.arcs)

    @property
    def is_whole(self) -> bool:
        """Whether all of it is followed."""
        return self.ended and not self.is_open

    def has(self, v: Array) -> bool:
        """Whether a position (N,) lies on it, as far as it is followed."""
        number = self._explorer.known_arc(v)
        return number is not None and self._explorer.arcs[number] in self.arcs

    def meets(self, other: FollowedCircuit) -> bool:
        """Whether both have an arc in common, as far as they are followed."""
        return any(arc in other.arcs for arc in self.arcs)

    def lies_on(self, branch: CurveBranch, v: Array) -> bool:
        """Whether a position (N,) at which the input can lead is one of a branch."""
        places = self.positions(branch, float(v[self.leads.parameter]))
        return any(same_position(self.leads, place, v) for place in places)

    def positions(self, branch: CurveBranch, value: float) -> list[Array]:
        """The positions (N,) of a branch at a value of the input, modulo whole turns."""
        found = positions_at_value(self.leads, branch, value)
        own = self.leads.with_parameter(self.leads.parameter)
        if own is None or not found or not is_regular(self.leads, branch.anchor):
            return found
        # next to a dead point Newton-Raphson may come onto the branch beyond it, where det J has
        # another sign
        side = own.node(branch.anchor).orientation
        return [v for v in found if np.array_equal(own.node(v).orientation, side)]
