"""Gears: two round wheels in mesh, external or internal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.elementwise import largest
from linkwork.foundation.file_keys import Flag, Key, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.figures import Figure, Mesh, Outlines
from linkwork.mechanism.joint import JointKind
from linkwork.mechanism.part.part import AGREE, PartChecks
from linkwork.mechanism.part.toothed import PRESSURE_KEY, ToothedPart
from linkwork.mechanism.part.wheel_pair import ARM_KEYS, PHASE_KEY, SIZE_KEYS, WheelPair

__all__ = ["Gear"]


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
