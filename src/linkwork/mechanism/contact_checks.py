"""What can be wrong with welds, gears, belts, racks, rolling wheels, cams and curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.mechanism.cam_checks import CamChecks
from linkwork.mechanism.contacts import Weld
from linkwork.mechanism.part_checks import Key, PartChecks
from linkwork.mechanism.wheel_checks import WheelChecks

if TYPE_CHECKING:
    from linkwork.mechanism.description import Problems
    from linkwork.mechanism.linkage import Linkage

__all__ = ["check_contacts"]


def check_contacts(linkage: Linkage, problems: Problems) -> None:
    """Add every problem of these parts that shows without the links' shapes."""
    wheels, cams = WheelChecks(linkage, problems), CamChecks(linkage, problems)
    welds = _WeldChecks(linkage, problems)
    for k, weld in enumerate(linkage.welds):
        welds.weld(weld, ("welds", k))
    for k, gear in enumerate(linkage.gears):
        wheels.wheels(gear, ("gears", k))
    for k, belt in enumerate(linkage.belts):
        wheels.wheels(belt, ("belts", k))
    for k, rack in enumerate(linkage.racks):
        wheels.rack(rack, ("racks", k))
    for k, rolling in enumerate(linkage.rolling):
        wheels.rolling(rolling, ("rolling", k))
    for k, cam in enumerate(linkage.cams):
        cams.cam(cam, ("cams", k))
    for k, curve in enumerate(linkage.curves):
        cams.curve(curve, ("curves", k))


class _WeldChecks(PartChecks):
    """Checks of welds, adding to a linkage's problems."""

    def weld(self, weld: Weld, key: Key) -> None:
        """Two different links with a common point."""
        if not self.two(weld.links, (*key, "links"), "link"):
            return
        there = [self.link(name, (*key, "links")) for name in weld.links]
        if not all(there):
            return
        first, second = (self.linkage.links[name] for name in weld.links)
        if not set(first) & set(second):
            self.problems.add(
                (*key, "links"),
                f"{' and '.join(weld.links)} share no point: let both carry the point at which "
                "they are welded",
            )
        for name, points in zip(weld.links, (first, second), strict=True):
            known = name == "ground" or name in self.linkage.turning_on_one_point
            if len(points) < 2 and not known:
                self.problems.add(
                    (*key, "links"),
                    f'"{name}" has only the point {points[0]}, so its direction is not known: '
                    "make one link of both",
                )
        if weld.angle is not None:
            self.linkage.numbers.check_number(self.problems.add, (*key, "angle"), weld.angle)
