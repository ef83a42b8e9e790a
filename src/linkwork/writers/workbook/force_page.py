"""The sheet of forces: inertia, loads and the effort by virtual work, in every row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Variable
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Name, Node, NumberNode, names_in
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.drives import effort_kind, effort_name
from linkwork.writers.formulas.closure_formulas import of_radians, rebuilt
from linkwork.writers.formulas.rate_formulas import rate_key
from linkwork.writers.workbook.book import FORCES, Book
from linkwork.writers.workbook.layout import Table
from linkwork.writers.workbook.load_cells import LoadCells
from linkwork.writers.workbook.rates import partial_key

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
    page = _Page(book, Table(book, FORCES, sheet), cells)
    page.write()
    page.columns.of = page.table.of
    return page.columns


@dataclass
class _Page:
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
