"""Masses, loads, springs and questions, added at random to the text of a mechanism."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from tests.campaigns.fuzzing.odd import FORMULAS, NUMBERS, pick

__all__ = ["LOADED", "loaded_text", "names_in"]

#: A crank-rocker under loads of every kind.
LOADED = """\
format = 1
length = "mm"
mass = "kg"
force = "N"
gravity = { size = "9.81 m/s^2", angle = -90 }
[points]
O2 = [0, 0]
A = [35, 20]
B = [146, 66]
O4 = [100, 0]
P = [90, 90]
[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B", "P"]
rocker = ["O4", "B"]
[dimensions]
a = 40
[lengths]
"O2 A" = "a"
"A B" = 120
[masses]
crank = { mass = 1.2, center = [20, 0], inertia = 800 }
rocker = { mass = 2, shape = "rod" }
[[loads]]
point = "P"
force = [0, "-500*(t < 0.1)"]
with = "coupler"
[[loads]]
link = "rocker"
torque = "-20 - 0.5*rocker.velocity"
[[springs]]
name = "return"
between = ["O2", "P"]
stiffness = 2
free = 50
damping = 0.1
[[springs]]
name = "torsion"
links = ["ground", "rocker"]
stiffness = 400
[input]
link = "crank"
from = 0
to = 360
step = 30
speed = "60 rpm"
[[questions]]
text = "How far does the rocker swing?"
answer = "stroke(rocker)"
tolerance = 1
"""

_USUAL = ("0", "1", "2.5", "1e-3", "40", "800", "1e-12", "1e9")
_FORMULAS = ("-500*(t < 0.1)", "-0.5*t", "(t >= 0)*(t <= 1)", "1e308*t", "1/t", "sqrt(t)", "0/0*t")
_TITLE = re.compile(r'^([^\W\d]\w*|"[^"\n]+") *= *\[', re.MULTILINE)


def names_in(text: str, table: str) -> list[str]:
    """The keys with lists in a table of a file, as they are typed; points, links."""
    _, _, rest = text.partition(f"[{table}]\n")
    return _TITLE.findall(rest.partition("\n[")[0])


def loaded_text(rng: np.random.Generator, text: str) -> str:
    """The text with masses, loads and springs, and sometimes a speed and questions."""
    links = [name for name in names_in(text, "links") if name != "ground"] or ["crank"]
    points = names_in(text, "points") or ["A", "B"]
    odd = pick(rng, [0.0, 0.0, 0.0, 0.05, 0.2])
    added = _Added(rng, points, links, odd=odd, moving="\nspeed" in text)
    head = [f'mass = "{pick(rng, ["kg", "g", "slug", "lb", "t"])}"', 'force = "N"']
    if "\nlength" not in text:
        head.append('length = "mm"')
    if rng.random() < 0.7:
        size = '"9.81 m/s^2"' if rng.random() < 0.7 else added.number()
        head.append(f"gravity = {{ size = {size}, angle = {added.number(signed=True)} }}")
    if rng.random() < 0.6 and not added.moving:
        added.moving = "[input]\n" in text
        text = text.replace("[input]\n", f"[input]\nspeed = {added.number(signed=True)}\n", 1)
    masses = [f"{link} = {added.mass()}" for link in rng.permutation(links) if rng.random() < 0.4]
    tables = ["[masses]", *masses] if masses else []
    for make in (added.load, added.spring, added.question):
        for _ in range(int(rng.integers(3))):
            tables += make()
    first, end, rest = text.partition("format = 1\n")
    return "\n".join([f"{first}{end}" + "\n".join(head), rest.rstrip(), *tables, ""])


@dataclass
class _Added:
    """Entries for the points and links of a mechanism; ``odd``: the share of odd numbers."""

    rng: np.random.Generator
    points: list[str]
    links: list[str]
    odd: float
    moving: bool  # whether an input has a speed
    springs: int = 0

    def number(self, *, signed: bool = False) -> str:
        """A usual or an odd number."""
        if self.rng.random() < self.odd:
            return pick(self.rng, [*NUMBERS, *(f'"{formula}"' for formula in FORMULAS)])
        sign = "-" if signed and self.rng.random() < 0.5 else ""
        return sign + pick(self.rng, _USUAL)

    def mass(self) -> str:
        number = self.number
        if self.rng.random() < 0.3:
            return f'{{ mass = {number()}, shape = "rod" }}'
        centre = f"center = [{number(signed=True)}, {number(signed=True)}]"
        return f"{{ mass = {number()}, {centre}, inertia = {number()} }}"

    def load(self) -> list[str]:
        rng, lines = self.rng, ["[[loads]]"]
        if rng.random() < 0.7:
            force = f"force = [{self._effort()}, {self._effort()}]"
            lines += [f"point = {_quoted(pick(rng, self.points))}", force]
            if rng.random() < 0.3:
                lines.append(f"with = {_quoted(pick(rng, self.links))}")
            return lines
        return [*lines, f"link = {_quoted(pick(rng, self.links))}", f"torque = {self._effort()}"]

    def _effort(self) -> str:
        rng = self.rng
        link, point = pick(rng, self.links).strip('"'), pick(rng, self.points).strip('"')
        quantities = [
            f"{link}", f"-2*{link}.d1", f"{point}.x", f"1/{point}.x", f"1e300*{point}.x*{point}.x",
        ]  # fmt: skip
        if self.moving:
            quantities += [
                f"-5*{link}.velocity",
                f"2*{point}.y.velocity",
                f"{link}.acceleration",
                "t",
            ]
        kind = rng.random()
        formula = pick(rng, _FORMULAS if kind < 0.2 else quantities)
        return f'"{formula}"' if kind < 0.5 else self.number(signed=True)

    def spring(self) -> list[str]:
        rng = self.rng
        self.springs += 1
        turning = rng.random() < 0.3
        two = rng.permutation(["ground", *self.links] if turning else self.points)[:2]
        ends = f"{'links' if turning else 'between'} = [{', '.join(map(_quoted, two))}]"
        keys = [key for key in ("stiffness", "free", "damping") if rng.random() < 0.7]
        numbers = [f"{key} = {self.number()}" for key in keys]
        return ["[[springs]]", f'name = "spring{self.springs}"', ends, *numbers]

    def question(self) -> list[str]:
        rng = self.rng
        link, point = pick(rng, self.links).strip('"'), pick(rng, self.points).strip('"')
        answers = ("dead points", "change points", f"stroke({link})", link, f"{point}.x")
        answer = pick(rng, answers)
        lines = ["[[questions]]", 'text = "How far?"', f'answer = "{answer}"']
        lines.append(f"tolerance = {self.number() if rng.random() < self.odd else 1}")
        if answer in (link, f"{point}.x"):
            lines.append(f"at = {self.number()}")
        hidden = pick(rng, ["[]", '["charts"]', '["equations", "input"]'])
        return [*lines, f"hide = {hidden}"] if rng.random() < 0.3 else lines


def _quoted(name: str) -> str:
    return name if name.startswith('"') else f'"{name}"'
