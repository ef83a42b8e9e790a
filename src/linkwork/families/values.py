"""Rates of the unknowns of many designs at their solved positions, with condition and residual."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from linkwork import wings
from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.grammar import parse
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray, TurnArray
from linkwork.core.foundation.errors import InputError, LinkworkError
from linkwork.core.foundation.lanes import LaneArithmetic, NotElementwise, is_batched
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.statuses import Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Number, Numbers
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.varied_numbers import with_numbers
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import Model, leading_input, leading_speeds
from linkwork.core.motion.positions import QuantityValues
from linkwork.core.record.recorder import Code, Op, Recorder, Value
from linkwork.families.building import Designs
from linkwork.families.compiled.code_cache import has_compiler
from linkwork.families.design_sweep import (
    DesignRows,
    block_parts,
    lines_of_lengths,
    loop_coefficients,
    zero_coefficients,
)
from linkwork.families.march.march_programs import PlaceProgram, PlaceWriter
from linkwork.families.printed_solver import RecordedQuantities
from linkwork.families.recorded_design import Part
from linkwork.forces.reactions.drives import effort_name, work_terms
from linkwork.forces.reactions.free_bodies import FreeBodies
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry
from linkwork.forces.reactions.parts import join_loads

_MOST_BYTES = 8 << 30  # limit for the rates of one family


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRates:
    """Derivatives of the unknowns with respect to the leading input, (n, R, D) each, internal
    units.

    NaN without a position and at dead points. ``driven`` (2, R, D): whether the inputs have first
    and second derivatives.
    """

    first: Array
    second: Array
    driven: BoolArray

    def take(self, part: slice) -> DesignRates:
        """The rates of some designs."""
        return DesignRates(
            first=self.first[:, :, part],
            second=self.second[:, :, part],
            driven=self.driven[:, :, part],
        )


def design_rates(designs: Designs, rows: DesignRows, threads: int = 1) -> DesignRates:
    """The rates of all unknowns, computed for all designs together by a compiled program.

    For designs swept alone, the rates of that sweep are used.

    Raises
    ------
    InputError
        If they do not fit into memory.
    """
    n, count, width = rows.v.shape
    if 2 * rows.v.nbytes > _MOST_BYTES:
        raise InputError(
            f"the rates of {width} designs × {count} rows take {2 * rows.v.nbytes / 2**30:.0f} "
            "GiB: use family.parts() or family.reduced({...})"
        )
    both = np.full((2, n, count, width), np.nan)
    if _together(designs, rows):
        reading = PlaceReading.of(designs)
        writer = reading.writer()
        both = reading.run(writer.finish(writer.rates()), rows, threads).reshape(both.shape)
        # at dead points J is singular: rates are infinite or noise
        both[~np.isfinite(both)] = np.nan
    driven = np.ones((2, count, width), dtype=bool)
    for k, own in rows.own.items():
        both[0, :, :, k], both[1, :, :, k] = own.first[:, :n].T, own.second[:, :n].T
        driven[:, :, k] = ~np.isnan([own.first[:, -1], own.second[:, -1]])
    return DesignRates(first=both[0], second=both[1], driven=driven)


def design_evidence(designs: Designs, rows: DesignRows, threads: int = 1) -> tuple[Array, Array]:
    """Condition number and residual of every position, (R, D) each; NaN without one."""
    condition, residual = np.full((2, *rows.v.shape[1:]), np.nan)
    if _together(designs, rows):
        reading, lengths = PlaceReading.of(designs), lines_of_lengths(designs.base)
        writer = reading.writer()
        program = writer.finish([*writer.condition(lengths), *writer.residual(lengths)])
        condition, residual = reading.run(program, rows, threads)
        found = rows.status == Status.CONVERGED.code
        # of existing positions; NaN for the others
        condition[found & ~np.isfinite(condition)] = np.inf
        condition[~found] = residual[~found] = np.nan
    for k, own in rows.own.items():
        condition[:, k], residual[:, k] = own.condition, own.residual
    return condition, residual


def _together(designs: Designs, rows: DesignRows) -> bool:
    """Whether any design was not swept alone."""
    return bool((~rows.alone & (designs.problem == 0)).any())


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaceReading:
    """The arguments of programs run at the positions of a family."""

    designs: Designs
    coefficients: dict[str, Array]
    zeros: set[str]

    @classmethod
    def of(cls, designs: Designs) -> PlaceReading:
        coefficients = loop_coefficients(designs)
        zeros = zero_coefficients(designs, coefficients)
        coefficients["length"] = designs.length_scale
        for j, rate in enumerate(leading_input(designs.base.rows)[1]):
            coefficients[f"u{j}.rate"] = np.full(len(designs), rate)
        return cls(designs=designs, coefficients=coefficients, zeros=zeros)

    def writer(self) -> PlaceWriter:
        """Writes programs of the family's equations."""
        base = self.designs.base
        return PlaceWriter(base.compiled.table, block_parts(base), self.zeros)

    def run(self, program: PlaceProgram, rows: DesignRows, threads: int) -> Array:
        """Run at the inputs of the solved positions, on the straight line of the table."""
        model = self.designs.base
        if rows.inputs is not None:
            v = np.concatenate([rows.v, rows.inputs.swapaxes(0, 1)])
            none = np.zeros((v.shape[1], 0))
            return _at_places()(program, self.coefficients, v, none, rows.turns, threads)
        lead, rate = leading_input(model.rows)
        inputs = Drive.through(model, model.rows[0], rate, lead).path.at(model.rows[:, lead])
        return _at_places()(program, self.coefficients, rows.v, inputs, rows.turns, threads)


def _at_places() -> Callable[..., Array]:
    """Runs programs over positions: in compiled code, or with arrays."""
    compiled = has_compiler()
    return wings.use("families.march.sweep_kernel" if compiled else "families.values").at_places


def design_speeds(designs: Designs) -> Array | None:
    """The rate of every design's leading input, (D,) [rad/s] or [length/s]; ``None`` without a
    speed, NaN for designs with a problem.
    """
    if designs.base.speed is None:
        return None
    found = np.full(len(designs), np.nan)
    fine = np.flatnonzero(designs.problem == 0)
    if designs.base.untimed is not None:
        found[fine] = 1.0  # time leads
        return found
    # all together if the formula of the speed is elementwise
    left = fine[_speeds_together(designs, fine, found)] if len(fine) else fine
    for k in left:
        with suppress(LinkworkError):  # a formula without a value for this design
            found[k] = _speed_of(designs, designs.description(int(k)))
    return found


def _speed_of(designs: Designs, description: Description) -> float:
    base = designs.base
    return next(iter(leading_speeds(description, base.equations.inputs, base.rows).values()))


def _speeds_together(designs: Designs, fine: IndexArray, found: Array) -> BoolArray:
    """Fill in the speeds of valid designs; returns those to compute one by one."""
    consensus = LaneArithmetic(len(fine))
    columns = zip(designs.quantities, designs.dimensions.values(), strict=True)
    numbers = {quantity: consensus.lanes(values[fine]) for quantity, values in columns}
    try:
        speed = _speed_of(designs, with_numbers(designs.base.description, numbers))
    except (NotElementwise, LinkworkError):
        return np.ones(len(fine), dtype=bool)
    found[fine] = speed.values if is_batched(speed) else speed
    return ~consensus.agreeing


# ----------------------------------------------------------------------
# The quantities of many designs over many rows, from their variables.


_NONE = np.zeros(())  # rates of a quantity whose value only is requested


class DesignValues(QuantityValues):
    """Computes quantities from the variables of D designs over R rows, (R, D) each.

    Parameters
    ----------
    designs : Designs
    inputs : (R, p) or (R, p, D)
        Requested inputs, file units.
    v : (n, R, D)
        Unknowns, internal units; NaN where there is no position.
    turns : (R, D)
        Whole turns from the requested to the actual first input of a position.
    rates : DesignRates, optional
        If omitted, only values are available.
    """

    def __init__(
        self,
        designs: Designs,
        inputs: Array,
        v: Array,
        turns: TurnArray,
        rates: DesignRates | None = None,
    ) -> None:
        lost: BoolArray = np.zeros(v.shape[1:], dtype=bool)
        lost |= np.isnan(v).any(axis=0)
        still = _NONE if rates is None else np.where(lost, np.nan, 0.0)
        super().__init__(designs.base, lost, still, designs.link_angles, designs.numbers)
        self.designs, self.inputs, self.v, self.turns = designs, inputs, v, turns
        self.rates = rates
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}

    @cached_property
    def _blanks(self) -> tuple[Array, Array]:
        """0, or NaN where a variable has no first or second derivative, (R, D)."""
        if self.rates is None:
            return _NONE, _NONE
        first = np.isnan(self.rates.first).any(axis=0) | self.lost
        second = np.isnan(self.rates.second).any(axis=0) | first
        return np.where(first, np.nan, 0.0), np.where(second, np.nan, 0.0)

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""
        k = self.number[symbol]
        n, rates = len(self.equations.unknowns), self.rates
        if k < n:
            if rates is None:
                return Jet(self.v[k], _NONE, _NONE)
            return Jet(self.v[k], rates.first[k], rates.second[k])
        column = self.inputs[:, k - n] * self.model.input_scale[k - n]
        value = np.where(self.lost, np.nan, column if column.ndim > 1 else column[:, None])
        # a row found whole turns away has other outputs, where angles enter without a sine
        if k == n and self.turns.any():
            value = value + self.turns * FULL_TURN
        if rates is None:
            return Jet(value, _NONE, _NONE)
        rate = leading_input(self.model.rows)[1][k - n]
        first, second = (
            np.where(self.lost | ~driven, np.nan, own)
            for driven, own in zip(rates.driven, (rate, 0.0), strict=True)
        )
        return Jet(value, first, second)

    def apart(self) -> Iterator[DesignColumn | None]:
        """Every design by itself, (R,), with a model of its own numbers; ``None`` without rows."""
        for k in range(len(self.designs)):
            if self.lost[:, k].all():
                yield None
                continue
            if len(self.equations.inputs) > 1:  # partial derivatives need its own equations
                yield DesignColumn(self, self.designs.design(k), k)
            else:
                description = self.designs.description(k)
                yield DesignColumn(self, replace(self.model, description=description), k)

    def place(self, point: str) -> Jet:
        """A point by its exact name: its parent's position plus its own terms."""
        table = self.model.compiled.points
        number = {own: k for k, own in enumerate(table.names)}
        parent = self.equations.points[point].parent
        if parent is None:
            blanks = (np.where(self.lost, np.nan, 0.0), *self._blanks)
            place = Jet(*(_as_complex(blank) for blank in blanks))
        else:
            place = self.place(parent)
        for term in np.flatnonzero(table.rows.row == number[point]):
            place = place + self._term(int(term))
        return place

    def _term(self, term: int) -> Jet:
        """c s e^{iψ} with both derivatives."""
        rows = self.model.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        value: ComplexArray = self.designs.points[:, term][None, :]
        mine = rows.phase_term == term
        turn = Jet.constant(0.0)
        for k, weight in zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True):
            angle = self.variable(symbols[k])
            turn = turn + Jet(weight * angle.v, weight * angle.d1, weight * angle.d2)
        if mine.any():
            value = value * np.exp(1j * np.asarray(turn.v))
        length = int(rows.length[term])
        if self.rates is None:
            value = value if length < 0 else value * self.variable(symbols[length]).v
            return Jet(value, _NONE, _NONE)
        s = Jet.constant(1.0) if length < 0 else self.variable(symbols[length])
        first = value * (s.d1 + 1j * s.v * turn.d1)  # derivative of eq. (1)
        # eq. (3) with a = b
        second = s.d2 - s.v * turn.d1**2 + 1j * (2.0 * s.d1 * turn.d1 + s.v * turn.d2)
        return Jet(value * s.v, first, value * second)


@dataclass(frozen=True, eq=False)
class DesignColumn:
    """The values of one design, (R,)."""

    values: DesignValues
    model: Model
    number: int

    def own(self, name: str) -> Jet:
        """A variable or output by its exact name."""
        return self._column(self.values.own(name))

    def place(self, point: str) -> Jet:
        """A point by its exact name."""
        return self._column(self.values.place(point))

    def _column(self, jet: Jet) -> Jet:
        shape = self.values.lost.shape
        parts = (np.broadcast_to(part, shape)[:, self.number] for part in (jet.v, jet.d1, jet.d2))
        return Jet(*parts)


def _as_complex(blank: Array) -> ComplexArray:
    """0, or NaN in both parts."""
    both: ComplexArray = np.asarray(blank * (1.0 + 1.0j), dtype=complex)
    return both


# ----------------------------------------------------------------------
# Efforts of the inputs of many designs, by a compiled program over all positions.
#
# Virtual work needs the motion of loads and masses only. Its sum is recorded once from the same
# code that computes it for one mechanism, and runs lane by lane like the rates that it uses.


_UNBOUNDED = 1e9  # radians, or longest links, per unit of the input: no rate at all
_RATE = "speed"  # the register with the speed of a design's leading input


def design_efforts(designs: Designs, rows: DesignRows, name: str, threads: int = 1) -> Array | None:
    """The effort of an input, (R, D); ``None`` if it is no effort that one program computes.

    Designs that were swept alone are left NaN.
    """
    model = designs.base
    inputs = model.equations.inputs
    if len(inputs) != 1 or name != effort_name(inputs[0].name) or not _serves(model):
        return None
    reading = PlaceReading.of(designs)
    speeds = design_speeds(designs)
    coefficients = reading.coefficients | _coefficients(designs)
    if speeds is not None:
        coefficients[_RATE] = speeds
    try:
        # recorded numbers have no values, and divide by any
        with np.errstate(all="ignore"):
            program = _program(designs, reading, coefficients)
    except (NotElementwise, TypeError):
        return None
    place = replace(reading, coefficients=coefficients)
    found: Array = place.run(program, rows, threads)[0]
    # at a dead point J is singular
    found[~np.isfinite(found)] = np.nan
    return found


def _serves(model: Model) -> bool:
    """Whether the effort is that of virtual work alone."""
    description = model.description
    if not isinstance(description, Linkage) or model.compiled.table.functions:
        return False
    return not getattr(description, "friction", None)


def _coefficients(designs: Designs) -> dict[str, Array]:
    """Coefficients of points, constants of links and named numbers by register, (D,) each."""
    found: dict[str, Array] = {}
    for term, column in enumerate(designs.points.T):
        found[f"point{term}.re"] = np.ascontiguousarray(column.real)
        found[f"point{term}.im"] = np.ascontiguousarray(column.imag)
    for letter, columns in (("link", designs.link_angles.T), ("dimension", designs.numbers.T)):
        for k, column in enumerate(columns):
            found[f"{letter}{k}"] = np.ascontiguousarray(column)
    return found


@dataclass(frozen=True, eq=False)
class _FamilyParts:
    """The coefficients of a family: numbers where all designs have the same."""

    base: Model
    parts: Mapping[str, Part]
    rates: Array


def _program(
    designs: Designs, reading: PlaceReading, coefficients: Mapping[str, Array]
) -> PlaceProgram:
    model, fine = designs.base, np.flatnonzero(designs.problem == 0)
    writer = reading.writer()
    rec, derivatives = writer.rec, writer.derivatives()
    parts: dict[str, Part] = {}
    for name, values in coefficients.items():
        one = float(values[fine[0]]) if len(fine) else 0.0
        # what all designs share is a constant, which the recorder simplifies
        varies = bool((values[fine] != one).any())
        parts[name] = rec.input(name) if varies else one
    family = _FamilyParts(model, parts, leading_input(model.rows)[1])
    solved = _RecordedRows(family, rec, *derivatives)
    effort = _effort(solved, parts.get(_RATE, 0.0))
    rec.write("effort", rec.where(solved.slow(parts["length"]), effort, np.nan))
    return writer.finish(["effort"])


class _RecordedRows(RecordedQuantities):
    """Recorded quantities whose rates the same program has computed."""

    def __init__(
        self,
        design: _FamilyParts,
        recorder: Recorder,
        first: Mapping[int, Value | float],
        second: Mapping[int, Value | float],
    ) -> None:
        self.derivatives = first, second
        super().__init__(design, recorder)

    def recorded(self, part: Part) -> Any:
        """A recorded number."""
        return self.recording.make(None, part)

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""
        k = self.number[symbol]
        make: Callable[..., Any] = self.recording.make
        first, second = self.derivatives
        return Jet(make(None, self.recorder.input(f"v{k}")), make(None, first[k]),
                   make(None, second[k]))  # fmt: skip

    def slow(self, length: Part) -> Value:
        """Where the unknowns have finite rates: no dead point."""
        rec, table = self.recorder, self.model.compiled.table
        rates = [
            rec.absolute(x) if table.is_angle[k] else rec.divide(rec.absolute(x), length)
            for k, x in self.derivatives[0].items()
        ]
        return rec.at_most(rec.largest(rates), _UNBOUNDED)


class _RecordedNumbers(Numbers):
    """Numbers and formulas of named numbers that vary."""

    def __init__(self, solved: _RecordedRows) -> None:
        equations = solved.model.equations
        self.unit = solved.model.description.angle
        columns: Any = solved.dimensions
        self.known = {
            canonical(name): columns[..., k] for k, name in enumerate(equations.dimensions)
        }

    def __call__(self, number: Number) -> Any:
        """The value of a number or formula."""
        if not isinstance(number, str):
            return float(number)
        zero = np.zeros(())
        known: dict[str, Any] = dict(self.known)
        names = {name: Jet(value, zero, zero) for name, value in known.items()}
        return evaluate(parse(number), names, self.unit).v


class _RecordedGeometry(Geometry):
    """Places and rates as recorded numbers."""

    def __init__(self, solved: _RecordedRows) -> None:
        super().__init__(solved.model, solved)
        self._numbers = _RecordedNumbers(solved)

    @property
    def shape(self) -> tuple[int, ...]:
        """One number."""
        return ()

    @property
    def numbers(self) -> Numbers:
        """Reads numbers and formulas of the file."""
        return self._numbers

    def partial(self, point: str) -> Any:
        """The derivative of a point by the only input."""
        return self.place(point).d1

    def turning(self, link: str) -> Any:
        """The derivative of a link's angle by the only input."""
        return self.angle(link).d1


def _effort(solved: _RecordedRows, rate: Part) -> Part:
    """The sum of virtual work, eq. (71)."""
    geometry = _RecordedGeometry(solved)
    linkage = solved.model.description
    assert isinstance(linkage, Linkage)
    applied = AppliedLoads(geometry, solved.recorded(rate) if isinstance(rate, Value) else rate)
    applied.weigh(linkage)
    bodies = FreeBodies(linkage, geometry, applied)
    join_loads(bodies)
    total: Any = solved.recorded(0.0)
    for load, moved in work_terms(applied):
        total = total - (np.conj(load) * moved).real
    effort: Part = total.re
    return effort


# ----------------------------------------------------------------------
# Programs run over the positions of many designs with arrays, where nothing is compiled.


_PART = 1 << 14  # positions worked on together

_OPERATIONS: dict[Op, Callable[..., Any]] = {
    Op.COPY: lambda a, b, c, d: a,
    Op.ADD: lambda a, b, c, d: a + b,
    Op.SUB: lambda a, b, c, d: a - b,
    Op.MUL: lambda a, b, c, d: a * b,
    Op.DIV: lambda a, b, c, d: a / b,
    Op.FMA: lambda a, b, c, d: a * b + c,
    Op.FMS: lambda a, b, c, d: a * b - c,
    Op.FNMA: lambda a, b, c, d: c - a * b,
    Op.NEG: lambda a, b, c, d: -a,
    Op.ABS: lambda a, b, c, d: np.abs(a),
    Op.MAX: lambda a, b, c, d: np.maximum(a, b),
    Op.MIN: lambda a, b, c, d: np.minimum(a, b),
    Op.SQRT: lambda a, b, c, d: np.sqrt(a),
    Op.WHERE: lambda a, b, c, d: np.where(a > 0.5, b, c),
    Op.LE: lambda a, b, c, d: np.where(a <= b, 1.0, 0.0),
    Op.AND: lambda a, b, c, d: a * b,
    Op.KEEP: lambda a, b, c, d: np.where(a > 0.5, b, d),
    Op.LESS: lambda a, b, c, d: d - a,
}


def run(code: Code, registers: list[Any]) -> None:
    """Run a program in place; registers are numbers or arrays (B,)."""
    with np.errstate(all="ignore"):
        for number, d, a, b, c in code.tolist():
            if number == Op.SIN:
                angle = registers[a]
                registers[d], registers[c] = np.sin(angle), np.cos(angle)
            else:
                of = _OPERATIONS[Op(number)]
                registers[d] = of(registers[a], registers[b], registers[c], registers[d])


def at_places(
    reading: PlaceProgram,
    coefficients: Mapping[str, Array],
    v: Array,
    inputs: Array,
    turns: TurnArray,
    threads: int = 1,
) -> Array:
    """As :func:`linkwork.families.march.sweep_kernel.at_places`."""
    n, rows, count = v.shape
    named = reading.registers.named
    height = max(reading.program.height, reading.registers.count)
    found = np.empty((len(reading.wanted), rows, count))
    step = max(1, _PART // max(rows, 1))
    for begin in range(0, count, step):
        part = slice(begin, begin + step)
        registers: list[Any] = [0.0] * height
        for value, register in reading.registers.constants.items():
            registers[register] = value
        for name, values in coefficients.items():
            if name in named:
                registers[named[name]] = values[part]
        for k in range(n):
            if f"v{k}" in named:
                registers[named[f"v{k}"]] = v[k, :, part]
        for j, column in enumerate(inputs.T):
            if f"v{n + j}" in named:
                moved = turns[:, part] * (2.0 * math.pi if j == 0 else 0.0)
                registers[named[f"v{n + j}"]] = column[:, None] + moved
        run(reading.program.code, registers)
        for k, name in enumerate(reading.wanted):
            found[k, :, part] = registers[named[name]]
    return found
