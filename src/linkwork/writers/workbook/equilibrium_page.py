"""The sheet of the equilibrium in a selected row: reactions, and one free body for each link."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import cell_text
from linkwork.writers.formulas.traced import LinearForm, Trace, TracedNumber, forms_of
from linkwork.writers.workbook.acting import Act, Follower, Unknown
from linkwork.writers.workbook.book import CYCLE, FIRST, FORCES, Book, cached, column_name
from linkwork.writers.workbook.force_page import ForceColumns
from linkwork.writers.workbook.layout import print_on_one_page
from linkwork.writers.workbook.load_cells import LoadCells
from linkwork.writers.workbook.parts import contacts_of, join_links
from linkwork.writers.workbook.reactions import Reactions

EQUILIBRIUM = "Equilibrium"
_ROWS = ("force x", "force y", "moment")


def write_equilibrium(
    book: Book, sheet: Any, cells: LoadCells, columns: ForceColumns, cycle: dict[str, int]
) -> None:
    """Write the sheet."""
    _Page(book, sheet, cells.linkage, columns, cycle).write()


@dataclass
class _Page:
    book: Book
    sheet: Any
    linkage: Linkage
    columns: ForceColumns
    cycle: dict[str, int]
    row: int = 3

    def __post_init__(self) -> None:
        self.bodies = [link for link in self.linkage.links if link != GROUND]
        units = self.book.model.units
        self.length, force = units.of(Kind.LENGTH), units.of(Kind.FORCE)
        self.sums = tuple(zip(_ROWS, (force, force, units.of(Kind.MOMENT)), strict=True))
        self.trace, self.names = Trace(), dict(self.book.names.of)
        self.at: dict[str, Any] = {}
        self.along: dict[str, Any] = {}
        self.way: dict[str, Any] = {}

    def write(self) -> None:
        """Write points, lines, loads, the linear equations, and the free bodies."""
        book, sheet = self.book, self.sheet
        book.title(sheet, "equilibrium in one row")
        for column, width in enumerate((26, 14, 14, 14, *[13] * 60)):
            sheet.set_column(column, column, width)
        sheet.write(1, 0, "The row is chosen on the sheet Drawing.", book.style["note"])
        sheet.write(2, 0, "row shown", book.style["head_left"])
        sheet.write_formula(2, 1, "=row_shown", book.style["count"], book.row_shown + 1)
        self._points()
        self._lines()
        reactions = self._reactions()
        if len(reactions.unknowns) != 3 * len(self.bodies):
            message = "Redundant links: equilibrium does not determine all reactions."
            sheet.write(self.row + 1, 0, message, book.style["warning"])
            return
        loads = list(self._loads())
        self._system(reactions, loads)
        self._free_bodies(reactions, loads)
        print_on_one_page(sheet, tall=0)

    def _reactions(self) -> Reactions:
        def number(key: str) -> Any:
            return self._named(key, float(self.book.values[key]))

        reactions = Reactions(self.book.model, self.linkage, self.along, self.way, number)
        join_links(reactions)
        return reactions

    def _named(self, name: str, value: float) -> Any:
        """A number with a name in formulas."""
        return self.trace.number(value, LinearForm.named(name))

    def _cell(self, row: int, column: int, value: float) -> Any:
        """The number in a cell."""
        address = f"${column_name(column)}${row + 1}"
        self.names[address] = address
        return self._named(address, value)

    # What is picked from other sheets

    def _pick(self, key: str, column: int) -> Any:
        """Write the number of a quantity in the row that is shown."""
        sheet, of = (CYCLE, self.cycle) if key in self.cycle else (FORCES, self.columns.of)
        area = f"{sheet}!$#${FIRST + 1}:$#${self.book.last}".replace("#", column_name(of[key]))
        value = float(self.book.over_rows(self.book.values[key])[self.book.row_shown])
        self._formula(self.row, column, f"INDEX({area},row_shown)", value)
        return self._cell(self.row, column, value)

    def _heads(self, first: str, *titles: tuple[str, str]) -> None:
        """A line of headings, and one of their units if there are any."""
        style = self.book.style
        self.row += 1
        self.sheet.write(self.row, 0, first, style["head_left"])
        for column, (title, _) in enumerate(titles, start=1):
            self.sheet.write(self.row, column, title, style["head"])
        self.row += 1
        if any(unit for _, unit in titles):
            self.sheet.write(self.row, 0, "", style["unit"])
            for column, (_, unit) in enumerate(titles, start=1):
                self.sheet.write(self.row, column, unit, style["unit"])
            self.row += 1

    def _points(self) -> None:
        self._heads("point", *zip("xy", [self.length] * 2, strict=True))
        for point in self.book.closure.points:
            self.sheet.write(self.row, 0, point)
            x, y = (self._pick(coordinate_name(point, a), k) for k, a in enumerate("xy", start=1))
            self.at[point] = x + 1j * y
            self.row += 1

    def _lines(self) -> None:
        """The unit vectors of lines, and where parts push each other."""
        candidates = {
            part.label: part.body or getattr(part, "line", None) for part in self.linkage.parts
        }
        lines = {name: line for name, line in candidates.items() if line}
        if lines:
            self._heads("line", ("along x", ""), ("along y", ""))
        for name, (start, end) in lines.items():
            along = self.at[end] - self.at[start]
            self.along[name] = self._vector(name, 1, along / abs(along))
            self.row += 1
        contacts = list(contacts_of(self.linkage, self.at))
        if contacts:
            places = ("x", self.length), ("y", self.length)
            self._heads("contact", *places, ("along x", ""), ("along y", ""))
        for contact in contacts:
            self.at[contact.name] = self._vector(contact.name, 1, contact.place)
            self.way[contact.name] = self._vector(contact.name, 3, contact.way)
            self.row += 1

    def _vector(self, title: str, column: int, z: Any) -> Any:
        """Two cells with the components of a vector, from this column on; the vector of them."""
        self.sheet.write(self.row, 0, title)
        return self._write(self.row, column, z.real) + 1j * self._write(
            self.row, column + 1, z.imag
        )

    # Loads

    def _loads(self) -> Iterator[tuple[str, Act]]:
        """Masses, forces and torques in the row, with their names."""
        self._heads("load", *self.sums, ("at x", self.length), ("at y", self.length))
        carriers = self.linkage.carriers()
        for link in self.columns.masses:
            keys = [f"{link} force x", f"{link} force y", f"{link} torque"]
            keys += [f"{link} center x", f"{link} center y"]
            name = f"mass of {link}"
            x, y, moment, px, py = self._picked(name, keys)
            self.at[name] = px + 1j * py
            yield name, Act(link, name, x + 1j * y, moment)
        for point, on_link, kx, ky in self.columns.forces:
            x, y = self._picked(f"load on {point}", [kx, ky])
            yield f"load on {point}", Act(on_link or carriers[point][0], point, x + 1j * y)
        for link, key in self.columns.torques:
            (moment,) = self._picked(f"torque on {link}", [key], first=3)
            yield f"torque on {link}", Act(link, "", moment=moment)

    def _picked(self, name: str, keys: list[str], first: int = 1) -> list[Any]:
        self.sheet.write(self.row, 0, name)
        entries = [self._pick(key, column) for column, key in enumerate(keys, start=first)]
        self.row += 1
        return entries

    # Equations

    def _parts(self, link: str, acts: Iterable[Act]) -> tuple[Any, Any, Any]:
        """The sums of forces and moments of acts on a link, about its first point."""
        force, moment = self.trace.plain(0.0), self.trace.plain(0.0)
        origin = self.at[self.linkage.links[link][0]]
        for act in acts:
            if act.link == link:
                force, moment = force + act.force, moment + act.moment
                if act.point:
                    arm = self.at[act.point] - origin
                    moment += (arm.conjugate() * act.force).imag
        return force.real, force.imag, moment

    def _system(self, reactions: Reactions, loads: list[tuple[str, Act]]) -> None:
        """The matrix, the loads, and the solution."""
        unknowns, followers = reactions.unknowns, reactions.followers
        size = len(unknowns)
        heads = [*((amount.name, "") for amount in unknowns), ("loads" if followers else "b", "")]
        if followers:  # these follow from the unknowns under the loads alone
            heads += [*((amount.name, "") for amount in followers), ("b", "")]
        self._heads("W r + b = 0", *heads)
        top = self.row
        acts = [
            *(amount.acts for amount in unknowns),
            [act for _, act in loads],
            *(amount.acts for amount in followers),
        ]
        # values for programs that do not calculate; the formulas stand on their own
        table = np.zeros((size, len(acts)))
        for k, link in enumerate(self.bodies):
            sums = [self._parts(link, amount) for amount in acts]
            for part, word in enumerate(_ROWS):
                self.sheet.write(self.row, 0, f"{word} on {link}")
                for column, entries in enumerate(sums):
                    table[3 * k + part, column] = _value_of(entries[part])
                    self._write(self.row, column + 1, entries[part])
                self.row += 1
        self._solve(reactions, table, top)

    def _solve(self, reactions: Reactions, table: Array, top: int) -> None:
        """The reactions, and the forces that follow from them: they complete the loads."""
        unknowns, followers = reactions.unknowns, reactions.followers
        size = len(unknowns)
        first = top + size + 2  # the row of the first reaction
        matrix, right = table[:, :size], table[:, size]
        plain = _solution(matrix, right)
        sizes = []
        for amount in followers:
            which = [unknown.name for unknown in unknowns].index(amount.of)
            self.names[amount.of] = f"({self._row_of_solution(which, size, top, size + 1)})"
            sizes.append(amount.size(self._named(amount.of, plain[which])))
        total = right + table[:, size + 1 :] @ [_value_of(entry) for entry in sizes]
        side = size + 1
        if followers:
            side = size + len(followers) + 2
            for line, value in enumerate(total.tolist()):
                row = top + line + 1
                terms = [f"${column_name(size + 1)}{row}"]
                terms += [
                    f"$B${first + size + k + 1}*${column_name(size + 2 + k)}{row}"
                    for k in range(len(followers))
                ]
                self._formula(row - 1, side, "+".join(terms), value)
        solution = _solution(matrix, total)
        self._heads("reaction", ("value", ""))
        self.sheet.write(self.row - 1, 2, "unit", self.book.style["head_indented"])
        assert self.row == first
        self.solved: dict[str, Any] = {}
        for k, unknown in enumerate(unknowns):
            text = self._row_of_solution(k, size, top, side)
            self._formula(self.row, 1, text, float(solution[k]))
            self._result(unknown.name, unknown.unit, self._cell(self.row, 1, float(solution[k])))
        for amount, entry in zip(followers, sizes, strict=True):
            self._result(amount.name, amount.unit, self._write(self.row, 1, entry))
        for reading in reactions.readings:
            parts = (self.solved[name] * weight for name, weight in reading.weights.items())
            entry = sum(parts, self.trace.plain(0.0))
            self._result(reading.name, reading.unit, self._write(self.row, 1, entry))
        units = {amount.name: amount.unit for amount in unknowns}
        for key, name in self.columns.efforts.items():
            self.sheet.write(self.row, 0, f"{name} by virtual work")
            self._pick(key, 1)
            self.sheet.write(self.row, 2, units[name], self.book.style["unit_right"])
            self.row += 1

    def _result(self, name: str, unit: str, number: Any) -> None:
        """The name and unit of a number in the second column."""
        self.sheet.write(self.row, 0, name)
        self.sheet.write(self.row, 2, unit, self.book.style["unit_right"])
        self.solved[name] = number
        self.row += 1

    @staticmethod
    def _row_of_solution(k: int, size: int, top: int, side: int) -> str:
        """One unknown of the linear equations, with the loads in a column."""
        area = f"$B${top + 1}:${column_name(size)}${top + size}"
        right = f"${column_name(side)}${top + 1}:${column_name(side)}${top + size}"
        # MMULT, MINVERSE and SUMPRODUCT accept arrays without an array formula
        unit = ";".join("1" if j == k else "0" for j in range(size))
        return f"-SUMPRODUCT(MMULT(MINVERSE({area}),{right}),{{{unit}}})"

    def _write(self, row: int, column: int, number: Any) -> Any:
        """Write a number or its formula; the number in this cell."""
        form, value = forms_of(number)[0], _value_of(number)
        if form.fixed:
            self.sheet.write_number(row, column, value, self.book.style["count"])
        else:
            self._formula(row, column, cell_text(form.node, self.names), value)
        return self._cell(row, column, value)

    def _formula(self, row: int, column: int, text: str, value: float) -> None:
        look = self.book.style["number"]
        self.sheet.write_formula(row, column, f"={text}", look, cached(value))

    def _free_bodies(self, reactions: Reactions, loads: list[tuple[str, Act]]) -> None:
        """All forces on every link, and their sums, which are zero."""
        style = self.book.style
        acting: Sequence[Unknown | Follower] = [*reactions.unknowns, *reactions.followers]
        for link in self.bodies:
            self._heads(f"free body {link}", *self.sums)
            begin, sums = self.row, np.zeros(3)
            for force in acting:
                if all(act.link != link for act in force.acts):
                    continue
                solved = self.solved[force.name]
                entries = [solved * entry for entry in self._parts(link, force.acts)]
                sums += self._line(force.name, entries)
            for name, act in loads:
                if act.link == link:
                    sums += self._line(name, self._parts(link, [act]))
            self.sheet.write(self.row, 0, "sum", style["head_left"])
            for column in range(3):
                letter = column_name(column + 1)
                text = f"=SUM({letter}{begin + 1}:{letter}{self.row})"
                known = cached(float(sums[column]))
                self.sheet.write_formula(self.row, column + 1, text, style["small"], known)
            self.row += 1

    def _line(self, name: str, entries: Sequence[Any]) -> Array:
        """A line of a free body; its values."""
        self.sheet.write(self.row, 0, name)
        for column, entry in enumerate(entries):
            self._write(self.row, column + 1, entry)
        self.row += 1
        return np.array([_value_of(entry) for entry in entries])


def _value_of(number: Any) -> float:
    """The value of a real number, traced or plain."""
    return float(np.real(number.values[0])) if isinstance(number, TracedNumber) else float(number)


def _solution(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(-np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:  # at a dead point nothing balances the loads
        return np.full(len(right), np.nan)
