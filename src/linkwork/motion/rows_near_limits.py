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
from linkwork.numerics.continuation.branch_tracking import Node, Track
from linkwork.numerics.continuation.curve_proof import same_solution
from linkwork.numerics.continuation.local_parametrization import Parametrization
from linkwork.numerics.continuation.passage import Passage
from linkwork.numerics.continuation.step_division import sign_change
from linkwork.numerics.continuation.turning_point import TurnAhead
from linkwork.numerics.proof.position_proof import Proof, prove
from linkwork.numerics.rows import SolvedRows

__all__ = ["fill_last_rows", "fill_passed_rows"]


def fill_last_rows(
    drive: Drive,
    track: Track,
    ends: tuple[BranchEnd, ...],
    t: Array,
    placed: Array,
    rows: SolvedRows,
) -> SolvedRows:
    """Fill the rows between a track's outermost nodes and the dead points beyond them.

    ``t`` (B,): values asked for. ``placed`` (B,): where on the branch each row lies, NaN for those
    that were not found; it gets the values of the rows that are found here.
    """
    certify = rows.asks_for_proofs
    found: dict[int, SolvedRows] = {}
    for end in ends:
        edge = track.last_t if end.side > 0 else track.first_t
        for row, here in _between(t, np.isnan(placed), edge, end.t, drive.free):
            solved = None
            if end.passage is not None:
                why = Certification.MOTION_NOT_PROVED
                solved = _passed_row(drive, end.passage, here, why, certify)
            elif end.ahead is not None:
                solved = _row_ahead(drive, end, end.ahead, here, certify)
            if solved is not None:
                found[row], placed[row] = solved, here
    return _put_each(rows, found)


def fill_passed_rows(
    drive: Drive, passage: Passage, t: Array, placed: Array, rows: SolvedRows
) -> SolvedRows:
    """Fill the rows between the first change point on a way and its end."""
    begin, end = passage.crossings[0][0].t, passage.node.t
    certify, why = rows.asks_for_proofs, Certification.BRANCH_CHOSEN
    found: dict[int, SolvedRows] = {}
    for row, here in _between(t, np.isnan(placed), begin, end, False):
        found[row], placed[row] = _passed_row(drive, passage, here, why, certify), here
    return _put_each(rows, found)


def _put_each(rows: SolvedRows, found: dict[int, SolvedRows]) -> SolvedRows:
    """The rows with some replaced, each by its number."""
    if not found:
        return rows
    return rows.put(np.array(list(found)), SolvedRows.concatenate(list(found.values())))


def _between(
    t: Array, missing: BoolArray, a: float, b: float, free: bool
) -> Iterator[tuple[int, float]]:
    """The rows that belong between two values of t, and where."""
    turns = np.round((0.5 * (a + b) - t) / FULL_TURN) if free else np.zeros(len(t))
    here = t + turns * FULL_TURN
    inside = missing & (here > min(a, b)) & (here < max(a, b))
    for row in np.flatnonzero(inside):
        yield int(row), float(here[row])


def _passed_row(
    drive: Drive, passage: Passage, t: float, standing: Certification, certify: bool
) -> SolvedRows:
    """One row on the way across change points.

    Next to a crossing positions are too ill-conditioned for Newton-Raphson to improve them;
    elsewhere it does, and stays at the only root nearby.
    """
    v = passage.position(t)[0]
    row, proof = _row_at(drive, v, True)
    if proof is not None:
        done = drive.solver.solve(v[None, :])
        moved = np.abs((done.v[0] - v) / drive.solver.variable_scale).max()
        if done.status[0] == Status.CONVERGED.code and moved < proof.least_uniqueness_radius[0]:
            row, proof = _row_at(drive, done.v[0], True)
    if not certify:
        return row.set(
            certification=Certification.NOT_ASKED.code, radius=np.nan, uniqueness_radius=np.nan
        )
    return _with_proof(row, proof, standing) if proof is not None else row


def _row_at(drive: Drive, v: Array, certify: bool) -> tuple[SolvedRows, Proof | None]:
    """A position (N,) as a row, not proved yet; its proof, ``None`` if there is none."""
    solver, here = drive.solver, v[None, :]
    why = Certification.POSITION_NOT_PROVED if certify else Certification.NOT_ASKED
    row = solver.rates(here, drive.path.rate).with_columns(
        status=np.array([Status.CONVERGED.code], dtype=np.int8),
        residual=solver.residual(here),
        certification=np.array([why.code], dtype=np.int8),
        radius=np.array([np.nan]),
        uniqueness_radius=np.array([np.nan]),
    )
    if not (certify and solver.is_provable):
        return row, None
    proof = prove(solver, here, 4.0 * EPSILON * np.abs(here[:, solver.unknowns :]))
    return row, proof if proof.holds[0] else None


def _with_proof(row: SolvedRows, proof: Proof, standing: Certification) -> SolvedRows:
    return row.set(
        certification=standing.code,
        radius=proof.radius,
        uniqueness_radius=proof.least_uniqueness_radius,
    )


def _row_ahead(
    drive: Drive, end: BranchEnd, ahead: TurnAhead, t: float, certify: bool
) -> SolvedRows | None:
    """One row between the track and a dead point, at a value of the path; ``None`` if it was not
    found.
    """
    found = _position(drive, ahead, t) if ahead.located else None
    if found is None:
        return None
    v, led = found
    row, proof = _row_at(drive, v, certify)
    own = drive.leads.with_parameter(drive.leads.parameter)
    if proof is not None and own is not None and same_solution(led, own, v):
        return _with_proof(row, proof, end.certification)
    return row


def _position(drive: Drive, ahead: TurnAhead, t: float) -> tuple[Array, Parametrization] | None:
    """The position (N,) on the way to a dead point with a value of the path, and its leader."""
    p = drive.leads.parameter
    steps = ((leg.led, *ends) for leg in ahead.legs for ends in itertools.pairwise(leg.nodes))
    for led, low, high in steps:
        place = led.place(p)
        if (low.v[place] - t) * (high.v[place] - t) > 0.0:
            continue

        def beyond(here: Node, place: int = place) -> float:
            return float(here.v[place]) - t

        node = sign_change(led, low, high, beyond, to_rounding=True)
        v = led.whole(node.v)
        side = drive.solver.rates(v[None, :], drive.path.rate).orientation
        v[drive.solver.unknowns :] = drive.path.at(t)
        found = drive.solver.solve(v[None, :])
        moved = np.abs((found.v[0] - v) / drive.solver.variable_scale).max()
        if found.status[0] == Status.CONVERGED.code and moved < LARGEST_POLISH:
            after = drive.solver.rates(found.v, drive.path.rate).orientation
            if np.array_equal(side, after):
                return found.v[0], led
        return v, led
    return None
