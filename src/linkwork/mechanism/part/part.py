"""A part that joins links: what its file keys, checks, counts, inversion and figures are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from linkwork.foundation.elementwise import vector
from linkwork.foundation.errors import choices
from linkwork.foundation.file_keys import Key as FileKey, ListOf, Number as NumberKey, Text
from linkwork.foundation.names import free_name
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.description import Key, Problems
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Disc, Figure, Outlines
from linkwork.mechanism.joint import Joint, JointKind

__all__ = [
    "AGREE", "LINK", "NUMBER_PAIR", "POINT", "POINT_PAIR", "SLIDER",
    "Inversion", "NamedPart", "Part", "PartChecks", "carriers", "pinned", "turning_links",
]  # fmt: skip

#: Relative: numbers that are given twice must agree to this.
AGREE = 1e-9
_LARGEST = 1e100  # so that squares and quotients of lengths stay numbers

POINT, LINK, SLIDER = Text(of="point"), Text(of="link"), Text(of="slider")
POINT_PAIR = ListOf(Text(), "point", 2, 2)
NUMBER_PAIR = ListOf(NumberKey(), "number", 2, 2)


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of a mechanism besides points and links.

    ``title`` and ``doc`` name its kind on the page and in the file's schema, ``keys`` are those of
    its table, ``kind`` is the joint of two links that it is, if it is one.
    """

    title: ClassVar[str]
    doc: ClassVar[str]
    keys: ClassVar[tuple[FileKey, ...]]
    kind: ClassVar[JointKind | None] = None
    holders: ClassVar[str] = "joints"  # what may contradict an angle that it keeps

    def __post_init__(self) -> None:
        """Turn lists into tuples, so that parts compare and cannot change."""
        for field, entry in vars(self).items():
            # the class is frozen: only this way may it set its own fields
            object.__setattr__(self, field, _frozen(entry))

    @classmethod
    def of_table(cls, table: Mapping[str, Any]) -> Self:
        """The part that a table of a file describes."""
        return cls(**table)

    @property
    def label(self) -> str:
        """What the part is called in lists."""
        raise NotImplementedError

    @property
    def names(self) -> tuple[str, ...]:
        """The name of the part and those of what it adds to results."""
        return ()

    @property
    def drive(self) -> str:
        """The key of an input that can drive the part: slider or cylinder."""
        return ""

    @property
    def turning(self) -> tuple[str, ...]:
        """Links that one point is enough for: wheels and cams, which have no direction to see."""
        return ()

    @property
    def body(self) -> tuple[str, ...]:
        """The points of a body that the part is itself."""
        return ()

    @property
    def ends(self) -> tuple[str, ...]:
        """The links of the chain at these points, where the body is two that slide."""
        return ()

    @property
    def mobility(self) -> int:
        """What the part adds to Grübler's count: f - 3 for a joint of f freedoms, 3 for a link."""
        # a joint of f freedoms takes 3 - f from the plane
        joint = 0 if self.kind is None else self.kind.freedom - 3
        return joint + 3 * len(self.ends)

    def joint(self, linkage: Bodies) -> Joint | None:
        """The joint that the part is in the chain."""
        if self.kind is None:
            return None
        return Joint(kind=self.kind, name=self.label, links=self.joined(linkage))

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        """The links that the joint joins."""
        return ()

    def kept_angle(self, linkage: Bodies) -> tuple[str, str, float] | None:
        """A link that keeps its angle against another one, that one, and the angle [rad]."""
        return None

    @property
    def guided(self) -> tuple[str, str, str] | None:
        """The key of a point that the part leads along a line, the point, and the line's link."""
        return None

    def check(self, checks: PartChecks) -> None:
        """Report what is wrong without looking at the links' shapes."""

    def check_shapes(self, checks: PartChecks) -> None:
        """Report what does not fit the links' shapes."""

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        """What the part looks like."""
        return iter(())

    def size_of(self, link: str, linkage: Bodies) -> float | None:
        """The radius that a link has by this part."""
        discs = (f for f in self.figures(linkage, {}) if isinstance(f, Disc))
        return next((disc.radius for disc in discs if disc.link == link), None)

    def inverted(self, inversion: Inversion) -> Self:
        """The same part where another link is the ground."""
        return self._renamed("link", inversion.name)

    def find_spelling(self, same: Callable[[str], str]) -> Self:
        """A copy in which every name has the spelling of its declaration."""
        return self._renamed("", same)

    def _renamed(self, of: str, rename: Callable[[str], str]) -> Self:
        """A copy with other names of links, or of all that it names."""
        changed: dict[str, object] = {}
        for key in self.keys:
            entry = getattr(self, key.name)
            match key.kind:
                case Text(of=named) if named and (not of or named == of) and entry is not None:
                    changed[key.name] = rename(entry)
                case ListOf(Text(), noun) if (not of or noun == of) and entry is not None:
                    changed[key.name] = tuple(map(rename, entry))
        return replace(self, **changed)


@dataclass(frozen=True, kw_only=True)
class NamedPart(Part):
    """A part with a name of its own."""

    name: str

    @property
    def label(self) -> str:
        return self.name

    @property
    def names(self) -> tuple[str, ...]:
        return (self.name,)


def _frozen(entry: object) -> object:
    return tuple(map(_frozen, entry)) if isinstance(entry, list | tuple) else entry


def carriers(linkage: Bodies) -> dict[str, list[str]]:
    """For every point the links and cylinders that carry it, in the file's order."""
    found: dict[str, list[str]] = {point: [] for point in linkage.points}
    for link, points in linkage.links.items():
        for point in points:
            found[point].append(link)
    for part in linkage.of(Part):
        for point in part.body:
            found[point].append(part.label)
    return found


def pinned(linkage: Bodies, point: str) -> str:
    """The first link that carries a point, a cylinder by its end."""
    for link in linkage.bodies_at(point):
        return link
    ends = (dict(zip(part.body, part.ends, strict=True)) for part in linkage.of(Part))
    return next(own[point] for own in ends if point in own)


def turning_links(linkage: Bodies) -> frozenset[str]:
    """Links that one point is enough for: wheels and cams, which have no direction to see."""
    return frozenset(link for part in linkage.of(Part) for link in part.turning)


@dataclass(kw_only=True)
class Inversion:
    """The linkage that is inverted, and the new ground while it is written.

    ``link`` becomes ground and the old ground the link ``frame``, whose angle counts from the
    direction ``turn`` [rad] of the old one. ``seen`` are places in the new ground's coordinates,
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
        """What a link is called now."""
        return {self.ground: self.frame, self.link: self.ground}.get(link, link)

    def shifted(self, number: Number, turn: float) -> Number:
        """A number or formula and an angle [rad] more."""
        more = self.linkage.angle.from_radians(turn)
        return f"({number}) + ({more!r})" if isinstance(number, str) else number + more

    def free_name(self, name: str) -> str:
        """A name that nothing has yet, from now on taken."""
        return free_name(name, self.taken)


class PartChecks:
    """Checks of one part, adding to its linkage's problems under the part's key.

    Fields are given as they stand below that key.
    """

    def __init__(self, linkage: Bodies, problems: Problems, key: Key) -> None:
        self.linkage, self.problems, self.key = linkage, problems, key

    def add(self, message: str, *field: str | int) -> None:
        """Note a problem of a field, or of the whole part."""
        self.problems.add((*self.key, *field), message)

    def defined(self, point: str, *field: str | int) -> bool:
        """Whether there is such a point; reported if not."""
        if point not in self.linkage.points:
            known = choices("points", self.linkage.points, point)
            self.add(f'point "{point}" is not defined {known}', *field)
        return point in self.linkage.points

    def link(self, link: str, *field: str | int) -> bool:
        """Whether there is such a link; reported if not."""
        if link not in self.linkage.links:
            known = choices("links", self.linkage.links, link)
            self.add(f'link "{link}" is not defined {known}', *field)
        return link in self.linkage.links

    def on(self, point: str, link: str, *field: str | int) -> None:
        """The point has to be one of the link's."""
        if self.defined(point, *field) and point not in self.linkage.links[link]:
            known = choices("points", self.linkage.links[link])
            self.add(f'point "{point}" is not on link "{link}" {known}', *field)

    def two(self, names: Sequence[str], noun: str, *field: str | int) -> bool:
        """Two different names."""
        if len(names) != 2:
            self.add(f"needs two {noun}s, got {len(names)}", *field)
            return False
        if names[0] == names[1]:
            self.add(f"needs two different {noun}s, got {names[0]} twice", *field)
            return False
        return True

    def line(self, on: str, line: Sequence[str]) -> None:
        """A link and two points of it."""
        if not self.link(on, "on"):
            return
        if len(line) != 2:
            self.add(f"needs two points, got {len(line)}", "line")
            return
        for point in line:
            self.on(point, on, "line")
        if line[0] == line[1]:
            self.add(f"needs two different points, got {line[0]} twice", "line")

    def ends(self, between: Sequence[str]) -> None:
        """The two points of a cylinder or spring."""
        if len(between) != 2:
            self.add(f"needs two points, got {len(between)}", "between")
        elif between[0] == between[1]:
            self.add(f"needs two different points, got {between[0]} twice", "between")
        for point in between:
            self.defined(point, "between")

    def number(self, number: Number, *field: str | int) -> float:
        """The number, or NaN after reporting why there is none."""
        key = (*self.key, *field)
        return self.linkage.numbers.check_number(self.problems.add, key, number)

    def length(self, number: Number, *field: str | int) -> float:
        """A length or coordinate whose square is a number too."""
        amount = self.number(number, *field)
        if abs(amount) > _LARGEST:
            self.add(f"{amount:g} is too large: at most {_LARGEST:g} {self.linkage.length}", *field)
        return amount

    def positive(self, number: Number, noun: str, *field: str | int) -> float:
        """A positive number."""
        amount = self.number(number, *field)
        if amount <= 0:
            what = "positive" if noun == "radii" else f"a positive {noun}"
            what = "positive whole numbers" if noun == "teeth" else what
            self.add(f"must be {what}, got {amount:g}", *field)
        return amount

    def outline(self, points: Sequence[Sequence[Number]], field: str, *, closed: bool) -> None:
        """Enough different points in a row."""
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
        for k in range(1, len(places)):
            if places[k] == places[k - 1]:
                self.add("is the same point as the one before", field, k)
