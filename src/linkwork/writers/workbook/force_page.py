"""The sheet of forces: inertia, loads and the effort by virtual work, in every row."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Variable
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Name, Node, NumberNode, names_in
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.drives import effort_kind, effort_name
from linkwork.writers.formulas.closure_formulas import cell_text, of_radians, rebuilt
from linkwork.writers.formulas.rate_formulas import rate_key
from linkwork.writers.formulas.traced import LinearForm, Trace, TracedNumber, forms_of
from linkwork.writers.workbook.book import (
    CYCLE,
    FIRST,
    FORCES,
    Book,
    Table,
    cached,
    column_name,
    print_on_one_page,
)
from linkwork.writers.workbook.load_cells import LoadCells
from linkwork.writers.workbook.newton_page import partial_key
from linkwork.writers.workbook.reactions import (
    Act,
    Follower,
    Reactions,
    Unknown,
    contacts_of,
    join_links,
)

_SPINS = ((1, "ω", "rad/s"), (2, "α", "rad/s²"))
_SPAN = "((x1-x0)^2+(y1-y0)^2)"


@dataclass
class ForceColumns:
    """The keys of forces (point, link, x, y) and of torques (link, key); the names of efforts by
    key.
    """

    forces: list[tuple[str, str | None, str, str]] = field(default_factory=list)
    torques: list[tuple[str, str]] = field(default_factory=list)
    masses: list[str] = field(default_factory=list)
    efforts: dict[str, str] = field(default_factory=dict)
    of: dict[str, int] = field(default_factory=dict)


def write_forces(book: Book, sheet: Any, cells: LoadCells) -> ForceColumns:
    """Write the columns; ``Equilibrium`` takes them from there."""
    page = _ForcePage(book, Table(book, FORCES, sheet), cells)
    page.write()
    page.columns.of = page.table.of
    return page.columns


@dataclass
class _ForcePage:
    book: Book
    table: Table
    cells: LoadCells
    columns: ForceColumns = field(default_factory=ForceColumns)
    work: list[tuple[str, str]] = field(default_factory=list)

    def write(self) -> None:
        """Write directions, masses, loads and springs, then the sum of virtual work."""
        self.table.inputs()
        linkage = self.cells.linkage
        turned = [load.turns_with for load in linkage.loads if load.turns_with]
        loaded = [load.link for load in linkage.loads if load.torque is not None and load.link]
        for link in dict.fromkeys([*self.cells.masses, *turned, *loaded]):
            self._turning(link)
        for link in self.cells.masses:
            self._mass(link)
        for k, (load, parts) in enumerate(self.cells.loads, start=1):
            self._load(k, load, parts)
        for spring in self.cells.pulling:
            if spring.links is None:
                self._spring(spring.name, *spring.between)
            else:
                self._torsion(spring.name, *spring.links)
        self._effort()
        whole = "effort = -Σ (force · velocity + torque · angular velocity) / speed of the input"
        alone = "effort = -Σ (force · rate + torque · angular rate by this input alone)"
        note = f"{alone if self.each else whole}, with the forces of inertia"
        self.table.finish("forces", note, 2)

    def _add(self, key: str, title: str, unit: str, text: str, names: Mapping[str, str]) -> str:
        """A column of a formula; ``names`` are the keys of its names, 0 if they have no cells."""
        return self._column(key, title, unit, parse(text, comparing=True), names)

    def _column(
        self, key: str, title: str, unit: str, formula: Node, names: Mapping[str, str]
    ) -> str:
        known = {name: used for name, used in names.items() if used in self.book.values}
        still = names.keys() - known.keys()

        def at_rest(part: Node) -> Node:
            return NumberNode(0.0) if isinstance(part, Name) and part.name in still else part

        self.book.names.claim(key, key.replace(" ", "_"))
        self.table.formula(title, unit, rebuilt(formula, at_rest), key=key, names=known)
        return key

    def _moving(self, key: str, title: str, unit: str, text: str, names: Mapping[str, str]) -> None:
        """A column of a speed; with several inputs also of that by each alone."""
        self._add(key, title, unit, text, names)
        for which in self.each:
            names_by = {name: self._by(used, which) for name, used in names.items()}
            title_by = f"{title} by {self.book.shown(which)}"
            self._add(partial_key(key, which), title_by, "", text, names_by)

    def _pair(
        self, key: str, title: str, unit: str, texts: tuple[str, str], names: Mapping[str, str]
    ) -> list[str]:
        """Columns of the x and y components of a vector."""
        return [
            self._add(f"{key} {axis}", f"{title} {axis}", unit, text, names)
            for axis, text in zip("xy", texts, strict=True)
        ]

    def _by(self, key: str, which: Variable) -> str:
        """The key of a rate by one input alone; other keys stay."""
        partial = partial_key(key, which)
        return partial if partial in self.book.values else key

    @property
    def each(self) -> Sequence[Variable]:
        """The inputs, if there are several."""
        inputs = self.book.model.equations.inputs
        return inputs if len(inputs) > 1 else ()

    @staticmethod
    def _rates(point: str, order: int, stem: str) -> dict[str, str]:
        """The keys of the rates of a point, for the names ``stem`` x and y."""
        return {f"{stem}{axis}": rate_key(coordinate_name(point, axis), order) for axis in "xy"}

    @staticmethod
    def _ends(first: str, second: str) -> dict[str, str]:
        """The keys of the coordinates of two points: ``x0``, ``y0``, ``x1``, ``y1``."""
        ends = (("0", first), ("1", second))
        return {f"{axis}{k}": coordinate_name(point, axis) for k, point in ends for axis in "xy"}

    @staticmethod
    def _direction(link: str) -> dict[str, str]:
        return {f"u{axis}": f"{link} direction {axis}" for axis in "xy"}

    def _turning(self, link: str) -> None:
        """The direction of a link and its rates."""
        first, *others = self.cells.linkage.links[link]
        self.table.group = f"Direction of {link}"
        key = f"{link} direction"
        if others:
            names = self._ends(first, others[0])
            along = f"(x1-x0)/sqrt({_SPAN})", f"(y1-y0)/sqrt({_SPAN})"
            self._pair(key, "direction", "", along, names)
            names |= self._direction(link)
        else:  # that of its angle, if it turns
            for axis, text in (("x", "cos(q)"), ("y", "sin(q)")):
                formula = of_radians(parse(text), self.cells.linkage.angle)
                names = {"q": canonical(link)}
                self._column(f"{key} {axis}", f"direction {axis}", "", formula, names)
        for order, word, per in _SPINS:
            if others:
                text = f"(ux*(by-ay)-uy*(bx-ax))/sqrt({_SPAN})"
                names |= self._rates(first, order, "a") | self._rates(others[0], order, "b")
            else:
                text, names = "q", {"q": rate_key(canonical(link), order)}
            add = self._moving if order == 1 else self._add
            add(f"{link} spin {order}", word, per, text, names)

    def _mass(self, link: str) -> None:
        """Weight and inertia of a link, and their virtual work."""
        linkage = self.cells.linkage
        first = linkage.links[link][0]
        self.table.group = f"Mass of {link}"
        length, force = linkage.length, linkage.force
        names = {
            **self._direction(link), **self._ends(first, linkage.links[link][-1]),
            "w": f"{link} spin 1", "al": f"{link} spin 2", "m": f"mass {link}",
            "k": "force unit", "on": "moving", "gx": "gravity x", "gy": "gravity y",
            "cx": f"center {link} x", "cy": f"center {link} y", "j": f"inertia {link}",
            **self._rates(first, 1, "v"), **self._rates(first, 2, "s"),
        }  # fmt: skip
        inertia = "j"
        if linkage.masses[link].shape is not None:
            ends = self._ends(first, linkage.links[link][1])
            half = self._add(f"{link} half", "half length", length, f"sqrt({_SPAN})/2", ends)
            names |= {"cx": half, "cy": "", "j": ""}
            inertia = "m*cx^2/3"
        x, y = "(cx*ux-cy*uy)", "(cx*uy+cy*ux)"
        # v = v₀ + iω r and a = a₀ + (iα - ω²) r, r the arm from the first point
        self._pair(f"{link} center", "center", length, (f"x0+{x}", f"y0+{y}"), names)
        for axis, text in (("x", f"vx-w*{y}"), ("y", f"vy+w*{x}")):
            self._moving(f"{link} speed {axis}", f"velocity {axis}", f"{length}/s", text, names)
        bends = f"sx-al*{y}-w^2*{x}", f"sy+al*{x}-w^2*{y}"
        pull = f"k*m*(gx-on*({bends[0]}))", f"k*m*(gy-on*({bends[1]}))"
        self._pair(f"{link} force", "force", force, pull, names)
        torque = f"-k*on*({inertia})*al"
        self._add(f"{link} torque", "torque", f"{force}·{length}", torque, names)
        self.work += [(f"{link} force {axis}", f"{link} speed {axis}") for axis in "xy"]
        self.work.append((f"{link} torque", f"{link} spin 1"))
        self.columns.masses.append(link)

    def _load(self, k: int, load: Any, parts: tuple[Node, ...]) -> None:
        linkage = self.cells.linkage
        self.table.group = load.label.capitalize()
        if any(node.name == "time" for part in parts for node in names_in(part)):
            self._time()
        if load.torque is not None:
            unit = f"{linkage.force}·{linkage.length}"
            key = self._column(f"load {k}", "torque", unit, parts[0], {})
            self.columns.torques.append((load.link, key))
            self.work.append((key, f"{load.link} spin 1"))
        else:
            keys = [
                self._column(f"load {k} force {axis}", f"force {axis}", linkage.force, part, {})
                for axis, part in zip("xy", parts, strict=True)
            ]
            if load.turns_with is not None:
                link = load.turns_with
                along = {**self._direction(link), "fx": keys[0], "fy": keys[1]}
                texts = "fx*ux-fy*uy", "fx*uy+fy*ux"
                keys = self._pair(f"load {k} turned", "on ground", linkage.force, texts, along)
            self._push(load.point, load.link, keys[0], keys[1])

    def _time(self) -> None:
        """The time since the first row of the table."""
        if "time" not in self.table.of:
            lead = self.book.leading
            scale = "*pi/180" if lead.kind == "angle" and self.book.unit("angle") == "deg" else ""
            begin = float(self.book.values[lead.symbol][0])
            text = f"(q-({begin!r})){scale}/s"
            names = {"q": lead.symbol, "s": rate_key(lead.symbol, 1)}
            self._add("time", "t", "s", text, names)

    def _push(self, point: str, link: str | None, x: str, y: str) -> None:
        """A force on a point, and its virtual work."""
        self.columns.forces.append((point, link, x, y))
        # forces on points at rest do no work
        for axis, key in (("x", x), ("y", y)):
            rate = rate_key(coordinate_name(point, axis), 1)
            if rate in self.book.values:
                self.work.append((key, rate))

    def _spring(self, name: str, first: str, second: str) -> None:
        linkage = self.cells.linkage
        self.table.group = f"Spring {name}"
        names = self._ends(first, second)
        names |= self._rates(first, 1, "a") | self._rates(second, 1, "b")
        names |= {word: f"{name} {word}" for word in ("stiffness", "free", "damping")}
        names |= {"l": f"{name} length", "r": f"{name} rate", "on": "moving"}
        self._add(f"{name} length", "length", linkage.length, f"sqrt({_SPAN})", names)
        text = "((x1-x0)*(bx-ax)+(y1-y0)*(by-ay))/l"
        self._add(f"{name} rate", "rate", f"{linkage.length}/s", text, names)
        text = "stiffness*(l-free)+damping*on*r"
        names["f"] = self._add(f"{name} tension", "tension", linkage.force, text, names)
        for point, sign in ((first, ""), (second, "-")):
            texts = f"{sign}f*(x1-x0)/l", f"{sign}f*(y1-y0)/l"
            keys = self._pair(f"{name} on {point}", f"on {point}", linkage.force, texts, names)
            self._push(point, None, keys[0], keys[1])

    def _torsion(self, name: str, first: str, second: str) -> None:
        """The torque of a torsion spring on two links, by the angle between them."""
        linkage = self.cells.linkage
        self.table.group = f"Spring {name}"
        links = {"a": first, "b": second}
        scale = "*pi/180" if linkage.angle.value == "deg" else ""
        angles = {word: canonical(link) for word, link in links.items()}
        names = {
            word: f"{name} {word}" for word in ("stiffness", "free", "damping", "turn", "rate")
        }
        names["on"] = "moving"
        self._add(f"{name} turn", "turn", "rad", f"(b-a-free){scale}", {**names, **angles})
        speeds = {word: rate_key(symbol, 1) for word, symbol in angles.items()}
        self._add(f"{name} rate", "rate", "rad/s", "b-a", speeds)
        for word, sign in (("a", ""), ("b", "-")):
            if links[word] != GROUND:
                text = f"{sign}(stiffness*turn+damping*on*rate)"
                unit = f"{linkage.force}·{linkage.length}"
                key = self._add(f"{name} on {links[word]}", f"on {links[word]}", unit, text, names)
                self.columns.torques.append((links[word], key))
                self.work.append((key, speeds[word]))

    def _effort(self) -> None:
        """The sum of virtual work over the speed of the input."""
        self.table.group = "Virtual work"
        for which in self.book.model.equations.inputs:
            names: dict[str, str] = {}
            terms = []
            for k, (load, moved) in enumerate(self.work):
                names |= {f"f{k}": load, f"v{k}": self._by(moved, which)}
                terms.append(f"f{k}*v{k}")
            # eq. (71), for one input both sides times its speed; "by input" the speed is 1
            text = f"-({'+'.join(terms)})" if terms else "0"
            if terms and not self.each:
                names["s"] = rate_key(which.symbol, 1)
                text = f"{text}/s"
            unit = self.book.model.units.of(effort_kind(Kind(which.kind)))
            key = f"effort {which.symbol}"
            self.columns.efforts[key] = effort_name(which.name)
            self._add(key, effort_name(which.name), unit, text, names)


# ----------------------------------------------------------------------
# The sheet of the equilibrium in a selected row: reactions, and one free body for each link.


EQUILIBRIUM = "Equilibrium"
_ROWS = ("force x", "force y", "moment")


def write_equilibrium(
    book: Book, sheet: Any, cells: LoadCells, columns: ForceColumns, cycle: dict[str, int]
) -> None:
    """Write the sheet."""
    _EquilibriumPage(book, sheet, cells.linkage, columns, cycle).write()


@dataclass
class _EquilibriumPage:
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
