"""Springs, loads and welds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import constants_in
from linkwork.core.expression.values import check_real, value
from linkwork.core.foundation.errors import ExpressionError, undefined
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.precise import Precise
from linkwork.core.foundation.values import Key, ListOf, NumberValue as NumberKey, Text
from linkwork.core.mechanism.bodies import Bodies, Figure, Outlines
from linkwork.core.mechanism.dimensions import LARGEST, Number
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.mechanism.part.part import (
    LINK,
    POINT,
    POINT_PAIR,
    Inversion,
    KinematicPairs,
    NamedPart,
    Pair,
    PairKind,
    Part,
    PartChecks,
    turning_links,
)

# ----------------------------------------------------------------------
# Springs and loads.


# ----------------------------------------------------------------------
# Springs between two points or two links, and dampers: they do not constrain the motion.


@dataclass(frozen=True, kw_only=True)
class SpringFigure(Figure):
    """A spring between two points."""

    over: ClassVar[bool] = True

    between: tuple[str, str]

    @property
    def pins(self) -> tuple[str, ...]:
        return self.between

    @property
    def ends(self) -> tuple[str, ...]:
        return self.between


@dataclass(frozen=True, kw_only=True)
class Spring(NamedPart):
    """A spring between two points, or a torsion spring between two links.

    With a stiffness it pulls by stiffness · (length - free), with a damping by damping · velocity.

    Parameters
    ----------
    name : str
        The name of the spring.
    between : (str, str), optional
        The two points.
    links : (str, str), optional
        Instead of points: the links between which a torsion spring acts; it is not drawn.
    stiffness : number
        Force per length; of a torsion spring torque per radian.
    free : number
        The length, or the angle from the first link to the second, without force.
    damping : number
        Force per velocity; of a torsion spring torque per rad/s.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Spring(name="return", between=("O4", "B")).between
    ('O4', 'B')
    """

    title = "Spring"
    doc = "A spring or damper between two points or links"
    keys = (
        Key("name", Text(), "Name of the spring", required=True),
        Key("between", POINT_PAIR, "The two points it connects"),
        Key("links", ListOf(Text(), "link", 2, 2), "Or the two links of a torsion spring"),
        Key(
            "stiffness", NumberKey("stiffness"), "Force per length, or torque per radian; default 0"
        ),
        Key("free", NumberKey("free"), "Length or angle without force; default 0"),
        Key(
            "damping", NumberKey("stiffness"), "Force per velocity, or torque per rad/s; default 0"
        ),
    )

    between: tuple[str, str] | None = None
    links: tuple[str, str] | None = None
    stiffness: Number = 0
    free: Number = 0
    damping: Number = 0

    @property
    def pulls(self) -> bool:
        """Whether it has a stiffness or a damping."""
        return self.stiffness != 0 or self.damping != 0

    @property
    def acts(self) -> bool:
        return self.pulls

    def check(self, checks: PartChecks) -> None:
        if (self.between is None) == (self.links is None):
            what = "both" if self.links is not None else "neither"
            checks.add(f"needs either two points (between) or two links, it has {what}")
        elif self.between is not None:
            checks.ends(self.between)
            ends = set(self.between)
            alone = next((x for x, on in checks.linkage.links.items() if ends <= {*on}), None)
            if self.pulls and len(ends) == 2 and alone is not None:
                told = f'has both ends on "{alone}", where it does nothing: connect two links'
                checks.add(told, "between")
        elif self.links is not None and checks.two(self.links, "link", "links"):
            for link in self.links:
                checks.link(link, "links")
        for field in ("stiffness", "free", "damping"):
            amount = checks.amount(getattr(self, field), field)
            if amount < 0 and (field != "free" or self.links is None):
                checks.add(f"must not be negative, got {amount:g}", field)

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        if self.between is not None:
            yield SpringFigure(name=self.name, between=self.between)


# ----------------------------------------------------------------------
# Loads: forces on points and torques on links.


@dataclass(frozen=True, kw_only=True)
class Load(Part):
    """A force on a point, or a torque on a link.

    Where several links share the point, the force acts on the pin itself unless a link is given.
    Formulas may contain the mechanism's quantities, their rates and the time ``t``, and
    comparisons, which are 1 or 0: ``"-500*(t < 0.1)"``. A load on ground moves nothing: with its
    opposite on a piston, as of the gas in an engine, it shakes nothing.

    Parameters
    ----------
    point : str, optional
        The point on which a force acts.
    force : (number, number), optional
        Its components along the axes of the ground, or of the link ``turns_with``.
    turns_with : str, optional
        The link in whose frame the components are given (``with`` in a file).
    link : str, optional
        The link on which a torque acts; for a force on a pin, the link at the pin that takes it.
    torque : number, optional
        Positive counter-clockwise [force · length].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Load(point="P", force=(0, "-500*(t < 0.1)")).force
    (0, '-500*(t < 0.1)')
    """

    title = "Load"
    doc = "A force on a point, or a torque on a link"
    keys = (
        Key("point", POINT, "The point on which a force acts"),
        Key("force", ListOf(NumberKey(), "component", 2, 2), "Its components, or formulas of them"),
        Key("with", LINK, "The link with which the force turns", field="turns_with"),
        Key("link", LINK, "The link on which a torque acts, or that takes a force on a pin"),
        Key("torque", NumberKey("length"), "The torque, or a formula; positive counter-clockwise"),
    )

    point: str | None = None
    force: tuple[Number, ...] | None = None
    turns_with: str | None = None
    link: str | None = None
    torque: Number | None = None

    @property
    def acts(self) -> bool:
        return True

    @property
    def label(self) -> str:
        return f"load on {self.point or self.link}"

    def check(self, checks: PartChecks) -> None:
        self.check_in(checks.linkage, checks.add)

    def check_in(self, loaded: LoadedBodies, add: Callable[..., None]) -> None:
        """Report the problems of the load on a mechanism; ``add`` takes a message and a field."""
        if (self.force is None) == (self.torque is None):
            what = "both" if self.force is not None else "neither"
            add(f"needs either a force or a torque, it has {what}")
            return
        on, noun = ("point", "force") if self.torque is None else ("link", "torque")
        for field, given in (("point", self.point), ("with", self.turns_with)):
            if self.torque is not None and given is not None:
                add("is used with force only", field)
        if getattr(self, on) is None:
            add(f"is missing: the {on} on which the {noun} acts", on)
        named = [("point", self.point, loaded.placed)]
        named += [(key, own, loaded.carried) for key, own in
                  (("link", self.link), ("with", self.turns_with))]  # fmt: skip
        for field, name, known in named:
            if name is not None and name not in known:
                add(undefined("point" if field == "point" else "link", name, known), field)
        # beside a load on a moving link it may be that one's opposite, as of the gas in an engine
        others: tuple[Load, ...] = getattr(loaded, "loads", ())
        if all(load._on_ground(loaded) for load in (self, *others)):
            field, what = ("link", "") if self.link == GROUND else ("point", f"{self.point} ")
            add(f"{what}is fixed: the {noun} has no effect, remove it", field)
        if self.turns_with == GROUND:
            add("does not turn: leave it out, as the axes of ground are the default", "with")
        carried = loaded.carried.get(self.link or "", (self.point,))
        if self.force is not None and self.point not in carried:
            add(f'"{self.link}" does not carry {self.point}', "link")
        if self.force is not None and len(self.force) != 2:
            add(f"needs two components, got {len(self.force)}", "force")
        for key, number in self.formulas:
            if not isinstance(number, str):
                loaded.numbers.check_amount(lambda at, told: add(told, *at), key, number)
                continue
            try:
                tree = parse(number, comparing=True)
                check_real(tree, number, "a load")
                for part in constants_in(tree, loaded.numbers.known.keys() | CONSTANTS.keys()):
                    amount = value(part, loaded.numbers.known, loaded.angle, number)
                    if abs(amount) > LARGEST:
                        add(f"{amount:g} is too large: at most {LARGEST:g}", *key)
            except ExpressionError as error:
                add(str(error), *key)

    def _on_ground(self, loaded: LoadedBodies) -> bool:
        return self.link == GROUND or (
            self.link is None and self.point in loaded.carried.get(GROUND, ())
        )

    @property
    def formulas(self) -> tuple[tuple[tuple[str | int, ...], Number], ...]:
        """The components or the torque with their keys."""
        if self.torque is not None:
            return ((("torque",), self.torque),)
        return tuple((("force", k), number) for k, number in enumerate(self.force or ()))


# ----------------------------------------------------------------------
# Weld: two links that share a point and turn together.


@dataclass(frozen=True, kw_only=True)
class RigidJoint(Figure):
    """Two links welded together at a common point."""

    over: ClassVar[bool] = True

    links: tuple[str, str]
    point: str


@dataclass(frozen=True, kw_only=True)
class Weld(Part):
    """A weld: two links share a point and turn together.

    Parameters
    ----------
    links : (str, str)
        The two links.
    angle : number, optional
        Angle from the direction of the first link to that of the second [file's angle unit]; by
        default measured in the sketch.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Weld(links=["pulley", "crank"], angle=0).links
    ('pulley', 'crank')
    """

    title = "Weld"
    doc = "Two links that share a point and rotate together"
    keys = (
        Key("links", ListOf(Text(), "link", 2, 2), "Two links that share a point", required=True),
        Key("angle", NumberKey("angle"), "From the first link's direction to the second's"),
    )

    links: tuple[str, str]
    angle: Number | None = None

    @property
    def label(self) -> str:
        return " ".join(self.links)

    @property
    def mobility(self) -> int:
        """The weld removes the freedom of the pin between its two links."""
        return -1

    def kept_angle(self, linkage: Bodies) -> tuple[str, str, Precise]:
        first, second = self.links
        angle = self.measured_angle(linkage)
        if angle is None:
            angle = linkage.numbers.precise_angle(self.angle or 0)
        return second, first, angle

    def measured_angle(self, linkage: Bodies) -> Precise | None:
        if self.angle is not None:
            return None
        first, second = map(linkage.exact_angle, self.links)
        return second - first

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        first, second = (linkage.links[link] for link in self.links)
        shared = next(point for point in first if point in second)
        name = self.label.replace(" ", "_")
        pair = Pair(kind=PairKind.FIXED, name=name, bodies=self.links, point=shared)
        return KinematicPairs(pairs=(pair,))

    def check(self, checks: PartChecks) -> None:
        if not checks.two(self.links, "link", "links"):
            return
        known = [checks.link(name, "links") for name in self.links]
        if not all(known):
            return
        first, second = (checks.linkage.links[name] for name in self.links)
        if not set(first) & set(second):
            checks.add(
                f"{' and '.join(self.links)} share no point: let both carry the point at which "
                "they are welded",
                "links",
            )
        # their angles are separate unknowns; other links have a direction by two points
        directed = {GROUND, *turning_links(checks.linkage)}
        for name, points in zip(self.links, (first, second), strict=True):
            if len(points) < 2 and name not in directed:
                checks.add(
                    f'"{name}" has only the point {points[0]}, so its direction is not known: '
                    "make one link of both",
                    "links",
                )
        if self.angle is not None:
            checks.number(self.angle, "angle")

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        first, second = (linkage.links[name] for name in self.links)
        shared = next(point for point in first if point in second)
        yield RigidJoint(name=self.label, links=self.links, point=shared)

    def inverted(self, inversion: Inversion) -> Self:
        # the angle follows from the sketch, which is an assembled position
        return replace(super().inverted(inversion), angle=None)
