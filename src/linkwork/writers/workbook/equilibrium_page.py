"""The sheet of the equilibrium in a selected row: reactions, and one free body for each link."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.quantity import Kind
from linkwork.writers.workbook.acting import NO, Act, Entry, Follower, Unknown, computed
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
    place: dict[str, int] = field(default_factory=dict)
    row: int = 3

    def __post_init__(self) -> None:
        solved = np.flatnonzero(self.book.iterations.found)
        self.shown = int(solved[len(solved) // 6])
        self.bodies = [link for link in self.linkage.links if link != GROUND]
        units = self.book.model.units
        self.length, force = units.of(Kind.LENGTH), units.of(Kind.FORCE)
        self.sums = tuple(zip(_ROWS, (force, force, units.of(Kind.MOMENT)), strict=True))

    def write(self) -> None:
        """Write points, lines, loads, the linear equations, and the free bodies."""
        book, sheet = self.book, self.sheet
        book.title(sheet, "equilibrium in one row")
        for column, width in enumerate((26, 14, 14, 14, *[13] * 60)):
            sheet.set_column(column, column, width)
        sheet.write(1, 0, "The row is chosen on the sheet Drawing.", book.style["note"])
        sheet.write(2, 0, "row shown", book.style["head_left"])
        sheet.write_formula(2, 1, "=row_shown", book.style["count"], self.shown + 1)
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
        cells = {
            key: Entry(name, self.book.values[key])
            for key, name in self.book.names.cells.items()
            if key in self.book.values and np.ndim(self.book.values[key]) == 0
        }
        reactions = Reactions(self.book.model, self.linkage, self.along, self.way, cells)
        join_links(reactions)
        return reactions

    # What is picked from other sheets

    def _pick(self, sheet: str, column: int, value: float, at: tuple[int, int]) -> Entry:
        letter = column_name(column)
        area = f"{sheet}!${letter}${FIRST + 1}:${letter}${self.book.last}"
        style = self.book.style["number"]
        self.sheet.write_formula(*at, f"=INDEX({area},row_shown)", style, cached(value))
        return Entry(f"${column_name(at[1])}${at[0] + 1}", value)

    def _value(self, key: str) -> float:
        return float(self.book.over_rows(self.book.values[key])[self.shown])

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
        self.at: dict[str, tuple[Entry, Entry]] = {}
        for point in self.book.closure.points:
            self.sheet.write(self.row, 0, point)
            keys = [coordinate_name(point, axis) for axis in "xy"]
            entries = [
                self._pick(CYCLE, self.cycle[key], self._value(key), (self.row, column))
                for column, key in enumerate(keys, start=1)
            ]
            self.at[point] = (entries[0], entries[1])
            self.row += 1

    def _lines(self) -> None:
        """The unit vectors of lines, and where parts push each other."""
        candidates = {
            part.label: part.body or getattr(part, "line", None) for part in self.linkage.parts
        }
        lines = {name: line for name, line in candidates.items() if line}
        if lines:
            self._heads("line", ("along x", ""), ("along y", ""))
        self.along: dict[str, tuple[Entry, Entry]] = {}
        for name, (start, end) in lines.items():
            ends = self._coordinates({"a": start, "b": end})
            span = "hypot(bx-ax, by-ay)"
            self.along[name] = self._vector(name, 1, (f"(bx-ax)/{span}", f"(by-ay)/{span}"), ends)
            self.row += 1
        self.way: dict[str, tuple[Entry, Entry]] = {}
        for k, contact in enumerate(contacts_of(self.linkage)):
            if not k:
                self._heads(
                    "contact", ("x", self.length), ("y", self.length), ("along x", ""),
                    ("along y", ""),
                )  # fmt: skip
            names = self._coordinates(contact.points)
            self.at[contact.name] = self._vector(contact.name, 1, contact.place, names)
            self.way[contact.name] = self._vector(contact.name, 3, contact.way, names)
            self.row += 1

    def _coordinates(self, points: dict[str, str]) -> dict[str, Entry]:
        """The coordinates of points as names of formulas: ``ax``, ``ay`` of ``a``."""
        return {
            f"{letter}{axis}": entry
            for letter, point in points.items()
            for axis, entry in zip("xy", self.at[point], strict=True)
        }

    def _vector(
        self, title: str, column: int, texts: tuple[str, str], names: dict[str, Entry]
    ) -> tuple[Entry, Entry]:
        """Two cells of formulas, from this column on."""
        self.sheet.write(self.row, 0, title)
        entries = []
        for k, text in enumerate(texts, start=column):
            entry = computed(text, names)
            self._write(self.row, k, entry)
            entries.append(Entry(f"${column_name(k)}${self.row + 1}", entry.value))
        return entries[0], entries[1]

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
            self.at[name] = (px, py)
            yield name, Act(link, name, x, y, moment)
        for point, on_link, kx, ky in self.columns.forces:
            x, y = self._picked(f"load on {point}", [kx, ky])
            yield f"load on {point}", Act(on_link or carriers[point][0], point, x, y)
        for link, key in self.columns.torques:
            (moment,) = self._picked(f"torque on {link}", [key], first=3)
            yield f"torque on {link}", Act(link, "", moment=moment)

    def _picked(self, name: str, keys: list[str], first: int = 1) -> list[Entry]:
        self.sheet.write(self.row, 0, name)
        entries = [
            self._pick(FORCES, self.columns.of[key], self._value(key), (self.row, column))
            for column, key in enumerate(keys, start=first)
        ]
        self.row += 1
        return entries

    # Equations

    def _moment(self, link: str, act: Act) -> Entry:
        """The moment of an act about the first point of a link."""
        if not act.point:
            return act.moment
        (px, py), (cx, cy) = self.at[act.point], self.at[self.linkage.links[link][0]]
        value = (px.value - cx.value) * act.y.value - (py.value - cy.value) * act.x.value
        text = f"({px.text}-{cx.text})*({act.y.text})-({py.text}-{cy.text})*({act.x.text})"
        if act.moment != NO:
            text = f"{text}+({act.moment.text})"
        return Entry(text, value + act.moment.value)

    def _parts(self, link: str, acts: Iterable[Act]) -> tuple[Entry, Entry, Entry]:
        """The sums of forces and moments of acts on a link."""
        terms = [(act.x, act.y, self._moment(link, act)) for act in acts if act.link == link]
        sums = []
        for part in range(3):
            entries = [each[part] for each in terms if each[part] != NO]
            text = "+".join(f"({entry.text})" for entry in entries) if len(entries) > 1 else ""
            total = Entry(text, sum(entry.value for entry in entries))
            sums.append(total if text else entries[0] if entries else NO)
        return sums[0], sums[1], sums[2]

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
                    table[3 * k + part, column] = entries[part].value
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
            text = self._row_of_solution(which, size, top, size + 1)
            entry = computed(
                amount.size, {**amount.names, "t": Entry(text, plain[which])}, self.linkage.angle
            )
            sizes.append(entry)
        total = right + table[:, size + 1 :] @ [entry.value for entry in sizes]
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
                self._write(row - 1, side, Entry("+".join(terms), value))
        solution = _solution(matrix, total)
        self._heads("reaction", ("value", ""))
        self.sheet.write(self.row - 1, 2, "unit", self.book.style["head_indented"])
        assert self.row == first
        self.solved: dict[str, Entry] = {}
        for k, unknown in enumerate(unknowns):
            entry = Entry(self._row_of_solution(k, size, top, side), float(solution[k]))
            self._result(unknown.name, unknown.unit, entry)
        for amount, entry in zip(followers, sizes, strict=True):
            self._result(amount.name, amount.unit, entry)
        for reading in reactions.readings:
            names = {
                letter: self.solved[name] for letter, name in zip("ab", reading.of, strict=False)
            }
            self._result(
                reading.name, reading.unit, computed(reading.text, {**names, **reading.names})
            )
        units = {amount.name: amount.unit for amount in unknowns}
        for key, name in self.columns.efforts.items():
            self.sheet.write(self.row, 0, f"{name} by virtual work")
            self._pick(FORCES, self.columns.of[key], self._value(key), (self.row, 1))
            self.sheet.write(self.row, 2, units[name], self.book.style["unit_right"])
            self.row += 1

    def _result(self, name: str, unit: str, entry: Entry) -> None:
        self.sheet.write(self.row, 0, name)
        self._write(self.row, 1, entry)
        self.sheet.write(self.row, 2, unit, self.book.style["unit_right"])
        self.solved[name] = Entry(f"$B${self.row + 1}", entry.value)
        self.row += 1

    @staticmethod
    def _row_of_solution(k: int, size: int, top: int, side: int) -> str:
        """One unknown of the linear equations, with the loads in a column."""
        area = f"$B${top + 1}:${column_name(size)}${top + size}"
        right = f"${column_name(side)}${top + 1}:${column_name(side)}${top + size}"
        # MMULT, MINVERSE and SUMPRODUCT accept arrays without an array formula
        unit = ";".join("1" if j == k else "0" for j in range(size))
        return f"-SUMPRODUCT(MMULT(MINVERSE({area}),{right}),{{{unit}}})"

    def _write(self, row: int, column: int, entry: Entry) -> None:
        style = self.book.style
        if entry.text in ("0", "1"):
            self.sheet.write_number(row, column, entry.value, style["count"])
        else:
            known = cached(entry.value)
            self.sheet.write_formula(row, column, f"={entry.text}", style["number"], known)

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
                entries = [
                    Entry(f"{solved.text}*({entry.text})", solved.value * entry.value)
                    for entry in self._parts(link, force.acts)
                ]
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

    def _line(self, name: str, entries: Sequence[Entry]) -> Array:
        """A line of a free body; its values."""
        self.sheet.write(self.row, 0, name)
        for column, entry in enumerate(entries):
            self._write(self.row, column + 1, entry)
        self.row += 1
        return np.array([entry.value for entry in entries])


def _solution(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(-np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:  # at a dead point nothing balances the loads
        return np.full(len(right), np.nan)
