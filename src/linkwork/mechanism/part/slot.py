"""Pin in slot: a point runs along a line of another link."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.foundation.file_keys import Key, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.figures import Figure, Guide, Outlines
from linkwork.mechanism.joint import Joint, JointKind
from linkwork.mechanism.part.guide import GuidePart
from linkwork.mechanism.part.part import LINK, POINT, POINT_PAIR, PartChecks, pinned

__all__ = ["Slot"]


@dataclass(frozen=True, kw_only=True)
class Slot(GuidePart):
    """Pin in slot: ``point`` runs along the line through two points of the link ``on``.

    The displacement ``name`` is zero at the first point of ``line``, positive to the second.
    """

    title = "Pin in slot"
    doc = "Pin in slot: a point runs along a line of another link"
    keys = (
        Key("name", Text(), "Name of the displacement, zero at the first point of the line", True),
        Key("point", POINT, "The pin: a point of another link", required=True),
        Key("on", LINK, "The link with the slot", required=True),
        Key("line", POINT_PAIR, "Two points of that link; positive from first to second", True),
    )
    kind = JointKind.PIN_IN_SLOT

    point: str

    @property
    def point_on_line(self) -> str:
        return self.point

    @property
    def guided(self) -> tuple[str, str, str]:
        return "point", self.point, self.on

    def joint(self, linkage: Bodies) -> Joint:
        links = (pinned(linkage, self.point), self.on)
        return Joint(kind=self.kind, name=self.name, links=links, point=self.point)

    def check(self, checks: PartChecks) -> None:
        checks.line(self.on, self.line)
        fixed = self.point in checks.linkage.links.get(self.on, ())
        if checks.defined(self.point, "point") and fixed:
            checks.add(
                f'point "{self.point}" is fixed on "{self.on}" and cannot move in its slot', "point"
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield Guide(name=self.name, point=self.point, on=self.on, line=self.line)
