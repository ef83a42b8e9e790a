"""The rows right before a dead point, where the input leads the motion no longer well.

There the position is found with the variable that leads through the dead point: its value at which
the input has the value asked for.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd
from linkwork.motion.rows import SolvedRows
from linkwork.numerics.divided_steps import sign_change
from linkwork.numerics.proof import prove
from linkwork.numerics.proven_curve import same_solution
from linkwork.numerics.track import Track
from linkwork.numerics.turning_point import TurnAhead

__all__ = ["fill_last_rows"]

_UNIT = np.finfo(float).eps
_SAME = 1e-6  # weighted: a position moves no further when its input is made exact


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
        if end.ahead is None or not end.ahead.located:
            continue
        edge = track.last_t if end.side > 0 else track.first_t
        for row, here in _between(t, np.isnan(placed), edge, end, drive.free):
            if _fill(drive, end, end.ahead, here, row, rows):
                placed[row] = here


def _between(
    t: Array, missing: BoolArray, edge: float, end: BranchEnd, free: bool
) -> Iterator[tuple[int, float]]:
    """The rows that belong between the edge and the end of a branch, and where."""
    middle = 0.5 * (edge + end.t)
    turns = np.round((middle - t) / FULL_TURN) if free else np.zeros(len(t))
    here = t + turns * FULL_TURN
    inside = missing & (end.side * (here - edge) > 0.0) & (end.side * (end.t - here) > 0.0)
    for row in np.flatnonzero(inside):
        yield int(row), float(here[row])


def _fill(
    drive: Drive, end: BranchEnd, ahead: TurnAhead, t: float, row: int, rows: SolvedRows
) -> bool:
    """Solve one row at a value of the path; whether it was found."""
    solver, p = drive.solver, drive.leads.parameter
    v = _position(drive, ahead, t)
    if v is None:
        return False
    here = v[None, :]
    rates = solver.rates(here, drive.path.rate)
    where = np.array([row])
    rows.v[where], rows.first[where], rows.second[where] = here, rates.first, rates.second
    rows.status[where] = Status.CONVERGED.code
    rows.residual[where], rows.condition[where] = solver.residual(here), rates.condition
    if rows.certification[row] == Certification.NOT_ASKED.code:
        return True
    own = drive.leads.by(p)
    rounding = 4.0 * _UNIT * np.abs(here[:, solver.unknowns :])
    proof = None if own is None or not own.provable else prove(solver, here, rounding)
    if proof is None or own is None:
        rows.certification[where] = Certification.NO_BOUND.code
    elif not (proof.holds[0] and same_solution(ahead.leg.led, own, v)):
        rows.certification[where] = Certification.POSITION_NOT_PROVED.code
    else:
        rows.certification[where] = end.certification.code
        rows.radius[where], rows.unique[where] = proof.radius, proof.alone_within
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
        if found.status[0] == Status.CONVERGED.code and moved < _SAME:
            after = drive.solver.rates(found.v, drive.path.rate).orientation
            if np.array_equal(side, after):
                return np.asarray(found.v[0])
        return v
    return None
