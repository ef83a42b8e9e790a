"""Cylinder: a link of variable length between two points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.file_keys import Key, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.figures import Figure, Outlines
from linkwork.mechanism.joint import JointKind
from linkwork.mechanism.part.pairs import AddedBody, KinematicPairs, Pair, PairKind
from linkwork.mechanism.part.part import POINT_PAIR, NamedPart, PartChecks

__all__ = ["Cylinder", "Strut"]


@dataclass(frozen=True, kw_only=True)
class Strut(Figure):
    """A body of variable length between two points."""

    over: ClassVar[bool] = True

    between: tuple[str, str]


@dataclass(frozen=True, kw_only=True)
class Cylinder(NamedPart):
    """A link of variable length between two points, such as a hydraulic cylinder.

    Parameters
    ----------
    name : str
        The name of the variable length.
    between : (str, str)
        The two points.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Cylinder(name="ram", between=("P", "Q")).angle_name
    'ram_angle'
    """

    title = "Cylinder"
    doc = "A link of variable length between two points"
    keys = (
        Key("name", Text(), "Name of the variable length", required=True),
        Key("between", POINT_PAIR, "The two points it connects", required=True),
    )
    kind = JointKind.PRISMATIC

    between: tuple[str, str]

    @property
    def angle_name(self) -> str:
        """The name of the cylinder's angle in results."""
        stem = self.name.rstrip("'")
        return f"{stem}_angle{self.name[len(stem) :]}"  # primes are at the end of a name

    @property
    def names(self) -> tuple[str, ...]:
        return self.name, self.angle_name

    @property
    def drive(self) -> str:
        return "cylinder"

    @property
    def body(self) -> tuple[str, ...]:
        return self.between

    @property
    def ends(self) -> tuple[str, str]:
        """The two links of a cylinder, at its first and at its second point."""
        return f"{self.name} barrel", f"{self.name} rod"

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return self.ends

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        ends = zip(self.ends, self.between, strict=True)
        slide = Pair(
            kind=PairKind.SLIDE,
            name=self.name,
            bodies=self.ends,
            point=self.between[1],
            line=self.between,
        )
        return KinematicPairs(
            bodies=tuple(
                AddedBody(name=end, points=(point,), angle=self.angle_name, pinned=True)
                for end, point in ends
            ),
            pairs=(slide,),
        )

    def check(self, checks: PartChecks) -> None:
        checks.ends(self.between)

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield Strut(name=self.name, between=self.between)
