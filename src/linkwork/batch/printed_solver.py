"""The solver of one mechanism printed as functions of a language.

``design(x, d)``         numbers that vary to the numbers ``d`` of the equations
``reach``, ``given``, …  sections of the march, of its state ``w``
``rates(v, d, o)``       derivatives of the unknowns, and the residual, at variables ``v``
``drawn(v, d, o, q)``    points, columns and turns, with derivatives
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from linkwork.batch.recorded_design import RecordedDesign
from linkwork.batch.recorded_quantities import RecordedQuantities
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

__all__ = ["PrintedSolver", "print_solver"]

_OPTIONS = ("tolerance", "most_turn", "most_correction", "most_drift")


@dataclass(frozen=True, kw_only=True)
class PrintedSolver:
    """The functions, and how their arrays are laid out.

    Parameters
    ----------
    source : str
    columns : tuple of str
        Those that are computed.
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
    state = ThreadState.of(programs, _OPTIONS, written)
    starts = ["fits", *(f"guess{k}" for k in range(table.unknowns)), "start"]
    varied = [name for name, part in design.parts.items() if isinstance(part, Value)]
    order = dict.fromkeys([*starts, *state.coefficients, *spreads, *varied])
    places = {name: f"d[{k}]" for k, name in enumerate(order)}
    at_rows = drawn_program(table, parts, lines_of_lengths(base), zeros)
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
