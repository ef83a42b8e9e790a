"""Marks: second points that give one-point wheels, cams and grounds a direction."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping
from dataclasses import replace

from linkwork.foundation.names import GROUND, canonical, free_name
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.slider import Slider

__all__ = ["directed", "named_in"]


def directed(linkage: Linkage, angles: Mapping[str, float]) -> Linkage:
    """The linkage with a mark on every wheel, cam and ground of one point.

    A mark is a second point, in the direction of the link's angle, so that no angle changes.

    Parameters
    ----------
    angles : Mapping[str, float]
        The angles of links in the sketch [rad]; that of ground is zero.
    """
    blocks = {slider.link for slider in linkage.of(Slider)}
    bare = [
        link
        for link, points in linkage.links.items()
        if len(points) == 1
        and (link == GROUND or (link in linkage.turning_on_one_point and link not in blocks))
    ]
    if not bare:
        return linkage
    taken = set(map(canonical, named_in(linkage)))
    points, links, lengths = dict(linkage.points), dict(linkage.links), dict(linkage.lengths)
    for link in bare:
        (center,) = linkage.links[link]
        mark, size = free_name(f"{link}_mark", taken), _size(linkage, link)
        x, y = linkage.points[center]
        points[mark] = _beside((x, y), cmath.rect(size, angles.get(link, 0.0)))
        links[link] = (center, mark)
        if link != GROUND:
            lengths[f"{center} {mark}"] = size
    return replace(linkage, points=points, links=links, lengths=lengths)


def _size(linkage: Linkage, link: str) -> float:
    """The radius of a wheel or a cam's base circle, otherwise the largest extent of a link."""
    for part in linkage.parts:
        size = part.size_of(link, linkage)
        if size is not None:
            return size
    shapes = linkage.shapes.local.values()
    return (
        max((abs(a - b) for own in shapes for a in own.values() for b in own.values()), default=0.0)
        or 1.0
    )


def _beside(place: tuple[Number, ...], span: complex) -> tuple[Number, ...]:
    """The coordinates of a point that is away from another one."""
    x, y = place
    return _sum(x, span.real), _sum(y, span.imag)


def _sum(x: Number, size: float) -> Number:
    if not size:
        return x
    return f"({x}) + ({size!r})" if isinstance(x, str) else x + size


def named_in(linkage: Linkage) -> Iterator[str]:
    """All names used in a linkage."""
    yield from linkage.points
    yield from linkage.links
    yield from linkage.dimensions
    yield from linkage.outputs
    for part in linkage.parts:
        yield from part.names
