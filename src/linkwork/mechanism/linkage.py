"""Form A: a mechanism described by its points and links."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.names import GROUND, canonical
from linkwork.mechanism.bodies import Shapes
from linkwork.mechanism.description import Problems
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.field_types import check_entries
from linkwork.mechanism.link_shapes import link_shapes
from linkwork.mechanism.linkage_checks import check_linkage
from linkwork.mechanism.part.index import PARTS, JoinedBodies
from linkwork.mechanism.part.part import Part, PartChecks, carriers, turning_links

__all__ = ["GROUND", "Linkage"]


@dataclass(frozen=True, kw_only=True)
class Linkage(JoinedBodies):
    """Points, links and inputs.

    Links that share a point are pinned there. The link ``ground`` is fixed.

    Parameters
    ----------
    points : Mapping[str, (x, y)]
        One assembled position: exact on ground, elsewhere exact or a sketch that selects sides.
    links : Mapping[str, sequence of str]
        The points of each link; its angle is the direction from the first to the second.
    lengths : Mapping[str, number]
        Exact distances, ``"A B"``, between two points of one link.
    angles : Mapping[str, number]
        Exact angles in a link: ``"B A P"`` at A, from AB to AP, counter-clockwise.
    sketch : bool
        If true, dimensions are never measured from ``points``.
    slots, sliders, … : tuples of parts
        One field for each table of parts, see :mod:`linkwork.mechanism.part.index`.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        set_ = object.__setattr__
        for table, kind in PARTS.items():
            check_entries(table, kind, getattr(self, table))
        own = [name for part in self.parts if (name := getattr(part, "name", ""))]
        named = (*self.points, *self.links, *own)
        find_spelling = {canonical(name): name for name in named}

        def same(name: str) -> str:
            return str(find_spelling.get(canonical(name), name))

        set_(self, "points", FrozenDict({n: tuple(p) for n, p in self.points.items()}))
        links = {name: tuple(map(same, points)) for name, points in self.links.items()}
        set_(self, "links", FrozenDict(links))
        for which in ("lengths", "angles"):
            table = getattr(self, which)
            folded = {" ".join(map(same, key.split())): number for key, number in table.items()}
            set_(self, which, FrozenDict(folded if len(folded) == len(table) else table))
        for table in PARTS:
            entries: tuple[Part, ...] = getattr(self, table)
            set_(self, table, tuple(part.find_spelling(same) for part in entries))
        self.__dict__.pop("parts", None)
        inputs = tuple(_spelled_input(driven, same) for driven in self.inputs)
        set_(self, "inputs", inputs)
        set_(self, "trace", tuple(map(same, self.trace)))
        problems = Problems()
        check_linkage(self, problems)
        set_(self, "shapes", Shapes() if problems else link_shapes(self, problems))
        if not problems:
            for key, part in self.keyed_parts():
                part.check_shapes(PartChecks(self, problems, key))
        problems.raise_any(f'mechanism "{self.name}"')

    @property
    def turning_on_one_point(self) -> frozenset[str]:
        """Links that may have one point only: wheels and cams."""
        return turning_links(self)

    def carriers(self) -> dict[str, list[str]]:
        """The links and cylinders at every point, in the file's order."""
        return carriers(self)


def _spelled_input(which: Input, same: Callable[[str], str]) -> Input:
    changes = {
        field: same(name)
        for field in ("link", "joint", "slider", "cylinder", "relative_to")
        if (name := getattr(which, field)) is not None
    }
    return replace(which, **changes)
