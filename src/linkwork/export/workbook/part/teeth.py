"""Teeth: a force across the line of centres, and one that pushes the wheels apart."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.export.workbook.acting import left_of, opposite
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.toothed import ToothedPart
from linkwork.results.quantity import Kind

__all__ = ["mesh", "pressure"]


def mesh(name: str, links: tuple[str, str], reactions: Reactions) -> None:
    """The force of the first link's teeth on the second's, at the contact of this name."""
    first, second = links
    way, tangent = reactions.way[name], f"{name}.tangent"
    reactions.pair(tangent, second, first, name, left_of(way))
    names = {"p": reactions.cells[f"{name} pressure"]}
    acts = opposite(second, first, name, way)
    # eq. (74) for round wheels
    reactions.follow(f"{name}.radial", tangent, "tan(p)*abs(t)", names, acts)


def pressure(part: ToothedPart, linkage: Linkage) -> Iterator[tuple[str, float, Kind, str]]:
    """The pressure angle."""
    angle = part.pressure(linkage) / linkage.angle.radians
    yield "pressure", angle, Kind.ANGLE, f"pressure angle of {part.label}"
