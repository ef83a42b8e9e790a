"""Points, links and joints of a foreign file, put together to a linkage."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import combinations
from typing import Any

from linkwork.exchange.source import Source
from linkwork.expression.grammar import RESERVED, parse
from linkwork.expression.tree import Name
from linkwork.foundation.errors import ExpressionError, MechanismError, MechanismFileError
from linkwork.foundation.names import GROUND, canonical, free_name, is_name
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.index import PARTS

__all__ = ["Assembly"]

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

    def new_name(self, wanted: str, kind: str) -> str:
        """A name like the wanted one that formulas can use and nothing else has."""
        text = re.sub(r"\W", "_", wanted.strip()[:_LONGEST_NAME]).strip("_")
        # the nearest spelling first, so that a person recognizes the name
        tried = (wanted, text, f"{kind}{text}", f"{kind}_{text}", kind)
        own = free_name(next(filter(_is_usable, tried)), self._taken)
        if own != wanted and wanted:
            self.renamed[f'{_KINDS.get(kind, kind)} "{wanted[:_LONGEST_NAME]}"'] = own
        return own

    def add_point(self, wanted: str, place: complex, fixed: bool = False) -> str:
        """A point; returns its name."""
        if len(self.points) == _MOST:
            self.source.refuse(f"has more than {_MOST} points")
        name = self.new_name(wanted, "P")
        self.points[name] = place
        if fixed:
            self.fixed.add(name)
        return name

    def add_link(self, wanted: str, points: Iterable[str] = ()) -> str:
        """A link; returns its name."""
        if len(self.links) == _MOST:
            self.source.refuse(f"has more than {_MOST} links")
        name = self.new_name(wanted, "link")
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

    def add_slot(self, wanted: str, point: str, on: str, line: tuple[str, str]) -> str:
        """A pin in a slot of a link; returns the name of the displacement."""
        return self.add_part("slots", wanted, "s", point=point, on=on, line=line)

    def add_slider(self, wanted: str, link: str, point: str, on: str, line: tuple[str, str]) -> str:
        """A link that slides without turning; returns the name of the displacement."""
        return self.add_part("sliders", wanted, "s", link=link, points=(point,), on=on, line=line)

    def add_part(self, table: str, wanted: str, kind: str, **fields: Any) -> str:
        """A part of a table of the file, with a name like the wanted one; returns the name."""
        name = self.new_name(wanted, kind)
        part: Callable[..., Any] = PARTS[table]
        self.parts[table].append(part(name=name, **fields))
        return name

    def finish(self) -> Linkage:
        """The linkage.

        Raises
        ------
        MechanismFileError
            If what the file contains is not a linkage, with every problem found.
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
            own = self.carries(name)
            for point in [point for point in self.points if point in own]:
                kept = first.setdefault(self.points[point], point)
                if kept != point and point not in same and kept not in same:
                    same[point] = kept
                    self.source.leave_out(
                        f'point "{point}"', f'as a point of its own: it is "{kept}" of {name}'
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
            into.update({name: kept for name, own in into.items() if own == lost})
        return bool(pairs)

    def _merge(self, kept: str, lost: str) -> None:
        shared = sorted(self.carries(kept) & self.carries(lost))[:2]
        how = "it is fixed" if kept == GROUND else f'it moves with "{kept}"'
        self.source.leave_out(
            f'link "{lost}"', f"as a link of its own: by {' and '.join(shared)} {how}"
        )
        for point in self.links.pop(lost):
            self.put_on(kept, point)

    def _rigid_pairs(self) -> list[tuple[str, str]]:
        """Pairs of links, or of ground and a link, with two points in common."""
        at: dict[str, list[str]] = {}
        for name in (GROUND, *self.links):
            own = self.carries(name)
            for point in (point for point in self.points if point in own):
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
    for key, own in vars(part).items():
        if isinstance(own, tuple):
            changes[key] = tuple(names.get(n, n) if isinstance(n, str) else n for n in own)
        elif isinstance(own, str) and key != "name":
            changes[key] = names.get(own, own)
    return replace(part, **changes)


def _names(part: Any) -> Iterator[str]:
    """The names in the fields of a part."""
    for own in vars(part).values():
        if isinstance(own, str):
            yield own
        elif isinstance(own, tuple):
            yield from (name for name in own if isinstance(name, str))


@lru_cache(maxsize=4096)
def _is_usable(name: str) -> bool:
    """Whether formulas can use a name."""
    if not is_name(name) or len(name) > _LONGEST_NAME or canonical(name) in RESERVED:
        return False
    try:
        return parse(name) == Name(canonical(name))
    except ExpressionError:
        return False
