"""A guide: a part that leads something along the line through two points of a link."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.part.part import NamedPart

__all__ = ["GuidePart", "guide_named"]


@dataclass(frozen=True, kw_only=True)
class GuidePart(NamedPart):
    """A slider or slot along the line through two points of the link ``on``."""

    on: str
    line: tuple[str, str]

    @property
    def drive(self) -> str:
        return "slider"

    @property
    def point_on_line(self) -> str:
        """The point that runs along the line."""
        raise NotImplementedError


def guide_named(linkage: Bodies, name: str | None) -> GuidePart | None:
    """The slider or slot of that name."""
    return next((guide for guide in linkage.of(GuidePart) if guide.name == name), None)
