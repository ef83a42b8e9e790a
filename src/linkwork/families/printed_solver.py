"""Quantities of a position as a program of its variables: what :mod:`design_values` computes with
arrays, recorded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.lanes import NotElementwise
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import LastAxis, QuantityValues, term_jet
from linkwork.core.record.printing import Body, Language
from linkwork.core.record.recorder import (
    Program,
    Recorder,
    Registers,
    Value,
    lower_program,
    reserve,
)
from linkwork.families.design_sweep import block_parts, lines_of_lengths
from linkwork.families.march.march_programs import (
    OPTIONS,
    PlaceWriter,
    Steps,
    ThreadState,
    march_programs,
    printed_sections,
)
from linkwork.families.recorded_design import Part, RecordedDesign, RecordedNumber, Recording

_UNKNOWN = np.array([np.nan])


class _RowNumber(RecordedNumber):
    """A recorded number where NumPy's functions expect an array of no axes."""

    __slots__ = ()
    conj = RecordedNumber.conjugate

    def __array_function__(
        self, function: Callable[..., Any], types: object, given: Sequence[Any], named: object
    ) -> Any:
        if function is np.shape:
            return ()
        if function in (np.broadcast_to, np.atleast_1d):
            return self
        return self.arithmetic.apply(function, *given)


class _RowRecording(Recording):
    """Computes with rows: what holds in one of them decides nothing."""

    def make(self, values: Any, re: Part, im: Part = 0.0) -> RecordedNumber:
        """A number; its value is unknown if it differs from row to row."""
        x, y = self.plainly(re), self.plainly(im)
        known = _UNKNOWN
        if not isinstance(x, Value) and not isinstance(y, Value):
            known = np.array([complex(x, y) if y else x])
        return _RowNumber(known, self, x, y)

    def of_numpy(self, function: Any, inputs: Sequence[Any]) -> Any:
        """Any function that can be recorded, of arrays of no axes too."""
        return self.apply(function, *inputs)

    def operand(self, number: object) -> RecordedNumber:
        """The second operand, which may be an array of one number."""
        plain = number.item() if isinstance(number, np.ndarray) and number.size == 1 else number
        found: RecordedNumber = super().operand(plain)
        return found

    def divide(self, x: RecordedNumber, y: RecordedNumber) -> RecordedNumber:
        """x / y; of 0 too it is no number where y is none."""
        found, rec = super().divide(x, y), self.recorder
        if y.im != 0.0 or not isinstance(y.re, Value):
            return found
        zero = rec.where(rec.at_most(y.re, y.re), 0.0, math.nan)
        parts = ((x.re, found.re), (x.im, found.im))
        return self.make(None, *(quotient if own else zero for own, quotient in parts))

    def decide(self, truths: Any) -> bool:
        """Refused: rows differ."""
        raise NotElementwise

    def apply(self, function: Callable[..., Any], *numbers: object) -> RecordedNumber:
        """A function or an operator of NumPy."""
        if function is np.where and isinstance(numbers[0], np.ndarray):
            chosen: RecordedNumber = self.operand(numbers[1 if numbers[0].item() else 2])
            return chosen
        method = _OPERATORS.get(function)
        if method is None:
            return super().apply(function, *numbers)
        found: RecordedNumber = method(self, *map(self.operand, numbers))
        return found


_OPERATORS: Mapping[Any, Callable[..., Any]] = {
    np.add: Recording.add, np.subtract: Recording.subtract, np.multiply: Recording.multiply,
    np.true_divide: Recording.divide, np.power: Recording.power, np.negative: Recording.negate,
}  # fmt: skip


class HasParts(Protocol):
    """A structure, its path of inputs, and its coefficients: numbers, or values that vary."""

    @property
    def base(self) -> Model:
        """The structure."""

    @property
    def parts(self) -> Mapping[str, Part]:
        """Coefficients by register."""

    @property
    def rates(self) -> Array:
        """The rate of every input by the leading one."""


class RecordedQuantities(QuantityValues):
    """Records quantities of a mechanism's position from ``v<k>``, ``first<k>`` and ``second<k>``.

    Parameters
    ----------
    design : HasParts
        A recorded design, or a family.
    recorder : Recorder, optional
        Records into a program that has begun.
    """

    def __init__(self, design: HasParts, recorder: Recorder | None = None) -> None:
        self.design, self.recording = design, _RowRecording()
        if recorder is not None:
            self.recording.recorder = recorder
        self.recorder: Recorder = self.recording.recorder
        base, zero = design.base, np.zeros(())
        links = [self._part(f"link{k}") for k in range(len(base.equations.links))]
        named = [self._part(f"dimension{k}") for k in range(len(base.equations.dimensions))]
        columns: list[Any] = [LastAxis(links), LastAxis(named)]
        super().__init__(base, np.zeros((), dtype=bool), zero, *columns)
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}
        self.places: dict[str, Jet] = {}

    def write(self, name: str, number: AnyArray | RecordedNumber) -> None:
        """Leave a real number in a named register."""
        part = self.recording.operand(number).re
        self.recorder.write(name, part)

    def column(self, name: str) -> Jet | None:
        """A quantity by name; ``None`` if it cannot be recorded."""
        try:
            with np.errstate(all="ignore"):
                jet = self.model.quantities.find(name).jet(self)
                for part in (jet.v, jet.d1):
                    self.recording.operand(part)
        except TypeError:
            return None
        return jet

    def _part(self, *names: str) -> Any:
        """A coefficient: a number, or what is computed from those that vary."""
        parts = [
            self.recorder.input(name) if isinstance(self.design.parts[name], Value)
            else self.design.parts[name]
            for name in names
        ]  # fmt: skip
        return self.recording.make(None, *parts)

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""
        k, n = self.number[symbol], len(self.equations.unknowns)
        rec, make = self.recorder, self.recording.make
        value: Any = make(None, rec.input(f"v{k}"))
        if k >= n:
            return Jet(value, np.asarray(float(self.design.rates[k - n])), np.zeros(()))
        first: Any = make(None, rec.input(f"first{k}"))
        second: Any = make(None, rec.input(f"second{k}"))
        return Jet(value, first, second)

    def place(self, point: str) -> Jet:
        """A point by its exact name: its parent's position plus its own terms."""
        if point not in self.places:
            table = self.model.compiled.points
            parent = self.equations.points[point].parent
            place = Jet.constant(0.0) if parent is None else self.place(parent)
            for term in np.flatnonzero(table.rows.row == table.names.index(point)).tolist():
                place = place + self._term(term)
            self.places[point] = place
        return self.places[point]

    def _term(self, term: int) -> Jet:
        """c s e^{iψ} with both derivatives."""
        rows = self.model.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        c, turn = self._part(f"point{term}.re", f"point{term}.im"), Jet.constant(0.0)
        mine = rows.phase_term == term
        for k, weight in zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True):
            turn = turn + self.variable(symbols[k]) * float(weight)
        length = int(rows.length[term])
        s = Jet.constant(1.0) if length < 0 else self.variable(symbols[length])
        return term_jet(c, s, turn if mine.any() else None)


# ----------------------------------------------------------------------
# The solver of one mechanism printed as functions of a language.
#
# ``design(x, d)``         numbers that vary to the numbers ``d`` of the equations
# ``reach``, ``given``, …  sections of the march, of its state ``w``
# ``rates(v, d, o)``       derivatives of the unknowns, and the residual, at variables ``v``
# ``drawn(v, d, o, q)``    points, columns and turns, with derivatives


@dataclass(frozen=True, kw_only=True)
class PrintedSolver:
    """The functions, and how their arrays are laid out.

    Parameters
    ----------
    source : str
    columns : tuple of str
        Those that are computed.
    unknowns, size, blocks : int
        As in :class:`linkwork.families.gpu.march.Shape`.
    coefficients : int
        How many numbers of ``d``, from ``unknowns + 2`` on, the state of the march takes over.
    spread : tuple of int
        Places in ``d`` of the widths of inputs.
    state, design, drawn : int
        Lengths of ``w``, ``d`` and ``q``.
    options : tuple of float
    """

    source: str
    columns: tuple[str, ...]
    unknowns: int
    size: int
    blocks: int
    coefficients: int
    spread: tuple[int, ...]
    state: int
    design: int
    drawn: int
    options: tuple[float, ...]


def print_solver(
    design: RecordedDesign,
    language: Language,
    *,
    points: Sequence[str],
    columns: Sequence[str],
    turns: Sequence[str],
) -> PrintedSolver:
    """Print the solver of a mechanism.

    Parameters
    ----------
    design : RecordedDesign
    language : Language
    points : sequence of str
        Points of which x and y with both derivatives are computed.
    columns : sequence of str
        Quantities whose values are computed if they can be, after the points: value and first
        derivative.
    turns : sequence of str
        Links whose angles [rad] are computed, after the columns.
    """
    base, fixed = design.base, design.fixed
    table, parts = base.compiled.table, block_parts(base)
    spreads = [f"u{j}.spread" for j in range(len(base.equations.inputs))]
    written = {name: part for name, part in fixed.items() if name not in spreads}
    zeros = frozenset(name for name, part in written.items() if not part)
    programs = march_programs(table, parts, zeros, certified=True)
    state = ThreadState.of(programs, OPTIONS, written)
    starts = ["fits", *(f"guess{k}" for k in range(table.unknowns)), "start"]
    varied = [name for name, part in design.parts.items() if isinstance(part, Value)]
    order = dict.fromkeys([*starts, *state.coefficients, *spreads, *varied])
    places = {name: f"d[{k}]" for k, name in enumerate(order)}
    writer = PlaceWriter(table, parts, zeros)
    at_rows = writer.finish([*writer.rates(), *writer.residual(lines_of_lengths(base))])
    variables = {f"v{k}": f"v[{k}]" for k in range(table.variables)}
    rates = {name: f"o[{k}]" for k, name in enumerate(at_rows.wanted)}
    drawing = RecordedQuantities(design)
    recorded = _write_drawn(drawing, points, columns, turns)
    results = {name: f"q[{k}]" for k, name in enumerate(drawing.recorder.writes)}
    text = [
        _numbers(design, order, places, language),
        *printed_sections(programs, state, language, written),
        _function(
            language, "rates", ["v", "d", "o"], at_rows.program, at_rows.registers,
            variables | places | rates, written,
        ),
        _recorded(
            language, "drawn", ["v", "d", "o", "q"], drawing.recorder,
            variables | places | rates | results, written,
        ),
    ]  # fmt: skip
    steps = Steps()
    return PrintedSolver(
        columns=recorded,
        source="".join(text),
        unknowns=table.unknowns,
        size=programs.nodes.shape[1],
        blocks=state.blocks,
        coefficients=len(state.coefficients),
        spread=tuple(list(order).index(name) for name in spreads),
        state=len(state.place),
        design=len(order),
        drawn=len(results),
        options=tuple(float(getattr(steps, name)) for name in state.options),
    )


def _numbers(
    design: RecordedDesign, order: Mapping[str, None], places: Mapping[str, str], language: Language
) -> str:
    """The function from numbers that vary to those of the equations."""
    rec = design.recorder
    for name in order:
        if name not in rec.writes:
            rec.write(name, design.parts[name])
    given = {f"number{k}": f"x[{k}]" for k in range(len(design.quantities))}
    return _recorded(language, "design", ["x", "d"], rec, given | dict(places), {})


def _recorded(
    language: Language,
    name: str,
    arguments: Sequence[str],
    rec: Recorder,
    places: Mapping[str, str],
    fixed: Mapping[str, float],
) -> str:
    registers = Registers()
    reserve(rec, registers)
    program = lower_program(rec, registers, registers.count)
    return _function(language, name, arguments, program, registers, places, fixed)


def _function(
    language: Language,
    name: str,
    arguments: Sequence[str],
    program: Program,
    registers: Registers,
    places: Mapping[str, str],
    fixed: Mapping[str, float],
) -> str:
    """A program as a function of arrays; ``places``: elements by the names of registers."""
    named = {register: own for own, register in registers.named.items()}
    constants = {register: value for value, register in registers.constants.items()}
    constants |= {registers.named[own]: fixed[own] for own in fixed.keys() & registers.named}
    body = Body(lambda register: places[named[register]], constants, language)
    body.add(program.code)
    body.end(named.keys())
    return language.written(name, arguments, body.lines)


def _write_drawn(
    drawing: RecordedQuantities,
    points: Sequence[str],
    columns: Sequence[str],
    turns: Sequence[str],
) -> tuple[str, ...]:
    """Six numbers of every point, two of every column, one of every turn; returns the columns."""
    for name in points:
        place = drawing.place(name)
        for axis in ("real", "imag"):
            for order, part in enumerate((place.v, place.d1, place.d2)):
                drawing.write(f"{name}.{axis}{order}", getattr(part, axis))
    recorded = {name: jet for name in columns if (jet := drawing.column(name)) is not None}
    for name, jet in recorded.items():
        drawing.write(f"column {name}", jet.v)
        drawing.write(f"column {name} first", jet.d1)
    scale = drawing.model.units.angle.radians
    for name in turns:
        drawing.write(f"turn {name}", drawing.own(name).v * scale)
    return tuple(recorded)
