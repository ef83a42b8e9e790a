"""The sheet of the equilibrium in a selected row: reactions, and one free body for each link."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.export.workbook.book import CYCLE, FIRST, FORCES, Book, cached, column_name
from linkwork.export.workbook.force_page import ForceColumns
from linkwork.export.workbook.load_cells import LoadCells
from linkwork.export.workbook.page_layout import print_on_one_page
from linkwork.foundation.names import GROUND
from linkwork.mechanism.linkage import Linkage
from linkwork.results.quantity import Kind

__all__ = ["EQUILIBRIUM", "write_equilibrium"]

EQUILIBRIUM = "Equilibrium"
_ROWS = ("force x", "force y", "moment")


@dataclass(frozen=True)
class _Entry:
    """The text of a formula, without equals sign, and its value."""

    text: str
    value: float


_NO, _ONE = _Entry("0", 0.0), _Entry("1", 1.0)


@dataclass(frozen=True)
class _Act:
    """What a unit of something, or a load, does to a link at a point."""

    link: str
    point: str
    x: _Entry = _NO
    y: _Entry = _NO
    moment: _Entry = _NO


def _minus(entry: _Entry) -> _Entry:
    return entry if entry == _NO else _Entry(f"-({entry.text})", -entry.value)


@dataclass(frozen=True)
class _Unknown:
    """A reaction: its name, unit and acts on two links."""

    name: str
    unit: str
    acts: tuple[_Act, ...]


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
        found = np.flatnonzero(self.book.iterations.found)
        self.shown = int(found[len(found) // 6])
        self.bodies = [link for link in self.linkage.links if link != GROUND]

    def write(self) -> None:
        """Write points, lines, loads, the linear equations, and the free bodies."""
        book, sheet = self.book, self.sheet
        book.title(sheet, "equilibrium in one row")
        for column, width in enumerate((26, 14, 14, 14, *[11] * 60)):
            sheet.set_column(column, column, width)
        sheet.write(1, 0, "The row is chosen on the sheet Drawing.", book.style["note"])
        sheet.write(2, 0, "row shown", book.style["head_left"])
        sheet.write_formula(2, 1, "=row_shown", book.style["count"], self.shown + 1)
        self._points()
        unknowns = list(self._unknowns())
        if len(unknowns) != 3 * len(self.bodies):
            message = "Redundant links: equilibrium does not determine all reactions."
            sheet.write(self.row + 1, 0, message, book.style["warning"])
            return
        loads = list(self._loads())
        first = self._system(unknowns, loads)
        self._free_bodies(unknowns, loads, first)
        print_on_one_page(sheet, tall=0)

    # What is picked from other sheets

    def _pick(self, sheet: str, column: int, value: float, at: tuple[int, int]) -> _Entry:
        letter = column_name(column)
        area = f"{sheet}!${letter}${FIRST + 1}:${letter}${self.book.last}"
        style = self.book.style["number"]
        self.sheet.write_formula(*at, f"=INDEX({area},row_shown)", style, cached(value))
        return _Entry(f"${column_name(at[1])}${at[0] + 1}", value)

    def _value(self, key: str) -> float:
        return float(self.book.over_rows(self.book.values[key])[self.shown])

    def _heads(self, *titles: str) -> None:
        self.row += 1
        for column, title in enumerate(titles):
            style = self.book.style["head" if column else "head_left"]
            self.sheet.write(self.row, column, title, style)
        self.row += 1

    def _points(self) -> None:
        self._heads("point", "x", "y")
        self.at: dict[str, tuple[_Entry, _Entry]] = {}
        for point in self.book.closure.points:
            self.sheet.write(self.row, 0, point)
            keys = [coordinate_name(point, axis) for axis in "xy"]
            entries = [
                self._pick(CYCLE, self.cycle[key], self._value(key), (self.row, column))
                for column, key in enumerate(keys, start=1)
            ]
            self.at[point] = (entries[0], entries[1])
            self.row += 1
        if self.linkage.sliders or self.linkage.slots:
            self._heads("line", "along x", "along y")
        self.along: dict[str, tuple[_Entry, _Entry]] = {}
        for guide in (*self.linkage.sliders, *self.linkage.slots):
            self.sheet.write(self.row, 0, guide.name)
            (x0, y0), (x1, y1) = (self.at[point] for point in guide.line)
            span = f"SQRT(({x1.text}-{x0.text})^2+({y1.text}-{y0.text})^2)"
            size = float(np.hypot(x1.value - x0.value, y1.value - y0.value))
            entries = []
            for column, (end, start) in enumerate(((x1, x0), (y1, y0)), start=1):
                value = (end.value - start.value) / size
                text = f"=({end.text}-{start.text})/{span}"
                self.sheet.write_formula(self.row, column, text, self.book.style["number"], value)
                entries.append(_Entry(f"${column_name(column)}${self.row + 1}", value))
            self.along[guide.name] = (entries[0], entries[1])
            self.row += 1

    # Unknowns

    def _unknowns(self) -> Iterator[_Unknown]:
        """As in ``forces``: pins, guides and fixed joints, then the effort."""
        linkage, units = self.linkage, self.book.model.units
        force, moment = units.of(Kind.FORCE), units.of(Kind.MOMENT)
        # loads on a pin act on its first link, so that this one needs no unknown of its own
        carriers = linkage.carriers()
        for point, links in carriers.items():
            for other in links[1:]:
                stem = f"{point}.force" if len(links) == 2 else f"{point}.force.{other}"
                for axis, x, y in (("x", _ONE, _NO), ("y", _NO, _ONE)):
                    yield _Unknown(
                        f"{stem}.{axis}", force, self._pair(other, links[0], point, x, y)
                    )
        for slider in linkage.sliders:
            x, y = self.along[slider.name]
            # the normal is to the left of the line
            point = slider.points[0]
            acts = self._pair(slider.link, slider.on, point, _minus(y), x)
            yield _Unknown(f"{slider.name}.normal", force, acts)
            yield _Unknown(f"{slider.name}.moment", moment, self._couple(slider.link, slider.on))
        for slot in linkage.slots:
            x, y = self.along[slot.name]
            acts = self._pair(carriers[slot.point][0], slot.on, slot.point, _minus(y), x)
            yield _Unknown(f"{slot.name}.normal", force, acts)
        for part in linkage.parts:
            kept = part.kept_angle(linkage)
            if part.kind is not None or kept is None:
                continue
            # two links that are one body
            earlier, later = sorted(kept[:2], key=list(linkage.links).index)
            point = next(p for p in linkage.links[earlier] if p in linkage.links[later])
            stem = point if len(carriers[point]) == 2 else f"{point}.{later}"
            yield _Unknown(f"{stem}.moment", moment, self._couple(later, earlier))
        (which,) = linkage.inputs
        kind, name = which.drives
        effort = f"{self.book.leading.name}.effort"
        if kind == "slider":
            x, y = self.along[name]
            guides = [guide for guide in linkage.sliders if guide.name == name]
            slots = [slot for slot in linkage.slots if slot.name == name]
            if guides:
                acts = self._pair(guides[0].link, guides[0].on, guides[0].points[0], x, y)
            else:
                own = carriers[slots[0].point][0]
                acts = self._pair(own, slots[0].on, slots[0].point, x, y)
            yield _Unknown(effort, force, acts)
            return
        pair = (which.relative_to or GROUND, name)
        if kind == "joint":
            first, second = linkage.bodies_at(name)
            pair = (second, first) if second == GROUND else (first, second)
        yield _Unknown(effort, moment, self._couple(pair[1], pair[0]))

    def _pair(self, on: str, against: str, point: str, x: _Entry, y: _Entry) -> tuple[_Act, ...]:
        return _Act(on, point, x, y), _Act(against, point, _minus(x), _minus(y))

    def _couple(self, on: str, against: str) -> tuple[_Act, ...]:
        return _Act(on, "", moment=_ONE), _Act(against, "", moment=_minus(_ONE))

    # Loads

    def _loads(self) -> Iterator[tuple[str, _Act]]:
        """Masses, forces and torques in the row, with what they are called."""
        self._heads("load", "force x", "force y", "moment", "at x", "at y")
        carriers = self.linkage.carriers()
        for link in self.columns.masses:
            keys = [f"{link} force x", f"{link} force y", f"{link} torque"]
            keys += [f"{link} center x", f"{link} center y"]
            name = f"mass of {link}"
            x, y, moment, px, py = self._picked(name, keys)
            self.at[name] = (px, py)
            yield name, _Act(link, name, x, y, moment)
        for point, given, kx, ky in self.columns.forces:
            x, y = self._picked(f"load on {point}", [kx, ky])
            yield f"load on {point}", _Act(given or carriers[point][0], point, x, y)
        for link, key in self.columns.torques:
            (moment,) = self._picked(f"torque on {link}", [key], first=3)
            yield f"torque on {link}", _Act(link, "", moment=moment)

    def _picked(self, name: str, keys: list[str], first: int = 1) -> list[_Entry]:
        self.sheet.write(self.row, 0, name)
        entries = [
            self._pick(FORCES, self.columns.of[key], self._value(key), (self.row, column))
            for column, key in enumerate(keys, start=first)
        ]
        self.row += 1
        return entries

    # Equations

    def _moment(self, link: str, act: _Act) -> _Entry:
        """The moment of an act about the first point of a link."""
        if not act.point:
            return act.moment
        (px, py), (cx, cy) = self.at[act.point], self.at[self.linkage.links[link][0]]
        value = (px.value - cx.value) * act.y.value - (py.value - cy.value) * act.x.value
        text = f"({px.text}-{cx.text})*({act.y.text})-({py.text}-{cy.text})*({act.x.text})"
        if act.moment != _NO:
            text = f"{text}+({act.moment.text})"
        return _Entry(text, value + act.moment.value)

    def _parts(self, link: str, act: _Act) -> tuple[_Entry, _Entry, _Entry]:
        return act.x, act.y, self._moment(link, act)

    def _system(self, unknowns: list[_Unknown], loads: list[tuple[str, _Act]]) -> int:
        """The matrix, the loads and the solution; returns the row of the first unknown."""
        size, style = len(unknowns), self.book.style
        self._heads("W r + b = 0", *(unknown.name for unknown in unknowns), "b")
        top = self.row
        # values for programs that do not calculate; the formulas stand on their own
        matrix, right = np.zeros((size, size)), np.zeros(size)
        for k, link in enumerate(self.bodies):
            for part, word in enumerate(_ROWS):
                line = 3 * k + part
                self.sheet.write(self.row, 0, f"{word} on {link}")
                for column, unknown in enumerate(unknowns):
                    own = [act for act in unknown.acts if act.link == link]
                    entry = self._parts(link, own[0])[part] if own else _NO
                    matrix[line, column] = entry.value
                    self._write(self.row, column + 1, entry)
                known = [self._parts(link, act)[part] for _, act in loads if act.link == link]
                entries = [entry for entry in known if entry != _NO]
                total = sum(entry.value for entry in entries)
                text = "+".join(f"({entry.text})" for entry in entries) or "0"
                right[line] = total
                self._write(self.row, size + 1, _Entry(text, total))
                self.row += 1
        last, b = column_name(size), column_name(size + 1)
        area = f"$B${top + 1}:${last}${top + size}"
        side = f"${b}${top + 1}:${b}${top + size}"
        try:
            solution = -np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:  # at a dead point nothing balances the loads
            solution = np.full(size, np.nan)
        self._heads("reaction", "value", "unit")
        first = self.row
        for k, unknown in enumerate(unknowns):
            self.sheet.write(self.row, 0, unknown.name)
            # MMULT, MINVERSE and SUMPRODUCT accept arrays without an array formula
            unit = ";".join("1" if j == k else "0" for j in range(size))
            text = f"=-SUMPRODUCT(MMULT(MINVERSE({area}),{side}),{{{unit}}})"
            value = cached(float(solution[k]))
            self.sheet.write_formula(self.row, 1, text, style["number"], value)
            self.sheet.write(self.row, 2, unknown.unit, style["unit_right"])
            self.row += 1
        self.solution = solution
        effort = f"{self.book.leading.name}.effort by virtual work"
        self.sheet.write(self.row, 0, effort)
        self._pick(FORCES, self.columns.of["effort"], self._value("effort"), (self.row, 1))
        self.row += 1
        return first

    def _write(self, row: int, column: int, entry: _Entry) -> None:
        style = self.book.style["number"]
        if entry.text in ("0", "1"):
            self.sheet.write_number(row, column, entry.value, style)
        else:
            self.sheet.write_formula(row, column, f"={entry.text}", style, cached(entry.value))

    def _free_bodies(
        self, unknowns: list[_Unknown], loads: list[tuple[str, _Act]], first: int
    ) -> None:
        """All forces on every link, and their sums, which are zero."""
        style = self.book.style
        for link in self.bodies:
            self._heads(f"free body {link}", *_ROWS)
            begin, sums = self.row, np.zeros(3)
            for k, unknown in enumerate(unknowns):
                for act in (own for own in unknown.acts if own.link == link):
                    self.sheet.write(self.row, 0, unknown.name)
                    for column, entry in enumerate(self._parts(link, act)):
                        value = entry.value * float(self.solution[k])
                        sums[column] += value
                        text = f"$B${first + k + 1}*({entry.text})"
                        self._write(self.row, column + 1, _Entry(text, value))
                    self.row += 1
            for name, act in loads:
                if act.link == link:
                    self.sheet.write(self.row, 0, name)
                    for column, entry in enumerate(self._parts(link, act)):
                        sums[column] += entry.value
                        self._write(self.row, column + 1, entry)
                    self.row += 1
            self.sheet.write(self.row, 0, "sum", style["head_left"])
            for column in range(3):
                letter = column_name(column + 1)
                text = f"=SUM({letter}{begin + 1}:{letter}{self.row})"
                known = cached(float(sums[column]))
                self.sheet.write_formula(self.row, column + 1, text, style["small"], known)
            self.row += 1
