"""Bodies, what turns together, and where points sit in the frame of each body.

Links that slide on each other without turning share one angle variable. A point's place in a body
is a sum of terms: a fixed vector, and for slots and sliders a variable length along their line.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field

from linkwork.equations.model import LinkAngle, Term
from linkwork.expression.grammar import parse
from linkwork.expression.tree import Name, Node
from linkwork.foundation.names import canonical
from linkwork.mechanism.description import Problems
from linkwork.mechanism.linkage import GROUND, Linkage
from linkwork.mechanism.parts import Slider, Slot

__all__ = ["Frames", "Place"]


@dataclass(frozen=True)
class Place:
    """Where a point sits in a body: a fixed vector from the body's origin, and sliding terms."""

    fixed: complex
    sliding: tuple[Term, ...] = ()
    base: str = ""  # the point at the tip of the fixed vector, for naming


@dataclass
class Frames:
    """All bodies of a linkage with the places of their points.

    ``bodies`` in the file's order, ground first. ``angle[body]`` tells its variable and constant.
    ``places[body][point]``. ``symbols`` collects the named lengths that were used.
    """

    linkage: Linkage
    bodies: list[str] = field(default_factory=list)
    angle: dict[str, LinkAngle] = field(default_factory=dict)
    places: dict[str, dict[str, Place]] = field(default_factory=dict)
    lengths: list[str] = field(default_factory=list)
    start: dict[str, float] = field(default_factory=dict)
    symbols: dict[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, linkage: Linkage, problems: Problems) -> Frames:
        """Bodies, shared angles and places; contradictions are added to ``problems``."""
        frames = cls(linkage)
        frames.bodies = [GROUND, *[b for b in linkage.links if b != GROUND]]
        groups = _Orientation(linkage, problems)
        for body in frames.bodies:
            frames.angle[body] = groups.angle_of(body)
        for body in frames.bodies:
            root = groups.root(body)
            if frames.angle[body].variable == body:
                frames.start[body] = groups.sketched_angle(root, body)
            local = linkage.shapes.local[body]
            frames.places[body] = {p: Place(z, base=p) for p, z in local.items()}
        for slot in linkage.slots:
            frames._add_guide(slot, slot.point, 0.0)
        for slider in linkage.sliders:
            frames._add_guide(slider, slider.points[0], linkage.numbers(slider.offset))
        for cylinder in linkage.cylinders:
            a, b = cylinder.between
            frames.bodies.append(cylinder.name)
            frames.angle[cylinder.name] = LinkAngle(variable=cylinder.angle_name, constant=0.0)
            rod = Term(
                value=1.0 + 0j,
                length=canonical(cylinder.name),
                phase=((canonical(cylinder.angle_name), 1.0),),
            )
            frames.places[cylinder.name] = {a: Place(0j, base=a), b: Place(0j, (rod,), base=a)}
            span = linkage.sketched(b) - linkage.sketched(a)
            frames.lengths.append(cylinder.name)
            frames.start[cylinder.name] = abs(span)
            frames.start[cylinder.angle_name] = cmath.phase(span)
        return frames

    def _add_guide(self, guide: Slot | Slider, point: str, offset: float) -> None:
        """The guided point's place in the body that carries the line."""
        linkage, body = self.linkage, guide.on
        s, t = (linkage.shapes.local[body][p] for p in guide.line)
        along = (t - s) / abs(t - s)
        terms = [self._turned(along, None, body, guide.name)]
        if offset:
            name = canonical(f"{guide.name}_offset")
            self.symbols[name] = abs(offset)
            sideways = 1j * along * math.copysign(1.0, offset)
            terms.append(self._turned(sideways * abs(offset), Name(name, name), body))
        self.places[body][point] = Place(s, tuple(terms), base=guide.line[0])
        self.lengths.append(guide.name)
        a, b, p = (linkage.sketched(q) for q in (*guide.line, point))
        self.start[guide.name] = ((p - a) * (b - a).conjugate()).real / abs(b - a)

    def _turned(self, z: complex, shown: Node | None, body: str, length: str | None = None) -> Term:
        """A vector of the body's frame as a term."""
        angle = self.angle[body]
        phase = ((canonical(angle.variable), 1.0),) if angle.variable is not None else ()
        symbol = None if length is None else canonical(length)
        return Term.vector(z * cmath.exp(1j * angle.constant), shown, symbol, phase)

    def between(self, body: str, start: str, end: str) -> list[Term]:
        """The vector from one point to another across a body, as terms."""
        a, b = self.places[body][start], self.places[body][end]
        terms = []
        if a.base != b.base:
            shown = self._distance(body, a.base, b.base)
            terms.append(self._turned(b.fixed - a.fixed, shown, body))
        terms += [term.negated() for term in a.sliding]
        terms += list(b.sliding)
        return terms

    def _distance(self, body: str, a: str, b: str) -> Node:
        """How the distance between two points is called in formulas."""
        order = self.linkage.links[body]
        if order.index(a) > order.index(b):
            a, b = b, a
        given = self.linkage.lengths.get(f"{a} {b}", self.linkage.lengths.get(f"{b} {a}"))
        if isinstance(given, str):
            tree = parse(given)
            if isinstance(tree, Name):
                self.symbols[tree.name] = self.linkage.numbers(given)
                return tree
        name = f"{a}{b}"
        places = self.places[body]
        self.symbols[name] = abs(places[b].fixed - places[a].fixed)
        return Name(name, name)


class _Orientation:
    """Groups of links that keep their relative orientation because they only slide."""

    def __init__(self, linkage: Linkage, problems: Problems) -> None:
        self.linkage = linkage
        self._parent: dict[str, tuple[str, float]] = {b: (b, 0.0) for b in linkage.links}
        for k, slider in enumerate(linkage.sliders):
            self._join(slider, ("sliders", k), problems)
        driven = {w.link for w in linkage.inputs if w.link}
        self._name: dict[str, str] = {}
        for body in linkage.links:
            root = self.root(body)
            named = self._name.get(root)
            if len(linkage.links[body]) < 2 or body == GROUND:
                continue
            if named is None or (body in driven and named not in driven):
                self._name[root] = body
        self._ground = self.root(GROUND)

    def _find(self, body: str) -> tuple[str, float]:
        """The group's root and θ_body - θ_root."""
        total = 0.0
        while self._parent[body][0] != body:
            body, offset = self._parent[body]
            total += offset
        return body, total

    def root(self, body: str) -> str:
        """The group of a body."""
        return self._find(body)[0]

    def _join(self, slider: Slider, key: tuple[str | int, ...], problems: Problems) -> None:
        """θ_link = θ_on + constant."""
        constant = self._constant(slider)
        a, offset_a = self._find(slider.link)
        b, offset_b = self._find(slider.on)
        if a == b:
            gap = math.remainder(offset_a - offset_b - constant, 2 * math.pi)
            if abs(gap) > 1e-9:
                problems.add(
                    key,
                    f'"{slider.link}" cannot keep its angle against "{slider.on}": '
                    f"other sliders turn it by {math.degrees(gap):.6g}° from there",
                )
            return
        self._parent[a] = (b, constant + offset_b - offset_a)

    def _constant(self, slider: Slider) -> float:
        """The link's angle minus the carrier's, from the line and the sliding points."""
        linkage = self.linkage
        s, t = (linkage.shapes.local[slider.on][p] for p in slider.line)
        line = cmath.phase(t - s)
        local = linkage.shapes.local[slider.link]
        if len(slider.points) == 2:
            own = cmath.phase(local[slider.points[1]] - local[slider.points[0]])
            d, e, a, b = (linkage.sketched(p) for p in (*slider.points, *slider.line))
            along = ((e - d) * (b - a).conjugate()).real >= 0
            return line - own + (0.0 if along else math.pi)
        if slider.angle is not None:
            return line + linkage.numbers(slider.angle) * linkage.angle.radians
        points = linkage.links[slider.link]
        if len(points) < 2:
            return line
        a, b = (linkage.sketched(p) for p in slider.line)
        own_direction = linkage.sketched(points[1]) - linkage.sketched(points[0])
        return line + cmath.phase(own_direction * (b - a).conjugate())

    def angle_of(self, body: str) -> LinkAngle:
        """The body's angle: its group's variable plus a constant; ground stands at zero."""
        root, offset = self._find(body)
        if root == self._ground:
            return LinkAngle(variable=None, constant=_tidy(offset - self._find(GROUND)[1]))
        name = self._name[root]
        return LinkAngle(variable=name, constant=_tidy(offset - self._find(name)[1]))

    def sketched_angle(self, root: str, body: str) -> float:
        """The direction of a link in the sketch [rad]."""
        first, second = self.linkage.links[body][:2]
        return cmath.phase(self.linkage.sketched(second) - self.linkage.sketched(first))


def _tidy(angle: float) -> float:
    """Into (-π, π], with rounding next to a multiple of a right angle removed."""
    reduced = math.remainder(angle, 2 * math.pi)
    quarter = round(reduced / (math.pi / 2))
    if abs(reduced - quarter * math.pi / 2) < 1e-15:
        return quarter * math.pi / 2
    return reduced
