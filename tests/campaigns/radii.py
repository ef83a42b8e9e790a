"""Printed positions of random mechanisms against 100 digits from the floats of their files.

A four-bar linkage whose coupler has three to six points, given by sides, angles, formulas or the
sketch, nearly flat ones among them; at its points and wheels hang dyads and every kind of part.
Shapes, units, constants and equations are written here once more, in ball arithmetic; Newton's
method begins at the printed numbers.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise

import numpy as np
from flint import acb, arb, arb_mat, ctx

import linkwork as lw

__all__ = ["RandomMechanism", "judge_radii", "radius_campaign"]

_BITS = 400
_STEP = arb(2) ** -120  # of derivatives by differences
_HALF = 180.0
Residual = Callable[[Sequence[arb]], list[arb]]


def _unit(angle: arb) -> acb:
    return acb(angle.cos(), angle.sin())


def _exact(z: complex) -> acb:
    return acb(arb(z.real), arb(z.imag))


def _radians(degrees: arb | float) -> arb:
    return arb(degrees) * arb.pi() / 180


def _root(residual: Residual, start: Sequence[arb]) -> list[arb]:
    """The root next to a start, by Newton's method with differences."""
    x = [value.mid() for value in start]
    for _ in range(6):
        f = residual(x)
        columns = []
        for k in range(len(x)):
            moved = [*x[:k], x[k] + _STEP, *x[k + 1 :]]
            columns.append([(a - b) / _STEP for a, b in zip(residual(moved), f, strict=True)])
        matrix = arb_mat([[column[i] for column in columns] for i in range(len(f))])
        step = matrix.solve(arb_mat([[value] for value in f]), algorithm="approx")
        x = [(value - step[k, 0]).mid() for k, value in enumerate(x)]
    return x


@dataclass
class RandomMechanism:
    """A random mechanism as text; how its printed numbers follow, in the order of solving.

    ``steps``: names of printed numbers (an angle or not) and the residual that they satisfy, which
    may use all numbers found before, by name, in ``found``.
    """

    rng: np.random.Generator
    points: dict[str, complex] = field(default_factory=dict)
    links: dict[str, list[str]] = field(default_factory=dict)
    lengths: dict[str, str] = field(default_factory=dict)
    angles: dict[str, str] = field(default_factory=dict)
    dimensions: dict[str, float] = field(default_factory=dict)
    parts: list[str] = field(default_factory=list)
    steps: list[tuple[list[tuple[str, bool]], Residual]] = field(default_factory=list)
    found: dict[str, arb] = field(default_factory=dict)
    places: dict[str, Callable[[], acb]] = field(default_factory=dict)
    kinds: list[str] = field(default_factory=list)
    number: int = 0

    def __post_init__(self) -> None:
        ctx.prec = _BITS
        rng = self.rng
        self.links["ground"] = ["O", "G"]
        scale = 10.0 ** rng.uniform(-1, 2)
        self.at = rng.uniform(0, 360)
        a = scale * rng.uniform(0.5, 1) * np.exp(1j * math.radians(self.at))
        g = scale * complex(rng.uniform(1.5, 3), rng.uniform(-0.5, 0.5))
        b = complex(scale * complex(rng.uniform(1, 2.5), rng.uniform(1.2, 2.5)))
        self.points |= {"O": 0j, "G": g, "A": complex(a), "B": b}
        self.scale = scale
        self.links |= {"crank": ["O", "A"], "c": ["A", "B"], "r": ["G", "B"]}
        self.crank = self.length("O", "A")
        local = self.shape()
        rocker = self.length("G", "B")
        self.places["A"] = lambda: self.crank * _unit(_radians(self.input))
        self.steps.append(
            (
                [("c", True), ("r", True)],
                lambda x: self._closed(
                    self.places["A"]() + local["B"] * _unit(x[0]), "G", rocker, x[1]
                ),
            )
        )
        for name, z in local.items():
            if name not in "AB":
                self.places[name] = partial(self._on_coupler, z)
        hung = [name for name in local if name not in "AB"]
        # the coupler is turned so that its points are nearest to the sketched ones
        at = [_exact(self.points[name]) for name in local]
        middle, center = (sum(places, acb(0)) / len(at) for places in (at, local.values()))
        pairs = zip(at, local.values(), strict=True)
        self.sketched_coupler = sum(
            ((z - middle) * (own - center).conjugate() for z, own in pairs), acb(0)
        )
        hangers = [self._dyad, self._slider, self._slot, self._cylinder, self._weld]
        for name in hung:
            hangers[int(rng.integers(len(hangers)))](name)
        turned = [self._wheels, self._wheels, self._rack, self._cam, self._curve, self._rolling]
        for _ in range(int(rng.integers(1, 3))):
            turned[int(rng.integers(len(turned)))]()

    def _on_coupler(self, z: acb) -> acb:
        return self.places["A"]() + z * _unit(self.found["c"])

    def _closed(self, tip: acb, pivot: str, length: arb, angle: arb) -> list[arb]:
        gap = tip - _exact(self.points[pivot]) - length * _unit(angle)
        return [gap.real, gap.imag]

    def name(self, letter: str) -> str:
        self.number += 1
        return f"{letter}{self.number}"

    def ground(self, letter: str, place: complex) -> str:
        """A new point of ground."""
        name = self.name(letter)
        self.points[name] = complex(place)
        self.links["ground"].append(name)
        return name

    def near(self, place: complex, far: float = 1.0) -> complex:
        """A place at some distance."""
        size = far * self.scale * self.rng.uniform(0.5, 1.2)
        return complex(place + size * np.exp(1j * self.rng.uniform(0, 2 * math.pi)))

    # Numbers: as text, and exactly

    def number_of(self, value: float) -> tuple[str, arb]:
        """A number near a value: plain, or a formula of dimensions that may cancel."""
        rng = self.rng
        kind = int(rng.integers(6))
        if kind < 3:
            return repr(float(value)), arb(float(value))
        p, q = self.name("p"), self.name("q")
        x = float(abs(value) * 10 ** rng.uniform(-1, 4))
        y = float(rng.uniform(20, 70))
        if kind == 3:
            self.dimensions |= {p: x + value, q: x}
            return f'"{p} - {q}"', arb(x + value) - arb(x)
        if kind == 4:
            self.dimensions |= {p: float(value / math.cos(math.radians(y))), q: y}
            return f'"{p}*cos({q})"', arb(self.dimensions[p]) * _radians(y).cos()
        self.dimensions |= {p: x, q: float(value**2 - x**2)}
        sign = arb(self.dimensions[q]) + arb(x) ** 2
        return f'"sqrt({p}^2 + {q})"', sign.sqrt()

    def length(self, a: str, b: str, *, given: bool | None = None) -> arb:
        """A length of the sketch, given or measured."""
        span = _exact(self.points[b]) - _exact(self.points[a])
        if given is False or (given is None and self.rng.random() < 0.4):
            return abs(span)
        text, value = self.number_of(float(abs(span).mid()))
        self.lengths[f"{a} {b}"] = text
        return value

    def shape(self) -> dict[str, acb]:
        """The coupler's points about A, B on the real axis."""
        rng = self.rng
        a, b = self.points["A"], self.points["B"]
        way = int(rng.integers(3))  # measured; sides; angles
        base = self.length("A", "B", given=way > 0)
        local = {"A": acb(0), "B": acb(base)}
        for k in range(int(rng.integers(1, 5))):
            name = f"C{k}"
            flat = rng.choice([-1, 1]) * 10 ** (rng.uniform(-7, 0) if rng.random() < 0.5 else -0.3)
            self.points[name] = complex(a + (rng.uniform(-0.5, 1.5) + 1j * flat) * (b - a))
            self.links["c"].append(name)
            seen = (_exact(self.points[name]) - _exact(a)) / (_exact(b) - _exact(a))
            if way == 0:
                local[name] = seen * base
            elif way == 1 and (found := self._by_sides(name, local)) is not None:
                local[name] = found
            else:
                side = self.length("A", name, given=True)
                text, angle = self.number_of(math.degrees(float(seen.arg().mid())))
                self.angles[f"B A {name}"] = text
                local[name] = side * _unit(_radians(angle))
        return local

    def _by_sides(self, name: str, local: dict[str, acb]) -> acb | None:
        """Placed from two points before it, unless they and it are in line to rounding."""
        first, second = (list(local)[k] for k in sorted(self.rng.permutation(len(local))[:2]))
        before = dict(self.lengths), dict(self.dimensions)
        r, s = (self.length(q, name, given=True) for q in (first, second))
        span = local[second] - local[first]
        d = abs(span)
        slack = min(float((r + s - d).mid()), float((d - abs(r - s)).mid()))
        if not slack > 1e-15 * float((r + s + d).mid()):
            self.lengths, self.dimensions = before
            return None
        x = (r * r - s * s + d * d) / (2 * d)
        y = (r * r - x * x).sqrt()
        # three points of the sketch may be in line but for their rounding, which then decides
        at = [_exact(self.points[q]) for q in (first, second, name)]
        across = (at[2] - at[0]) * (at[1] - at[0]).conjugate()
        return local[first] + acb(x, y if across.imag > 0 else -y) * span / d

    # What hangs on a point

    def _dyad(self, at: str) -> None:
        pivot = self.ground("H", self.near(self.points[at], 1.5))
        end, one, other = self.name("E"), self.name("d"), self.name("h")
        middle = (self.points[at] + self.points[pivot]) / 2
        turn = (self.points[pivot] - self.points[at]) * 1j
        self.points[end] = complex(middle + turn * self.rng.uniform(0.3, 1.0))
        self.links |= {one: [at, end], other: [pivot, end]}
        first, second = self.length(at, end), self.length(pivot, end)
        self.steps.append(
            (
                [(one, True), (other, True)],
                lambda x: self._closed(
                    self.places[at]() + first * _unit(x[0]), pivot, second, x[1]
                ),
            )
        )
        self.kinds.append("dyad")

    def _line(self, about: complex, direction: complex) -> tuple[str, str, acb, acb]:
        """A line of ground: its points, the first one and its direction exactly."""
        s = self.ground("S", about - direction)
        t = self.ground("T", about + direction)
        span = _exact(self.points[t]) - _exact(self.points[s])
        return s, t, _exact(self.points[s]), span / abs(span)

    def _slider(self, at: str) -> None:
        rng = self.rng
        direction = self.scale * np.exp(1j * rng.uniform(0, 2 * math.pi))
        s, t, origin, along = self._line(self.near(self.points[at], 0.3), complex(direction))
        block, rod, end, name = (self.name(letter) for letter in ("k", "l", "P", "x"))
        text, offset = self.number_of(self.scale * rng.uniform(0.05, 0.5))
        a, b = self.points[s], self.points[t]
        way = (b - a) / abs(b - a)
        foot = (a + b) / 2 + way * self.scale * rng.uniform(0.8, 1.5)
        self.points[end] = complex(foot + 1j * way * float(offset.mid()))
        self.links |= {rod: [at, end], block: [end]}
        length = self.length(at, end)
        self.parts.append(
            f'[[sliders]]\nname="{name}"\nlink="{block}"\npoints=["{end}"]\non="ground"\n'
            f'line=["{s}","{t}"]\noffset={text}\n'
        )

        def residual(x: Sequence[arb]) -> list[arb]:
            tip = self.places[at]() + length * _unit(x[0])
            gap = tip - origin - along * acb(x[1], offset)
            return [gap.real, gap.imag]

        self.steps.append(([(rod, True), (name, False)], residual))
        self.kinds.append("slider")

    def _slot(self, at: str) -> None:
        pivot = self.ground("W", self.near(self.points[at]))
        end, link, name = self.name("V"), self.name("w"), self.name("x")
        self.points[end] = complex(2 * self.points[at] - self.points[pivot])
        self.links[link] = [pivot, end]
        self.parts.append(
            f'[[slots]]\nname="{name}"\npoint="{at}"\non="{link}"\nline=["{pivot}","{end}"]\n'
        )
        self.steps.append(
            (
                [(link, True), (name, False)],
                lambda x: self._closed(self.places[at](), pivot, x[1], x[0]),
            )
        )
        self.kinds.append("slot")

    def _cylinder(self, at: str) -> None:
        pivot = self.ground("W", self.near(self.points[at]))
        name = self.name("z")
        self.parts.append(f'[[cylinders]]\nname="{name}"\nbetween=["{pivot}","{at}"]\n')
        self.steps.append(
            (
                [(f"{name}_angle", True), (name, False)],
                lambda x: self._closed(self.places[at](), pivot, x[1], x[0]),
            )
        )
        self.kinds.append("cylinder")

    def _weld(self, at: str) -> None:
        """A link welded to the coupler, whose angle is derived; a dyad at its end."""
        link, end = self.name("y"), self.name("Y")
        self.points[end] = self.near(self.points[at])
        self.links[link] = [at, end]
        span = _exact(self.points[end]) - _exact(self.points[at])
        gap = (span / self.sketched_coupler).arg()
        text = ""
        if self.rng.random() < 0.5:
            text, value = self.number_of(float(gap.mid()) * _HALF / math.pi)
            gap = _radians(value)
            text = f"angle={text}\n"
        length = self.length(at, end)
        self.parts.append(f'[[welds]]\nlinks=["c","{link}"]\n{text}')
        self.places[end] = lambda: self.places[at]() + length * _unit(self.found["c"] + gap)
        self.steps.append(([(link, True)], lambda x: [x[0] - self.found["c"] - gap]))
        self.kinds.append("weld")
        self._dyad(end)

    # What turns with the rocker

    def _sketched(self, link: str) -> arb:
        a, b = self.links[link][:2]
        return (_exact(self.points[b]) - _exact(self.points[a])).arg()

    def _wheels(self) -> None:
        rng = self.rng
        center, wheel, name = self.ground("W", self.near(self.points["G"])), self.name("w"), None
        self.links[wheel] = [center]
        kind = str(rng.choice(["gears", "belts"]))
        sizes = [self.number_of(self.scale * rng.uniform(0.2, 0.6)) for _ in range(2)]
        key, flag = "radii", bool(rng.random() < 0.5)
        if kind == "gears" and rng.random() < 0.5:
            teeth = rng.integers(12, 80, 2)
            key, sizes = "teeth", [(str(n), arb(int(n))) for n in teeth]
        if kind == "gears" and flag and sizes[0][1] == sizes[1][1]:
            flag = False
        name = self.name("mesh")
        text, phase = "", None
        if rng.random() < 0.5:
            shown, phase = self.number_of(float(rng.uniform(-300, 300)))
            text = f"phase={shown}\n"
        self.parts.append(
            f'[[{kind}]]\nname="{name}"\nwheels=["r","{wheel}"]\ncenters=["G","{center}"]\n'
            f"{key}=[{sizes[0][0]},{sizes[1][0]}]\n"
            f"{'internal' if kind == 'gears' else 'crossed'}={str(flag).lower()}\n{text}"
        )
        ratio = sizes[0][1] / sizes[1][1]
        if flag == (kind == "gears"):  # both turn in one direction
            ratio = -ratio
        begin = ratio * self._sketched("r") if phase is None else _radians(phase)
        self.steps.append(([(wheel, True)], lambda x: [x[0] + ratio * self.found["r"] - begin]))
        self.kinds.append(kind)

    def _rack(self) -> None:
        rng = self.rng
        text, radius = self.number_of(self.scale * rng.uniform(0.2, 0.6))
        way = complex(np.exp(1j * rng.uniform(0, 2 * math.pi)))
        side = float(rng.choice([-1, 1]))
        about = self.points["G"] - 1j * way * side * float(radius.mid())
        s, t, origin, along = self._line(about, way * self.scale)
        bar, p, q, name = self.name("b"), self.name("P"), self.name("Q"), self.name("x")
        a, b = self.points[s], self.points[t]
        self.points[p] = complex(a + (b - a) * rng.uniform(0.1, 0.4))
        self.points[q] = complex(a + (b - a) * rng.uniform(0.6, 0.9))
        self.links[bar] = [p, q]
        self.parts.append(
            f'[[sliders]]\nname="{name}"\nlink="{bar}"\npoints=["{p}","{q}"]\non="ground"\n'
            f'line=["{s}","{t}"]\n[[racks]]\nname="{self.name("rack")}"\npinion="r"\ncenter="G"\n'
            f'slider="{name}"\nradius={text}\n'
        )
        seen = ((_exact(self.points[p]) - origin) * along.conjugate()).real
        turned = self._sketched("r")
        self.steps.append(
            (
                [(name, False)],
                lambda x: [x[0] - seen - side * radius * (self.found["r"] - turned)],
            )
        )
        self.kinds.append("rack")

    def _rolling(self) -> None:
        """A wheel that rolls on a line, its place led by a rack's slider: driven by the rocker."""
        self._rack()
        slider = self.steps[-1][0][0][0]
        rng = self.rng
        text, radius = self.number_of(self.scale * rng.uniform(0.2, 0.6))
        bar = next(link for link in self.links if f'link="{link}"' in self.parts[-1])
        p = self.links[bar][0]
        line = self.parts[-1].split('line=["')[1].split('"]')[0].split('","')
        s, t = (_exact(self.points[q]) for q in line)
        along = (t - s) / abs(t - s)
        # the wheel's centre is carried by a rod from the bar, along the normal of the line
        center, wheel, name = self.name("K"), self.name("w"), self.name("x")
        way = (self.points[line[1]] - self.points[line[0]]) / abs(
            self.points[line[1]] - self.points[line[0]]
        )
        self.points[center] = complex(
            self.points[p] + way * self.scale + 1j * way * float(radius.mid())
        )
        rod = self.name("l")
        self.links |= {rod: [p, center], wheel: [center]}
        length = self.length(p, center)
        self.parts.append(
            f'[[rolling]]\nname="{name}"\nwheel="{wheel}"\ncenter="{center}"\nradius={text}\n'
            f'on="ground"\nline=["{line[0]}","{line[1]}"]\n'
        )
        seen = ((_exact(self.points[center]) - s) * along.conjugate()).real

        def residual(x: Sequence[arb]) -> list[arb]:
            tip = s + along * self.found[slider] + length * _unit(x[0])
            gap = tip - s - along * acb(x[1], radius)
            return [gap.real, gap.imag, radius * x[2] + x[1] - seen]

        self.steps.append(([(rod, True), (name, False), (wheel, True)], residual))
        self.kinds.append("rolling")

    def _cam(self) -> None:
        rng = self.rng
        way = complex(np.exp(1j * rng.uniform(0, 2 * math.pi)))
        base, roller = self.scale * rng.uniform(0.6, 1), self.scale * rng.uniform(0.1, 0.2)
        (base_text, low), (roller_text, size) = self.number_of(base), self.number_of(roller)
        off = rng.uniform(-0.9, 0.9) * base
        s, t, origin, along = self._line(self.points["G"] + 1j * way * off, way * self.scale)
        link, p, q, name = self.name("f"), self.name("P"), self.name("Q"), self.name("x")
        a = self.points["G"] + 1j * way * off
        self.points[p], self.points[q] = complex(a + way * base), complex(a + way * 2 * base)
        self.links[link] = [p, q]
        lift = float(0.2 * base * rng.uniform(0.3, 1))
        start = float(rng.uniform(-90, 90))
        overs = [100.0, 50.0, 130.0, 80.0]
        rise = str(rng.choice(["cycloidal", "3-4-5", "harmonic"]))
        self.parts.append(
            f'[[sliders]]\nname="{name}"\nlink="{link}"\npoints=["{p}","{q}"]\non="ground"\n'
            f'line=["{s}","{t}"]\n[[cams]]\nname="{self.name("cam")}"\ncam="r"\ncenter="G"\n'
            f'slider="{name}"\ncontact="roller"\nradius={roller_text}\nbase={base_text}\n'
            f'start={start!r}\nsegments=[{{law="{rise}",over={overs[0]},lift={lift!r}}},'
            f'{{law="dwell",over={overs[1]}}},{{law="{rise}",over={overs[2]},lift={-lift!r}}},'
            f'{{law="dwell",over={overs[3]}}}]\n'
        )
        center = (_exact(self.points["G"]) - origin) * along.conjugate()
        foot = ((low + size) ** 2 - center.imag**2).sqrt()

        def residual(x: Sequence[arb]) -> list[arb]:
            turn = (self.found["r"] * 180 / arb.pi() - start) / 360
            at = (turn - turn.floor()) * 360
            moved = _follower(at, overs, rise) * arb(lift)
            return [x[0] - center.real - foot - moved]

        self.steps.append(([(name, False)], residual))
        self.kinds.append("cam")

    def _curve(self) -> None:
        """A curve on the rocker; a pin of a slider on ground runs along it."""
        rng = self.rng
        count = int(rng.integers(5, 9))
        xs = self.scale * (np.linspace(-1, 1, count) + rng.uniform(-0.05, 0.05, count))
        ys = self.scale * (1.0 + rng.uniform(-0.2, 0.2, count))
        turned = self.points["B"] - self.points["G"]
        turned = turned / abs(turned)
        through = [complex(x, y) for x, y in zip(xs.tolist(), ys.tolist(), strict=True)]
        middle = through[count // 2] * 0.6 + through[count // 2 - 1] * 0.4
        begin = self.points["G"] + turned * middle
        way = turned * 1j
        s, t, origin, along = self._line(begin, complex(way * self.scale))
        link, p, q = self.name("f"), self.name("P"), self.name("Q")
        name, u = self.name("x"), self.name("u")
        a, b = self.points[s], self.points[t]
        own = (b - a) / abs(b - a)
        self.points[p], self.points[q] = complex(begin), complex(begin + own * self.scale)
        self.links[link] = [p, q]
        listed = ",".join(f"[{z.real!r},{z.imag!r}]" for z in through)
        self.parts.append(
            f'[[sliders]]\nname="{name}"\nlink="{link}"\npoints=["{p}","{q}"]\non="ground"\n'
            f'line=["{s}","{t}"]\n[[curves]]\nname="{u}"\npoint="{p}"\non="r"\norigin="G"\n'
            f"through=[{listed}]\nclosed=false\n"
        )
        at = _spline(through)

        def residual(x: Sequence[arb]) -> list[arb]:
            here = _exact(self.points["G"]) + at(x[1]) * _unit(self.found["r"])
            gap = here - origin - along * x[0]
            return [gap.real, gap.imag]

        self.steps.append(([(name, False), (u, False)], residual))
        self.kinds.append("curve")

    def text(self) -> str:
        """The file."""
        rows = ["format = 1", "[points]"]
        rows += [f"{k} = [{z.real!r}, {z.imag!r}]" for k, z in self.points.items()]
        for title, table in (
            ("dimensions", {k: repr(x) for k, x in self.dimensions.items()}),
            ("links", {k: str(v).replace("'", '"') for k, v in self.links.items()}),
            ("lengths", self.lengths),
            ("angles", self.angles),
        ):
            rows += [f"[{title}]", *(f'"{k}" = {v}' for k, v in table.items())]
        return "\n".join([*rows, *self.parts, '[input]\nlink = "crank"\n'])

    def truth(self, at: float, printed: Callable[[str], float]) -> dict[str, tuple[arb, bool]]:
        """All numbers at an input, next to the printed ones; whether each is an angle [rad]."""
        self.input = arb(at)
        result: dict[str, tuple[arb, bool]] = {}
        for names, residual in self.steps:
            start = [
                _radians(printed(name)) if turns else arb(printed(name)) for name, turns in names
            ]
            for (name, turns), value in zip(names, _root(residual, start), strict=True):
                self.found[name] = value
                result[name] = value, turns
        return result


def _follower(at: arb, overs: Sequence[float], law: str) -> arb:
    """The part of the lift at an angle of the cam [deg]."""
    ends = np.cumsum(overs)
    if at < arb(overs[0]):
        return _rise(at / arb(overs[0]), law)
    if at < arb(float(ends[1])):
        return arb(1)
    if at < arb(float(ends[2])):
        return 1 - _rise((at - arb(float(ends[1]))) / arb(overs[2]), law)
    return arb(0)


def _rise(t: arb, law: str) -> arb:
    if law == "cycloidal":
        return t - (2 * arb.pi() * t).sin() / (2 * arb.pi())
    if law == "harmonic":
        return (1 - (arb.pi() * t).cos()) / 2
    return 10 * t**3 - 15 * t**4 + 6 * t**5


def _spline(points: Sequence[complex]) -> Callable[[arb], acb]:
    """The natural cubic spline over chord lengths."""
    z = [_exact(p) for p in points]
    u = [arb(0)]
    for p, q in pairwise(z):
        u.append(u[-1] + abs(q - p))
    h = [b - a for a, b in pairwise(u)]
    n = len(h)
    second = [acb(0)] * (n + 1)
    matrix = arb_mat(n - 1, n - 1)
    right = arb_mat(n - 1, 2)
    for k in range(1, n):
        matrix[k - 1, k - 1] = 2 * (h[k - 1] + h[k])
        if k > 1:
            matrix[k - 1, k - 2] = h[k - 1]
        if k < n - 1:
            matrix[k - 1, k] = h[k]
        bent = 6 * ((z[k + 1] - z[k]) / h[k] - (z[k] - z[k - 1]) / h[k - 1])
        right[k - 1, 0], right[k - 1, 1] = bent.real, bent.imag
    solved = matrix.solve(right)
    for k in range(1, n):
        second[k] = acb(solved[k - 1, 0], solved[k - 1, 1])

    def at(x: arb) -> acb:
        k = 0
        while k < n - 1 and x > u[k + 1]:
            k += 1
        t = x - u[k]
        slope = (z[k + 1] - z[k]) / h[k] - h[k] * (2 * second[k] + second[k + 1]) / 6
        bend = (second[k + 1] - second[k]) / (6 * h[k])
        return z[k] + t * (slope + t * (second[k] / 2 + t * bend))

    return at


def judge_radii(number: int, counts: Counter[str]) -> list[str]:
    """The false claims of one random mechanism: printed numbers beyond the radius of the row."""
    rng = np.random.default_rng([40, number])
    made = RandomMechanism(rng)
    at = float(made.at + rng.uniform(-15, 15))
    try:
        mechanism = lw.loads(made.text())
        position = mechanism.solve(at=at)
    except lw.LinkworkError:
        counts["refused"] += 1
        return []
    radius = position.certificate.radius
    if not position.certificate.certified or radius is None:
        counts["not certified"] += 1
        return []
    counts["rows"] += 1
    counts.update(made.kinds)
    counts[f"links of {len(made.links['c'])} points"] += 1
    scale = mechanism.model.equations.length_scale
    false, worst = [], 0.0
    for name, (value, turns) in made.truth(at, lambda name: float(position[name])).items():
        printed = float(position[name])
        if turns:
            off = abs((_unit(value) / _unit(_radians(printed))).arg())
        else:
            off = abs(value - arb(printed)) / arb(scale)
        counts["numbers"] += 1
        part = float(off.mid()) / radius
        worst = max(worst, part)
        if not part <= 1.0:
            kinds = ", ".join(made.kinds)
            false.append(f"{number} ({kinds}): {name} is {part:.3g} radii of {radius:.2g} off")
    for bound in (0.01, 0.1, 0.5):
        counts[f"rows within {bound} of the radius"] += worst <= bound
    return false


def radius_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many rows."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        false += judge_radii(number, counts)
    return counts, false
