"""Points, links and parts that need not be a mechanism yet, with what they lack."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Self

from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import ExpressionError
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.names import GROUND, canonical
from linkwork.mechanism.bodies import Measured, Shapes
from linkwork.mechanism.description import Key, Problems
from linkwork.mechanism.dimensions import LARGEST
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.field_types import check_entries
from linkwork.mechanism.friction import Friction
from linkwork.mechanism.link_shapes import link_shapes
from linkwork.mechanism.linkage_checks import check_linkage
from linkwork.mechanism.part.index import PARTS, JoinedBodies
from linkwork.mechanism.part.part import Part, PartChecks, carriers, turning_links

__all__ = ["Draft"]


@dataclass(frozen=True, kw_only=True)
class Draft(JoinedBodies):
    """Points, links and parts under construction.

    Fields as of :class:`~linkwork.mechanism.linkage.Linkage`, which has no problems.
    """

    #: All that keeps the draft from being a linkage.
    problems: Problems = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        set_ = object.__setattr__
        for table, kind in PARTS.items():
            check_entries(table, kind, getattr(self, table))
        check_entries("friction", Friction, self.friction.values())
        own = [name for part in self.parts if (name := getattr(part, "name", ""))]
        named = (*self.points, *self.links, *own)
        find_spelling = {canonical(name): name for name in named}

        def same(name: str) -> str:
            return str(find_spelling.get(canonical(name), name))

        set_(self, "points", FrozenDict({n: tuple(p) for n, p in self.points.items()}))
        links = {name: tuple(map(same, points)) for name, points in self.links.items()}
        set_(self, "links", FrozenDict(links))
        set_(self, "masses", self.spelled_masses())
        set_(self, "clearances", FrozenDict({same(p): c for p, c in self.clearances.items()}))
        rubbing = {same(name): friction for name, friction in self.friction.items()}
        set_(self, "friction", FrozenDict(rubbing))
        for which in ("lengths", "angles"):
            table = getattr(self, which)
            folded = {" ".join(map(same, key.split())): number for key, number in table.items()}
            set_(self, which, FrozenDict(folded if len(folded) == len(table) else table))
        for table in PARTS:
            entries: tuple[Part, ...] = getattr(self, table)
            set_(self, table, tuple(part.find_spelling(same) for part in entries))
        for kept in ("parts", "keyed_parts"):
            self.__dict__.pop(kept, None)
        inputs = tuple(_spelled_input(driven, same) for driven in self.inputs)
        set_(self, "inputs", inputs)
        set_(self, "trace", tuple(map(same, self.trace)))
        self._examine()

    def _examine(self) -> None:
        """Find the problems and the shapes of the links."""
        problems = Problems()
        object.__setattr__(self, "problems", problems)
        check_linkage(self, problems)
        object.__setattr__(self, "shapes", Shapes() if problems else link_shapes(self, problems))
        if not problems:
            for key, part in self.keyed_parts:
                part.check_shapes(PartChecks(self, problems, key))

    def with_tables(self, tables: Mapping[str, Any]) -> Self:
        """A copy with other numbers under the same names in some tables, examined.

        Names keep their spelling and entries their types, which ``replace`` would check again.
        """
        copy = object.__new__(type(self))
        # without what was computed from the numbers and kept
        kept = {part.name: getattr(self, part.name) for part in fields(self)}
        copy.__dict__.update({**kept, **tables})
        copy._examine()
        return copy

    @property
    def turning_on_one_point(self) -> frozenset[str]:
        """Links that may have one point only: wheels and cams."""
        return turning_links(self)

    def carriers(self) -> dict[str, list[str]]:
        """The links and cylinders at every point, in the file's order."""
        return carriers(self)

    @cached_property
    def measured(self) -> tuple[Measured, ...]:
        """Lengths that are not given; of a draft, those between neighbouring points of links."""
        if not self.problems:
            return self.shapes.measured
        draft = self.drawable
        given = {frozenset(key.split()) for key in self.lengths}
        return tuple(
            Measured(link=link, points=(a, b), length=abs(draft.sketched(b) - draft.sketched(a)))
            for link, points in draft.links.items()
            for a, b in pairwise(points)
            if link != GROUND and frozenset((a, b)) not in given
        )

    @cached_property
    def drawable(self) -> Draft:
        """The points with coordinates, and the links and parts that exist between them, shaped as
        sketched.
        """
        points = {name: place for name, place in self.points.items() if self._is_placed(name)}
        links = {
            name: tuple(dict.fromkeys(point for point in carried if point in points))
            for name, carried in {GROUND: (), **self.links}.items()
        }
        kept: dict[str, object] = {
            "points": points,
            "links": {name: own for name, own in links.items() if own or name == GROUND},
            "trace": tuple(point for point in self.trace if point in points),
        }
        inputs = enumerate(self.inputs)
        kept["inputs"] = tuple(i for k, i in inputs if not self._lacks(self.input_key(k)))
        for table in PARTS:
            parts = enumerate(getattr(self, table))
            kept[table] = tuple(part for k, part in parts if not self._lacks((table, k)))
        found = replace(self, **kept)  # type: ignore[arg-type]
        # what is left may refer to a part that was left out
        keys = [key for key, _ in found.keyed_parts]
        keys += map(found.input_key, range(len(found.inputs)))
        if any(map(found._lacks, keys)):
            return found.drawable
        object.__setattr__(found, "shapes", Shapes(local=dict(found._sketched_shapes())))
        return found

    def _sketched_shapes(self) -> Iterator[tuple[str, Mapping[str, complex]]]:
        for link, points in self.links.items():
            origin = 0j if link == GROUND else self.sketched(points[0])
            span = 1.0 if link == GROUND else self.sketched(points[:2][-1]) - origin
            turn = cmath.exp(-1j * phase(span))
            yield link, {point: (self.sketched(point) - origin) * turn for point in points}

    def _lacks(self, key: Key) -> bool:
        """Whether there is a problem below a key path."""
        return any(problem.key[: len(key)] == key for problem in self.problems)

    def _is_placed(self, point: str) -> bool:
        place = self.points[point]
        try:
            return len(place) == 2 and all(abs(self.numbers(c)) <= LARGEST for c in place)
        except ExpressionError:
            return False


def _spelled_input(which: Input, same: Callable[[str], str]) -> Input:
    changes: dict[str, Any] = {
        field: same(name)
        for field in ("link", "joint", "slider", "cylinder", "relative_to")
        if (name := getattr(which, field)) is not None and same(name) != name
    }
    return replace(which, **changes) if changes else which
