"""Around the whole circuit: the rows of the branches beyond the dead points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.equations.leading import LeadTable
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.motion.branch_rows import Asked, BranchRows, Report, rows_of_branch
from linkwork.motion.circuit.branches import CurveBranch, Traced, branches_of, traced
from linkwork.motion.limits import BranchEnd, end_at_dead_point
from linkwork.motion.model import Model
from linkwork.motion.tracking import turns_freely
from linkwork.numerics.track import InputPath, node_at

__all__ = ["Around", "FurtherBranch", "further_branches"]

_FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True, kw_only=True, eq=False)
class FurtherBranch:
    """A branch beyond a dead point: what was asked on it, its rows, its ends, its name.

    ``window``: smallest and largest value of t on it. ``standing``: what rows that are proved on
    it say.
    """

    asked: Asked
    window: tuple[float, float]
    found: BranchRows
    ends: tuple[BranchEnd, ...]
    standing: Certification
    name: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Around:
    """The further branches of the start's circuit, its dead points, and how it ends."""

    branches: tuple[FurtherBranch, ...]
    dead_points: tuple[BranchEnd, ...]
    end: CircuitEnd


def further_branches(
    model: Model,
    path: InputPath,
    lead: int,
    start: Array,
    asked: Asked,
    report: Report,
    certify: bool,
) -> Around:
    """Trace the circuit of a position (N,) and solve the rows asked for on its other branches.

    A closed circuit is followed once around, upwards first; an open one to both of its ends.
    """
    leads = LeadTable(model.compiled.table, path, lead)
    walks = [traced(leads, start, 1.0, certify)]
    if not walks[0].curve.end.closed:
        walks.append(traced(leads, start, -1.0, certify))
    ways = [(walk, branches_of(leads, walk)) for walk in walks if walk.curve.legs]
    pieces: list[tuple[Traced, CurveBranch]] = [
        (walk, branch) for walk, branches in ways for branch in branches[1:]
    ]
    found = []
    for number, (walk, branch) in enumerate(pieces, start=2):
        rows = _rows(model, path, lead, leads, (walk, branch), asked, report, certify)
        if rows is not None:
            found.append(replace(rows, name=_branch_name(model, number)))
    return Around(
        branches=tuple(found),
        dead_points=tuple(
            end_at_dead_point(model, turn, walk.curve.legs[turn.leg].led, lead, certify)
            for walk in walks
            for turn in walk.turns
        ),
        end=_how_it_ends(walks),
    )


def _branch_name(model: Model, number: int) -> str:
    """Branches are counted from that of the guess if it is the first one of its circuit."""
    if model.branch == f"{model.circuit} branch 1":
        return f"{model.circuit} branch {number}"
    return f"{model.circuit}, branch {number} from there"


def _how_it_ends(walks: Sequence[Traced]) -> CircuitEnd:
    """How the circuit ends: of its two ends the one that leaves most open."""
    return max((walk.curve.end for walk in walks), key=list(CircuitEnd).index)


def _rows(
    model: Model,
    path: InputPath,
    lead: int,
    leads: LeadTable,
    piece: tuple[Traced, CurveBranch],
    asked: Asked,
    report: Report,
    certify: bool,
) -> FurtherBranch | None:
    walk, branch = piece
    mine = _asked_on(branch, asked, leads.parameter, turns_freely(model))
    anchor = branch.anchor
    node = node_at(model.compiled.solver, path, float(anchor[leads.parameter]), anchor)
    if not len(mine.t):
        return None
    found = rows_of_branch(model, path, lead, node, mine, report, certify)
    joined = branch.is_joined(leads)
    standing = Certification.CERTIFIED if joined else Certification.MOTION_NOT_PROVED
    if certify and not joined:
        code = found.rows.certification
        code[code == Certification.CERTIFIED.code] = Certification.MOTION_NOT_PROVED.code
    ends = tuple(
        end_at_dead_point(model, turn, walk.curve.legs[turn.leg].led, lead, certify, joined)
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


def _asked_on(branch: CurveBranch, asked: Asked, parameter: int, free: bool) -> Asked:
    """The rows of the table that lie on a branch, in the direction of travel.

    With a freely turning input a row is met once in every turn.
    """
    low, high = branch.range(parameter)
    turns = np.zeros(1)
    if free:
        first = np.ceil((low - asked.t.max()) / _FULL_TURN)
        last = np.floor((high - asked.t.min()) / _FULL_TURN)
        turns = np.arange(first, last + 1.0)
    t = (asked.t[None, :] + turns[:, None] * _FULL_TURN).ravel()
    row = np.tile(np.arange(len(asked.t)), len(turns))
    inside = np.flatnonzero((t >= low) & (t <= high))
    order = inside[np.argsort(branch.side * t[inside], kind="stable")]
    if len(order):  # 0 and 360 degrees are one row here
        keep = np.concatenate([[True], np.abs(np.diff(t[order])) > 1e-12])
        order = order[keep]
    everyday = asked.everyday[row[order]]
    return Asked(t=t[order], inputs=asked.inputs[row[order]], everyday=everyday)
