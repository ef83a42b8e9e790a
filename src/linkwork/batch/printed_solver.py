"""The solver of one mechanism printed as functions of a language.

``design(x, d)``         numbers that vary to the numbers ``d`` of the equations
``reach``, ``given``, …  sections of the march, of its state ``w``
``rates(v, d, o)``       derivatives of the unknowns, and the residual, at variables ``v``
``drawn(v, d, o, q)``    points, columns and turns, with derivatives
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.batch.recorded_design import RecordedDesign
from linkwork.batch.recorded_number import Part
from linkwork.foundation.names import canonical
from linkwork.kernels.march.march_programs import march_programs
from linkwork.kernels.march.printed_sections import ThreadState, printed_sections
from linkwork.kernels.march.rate_programs import drawn_program
from linkwork.kernels.march.sweep_kernel import Steps
from linkwork.kernels.program.languages import Language
from linkwork.kernels.program.lowering import lower_program, reserve
from linkwork.kernels.program.printing import Body
from linkwork.kernels.program.program import Program, Registers
from linkwork.kernels.program.recorder import Recorder, Value
from linkwork.motion.by_kernels import block_parts, lines_of_lengths
from linkwork.results.quantities.asked import Group

__all__ = ["PrintedSolver", "print_solver"]

#: A value with its first and second derivative.
Jet = tuple[Part, Part, Part]
Vector = tuple[Jet, Jet]

_OPTIONS = ("tolerance", "most_turn", "most_correction", "most_drift")


@dataclass(frozen=True, kw_only=True)
class PrintedSolver:
    """The functions, and how their arrays are laid out.

    Parameters
    ----------
    source : str
    unknowns, size, blocks : int
        As in :class:`linkwork.kernels.gpu.march.Shape`.
    coefficients : int
        How many numbers of ``d``, from ``unknowns + 2`` on, the state of the march takes over.
    spread : tuple of int
        Places in ``d`` of the widths of inputs.
    state, design, drawn : int
        Lengths of ``w``, ``d`` and ``q``.
    options : tuple of float
    """

    source: str
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
        Unknowns and links whose values are computed, after the points: value and first derivative.
    turns : sequence of str
        Links whose angles [rad] are computed, after the columns.
    """
    base, fixed = design.base, design.fixed
    table, parts = base.compiled.table, block_parts(base)
    spreads = [f"u{j}.spread" for j in range(len(base.equations.inputs))]
    written = {name: part for name, part in fixed.items() if name not in spreads}
    zeros = frozenset(name for name, part in written.items() if not part)
    programs = march_programs(table, parts, zeros, certified=True)
    state = ThreadState.of(programs, _OPTIONS, written)
    starts = ["fits", *(f"guess{k}" for k in range(table.unknowns)), "start"]
    varied = [name for name, part in design.parts.items() if isinstance(part, Value)]
    order = dict.fromkeys([*starts, *state.coefficients, *spreads, *varied])
    places = {name: f"d[{k}]" for k, name in enumerate(order)}
    at_rows = drawn_program(table, parts, lines_of_lengths(base), zeros)
    variables = {f"v{k}": f"v[{k}]" for k in range(table.variables)}
    rates = {name: f"o[{k}]" for k, name in enumerate(at_rows.wanted)}
    drawing = _Drawing(design)
    drawing.write(points, columns, turns)
    results = {name: f"q[{k}]" for k, name in enumerate(drawing.rec.writes)}
    text = [
        _numbers(design, order, places, language),
        *printed_sections(programs, state, language, written),
        _function(
            language, "rates", ["v", "d", "o"], at_rows.program, at_rows.registers,
            variables | places | rates, written,
        ),
        _recorded(
            language, "drawn", ["v", "d", "o", "q"], drawing.rec,
            variables | places | rates | results, written,
        ),
    ]  # fmt: skip
    steps = Steps()
    return PrintedSolver(
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


class _Drawing:
    """Records what a page draws at a position, with derivatives by the leading input."""

    def __init__(self, design: RecordedDesign) -> None:
        self.design, self.base, self.rec = design, design.base, Recorder()
        self.equations = self.base.equations
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}
        self.symbols = {x.name: x.symbol for x in self.equations.variables}
        self.known: dict[str, Vector] = {}

    def write(self, points: Sequence[str], columns: Sequence[str], turns: Sequence[str]) -> None:
        """Six numbers of every point, two of every column, one of every turn."""
        for name in points:
            for axis, jet in zip("xy", self._place(name), strict=True):
                for order, part in enumerate(jet):
                    self.rec.write(f"{name}.{axis}{order}", part)
        for name in columns:
            asked = self.base.quantities.own[name]
            jet = self._column(name, asked.group)
            scale = self.base.units.scale(asked.own.kind)
            self.rec.write(f"column {name}", self.rec.divide(jet[0], scale))
            self.rec.write(f"column {name} first", jet[1])
        for name in turns:
            self.rec.write(f"turn {name}", self._link(name)[0])

    def _part(self, name: str) -> Part:
        """A coefficient: a number, or what the page computes from the varied ones."""
        part = self.design.parts[name]
        return self.rec.input(name) if isinstance(part, Value) else part

    def _column(self, name: str, group: Group) -> Jet:
        if group is Group.LINK:
            return self._link(name)
        if group is Group.SLIDER:
            return self._variable(canonical(self.equations.sliders[name]))
        return self._variable(self.symbols[name])

    def _link(self, name: str) -> Jet:
        angle = self.equations.links[name]
        constant = self._part(f"link{list(self.equations.links).index(name)}")
        if angle.variable is None:
            return constant, 0.0, 0.0
        jet = self._variable(canonical(angle.variable))
        return self.rec.add(jet[0], constant), jet[1], jet[2]

    def _variable(self, symbol: str) -> Jet:
        k, n = self.number[symbol], len(self.equations.unknowns)
        value = self.rec.input(f"v{k}")
        if k >= n:
            return value, float(self.design.path.rate[k - n]), 0.0
        return value, self.rec.input(f"first{k}"), self.rec.input(f"second{k}")

    def _place(self, point: str) -> Vector:
        """A point: its parent's position plus its own terms."""
        if point not in self.known:
            table, rec = self.base.compiled.points, self.rec
            parent = self.equations.points[point].parent
            still: Jet = (0.0, 0.0, 0.0)
            place = (still, still) if parent is None else self._place(parent)
            own = table.names.index(point)
            for term in np.flatnonzero(table.rows.row == own).tolist():
                place = _sum(rec, place, self._term(term))
            self.known[point] = place
        return self.known[point]

    def _term(self, term: int) -> Vector:
        """c s e^{iψ} with both derivatives."""
        rec, rows = self.rec, self.base.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        z = self._part(f"point{term}.re"), self._part(f"point{term}.im")
        mine, turn = rows.phase_term == term, [0.0, 0.0, 0.0]
        weights = zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True)
        jets = [(float(weight), self._variable(symbols[k])) for k, weight in weights]
        psi, d1, d2 = (
            rec.total([zero, *(rec.multiply(weight, jet[k]) for weight, jet in jets)])
            for k, zero in enumerate(turn)
        )
        if jets:
            sine, cosine = rec.sin_cos(psi)
            z = _times(rec, z, (cosine, sine))
        length = int(rows.length[term])
        s: Jet = (1.0, 0.0, 0.0) if length < 0 else self._variable(symbols[length])
        # derivative of eq. (1), and eq. (3) with a = b
        first = s[1], rec.multiply(s[0], d1)
        second = (
            rec.subtract(s[2], rec.multiply(s[0], rec.multiply(d1, d1))),
            rec.add(rec.multiply(2.0, rec.multiply(s[1], d1)), rec.multiply(s[0], d2)),
        )
        found = [_times(rec, z, factor) for factor in ((s[0], 0.0), first, second)]
        x, y = zip(*found, strict=True)
        return x, y


def _times(rec: Recorder, a: tuple[Part, Part], b: tuple[Part, Part]) -> tuple[Part, Part]:
    """The product of two complex numbers."""
    re = rec.subtract(rec.multiply(a[0], b[0]), rec.multiply(a[1], b[1]))
    return re, rec.add(rec.multiply(a[0], b[1]), rec.multiply(a[1], b[0]))


def _sum(rec: Recorder, a: Vector, b: Vector) -> Vector:
    x, y = (
        tuple(rec.add(one, other) for one, other in zip(left, right, strict=True))
        for left, right in zip(a, b, strict=True)
    )
    return (x[0], x[1], x[2]), (y[0], y[1], y[2])
