"""A pair of wheels on a common arm, given by radii or teeth: the base of gears and belts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.foundation.elementwise import largest
from linkwork.foundation.file_keys import Key, ListOf, Number as NumberKey, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Disc
from linkwork.mechanism.part.pairs import KinematicPairs, meshing
from linkwork.mechanism.part.part import LINK, NUMBER_PAIR, Inversion, NamedPart, PartChecks

__all__ = ["ARM_KEYS", "PHASE_KEY", "SIZE_KEYS", "ArmPair", "WheelPair"]

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
        if self.check_arm(checks) and self.phase is not None:
            checks.number(self.phase, "phase")

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

    def check(self, checks: PartChecks) -> None:
        if not self.check_arm(checks):
            return
        self._check_sizes(checks)
        if self.phase is not None:
            checks.number(self.phase, "phase")

    def _check_sizes(self, checks: PartChecks) -> None:
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

    def discs(self, linkage: Bodies) -> Iterator[Disc]:
        """The two wheels."""
        radii = self.pitch_radii(linkage)
        teeth = (None, None) if self.teeth is None else tuple(map(linkage.numbers, self.teeth))
        for link, center, radius, count in zip(
            self.wheels, self.centers, radii, teeth, strict=True
        ):
            yield Disc(
                name=self.name,
                link=link,
                center=center,
                radius=radius,
                kind=self.disc_kind,
                ring=self.ring and radius == max(radii),
                teeth=None if count is None else int(count),
            )
