"""The equations of many designs of one mechanism: coefficients, and their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from linkwork.core.equations.compiling import phasor_rows
from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import (
    EQUAL_ROWS,
    AnyArray,
    Array,
    BoolArray,
    IndexArray,
    inverses,
    solutions,
)
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.design.derivatives.rows import DifferentiatedRows, taped_speed
from linkwork.design.derivatives.tape import RecordedTape, Tape, TapedNumber
from linkwork.families.building import write_equations


class DesignWriter:
    """The equations of a mechanism on a record, which designs with other numbers follow.

    Parameters
    ----------
    model : Model
    numbers : sequence of VariedNumber
        The numbers that differ from design to design, P.

    Raises
    ------
    NotElementwise
        If the form of the equations depends on a number.
    """

    def __init__(self, model: Model, numbers: Sequence[VariedNumber]) -> None:
        self.model, self._record = model, RecordedTape()
        taped = {q: self._record.number(float(q.of(model.description))) for q in numbers}
        with np.errstate(all="ignore"):
            description = with_numbers(model.description, taped)
            self.equations = write_equations(description)
            self.speed = taped_speed(model, description, self.equations)
        rows = [loop.terms for loop in self.equations.loops]
        self.loops = phasor_rows(
            rows, {x.symbol: k for k, x in enumerate(self.equations.variables)}
        )
        #: Of the terms of loops; plain numbers, too.
        self.coefficients: list[Any] = [term.value for row in rows for term in row]
        recorded = [self.speed, *self.coefficients]
        self.equations.mapped(recorded.append)
        self._numbers = {x.node: x for x in recorded if isinstance(x, TapedNumber)}
        self._record.keep(list(self._numbers.values()))

    def written(self, x: Array) -> WrittenDesigns:
        """The equations of designs (D, P), file units."""
        fine, values = self._record.follow(x.T)
        return WrittenDesigns(
            writer=self, x=x, fine=fine, known=dict(zip(self._numbers, values, strict=True))
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class WrittenDesigns:
    """The equations of D designs that differ in P numbers.

    Parameters
    ----------
    writer : DesignWriter
    x : (D, P)
        File units.
    fine : (D,) bool
        Designs whose equations have the same form as those of the mechanism.
    known : dict
        The writer's numbers by node: values (D,), and derivatives by x, (P, D).
    """

    writer: DesignWriter
    x: Array
    fine: BoolArray
    known: dict[int, tuple[AnyArray, AnyArray]]


# ----------------------------------------------------------------------
# Rows of many designs, each with its own numbers, unknowns and inputs.
#
# F(v, u; p) = 0 holds in each row. Its loops are sums of terms, whose derivatives by variables and
# coefficients are known; the other equations and all quantities are written on a tape.


_ZERO = np.zeros(())


class LaneRows(DifferentiatedRows):
    """Quantities of the rows of D designs, design by design.

    Parameters
    ----------
    designs : WrittenDesigns
    v : (B, N)
        Unknowns, then inputs, internal units; NaN where there is no position.
    slopes : (B, N, K)
        Their derivatives by parameters, of which the first P are the designs' numbers.
    """

    def __init__(self, designs: WrittenDesigns, v: Array, slopes: Array) -> None:
        self.tape, self.solution, self.order = Tape(len(v)), v, 0
        self.designs = designs
        self._given: dict[int, AnyArray] = {}
        self._rows_of: dict[int, Any] = {}
        self._shape = slopes.shape[2], len(v)
        self.taped = designs.writer.equations.mapped(self._spread)
        self._take_quantities(designs.writer.model, np.logical_not(np.isfinite(v).all(axis=1)))
        self.__dict__["speed"] = self._spread(designs.writer.speed)
        numbers = [self._number(v[:, k], slopes[:, k].T) for k in range(v.shape[1])]
        parts = zip(self._symbols, numbers, strict=True)
        self.__dict__["variables"] = {name: Jet(x, _ZERO, _ZERO) for name, x in parts}

    def _number(self, values: AnyArray, rates: AnyArray) -> Any:
        """A number on the tape of the rows."""
        number: Any = self.tape.number(values)
        self._given[number.node] = rates
        return number

    def _spread(self, number: Any) -> Any:
        """A number of the designs in their rows."""
        if not isinstance(number, TapedNumber):
            return number
        if number.node not in self._rows_of:
            value, rate = self.designs.known[number.node]
            each = self._shape[1] // len(value)
            rates = np.zeros(self._shape, dtype=rate.dtype)
            rates[: len(rate)] = np.repeat(rate, each, axis=1)
            self._rows_of[number.node] = self._number(np.repeat(value, each), rates)
        return self._rows_of[number.node]

    def slopes(self, results: Sequence[Any]) -> tuple[Array, Array]:
        """Real results (B, m), and their derivatives by the parameters, (B, m, K)."""
        rates = self.tape.forward(results, self._given)
        values = [np.broadcast_to(getattr(x, "values", x), self._shape[1]) for x in results]
        slopes = [np.broadcast_to(np.real(rate), self._shape) for rate in rates]
        return (
            np.array(values).reshape(len(results), self._shape[1]).T,
            np.array(slopes).reshape(len(results), *self._shape).transpose(2, 0, 1),
        )

    def further(self) -> tuple[Array, Array]:
        """All equations but loops, (B, m), and their derivatives by the parameters."""
        return self.slopes([row.v for row in self._further(self.variables)])

    def rated(self, inverse: Array, first: Array, order: int) -> Self:
        """The same rows with derivatives by the leading input, eq. (120).

        Parameters
        ----------
        inverse : (B, n, n)
            Of the Jacobians.
        first : (B, N)
            The derivatives of all variables by the leading input.
        order : int
            1 or 2.
        """
        second = np.zeros_like(first)
        if order > 1:
            parts = (self.solution, first, second)
            jets = [Jet(*(part[:, k] for part in parts)) for k in range(first.shape[1])]
            bent = [row.d2 for row in self._residuals(dict(zip(self._symbols, jets, strict=True)))]
            rows = [np.broadcast_to(getattr(x, "values", x), len(first)) for x in bent]
            # J q'' = -(all other terms of F'')
            right = np.array(rows).reshape(len(rows), len(first)).T
            second[:, : self.count] = -(inverse @ right[:, :, None])[:, :, 0]
        moved = copy(self)
        moved._points, moved.order = {}, order
        moved.__dict__.update(_inverse=inverse, _rates=(first, second))
        values = [self.variables[symbol].v for symbol in self._symbols]
        moved.__dict__["variables"] = moved._differentiated(values)
        return moved


class LaneEquations:
    """F(v, u; p) of D designs in N rows each.

    Parameters
    ----------
    designs : WrittenDesigns
    rows : int
        N.
    """

    def __init__(self, designs: WrittenDesigns, rows: int) -> None:
        self.designs, self.rows = designs, rows
        self.loops, coefficients = designs.writer.loops, designs.writer.coefficients
        by_lane = np.tile(self.loops.coefficient, (len(designs.x), 1))
        self._by_numbers = np.zeros((*by_lane.shape, designs.x.shape[1]), dtype=complex)
        for k, number in enumerate(coefficients):
            if isinstance(number, TapedNumber):
                by_lane[:, k], rate = designs.known[number.node]
                self._by_numbers[:, k] = rate.T
        self._coefficients = np.repeat(by_lane, rows, axis=0)

    @np.errstate(all="ignore")  # rows without a position are no numbers
    def at(self, v: Array) -> tuple[Array, Array]:
        """F (B, m) at variables (B, N), and by them, (B, m, N)."""
        value, slope = self.loops.value_and_jacobian(v, self._coefficients)
        further, slopes = self._further(v)
        return (
            np.concatenate([value.real, value.imag, further], axis=1),
            np.concatenate([slope.real, slope.imag, slopes[:, :, -v.shape[1] :]], axis=1),
        )

    @np.errstate(all="ignore")
    def by_numbers(self, v: Array) -> Array:
        """F by the numbers, (B, m, P)."""
        designs, terms, numbers = self._by_numbers.shape
        bare = self.loops.by_coefficients(v).reshape(designs, self.rows, terms)
        result = np.empty((len(v), self.loops.rows, numbers), dtype=complex)
        for row in range(self.loops.rows):
            part = self.loops.row == row
            result[:, row] = (bare[:, :, part] @ self._by_numbers[:, part]).reshape(len(v), numbers)
        _, slopes = self._further(v)
        return np.concatenate([result.real, result.imag, slopes[:, :, :numbers]], axis=1)

    def _further(self, v: Array) -> tuple[Array, Array]:
        """All equations but loops, by the numbers and by the variables."""
        numbers, variables = self._by_numbers.shape[2], v.shape[1]
        equations = self.designs.writer.equations
        if not (equations.linear or equations.real or equations.laws):
            return np.zeros((len(v), 0)), np.zeros((len(v), 0, numbers + variables))
        slopes = np.zeros((len(v), variables, numbers + variables))
        slopes[:, :, numbers:] = np.eye(variables)
        return LaneRows(self.designs, v, slopes).further()


# ----------------------------------------------------------------------
# Positions of many designs at given inputs, followed from design to design.
#
# A lane keeps the unknowns of its last accepted design and their derivatives by its numbers; a new
# design starts from their prediction and Newton-Raphson. A position whose Jacobian has another sign
# than that of the first design is on another branch, and counts as none.


_NEWTON_STEPS = 8
_CLOSED = 1e-13  # scaled residuals that count as solved, and steps that end


@dataclass(frozen=True, kw_only=True, eq=False)
class LanePositions:
    """D designs at N rows.

    Parameters
    ----------
    rows : LaneRows
        D N rows, design by design.
    t : (D, N)
        The leading inputs.
    slopes : (D N, N, P + 1)
        Derivatives of all variables by the numbers and by the leading input.
    shape : (int, int)
    inverse : (D N, n, n)
        Of the Jacobians.
    sign : (D, N)
        Of their determinants.
    """

    rows: LaneRows
    t: Array
    slopes: Array
    solved: BoolArray
    shape: tuple[int, int]
    inverse: Array
    sign: Array

    def values(
        self, results: Sequence[object], rows: LaneRows | None = None
    ) -> tuple[Array, Array, Array]:
        """Real results (D, N, m) on the tape of the rows, or of rated ones; by numbers (D, N, m, P)
        and the input (D, N, m).
        """
        value, slope = (rows or self.rows).slopes(results)
        shape = *self.shape, len(results)
        value = np.where(self.solved[:, None], value, np.nan).reshape(shape)
        slope = slope.reshape(*shape, slope.shape[2])
        return value, slope[..., :-1], slope[..., -1]

    def rated(self, order: int) -> LaneRows:
        """The rows with so many derivatives by the leading input, 0 to 2."""
        if order not in self._rated:
            self._rated[order] = self.rows.rated(self.inverse, self.slopes[:, :, -1], order)
        return self._rated[order]

    @cached_property
    def _rated(self) -> dict[int, LaneRows]:
        return {0: self.rows}

    def totals(self, rows: LaneRows, result: Any) -> tuple[Array, Array]:
        """A real result of rows or rated rows, (D, N), and by the numbers, (D, N, P)."""
        value, by_x, _ = self.values([result], rows)
        return value[:, :, 0], by_x[:, :, 0]

    def plain(self, column: Any) -> AnyArray:
        """The values of a column of rows, (D, N); NaN where there is no position."""
        values = np.broadcast_to(getattr(column, "values", column), len(self.solved))
        return np.where(self.solved, values, np.nan).reshape(self.shape)


def inputs_away(at: Array, motion: Motion, model: Model) -> Array:
    """The distances of inputs (N,) from those of rows (R,), infinite from lost ones, (N, R)."""
    lead = next(iter(motion.inputs))
    table = np.asarray(motion.inputs[lead]) * float(model.input_scale[0])
    away = np.abs(at[:, None] - table)
    if model.equations.inputs[0].kind == Kind.ANGLE.value:
        turned = np.abs(np.mod(away + 0.5 * FULL_TURN, FULL_TURN) - 0.5 * FULL_TURN)
        # of rows whole turns apart the nearest: geared links differ there
        away = turned + EQUAL_ROWS * away
    return np.where(motion.found, away, np.inf)


class SolvedLanes:
    """Lanes of one mechanism at N rows.

    Parameters
    ----------
    writer : DesignWriter
    x : (P,)
        The numbers of the mechanism, file units.
    q : (N, n)
        Unknowns of the mechanism at the rows.
    t : (N,)
        Leading input there [rad or length].
    lanes : int
    """

    def __init__(self, writer: DesignWriter, x: Array, q: Array, t: Array, lanes: int) -> None:
        self.model = model = writer.model
        self.lead, self.rate = leading_input(model.rows)
        self.rows_at = t
        rows, n = len(t), len(model.equations.unknowns)
        # row by row: a row that does not close keeps the last design in which it did; one that
        # has never closed keeps its nearest row
        self.x = np.broadcast_to(x, (lanes, rows, len(x))).copy()
        self.t = np.broadcast_to(t, (lanes, rows)).copy()
        self.q = np.broadcast_to(q, (lanes, rows, n)).copy()
        self.by_x = np.zeros((lanes, rows, n, len(x)))
        self.by_t = np.zeros((lanes, rows, n))
        self.total = np.full(lanes, np.inf)
        self._sign: Array | None = None
        first = self.at(writer.written(x[None, :]), np.arange(1))
        self._sign = first.sign
        self.by_x[:] = first.slopes[:, :n, :-1].reshape(1, rows, n, len(x))
        self.by_t[:] = first.slopes[:, :n, -1].reshape(1, rows, n)
        self._known = np.broadcast_to(first.solved, (lanes, rows)).copy()
        if first.solved.any():
            near = self._nearest(first.solved)
            self._sign = first.sign[:, near]  # rows that do not close are on the same branch
            for lane in range(lanes):
                self._lend(lane, near)

    def copy_lanes(self, of: IndexArray, to: IndexArray) -> None:
        """Start lanes at the present state of other lanes."""
        for kept in (self.x, self.t, self.q, self.by_x, self.by_t, self._known):
            kept[to] = kept[of]

    def inputs(self, t: Array) -> Array:
        """All inputs (…, p) for values of the leading one."""
        first = self.model.rows[0]
        return np.asarray(first + (t - first[self.lead])[..., None] * self.rate)

    def at(
        self, designs: WrittenDesigns, lanes: IndexArray, t: Array | None = None
    ) -> LanePositions:
        """The positions of D designs of these lanes at inputs (D, N), by default those of rows."""
        x, count, rows = designs.x, len(designs.x), len(self.rows_at)
        t = np.broadcast_to(self.rows_at, (count, rows)) if t is None else t
        change = np.einsum("dnkp,dnp->dnk", self.by_x[lanes], x[:, None] - self.x[lanes])
        change += self.by_t[lanes] * (t - self.t[lanes])[:, :, None]
        v = np.concatenate([self.q[lanes] + change, self.inputs(t)], axis=2)
        v = v.reshape(count * rows, v.shape[2])
        equations = LaneEquations(designs, rows)
        n = self.q.shape[2]
        scale = self.model.compiled.table.equation_scale
        weight = self.model.compiled.table.variable_scale[:n]
        fine = np.repeat(designs.fine, rows)
        if not fine.any():
            v = np.full_like(v, np.nan)
        for _ in range(_NEWTON_STEPS):
            solved = v
            f, by_v = equations.at(v)
            jacobian = by_v[:, :, :n]
            step = solutions(jacobian, f[:, :, None])[:, :, 0]
            missed = np.abs(f / scale).max(axis=1, initial=0.0)
            moved = np.abs(step / weight).max(axis=1, initial=0.0)
            closed = (missed <= _CLOSED) | (moved <= _CLOSED)
            if (closed | ~np.isfinite(missed)).all():
                break
            v = v.copy()
            v[:, :n] -= np.where(np.isfinite(step), step, np.nan)
        sign = np.linalg.slogdet(np.nan_to_num(jacobian))[0].reshape(count, rows)
        fine &= closed
        if self._sign is not None:
            fine &= (sign == self._sign).ravel()
        inverse = inverses(jacobian)
        # eq. (156)
        slopes = np.zeros((len(v), v.shape[1], x.shape[1] + 1))
        slopes[:, :n, :-1] = -inverse @ equations.by_numbers(solved)
        slopes[:, :n, -1] = -(inverse @ (by_v[:, :, n:] @ self.rate)[:, :, None])[:, :, 0]
        slopes[:, n:, -1] = self.rate
        return LanePositions(
            rows=LaneRows(designs, solved, slopes),
            t=t,
            slopes=slopes,
            solved=fine,
            shape=(count, rows),
            inverse=inverse,
            sign=sign,
        )

    def keep(self, positions: LanePositions, lanes: IndexArray, total: Array) -> None:
        """Remember designs that are better than the last ones of their lanes."""
        x = positions.rows.designs.x
        better = total < self.total[lanes]
        self.total[lanes[better]] = total[better]
        which = np.nonzero(positions.solved.reshape(positions.shape) & better[:, None])
        to, n = (lanes[which[0]], which[1]), self.q.shape[2]
        shape = *positions.shape, n
        self.x[to], self.t[to] = x[which[0]], positions.t[which]
        self.q[to] = positions.rows.solution[:, :n].reshape(shape)[which]
        self.by_x[to] = positions.slopes[:, :n, :-1].reshape(*shape, x.shape[1])[which]
        self.by_t[to] = positions.slopes[:, :n, -1].reshape(shape)[which]
        self._known[to] = True
        closed = positions.solved.reshape(positions.shape)
        for k in np.flatnonzero(better & closed.any(axis=1)):
            if not self._known[lanes[k]].all():
                self._lend(lanes[k], self._nearest(closed[k]))

    def _away(self, rows: IndexArray) -> Array:
        """The change of the leading input from rows (N,) to the lane, at most half a turn."""
        away = self.rows_at - self.rows_at[rows]
        if self.model.equations.inputs[self.lead].kind == Kind.ANGLE.value:
            away = np.mod(away + 0.5 * FULL_TURN, FULL_TURN) - 0.5 * FULL_TURN
        return away

    def _nearest(self, closed: BoolArray) -> IndexArray:
        """The nearest of the closed rows for each row, (N,)."""
        rows = np.flatnonzero(closed)
        away = [np.abs(self._away(np.full(len(closed), row))) for row in rows]
        return np.asarray(rows[np.argmin(away, axis=0)])

    def _lend(self, lane: int, near: IndexArray) -> None:
        """Begin rows of a lane that have never closed at their nearest rows."""
        to = np.flatnonzero(~self._known[lane])
        of = near[to]
        self.t[lane, to] = self.rows_at[to] - self._away(near)[to]
        for kept in (self.x, self.q, self.by_x, self.by_t):
            kept[lane, to] = kept[lane, of]
