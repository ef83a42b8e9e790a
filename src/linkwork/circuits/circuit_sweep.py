"""Sweep the whole circuit: the rows of the branches beyond the dead points."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.circuits.branches import CurveBranch, TracedCurve, branches_of, trace_with_proof
from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.statuses import Certification, CircuitEnd
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.branch_rows import Asked, BranchRows, Report, rows_of_branch
from linkwork.core.motion.following import Drive
from linkwork.core.motion.limits import BranchEnd, end_at_dead_point
from linkwork.core.motion.model import Model
from linkwork.core.numerics.branch_tracking import node_at


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
