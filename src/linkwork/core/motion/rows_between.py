"""Solved rows as a motion: every quantity by its name, in file units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.statuses import CONVERGED, Certification, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import (
    FITS,
    Model,
    has_corners,
    largest_misfits,
    leading_input,
    misfit,
)
from linkwork.core.motion.positions import RowValues, name_series
from linkwork.core.numerics.branch_tracking import (
    Track,
    follow,
    node_at,
    quintic,
    rows_of_nodes,
    rows_on_track,
)
from linkwork.core.numerics.newton import unlimited
from linkwork.core.numerics.position_proof import roots_proved
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.results.limit import Limit
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
