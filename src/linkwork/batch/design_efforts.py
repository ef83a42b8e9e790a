"""Efforts of the inputs of many designs, by a compiled program over all positions.

Virtual work needs the motion of loads and masses only. Its sum is recorded once from the same code
that computes it for one mechanism, and runs lane by lane like the rates that it uses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.batch.rates import PlaceReading, design_speeds
from linkwork.batch.recorded_number import Part
from linkwork.batch.recorded_quantities import RecordedQuantities
from linkwork.batch.rows import DesignRows
from linkwork.expression.grammar import parse
from linkwork.expression.jets import Jet, evaluate
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.drives import effort_name
from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.index import join_loads
from linkwork.forces.virtual_work import work_terms
from linkwork.foundation.arrays import Array
from linkwork.foundation.names import canonical
from linkwork.foundation.operand import NotElementwise
from linkwork.kernels.march.rate_programs import PlaceProgram, quantity_program
from linkwork.kernels.program.recorder import Recorder, Value
from linkwork.mechanism.dimensions import Number, Numbers
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model

__all__ = ["design_efforts"]

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

    def write(
        rec: Recorder, first: Mapping[int, Value | float], second: Mapping[int, Value | float]
    ) -> Sequence[str]:
        parts: dict[str, Part] = {}
        for name, values in coefficients.items():
            one = float(values[fine[0]]) if len(fine) else 0.0
            # what all designs share is a constant, which the recorder simplifies
            varies = bool((values[fine] != one).any())
            parts[name] = rec.input(name) if varies else one
        family = _FamilyParts(model, parts, leading_input(model.rows)[1])
        solved = _RecordedRows(family, rec, first, second)
        effort = _effort(solved, parts.get(_RATE, 0.0))
        slow = solved.slow(parts["length"])
        rec.write("effort", rec.where(slow, effort, np.nan))
        return ["effort"]

    return quantity_program(model.compiled.table, reading.parts, write, reading.zeros)


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
