"""Belts and chains around two wheels, open or crossed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.file_keys import Flag, Key, Number as NumberKey, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Figure, Outlines
from linkwork.mechanism.joint import JointKind
from linkwork.mechanism.part.part import PartChecks
from linkwork.mechanism.part.wheel_pair import ARM_KEYS, PHASE_KEY, SIZE_KEYS, WheelPair

__all__ = ["Belt", "BeltRun"]


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
