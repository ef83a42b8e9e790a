"""The sheet of forces: inertia, loads and the effort by virtual work, in every row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Variable
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Name, Node, names_in
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.drives import effort_kind, effort_name
from linkwork.writers.formulas.closure_formulas import of_radians
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
    work: list[str] = field(default_factory=list)

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
        for k, (load, parts, names) in enumerate(self.cells.loads, start=1):
            self._load(k, load, parts, names)
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
        """A column of a formula; ``names`` are the keys of its names."""
        return self._column(key, title, unit, parse(text, comparing=True), names)

    def _column(
        self, key: str, title: str, unit: str, formula: Node, names: Mapping[str, str]
    ) -> str:
        self.book.names.claim(key, key.replace(" ", "_"))
        self.table.formula(title, unit, formula, key=key, names=names)
        return key

    def _moving(self, key: str, title: str, unit: str, text: str, names: Mapping[str, str]) -> None:
        """A column of a speed; with several inputs also of that by each alone."""
        self._add(key, title, unit, text, names)
        for which in self.each:
            names_by = {name: self._by(used, which) for name, used in names.items()}
            self._add(
                partial_key(key, which), f"{title} by {self.book.shown(which)}", "", text, names_by
            )

    def _by(self, key: str, which: Variable) -> str:
        """The key of a rate by one input alone; other keys stay."""
        partial = partial_key(key, which)
        return partial if partial in self.book.values else key

    @property
    def each(self) -> Sequence[Variable]:
        """The inputs, if there are several."""
        inputs = self.book.model.equations.inputs
        return inputs if len(inputs) > 1 else ()

    def _rates(self, point: str, order: int, stem: str) -> tuple[dict[str, str], dict[str, str]]:
        """Names for the rates of a point that have cells, and "0" for the rest."""
        rates, still = {}, {}
        for axis in "xy":
            key = rate_key(coordinate_name(point, axis), order)
            if key in self.book.values:
                rates[f"{stem}{axis}"] = key
            else:
                still[f"{stem}{axis}"] = "0"
        return rates, still

    def _formula(self, text: str, *points: tuple[str, int, str]) -> tuple[str, dict[str, str]]:
        """A formula of rates of points, zeros written as 0."""
        names: dict[str, str] = {}
        for point, order, stem in points:
            rates, still = self._rates(point, order, stem)
            names |= rates
            # points at rest have no cells of rates
            for name, zero in still.items():
                text = text.replace(name, zero)
        return text, names

    def _place(self, point: str, number: str) -> dict[str, str]:
        return {f"{axis}{number}": coordinate_name(point, axis) for axis in "xy"}

    def _turning(self, link: str) -> None:
        """The direction of a link and its rates."""
        first, *others = self.cells.linkage.links[link]
        self.table.group = f"Direction of {link}"
        if others:
            names = {**self._place(first, "0"), **self._place(others[0], "1")}
            for axis in "xy":
                text = f"({axis}1-{axis}0)/sqrt({_SPAN})"
                self._add(f"{link} direction {axis}", f"direction {axis}", "", text, names)
            directions = {f"u{axis}": f"{link} direction {axis}" for axis in "xy"}
            for order, word, per in _SPINS:
                text = f"(ux*(by-ay)-uy*(bx-ax))/sqrt({_SPAN})"
                text, rates = self._formula(text, (first, order, "a"), (others[0], order, "b"))
                add = self._moving if order == 1 else self._add
                add(f"{link} spin {order}", word, per, text, {**names, **directions, **rates})
        else:
            self._turning_wheel(link)

    def _turning_wheel(self, link: str) -> None:
        """The direction of a link with one point: that of its angle, if it turns."""
        symbol = canonical(link)
        names = {"q": symbol} if symbol in self.book.values else {}
        for axis, turned, still in (("x", "cos(q)", "1"), ("y", "sin(q)", "0")):
            formula = of_radians(parse(turned if names else still), self.cells.linkage.angle)
            self._column(f"{link} direction {axis}", f"direction {axis}", "", formula, names)
        for order, word, per in _SPINS:
            key = rate_key(symbol, order)
            angle = {"q": key} if key in self.book.values else {}
            add = self._moving if order == 1 else self._add
            add(f"{link} spin {order}", word, per, "q" if angle else "0", angle)

    def _mass(self, link: str) -> None:
        """Weight and inertia of a link, and their virtual work."""
        linkage = self.cells.linkage
        first = linkage.links[link][0]
        self.table.group = f"Mass of {link}"
        length, force = linkage.length, linkage.force
        names = {
            "ux": f"{link} direction x", "uy": f"{link} direction y",
            "w": f"{link} spin 1", "al": f"{link} spin 2", "m": f"mass {link}",
            "k": "force unit", "on": "moving", "gx": "gravity x", "gy": "gravity y",
        }  # fmt: skip
        if linkage.masses[link].shape is not None:
            second = linkage.links[link][1]
            ends = {**self._place(first, "0"), **self._place(second, "1")}
            self._add(f"{link} half", "half length", length, f"sqrt({_SPAN})/2", ends)
            names["cx"] = f"{link} half"
            cx, cy, inertia = "cx", "0", "m*cx^2/3"
        else:
            names |= {f"c{axis}": f"center {link} {axis}" for axis in "xy"}
            names["j"] = f"inertia {link}"
            cx, cy, inertia = "cx", "cy", "j"
        arm = {"x": f"({cx}*ux-{cy}*uy)", "y": f"({cx}*uy+{cy}*ux)"}
        origin = self._place(first, "0")
        for axis in "xy":
            text = f"{axis}0+{arm[axis]}"
            self._add(f"{link} center {axis}", f"center {axis}", length, text, {**names, **origin})
        speeds = {"x": f"vx-w*{arm['y']}", "y": f"vy+w*{arm['x']}"}
        bends = {
            "x": f"sx-al*{arm['y']}-w^2*{arm['x']}", "y": f"sy+al*{arm['x']}-w^2*{arm['y']}",
        }  # fmt: skip
        # v = v₀ + iω r and a = a₀ + (iα - ω²) r, r the arm from the first point
        for axis in "xy":
            text, rates = self._formula(speeds[axis], (first, 1, "v"))
            key = f"{link} speed {axis}"
            self._moving(key, f"velocity {axis}", f"{length}/s", text, {**names, **rates})
        for axis in "xy":
            text = f"k*m*(g{axis}-on*({bends[axis]}))"
            text, rates = self._formula(text, (first, 2, "s"))
            self._add(f"{link} force {axis}", f"force {axis}", force, text, {**names, **rates})
        torque = f"-k*on*({inertia})*al"
        self._add(f"{link} torque", "torque", f"{force}·{length}", torque, names)
        self.work += [f"{link} force {axis}*{link} speed {axis}" for axis in "xy"]
        self.work.append(f"{link} torque*{link} spin 1")
        self.columns.masses.append(link)

    def _load(self, k: int, load: Any, parts: tuple[Node, ...], names: Mapping[str, str]) -> None:
        linkage, cells = self.cells.linkage, dict(names)
        self.table.group = load.label.capitalize()
        if any(node.name == "t" for part in parts for node in names_in(part)):
            cells["t"] = self._time()
        if load.torque is not None:
            key = self._part(
                f"load {k}", "torque", f"{linkage.force}·{linkage.length}", parts[0], cells, 1
            )
            self.columns.torques.append((load.link, key))
            self.work.append(f"{key}*{load.link} spin 1")
        else:
            keys = [
                self._part(f"load {k} force {axis}", f"force {axis}", linkage.force, part, cells, n)
                for n, (axis, part) in enumerate(zip("xy", parts, strict=True), start=1)
            ]
            if load.turns_with is not None:
                link = load.turns_with
                along = {"ux": f"{link} direction x", "uy": f"{link} direction y"}
                along |= {"fx": keys[0], "fy": keys[1]}
                keys = [
                    self._add(
                        f"load {k} turned {axis}", f"on ground {axis}", linkage.force, text, along
                    )
                    for axis, text in (("x", "fx*ux-fy*uy"), ("y", "fx*uy+fy*ux"))
                ]
            self._push(load.point, load.link, keys[0], keys[1])

    def _part(
        self, key: str, title: str, unit: str, part: Node, names: Mapping[str, str], n: int
    ) -> str:
        plain = isinstance(part, Name) and part.name == "q"
        used = {"q": names[f"q {n}"]} if plain else {
            node.name: names[node.name] for node in names_in(part) if node.name in names
        }  # fmt: skip
        return self._column(key, title, unit, part, used)

    def _time(self) -> str:
        """The time since the first row of the table."""
        if "time" not in self.table.of:
            lead = self.book.leading
            scale = "*pi/180" if lead.kind == "angle" and self.book.unit("angle") == "deg" else ""
            begin = float(self.book.values[lead.symbol][0])
            text = f"(q-({begin!r})){scale}/s"
            names = {"q": lead.symbol, "s": rate_key(lead.symbol, 1)}
            self._add("time", "t", "s", text, names)
        return "time"

    def _push(self, point: str, link: str | None, x: str, y: str) -> None:
        """A force on a point, and its virtual work."""
        self.columns.forces.append((point, link, x, y))
        # forces on points at rest do no work
        for axis, key in (("x", x), ("y", y)):
            rate = rate_key(coordinate_name(point, axis), 1)
            if rate in self.book.values:
                self.work.append(f"{key}*{rate}")

    def _spring(self, name: str, first: str, second: str) -> None:
        linkage = self.cells.linkage
        self.table.group = f"Spring {name}"
        names = {**self._place(first, "0"), **self._place(second, "1")}
        length = self._add(f"{name} length", "length", linkage.length, f"sqrt({_SPAN})", names)
        text = "((x1-x0)*(bx-ax)+(y1-y0)*(by-ay))/l"
        text, rates = self._formula(text, (first, 1, "a"), (second, 1, "b"))
        rate = self._add(
            f"{name} rate", "rate", f"{linkage.length}/s", text, {**names, **rates, "l": length}
        )
        constants = {word: f"{name} {word}" for word in ("stiffness", "free", "damping")}
        text = "stiffness*(l-free)+damping*on*r"
        used = {**constants, "l": length, "r": rate, "on": "moving"}
        tension = self._add(f"{name} tension", "tension", linkage.force, text, used)
        for point, sign in ((first, ""), (second, "-")):
            keys = [
                self._add(
                    f"{name} on {point} {axis}", f"on {point} {axis}", linkage.force,
                    f"{sign}f*({axis}1-{axis}0)/l", {**names, "f": tension, "l": length},
                )
                for axis in "xy"
            ]  # fmt: skip
            self._push(point, None, keys[0], keys[1])

    def _torsion(self, name: str, first: str, second: str) -> None:
        """The torque of a torsion spring on two links, by the angle between them."""
        linkage = self.cells.linkage
        self.table.group = f"Spring {name}"
        links = {"a": first, "b": second}
        symbols = {word: canonical(link) for word, link in links.items() if link != GROUND}
        between = "-".join(word if word in symbols else "0" for word in "ba")
        scale = "*pi/180" if linkage.angle.value == "deg" else ""
        angles = {**symbols, "free": f"{name} free"}
        self._add(f"{name} turn", "turn", "rad", f"({between}-free){scale}", angles)
        speeds = {word: rate_key(symbol, 1) for word, symbol in symbols.items()}
        self._add(f"{name} rate", "rate", "rad/s", between, speeds)
        names = {word: f"{name} {word}" for word in ("stiffness", "damping", "turn", "rate")}
        unit = f"{linkage.force}·{linkage.length}"
        for word, sign in (("a", ""), ("b", "-")):
            if word not in symbols:
                continue
            text = f"{sign}(stiffness*turn+damping*on*rate)"
            key = f"{name} on {links[word]}"
            self._add(key, f"on {links[word]}", unit, text, {**names, "on": "moving"})
            self.columns.torques.append((links[word], key))
            self.work.append(f"{key}*{speeds[word]}")

    def _effort(self) -> None:
        """The sum of virtual work over the speed of the input."""
        self.table.group = "Virtual work"
        for which in self.book.model.equations.inputs:
            names: dict[str, str] = {}
            terms = []
            for k, term in enumerate(self.work):
                load, _, moved = term.partition("*")
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
