"""Springs: drawn between two points, without constraint."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.file_keys import Key, Text
from linkwork.mechanism.bodies import Bodies
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
    """A spring between two points; it is drawn and does not constrain the motion.

    Parameters
    ----------
    name : str
        The name of the spring.
    between : (str, str)
        The two points.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Spring(name="return", between=("O4", "B")).between
    ('O4', 'B')
    """

    title = "Spring"
    doc = "A spring between two points; drawn, without constraint"
    keys = (
        Key("name", Text(), "Name of the spring", required=True),
        Key("between", POINT_PAIR, "The two points it connects", required=True),
    )

    between: tuple[str, str]

    def check(self, checks: PartChecks) -> None:
        checks.ends(self.between)

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield SpringFigure(name=self.name, between=self.between)
