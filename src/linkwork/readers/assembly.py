"""A file of another program: its text, numbers, refusals, and the list of omitted parts."""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import Any, NoReturn

from linkwork.core.expression.grammar import RESERVED, parse
from linkwork.core.expression.tree import Name
from linkwork.core.foundation.errors import (
    ExpressionError,
    InputError,
    MechanismError,
    MechanismFileError,
    Problem,
)
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND, canonical, free_name, is_name
from linkwork.core.mechanism.dimensions import LARGEST as LARGEST_NUMBER
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.part import KinematicPairs

#: Maximum size of a file, packed or unpacked [bytes].
LARGEST = 4_000_000
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_SHOWN = 60  # characters of a wrong word in a message


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """Something in a file of another program that was not carried over.

    Parameters
    ----------
    what : str
        The omitted part, and the reason.
    places : tuple of str
        Where it is in the file.

    Examples
    --------
    >>> import linkwork as lw
    >>> print(lw.readers.LeftOut(what="force", places=("line 3", "line 7", "line 9")))
    line 3 and 2 more: force
    """

    what: str
    places: tuple[str, ...]

    def __str__(self) -> str:
        more = len(self.places) - 1
        return f"{self.places[0]}{f' and {more} more' if more else ''}: {self.what}"


class Notes:
    """The parts that were omitted so far."""

    def __init__(self) -> None:
        self._places: dict[str, dict[str, None]] = {}

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What was left out, in the file's order."""
        return tuple(LeftOut(what=what, places=tuple(at)) for what, at in self._places.items())

    def leave_out(self, place: str, what: str) -> None:
        """Note a part that is not carried over."""
        self._places.setdefault(what, {})[place] = None


class Source(Notes):
    """The bytes of a file, its name for messages, and the parts omitted so far."""

    def __init__(self, data: bytes, name: str) -> None:
        super().__init__()
        self.data, self.name = data, name
        if len(data) > LARGEST:
            self.refuse(f"has more than {LARGEST / 1e6:.0f} MB: more is not read")

    def refuse(
        self, message: str, line: int | None = None, key: Sequence[str | int] = ()
    ) -> NoReturn:
        """Refuse the file.

        Raises
        ------
        MechanismFileError
            Always: with the reason and its place.
        """
        problem = Problem(key=tuple(key), message=message, line=line)
        raise MechanismFileError([problem], self.name)

    def text(self) -> str:
        """The file as text, without byte order mark."""
        try:
            text = self.data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = self.data.count(b"\n", 0, error.start) + 1
            self.refuse(f"byte {error.start} (0x{self.data[error.start]:02x}) is not UTF-8", line)
        if "\0" in text:
            self.refuse("contains a NUL character: not a text file")
        return text

    def number(self, entry: object, what: str, line: int | None = None) -> float:
        """A finite number that is a text or a number of JSON."""
        if isinstance(entry, str) and _NUMBER.fullmatch(entry.strip()):
            number = float(entry)
        elif isinstance(entry, int | float) and not isinstance(entry, bool):
            number = float(entry) if abs(entry) <= LARGEST_NUMBER else math.inf
        else:
            self.refuse(f"{what} must be a number, got {_shown(entry)}", line)
        if not abs(number) <= LARGEST_NUMBER:
            self.refuse(f"{what} is {_shown(entry)}: at most {LARGEST_NUMBER:g}", line)
        return number

    def point(self, x: object, y: object, what: str, line: int | None = None) -> complex:
        """Two finite numbers as x + iy."""
        return complex(self.number(x, what, line), self.number(y, what, line))

    def numbers(self, text: str, count: int, what: str, line: int | None = None) -> list[float]:
        """So many numbers between spaces."""
        words = text.split()
        if len(words) != count:
            self.refuse(f"{what} must be {count} numbers, got {len(words)}", line)
        return [self.number(word, what, line) for word in words]

    def chosen(self, word: str, known: Mapping[str, str], what: str) -> str:
        """The word that stands for an entry of a list, or its first word, with a note."""
        if word in known:
            return known[word]
        usual = next(iter(known.values()))
        self.leave_out(what, f"unknown {_shown(word)}, {usual} is assumed")
        return usual


def _shown(entry: object) -> str:
    text = entry if isinstance(entry, str) else type(entry).__name__
    return '"' + "".join(c if c.isprintable() else "?" for c in text[:_SHOWN]) + '"'


# ----------------------------------------------------------------------
# Points, links and joints of a foreign file, put together to a linkage.


_MOST = 400  # points, and links: linkages of more are no mechanisms drawn by a person
_LONGEST_NAME = 40
_KINDS = {"P": "point", "s": "slide"}


class Assembly:
    """A linkage that a reader builds: names are made valid and unique when they are added.

    ``points`` and ``links`` are those so far, ``fixed`` the points on ground. ``parts`` has one
    list for each table of parts, ``inputs`` are the driven quantities.
    """

    def __init__(self, source: Source, name: str = "") -> None:
        self.source = source
        self.name = " ".join(name.split())[:200]
        self.length = "mm"
        self.points: dict[str, complex] = {}
        self.links: dict[str, list[str]] = {}
        self.fixed: set[str] = set()
        self.lengths: dict[str, float] = {}
        self.angles: dict[str, float] = {}
        self.inputs: list[Input] = []
        self.trace: list[str] = []
        self.parts: dict[str, list[Any]] = {table: [] for table in PARTS}
        self.renamed: dict[str, str] = {}
        self._taken = {canonical(GROUND)}

    def new_name(self, like: str, kind: str) -> str:
        """A free name like the preferred one that formulas can use."""
        text = re.sub(r"\W", "_", like.strip()[:_LONGEST_NAME]).strip("_")
        # the nearest spelling first, so that a person recognizes the name
        tried = (like, text, f"{kind}{text}", f"{kind}_{text}", kind)
        name = free_name(next(filter(_is_usable, tried)), self._taken)
        if name != like and like:
            self.renamed[f'{_KINDS.get(kind, kind)} "{like[:_LONGEST_NAME]}"'] = name
        return name

    def add_point(self, like: str, place: complex, fixed: bool = False) -> str:
        """A point; returns its name."""
        if len(self.points) == _MOST:
            self.source.refuse(f"has more than {_MOST} points")
        name = self.new_name(like, "P")
        self.points[name] = place
        if fixed:
            self.fixed.add(name)
        return name

    def add_link(self, like: str, points: Iterable[str] = ()) -> str:
        """A link; returns its name."""
        if len(self.links) == _MOST:
            self.source.refuse(f"has more than {_MOST} links")
        name = self.new_name(like, "link")
        self.links[name] = list(dict.fromkeys(points))
        return name

    def put_on(self, link: str, point: str) -> None:
        """Put a point on a link or on ground."""
        if link == GROUND:
            self.fixed.add(point)
        elif point not in self.links[link]:
            self.links[link].append(point)

    def carries(self, link: str) -> set[str]:
        """The points of a link or of ground."""
        return self.fixed if link == GROUND else set(self.links[link])

    def carriers(self, *points: str) -> list[str]:
        """Ground and links that carry all of these points."""
        return [name for name in (GROUND, *self.links) if self.carries(name).issuperset(points)]

    def carrier(self, *points: str) -> str | None:
        """Ground, or the first link, that carries all of these points."""
        return next(iter(self.carriers(*points)), None)

    def drive(self, link: str, on: str, **fields: Any) -> None:
        """Drive the angle of a link relative to another one, or to ground."""
        relative = None if on == GROUND else on
        self.inputs.append(Input(link=link, relative_to=relative, **fields))

    def guide(
        self, on: str, point: str, along: complex, at: complex | None = None
    ) -> tuple[str, str]:
        """A line on a link, from a place in a direction: by default that of a point as drawn."""
        at = self.points[point] if at is None else at
        # any length would do: this one is visible in drawings
        size = max((abs(p - at) for p in self.points.values()), default=0.0) or 1.0
        first = self.add_point(f"{point}_from", at)
        second = self.add_point(f"{point}_to", at + along / abs(along) * size)
        for end in (first, second):
            self.put_on(on, end)
        return first, second

    def add_slot(self, like: str, point: str, on: str, line: tuple[str, str]) -> str:
        """A pin in a slot of a link; returns the name of the displacement."""
        return self.add_part("slots", like, "s", point=point, on=on, line=line)

    def add_slider(self, like: str, link: str, point: str, on: str, line: tuple[str, str]) -> str:
        """A link that slides without turning; returns the name of the displacement."""
        return self.add_part("sliders", like, "s", link=link, points=(point,), on=on, line=line)

    def add_part(self, table: str, like: str, kind: str, **fields: Any) -> str:
        """Add a part to a table, with a name like the preferred one; returns the name."""
        name = self.new_name(like, kind)
        part: Callable[..., Any] = PARTS[table]
        self.parts[table].append(part(name=name, **fields))
        return name

    def finish(self) -> Linkage:
        """The linkage.

        Raises
        ------
        MechanismFileError
            If the file does not contain a linkage; lists all problems.
        """
        into = {name: name for name in (GROUND, *self.links)}
        # a merged link may have two points at one place, and points merged may join links
        while self._join_points() or self._join_links(into):
            pass
        self._drop_loose(into)
        # without these two, the other messages would only be consequences
        if not self.fixed:
            self.source.refuse("has no fixed point: nothing is joined to ground")
        if not self.links:
            self.source.refuse("has no moving link")
        links = {GROUND: [p for p in self.points if p in self.fixed], **self.links}
        parts: dict[str, Any] = {
            table: tuple(_renamed(e, into) for e in es) for table, es in self.parts.items()
        }
        try:
            return Linkage(
                name=self.name or "mechanism",
                length=self.length,
                points={name: (p.real + 0.0, p.imag + 0.0) for name, p in self.points.items()},
                links={name: tuple(points) for name, points in links.items()},
                lengths=self.lengths,
                angles=self.angles,
                inputs=tuple(self._driven(into)),
                trace=tuple(dict.fromkeys(p for p in self.trace if p in self.points)),
                **parts,
            )
        except MechanismError as error:
            raise MechanismFileError(error.problems, self.source.name) from None

    def _join_points(self) -> bool:
        """Make one point of points of a link at the same place; returns whether there were any."""
        same: dict[str, str] = {}
        for name in (GROUND, *self.links):
            # equal to the last digit only: points that are merely close may be a short bar
            first: dict[complex, str] = {}
            carried = self.carries(name)
            for point in [point for point in self.points if point in carried]:
                kept = first.setdefault(self.points[point], point)
                if kept != point and point not in same and kept not in same:
                    same[point] = kept
                    self.source.leave_out(
                        f'point "{point}"', f'as a separate point: it is "{kept}" of {name}'
                    )
        # everything that names a point follows
        for point in same:
            del self.points[point]
        self.fixed = {same.get(point, point) for point in self.fixed}
        for name, points in self.links.items():
            self.links[name] = list(dict.fromkeys(same.get(point, point) for point in points))
        self.trace = [same.get(point, point) for point in self.trace]
        for table in (self.lengths, self.angles):
            for key in list(table):
                spelled = " ".join(same.get(point, point) for point in key.split())
                table[spelled] = table.pop(key)
        if same:
            for table_name, parts in self.parts.items():
                self.parts[table_name] = [_renamed(part, same) for part in parts]
        return bool(same)

    def _join_links(self, into: dict[str, str]) -> bool:
        """Make one link of links that share two points, and note in ``into`` what each became."""
        pairs = self._rigid_pairs()
        for one, other in pairs:
            kept, lost = into[one], into[other]
            if kept == lost:
                continue
            if lost == GROUND:  # ground stays, otherwise the first in the file
                kept, lost = lost, kept
            self._merge(kept, lost)
            into.update({name: kept for name, target in into.items() if target == lost})
        return bool(pairs)

    def _merge(self, kept: str, lost: str) -> None:
        shared = sorted(self.carries(kept) & self.carries(lost))[:2]
        how = "it is fixed" if kept == GROUND else f'it moves with "{kept}"'
        self.source.leave_out(
            f'link "{lost}"', f"as a separate link: by {' and '.join(shared)} {how}"
        )
        for point in self.links.pop(lost):
            self.put_on(kept, point)

    def _rigid_pairs(self) -> list[tuple[str, str]]:
        """Pairs of links, or of ground and a link, with two points in common."""
        at: dict[str, list[str]] = {}
        for name in (GROUND, *self.links):
            carried = self.carries(name)
            for point in (point for point in self.points if point in carried):
                at.setdefault(point, []).append(name)
        # by points, in the file's order, since most links share no point
        common = Counter(pair for names in at.values() for pair in combinations(names, 2))
        return [pair for pair, count in common.items() if count > 1]

    def _drop_loose(self, into: Mapping[str, str]) -> None:
        """Leave out links of one point that are no wheels, and points that nothing carries."""
        used = {name for parts in self.parts.values() for part in parts for name in _names(part)}
        # wheels and blocks need no second point
        used = {into.get(name, name) for name in used}
        for name, points in list(self.links.items()):
            if len(points) < 2 and name not in used:
                del self.links[name]
                into_nothing = "it has one point" if points else "it has no point"
                self.source.leave_out(f'link "{name}"', f"{into_nothing} and no joint but a pin")
        carried = {point for name in (GROUND, *self.links) for point in self.carries(name)}
        for name in [point for point in self.points if point not in carried | used]:
            del self.points[name]
            self.source.leave_out(f'point "{name}"', "it is on no link")

    def _driven(self, into: Mapping[str, str]) -> Iterator[Input]:
        """The inputs whose quantities still exist."""
        for which in self.inputs:
            link, against = into.get(which.link or ""), into.get(which.relative_to or GROUND)
            if which.link is None:
                yield which
            elif link not in self.links or against not in (GROUND, *self.links) or link == against:
                self.source.leave_out(f'link "{which.link}"', "as an input: it does not turn")
            else:
                yield replace(which, link=link, relative_to=None if against == GROUND else against)


def _renamed(part: Any, names: Mapping[str, str]) -> Any:
    """A part with other names of points or links."""
    changes: dict[str, Any] = {}
    for key, entry in vars(part).items():
        if isinstance(entry, tuple):
            changes[key] = tuple(names.get(n, n) if isinstance(n, str) else n for n in entry)
        elif isinstance(entry, str) and key != "name":
            changes[key] = names.get(entry, entry)
    return replace(part, **changes)


def _names(part: Any) -> Iterator[str]:
    """The names in the fields of a part."""
    for entry in vars(part).values():
        if isinstance(entry, str):
            yield entry
        elif isinstance(entry, tuple):
            yield from (name for name in entry if isinstance(name, str))


@lru_cache(maxsize=4096)
def _is_usable(name: str) -> bool:
    """Whether formulas can use a name."""
    if not is_name(name) or len(name) > _LONGEST_NAME or canonical(name) in RESERVED:
        return False
    try:
        return parse(name) == Name(canonical(name))
    except ExpressionError:
        return False


# ----------------------------------------------------------------------
# Mechanisms given as a list of joints, each with the links that it connects: PMKS, Pyslvs.


@dataclass(frozen=True, kw_only=True)
class JointRow:
    """A joint: ``kind`` R (pin), P (slider) or RP (pin in slot), where the first link has the line.

    ``angle`` is that of the line [rad]; ``input``: the joint is driven, with ``speed``.
    """

    place: str
    kind: str
    at: complex
    links: tuple[str, ...]
    angle: float = 0.0
    input: bool = False
    name: str = ""
    speed: str | None = None


def add_joints(assembly: Assembly, rows: Sequence[JointRow]) -> None:
    """Add joints in the file's order, and the links that they name."""
    links = {GROUND: GROUND}
    for row in rows:
        for name in row.links:
            if name not in links:
                links[name] = assembly.add_link(name)
    driven: list[tuple[JointRow, list[str]]] = []
    # pins first: sliders reuse a pin of their link at the same place
    for row in sorted(rows, key=lambda row: row.kind != "R"):
        joined = [links[name] for name in dict.fromkeys(row.links)]
        if row.kind == "R":
            point = assembly.add_point(row.name, row.at)
            for link in joined:
                assembly.put_on(link, point)
            if row.input:
                driven.append((row, joined))
        elif len(joined) < 2:
            assembly.source.leave_out(row.place, f"joint of type {row.kind} with one link")
        else:
            _add_slide(assembly, row, joined)
    # only now do links have all their points
    for row, joined in driven:
        drive_joint(assembly, row.place, joined, row.speed)


def _add_slide(assembly: Assembly, row: JointRow, joined: list[str]) -> None:
    on, *moving = joined
    point = _point_at(assembly, row, moving)
    for link in moving:
        assembly.put_on(link, point)
    if point in assembly.carries(on):
        assembly.source.leave_out(row.place, f'slide on "{on}", which carries the point itself')
        return
    line = assembly.guide(on, point, cmath.rect(1.0, row.angle))
    if row.kind == "RP":
        name = assembly.add_slot(f"s_{point}", point, on, line)
    else:
        name = assembly.add_slider(f"s_{point}", moving[0], point, on, line)
    if row.input:
        assembly.source.leave_out(row.place, "range of the driven slide: it is set to ± a quarter")
        size = abs(assembly.points[line[1]] - assembly.points[line[0]]) / 4.0
        assembly.inputs.append(Input(slider=name, from_=-size, to=size, step=size / 50.0))


def _point_at(assembly: Assembly, row: JointRow, moving: list[str]) -> str:
    """A point of a moving link at the place of a slide, or a new one."""
    for link in moving:
        for point in sorted(assembly.carries(link)):
            if assembly.points[point] == row.at:
                return point
    return assembly.add_point(row.name, row.at)


def drive_joint(
    assembly: Assembly, place: str, links: Sequence[str], speed: str | None = None
) -> None:
    """Drive the angle between the two links at a pin; all points must be on their links before."""
    moving = [name for name in links if not assembly.carries(name) <= assembly.fixed]
    # links whose points are all fixed are part of ground
    joined = [GROUND, *moving] if len(moving) < len(links) else moving
    if len(joined) != 2:
        message = f"input at a pin of {len(joined)} links: name two of them"
        assembly.source.leave_out(place, message)
        return
    assembly.drive(joined[1], joined[0], speed=speed)


# ----------------------------------------------------------------------
# A linkage at one position, as the joints that formats of other programs list.


@dataclass(frozen=True, kw_only=True)
class Exported:
    """A mechanism as a text of another program.

    Parameters
    ----------
    text : str
        The content of a file, or a link.
    left_out : tuple of LeftOut
        What the format cannot carry.

    Examples
    --------
    >>> import linkwork as lw
    >>> made = lw.readers.exported(lw.example("four-bar"), "pyslvs", at=0)
    >>> made.text[:41]
    'M[J[R, P[0.0, 0.0], L[ground, crank]], J['
    >>> print(made.left_out[0])
    "crank": range or law of the input
    """

    text: str
    left_out: tuple[LeftOut, ...]


class Drawn(Notes):
    """A linkage and the places of its points in an assembled position; notes on omitted parts.

    Raises
    ------
    InputError
        If the linkage has parts that these formats do not know.
    """

    def __init__(self, linkage: Linkage, places: Mapping[str, complex]) -> None:
        super().__init__()
        self.linkage, self.places = linkage, places
        for key, part in linkage.keyed_parts:
            if part.pairs(linkage) == KinematicPairs():  # it constrains nothing
                self.leave_out(part.label, part.title.lower())
            elif key[0] not in ("slots", "sliders"):
                raise InputError(
                    f'"{part.label}" ({part.title.lower()}) has no equivalent in this format: it '
                    "has pins, slots and sliders only"
                )
        for name in linkage.masses:
            self.leave_out(name, "mass")
        for which in linkage.inputs:
            # the driven pin itself can be written
            table = (which.from_, which.to, which.step)
            if table != (None, None, None) or which.law is not None:
                self.leave_out(which.column, "range or law of the input")

    def leave_out(self, place: str, what: str) -> None:
        """Note a part, by its name, that is not carried over."""
        super().leave_out(f'"{place}"', what)

    def joints(self) -> Iterator[JointRow]:
        """Pins of points, slots, and sliders; a slider lies at a point that also has a pin."""
        slotted = {slot.point for slot in self.linkage.slots}
        for point, at in self.places.items():
            if point not in slotted:
                carriers = self._carriers(point)
                yield JointRow(place=point, kind="R", at=at, links=carriers, name=point)
        slides: list[tuple[str, Any, str, tuple[str, ...]]] = [
            *(("RP", s, s.point, self._carriers(s.point)) for s in self.linkage.slots),
            *(("P", s, s.points[0], (s.link,)) for s in self.linkage.sliders),
        ]
        for kind, part, point, moving in slides:
            a, b = (self.places[end] for end in part.line)
            yield JointRow(
                place=part.name,
                kind=kind,
                at=self.places[point],
                links=(part.on, *moving),
                angle=phase(b - a),
                name=point,
            )

    def _carriers(self, point: str) -> tuple[str, ...]:
        return tuple(name for name, points in self.linkage.links.items() if point in points)

    def driven_pins(self) -> dict[str, Input]:
        """The inputs by the points whose pins they drive; other inputs are left out."""
        pins_of_inputs = {}
        for which in self.linkage.inputs:
            kind, name = which.drives
            pair = {name, which.relative_to or GROUND}
            pins = [name] if kind == "joint" else []
            if kind == "link":
                pins = [p for p in self.places if pair == set(self._carriers(p))]
            if pins:
                pins_of_inputs[pins[0]] = which
            else:
                self.leave_out(which.column, "the input: it is no pin of two links")
        return pins_of_inputs
