"""Springs between two points or two links, and dampers: they do not constrain the motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.file_keys import Key, ListOf, Number as NumberKey, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Figure, Outlines
from linkwork.mechanism.part.part import POINT_PAIR, NamedPart, PartChecks

__all__ = ["Spring", "SpringFigure"]


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
