"""The index of part reactions: each part has a module of the same name.

It adds the part's reactions with ``write(part, bodies)``, and if the part can be driven, the force
along its displacement with ``drive(part, bodies)``, which returns the number of the unknown.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import ModuleType

from linkwork.forces.free_bodies import FreeBodies
from linkwork.mechanism.part.index import part_module
from linkwork.mechanism.part.part import Part

__all__ = ["drive_part", "join_loads", "join_parts"]


def join_parts(bodies: FreeBodies) -> None:
    """Add the reactions of all parts."""
    for part in bodies.parts:
        join_part(part, bodies)


def join_loads(bodies: FreeBodies) -> None:
    """Add the parts that load the links without joining them."""
    linkage = bodies.linkage
    for part in (*linkage.loads, *linkage.springs):
        join_part(part, bodies)


def join_part(part: Part, bodies: FreeBodies) -> None:
    """Add the reactions of one part, or its loads."""
    write: Callable[[Part, FreeBodies], None] = _room(part).write
    write(part, bodies)


def drive_part(bodies: FreeBodies, name: str) -> int:
    """Add the force along the displacement of the part with this name."""
    part = next(part for part in bodies.parts if part.drive and part.label == name)
    drive: Callable[[Part, FreeBodies], int] = _room(part).drive
    return drive(part, bodies)


def _room(part: Part) -> ModuleType:
    return import_module(f"linkwork.forces.part.{part_module(type(part))}")
