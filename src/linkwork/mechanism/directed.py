"""Wheels, cams and grounds of one point get a mark, which shows how they are turned."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from linkwork.foundation.names import canonical
from linkwork.mechanism.contact_shapes import ContactShapes
from linkwork.mechanism.contacts import names_of
from linkwork.mechanism.linkage import GROUND, Linkage
from linkwork.mechanism.parts import Number

__all__ = ["directed", "free_name", "named_in"]

_CONTACTS = ("gears", "belts", "racks", "rolling", "cams", "curves")


def directed(linkage: Linkage) -> Linkage:
    """The linkage whose wheels, cams and ground have a direction: those of one point get a mark.

    A mark is a second point. In the sketch it lies beside the first one in the direction of the x
    axis, from which the angle of a link of one point is counted: all angles stay what they are.
    """
    blocks = {slider.link for slider in linkage.sliders}
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
        points[mark] = (_sum(x, size), y)
        links[link] = (center, mark)
        if link != GROUND:
            lengths[f"{center} {mark}"] = size
    return replace(linkage, points=points, links=links, lengths=lengths)


def _size(linkage: Linkage, link: str) -> float:
    """The radius of a wheel or of a cam's base circle, else the largest extent of a link."""
    numbers = linkage.numbers
    for disc in ContactShapes.of(linkage, {}).discs:
        if disc.link == link:
            return disc.radius
    for cam in linkage.cams:
        if cam.cam == link and cam.base is not None:
            return numbers(cam.base)
        if cam.cam == link:
            return abs(complex(*map(numbers, cam.profile[0])))
    shapes = linkage.shapes.local.values()
    return (
        max((abs(a - b) for own in shapes for a in own.values() for b in own.values()), default=0.0)
        or 1.0
    )


def _sum(x: Number, size: float) -> Number:
    return f"({x}) + ({size!r})" if isinstance(x, str) else x + size


def named_in(linkage: Linkage) -> Iterator[str]:
    """Every name that a linkage uses."""
    yield from linkage.points
    yield from linkage.links
    yield from linkage.dimensions
    yield from linkage.outputs
    yield from (slot.name for slot in linkage.slots)
    yield from (slider.name for slider in linkage.sliders)
    for kind in _CONTACTS:
        for part in getattr(linkage, kind):
            yield from names_of(part)
    for cylinder in linkage.cylinders:
        yield from (cylinder.name, cylinder.angle_name)


def free_name(name: str, taken: set[str]) -> str:
    """A name that nothing has yet, from now on taken (canonical names)."""
    found, k = name, 1
    while canonical(found) in taken:
        found, k = f"{name}{k}", k + 1
    taken.add(canonical(found))
    return found
