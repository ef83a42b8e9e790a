"""Bodies, groups of bodies with equal rotation, and coordinates of points in the frame of each
body.

Links that slide on each other without rotation share one angle variable. A point's position in a
body is a sum of terms: a fixed vector, and for slots and sliders a variable length along their
line.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from linkwork.core.equations.model import (
    LawEquation,
    LinearEquation,
    LinkAngle,
    LoopEquation,
    MeasuredInPart,
    Redundant,
    Term,
)
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Name, Node
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.lanes import (
    cis,
    copysign,
    degrees,
    estimated,
    is_structurally_nonzero,
    largest,
    phase as phase_of,
    remainder,
    snap,
    uniform_value,
)
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.precise import PI, Precise, chosen, joined, phase, precise, sin_cos
from linkwork.core.mechanism.description import Key, Problems
from linkwork.core.mechanism.linkage import Linkage

_SQUARE = 1.3e-16  # [rad] between the floats π and π/2 and the right angles they are


@dataclass(frozen=True)
class Place:
    """A point's position in a body: a fixed vector from the body's origin, and sliding terms."""

    fixed: complex
    sliding: tuple[Term, ...] = ()
    base: str = ""  # the point at the tip of the fixed vector, for naming
    rest: complex = 0j  # what ``fixed`` loses where it is rounded

    @property
    def tip(self) -> Precise:
        """The fixed vector."""
        return Precise(self.fixed, self.rest)


@dataclass
class Frames:
    """All bodies of a linkage with the positions of their points.

    ``bodies`` in the file's order, ground first. ``angle[body]`` is its variable and constant,
    ``constant[body]`` the constant before it is rounded. ``places[body][point]``. ``symbols``
    collects the named lengths in use. ``start`` are the variables in the sketch as estimates,
    ``sketched`` the same before they are rounded, with their formulas.
    """

    linkage: Linkage
    bodies: list[str] = field(default_factory=list)
    angle: dict[str, LinkAngle] = field(default_factory=dict)
    places: dict[str, dict[str, Place]] = field(default_factory=dict)
    lengths: list[str] = field(default_factory=list)
    start: dict[str, float] = field(default_factory=dict)
    symbols: dict[str, float] = field(default_factory=dict)
    released: list[Redundant] = field(default_factory=list)
    measured: list[MeasuredInPart] = field(default_factory=list)
    constant: dict[str, Precise] = field(default_factory=dict)
    sketched: dict[str, Callable[[], Precise]] = field(default_factory=dict)

    @classmethod
    def of(cls, linkage: Linkage, problems: Problems) -> Frames:
        """Bodies, shared angles and positions; contradictions are added to ``problems``."""
        frames = cls(linkage)
        frames.bodies = [GROUND, *[b for b in linkage.links if b != GROUND]]
        groups = _Orientation(linkage, problems)
        for _, part in linkage.keyed_parts:
            if (angle := part.measured_angle(linkage)) is not None:
                frames.measured.append(MeasuredInPart(part.label, "angle", angle.high, "angle"))
        for body in frames.bodies:
            variable, frames.constant[body] = groups.angle_of(body)
            frames.angle[body] = LinkAngle(variable=variable, constant=frames.constant[body].high)
        for name, drawn in groups.drawn(frames.angle).items():
            if drawn == [name]:
                frames.start[name] = linkage.sketched_angle(name, of_start=True)
                frames.sketched[name] = partial(linkage.exact_angle, name)
                continue
            spans = (
                linkage.sketched_span(b, of_start=True) * cis(-estimated(frames.angle[b].constant))
                for b in drawn
            )
            frames.start[name] = phase_of(sum(spans))
            frames.sketched[name] = partial(frames._sketched_angle, drawn)
        for body in frames.bodies:
            local, rest = linkage.shapes.local[body], linkage.shapes.rest[body]
            frames.places[body] = {p: Place(z, base=p, rest=rest[p]) for p, z in local.items()}
        return frames

    def add_guide(
        self,
        guide: tuple[str, str, tuple[str, str]],
        point: str,
        offset: Precise | None = None,
        symbol: str = "",
    ) -> None:
        """Add the position of a guided point in the body with the line.

        ``guide``: the displacement's name, the body, two points of its line.
        """
        linkage, (own, body, line) = self.linkage, guide
        along = linkage.shapes.direction(body, line)
        terms = [self.vector_term(along, None, body, own)]
        if offset is not None and is_structurally_nonzero(offset.high):
            name = canonical(symbol)
            self.symbols[name] = abs(offset.high)
            # the term keeps a positive length, so that formulas show it without a sign
            sideways = along * (1j * copysign(1.0, offset.high))
            terms.append(self.vector_term(sideways * abs(offset), Name(name, name), body))
        origin = self.places[body][line[0]]
        self.places[body][point] = Place(origin.fixed, tuple(terms), line[0], origin.rest)
        self.lengths.append(own)
        a, b, p = (linkage.precisely_sketched(q) for q in (*line, point))
        place = ((p - a) * (b - a).conjugate()).real / abs(b - a)
        self.start[own], self.sketched[own] = place.high, lambda: place

    def add_rod(
        self, name: str, between: tuple[str, str], length: Precise | None = None, angle: str = ""
    ) -> None:
        """Add a body between two points, of a given length or a variable length with its name."""
        a, b = between
        turning = angle or name
        self.bodies.append(name)
        self.angle[name], self.constant[name] = (
            LinkAngle(variable=turning, constant=0.0),
            Precise(0.0),
        )
        span = self.linkage.precisely_sketched(b) - self.linkage.precisely_sketched(a)
        self.start[turning], self.sketched[turning] = phase_of(span.high), lambda: phase(span)
        if length is None:
            rod = self.vector_term(1.0 + 0j, None, name, name)
            self.lengths.append(name)
            self.start[name], self.sketched[name] = abs(span.high), lambda: abs(span)
        else:
            symbol = canonical(f"{name}_rod")
            self.symbols[symbol] = length.high
            rod = self.vector_term(length + 0j, Name(symbol, symbol), name)
        self.places[name] = {a: Place(0j, base=a), b: Place(0j, (rod,), base=a)}

    def release(self, link: str, a: str, b: str) -> None:
        """Make the distance between two points of a link an unknown."""
        name = f"{link}_length"
        first = self.places[link][a]
        span = self.places[link][b].tip - first.tip
        along = self.vector_term(span / abs(span), None, link, name)
        self.places[link][b] = Place(first.fixed, (along,), a, first.rest)
        length = self.start[name] = abs(span).high
        self.released.append(Redundant(variable=name, link=link, points=(a, b), length=length))

    def _sketched_angle(self, drawn: Iterable[str]) -> Precise:
        """The angle that fits some links of a group in the sketch [rad]."""
        total = Precise(0j)
        for body in drawn:
            sine, cosine = sin_cos(self.constant[body])
            total = total + self.linkage.exact_span(body) * joined(cosine, -sine)
        return phase(total)

    def now(self, angle: LinkAngle) -> float:
        """The variable part of an angle in the sketch [rad]."""
        return 0.0 if angle.variable is None else self.start[angle.variable]

    def angles_of(self, bodies: Iterable[tuple[str, float]]) -> tuple[dict[str, float], Precise]:
        """Σ weight · angle of body as weights of variables by name, and a constant [rad]."""
        weights: dict[str, float] = {}
        constant = Precise(0.0)
        for body, weight in bodies:
            angle = self.angle[body]
            constant = constant + self.constant[body] * weight
            if angle.variable is not None:
                weights[angle.variable] = weights.get(angle.variable, 0.0) + weight
        return {name: weight for name, weight in weights.items() if weight}, constant

    def sketched_sum(self, weights: Mapping[str, float]) -> Precise:
        """Σ weight · variable in the sketch."""
        total = Precise(0.0)
        for name, weight in weights.items():
            exact = self.sketched[name]()
            # half a turn may be rounded to the other one
            turns = round((self.start[name] - estimated(exact.high)) / math.tau)
            total = total + (exact + PI * (2.0 * turns)) * weight
        return total

    def vector_term(
        self, z: complex | Precise, shown: Node | None, body: str, length: str | None = None
    ) -> Term:
        """A vector of the body's frame as a term: its coefficient is rounded once."""
        angle = self.angle[body]
        turning = ((canonical(angle.variable), 1.0),) if angle.variable is not None else ()
        symbol = None if length is None else canonical(length)
        vector = precise(z)
        if is_structurally_nonzero(angle.constant):
            sine, cosine = sin_cos(self.constant[body])
            vector = vector * joined(cosine, sine)
        return Term.vector(vector.high, shown, symbol, turning)

    def between(self, body: str, start: str, end: str) -> list[Term]:
        """The vector from one point to another across a body, as terms."""
        a, b = self.places[body][start], self.places[body][end]
        terms = []
        if a.base != b.base:
            shown = self._distance(body, a.base, b.base)
            terms.append(self.vector_term(b.tip - a.tip, shown, body))
        terms += [term.negated() for term in a.sliding]
        terms += list(b.sliding)
        return terms

    def _distance(self, body: str, a: str, b: str) -> Node:
        """The name of the distance between two points in formulas."""
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
    """Groups of links with constant relative orientation, joined by slides and welds."""

    def __init__(self, linkage: Linkage, problems: Problems) -> None:
        self.linkage = linkage
        none = Precise(0.0)
        self._parent: dict[str, tuple[str, Precise]] = {b: (b, none) for b in linkage.links}
        for key, part in linkage.keyed_parts:
            kept = part.kept_angle(linkage)
            gap = 0.0 if kept is None else self._join(*kept)
            if kept is not None and gap:
                problems.add(
                    key,
                    f'"{kept[0]}" cannot keep its angle relative to "{kept[1]}": '
                    f"other {part.holders} change it by {degrees(gap):.6g}°",
                )
        driven = self._driven = {w.link for w in linkage.inputs if w.link}
        self._name: dict[str, str] = {}
        for body in linkage.links:
            root = self.root(body)
            named = self._name.get(root)
            if body == GROUND or not self._turns(body):
                continue
            # the input must be a separate variable
            if named is None or (body in driven and named not in driven):
                self._name[root] = body
        self._ground = self.root(GROUND)

    def _find(self, body: str) -> tuple[str, Precise]:
        """The group's root and θ_body - θ_root."""
        total = Precise(0.0)
        while self._parent[body][0] != body:
            body, offset = self._parent[body]
            total += offset
        return body, total

    def root(self, body: str) -> str:
        """The group of a body."""
        return self._find(body)[0]

    def _turns(self, body: str) -> bool:
        """Whether a link has a direction or is a wheel."""
        several = len(self.linkage.links[body]) > 1
        return several or body in self.linkage.turning_on_one_point

    def _join(self, link: str, on: str, constant: Precise) -> float:
        """Set θ_link = θ_on + constant; returns the contradiction to known angles [rad]."""
        a, offset_a = self._find(link)
        b, offset_b = self._find(on)
        if a == b:
            gap = remainder((offset_a - offset_b - constant).high, 2 * math.pi)
            return gap if abs(gap) > 1e-9 else 0.0
        # θ_a = θ_link - offset_a and θ_b = θ_on - offset_b
        self._parent[a] = (b, constant + offset_b - offset_a)
        return 0.0

    def drawn(self, angles: Mapping[str, LinkAngle]) -> dict[str, list[str]]:
        """The links whose sketch gives the variables of all groups, by name.

        That of a driven link is its direction, every other one fits the links of its group best:
        those that are drawn between most joints with other groups, at most two, since a flag that
        is welded on may be drawn anywhere. Wheels of one point only count without other links.
        """
        found: dict[str, list[str]] = {}
        carriers = self.linkage.carriers()
        groups: dict[str, list[str]] = {}
        for body, angle in angles.items():
            if angle.variable is not None:
                groups.setdefault(angle.variable, []).append(body)
        for name, members in groups.items():
            joints: dict[int, list[str]] = {}
            for body in members if len(members) > 1 else ():
                points = self.linkage.links[body]
                joined = [p for p in points if not {*members}.issuperset(carriers[p])]
                joints.setdefault(min(len(joined), 2) if len(points) > 1 else -1, []).append(body)
            drawn = joints[max(joints)] if joints else members
            found[name] = [name] if name in drawn and name in self._driven else drawn
        return found

    def angle_of(self, body: str) -> tuple[str | None, Precise]:
        """The body's angle: its group's variable plus a constant; zero for ground."""
        root, offset = self._find(body)
        if root == self._ground:
            return None, _tidy(offset - self._find(GROUND)[1])
        name = self._name[root]
        return name, _tidy(offset - self._find(name)[1])


def _tidy(angle: Precise) -> Precise:
    """The angle in (-π, π], rounded to a multiple of a right angle if very near."""
    if not angle.has_rest:
        reduced = remainder(angle.high, 2 * math.pi)
        square = round(reduced / (math.pi / 2)) * math.pi / 2
        # a right angle with rounding error would leave a tiny term in every equation
        return Precise(snap(abs(reduced - square) < 1e-15, square, reduced))
    turns = round(angle.high / (2 * math.pi))
    reduced = angle - PI * (2.0 * turns)
    square = PI * (0.5 * round(reduced.high / (math.pi / 2)))
    return chosen(abs((reduced - square).high) < _SQUARE, square, reduced)


# ----------------------------------------------------------------------
# The rows that parts add to the equations of a linkage.


@dataclass
class PartRows:
    """Collects the rows of parts; their positions and rods are added to the frames.

    ``variables`` are unknowns other than body angles and slide lengths, (name, kind);
    ``outlines`` are for pictures: name → (body, centre, points about it in the body's frame).
    """

    frames: Frames
    problems: Problems
    loops: list[LoopEquation] = field(default_factory=list)
    linear: list[LinearEquation] = field(default_factory=list)
    laws: list[LawEquation] = field(default_factory=list)
    variables: list[tuple[str, str]] = field(default_factory=list)
    outlines: dict[str, tuple[str, str, ComplexArray]] = field(default_factory=dict)
    measured: list[MeasuredInPart] = field(default_factory=list)

    def held(self, link: str, frame: str, key: Key) -> None:
        """Report a fixed angle."""
        self.problems.add(
            key, f'"{link}" cannot turn relative to "{frame}": a slider or a weld holds its angle'
        )

    def put(self, body: str, point: str, place: Place, key: Key) -> None:
        """Add the position of a point in a body that does not guide it yet."""
        if point in self.frames.places[body]:
            self.problems.add(key, f'point "{point}" is already guided by "{body}"')
            return
        self.frames.places[body][point] = place

    def sketched_in(self, body: str, origin: str, point: str) -> complex:
        """The sketched position of a point in a body's frame, relative to a point of the body."""
        frames = self.frames
        turned = frames.angle[body].constant + frames.now(frames.angle[body])
        linkage = frames.linkage
        return (linkage.sketched(point) - linkage.sketched(origin)) * cmath.exp(-1j * turned)

    def unknown(self, name: str, kind: str, start: float) -> str:
        """Add an unknown; returns its symbol."""
        self.variables.append((name, kind))
        self.frames.start[name] = start
        return canonical(name)

    def tie(
        self,
        label: str,
        turns: list[tuple[str, float]],
        lengths: Sequence[tuple[str, float]] = (),
        total: Precise | None = None,
        measured: tuple[str, float] = ("", 1.0),
    ) -> None:
        """Add Σ weight · angle of body (+ Σ weight · length) = total, by default as sketched.

        ``measured``: the name of what the sketch then gives, and its weight in the total.
        """
        frames = self.frames
        weights, constant = frames.angles_of(
            (body, uniform_value(weight)) for body, weight in turns
        )
        weights |= dict(lengths)
        # by default the total of the sketch: gears can mesh at any tooth
        kind = "length" if lengths else "angle"
        if total is None:
            quantity, weight = measured
            value = frames.sketched_sum(weights) + constant
            self.measured.append(MeasuredInPart(label, quantity, value.high / weight, kind))
        rounded = (-frames.sketched_sum(weights) if total is None else constant - total).high
        self.linear.append(
            LinearEquation(
                label=label,
                terms=tuple((canonical(name), weight) for name, weight in weights.items()),
                constant=rounded,
                kind=kind,
            )
        )

    def side(self, body: str, line: tuple[str, str], point: str, key: Key) -> float:
        """The side of a body's line on which a point is sketched: 1 for left, -1 for right."""
        linkage = self.frames.linkage
        a, b, p = (linkage.sketched(q) for q in (*line, point))
        away = ((p - a) * (b - a).conjugate()).imag / abs(b - a)
        if abs(away) <= 1e-9 * largest((abs(b - a), abs(p - a))):
            self.problems.add(
                key,
                f"{point} lies on the line {' '.join(line)} of {body}: sketch it on the side on "
                "which it is",
            )
            return 1.0
        return copysign(1.0, away)
