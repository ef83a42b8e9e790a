"""What can be wrong with a linkage, found before anything is solved and reported together."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations
from typing import TYPE_CHECKING

from linkwork.foundation.errors import choices
from linkwork.foundation.names import GROUND
from linkwork.mechanism.contact_checks import check_contacts
from linkwork.mechanism.contacts import names_of
from linkwork.mechanism.description import Problems, declared
from linkwork.mechanism.parts import Input, Number, Slider, Slot
from linkwork.mechanism.shape import Shapes
from linkwork.mechanism.wheel_checks import check_distances

if TYPE_CHECKING:
    from linkwork.mechanism.linkage import Linkage

__all__ = ["check_linkage"]

Key = tuple[str | int, ...]
_LARGEST = 1e100  # so that squares and quotients of lengths stay numbers
_SMALLEST = 1e-100


def check_linkage(linkage: Linkage, problems: Problems) -> Shapes:
    """Add every problem of the linkage to ``problems``; the links' shapes if there is none."""
    linkage.check_common(
        problems,
        [
            *declared("points", linkage.points),
            *declared("links", linkage.links),
            *((("slots", k, "name"), slot.name) for k, slot in enumerate(linkage.slots)),
            *((("sliders", k, "name"), part.name) for k, part in enumerate(linkage.sliders)),
            *((("cylinders", k, "name"), part.name) for k, part in enumerate(linkage.cylinders)),
            *(
                (("cylinders", k, "name"), part.angle_name)
                for k, part in enumerate(linkage.cylinders)
            ),
            *((("springs", k, "name"), part.name) for k, part in enumerate(linkage.springs)),
            *(
                ((kind, k, "name"), name)
                for kind in ("gears", "belts", "racks", "rolling", "cams", "curves")
                for k, part in enumerate(getattr(linkage, kind))
                for name in names_of(part)
            ),
        ],
    )
    _check_points(linkage, problems)
    _check_links(linkage, problems)
    _check_shared_points(linkage, problems)
    for k, slot in enumerate(linkage.slots):
        _check_slot(linkage, slot, ("slots", k), problems)
    for k, slider in enumerate(linkage.sliders):
        _check_slider(linkage, slider, ("sliders", k), problems)
    _check_guided_once(linkage, problems)
    for k, cylinder in enumerate(linkage.cylinders):
        _check_ends(linkage, cylinder.between, ("cylinders", k, "between"), problems)
    for k, spring in enumerate(linkage.springs):
        _check_ends(linkage, spring.between, ("springs", k, "between"), problems)
    check_contacts(linkage, problems)
    _check_dimension_keys(linkage, problems)
    _check_inputs(linkage, problems)
    for k, point in enumerate(linkage.trace):
        if point not in linkage.points:
            problems.add(("trace", "points", k), _no_point(linkage, point))
    shapes = Shapes() if problems else Shapes.of(linkage, problems)
    if not problems:
        check_distances(linkage, shapes, problems)
    return shapes


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
            _check_length(linkage, number, ("points", point), problems)
        if point not in carried:
            problems.add(("points", point), "is on no link: add it to a link or remove it")


def _check_length(linkage: Linkage, number: Number, key: Key, problems: Problems) -> float:
    """A length or coordinate whose square is a number too."""
    amount = linkage.numbers.check_number(problems.add, key, number)
    if abs(amount) > _LARGEST:
        problems.add(key, f"{amount:g} is too large: at most {_LARGEST:g} {linkage.length}")
    return amount


def _check_links(linkage: Linkage, problems: Problems) -> None:
    if GROUND not in linkage.links:
        problems.add(("links",), '"ground" is missing: name the fixed link')
    alone = {GROUND} | {slider.link for slider in linkage.sliders}
    alone |= linkage.turning_on_one_point
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
                key,
                f"has only the point {points[0]}: a link needs two points, "
                "unless it slides or is a wheel",
            )


def _check_shared_points(linkage: Linkage, problems: Problems) -> None:
    """Two links that share two points are one rigid body."""
    bodies: list[tuple[Key, str, tuple[str, ...]]] = [
        *((("links", link), link, points) for link, points in linkage.links.items()),
        *((("cylinders", k), c.name, c.between) for k, c in enumerate(linkage.cylinders)),
    ]
    carriers: dict[str, list[int]] = {}
    for k, (_, _, points) in enumerate(bodies):
        for point in sorted(set(points)):
            carriers.setdefault(point, []).append(k)
    shared: dict[tuple[int, int], list[str]] = {}
    for point in sorted(carriers):
        for pair in combinations(carriers[point], 2):
            shared.setdefault(pair, []).append(point)
    for (first, second), common in sorted(shared.items(), key=lambda item: item[0][::-1]):
        if len(common) < 2:
            continue
        key, _, points = bodies[second]
        other = bodies[first][1]
        advice = (
            "a cylinder between them cannot change its length"
            if key[0] == "cylinders"
            else f"they move as one body: make one link of {_union(linkage, other, points)}"
        )
        problems.add(key, f'shares {common[0]} and {common[1]} with "{other}": {advice}')


def _union(linkage: Linkage, other: str, points: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys([*linkage.links.get(other, ()), *points]))


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
            (*key, "point"),
            f'point "{slot.point}" is fixed on "{slot.on}" and cannot move in its slot',
        )


def _check_guided_once(linkage: Linkage, problems: Problems) -> None:
    """A point has one place in a body: on one line of it."""
    guides = [
        *((("slots", k, "point"), s.name, s.point, s.on) for k, s in enumerate(linkage.slots)),
        *(
            (("sliders", k, "points"), s.name, s.points[0], s.on)
            for k, s in enumerate(linkage.sliders)
            if s.points
        ),
        *(
            (("rolling", k, "center"), part.name, part.center, part.on)
            for k, part in enumerate(linkage.rolling)
            if part.line is not None
        ),
    ]
    first: dict[tuple[str, str], str] = {}
    for key, name, point, on in guides:
        other = first.setdefault((point, on), name)
        if other != name:
            problems.add(
                key,
                f'point "{point}" is guided twice by "{on}": "{other}" already guides it along '
                "a line, and a second line would fix it",
            )


def _check_slider(linkage: Linkage, slider: Slider, key: Key, problems: Problems) -> None:
    _check_line(linkage, slider.on, slider.line, key, problems)
    if slider.link not in linkage.links:
        problems.add((*key, "link"), _no_link(linkage, slider.link))
        return
    if slider.link == slider.on:
        problems.add((*key, "on"), f'"{slider.link}" cannot slide on itself')
    if len(slider.points) not in (1, 2):
        problems.add((*key, "points"), f"needs one or two points, got {len(slider.points)}")
    for point in slider.points:
        if point not in linkage.points:
            problems.add((*key, "points"), _no_point(linkage, point))
        elif slider.link != slider.on and point in linkage.links.get(slider.on, ()):
            message = f'point "{point}" is fixed on "{slider.on}" and cannot slide on it'
            problems.add((*key, "points"), message)
        elif point not in linkage.links[slider.link]:
            own = choices("points", linkage.links[slider.link])
            problems.add((*key, "points"), f'point "{point}" is not on link "{slider.link}" {own}')
    if len(set(slider.points)) < len(slider.points):
        problems.add((*key, "points"), f"names {slider.points[0]} twice")
    if len(slider.points) == 2 and slider.angle is not None:
        problems.add((*key, "angle"), "is already given by the two points: leave one of them out")
    _check_length(linkage, slider.offset, (*key, "offset"), problems)
    if slider.angle is not None:
        linkage.numbers.check_number(problems.add, (*key, "angle"), slider.angle)


def _check_ends(linkage: Linkage, between: tuple[str, ...], key: Key, problems: Problems) -> None:
    """The two points of a cylinder or spring."""
    if len(set(between)) > 2 or len(between) < 2:
        problems.add(key, f"needs two points, got {len(between)}")
    elif len(set(between)) == 1:
        problems.add(key, f"needs two different points, got {between[0]} twice")
    for point in between:
        if point not in linkage.points:
            problems.add(key, _no_point(linkage, point))


def _check_dimension_keys(linkage: Linkage, problems: Problems) -> None:
    links_at: dict[str, set[str]] = {}
    for link, points in linkage.links.items():
        for point in points:
            links_at.setdefault(point, set()).add(link)
    for table, count in (("lengths", 2), ("angles", 3)):
        for text, number in getattr(linkage, table).items():
            key = (table, text)
            names = text.split()
            if len(names) != count or len(set(names)) != count:
                wanted = "two points" if count == 2 else "three points"
                example = "O2 A" if count == 2 else "O2 A P"
                problems.add(key, f'the key must name {wanted} of one link, as in "{example}"')
                continue
            missing = [name for name in names if name not in linkage.points]
            if missing:
                problems.add(key, _no_point(linkage, missing[0]))
            elif not set.intersection(*(links_at.get(name, set()) for name in names)):
                what = "a distance" if count == 2 else "an angle"
                problems.add(
                    key, f"no link carries {' and '.join(names)}: {what} between links varies"
                )
            if table == "angles":
                linkage.numbers.check_number(problems.add, key, number)
                continue
            amount = _check_length(linkage, number, key, problems)
            if amount <= 0:
                problems.add(key, f"must be a positive length, got {amount:g}")
            elif amount < _SMALLEST:
                message = f"{amount:g} is too small: at least {_SMALLEST:g} {linkage.length}"
                problems.add(key, message)


def _check_inputs(linkage: Linkage, problems: Problems) -> None:
    driven: dict[tuple[str, ...], Key] = {}
    for k, which in enumerate(linkage.inputs):
        key = linkage.input_key(k)
        kinds = ("link", "joint", "slider", "cylinder", "variable")
        given = [kind for kind in kinds if getattr(which, kind) is not None]
        if len(given) != 1:
            what = " and ".join(given) or "none of them"
            problems.add(key, f"must name one of link, joint, slider, cylinder; it has {what}")
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
        problems.add((*key, "relative_to"), "is used with link only")
        return None
    if kind == "variable":
        message = "belongs to [loops] and [equations]: use link, slider or cylinder"
        problems.add((*key, kind), message)
        return None
    if kind == "link":
        return _check_angle_input(linkage, which, key, problems)
    if kind == "joint":
        return _check_joint_input(linkage, name, key, problems)
    if kind == "cylinder":
        names = [part.name for part in linkage.cylinders]
    else:
        names = [part.name for part in linkage.sliders]
        names += [part.name for part in linkage.slots]
        names += [part.name for part in linkage.rolling if part.line is not None]
        names += [part.name for part in linkage.curves if not part.closed]
    if name not in names:
        known = choices("cylinders" if kind == "cylinder" else "sliders and slots", names, name)
        problems.add((*key, kind), f'{kind} "{name}" is not defined {known}')
        return None
    return (name,)


def _check_angle_input(
    linkage: Linkage, which: Input, key: Key, problems: Problems
) -> tuple[str, ...] | None:
    link, against = which.link or "", which.relative_to or GROUND
    if GROUND not in linkage.links and against == GROUND:
        return None  # reported at [links]
    for field, name in (("link", link), ("relative_to", against)):
        if name not in linkage.links:
            problems.add((*key, field), _no_link(linkage, name))
            return None
    if link == GROUND:
        problems.add((*key, "link"), "ground is fixed: drive another link")
        return None
    if link == against:
        problems.add((*key, "relative_to"), f'"{link}" has no angle relative to itself')
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
