"""Form A: a mechanism described by its points and links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.lanes import vector
from linkwork.foundation.names import GROUND, canonical
from linkwork.mechanism.contacts import Belt, Cam, Curve, Gear, Rack, Rolling, Weld
from linkwork.mechanism.description import Description, Problems
from linkwork.mechanism.linkage_checks import check_linkage
from linkwork.mechanism.parts import (
    Cylinder,
    Input,
    Number,
    Slider,
    Slot,
    Spring,
    replaced_names,
)
from linkwork.mechanism.shape import Shapes

__all__ = ["GROUND", "PART_KINDS", "Linkage"]


#: What a linkage is made of besides points and links: fields of the class, tables of a file.
PART_KINDS = (
    "slots", "sliders", "cylinders", "welds", "gears", "belts", "racks", "rolling", "cams",
    "curves", "springs",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Linkage(Description):
    """Points, the links that carry them, and what is driven.

    A pin joint is wherever links share a point. One link is called ``ground`` and stands still.

    Parameters
    ----------
    points : Mapping[str, (x, y)]
        One assembled position: exact for ground, elsewhere exact or a sketch. Decides sides.
    links : Mapping[str, sequence of str]
        The points each link carries; its angle runs from the first to the second.
    lengths : Mapping[str, number]
        Exact distances, ``"A B"``, between two points of one link.
    angles : Mapping[str, number]
        Exact angles in a link: ``"B A P"`` at A, from AB to AP, counter-clockwise.
    sketch : bool
        If true, dimensions are never measured from ``points``.
    """

    points: Mapping[str, tuple[Number, ...]] = FrozenDict()
    links: Mapping[str, tuple[str, ...]] = FrozenDict()
    lengths: Mapping[str, Number] = FrozenDict()
    angles: Mapping[str, Number] = FrozenDict()
    slots: tuple[Slot, ...] = ()
    sliders: tuple[Slider, ...] = ()
    cylinders: tuple[Cylinder, ...] = ()
    welds: tuple[Weld, ...] = ()
    gears: tuple[Gear, ...] = ()
    belts: tuple[Belt, ...] = ()
    racks: tuple[Rack, ...] = ()
    rolling: tuple[Rolling, ...] = ()
    cams: tuple[Cam, ...] = ()
    curves: tuple[Curve, ...] = ()
    springs: tuple[Spring, ...] = ()
    sketch: bool = False
    #: The exact shape of every link, as local coordinates, and what was measured.
    shapes: Shapes = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        set_ = object.__setattr__
        parts = [part for kind in PART_KINDS for part in getattr(self, kind)]
        own = (part.name for part in parts if not isinstance(part, Weld))
        named = (*self.points, *self.links, *own)
        spelled = {canonical(name): name for name in named}

        def same(name: str) -> str:
            return str(spelled.get(canonical(name), name))

        set_(self, "points", FrozenDict({n: tuple(p) for n, p in self.points.items()}))
        links = {name: tuple(map(same, points)) for name, points in self.links.items()}
        set_(self, "links", FrozenDict(links))
        for which in ("lengths", "angles"):
            table = getattr(self, which)
            folded = {" ".join(map(same, key.split())): number for key, number in table.items()}
            set_(self, which, FrozenDict(folded if len(folded) == len(table) else table))
        for kind in PART_KINDS:
            same_kind = getattr(self, kind)
            renamed = (replaced_names(part, spelled, canonical) for part in same_kind)
            set_(self, kind, tuple(renamed))
        inputs = tuple(_spelled_input(driven, same) for driven in self.inputs)
        set_(self, "inputs", inputs)
        set_(self, "trace", tuple(map(same, self.trace)))
        problems = Problems()
        shapes = check_linkage(self, problems)
        problems.raise_any(f'mechanism "{self.name}"')
        set_(self, "shapes", shapes)

    def sketched(self, point: str) -> complex:
        """The point's coordinates in ``points`` as x + iy."""
        x, y = self.points[point]
        return vector(self.numbers(x), self.numbers(y))

    def bodies_at(self, point: str) -> Iterator[str]:
        """The links that carry a point, in the file's order."""
        for link, points in self.links.items():
            if point in points:
                yield link

    @property
    def turning_on_one_point(self) -> frozenset[str]:
        """Links that one point is enough for: wheels and cams, which have no direction to see."""
        found = [wheel for part in self.gears for wheel in part.wheels]
        found += [wheel for part in self.belts for wheel in part.wheels]
        found += [part.wheel for part in self.rolling] + [part.pinion for part in self.racks]
        return frozenset([*found, *(part.cam for part in self.cams)])

    def carriers(self) -> dict[str, list[str]]:
        """For every point the links and cylinders that carry it, in the file's order."""
        found: dict[str, list[str]] = {point: [] for point in self.points}
        for link, points in self.links.items():
            for point in points:
                found[point].append(link)
        for cylinder in self.cylinders:
            for point in cylinder.between:
                found[point].append(cylinder.name)
        return found


def _spelled_input(which: Input, same: object) -> Input:
    assert callable(same)
    changes = {
        field: same(name)
        for field in ("link", "joint", "slider", "cylinder", "relative_to")
        if (name := getattr(which, field)) is not None
    }
    return Input(**{**vars(which), **changes})
