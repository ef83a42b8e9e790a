"""Checks of a linkage before it is solved; all problems are reported together."""

from __future__ import annotations

from collections import Counter
from itertools import combinations

from linkwork.foundation.errors import choices
from linkwork.foundation.names import GROUND
from linkwork.mechanism.description import Key, Problems, declared
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.friction_checks import check_friction
from linkwork.mechanism.loaded import check_masses
from linkwork.mechanism.part.index import JoinedBodies
from linkwork.mechanism.part.part import PartChecks, turning_links
from linkwork.mechanism.part.slider import Slider

__all__ = ["check_linkage"]

#: Key, name and points of a link or cylinder.
_Body = tuple[Key, str, tuple[str, ...]]
_SMALLEST = 1e-100  # keeps squares and quotients of lengths finite


def check_linkage(linkage: JoinedBodies, problems: Problems) -> None:
    """Add all problems of the linkage that do not depend on link shapes."""
    linkage.check_common(
        problems,
        [
            *declared("points", linkage.points),
            *declared("links", linkage.links),
            *(((*key, "name"), n) for key, part in linkage.keyed_parts for n in part.names),
        ],
    )
    _check_points(linkage, problems)
    _check_links(linkage, problems)
    _check_shared_points(linkage, problems)
    for key, part in linkage.keyed_parts:
        part.check(PartChecks(linkage, problems, key))
    check_masses(linkage, problems)
    check_friction(linkage, problems)
    _check_guided_once(linkage, problems)
    _check_dimension_keys(linkage, problems)
    _check_inputs(linkage, problems)
    for k, point in enumerate(linkage.trace):
        if point not in linkage.points:
            problems.add(("trace", "points", k), _no_point(linkage, point))


def _no_point(linkage: JoinedBodies, point: str) -> str:
    return f'point "{point}" is not defined {choices("points", linkage.points, point)}'


def _no_link(linkage: JoinedBodies, link: str) -> str:
    return f'link "{link}" is not defined {choices("links", linkage.links, link)}'


def _check_points(linkage: JoinedBodies, problems: Problems) -> None:
    carried = {point for points in linkage.links.values() for point in points}
    # a cylinder's end that nothing else holds would swing freely
    ends = Counter(point for part in linkage.parts for point in part.body)
    # slots and curves do
    ends.update(getattr(part, "point", "") for part in linkage.parts if part.kind is not None)
    carried |= {point for point, count in ends.items() if count > 1}
    if not linkage.points:
        problems.add(("points",), "is empty: name at least the pins of the mechanism")
    for point, coordinates in linkage.points.items():
        if len(coordinates) != 2:
            problems.add(("points", point), f"needs two coordinates, got {len(coordinates)}")
            continue
        for number in coordinates:
            PartChecks(linkage, problems, ("points", point)).length(number)
        if point not in carried:
            problems.add(("points", point), "is on no link: add it to a link or remove it")


def _check_links(linkage: JoinedBodies, problems: Problems) -> None:
    if GROUND not in linkage.links:
        problems.add(("links",), '"ground" is missing: name the fixed link')
    alone = {GROUND} | {slider.link for slider in linkage.of(Slider)}
    alone |= turning_links(linkage)
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


def _check_shared_points(linkage: JoinedBodies, problems: Problems) -> None:
    """Links that share two points are one rigid body; one problem for all that share the same."""
    bodies: list[_Body] = [
        *((("links", link), link, points) for link, points in linkage.links.items()),
        *((key, part.label, part.body) for key, part in linkage.keyed_parts if part.body),
    ]
    carried = Counter(point for _, _, points in bodies for point in set(points))
    shared: dict[tuple[str, str], list[_Body]] = {}
    for body in bodies:
        joints = sorted(point for point in set(body[2]) if carried[point] > 1)
        for pair in combinations(joints, 2):
            shared.setdefault(pair, []).append(body)
    # bodies that share more than two points are met again with every pair
    once: dict[tuple[Key, ...], tuple[tuple[str, str], list[_Body]]] = {}
    for pair, own in shared.items():
        if len(own) > 1:
            once.setdefault(tuple(key for key, _, _ in own), (pair, own))
    for pair, own in once.values():
        links = [body for body in own if body[0][0] == "links"]
        struts = [*links[:1], *own[len(links) :]]
        if len(links) > 1:
            union = ", ".join(dict.fromkeys(point for _, _, points in links for point in points))
            _add_shared(problems, pair, links, f"they move as one body: make one link of {union}")
        if len(struts) > 1:
            _add_shared(problems, pair, struts, "a cylinder between them cannot change its length")


def _add_shared(
    problems: Problems, pair: tuple[str, str], bodies: list[_Body], advice: str
) -> None:
    more = f" and {len(bodies) - 2} more" if len(bodies) > 2 else ""
    key, other = bodies[1][0], bodies[0][1]
    problems.add(key, f'shares {pair[0]} and {pair[1]} with "{other}"{more}: {advice}')


def _check_guided_once(linkage: JoinedBodies, problems: Problems) -> None:
    """A body may guide a point along one line only."""
    first: dict[tuple[str, str], str] = {}
    for key, part in linkage.keyed_parts:
        if part.guided is None:
            continue
        field, point, on = part.guided
        other = first.setdefault((point, on), part.label)
        if other != part.label:
            problems.add(
                (*key, field),
                f'point "{point}" is guided twice by "{on}": "{other}" already guides it along '
                "a line, and a second line would fix it",
            )


def _check_dimension_keys(linkage: JoinedBodies, problems: Problems) -> None:
    links_at: dict[str, set[str]] = {}
    for link, points in linkage.links.items():
        for point in points:
            links_at.setdefault(point, set()).add(link)
    # the message about a misspelt point names its link
    misspelt = not links_at.keys() <= set(linkage.points)
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
            elif not (misspelt or set.intersection(*(links_at.get(name, set()) for name in names))):
                what = "a distance" if count == 2 else "an angle"
                problems.add(
                    key, f"no link carries {' and '.join(names)}: {what} between links varies"
                )
            if table == "angles":
                linkage.numbers.check_number(problems.add, key, number)
                continue
            amount = PartChecks(linkage, problems, key).length(number)
            if amount <= 0:
                problems.add(key, f"must be a positive length, got {amount:g}")
            elif amount < _SMALLEST:
                message = f"{amount:g} is too small: at least {_SMALLEST:g} {linkage.length}"
                problems.add(key, message)


def _check_inputs(linkage: JoinedBodies, problems: Problems) -> None:
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
    linkage: JoinedBodies, which: Input, key: Key, problems: Problems
) -> tuple[str, ...] | None:
    """The driven quantity in comparable form, or ``None`` after a report."""
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
    names = [part.label for part in linkage.parts if part.drive == kind]
    if name not in names:
        known = choices("cylinders" if kind == "cylinder" else "sliders and slots", names, name)
        problems.add((*key, kind), f'{kind} "{name}" is not defined {known}')
        return None
    return (name,)


def _check_angle_input(
    linkage: JoinedBodies, which: Input, key: Key, problems: Problems
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
    linkage: JoinedBodies, joint: str, key: Key, problems: Problems
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
