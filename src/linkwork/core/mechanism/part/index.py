"""The index of parts: every table of parts of a file, in its order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING

from linkwork import wings
from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.mechanism.bodies import Bodies
from linkwork.core.mechanism.description import Key
from linkwork.core.mechanism.machine import Friction
from linkwork.core.mechanism.part.gears import Belt, Gear, Rack
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.part import Part
from linkwork.core.mechanism.part.rolling import Rolling
from linkwork.core.mechanism.part.springs import Load, Spring, Weld

if TYPE_CHECKING:
    from linkwork.contacts.cams import Cam
    from linkwork.contacts.curves import Curve, NoncircularGear
    from linkwork.couplings.coupling import LinearCoupling


@dataclass(frozen=True, kw_only=True)
class _Tables:
    """One field for each table of parts."""

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
    couplings: tuple[LinearCoupling, ...] = ()  # noqa: V107
    springs: tuple[Spring, ...] = ()
    loads: tuple[Load, ...] = ()


_KINDS = {
    "slots": Slot,
    "sliders": Slider,
    "cylinders": Cylinder,
    "welds": Weld,
    "gears": Gear,
    "belts": Belt,
    "racks": Rack,
    "rolling": Rolling,
    "springs": Spring,
    "loads": Load,
    **{table: wings.load(place) for wing in wings.WINGS for table, place in wing.parts.items()},
}
#: The kind of part of every table, in the order of a file.
PARTS: Mapping[str, type[Part]] = {field.name: _KINDS[field.name] for field in fields(_Tables)}


def open_room(kind: type, room: str) -> None:
    """Import what registers the functions of a kind of parts in a room, such as its equations.

    A kind of the core that only a wing draws names it in ``wing``.
    """
    package = getattr(kind, "wing", kind.__module__.rpartition(".")[0])
    if not package.startswith("linkwork.core"):
        import_module(f"{package}.{room}")


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
