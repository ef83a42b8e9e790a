"""Symbols of Oldham couplings: two discs with a groove across, and the cross that slides in both.

A coupling is a link without pins that slides along two links, each about a fixed pivot on its line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Disc as Circle, Polygon, Primitive, Role, xy
from linkwork.mechanism.figures import Guide
from linkwork.mechanism.skeleton import Skeleton

__all__ = ["Coupling", "coupling_symbols", "couplings"]


@dataclass(frozen=True, kw_only=True)
class Coupling:
    """The link that slides in two discs, and for each disc its guide and its fixed centre."""

    cross: str
    discs: tuple[tuple[Guide, str], ...]

    @property
    def links(self) -> set[str]:
        """The links drawn as discs and cross."""
        return {self.cross, *(guide.on for guide, _ in self.discs)}

    @property
    def guides(self) -> set[str]:
        """The names of the sliders drawn as grooves."""
        return {guide.name for guide, _ in self.discs}

    def radius(self, pose: Pose, disc: int) -> float:
        """The radius of a disc: up to its furthest point, and to the other centre at least.

        The middle of a square cross moves on the circle through both centres.
        """
        guide, centre = self.discs[disc]
        points = next(bar.points for bar in pose.skeleton.bars if bar.name == guide.on)
        reached = (*points, self.discs[1 - disc][1])
        return max(abs(pose.points[name] - pose.points[centre]) for name in reached)


def couplings(skeleton: Skeleton) -> list[Coupling]:
    """All couplings of a mechanism."""
    points = {bar.name: bar.points for bar in skeleton.bars}
    by_link: dict[str, dict[str, Guide]] = {}
    for guide in skeleton.guides:
        if guide.block:
            by_link.setdefault(guide.link, {}).setdefault(guide.name, guide)
    found = []
    for link, guides in by_link.items():
        carried = [(guide, _centre(skeleton, guide, points)) for guide in guides.values()]
        discs = tuple((guide, centre) for guide, centre in carried if centre is not None)
        free = not set(points.get(link, ())) & set(skeleton.pins)
        if free and len(discs) == len(guides) == 2 == len({guide.on for guide, _ in discs}):
            found.append(Coupling(cross=link, discs=discs))
    return found


def _centre(skeleton: Skeleton, guide: Guide, points: dict[str, tuple[str, ...]]) -> str | None:
    """The fixed pivot of the link with the guide's line, if it is on that line."""
    if guide.offset or guide.on not in points:
        return None
    return next((name for name in guide.line if name in skeleton.fixed), None)


def coupling_symbols(
    found: list[Coupling], pose: Pose, measures: Measures, tone: Mapping[str, int]
) -> Iterator[Primitive]:
    """The discs, their grooves, and the cross."""
    half = 2.0 * measures.pin
    for coupling in found:
        own = next((b.points for b in pose.skeleton.bars if b.name == coupling.cross), ())
        middle = pose.points[coupling.discs[0][0].point]
        sizes = [coupling.radius(pose, k) for k in range(2)]
        reach = max([0.4 * min(sizes), *(abs(pose.points[name] - middle) for name in own)])
        for (guide, name), radius in zip(coupling.discs, sizes, strict=True):
            centre, number = pose.points[name], tone.get(guide.on, 1)
            yield Circle(
                role=Role.WHEEL, of=guide.on, tone=number, centre=xy(centre), radius=radius
            )
        for (guide, name), radius in zip(coupling.discs, sizes, strict=True):
            along = pose.direction(guide)
            groove = _bar(pose.points[name], along, (radius**2 - half**2) ** 0.5, half)
            yield Polygon(role=Role.SLOT, of=guide.name, tone=tone.get(guide.on, 1), points=groove)
        for guide, _ in coupling.discs:
            tongue = _bar(middle, pose.direction(guide), reach, 0.8 * half)
            yield Polygon(role=Role.SLIDER, of=coupling.cross, points=tongue)


def _bar(
    middle: complex, along: complex, reach: float, half: float
) -> tuple[tuple[float, float], ...]:
    """A rectangle about its middle."""
    ends = (-reach - 1j * half, reach - 1j * half, reach + 1j * half, -reach + 1j * half)
    return tuple(xy(middle + along * end) for end in ends)
