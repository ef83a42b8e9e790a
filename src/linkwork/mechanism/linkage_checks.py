"""What can be wrong with a linkage, found before anything is solved and reported together."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations
from typing import TYPE_CHECKING

from linkwork.foundation.errors import choices
from linkwork.mechanism.description import Problems
from linkwork.mechanism.parts import Cylinder, Input, Slider, Slot
from linkwork.mechanism.shape import Shapes

if TYPE_CHECKING:
    from linkwork.mechanism.linkage import Linkage

__all__ = ["check_linkage"]

Key = tuple[str | int, ...]
GROUND = "ground"


def check_linkage(linkage: Linkage, problems: Problems) -> None:
    """Add every problem of the linkage to ``problems``."""
    parts = [*linkage.slots, *linkage.sliders, *linkage.cylinders]
    linkage.check_common(
        problems,
        {
            "points": linkage.points,
            "links": linkage.links,
            "slots, sliders and cylinders": [part.name for part in parts],
        },
    )
    _check_points(linkage, problems)
    _check_links(linkage, problems)
    _check_shared_points(linkage, problems)
    for k, slot in enumerate(linkage.slots):
        _check_slot(linkage, slot, ("slots", k), problems)
    for k, slider in enumerate(linkage.sliders):
        _check_slider(linkage, slider, ("sliders", k), problems)
    for k, cylinder in enumerate(linkage.cylinders):
        _check_cylinder(linkage, cylinder, ("cylinders", k), problems)
    _check_dimension_keys(linkage, problems)
    _check_inputs(linkage, problems)
    for k, point in enumerate(linkage.trace):
        if point not in linkage.points:
            problems.add(("trace", "points", k), _no_point(linkage, point))
    if not problems:
        Shapes.of(linkage, problems)


def _no_point(linkage: Linkage, point: str) -> str:
    return f'point "{point}" is not defined {choices("points", linkage.points, point)}'


def _no_link(linkage: Linkage, link: str) -> str:
    return f'link "{link}" is not defined {choices("links", linkage.links, link)}'


def _check_points(linkage: Linkage, problems: Problems) -> None:
    carried = {point for points in linkage.links.values() for point in points}
    carried |= {point for cylinder in linkage.cylinders for point in cylinder.between}
    if not linkage.points:
        problems.add(("points",), "is empty: name at least the pins of the mechanism")
    for point, coordinates in linkage.points.items():
        if len(coordinates) != 2:
            problems.add(("points", point), f"needs two coordinates, got {len(coordinates)}")
            continue
        for number in coordinates:
            linkage.numbers.check_number(problems.add, ("points", point), number)
        if point not in carried:
            problems.add(("points", point), "is on no link: add it to a link or remove it")


def _check_links(linkage: Linkage, problems: Problems) -> None:
    if GROUND not in linkage.links:
        problems.add(("links",), '"ground" is missing: the link that stands still')
    alone = {GROUND} | {slider.link for slider in linkage.sliders}
    for link, points in linkage.links.items():
        key = ("links", link)
        for point in points:
            if point not in linkage.points:
                problems.add(key, _no_point(linkage, point))
        repeated = {point for point in points if points.count(point) > 1}
        if repeated:
            problems.add(key, f"names {', '.join(sorted(repeated))} more than once")
        if not points:
            problems.add(key, "has no points")
        elif len(points) == 1 and link not in alone:
            problems.add(
                key, f"has only the point {points[0]}: a link needs two points, unless it slides"
            )


def _check_shared_points(linkage: Linkage, problems: Problems) -> None:
    """Two links that share two points are one rigid body."""
    seen: dict[tuple[str, str], str] = {}
    reported: set[tuple[str, str]] = set()
    bodies = [(("links", link), link, points) for link, points in linkage.links.items()]
    bodies += [(("cylinders", k), c.name, c.between) for k, c in enumerate(linkage.cylinders)]
    for key, body, points in bodies:
        for pair in combinations(sorted(set(points)), 2):
            other = seen.setdefault(pair, body)
            if other == body or (other, body) in reported:
                continue
            reported.add((other, body))
            a, b = pair
            advice = (
                "a cylinder between them cannot change its length"
                if key[0] == "cylinders"
                else f"they move as one: make one link of {', '.join(_union(linkage, other, points))}"
            )
            problems.add(key, f'shares {a} and {b} with "{other}": {advice}')


def _union(linkage: Linkage, other: str, points: Iterable[str]) -> list[str]:
    return list(dict.fromkeys([*linkage.links.get(other, ()), *points]))


def _check_line(
    linkage: Linkage, on: str, line: tuple[str, ...], key: Key, problems: Problems
) -> None:
    if on not in linkage.links:
        problems.add((*key, "on"), _no_link(linkage, on))
        return
    if len(line) != 2:
        problems.add((*key, "line"), f"needs two points, got {len(line)}")
        return
    for point in line:
        if point not in linkage.points:
            problems.add((*key, "line"), _no_point(linkage, point))
        elif point not in linkage.links[on]:
            problems.add(
                (*key, "line"),
                f'point "{point}" is not on link "{on}" {choices("points", linkage.links[on])}',
            )
    if line[0] == line[1]:
        problems.add((*key, "line"), f"needs two different points, got {line[0]} twice")


def _check_slot(linkage: Linkage, slot: Slot, key: Key, problems: Problems) -> None:
    _check_line(linkage, slot.on, slot.line, key, problems)
    if slot.point not in linkage.points:
        problems.add((*key, "point"), _no_point(linkage, slot.point))
    elif slot.point in linkage.links.get(slot.on, ()):
        problems.add(
            (*key, "point"), f'point "{slot.point}" is fixed on "{slot.on}" and cannot run in its slot'
        )


def _check_slider(linkage: Linkage, slider: Slider, key: Key, problems: Problems) -> None:
    _check_line(linkage, slider.on, slider.line, key, problems)
    if slider.link not in linkage.links:
        problems.add((*key, "link"), _no_link(linkage, slider.link))
        return
    if slider.link == GROUND:
        problems.add((*key, "link"), "ground cannot slide: name the moving link, with on = ground")
    if slider.link == slider.on:
        problems.add((*key, "on"), f'"{slider.link}" cannot slide on itself')
    if len(slider.points) not in (1, 2):
        problems.add((*key, "points"), f"needs one or two points, got {len(slider.points)}")
    for point in slider.points:
        if point not in linkage.points:
            problems.add((*key, "points"), _no_point(linkage, point))
        elif point not in linkage.links[slider.link]:
            own = choices("points", linkage.links[slider.link])
            problems.add((*key, "points"), f'point "{point}" is not on link "{slider.link}" {own}')
    if len(set(slider.points)) < len(slider.points):
        problems.add((*key, "points"), f"names {slider.points[0]} twice")
    if len(slider.points) == 2 and slider.angle is not None:
        problems.add((*key, "angle"), "is already given by the two points: leave one of them out")
    linkage.numbers.check_number(problems.add, (*key, "offset"), slider.offset)
    if slider.angle is not None:
        linkage.numbers.check_number(problems.add, (*key, "angle"), slider.angle)


def _check_cylinder(linkage: Linkage, cylinder: Cylinder, key: Key, problems: Problems) -> None:
    if len(set(cylinder.between)) != 2:
        problems.add((*key, "between"), "needs two different points")
    for point in cylinder.between:
        if point not in linkage.points:
            problems.add((*key, "between"), _no_point(linkage, point))


def _check_dimension_keys(linkage: Linkage, problems: Problems) -> None:
    for table, count in (("lengths", 2), ("angles", 3)):
        for text, number in getattr(linkage, table).items():
            key = (table, text)
            names = text.split()
            wanted = "two points" if count == 2 else "three points"
            if len(names) != count or len(set(names)) != count:
                problems.add(key, f'the key names {wanted} of one link, as in "{"O2 A P"[: 3 * count - 2]}"')
                continue
            missing = [name for name in names if name not in linkage.points]
            if missing:
                problems.add(key, _no_point(linkage, missing[0]))
            elif not any(set(names) <= set(points) for points in linkage.links.values()):
                problems.add(key, f"no link carries {' and '.join(names)}: a distance between links varies")
            amount = linkage.numbers.check_number(problems.add, key, number)
            if table == "lengths" and amount <= 0:
                problems.add(key, f"must be a positive length, got {amount:g}")


def _check_inputs(linkage: Linkage, problems: Problems) -> None:
    driven: dict[tuple[str, ...], Key] = {}
    for k, which in enumerate(linkage.inputs):
        key = linkage.input_key(k)
        given = [f for f in ("link", "joint", "slider", "cylinder", "variable") if getattr(which, f)]
        if len(given) != 1:
            what = " and ".join(given) or "nothing"
            problems.add(key, f"must drive one of link, joint, slider, cylinder; it names {what}")
            continue
        quantity = _check_input(linkage, which, key, problems)
        if quantity is None:
            continue
        if quantity in driven:
            problems.add(key, f"drives {_quantity_text(quantity)} a second time")
        driven[quantity] = key


def _quantity_text(quantity: tuple[str, ...]) -> str:
    return " against ".join(f'"{name}"' for name in quantity)


def _check_input(
    linkage: Linkage, which: Input, key: Key, problems: Problems
) -> tuple[str, ...] | None:
    """The driven quantity in a comparable form, or ``None`` after reporting."""
    kind, name = which.drives
    if which.relative_to is not None and kind != "link":
        problems.add((*key, "relative_to"), "goes with link only")
        return None
    if kind == "variable":
        problems.add((*key, kind), "belongs to [loops] and [equations]: use link, slider or cylinder")
        return None
    if kind == "link":
        return _check_angle_input(linkage, which, key, problems)
    if kind == "joint":
        return _check_joint_input(linkage, name, key, problems)
    parts = linkage.cylinders if kind == "cylinder" else (*linkage.sliders, *linkage.slots)
    if name not in [part.name for part in parts]:
        known = choices("cylinders" if kind == "cylinder" else "sliders", [p.name for p in parts], name)
        problems.add((*key, kind), f'{kind} "{name}" is not defined {known}')
        return None
    return (name,)


def _check_angle_input(
    linkage: Linkage, which: Input, key: Key, problems: Problems
) -> tuple[str, ...] | None:
    link, against = which.link or "", which.relative_to or GROUND
    for field, name in (("link", link), ("relative_to", against)):
        if name not in linkage.links:
            problems.add((*key, field), _no_link(linkage, name))
            return None
    if link == GROUND:
        problems.add((*key, "link"), "ground stands still: drive another link")
        return None
    if link == against:
        problems.add((*key, "relative_to"), f'"{link}" has no angle against itself')
        return None
    return tuple(sorted((link, against)))


def _check_joint_input(
    linkage: Linkage, joint: str, key: Key, problems: Problems
) -> tuple[str, ...] | None:
    if joint not in linkage.points:
        problems.add((*key, "joint"), _no_point(linkage, joint))
        return None
    links = list(linkage.bodies_at(joint))
    if len(links) != 2:
        problems.add(
            (*key, "joint"),
            f"{joint} joins {len(links)} link{'s' if len(links) != 1 else ''} "
            f"({', '.join(links)}): name two of them with link and relative_to",
        )
        return None
    return tuple(sorted(links))
