"""Gears, belts, racks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.core.foundation.errors import choices
from linkwork.core.foundation.lanes import largest
from linkwork.core.foundation.values import Flag, Key, ListOf, NumberValue as NumberKey, Text
from linkwork.core.mechanism.bodies import Bodies, DiscFigure, Figure, Mesh, Outlines
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.mechanism.part.part import (
    AGREE,
    LINK,
    NUMBER_PAIR,
    POINT,
    SLIDER,
    Coupling,
    Inversion,
    JointKind,
    KinematicPairs,
    NamedPart,
    PartChecks,
    meshing,
)

# ----------------------------------------------------------------------
# Parts with teeth, whose force is inclined by the pressure angle.


_USUAL = math.radians(20.0)  # ISO 53
_STEEPEST = math.radians(45.0)

PRESSURE_KEY = Key(
    "pressure_angle",
    NumberKey("angle"),
    "Pressure angle of the teeth, for forces; default 20 degrees",
)


@dataclass(frozen=True, kw_only=True)
class ToothedPart(NamedPart):
    """A pair of teeth in mesh; forces need its ``pressure_angle`` [file's angle unit]."""

    pressure_angle: Number | None = None

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ("radius",)

    def pressure(self, linkage: Bodies) -> float:
        """The angle between the force of a tooth and the pitch line [rad]."""
        if self.pressure_angle is None:
            return _USUAL
        return linkage.numbers(self.pressure_angle) * linkage.angle.radians

    def check_pressure(self, checks: PartChecks) -> None:
        """Report a pressure angle that no teeth have."""
        if self.pressure_angle is None:
            return
        angle = checks.number(self.pressure_angle, "pressure_angle")
        if not 0.0 <= angle * checks.linkage.angle.radians <= _STEEPEST:
            most = checks.linkage.angle.from_radians(_STEEPEST)
            checks.add(f"must be from 0 to {most:g}, got {angle:g}", "pressure_angle")


# ----------------------------------------------------------------------
# A pair of wheels on a common arm, given by radii or teeth: the base of gears and belts.


_MOST_TEETH = 1_000_000

ARM_KEYS = (
    Key("wheels", ListOf(Text(), "link", 2, 2), "The two rotating links", required=True),
    Key("centers", ListOf(Text(), "point", 2, 2), "Their centres of rotation", required=True),
    Key("arm", LINK, "The link with both centres; default ground"),
)
SIZE_KEYS = (
    Key("radii", ListOf(NumberKey("length"), "number", 2, 2), "Pitch radii"),
    Key("teeth", NUMBER_PAIR, "Numbers of teeth, instead of radii"),
)
PHASE_KEY = Key(
    "phase", NumberKey("angle"), "Angle of the second wheel where the first one's is zero"
)


@dataclass(frozen=True, kw_only=True)
class ArmPair(NamedPart):
    """Two links that rotate about points of an arm with coupled angles."""

    wheels: tuple[str, str]
    centers: tuple[str, str]
    arm: str = "ground"
    phase: Number | None = None

    @property
    def turning(self) -> tuple[str, ...]:
        return self.wheels

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return self.wheels

    def check(self, checks: PartChecks) -> None:
        """Check for two wheels on a common arm."""
        if self.check_arm(checks):
            self.check_sizes(checks)
            if self.phase is not None:
                checks.number(self.phase, "phase")

    def check_sizes(self, checks: PartChecks) -> None:
        """Check radii or numbers of teeth, if there are any."""

    def check_arm(self, checks: PartChecks) -> bool:
        """Check for two wheels and an arm."""
        links = checks.linkage.links
        if not checks.two(self.wheels, "link", "wheels"):
            return False
        if not checks.two(self.centers, "point", "centers"):
            return False
        known = [checks.link(name, "wheels") for name in self.wheels]
        if not all([*known, checks.link(self.arm, "arm")]):
            return False
        if self.arm in self.wheels:
            checks.add(f'"{self.arm}" cannot be a wheel and the arm as well', "arm")
        for wheel, center in zip(self.wheels, self.centers, strict=True):
            checks.on(center, wheel, "centers")
            if center in checks.linkage.points and center not in links[self.arm]:
                checks.add(
                    f'"{self.arm}" does not carry the centre {center}: name the link that '
                    f"carries both centres {' and '.join(self.centers)}",
                    "arm",
                )
        return True

    def distance(self, linkage: Bodies) -> float:
        """The centre distance."""
        a, b = (linkage.shapes.local[self.arm][center] for center in self.centers)
        return abs(b - a)

    def inverted(self, inversion: Inversion) -> Self:
        """The pair with its phase from the assembled position."""
        return replace(super().inverted(inversion), phase=None)


@dataclass(frozen=True, kw_only=True)
class WheelPair(ArmPair):
    """Two round wheels, given by radii or teeth."""

    disc_kind: ClassVar[str]

    radii: tuple[Number, Number] | None = None
    teeth: tuple[Number, Number] | None = None

    @property
    def together(self) -> bool:
        """Whether both wheels rotate in the same direction."""
        raise NotImplementedError

    @property
    def ring(self) -> bool:
        """Whether the larger wheel is a ring around the smaller one."""
        return False

    def check_sizes(self, checks: PartChecks) -> None:
        if (self.radii is None) == (self.teeth is None):
            what = "both" if self.radii is not None else "neither"
            checks.add(f"needs either radii or teeth, it has {what}")
            return
        field = "radii" if self.radii is not None else "teeth"
        given: Sequence[Number] = self.radii or self.teeth or ()
        if len(given) != 2:
            checks.add(f"needs two numbers, got {len(given)}", field)
            return
        sizes = [checks.positive(number, field, field) for number in given]
        if field == "teeth" and any(size != round(size) for size in sizes if size > 0):
            checks.add("must be whole numbers", "teeth")
        elif field == "teeth" and largest(sizes) > _MOST_TEETH:
            checks.add(f"are too many: at most {_MOST_TEETH}", "teeth")
        elif field == "radii" and all(size > 0 for size in sizes):
            checks.comparable(sizes[0], sizes[1], field)
        if self.ring and sizes[0] == sizes[1] and sizes[0] > 0:
            checks.add("are equal: a wheel inside a ring is smaller than the ring", field)

    def pairs(self, linkage: Bodies) -> KinematicPairs | None:
        radii, outside = self.pitch_radii(linkage), not self.together
        mesh = meshing(self.name, self.wheels, self.arm, radii, outside=outside)
        return KinematicPairs(couplings=(mesh,))

    def pitch_radii(self, linkage: Bodies) -> tuple[float, float]:
        """The given radii, or those computed from the teeth."""
        if self.radii is not None:
            return linkage.numbers(self.radii[0]), linkage.numbers(self.radii[1])
        assert self.teeth is not None
        first, second = map(linkage.numbers, self.teeth)
        # teeth fix only the ratio; the distance of the centres fixes the size
        module = self.distance(linkage) / self.modules_apart(first, second)
        return module * first, module * second

    def modules_apart(self, first: float, second: float) -> float:
        """The centre distance divided by the module 2 r/z."""
        raise NotImplementedError

    def discs(self, linkage: Bodies) -> Iterator[DiscFigure]:
        """The two wheels."""
        radii = self.pitch_radii(linkage)
        teeth = (None, None) if self.teeth is None else tuple(map(linkage.numbers, self.teeth))
        for link, center, radius, count in zip(
            self.wheels, self.centers, radii, teeth, strict=True
        ):
            yield DiscFigure(
                name=self.name,
                link=link,
                center=center,
                radius=radius,
                kind=self.disc_kind,
                ring=self.ring and radius == max(radii),
                teeth=None if count is None else int(count),
            )


# ----------------------------------------------------------------------
# Gears: two round wheels in mesh, external or internal.


@dataclass(frozen=True, kw_only=True)
class Gear(ToothedPart, WheelPair):
    """Two wheels in mesh: r1 (θ1 - θ_arm) ± r2 (θ2 - θ_arm) is constant.

    Parameters
    ----------
    name : str
        The name of the gear pair.
    wheels : (str, str)
        The two links that turn.
    centers : (str, str)
        Their centres of rotation on ``arm``.
    arm : str
        The link with both centres: ground, or the carrier of a planetary gear.
    radii : (number, number), optional
        Pitch radii [length]; either these or ``teeth``.
    teeth : (number, number), optional
        Numbers of teeth; the radii follow from the distance of the centres.
    internal : bool
        Whether the larger wheel is a ring gear around the smaller one.
    phase : number, optional
        Angle of the second wheel relative to the arm where that of the first is zero [file's angle
        unit]; by default as sketched.
    pressure_angle : number, optional
        Pressure angle of the teeth [file's angle unit], for forces; 20 degrees unless given.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Gear(name="mesh", wheels=("left", "right"), centers=("O", "P"), teeth=(20, 40)).teeth
    (20, 40)
    >>> round(lw.example("geared-five-bar").solve(at=45)["right"], 6)
    -60.0
    """

    title = "Gear pair"
    doc = "Two wheels in mesh, external or internal, on a common arm"
    keys = (
        Key("name", Text(), "Name of the gear pair", required=True),
        *ARM_KEYS,
        *SIZE_KEYS,
        PHASE_KEY,
        Key("internal", Flag(), "The larger wheel is a ring around the smaller one"),
        PRESSURE_KEY,
    )
    kind = JointKind("G", 2, "gear pair")
    disc_kind: ClassVar[str] = "gear"

    internal: bool = False

    @property
    def together(self) -> bool:
        return self.internal

    @property
    def ring(self) -> bool:
        return self.internal

    def modules_apart(self, first: float, second: float) -> float:
        return abs(first - second) if self.internal else first + second

    def check_shapes(self, checks: PartChecks) -> None:
        """Check that the wheels fit between their centres."""
        self.check_pressure(checks)
        if self.radii is None:
            return
        distance = self.distance(checks.linkage)
        wanted = self.modules_apart(*map(checks.linkage.numbers, self.radii))
        # circles in mesh touch; belts only have to clear each other
        if abs(distance - wanted) > AGREE * largest((distance, wanted)):
            how = "differ by" if self.internal else "add up to"
            checks.add(
                f"{how} {wanted:.10g}, but the centres {' and '.join(self.centers)} are "
                f"{distance:.10g} apart",
                "radii",
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        first, second = self.discs(linkage)
        yield from (first, second, Mesh(name=self.name, discs=(first, second)))


# ----------------------------------------------------------------------
# Belts and chains around two wheels, open or crossed.


@dataclass(frozen=True, kw_only=True)
class BeltRun(Figure):
    """A belt or chain around two pulleys, given by their centres and radii."""

    centers: tuple[str, str]
    radii: tuple[float, float]
    crossed: bool = False

    @property
    def turns_with(self) -> tuple[str, str]:
        return self.centers


@dataclass(frozen=True, kw_only=True)
class Belt(WheelPair):
    """A belt or chain around two wheels: r1 (θ1 - θ_arm) ∓ r2 (θ2 - θ_arm) is constant.

    Parameters
    ----------
    name : str
        The name of the belt.
    wheels : (str, str)
        The two links that turn.
    centers : (str, str)
        Their centres of rotation on ``arm``.
    arm : str
        The link with both centres.
    radii : (number, number), optional
        Pitch radii [length]; either these or ``teeth``.
    teeth : (number, number), optional
        Numbers of teeth.
    crossed : bool
        Whether the belt crosses itself, so that the wheels turn in opposite directions.
    phase : number, optional
        Angle of the second wheel relative to the arm where that of the first is zero [file's angle
        unit]; by default as sketched.
    pretension : number, optional
        Tension of both strands at rest [force]; by default the slack strand has none.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Belt(name="b", wheels=("m", "p"), centers=("M", "O"), radii=(25, 50)).crossed
    False
    >>> round(lw.example("belt-drive").solve(at=90)["pulley"], 6)
    45.0
    """

    title = "Belt or chain"
    doc = "A belt or chain around two wheels, open or crossed"
    keys = (
        Key("name", Text(), "Name of the belt or chain", required=True),
        *ARM_KEYS,
        *SIZE_KEYS,
        PHASE_KEY,
        Key("pretension", NumberKey(), "Tension of both strands at rest; by default a slack chain"),
        Key("crossed", Flag(), "The belt crosses itself: the wheels turn in opposite directions"),
    )
    kind = JointKind("B", 2, "belt")
    lets_go = ("goes slack",)
    disc_kind: ClassVar[str] = "pulley"

    crossed: bool = False
    pretension: Number | None = None

    @property
    def together(self) -> bool:
        return not self.crossed

    def modules_apart(self, first: float, second: float) -> float:
        """Pulleys given by teeth fill half of the centre distance."""
        return 2.0 * (first + second)

    def check_shapes(self, checks: PartChecks) -> None:
        """Check that the wheels fit between their centres."""
        if self.pretension is not None and checks.number(self.pretension, "pretension") < 0:
            checks.add("must not be negative: a belt cannot push", "pretension")
        if self.radii is None:
            return
        distance = self.distance(checks.linkage)
        first, second = map(checks.linkage.numbers, self.radii)
        # nearer centres leave no tangent common to both wheels
        least = first + second if self.crossed else abs(first - second)
        if distance <= least:
            what = "crossed " if self.crossed else ""
            checks.add(
                f"do not fit: a {what}belt needs centres more than {least:g} apart, "
                f"those of {' and '.join(self.centers)} are {distance:g}",
                "radii",
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield from self.discs(linkage)
        radii = self.pitch_radii(linkage)
        yield BeltRun(name=self.name, centers=self.centers, radii=radii, crossed=self.crossed)


# ----------------------------------------------------------------------
# Rack and pinion: a pinion rolls along a slider.


@dataclass(frozen=True, kw_only=True)
class RackBar(Figure):
    """A slider as a rack, and the pinion that meshes with it."""

    slider: str
    link: str
    center: str
    radius: float


@dataclass(frozen=True, kw_only=True)
class Rack(ToothedPart):
    """A rack and pinion: the displacement of a slider equals the arc rolled by the pinion.

    The sketch selects the side of the rack on which the pinion is.

    Parameters
    ----------
    name : str
        The name of the rack and pinion.
    pinion : str
        The rotating link.
    center : str
        Its centre of rotation, on the link along which the rack slides.
    slider : str
        The slider that is the rack.
    radius : number
        Pitch radius of the pinion [length].
    pressure_angle : number, optional
        Pressure angle of the teeth [file's angle unit], for forces; 20 degrees unless given.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Rack(name="mesh", pinion="pinion", center="G", slider="s", radius=20).slider
    's'
    >>> motion = lw.example("rack-and-pinion").sweep(from_=90, to=180, step=90)
    >>> turn = motion["pinion"][0] - motion["pinion"][1]
    >>> stroke = motion["s"][0] - motion["s"][1]
    >>> round(float(abs(stroke / turn)) * 180 / 3.141592653589793, 6)
    20.0
    """

    title = "Rack and pinion"
    doc = "A rack that slides and the pinion that drives it"
    keys = (
        Key("name", Text(), "Name of the rack and pinion", required=True),
        Key("pinion", LINK, "The rotating link", required=True),
        Key("center", POINT, "Its centre of rotation", required=True),
        Key("slider", SLIDER, "The slider of the rack", required=True),
        Key("radius", NumberKey("length"), "Pitch radius of the pinion", required=True),
        PRESSURE_KEY,
    )
    kind = JointKind("G", 2, "rack and pinion")

    pinion: str
    center: str
    slider: str
    radius: Number

    @property
    def turning(self) -> tuple[str, ...]:
        return (self.pinion,)

    def guide(self, linkage: Bodies) -> Slider | None:
        """The slider of the rack."""
        return next((s for s in linkage.of(Slider) if s.name == self.slider), None)

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        slider = self.guide(linkage)
        assert slider is not None
        return self.pinion, slider.link

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        slider = self.guide(linkage)
        assert slider is not None
        radius = linkage.numbers(self.radius)
        turns = ((self.pinion, radius), (slider.on, -radius))
        slide = (self.slider, -linkage.side_of(slider.line, self.center))
        return KinematicPairs(couplings=(Coupling(name=self.name, turns=turns, slides=(slide,)),))

    def check(self, checks: PartChecks) -> None:
        """Check that the pinion is on the link along which the rack slides."""
        linkage = checks.linkage
        known = checks.link(self.pinion, "pinion")
        slider = self.guide(linkage)
        if slider is None:
            names = [s.name for s in linkage.of(Slider)]
            checks.add(
                f'slider "{self.slider}" is not defined {choices("sliders", names)}', "slider"
            )
        checks.positive(self.radius, "radius", "radius")
        self.check_pressure(checks)
        if not known or slider is None:
            return
        checks.on(self.center, self.pinion, "center")
        if self.pinion in (slider.on, slider.link):
            checks.add(f'"{self.pinion}" cannot be a part of the rack itself', "pinion")
        elif self.center in linkage.points and self.center not in linkage.links.get(slider.on, ()):
            checks.add(
                f'"{slider.on}", along which the rack slides, does not carry {self.center}: a '
                "pinion on another link is written as [[rolling]]",
                "center",
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        slider, radius = self.guide(linkage), linkage.numbers(self.radius)
        assert slider is not None
        yield DiscFigure(
            name=self.name, link=self.pinion, center=self.center, radius=radius, kind="gear"
        )
        yield RackBar(
            name=self.name,
            slider=self.slider,
            link=slider.link,
            center=self.center,
            radius=radius,
        )
