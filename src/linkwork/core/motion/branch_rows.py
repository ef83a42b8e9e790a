"""Solved rows as a motion: every quantity by its name, in file units."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, LARGEST_POLISH, Array, BoolArray, IndexArray
from linkwork.core.foundation.statuses import CONVERGED, Certification, ChangePointPolicy, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import Drive, Lap, lap_of, track_to
from linkwork.core.motion.limits import BranchEnd, end_at_change_point, ends_of
from linkwork.core.motion.model import (
    FITS,
    Model,
    has_corners,
    largest_misfits,
    leading_input,
    misfit,
)
from linkwork.core.motion.positions import (
    RowValues,
    inputs_apart,
    name_series,
    nodes_around,
    prove_rows,
)
from linkwork.core.numerics.block_solver import FEW
from linkwork.core.numerics.branch_tracking import (
    BOLD,
    Node,
    Parametrization,
    Track,
    TrackOptions,
    follow,
    node_at,
    quintic,
    rows_of_nodes,
    rows_on_track,
)
from linkwork.core.numerics.curve_tracing import sign_change
from linkwork.core.numerics.newton import Columns, SolvedRows, unlimited
from linkwork.core.numerics.passage import Passage, pass_change_points
from linkwork.core.numerics.path_proof import same_solution
from linkwork.core.numerics.position_proof import Proof, prove, roots_proved
from linkwork.core.numerics.proved_rows import proved_rows
from linkwork.core.numerics.turning_point import TurnAhead
from linkwork.core.results.failure import Limit
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import CLOSE_ROWS
from linkwork.core.results.quantity import Kind


def motion_of_rows(model: Model, rows: SolvedRows, message: str, added: BoolArray) -> Motion:
    """Name the columns of solved rows; ``added`` marks rows that were not asked for."""
    rows = fitting(model, rows)
    found = rows.status == Status.CONVERGED.code
    named = name_series(model, rows.v, rows.first, rows.second, rows.inputs, found)
    return Motion(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        quantities=model.quantities,
        inputs=named.inputs,
        input_units=model.input_units,
        derivative_unit=model.derivative_unit,
        unknowns=named.unknowns,
        links=named.links,
        riding=model.riding,
        sliders=named.sliders,
        points=named.points,
        outputs=named.outputs,
        status=Status.of_codes(rows.status),
        message=message,
        residual=rows.residual,
        iterations=rows.iterations,
        condition=rows.condition,
        certification=Certification.of_codes(rows.certification),
        radius=rows.radius,
        unique_within=rows.uniqueness_radius,
        branch=tuple(rows.branch),
        limit=tuple(rows.limit),
        added=added,
        speed=model.speed,
        redundant=largest_misfits(model.equations, rows.v),
        q=rows.v[:, : model.compiled.solver.unknowns],
    )


def fitting(model: Model, rows: SolvedRows) -> SolvedRows:
    """Rows with evidence of a position: roots of formulas are proved, redundant links fit."""
    if model.compiled.solver.has_formulas:
        open_ = np.flatnonzero((rows.status == Status.CONVERGED.code) & np.isnan(rows.radius))
        lost = open_[~roots_proved(model.compiled.solver, rows.v[open_])]
        rows = _without(rows, lost, Status.ROOT_NOT_PROVED)
    if has_corners(model.equations):
        rows = rows.demote(Certification.MOTION_NOT_PROVED)
    if not model.equations.redundant:
        return rows
    fits = misfit(model.equations, rows.v) <= FITS
    lost = np.flatnonzero((rows.status == Status.CONVERGED.code) & ~fits)
    rows = _without(rows, lost, Status.DOES_NOT_FIT)
    return rows.demote(Certification.SUBSET_CERTIFIED)


def _without(rows: SolvedRows, lost: IndexArray, status: Status) -> SolvedRows:
    """The rows without the positions of some, all for one reason."""
    nothing = SolvedRows.blank(rows.inputs[lost], rows.v.shape[1], status)
    return rows.put(lost, nothing)


def message_of(motion: Motion, model: Model) -> str:
    """The message of the start if all rows were found, else every limit once."""
    asked = motion.asked
    missing = int((asked & ~motion.found).sum())
    if not missing:
        return motion.message
    name, unit = next(iter(motion.input_units.items()))
    told = (
        f"{limit.kind.word} at {limit.told(name, unit)}{_driven_to(motion, model, limit)}"
        for limit in motion.limits
    )
    misses = [status.value for status in motion.counts if not status.ok]
    return "; ".join(
        [f"{missing} of {int(asked.sum())} positions were not found", *misses, *dict.fromkeys(told)]
    )


def _driven_to(motion: Motion, model: Model, limit: Limit) -> str:
    """The values of the inputs at a limit that a law of time leads to."""
    if model.untimed is None:
        return ""
    row = int(np.argmin(np.abs(motion.inputs[next(iter(motion.inputs))] - limit.input)))
    names = [variable.name for variable in model.untimed.equations.inputs]
    values = [
        f"{name} = {motion[name][row]:.10g} {motion.quantity(name).unit}".rstrip() for name in names
    ]
    return (
        f", {', '.join(values)}" if np.isfinite([motion[name][row] for name in names]).all() else ""
    )


# ----------------------------------------------------------------------
# Positions between the rows of a motion, on its branch.


_NODES = 720  # of longer tables not all rows are needed


def between_rows(model: Model, motion: Motion) -> Callable[[Array], RowValues]:
    """A function of the leading input (B,), in radians or lengths, between two rows of a motion.

    All rows must have positions. A place that its neighbours do not lead to has none.
    """
    values = [np.asarray(motion.inputs[v.name]) for v in model.equations.inputs]
    inputs = np.column_stack(values) * model.input_scale
    lead, rate = leading_input(model.rows)
    drive = Drive.through(model, inputs[0], rate, lead)
    order = np.argsort(inputs[:, lead], kind="stable")
    kept = order[np.unique(np.linspace(0, len(order) - 1, _NODES).astype(np.intp))]
    v, solver, path = np.hstack([motion.q, inputs]), drive.solver, drive.path
    nodes = (node_at(solver, path, float(inputs[k, lead]), v[k]) for k in kept)
    track = Track(nodes=tuple(nodes), start=0)

    def at(t: Array) -> RowValues:
        rows = rows_on_track(solver, path, track, t)
        good = rows.status == Status.CONVERGED.code
        return RowValues(model, rows.v, rows.first, rows.second, good)

    return at


# ----------------------------------------------------------------------
# Positions between neighbouring rows of a motion.


_MOVED = 0.1  # weighted: further from the interpolation a position may be on another branch
# from the straight line between two rows; on another turn positions are farther
_REACH = 1.0  # weighted
_REACH_OF_CHANGE = 0.5  # in addition, of what changes between the rows
_OF_PIECE = 5  # rows in a piece of a cam or law
_MOST_PARTS = 3600  # of the table
_SAME_TURN = 1.0  # of the leading input: rows named whole turns away differ by more


@dataclass(frozen=True, eq=False)
class RowsBetween:
    """Solves positions between the rows of a motion, each on the branch of its neighbours."""

    model: Model
    rows: SolvedRows

    @cached_property
    def _drive(self) -> Drive:
        lead, rate = leading_input(self.model.rows)
        return Drive.through(self.model, self.model.rows[0], rate, lead)

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """The leading input of the positions and as rows name it, (R,) [rad or length]."""
        drive, rows = self._drive, self.rows
        t = rows.v[:, drive.solver.unknowns + drive.lead]
        return t, rows.inputs[:, drive.lead] * drive.unit

    @cached_property
    def _regular(self) -> BoolArray:
        """Rows with rates, (R,)."""
        rows = self.rows
        parts = (rows.v, rows.first, rows.second)
        regular: BoolArray = np.all([np.isfinite(part).all(axis=1) for part in parts], axis=0)
        regular &= rows.status == CONVERGED
        return regular

    @cached_property
    def joined(self) -> BoolArray:
        """Whether a row and the next one are neighbours on one branch, (R - 1,)."""
        (t, named), found, branch = self._places, self.rows.status == CONVERGED, self.rows.branch
        regular = self._regular
        with np.errstate(invalid="ignore"):
            near = np.abs(np.diff(named - t)) < _SAME_TURN
            apart = np.diff(t) != 0.0
        one = near & apart & (branch[1:] == branch[:-1])
        joined: BoolArray = one & found[1:] & found[:-1] & (regular[1:] | regular[:-1])
        return joined

    @cached_property
    def switches(self) -> Array:
        """Where rows just beside switches of loads would be, as rows name them, rising, (K,)."""
        t = self._places[1]
        if not self.joined.all() or len(t) < 2:
            return np.zeros(0)
        order = np.argsort(t, kind="stable")
        rising = t[order]

        def at(places: Array) -> Motion:
            k = np.clip(rising.searchsorted(places, side="right") - 1, 0, len(t) - 2)
            return self(np.minimum(order[k], order[k + 1]), places)

        return self.model.beside_switches(at, rising)

    @cached_property
    def far(self) -> float:
        """The largest step that shows all extremes of smooth quantities [rad or length]."""
        model, span = self.model, float(np.ptp(self._places[1]))
        description, numbers = model.description, model.description.numbers
        kind = Kind(model.equations.inputs[self._drive.lead].kind)
        if description.timed:
            laws = [which.law for which in description.inputs if isinstance(which.law, tuple)]
            pieces = [segment.duration(numbers) for law in laws for segment in law]
        else:
            cams = [getattr(part, "segments", ()) for part in getattr(description, "parts", ())]
            unit = description.angle.radians if kind is Kind.ANGLE else np.inf
            pieces = [numbers(segment.over) * unit for cam in cams for segment in cam]
        whole = FULL_TURN if kind is Kind.ANGLE else span
        least = max(min(pieces, default=np.inf) / _OF_PIECE, span / _MOST_PARTS)
        return min(whole / CLOSE_ROWS, least)

    def __call__(self, row: IndexArray, at: Array) -> Motion:
        """Positions at leading inputs (K,) between rows (K,) and the next ones.

        Rows that lead to none have the status of a lost branch.
        """
        solver, rows = self._drive.solver, self.rows
        t, named = self._places
        here = t[row] + (at - named[row])
        found = SolvedRows.blank(
            self._inputs(row, here), solver.variables, Status.LOST, Certification.NOT_ASKED
        )
        smooth = np.flatnonzero(self._regular[row] & self._regular[row + 1])
        if len(smooth):
            found = found.put(smooth, self._interpolated(row[smooth], here[smooth]))
        left = np.flatnonzero(found.status != CONVERGED)
        found = found.put(*self._followed(left, row[left], here[left]))
        found = found.set(branch=rows.branch[row])
        return motion_of_rows(self.model, found, "", np.ones(len(row), dtype=bool))

    def _followed(
        self, number: IndexArray, row: IndexArray, here: Array
    ) -> tuple[IndexArray, SolvedRows]:
        """Positions followed from rows with rates, one after the other; those that were reached,
        by their numbers.
        """
        (t, _), drive, rows = self._places, self._drive, self.rows
        begin = np.where(self._regular[row], row, row + 1)
        reached, nodes = [], []
        node, last = None, -1
        for k in np.lexsort((np.abs(here - t[begin]), begin)).tolist():
            if node is None or begin[k] != last:
                last = int(begin[k])
                node = node_at(drive.solver, drive.path, float(t[last]), rows.v[last])
            track, end = follow(drive.solver, drive.path, node, float(here[k]))
            if end is None:
                node = track[-1] if track else node
                reached.append(k)
                nodes.append(node)
        if not nodes:
            return number[:0], rows.take(slice(0))
        solved = rows_of_nodes(nodes)
        found = solved.with_columns(
            status=np.full(len(nodes), CONVERGED, dtype=np.int8),
            condition=np.array([node.condition for node in nodes]),
        )
        return number[reached], found

    def _inputs(self, row: IndexArray, here: Array) -> Array:
        """All inputs as neighbouring rows name them, (K, p) file units."""
        t, rate = self._places[0], self._drive.path.rate
        away = (here - t[row])[:, None] * rate / self.model.input_scale
        return np.asarray(self.rows.inputs[row] + away)

    def _interpolated(self, row: IndexArray, here: Array) -> SolvedRows:
        """Positions from quintics between rows; lost where they may be on another branch."""
        drive, solver, rows, t = self._drive, self._drive.solver, self.rows, self._places[0]
        h = (t[row + 1] - t[row])[:, None]
        left, right = rows.take(row), rows.take(row + 1)
        guess = quintic((here - t[row])[:, None] / h, h, left, right)
        guess[:, solver.unknowns :] = drive.path.at(here)
        tolerance = solver.options.solution_tolerance
        done = solver.solve(guess, unlimited(solver.options, 12, tolerance))
        rates = solver.rates(done.v, drive.path.rate)
        expected = solver.rates(left.v, drive.path.rate).orientation
        moved = np.abs((done.v - guess) / solver.variable_scale).max(axis=1)
        good = (done.status == CONVERGED) & (moved <= _MOVED)
        good &= (rates.orientation == expected).all(axis=1)
        away = np.abs(done.v - left.v - (here - t[row])[:, None] / h * (right.v - left.v))
        scale = solver.variable_scale
        good &= (away <= _REACH * scale + _REACH_OF_CHANGE * np.abs(right.v - left.v)).all(axis=1)
        return SolvedRows(
            v=done.v,
            first=rates.first,
            second=rates.second,
            condition=rates.condition,
            residual=done.residual,
            iterations=done.iterations,
            status=np.where(good, CONVERGED, Status.LOST.code).astype(np.int8),
        )


# ----------------------------------------------------------------------
# Rows close to dead points and change points, where the input is a poor parameter.
#
# Before a dead point the position is found with the variable that leads through it: its value at
# which the input has the value asked for. Around change points it lies on the way across them.


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
