"""The index of parts: every table of parts of a file, in its order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import get_args, get_type_hints

from linkwork.foundation.frozen import FrozenDict
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.description import Key
from linkwork.mechanism.friction import Friction
from linkwork.mechanism.part.belt import Belt
from linkwork.mechanism.part.cam import Cam
from linkwork.mechanism.part.curve import Curve
from linkwork.mechanism.part.cylinder import Cylinder
from linkwork.mechanism.part.gear import Gear
from linkwork.mechanism.part.load import Load
from linkwork.mechanism.part.noncircular_gear import NoncircularGear
from linkwork.mechanism.part.part import Part
from linkwork.mechanism.part.rack import Rack
from linkwork.mechanism.part.rolling import Rolling
from linkwork.mechanism.part.slider import Slider
from linkwork.mechanism.part.slot import Slot
from linkwork.mechanism.part.spring import Spring
from linkwork.mechanism.part.weld import Weld

__all__ = ["PARTS", "JoinedBodies", "part_module"]


@dataclass(frozen=True, kw_only=True)
class _Tables:
    """One field for each table of parts; most fields are read through type hints only."""

    slots: tuple[Slot, ...] = ()
    sliders: tuple[Slider, ...] = ()
    cylinders: tuple[Cylinder, ...] = ()
    welds: tuple[Weld, ...] = ()
    gears: tuple[Gear, ...] = ()  # noqa: V107
    noncircular_gears: tuple[NoncircularGear, ...] = ()  # noqa: V107
    belts: tuple[Belt, ...] = ()  # noqa: V107
    racks: tuple[Rack, ...] = ()  # noqa: V107
    rolling: tuple[Rolling, ...] = ()
    cams: tuple[Cam, ...] = ()
    curves: tuple[Curve, ...] = ()
    springs: tuple[Spring, ...] = ()
    loads: tuple[Load, ...] = ()


#: The kind of part of every table.
PARTS: Mapping[str, type[Part]] = {
    # the fields are tuple[Kind, ...]
    table: get_args(kind)[0]
    for table, kind in get_type_hints(_Tables).items()
}


def part_module(kind: type) -> str:
    """The module name of a part, the same in the packages of its figures and equations."""
    return kind.__module__.rpartition(".")[2]


@dataclass(frozen=True, kw_only=True)
class JoinedBodies(_Tables, Bodies):
    """Rigid links and the parts between them.

    ``friction`` is that of pins and parts, by name.
    """

    friction: Mapping[str, Friction] = FrozenDict()

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Every part, in the order of the tables of a file."""
        return tuple(part for _, part in self.keyed_parts)

    @property
    def loaded(self) -> bool:
        return bool(self.masses or self.loads or any(spring.pulls for spring in self.springs))

    @cached_property
    def keyed_parts(self) -> tuple[tuple[Key, Part], ...]:
        """All parts with their key paths in a file."""
        return tuple(
            ((table, k), part) for table in PARTS for k, part in enumerate(getattr(self, table))
        )
