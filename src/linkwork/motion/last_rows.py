"""Rows close to dead points and change points, where the input is a poor parameter.

Before a dead point the position is found with the variable that leads through it: its value at
which the input has the value asked for. Around change points it lies on the way across them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import EPSILON, LARGEST_POLISH
from linkwork.foundation.status import Status
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd
from linkwork.motion.rows import SolvedRows
from linkwork.numerics.continuation.branch_tracking import Track
from linkwork.numerics.continuation.curve_proof import same_solution
from linkwork.numerics.continuation.passage import Passage
from linkwork.numerics.continuation.step_division import sign_change
from linkwork.numerics.continuation.turning_point import TurnAhead
from linkwork.numerics.proof.position_proof import Proof, prove

__all__ = ["fill_last_rows", "fill_passed_rows"]


def fill_last_rows(
    drive: Drive,
    track: Track,
    ends: tuple[BranchEnd, ...],
    t: Array,
    placed: Array,
    rows: SolvedRows,
) -> None:
    """Fill the rows between a track's outermost nodes and the dead points beyond them.

    ``t`` (B,): values asked for. ``placed`` (B,): where on the branch each row lies, NaN for those
    that were not found; it gets the values of the rows that are found here.
    """
    for end in ends:
        edge = track.last_t if end.side > 0 else track.first_t
        for row, here in _between(t, np.isnan(placed), edge, end.t, drive.free):
            if end.passage is not None:
                standing = Certification.MOTION_NOT_PROVED
                _enter_passed(drive, end.passage, here, row, rows, standing)
                placed[row] = here
            elif end.ahead is not None and _fill(drive, end, end.ahead, here, row, rows):
                placed[row] = here


def fill_passed_rows(
    drive: Drive, passage: Passage, t: Array, placed: Array, rows: SolvedRows
) -> None:
    """Fill the rows between the first change point on a way and its end."""
    begin, end = passage.crossings[0][0].t, passage.node.t
    for row, here in _between(t, np.isnan(placed), begin, end, False):
        _enter_passed(drive, passage, here, row, rows, Certification.BRANCH_CHOSEN)
        placed[row] = here


def _between(
    t: Array, missing: BoolArray, a: float, b: float, free: bool
) -> Iterator[tuple[int, float]]:
    """The rows that belong between two values of t, and where."""
    turns = np.round((0.5 * (a + b) - t) / FULL_TURN) if free else np.zeros(len(t))
    here = t + turns * FULL_TURN
    inside = missing & (here > min(a, b)) & (here < max(a, b))
    for row in np.flatnonzero(inside):
        yield int(row), float(here[row])


def _enter_passed(
    drive: Drive, passage: Passage, t: float, row: int, rows: SolvedRows, standing: Certification
) -> None:
    """Enter one row on the way across change points, where positions are too ill-conditioned for
    Newton-Raphson to improve them.
    """
    v = passage.position(t)[0]
    proof = _enter(drive, v, row, rows)
    if proof is not None and proof.holds[0]:
        rows.certification[row] = standing.code
        rows.radius[row], rows.uniqueness_radius[row] = (
            proof.radius[0],
            proof.least_uniqueness_radius[0],
        )


def _enter(drive: Drive, v: Array, row: int, rows: SolvedRows) -> Proof | None:
    """Enter a position (N,) as a row, not proved yet; its proof, ``None`` if there can be none."""
    solver, here = drive.solver, v[None, :]
    rates = solver.rates(here, drive.path.rate)
    rows.v[row], rows.first[row], rows.second[row] = v, rates.first[0], rates.second[0]
    rows.status[row] = Status.CONVERGED.code
    rows.residual[row], rows.condition[row] = solver.residual(here)[0], rates.condition[0]
    if rows.certification[row] == Certification.NOT_ASKED.code:
        return None
    bounded = all(block.system.has_curvature_bound for block in solver.blocks)
    why = Certification.POSITION_NOT_PROVED if bounded else Certification.NO_BOUND
    rows.certification[row] = why.code
    rounding = 4.0 * EPSILON * np.abs(here[:, solver.unknowns :])
    return prove(solver, here, rounding) if bounded else None


def _fill(
    drive: Drive, end: BranchEnd, ahead: TurnAhead, t: float, row: int, rows: SolvedRows
) -> bool:
    """Solve one row at a value of the path; whether it was found."""
    v = _position(drive, ahead, t) if ahead.located else None
    if v is None:
        return False
    proof, own = _enter(drive, v, row, rows), drive.leads.with_parameter(drive.leads.parameter)
    if proof is None or own is None or not proof.holds[0]:
        return True
    if same_solution(ahead.leg.led, own, v):
        rows.certification[row] = end.certification.code
        rows.radius[row], rows.uniqueness_radius[row] = (
            proof.radius[0],
            proof.least_uniqueness_radius[0],
        )
    return True


def _position(drive: Drive, ahead: TurnAhead, t: float) -> Array | None:
    """The position (N,) on the way to a dead point at which the input has a value."""
    led, p = ahead.leg.led, drive.leads.parameter
    place, nodes = led.place(p), ahead.leg.nodes
    for low, high in itertools.pairwise(nodes):
        if (low.v[place] - t) * (high.v[place] - t) > 0.0:
            continue
        node = sign_change(led, low, high, lambda here: float(here.v[place]) - t, sharp=True)
        v = led.whole(node.v)
        side = drive.solver.rates(v[None, :], drive.path.rate).orientation
        v[drive.solver.unknowns :] = drive.path.at(t)
        found = drive.solver.solve(v[None, :])
        moved = np.abs((found.v[0] - v) / drive.solver.variable_scale).max()
        if found.status[0] == Status.CONVERGED.code and moved < LARGEST_POLISH:
            after = drive.solver.rates(found.v, drive.path.rate).orientation
            if np.array_equal(side, after):
                return np.asarray(found.v[0])
        return v
    return None
