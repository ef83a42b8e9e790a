"""Rows close to dead points and change points, where the input is a poor parameter.

Before a dead point the position is found with the variable that leads through it: its value at
which the input has the value asked for. Around change points it lies on the way across them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.rounding import EPSILON, LARGEST_POLISH
from linkwork.core.foundation.statuses import Certification, ChangePointPolicy, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import Drive, track_to
from linkwork.core.motion.limits import BranchEnd, end_at_change_point, ends_of
from linkwork.core.motion.positions import inputs_apart, nodes_around, prove_rows
from linkwork.core.motion.whole_turns import Lap, lap_of
from linkwork.core.numerics.block_solver import FEW
from linkwork.core.numerics.branch_tracking import (
    BOLD,
    Node,
    Track,
    TrackOptions,
    follow,
    rows_on_track,
)
from linkwork.core.numerics.curve_proof import same_solution
from linkwork.core.numerics.curve_tracing import sign_change
from linkwork.core.numerics.local_parametrization import Parametrization
from linkwork.core.numerics.passage import Passage, pass_change_points
from linkwork.core.numerics.position_proof import Proof, prove
from linkwork.core.numerics.proved_rows import proved_rows
from linkwork.core.numerics.system import Columns, SolvedRows
from linkwork.core.numerics.turning_point import TurnAhead


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


# ----------------------------------------------------------------------
# Continue beyond change points by a policy: straight on, or onto the other branch.


def beyond_change_point(drive: Drive, end: BranchEnd, policy: ChangePointPolicy) -> Passage | None:
    """The way across the change point at the end of a branch, and others right after it.

    ``None`` if the chosen branch keeps the input, or a loop is not known to be on it.
    """
    if policy is not ChangePointPolicy.TURN or not end.crossings:
        return end.passage
    return pass_change_points(drive.solver, drive.path, end.nodes, end.t, end.side, turn=True)


def ends_passed(drive: Drive, end: BranchEnd, passage: Passage, certify: bool) -> list[BranchEnd]:
    """The change points on a way, the first one of which is the end of a branch."""
    return [
        end,
        *(
            end_at_change_point(drive, group, *passage.position(group[0].t), end.side, certify)
            for group in passage.crossings[1:]
        ),
    ]


# ----------------------------------------------------------------------
# The rows of a table that lie on one branch: followed, solved, proved.


class Asked(Columns):
    """Rows that are asked for: values ``t`` (B,) of the path, the inputs in internal units (B, p)
    and as they are named (B, p).
    """

    t: Array
    inputs: Array
    in_file_units: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class BranchRows:
    """The rows asked for, those that lie on the branch filled; the branch's track and its ends.

    ``placed`` (B,): where on the track each row lies, or laps earlier, NaN if nowhere. ``lap``: if
    the motion repeats itself and laps were left out; ``lap_proved``: whether a lap leads back.
    """

    rows: SolvedRows
    track: Track
    placed: Array
    ends: tuple[BranchEnd, ...]
    proved_to_ends: bool
    lap: Lap | None = None
    lap_proved: bool = False

    @property
    def here(self) -> BoolArray:
        """Which rows lie on the branch, (B,)."""
        return ~np.isnan(self.placed)

    @property
    def converged(self) -> BoolArray:
        """Which of them were found, (B,)."""
        converged: BoolArray = self.rows.status == Status.CONVERGED.code
        return self.here & converged


class Report:
    """Progress as a fraction: tracking, rows and proofs take about a third each."""

    def __init__(
        self, progress: Callable[[float], None] | None, start: float, low: float, high: float
    ) -> None:
        self.progress = progress
        self.start = start
        self.span = max(high, start) - min(low, start) or 1.0

    def tracked(self, t: float) -> None:
        """A step of the track has arrived at t."""
        if self.progress is not None:
            self.progress(min(1.0, abs(t - self.start) / self.span) / 3.0)

    def solved(self, fraction: float) -> None:
        """A fraction of the rows is done."""
        if self.progress is not None:
            self.progress((1.0 + fraction) / 3.0)

    def proved(self, fraction: float) -> None:
        """A fraction of the rows is proved."""
        if self.progress is not None:
            self.progress((2.0 + fraction) / 3.0)


def rows_of_branch(
    drive: Drive,
    anchor: Node,
    asked: Asked,
    report: Report,
    certify: bool,
    passage: Passage | None = None,
) -> BranchRows:
    """Follow the branch of ``anchor`` over the values asked for and solve those that lie on it.

    Many turns of a motion that repeats itself are followed once. With a ``passage`` that led to the
    anchor the branch is followed onwards only.
    """
    lap = lap_of(drive, anchor, asked.t) if passage is None else None
    once = None if lap is None else _rows_of_laps(lap, asked, report, certify)
    return once or _rows_followed(drive, anchor, asked, report, certify, passage)


def _rows_of_laps(lap: Lap, asked: Asked, report: Report, certify: bool) -> BranchRows | None:
    """The rows solved in the first lap; ``None`` if the branch ends there after all."""
    drive = lap.drive
    number = lap.number_of(asked.in_file_units[:, 0])
    nearer = lap.nearer(asked.in_file_units[:, 0], number)
    t = np.append(nearer * drive.unit, lap.end.t)  # the last row closes the lap
    once = Asked(
        t=t,
        inputs=np.append(lap.intended(nearer), lap.end.t)[:, None],
        in_file_units=np.append(nearer, np.nan)[:, None],
    )
    found = _rows_followed(drive, lap.begin, once, report, certify, None)
    if found.ends:
        return None
    rows, closing = found.rows.take(slice(-1)), found.rows.take(slice(-1, None))
    proved = lap.leads_back(closing)
    rows = lap.after(rows, number, proved).with_columns(inputs=asked.in_file_units.copy())
    return replace(found, rows=rows, placed=found.placed[:-1], lap=lap, lap_proved=proved)


def _rows_followed(
    drive: Drive,
    anchor: Node,
    asked: Asked,
    report: Report,
    certify: bool,
    passage: Passage | None,
) -> BranchRows:
    """The track is bold first; where that leaves rows unproved it is followed again with care."""
    # without proofs nothing would show that a bold track has left its branch
    tries = (BOLD, None) if certify and drive.solver.is_provable else (None,)
    for care in tries:
        track = _covering(drive, anchor, asked.t, care, report, passage)
        placed = _place_rows(track, asked.t, drive.free)
        work = _RowSolver(
            drive=drive, track=track, placed=placed, asked=asked, report=report, certify=certify
        )
        rows, to_ends = work.solve()
        if care is None or not _doubtful(rows, placed, to_ends):
            break
    ends = ends_of(drive, track, certify)
    # the dead points were found from the last nodes, which are not proved to be on this branch
    if not to_ends:
        ends = tuple(end.demote(Certification.MOTION_NOT_PROVED) for end in ends)
    rows = fill_last_rows(drive, track, ends, asked.t, placed, rows)
    if passage is not None:
        rows = fill_passed_rows(drive, passage, asked.t, placed, rows)
    rows = _mark_missing(rows, track, asked.t, np.isnan(placed), ends)
    return BranchRows(rows=rows, track=track, placed=placed, ends=ends, proved_to_ends=to_ends)


def _blank(drive: Drive, asked: Asked, certify: bool) -> SolvedRows:
    """Rows without positions."""
    grade = Certification.NO_POSITION if certify else Certification.NOT_ASKED
    variables = drive.solver.variables
    return SolvedRows.blank(asked.in_file_units, variables, Status.CONVERGED, grade)


def _doubtful(rows: SolvedRows, placed: Array, to_ends: bool) -> bool:
    """Whether a bold track left rows that are on it unproved."""
    there = ~np.isnan(placed)
    unproved_rows = rows.certification[there] != Certification.CERTIFIED.code
    return bool(unproved_rows.any()) or not to_ends


def _covering(
    drive: Drive,
    anchor: Node,
    t: Array,
    care: TrackOptions | None,
    report: Report,
    passage: Passage | None,
) -> Track:
    """A track over the table's range, wound on the other way where a limit cuts it short."""
    solver, path = drive.solver, drive.path
    low, high = float(t.min()), float(t.max())
    if passage is not None:  # the way back leads to the change point
        goals = [t for t in (low, high) if passage.side * (t - anchor.t) >= 0.0]
        return track_to(solver, path, anchor, goals, care, report.tracked)
    track = track_to(solver, path, anchor, [low, high], care, report.tracked)
    if not drive.free:
        return track
    # the other way around, from the end of the track there
    if track.above is not None and track.below is None:
        goal = float((t - _turns_above(t, track.last_t) * FULL_TURN).min())
        if goal < track.first_t:
            nodes, end = follow(solver, path, track.nodes[0], goal, care)
            return replace(
                track,
                nodes=(*reversed(nodes), *track.nodes),
                start=len(nodes) + track.start,
                below=end,
            )
    if track.below is not None and track.above is None:
        goal = float((t + _turns_above(track.first_t, t) * FULL_TURN).max())
        if goal > track.last_t:
            nodes, end = follow(solver, path, track.nodes[-1], goal, care)
            return replace(track, nodes=(*track.nodes, *nodes), above=end)
    return track


def _turns_above(t: Array | float, edge: Array | float) -> Array:
    """How many whole turns down bring values that lie above an edge to it or below."""
    turns: Array = np.maximum(np.ceil((np.asarray(t) - edge) / FULL_TURN), 0.0)
    return turns


def _place_rows(track: Track, t: Array, free: bool) -> Array:
    """Where on the track each row lies, whole turns apart if need be; NaN if nowhere."""
    moved = t
    if free:
        # up to the lower end or down to the upper one, whichever is needed: never both
        turns = _turns_above(track.first_t, t) - _turns_above(t, track.last_t)
        moved = t + turns * FULL_TURN
    return np.where((moved >= track.first_t) & (moved <= track.last_t), moved, np.nan)


@dataclass(frozen=True, kw_only=True, eq=False)
class _RowSolver:
    """Rows to be solved on a track; ``placed`` (B,): where on it each of them lies, or NaN."""

    drive: Drive
    track: Track
    placed: Array
    asked: Asked
    report: Report
    certify: bool

    def solve(self) -> tuple[SolvedRows, bool]:
        """All rows that lie on the track, and whether the track is proved up to its ends."""
        there = np.flatnonzero(~np.isnan(self.placed))
        # in the order of the path: proofs join neighbours
        there = there[np.argsort(self.placed[there], kind="stable")]
        solver, path, track = self.drive.solver, self.drive.path, self.track
        blank = _blank(self.drive, self.asked, self.certify)
        if not len(there):
            return blank, self.certify
        if self.certify and solver.is_recorded and len(there) > FEW:
            proved = self._at_once(there)
            if proved is not None:
                self.report.proved(1.0)
                return self._placed_in(blank, there, proved), True
        rows, to_ends = rows_on_track(solver, path, track, self.placed[there]), False
        self.report.solved(1.0)
        if self.certify:
            asked = self.asked.inputs[there]
            rows, to_ends = prove_rows(solver, path, track, rows, asked)
            self.report.proved(1.0)
        return self._placed_in(blank, there, rows), to_ends

    def _placed_in(self, blank: SolvedRows, there: IndexArray, rows: SolvedRows) -> SolvedRows:
        """The table with some rows; most often these are all of it, in its order."""
        if len(there) == len(blank) and (np.diff(there) == 1).all():
            names = blank.columns.keys() & rows.columns.keys()
            return blank.with_columns(**{name: getattr(rows, name) for name in names})
        return blank.put(there, rows)

    def _at_once(self, there: IndexArray) -> SolvedRows | None:
        """Rows in the order of the track, all proved; ``None`` where one is not."""
        t = self.placed[there]
        inputs, asked = self.drive.path.at(t), self.asked.inputs[there]
        joined = np.array(nodes_around(self.track, t), dtype=np.intp)
        apart = inputs_apart(inputs, asked)
        solver, path = self.drive.solver, self.drive.path
        return proved_rows(solver, path, self.track.nodes, joined, t, inputs, apart)


def _mark_missing(
    rows: SolvedRows, track: Track, t: Array, missing: BoolArray, ends: tuple[BranchEnd, ...]
) -> SolvedRows:
    """Give rows that are nowhere on the track the status of the limit on the way to them."""
    if not (ends and missing.any()):
        return rows
    lower = ends[0] if track.below is not None else ends[-1]
    upper = ends[-1] if track.above is not None else ends[0]
    status = rows.status.copy()
    status[missing & (t < track.first_t)] = lower.limit.status.code
    status[missing & (t > track.last_t)] = upper.limit.status.code
    return rows.with_columns(status=status)
