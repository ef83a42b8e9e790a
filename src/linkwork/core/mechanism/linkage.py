"""Checks of friction: where it acts, and the sizes that it needs there."""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import combinations, pairwise
from typing import Any, Self

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import ExpressionError, choices, undefined
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.mechanism.bodies import Measured, Shapes
from linkwork.core.mechanism.description import Key, Problems, check_entries, declared
from linkwork.core.mechanism.dimensions import LARGEST
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.link_shape import link_shapes
from linkwork.core.mechanism.machine import Friction, check_masses
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.mechanism.part.index import PARTS, JoinedBodies
from linkwork.core.mechanism.part.part import Part, PartChecks, carriers, turning_links


def check_friction(linkage: JoinedBodies, problems: Problems) -> None:
    """Report friction of what is no joint, and missing or wrong sizes."""
    parts = {part.label: part for part in linkage.parts if part.names}
    for name, friction in linkage.friction.items():
        checks = PartChecks(linkage, problems, ("friction", name))
        if name in linkage.points:
            # cylinders push along their axis only, and have no friction at their pins
            if len(list(linkage.bodies_at(name))) < 2:
                checks.add("is no pin of two links: friction needs a joint that moves")
                continue
            noun = "a pin"
            takes: tuple[str, ...] = ("radius",)
        elif name in parts:
            part = parts[name]
            noun = f"a {part.title[0].lower()}{part.title[1:]}"
            if part.friction_sizes is None:
                checks.add(f"{noun} has no friction of its own: give it to pins and guides")
                continue
            takes = part.friction_sizes
        else:
            checks.add(f"is neither a pin nor a part {choices('names', [*linkage.points, *parts])}")
            continue
        amount = checks.amount(friction.mu, "mu")
        if amount < 0.0:
            checks.add(f"must not be negative, got {amount:g}", "mu")
        for size in ("radius", "length"):
            given = getattr(friction, size)
            if given is not None and size not in takes:
                checks.add(f"the friction of {noun} does not depend on it: leave it out", size)
            elif given is not None:
                checks.positive(given, "length", size)
            elif size == "radius" and size in takes:
                example = f"{name} = {{ mu = 0.1, radius = 5 }}"
                checks.add(f"is missing: the friction of {noun} needs it, as in {example}", size)


# ----------------------------------------------------------------------
# Checks of a linkage before it is solved; all problems are reported together.


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
            problems.add(("trace", "points", k), undefined("point", point, linkage.points))


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
            PartChecks(linkage, problems, ("points", point)).amount(number)
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
                problems.add(key, undefined("point", point, linkage.points))
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
                problems.add(key, undefined("point", missing[0], linkage.points))
            elif not (misspelt or set.intersection(*(links_at.get(name, set()) for name in names))):
                what = "a distance" if count == 2 else "an angle"
                problems.add(
                    key, f"no link carries {' and '.join(names)}: {what} between links varies"
                )
            if table == "angles":
                linkage.numbers.check_number(problems.add, key, number)
                continue
            amount = PartChecks(linkage, problems, key).amount(number)
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
    for key_word, name in (("link", link), ("relative_to", against)):
        if name not in linkage.links:
            problems.add((*key, key_word), undefined("link", name, linkage.links))
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
        problems.add((*key, "joint"), undefined("point", joint, linkage.points))
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


# ----------------------------------------------------------------------
# Points, links and parts that need not be a mechanism yet, with what they lack.


@dataclass(frozen=True, kw_only=True)
class Draft(JoinedBodies):
    """Points, links and parts under construction.

    Fields as of :class:`~linkwork.core.mechanism.linkage.Linkage`, which has no problems.
    """

    #: All that keeps the draft from being a linkage.
    problems: Problems = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        set_ = object.__setattr__
        for table, kind in PARTS.items():
            check_entries(table, kind, getattr(self, table))
        check_entries("friction", Friction, self.friction.values())
        own = [name for part in self.parts if (name := getattr(part, "name", ""))]
        named = (*self.points, *self.links, *own)
        find_spelling = {canonical(name): name for name in named}

        def same(name: str) -> str:
            return str(find_spelling.get(canonical(name), name))

        set_(self, "points", FrozenDict({n: tuple(p) for n, p in self.points.items()}))
        links = {name: tuple(map(same, points)) for name, points in self.links.items()}
        set_(self, "links", FrozenDict(links))
        set_(self, "masses", self.spelled_masses())
        set_(self, "clearances", FrozenDict({same(p): c for p, c in self.clearances.items()}))
        rubbing = {same(name): friction for name, friction in self.friction.items()}
        set_(self, "friction", FrozenDict(rubbing))
        for which in ("lengths", "angles"):
            table = getattr(self, which)
            folded = {" ".join(map(same, key.split())): number for key, number in table.items()}
            set_(self, which, FrozenDict(folded if len(folded) == len(table) else table))
        for table in PARTS:
            entries: tuple[Part, ...] = getattr(self, table)
            set_(self, table, tuple(part.find_spelling(same) for part in entries))
        for kept in ("parts", "keyed_parts"):
            self.__dict__.pop(kept, None)
        inputs = tuple(_spelled_input(driven, same) for driven in self.inputs)
        set_(self, "inputs", inputs)
        set_(self, "trace", tuple(map(same, self.trace)))
        self._examine()

    def _examine(self) -> None:
        """Find the problems and the shapes of the links."""
        problems = Problems()
        object.__setattr__(self, "problems", problems)
        check_linkage(self, problems)
        object.__setattr__(self, "shapes", Shapes() if problems else link_shapes(self, problems))
        if not problems:
            for key, part in self.keyed_parts:
                part.check_shapes(PartChecks(self, problems, key))

    def with_tables(self, tables: Mapping[str, Any]) -> Self:
        """A copy with other numbers under the same names in some tables, examined.

        Names keep their spelling and entries their types, which ``replace`` would check again.
        """
        copy = object.__new__(type(self))
        # without what was computed from the numbers and kept
        kept = {part.name: getattr(self, part.name) for part in fields(self)}
        copy.__dict__.update({**kept, **tables})
        copy._examine()
        return copy

    @property
    def turning_on_one_point(self) -> frozenset[str]:
        """Links that may have one point only: wheels and cams."""
        return turning_links(self)

    def carriers(self) -> dict[str, list[str]]:
        """The links and cylinders at every point, in the file's order."""
        return carriers(self)

    @cached_property
    def measured(self) -> tuple[Measured, ...]:
        """Lengths that are not given; of a draft, those between neighbouring points of links."""
        if not self.problems:
            return self.shapes.measured
        draft = self.drawable
        given = {frozenset(key.split()) for key in self.lengths}
        return tuple(
            Measured(link=link, points=(a, b), length=abs(draft.sketched(b) - draft.sketched(a)))
            for link, points in draft.links.items()
            for a, b in pairwise(points)
            if link != GROUND and frozenset((a, b)) not in given
        )

    @cached_property
    def drawable(self) -> Draft:
        """The points with coordinates, and the links and parts that exist between them, shaped as
        sketched.
        """
        points = {name: place for name, place in self.points.items() if self._is_placed(name)}
        links = {
            name: tuple(dict.fromkeys(point for point in carried if point in points))
            for name, carried in {GROUND: (), **self.links}.items()
        }
        kept: dict[str, object] = {
            "points": points,
            "links": {name: own for name, own in links.items() if own or name == GROUND},
            "trace": tuple(point for point in self.trace if point in points),
        }
        inputs = enumerate(self.inputs)
        kept["inputs"] = tuple(i for k, i in inputs if not self._lacks(self.input_key(k)))
        for table in PARTS:
            parts = enumerate(getattr(self, table))
            kept[table] = tuple(part for k, part in parts if not self._lacks((table, k)))
        found = replace(self, **kept)  # type: ignore[arg-type]
        # what is left may refer to a part that was left out
        keys = [key for key, _ in found.keyed_parts]
        keys += map(found.input_key, range(len(found.inputs)))
        if any(map(found._lacks, keys)):
            return found.drawable
        object.__setattr__(found, "shapes", Shapes(local=dict(found._sketched_shapes())))
        return found

    def _sketched_shapes(self) -> Iterator[tuple[str, Mapping[str, complex]]]:
        for link, points in self.links.items():
            origin = 0j if link == GROUND else self.sketched(points[0])
            span = 1.0 if link == GROUND else self.sketched(points[:2][-1]) - origin
            turn = cmath.exp(-1j * phase(span))
            yield link, {point: (self.sketched(point) - origin) * turn for point in points}

    def _lacks(self, key: Key) -> bool:
        """Whether there is a problem below a key path."""
        return any(problem.key[: len(key)] == key for problem in self.problems)

    def _is_placed(self, point: str) -> bool:
        place = self.points[point]
        try:
            return len(place) == 2 and all(abs(self.numbers(c)) <= LARGEST for c in place)
        except ExpressionError:
            return False


def _spelled_input(which: Input, same: Callable[[str], str]) -> Input:
    changes: dict[str, Any] = {
        field: same(name)
        for field in ("link", "joint", "slider", "cylinder", "relative_to")
        if (name := getattr(which, field)) is not None and same(name) != name
    }
    return replace(which, **changes) if changes else which


# ----------------------------------------------------------------------
# Form A: a mechanism described by its points and links.


@dataclass(frozen=True, kw_only=True)
class Linkage(Draft):
    """Points, links and inputs.

    Links that share a point are pinned there. The link ``ground`` is fixed.

    Parameters
    ----------
    points : Mapping[str, (x, y)]
        One assembled position: exact on ground, elsewhere exact or a sketch that selects sides.
    links : Mapping[str, sequence of str]
        The points of each link; its angle is the direction from the first to the second.
    lengths : Mapping[str, number]
        Exact distances, ``"A B"``, between two points of one link.
    angles : Mapping[str, number]
        Exact angles in a link: ``"B A P"`` at A, from AB to AP, counter-clockwise.
    sketch : bool
        If true, dimensions are never measured from ``points``.
    clearances : Mapping[str, number]
        How far pins can move in their holes, by point: the difference of the radii.
    mass, force, gravity, masses
        Units of masses and forces, gravity, and the masses of links; see
        :class:`~linkwork.core.mechanism.machine.LoadedBodies`.
    slots, sliders, … : tuples of parts
        One field for each table of parts, see :mod:`linkwork.core.mechanism.part.index`.
    """

    def _examine(self) -> None:
        super()._examine()
        self.problems.raise_any(f'mechanism "{self.name}"')
