"""Guides: parts that guide a point along the line through two points of a link."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.part.part import NamedPart, PartChecks

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
        """The guided point."""
        raise NotImplementedError

    def check_shapes(self, checks: PartChecks) -> None:
        """Check that the sketch shows the direction of the line."""
        first, second = self.line
        if checks.linkage.sketched(first) == checks.linkage.sketched(second):
            checks.add(
                f"{first} and {second} are sketched at the same place: draw them apart", "line"
            )


def guide_named(linkage: Bodies, name: str | None) -> GuidePart | None:
    """The slider or slot with this name."""
    return next((guide for guide in linkage.of(GuidePart) if guide.name == name), None)
