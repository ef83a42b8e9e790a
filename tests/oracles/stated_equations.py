"""Positions from what a file states, in seventy digits: the reference of derivatives.

A link has the coordinates of its first point and its angle; every pin, guide, wheel and cam is an
equation of these, and the equations of loop files are taken as written. Nothing of the product's
loop equations, kernels, tapes or jets is used: of the product there are the parsed file, the trees
of its formulas, and a first guess. Derivatives are differences over steps of 1e-12, good to twenty
digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from flint import acb, arb, ctx

from linkwork.contacts.cams import Cam, follower_frame
from linkwork.core.expression.grammar import parse, parse_equation
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.part.gears import Belt, Gear, Rack
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot, guide_named
from linkwork.core.mechanism.part.rolling import Rolling
from linkwork.core.mechanism.part.springs import Spring, Weld
from linkwork.core.mechanism.varied_numbers import VariedNumber

__all__ = ["DIGITS", "NotStated", "StatedEquations", "stated"]

DIGITS = 70
_SOLVED = arb("1e-62")
_STEP = arb(2) ** -66  # of the slopes of equations; exact, as functions of wide balls lose digits
_MOST_STEPS = 25
_I = acb(0, 1)

Ball = Any  # arb or acb


class NotStated(Exception):
    """The equations of this file, or a position of it, are not known here."""


def _angle(z: Ball) -> Ball:
    return acb(z).arg()


def _turn(angle: Ball) -> Ball:
    return acb(0, angle).exp()


def _real(z: Ball) -> Ball:
    return z.real if isinstance(z, acb) else z


def evaluate(
    node: Node,
    named: Callable[[str], Ball],
    radians: Ball,
    turning: Callable[[str], Ball] | None = None,
) -> Ball:
    """A formula; ``radians``: those of the unit of angles in its functions; ``turning``: names in
    exponents, in radians.
    """
    match node:
        case NumberNode():
            return arb(node.value)
        case Name():
            constants: dict[str, Callable[[], Ball]] = {
                "pi": arb.pi,
                "e": lambda: arb(1).exp(),
                "i": lambda: _I,
            }
            return constants[node.name]() if node.name in constants else named(node.name)
        case Negative():
            return -evaluate(node.operand, named, radians, turning)
        case Binary(operator="^", left=Name(name="e")):
            return acb(evaluate(node.right, turning or named, radians)).exp()
        case Binary():
            a, b = (evaluate(side, named, radians, turning) for side in (node.left, node.right))
            operations: dict[str, Callable[[], Ball]] = {
                "+": lambda: a + b, "-": lambda: a - b, "*": lambda: a * b, "/": lambda: a / b,
                "^": lambda: a ** (int(float(b)) if b.is_integer() else b),
            }  # fmt: skip
            return operations[node.operator]()
        case Call():
            given = [evaluate(x, named, radians, turning) for x in node.arguments]
            return _call(node.function, given, radians)


def _call(function: str, given: Sequence[Ball], radians: Ball) -> Ball:
    if function in ("sin", "cos", "tan"):
        return getattr(given[0] * radians, function)()
    if function in ("asin", "acos", "atan"):
        return getattr(given[0], function)() / radians
    if function == "cis":
        return _turn(given[0] * radians)
    if function == "hypot":
        return (given[0] ** 2 + given[1] ** 2).sqrt()
    if function in ("sqrt", "exp"):
        return getattr(given[0], function)()
    raise NotStated(function)


class _Numbers:
    """The numbers of a file, one of them changed."""

    def __init__(self, description: Description, changed: Mapping[VariedNumber, Ball]) -> None:
        self.description = description
        self.radians = arb.pi() / 180 if description.angle.value == "deg" else arb(1)
        self.changed = {(q.table, q.key, q.axis): value for q, value in changed.items()}
        self.given = {canonical(name): name for name in description.dimensions}
        self.known: dict[str, Ball] = {}

    def __call__(self, number: float | int | str) -> Ball:
        if isinstance(number, str):
            return evaluate(parse(number), self.dimension, self.radians)
        return arb(float(number))

    def dimension(self, name: str) -> Ball:
        """A dimension by its canonical name."""
        if name not in self.known:
            if name not in self.given:
                raise NotStated(name)
            own = self.given[name]
            self.known[name] = self.of("dimensions", own, self.description.dimensions[own])
        return self.known[name]

    def of(self, table: str, key: str, written: float | int | str, axis: int = 0) -> Ball:
        """A number of a table, as written or changed."""
        if (table, key, axis) in self.changed:
            return self.changed[table, key, axis]
        return self(written)


class StatedEquations:
    """The equations of one file with some numbers changed.

    Parameters
    ----------
    description : Description
    changed : Mapping[VariedNumber, arb]
    guess : Mapping[str, float]
        Points as ``P.x``, ``P.y``, angles of links [rad] and lengths, near the position.
    """

    def __init__(
        self,
        description: Description,
        changed: Mapping[VariedNumber, Ball],
        guess: Mapping[str, float],
    ) -> None:
        self.numbers = _Numbers(description, changed)
        self.guess = guess
        self.names: list[str] = []
        self.start: list[Ball] = []

    def unknown(self, name: str, start: float) -> None:
        """Add a coordinate."""
        self.names.append(name)
        self.start.append(arb(start))

    def solve(self, inputs: Sequence[Ball], near: Sequence[Ball] | None = None) -> dict[str, Ball]:
        """The coordinates by name for values of the inputs [rad] or [length]."""
        x = list(self.start if near is None else near)
        n = len(x)
        base = self.residuals(dict(zip(self.names, x, strict=True)), inputs)
        columns = []
        for k in range(n):
            moved = [*x[:k], x[k] + _STEP, *x[k + 1 :]]
            there = self.residuals(dict(zip(self.names, moved, strict=True)), inputs)
            columns.append([float((a - b) / _STEP) for a, b in zip(there, base, strict=True)])
        inverse = np.linalg.pinv(np.array(columns).T, rcond=1e-11)
        scale = max(1.0, *(abs(float(value)) for value in x))
        for _ in range(_MOST_STEPS):
            step = [
                sum((arb(row[i]) * rest for i, rest in enumerate(base)), arb(0)) for row in inverse
            ]
            # midpoints: balls would grow with every step
            x = [(a - b).mid() for a, b in zip(x, step, strict=True)]
            base = self.residuals(dict(zip(self.names, x, strict=True)), inputs)
            if all(abs(b) <= _SOLVED * scale for b in step):
                break
        if not all(abs(rest.mid()) <= arb("1e-55") * scale for rest in base):
            raise NotStated("no position near the product's")
        return dict(zip(self.names, x, strict=True))

    def residuals(self, x: Mapping[str, Ball], inputs: Sequence[Ball]) -> list[Ball]:
        """All equations at some coordinates."""
        raise NotImplementedError

    def point(self, x: Mapping[str, Ball], name: str) -> Ball:
        """A point x + iy."""
        raise NotImplementedError

    def own(self, x: Mapping[str, Ball], name: str) -> Ball:
        """A variable by its name [rad] or [length]."""
        raise NotImplementedError


def stated(
    description: Description, changed: Mapping[VariedNumber, Ball], guess: Mapping[str, float]
) -> StatedEquations:
    """The equations of a file.

    Raises
    ------
    NotStated
        For splines through points, which are not equations of the file.
    """
    ctx.dps = DIGITS
    if isinstance(description, Linkage):
        return _StatedLinkage(description, changed, guess)
    if isinstance(description, Loops | PlainEquations):
        return _StatedLoops(description, changed, guess)
    raise NotStated(type(description).__name__)


class _StatedLoops(StatedEquations):
    """Loop equations, or plain equations, as written."""

    def __init__(
        self,
        description: Loops | PlainEquations,
        changed: Mapping[VariedNumber, Ball],
        guess: Mapping[str, float],
    ) -> None:
        super().__init__(description, changed, guess)
        self.description = description
        self.driven = [canonical(which.drives[1]) for which in description.inputs]
        self.spelling = {canonical(name): name for name in description.guess}
        for name, own in self.spelling.items():
            if name not in self.driven:
                self.unknown(name, guess[own])
        texts = description.loops if isinstance(description, Loops) else description.equations
        self.sides = [parse_equation(text) for text in texts.values()]
        points = description.points if isinstance(description, Loops) else {}
        self.paths = {canonical(name): parse(text) for name, text in points.items()}

    def _value(self, node: Node, x: Mapping[str, Ball], inputs: Mapping[str, Ball]) -> Ball:
        """One side of an equation, or a point."""

        def named(name: str, unit: Ball = 1) -> Ball:
            if name in x:
                return x[name]
            if name in inputs:
                return inputs[name]
            if name in self.paths:
                return self._value(self.paths[name], x, inputs)
            return self.numbers.dimension(name) * unit

        # dimensions in exponents are angles of the file
        return evaluate(node, named, arb(1), lambda name: named(name, self.numbers.radians))

    def residuals(self, x: Mapping[str, Ball], inputs: Sequence[Ball]) -> list[Ball]:
        self.at = dict(zip(self.driven, inputs, strict=True))
        found = []
        for left, right in self.sides:
            rest = acb(self._value(left, x, self.at) - self._value(right, x, self.at))
            found += [rest.real] if isinstance(self.description, PlainEquations) else [
                rest.real, rest.imag]  # fmt: skip
        return found

    def solve(self, inputs: Sequence[Ball], near: Sequence[Ball] | None = None) -> dict[str, Ball]:
        found = super().solve(inputs, near)
        return {**found, **dict(zip(self.driven, inputs, strict=True))}

    def point(self, x: Mapping[str, Ball], name: str) -> Ball:
        return acb(self._value(self.paths[canonical(name)], x, x))

    def own(self, x: Mapping[str, Ball], name: str) -> Ball:
        return x[canonical(name)]


class _StatedLinkage(StatedEquations):
    """Points and links: bodies with three coordinates, and the equations of their joints."""

    def __init__(
        self,
        linkage: Linkage,
        changed: Mapping[VariedNumber, Ball],
        guess: Mapping[str, float],
    ) -> None:
        super().__init__(linkage, changed, guess)
        self.linkage = linkage
        self.sketch = {
            point: acb(*(self.numbers.of("points", point, xy[k], k) for k in range(2)))
            for point, xy in linkage.points.items()
        }
        self.local = {link: self._shape(link) for link in linkage.links}
        self.carriers: dict[str, list[str]] = {}
        for link, points in linkage.links.items():
            for point in points:
                self.carriers.setdefault(point, []).append(link)
            if link != GROUND:
                for axis in "xy":
                    self.unknown(f"{link}/{axis}", guess[f"{points[0]}.{axis}"])
                self.unknown(f"{link}/turn", guess.get(link, 0.0))
        self.whole: dict[int, Ball] = {}
        for part in linkage.parts:
            if isinstance(part, Slider | Slot | Rolling):
                self.unknown(part.name, guess[part.name])
            elif not isinstance(part, Cylinder | Spring | Weld | Gear | Belt | Rack | Cam):
                if type(part).__name__ != "Load":
                    raise NotStated(type(part).__name__)
            elif isinstance(part, Cam) and not part.segments:
                raise NotStated("a cam by its outline")

    # Shapes of links

    def _shape(self, link: str) -> dict[str, Ball]:
        """Places of the points in the frame of their link."""
        points = self.linkage.links[link]
        if link == GROUND:
            return {p: self.sketch[p] for p in points}
        if len(points) == 1:
            return {points[0]: acb(0)}
        own = set(points)
        given: list[Callable[[Mapping[str, Ball]], Ball]] = []
        for key, number in self.linkage.lengths.items():
            if own.issuperset(key.split()):
                a, b = key.split()
                given.append(_distance(a, b, self.numbers.of("lengths", key, number)))
        for key, number in self.linkage.angles.items():
            if own.issuperset(key.split()):
                turn = self.numbers.of("angles", key, number) * self.numbers.radians
                a, v, b = key.split()
                given.append(_vertex(a, v, b, turn))
        for seen in self.linkage.shapes.measured:
            if seen.link == link:
                a, b = seen.points
                given.append(_distance(a, b, abs(self.sketch[b] - self.sketch[a])))
        guess = self.linkage.shapes.local[link]
        names = [f"{p}/{axis}" for p in points[1:] for axis in "xy"][:1]
        names += [f"{p}/{axis}" for p in points[2:] for axis in "xy"]

        def places(x: Mapping[str, Ball]) -> dict[str, Ball]:
            found = {points[0]: acb(0), points[1]: acb(x[f"{points[1]}/x"])}
            return found | {p: acb(x[f"{p}/x"], x[f"{p}/y"]) for p in points[2:]}

        start = [
            complex(guess[name[:-2]]).real if name.endswith("x") else complex(guess[name[:-2]]).imag
            for name in names
        ]
        shape = _Shape(given, places)
        for name, value in zip(names, start, strict=True):
            shape.unknown(name, value)
        return places(shape.solve(()))

    # Places of bodies

    def turn(self, x: Mapping[str, Ball], link: str) -> Ball:
        """The angle of a link."""
        return arb(0) if link == GROUND else x[f"{link}/turn"]

    def on(self, x: Mapping[str, Ball], link: str, point: str) -> Ball:
        """A point as carried by a link."""
        if link == GROUND:
            return self.local[GROUND][point]
        first = acb(x[f"{link}/x"], x[f"{link}/y"])
        return first + self.local[link][point] * _turn(self.turn(x, link))

    def point(self, x: Mapping[str, Ball], name: str) -> Ball:
        return self.on(x, self.carriers[name][0], name)

    def sketched(self, link: str) -> Ball:
        """The angle of a link in the sketch."""
        points = self.linkage.links.get(link, ())
        for part in self.linkage.parts if len(points) < 2 else ():
            # a wheel with one point has the direction of what it is welded to
            if isinstance(part, Weld) and link in part.links:
                angle = self.numbers(part.angle or 0) * self.numbers.radians
                first, second = part.links
                return self.sketched(second) - angle if link == first else (
                    self.sketched(first) + angle)  # fmt: skip
        if link == GROUND or len(points) < 2:
            return arb(0)
        return _angle(self.sketch[points[1]] - self.sketch[points[0]])

    def own(self, x: Mapping[str, Ball], name: str) -> Ball:
        if name in self.linkage.links:
            return self.turn(x, name)
        if name in x:
            return x[name]
        for part in self.linkage.parts:
            if isinstance(part, Cylinder):
                a, b = (self.point(x, point) for point in part.between)
                if name == part.name:
                    return abs(b - a)
                if name == f"{part.name}_angle":
                    return self._near(_angle(b - a), name)
        raise NotStated(name)

    def _near(self, angle: Ball, name: str) -> Ball:
        """The angle with whole turns as in the guess."""
        turns = round((self.guess[name] - float(angle)) / (2.0 * np.pi))
        return angle + 2 * arb.pi() * turns

    # Equations

    def residuals(self, x: Mapping[str, Ball], inputs: Sequence[Ball]) -> list[Ball]:
        found: list[Ball] = []
        for point, links in self.carriers.items():
            for other in links[1:]:
                found += _parts(self.on(x, links[0], point) - self.on(x, other, point))
        for part in self.linkage.parts:
            found += self._joint(part, x)
        for which, value in zip(self.linkage.inputs, inputs, strict=True):
            found.append(self._driven(which, x) - value)
        return found

    def _driven(self, which: Any, x: Mapping[str, Ball]) -> Ball:
        kind, name = which.drives
        if kind in ("slider", "cylinder"):
            return self.own(x, name)
        if kind == "link":
            return self.turn(x, name) - self.turn(x, which.relative_to or GROUND)
        against, link = self.linkage.bodies_at(name)
        if link == GROUND:
            against, link = link, against
        return self.turn(x, link) - self.turn(x, against)

    def _joint(self, part: Any, x: Mapping[str, Ball]) -> Iterator[Ball]:
        turn, number = self.turn, self.numbers
        if isinstance(part, Slider | Slot):
            yield from self._guide(part, x)
        elif isinstance(part, Weld):
            first, second = part.links
            kept = (
                self.sketched(second) - self.sketched(first)
                if part.angle is None
                else number(part.angle) * number.radians
            )
            yield self._turns(part, turn(x, second) - turn(x, first) - kept)
        elif isinstance(part, Gear | Belt):
            sizes: Any = part.radii if part.radii is not None else part.teeth
            p, q = map(number, sizes)
            p = -p if part.together else p
            yield self._mesh(part, [(part.wheels[1], q), (part.wheels[0], p), (part.arm, -p - q)],
                             x, q)  # fmt: skip
        elif isinstance(part, Rack):
            guide: Any = guide_named(self.linkage, part.slider)
            radius = number(part.radius) * self._side(guide.line, part.center)
            now = turn(x, guide.on) - turn(x, part.pinion)
            then = self.sketched(guide.on) - self.sketched(part.pinion)
            way = self._along(guide.line, guide.point_on_line)
            yield x[part.slider] - way + radius * (now - then)
        elif isinstance(part, Rolling):
            yield from self._rolling(part, x)
        elif isinstance(part, Cam):
            yield self._cam(part, x)

    def _guide(self, part: Slider | Slot, x: Mapping[str, Ball]) -> Iterator[Ball]:
        start, end = (self.on(x, part.on, p) for p in part.line)
        along = (end - start) / abs(end - start)
        if isinstance(part, Slot):
            body = next(link for link in self.carriers[part.point] if link != part.on)
            yield from _parts(self.on(x, body, part.point) - start - along * x[part.name])
            return
        offset = self.numbers.of("sliders", part.name, part.offset)
        guided = [self.on(x, part.link, p) for p in part.points]
        yield from _parts(guided[0] - start - along * acb(x[part.name], offset))
        if len(guided) == 2:
            yield ((guided[1] - start) * along.conjugate()).imag - offset
            return
        line = self.local[part.on][part.line[1]] - self.local[part.on][part.line[0]]
        kept = _angle(line)
        if part.angle is not None:
            kept += self.numbers(part.angle) * self.numbers.radians
        elif part.link == GROUND or len(self.linkage.links[part.link]) > 1:
            a, b = (self.sketch[p] for p in part.line)
            kept += self.sketched(part.link) - _angle(b - a)
        yield self._turns(part, self.turn(x, part.link) - self.turn(x, part.on) - kept)

    def _turns(self, part: Any, rest: Ball) -> Ball:
        """An equation of angles, which may differ by whole turns."""
        if id(part) not in self.whole:
            self.whole[id(part)] = 2 * arb.pi() * round(float(rest) / (2.0 * np.pi))
        return rest - self.whole[id(part)]

    def _mesh(
        self, part: Any, turns: Sequence[tuple[str, Ball]], x: Mapping[str, Ball], unit: Ball
    ) -> Ball:
        now = sum((w * self._wheel(x, link) for link, w in turns), arb(0))
        phase = getattr(part, "phase", None)
        if phase is None:
            total = sum((w * self._sketched_wheel(link) for link, w in turns), arb(0))
        else:
            total = unit * self.numbers(phase) * self.numbers.radians
        return self._turns(part, (now - total) / unit)

    def _wheel(self, x: Mapping[str, Ball], name: str) -> Ball:
        return self.turn(x, name) if name in self.linkage.links else x[name]

    def _sketched_wheel(self, name: str) -> Ball:
        if name in self.linkage.links:
            return self.sketched(name)
        part: Any = next(p for p in self.linkage.parts if getattr(p, "name", "") == name)
        return _angle(self.sketch[part.center] - self.sketch[part.circle])

    def _along(self, line: tuple[str, str], point: str) -> Ball:
        """The place of a point along a line in the sketch."""
        a, b, p = (self.sketch[q] for q in (*line, point))
        return ((p - a) * (b - a).conjugate()).real / abs(b - a)

    def _side(self, line: tuple[str, str], point: str) -> int:
        a, b, p = (self.sketch[q] for q in (*line, point))
        return 1 if ((p - a) * (b - a).conjugate()).imag > 0 else -1

    def _rolling(self, part: Any, x: Mapping[str, Ball]) -> Iterator[Ball]:
        centre = self.point(x, part.center)
        radius = self.numbers(part.radius)
        if part.line is not None:
            side = self._side(part.line, part.center)
            start, end = (self.on(x, part.on, p) for p in part.line)
            along = (end - start) / abs(end - start)
            yield from _parts(centre - start - along * acb(x[part.name], side * radius))
            now = self.turn(x, part.wheel) - self.turn(x, part.on)
            then = self.sketched(part.wheel) - self.sketched(part.on)
            way = x[part.name] - self._along(part.line, part.center)
            yield way + side * radius * (now - then)
            return
        large = self.numbers(part.circle_radius)
        length = abs(large - radius) if part.inside else large + radius
        yield from _parts(centre - self.point(x, part.circle) - length * _turn(x[part.name]))
        p = -large if part.inside else large
        turns = [(part.wheel, radius), (part.on, p), (part.name, -p - radius)]
        yield self._mesh(part, turns, x, radius)

    def _cam(self, part: Any, x: Mapping[str, Ball]) -> Ball:
        number, radians = self.numbers, self.numbers.radians
        frame = follower_frame(self.linkage, part)
        turned = self.turn(x, part.cam) - self.turn(x, frame) - number(part.start) * radians
        reach = number(part.base or 0) + number(part.radius)
        local = self.local[frame]
        flat = part.contact == "flat"
        if part.slider is not None:
            guide: Any = guide_named(self.linkage, part.slider)
            a, b = (local[p] for p in guide.line)
            centre = (local[part.center] - a) * ((b - a) / abs(b - a)).conjugate()
            offset = arb(0)
            if isinstance(guide, Slider):
                offset = number.of("sliders", guide.name, guide.offset)
            low = number(part.base or 0) if flat else (
                reach**2 - (offset - centre.imag) ** 2).sqrt()  # fmt: skip
            sign = 1 if self._along(guide.line, guide.point_on_line) > centre.real else -1
            lift = self._lift(part, turned, arb(1))
            return x[guide.name] - centre.real - sign * (low + lift)
        own = self.local[part.link]
        arm, ground = own[part.point] - own[part.pivot], local[part.center] - local[part.pivot]
        pivot, centre, tip = (self.sketch[q] for q in (part.pivot, part.center, part.point))
        sign = 1 if ((tip - pivot) * (centre - pivot).conjugate()).imag > 0 else -1
        a, d = abs(arm), abs(ground)
        low = (reach / d).asin() if flat else ((a**2 + d**2 - reach**2) / (2 * a * d)).acos()
        swing = self.turn(x, part.link) + _angle(arm) - self.turn(x, frame) - _angle(ground)
        return self._turns(part, swing - sign * (low + self._lift(part, turned, radians)))

    def _lift(self, part: Cam, turned: Ball, scale: Ball) -> Ball:
        """The motion of a follower over one turn of its cam."""
        spans = [self.numbers(s.over) * self.numbers.radians for s in part.segments]
        at = turned - 2 * arb.pi() * int(np.floor(float(turned) / (2.0 * np.pi)))
        lift = arb(0)
        for segment, span in zip(part.segments, spans, strict=True):
            rise = self.numbers(segment.lift) * scale
            if float(at) < float(span):
                return lift + rise * _law(segment.law, at / span)
            lift, at = lift + rise, at - span
        return lift


class _Shape(StatedEquations):
    """The dimensions of one link."""

    def __init__(
        self,
        given: Sequence[Callable[[Mapping[str, Ball]], Ball]],
        places: Callable[[Mapping[str, Ball]], dict[str, Ball]],
    ) -> None:
        self.given, self.places = given, places
        self.names, self.start = [], []

    def residuals(self, x: Mapping[str, Ball], inputs: Sequence[Ball]) -> list[Ball]:
        z = self.places(x)
        return [one(z) for one in self.given]


def _distance(a: str, b: str, length: Ball) -> Callable[[Mapping[str, Ball]], Ball]:
    return lambda z: abs(z[b] - z[a]) - length


def _vertex(a: str, v: str, b: str, angle: Ball) -> Callable[[Mapping[str, Ball]], Ball]:
    return lambda z: _angle((z[b] - z[v]) * (z[a] - z[v]).conjugate() * _turn(-angle))


def _parts(z: Ball) -> list[Ball]:
    return [_real(acb(z)), acb(z).imag]


def _law(law: str, t: Ball) -> Ball:
    """A rise from 0 to 1 over t from 0 to 1 (Norton, Cam Design and Manufacturing Handbook)."""
    pi = arb.pi()
    if law == "dwell":
        return arb(0)
    if law == "harmonic":
        return (1 - (pi * t).cos()) / 2
    if law == "cycloidal":
        return t - (2 * pi * t).sin() / (2 * pi)
    if law == "3-4-5":
        return t**3 * (10 - 15 * t + 6 * t**2)
    if law == "4-5-6-7":
        return t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3)
    if law == "modified sine":
        c = pi / (4 + pi)
        if t < arb(1) / 8:
            return c * (t - (4 * pi * t).sin() / (4 * pi))
        if t > arb(7) / 8:
            return 1 - _law(law, 1 - t)
        third = (pi / 3 + 4 * pi * t / 3).sin()
        return c * (2 / pi + t - 9 / (4 * pi) * third)
    raise NotStated(law)
