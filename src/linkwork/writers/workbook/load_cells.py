"""The sheet of loads: cells for masses, gravity, forces, torques and springs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from linkwork.contacts.cams import Cam
from linkwork.contacts.curves import Curve, NoncircularGear
from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Name, Node, names_in
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import force_of_inertia
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import carriers
from linkwork.core.mechanism.part.springs import Load
from linkwork.couplings.coupling import LinearCoupling
from linkwork.forces.reactions.parts import wound_angle
from linkwork.writers.formulas.closure_formulas import of_radians, rebuilt
from linkwork.writers.formulas.rate_formulas import rate_key
from linkwork.writers.workbook.book import Book, print_on_one_page
from linkwork.writers.workbook.reactions import numbers_of

LOADS = "Loads"
_DOWN = -math.pi / 2.0


def force_problem(book: Book) -> str | None:
    """Why a loaded mechanism has no sheets of forces; ``""`` without loads, ``None`` with them."""
    linkage = book.model.description
    if not isinstance(linkage, Linkage) or not linkage.loaded or not linkage.inputs:
        return ""
    without = Cam | Curve | NoncircularGear | LinearCoupling
    others = [part for part in linkage.parts if isinstance(part, without)]
    if others:
        return f"the forces of {others[0].label} ({others[0].title.lower()}) have no cells"
    loose = [
        point
        for point, names in carriers(linkage).items()
        if names and not any(name in linkage.links for name in names)
    ]
    if loose:
        return f"the forces of {loose[0]}, a pin between cylinders, have no cells"
    turning = {variable.symbol for variable in book.model.equations.variables}
    for spring in LoadCells(book, None).pulling:
        for link in spring.links or ():
            if link != GROUND and canonical(link) not in turning:
                return f"the angle of {link}, for its torsion spring, has no cell"
    if linkage.friction:
        return "friction has no cells"
    if any(not sides for sides in book.rates.sides):
        return "velocities without formulas give no forces"
    for load in linkage.loads:
        for _, number in load.formulas:
            if isinstance(number, str):
                for name in names_in(parse(number, comparing=True)):
                    if _key(book, name.name) is None:
                        return f'the load "{number}" uses {name.spelling}, which has no cell'
    return None


def _key(book: Book, name: str) -> str | None:
    """The key of the cell that a load's formula means; "" for a constant."""
    if name == "t":
        return "time"
    if name in CONSTANTS:
        return ""
    for variable in book.model.equations.variables:
        if canonical(name) in (canonical(variable.name), variable.symbol):
            return variable.symbol
        for word, order in (("velocity", 1), ("acceleration", 2)):
            if canonical(name) == canonical(f"{variable.name}.{word}"):
                return rate_key(variable.symbol, order)
    # dimensions last: a file may not give them the names of its unknowns
    known = {canonical(d.name): d.key for d in book.dimensions if d.kind == "dimensions"}
    if canonical(name) in known:
        return known[canonical(name)]
    points = {coordinate_name(point, axis) for point in book.closure.points for axis in "xy"}
    return name if name in points else None


@dataclass
class LoadCells:
    """The keys of the cells of a load sheet; ``loads`` with the formulas of their components."""

    book: Book
    sheet: Any
    row: int = 3
    loads: list[tuple[Load, tuple[Node, ...]]] = field(default_factory=list)

    @property
    def linkage(self) -> Linkage:
        """The mechanism."""
        description = self.book.model.description
        assert isinstance(description, Linkage)
        return description

    @property
    def masses(self) -> Iterator[str]:
        """The moving links with masses."""
        return (link for link in self.linkage.masses if link != GROUND)

    @property
    def pulling(self) -> tuple[Any, ...]:
        """The springs with a stiffness or a damping."""
        return tuple(spring for spring in self.linkage.springs if spring.pulls)

    def number(self, key: str, value: float, unit: str, about: str) -> None:
        """A yellow cell with a name."""
        book, style = self.book, self.book.style
        cell = book.names.claim(key, key.replace(" ", "_"))
        self.sheet.write(self.row, 0, cell, style["head_left"])
        self.sheet.write_number(self.row, 1, value, style["input"])
        self.sheet.write(self.row, 2, unit, style["unit_right"])
        self.sheet.write(self.row, 3, about, style["note"])
        book.define(key, LOADS, f"$B${self.row + 1}")
        book.values[key] = value
        self.row += 1


def write_loads(book: Book, sheet: Any) -> LoadCells:
    """Write the cells of all loads."""
    cells = LoadCells(book, sheet)
    linkage, numbers = cells.linkage, book.model.description.numbers
    for column, width in enumerate((24, 16, 18, 60)):
        sheet.set_column(column, column, width)
    book.title(sheet, "masses, loads and springs")
    note = "Edit a yellow cell: the sheets Forces and Equilibrium follow."
    sheet.write(1, 0, note, book.style["note"])
    # the sheet Velocities has rates at unit speed without one, which load nothing
    moving = 0.0 if book.motion.speed is None else 1.0
    cells.number("moving", moving, "", "1: masses have inertia; 0: at rest")
    if linkage.masses:
        scale = force_of_inertia(linkage.mass, linkage.length, linkage.force)
        unit = f"{linkage.force} per {linkage.mass}·{linkage.length}/s²"
        cells.number("force unit", scale, unit, "force of a unit of inertia")
        gravity = linkage.gravity
        size = 0.0 if gravity is None else gravity.acceleration(numbers, linkage.length)
        stated = None if gravity is None else gravity.angle
        angle = _DOWN if stated is None else numbers(stated) * linkage.angle.radians
        for axis, part in (("x", math.cos(angle)), ("y", math.sin(angle))):
            # cos(-90°) is not zero in floating point
            part = 0.0 if abs(part) < 1e-16 else part
            unit = f"{linkage.length}/s²"
            cells.number(f"gravity {axis}", size * part, unit, f"gravity along {axis}")
    _write_masses(cells)
    force, length = linkage.force, linkage.length
    for spring in cells.pulling:
        free = numbers(spring.free)
        units = f"{force}/{length}", length, f"{force}·s/{length}"
        if spring.links is not None:
            free = wound_angle(spring, linkage) / linkage.angle.radians
            units = f"{force}·{length}/rad", linkage.angle.value, f"{force}·{length}·s"
        amounts = numbers(spring.stiffness), free, numbers(spring.damping)
        for word, value, unit in zip(("stiffness", "free", "damping"), amounts, units, strict=True):
            cells.number(f"{spring.name} {word}", value, unit, "spring")
    for name, word, value, kind, about in numbers_of(linkage):
        cells.number(f"{name} {word}", value, book.model.units.of(kind), about)
    for k, load in enumerate(linkage.loads, start=1):
        _write_load(cells, k, load)
    print_on_one_page(sheet, tall=0)
    return cells


def _write_masses(cells: LoadCells) -> None:
    linkage = cells.linkage
    mass_unit, length = linkage.mass, linkage.length
    for link in cells.masses:
        mass, numbers = linkage.masses[link], linkage.numbers
        cells.number(f"mass {link}", numbers(mass.mass), mass_unit, f"mass of {link}")
        if mass.shape is not None:
            continue  # a rod follows its length
        for axis, part in zip("xy", mass.center or (0.0, 0.0), strict=True):
            about = f"centre of mass of {link}, in the frame of the link"
            cells.number(f"center {link} {axis}", numbers(part), length, about)
        unit, about = f"{mass_unit}·{length}²", f"moment of inertia of {link} about its centre"
        cells.number(f"inertia {link}", numbers(mass.inertia), unit, about)


def _write_load(cells: LoadCells, k: int, load: Load) -> None:
    """A load: cells of its numbers; formulas go to the sheet Forces."""
    linkage = cells.linkage
    unit = linkage.force if load.torque is None else f"{linkage.force}·{linkage.length}"
    parts: list[Node] = []

    def named(part: Node) -> Node:
        key = _key(cells.book, part.name) if isinstance(part, Name) else None
        return Name(key) if key else part

    for word, number in _components(load):
        if isinstance(number, str):
            formula = of_radians(parse(number, comparing=True), linkage.angle)
            parts.append(rebuilt(formula, named))
        else:
            key = f"load{k} {word}"
            cells.number(key, linkage.numbers(number), unit, load.label)
            parts.append(Name(key))
    cells.loads.append((load, tuple(parts)))


def _components(load: Load) -> list[tuple[str, Number]]:
    if load.torque is not None:
        return [("torque", load.torque)]
    return [("x", (load.force or (0, 0))[0]), ("y", (load.force or (0, 0))[1])]
