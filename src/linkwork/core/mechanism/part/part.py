"""Joints of a kinematic chain: their links and kinds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import ClassVar, Self

from linkwork.core.foundation.errors import choices, undefined
from linkwork.core.foundation.lanes import vector
from linkwork.core.foundation.names import free_name
from linkwork.core.foundation.precise import Precise
from linkwork.core.foundation.values import (
    Key as FileKey,
    ListOf,
    NumberValue as NumberKey,
    Text,
    check_values,
)
from linkwork.core.mechanism.bodies import Bodies, DiscFigure, Figure, Outline, Outlines
from linkwork.core.mechanism.description import Key, Problems
from linkwork.core.mechanism.dimensions import LARGEST, Number


@dataclass(frozen=True)
class JointKind:
    """A kind of joint: its letter, number of freedoms and name."""

    letter: str
    freedom: int
    noun: str

    REVOLUTE: ClassVar[JointKind]
    PRISMATIC: ClassVar[JointKind]
    PIN_IN_SLOT: ClassVar[JointKind]

    @property
    def lower(self) -> bool:
        """Whether it is a lower pair: surface contact and one freedom."""
        return self in (JointKind.REVOLUTE, JointKind.PRISMATIC)


JointKind.REVOLUTE = JointKind("R", 1, "revolute joint")
JointKind.PRISMATIC = JointKind("P", 1, "prismatic joint")
JointKind.PIN_IN_SLOT = JointKind("RP", 2, "pin in slot")


@dataclass(frozen=True, kw_only=True)
class Joint:
    """A joint of two links, or a multiple pin.

    Parameters
    ----------
    name : str
        The point of a pin; otherwise the name of slider, slot or cylinder.
    links : tuple of str
        Two links, or k > 2 for a multiple pin, which counts as k - 1 joints.
    point : str
        For a pin in a slot: the point of the pin.
    """

    kind: JointKind
    name: str
    links: tuple[str, ...]
    point: str = ""

    @property
    def count(self) -> int:
        """Its number of simple joints."""
        return len(self.links) - 1

    def across(self, link: str) -> Iterator[str]:
        """The other links of the joint."""
        return (other for other in self.links if other != link)


# ----------------------------------------------------------------------
# The kinematic pairs of a part: pins, slides, rigid joints, and fixed ratios of turns.


class PairKind(Enum):
    """How two bodies are joined; the value is the order in which a tree takes the pairs."""

    FIXED = 0
    SLIDE = 1
    PIN = 2


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A pair of two bodies.

    ``point`` is its place; a slide is along ``line`` of the first body, and its displacement is
    the variable ``name``.
    """

    kind: PairKind
    name: str
    bodies: tuple[str, str]
    point: str
    line: tuple[str, str] | None = None


@dataclass(frozen=True, kw_only=True)
class Coupling:
    """A sum of multiples of the angles of bodies and of displacements that is constant."""

    name: str
    turns: tuple[tuple[str, float], ...]
    slides: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, kw_only=True)
class AddedBody:
    """A body of the part that is no link.

    ``angle`` is the variable that is its angle, or it turns with the body ``on`` which it slides;
    ``pinned``: whether links that have its points are pinned to it there.
    """

    name: str
    points: tuple[str, ...]
    angle: str = ""
    on: str = ""
    pinned: bool = False


@dataclass(frozen=True, kw_only=True)
class KinematicPairs:
    """The bodies that a part adds, its pairs, and its couplings."""

    bodies: tuple[AddedBody, ...] = ()
    pairs: tuple[Pair, ...] = ()
    couplings: tuple[Coupling, ...] = ()

    def with_pin(self, link: str) -> KinematicPairs:
        """A copy in which a link is pinned to the body that the part adds."""
        (body,) = self.bodies
        (point,) = body.points
        pin = Pair(kind=PairKind.PIN, name=point, bodies=(body.name, link), point=point)
        return replace(self, pairs=(*self.pairs, pin))


def sliding_block(name: str, on: str, line: tuple[str, str], point: str) -> KinematicPairs:
    """A block at a point that slides along a line of a body."""
    block = AddedBody(name=f"{name} block", points=(point,), on=on)
    ends = (on, block.name)
    slide = Pair(kind=PairKind.SLIDE, name=name, bodies=ends, point=point, line=line)
    return KinematicPairs(bodies=(block,), pairs=(slide,))


def meshing(
    name: str, wheels: tuple[str, str], arm: str, radii: tuple[float, float], *, outside: bool
) -> Coupling:
    """The coupling of two wheels on an arm: r1 (θ1 - θarm) ± r2 (θ2 - θarm) is constant."""
    first, second = radii[0], radii[1] if outside else -radii[1]
    turns = ((wheels[0], first), (wheels[1], second), (arm, -first - second))
    return Coupling(name=name, turns=turns)


# ----------------------------------------------------------------------
# The base class of parts: file keys, checks, mobility, inversion and figures.


#: Relative tolerance of redundant numbers.
AGREE = 1e-9
_MOST_TIMES = 1e6  # the size of a wheel, of that of the other
_MOST_UNEVEN = 1e6  # distances of neighbouring points of a curve, from the smallest to the largest

POINT, LINK, SLIDER = Text(of="point"), Text(of="link"), Text(of="slider")
POINT_PAIR = ListOf(Text(), "point", 2, 2)
NUMBER_PAIR = ListOf(NumberKey(), "number", 2, 2)


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of a mechanism other than points and links.

    ``title`` and ``doc`` describe its kind on the page and in the schema, ``keys`` are those of its
    table, ``kind`` is the kind of joint, if the part is a joint of two links. ``lets_go``: how it
    may cease to be one, by a pull where it can only push, or beyond its friction.
    """

    title: ClassVar[str]
    doc: ClassVar[str]
    keys: ClassVar[tuple[FileKey, ...]]
    kind: ClassVar[JointKind | None] = None
    lets_go: ClassVar[tuple[str, ...]] = ()
    holders: ClassVar[str] = "joints"  # parts that may contradict an angle it fixes

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def label(self) -> str:
        """The name of the part in lists."""
        raise NotImplementedError

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the part and of its results."""
        return ()

    @property
    def acts(self) -> bool:
        """Whether it loads the mechanism by itself."""
        return False

    @property
    def drive(self) -> str:
        """The input key that drives the part: slider or cylinder."""
        return ""

    @property
    def pushes(self) -> tuple[str, ...]:
        """Names of sliders, slots and cylinders along which it exerts a force."""
        return ()

    @property
    def turning(self) -> tuple[str, ...]:
        """Links that may have one point only: wheels and cams."""
        return ()

    @property
    def friction_sizes(self) -> tuple[str, ...] | None:
        """What its friction depends on apart from the coefficient: ``radius``, which is required,
        or ``length``; ``None`` without friction.
        """
        return None

    @property
    def body(self) -> tuple[str, ...]:
        """The points of the part, if it is a body."""
        return ()

    @property
    def ends(self) -> tuple[str, ...]:
        """The two sliding links of such a body at these points."""
        return ()

    @property
    def mobility(self) -> int:
        """Its contribution to Grübler's count: f - 3 for a joint of f freedoms, 3 for a link."""
        # a joint of f freedoms removes 3 - f
        joint = 0 if self.kind is None else self.kind.freedom - 3
        return joint + 3 * len(self.ends)

    def joint(self, linkage: Bodies) -> Joint | None:
        """The joint of the chain."""
        if self.kind is None:
            return None
        return Joint(kind=self.kind, name=self.label, links=self.joined(linkage))

    def pairs(self, linkage: Bodies) -> KinematicPairs | None:
        """The kinematic pairs of which it consists; ``None`` if curves roll or slide in it."""
        return KinematicPairs()

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        """The links of the joint."""
        return ()

    def kept_angle(self, linkage: Bodies) -> tuple[str, str, Precise] | None:
        """Two links whose relative angle is fixed, and this angle [rad]."""
        return None

    def measured_angle(self, linkage: Bodies) -> Precise | None:
        """Its fixed angle, if not given but measured in the sketch [rad]."""
        return None

    @property
    def guided(self) -> tuple[str, str, str] | None:
        """The key of the guided point, the point, and the link with the line."""
        return None

    def check(self, checks: PartChecks) -> None:
        """Report problems that do not depend on link shapes."""

    def check_shapes(self, checks: PartChecks) -> None:
        """Report conflicts with the link shapes."""

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        """The figures of the part."""
        return iter(())

    def sketched_outlines(self, linkage: Bodies) -> Iterator[tuple[str, Outline]]:
        """Outlines by name before the equations are solved."""
        return iter(())

    def size_of(self, link: str, linkage: Bodies) -> float | None:
        """The radius of a link given by this part."""
        discs = (f for f in self.figures(linkage, {}) if isinstance(f, DiscFigure))
        return next((disc.radius for disc in discs if disc.link == link), None)

    def inverted(self, inversion: Inversion) -> Self:
        """The part after inversion to another ground."""
        return self._renamed("link", inversion.name)

    def find_spelling(self, same: Callable[[str], str]) -> Self:
        """A copy with all names spelled as declared."""
        return self._renamed("", same)

    def _renamed(self, of: str, rename: Callable[[str], str]) -> Self:
        """A copy with new names of links, or of all names used."""
        changed: dict[str, object] = {}
        for key in self.keys:
            entry = getattr(self, key.attribute)
            match key.kind:
                case Text(of=named) if named and (not of or named == of) and entry is not None:
                    changed[key.attribute] = rename(entry)
                case ListOf(Text(), noun) if (not of or noun == of) and entry is not None:
                    changed[key.attribute] = tuple(map(rename, entry))
        return replace(self, **changed)


@dataclass(frozen=True, kw_only=True)
class NamedPart(Part):
    """A part with a name."""

    name: str

    @property
    def label(self) -> str:
        return self.name

    @property
    def names(self) -> tuple[str, ...]:
        return (self.name,)


def carriers(linkage: Bodies) -> dict[str, list[str]]:
    """The links and cylinders at every point, in the file's order."""
    found: dict[str, list[str]] = {point: [] for point in linkage.points}
    for link, points in linkage.links.items():
        for point in points:
            found.setdefault(point, []).append(link)  # a draft may name points that it lacks
    for part in linkage.of(Part):
        for point in part.body:
            found.setdefault(point, []).append(part.label)
    return found


def pinned(linkage: Bodies, point: str) -> str:
    """The first link or cylinder end at a point."""
    for link in linkage.bodies_at(point):
        return link
    ends = (dict(zip(part.body, part.ends, strict=True)) for part in linkage.of(Part))
    return next(own[point] for own in ends if point in own)


def turning_links(linkage: Bodies) -> frozenset[str]:
    """Links that may have one point only: wheels and cams."""
    return frozenset(link for part in linkage.of(Part) for link in part.turning)


@dataclass(kw_only=True)
class Inversion:
    """The state of an inversion.

    ``link`` becomes ground and the old ground the link ``frame``, whose angle is measured from the
    direction ``turn`` [rad] of the old one. ``seen`` are points in the new ground's coordinates,
    ``fixed`` its points, ``taken`` the names in use.
    """

    linkage: Bodies
    link: str
    frame: str
    ground: str
    turn: float
    seen: dict[str, complex]
    fixed: list[str]
    taken: set[str]

    def name(self, link: str) -> str:
        """The new name of a link."""
        return {self.ground: self.frame, self.link: self.ground}.get(link, link)

    def shifted(self, number: Number, turn: float) -> Number:
        """A number or formula plus an angle [rad]."""
        more = self.linkage.angle.from_radians(turn)
        return f"({number}) + ({more!r})" if isinstance(number, str) else number + more

    def free_name(self, name: str) -> str:
        """Reserve an unused name."""
        return free_name(name, self.taken)


class PartChecks:
    """Checks of one part; problems are added to the linkage under the part's key.

    Fields are relative to that key.
    """

    def __init__(self, linkage: Bodies, problems: Problems, key: Key) -> None:
        self.linkage, self.problems, self.key = linkage, problems, key

    def add(self, message: str, *field: str | int) -> None:
        """Add a problem of a field, or of the whole part."""
        self.problems.add((*self.key, *field), message)

    def defined(self, point: str, *field: str | int) -> bool:
        """Whether the point exists; reported if not."""
        if point not in self.linkage.points:
            self.add(undefined("point", point, self.linkage.points), *field)
        return point in self.linkage.points

    def link(self, link: str, *field: str | int) -> bool:
        """Whether the link exists; reported if not."""
        if link not in self.linkage.links:
            self.add(undefined("link", link, self.linkage.links), *field)
        return link in self.linkage.links

    def on(self, point: str, link: str, *field: str | int) -> None:
        """Check that the point is on the link."""
        if self.defined(point, *field) and point not in self.linkage.links[link]:
            known = choices("points", self.linkage.links[link])
            self.add(f'point "{point}" is not on link "{link}" {known}', *field)

    def two(self, names: Sequence[str], noun: str, *field: str | int) -> bool:
        """Check for two different names."""
        if len(names) != 2:
            self.add(f"needs two {noun}s, got {len(names)}", *field)
            return False
        if names[0] == names[1]:
            self.add(f"needs two different {noun}s, got {names[0]} twice", *field)
            return False
        return True

    def line(self, on: str, line: Sequence[str]) -> None:
        """Check a link and two of its points."""
        if self.link(on, "on") and self.two(line, "point", "line"):
            for point in line:
                self.on(point, on, "line")

    def ends(self, between: Sequence[str]) -> None:
        """Check the two points of a cylinder or spring."""
        self.two(between, "point", "between")
        for point in between:
            self.defined(point, "between")

    def number(self, number: Number, *field: str | int) -> float:
        """The number, or NaN after reporting a problem."""
        key = (*self.key, *field)
        return self.linkage.numbers.check_number(self.problems.add, key, number)

    def amount(self, number: Number, *field: str | int) -> float:
        """A number that is limited so that products with it are finite."""
        key = (*self.key, *field)
        return self.linkage.numbers.check_amount(self.problems.add, key, number)

    def positive(self, number: Number, noun: str, *field: str | int) -> float:
        """A positive number, limited so that products with it are finite."""
        amount = self.amount(number, *field)
        if amount <= 0:
            what = "positive" if noun == "radii" else f"a positive {noun}"
            what = "positive whole numbers" if noun == "teeth" else what
            self.add(f"must be {what}, got {amount:g}", *field)
        return amount

    def comparable(self, first: float, second: float, field: str, what: str = "") -> None:
        """Two positive sizes whose ratio leaves room for rounding."""
        if first > _MOST_TIMES * second or second > _MOST_TIMES * first:
            self.add(f"{what}differ by a factor of more than {_MOST_TIMES:,.0f}", field)

    def outline(self, points: Sequence[Sequence[Number]], field: str, *, closed: bool) -> None:
        """Check for enough distinct consecutive points."""
        least = 4 if closed else 3
        if len(points) < least:
            self.add(f"needs at least {least} points, got {len(points)}", field)
            return
        places = []
        for k, pair in enumerate(points):
            if len(pair) != 2:
                self.add(f"needs two coordinates, got {len(pair)}", field, k)
                return
            x, y = (self.number(number, field, k) for number in pair)
            places.append(vector(x, y))
        if closed and places[0] == places[-1]:
            self.add("is closed automatically: leave out the repeated last point", field)
        gaps = (b - a for a, b in itertools.pairwise(places))
        steps = [math.hypot(gap.real, gap.imag) for gap in gaps]
        least_step = min((step for step in steps if step > 0.0), default=math.inf)
        for k, step in enumerate(steps, start=1):
            if step == 0.0:
                self.add("is the same point as the one before", field, k)
            elif not step <= _MOST_UNEVEN * least_step:
                times = f"{_MOST_UNEVEN:,.0f} times as far from the point before as the nearest two"
                self.add(f"is more than {times} points are from each other", field, k)
        if all(step <= _MOST_UNEVEN * least_step for step in steps):
            for k, place in enumerate(places):
                if max(abs(place.real), abs(place.imag)) > LARGEST:
                    self.add(f"is too far from the origin: at most {LARGEST:g}", field, k)
