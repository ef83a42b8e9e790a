"""Forces of differentiated rows: the same free bodies and virtual work, with taped numbers.

The equilibrium W r + b = 0 is solved with plain numbers; one step from its solution,
r - W⁻¹ (W r + b), then has the derivatives of the solution.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.design.differentiated_rows import DifferentiatedRows
from linkwork.design.tape import Tape
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.drives import drive_inputs, effort_name
from linkwork.forces.equilibrium import balance
from linkwork.forces.free_bodies import Act, FreeBodies
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.index import join_part, join_parts
from linkwork.forces.part.load import apply_load
from linkwork.forces.pins import join_pins, read_first_links
from linkwork.forces.system import known_acts, totals
from linkwork.forces.virtual_work import work_terms
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.foundation.lanes import is_batched
from linkwork.foundation.names import GROUND
from linkwork.foundation.operand import NotElementwise
from linkwork.mechanism.dimensions import Numbers
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.mechanism.loops import Loops
from linkwork.mechanism.part.load import Load
from linkwork.mechanism.part.spring import Spring

__all__ = ["LoadedRows"]


class TapedGeometry(Geometry):
    """Places and rates on a tape; derivatives by each input as lists of (B,)."""

    def __init__(self, rows: DifferentiatedRows) -> None:
        super().__init__(rows.model, rows)
        self.taped = rows

    @property
    def numbers(self) -> Numbers:
        """Reads numbers and formulas of the file."""
        return self.taped.description.numbers

    def partial(self, point: str) -> Any:
        """Derivatives of a point with respect to each input."""
        if self.alone:
            return [self.place(point).d1]
        return [moved.place(point).d1 for moved in self.taped.by_input]

    def turning(self, link: str) -> Any:
        """Derivatives of a link's angle with respect to each input."""
        if link == GROUND:
            return [np.zeros(self.rows) for _ in self.model.equations.inputs]
        if self.alone:
            return [self.angle(link).d1]
        return [Geometry(self.model, moved).angle(link).d1 for moved in self.taped.by_input]

    def partial_local(self, link: str, place: Any) -> Any:
        """Derivatives of a point in the frame of a link with respect to each input."""
        arm = 1j * self.direction(link).v * place
        pairs = zip(self.partial(self.links[link][0]), self.turning(link), strict=True)
        return [moved + turned * arm for moved, turned in pairs]


class LoadedRows(DifferentiatedRows):
    """Differentiated rows with the forces of their loads; parameters as of the base class."""

    def force(self, name: str) -> Any:
        """An effort, reaction, energy or total on the tape, (B,).

        Raises
        ------
        InputError
            If its derivatives are not known.
        """
        try:
            with np.errstate(all="ignore"):
                for table in ("_efforts", "_totals", "_reactions"):
                    known: dict[str, Any] = getattr(self, table)
                    if name in known:
                        return known[name]
        except (NotElementwise, TypeError, AttributeError):
            pass  # a part whose reactions take decisions row by row
        raise InputError(f'the derivatives of "{name}" are not known: sample its tolerance')

    @cached_property
    def _loads(self) -> AppliedLoads:
        """All loads; those of a linkage are those of its free bodies."""
        geometry, description = TapedGeometry(self), self.description
        assert isinstance(description, LoadedBodies)
        applied = AppliedLoads(geometry, 0.0 if self.speed is None else self.speed)
        if getattr(description, "friction", None):
            raise NotElementwise
        applied.weigh(description)
        if isinstance(description, Linkage):
            bodies = FreeBodies(description, geometry, applied)
            for part in description.parts:
                if isinstance(part, Load | Spring):
                    join_part(part, bodies)
        elif isinstance(description, Loops):
            for load in description.loads:
                apply_load(load, applied)
        return applied

    @cached_property
    def _efforts(self) -> dict[str, Any]:
        """Efforts of all inputs by virtual work, and their power."""
        inputs = self.equations.inputs
        found: list[Any] = [np.zeros(len(self.solution)) for _ in inputs]
        for load, moved in work_terms(self._loads):
            for k, own in enumerate(moved):
                found[k] = found[k] - (np.conj(load) * own).real  # eq. (71)
        named = {effort_name(x.name): own for x, own in zip(inputs, found, strict=True)}
        if self.speed is not None:
            rates = zip(self._input_rate, found, strict=True)
            named["power"] = sum((rate * own for rate, own in rates), 0.0) * self.speed
        return named

    @cached_property
    def _totals(self) -> dict[str, Any]:
        """Forces on the ground, energies and powers."""
        applied = self._loads
        return {name: value for name, _, _, value in totals(applied.geometry, applied)}

    @cached_property
    def _reactions(self) -> dict[str, Any]:
        """Reactions of all joints of a linkage."""
        description, geometry = self.description, TapedGeometry(self)
        if not isinstance(description, Linkage):
            return {}
        applied = AppliedLoads(geometry, 0.0 if self.speed is None else self.speed)
        applied.weigh(description)
        bodies = FreeBodies(description, geometry, applied)
        join_pins(bodies)
        join_parts(bodies)
        drive_inputs(bodies)
        return _Equilibrium(bodies, self.tape).readings()


class _Equilibrium:
    """The equilibrium of free bodies whose acts are on a tape."""

    def __init__(self, bodies: FreeBodies, tape: Tape) -> None:
        self.bodies, self.tape = bodies, tape
        rows = bodies.geometry.rows
        matrix = np.zeros((rows, bodies.equations, len(bodies.unknowns)))
        #: Of every unknown: rows of W and what is there.
        self.columns: list[list[tuple[int, Any]]] = []
        for k, acts in enumerate(bodies.unknowns):
            column = [entry for act in acts for entry in bodies.entries(act)]
            for row, value in column:
                matrix[:, row, k] += _bare(value)
            self.columns.append(column)
        self.balance = balance(matrix)

    def solve(self, acts: Iterable[Act]) -> list[Any]:
        """The unknowns for known acts, (B,) each on the tape."""
        geometry, bodies = self.bodies.geometry, self.bodies
        loads = np.zeros((geometry.rows, bodies.equations))
        rest: list[Any] = [np.zeros(geometry.rows) for _ in range(bodies.equations)]
        for act in acts:
            for row, value in bodies.entries(act):
                loads[:, row] += _bare(value)
                rest[row] = rest[row] + value
        r = self.balance.solve(loads)
        for k, column in enumerate(self.columns):
            for row, value in column:
                rest[row] = rest[row] + value * r[:, k]
        inverse = self.balance.inverse
        # eq. (90)
        return [
            self.tape.combine(r[:, k], [(-inverse[:, k, i], part) for i, part in enumerate(rest)])
            for k in range(r.shape[1])
        ]

    def readings(self) -> dict[str, Any]:
        """All named quantities."""
        bodies = self.bodies
        acts = known_acts(bodies)
        r = self.solve(acts)
        sizes = []
        for k, size, follow in bodies.following:
            amount: Any = size(r[k])
            sizes.append(amount)
            acts += [Act(a.on, a.place, a.force * amount, a.moment) for a in follow]
        if sizes:
            r = self.solve(acts)
        read_first_links(bodies, acts)
        found: dict[str, Any] = {}
        for reading in bodies.readings:
            value = reading.constant + sum((f * r[k] for k, f in reading.terms), 0.0)
            if reading.follow is not None:
                value = value + sizes[reading.follow]
            found[reading.name] = value
        return found


def _bare(value: Any) -> Array:
    """The values of a number that may be on a tape."""
    return value.values if is_batched(value) else value
