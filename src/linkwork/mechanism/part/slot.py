"""Pin in slot: a point moves along a line of another link."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.foundation.file_keys import Key, Number as NumberKey, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Figure, Guide, Outlines
from linkwork.mechanism.joint import Joint, JointKind
from linkwork.mechanism.part.guide import GuidePart
from linkwork.mechanism.part.pairs import KinematicPairs, sliding_block
from linkwork.mechanism.part.part import LINK, POINT, POINT_PAIR, PartChecks, pinned

__all__ = ["GenevaWheel", "Slot"]

_FEWEST, _MOST = 3, 60  # slots of a Geneva wheel


@dataclass(frozen=True, kw_only=True)
class GenevaWheel(Figure):
    """A wheel with ``count`` equal slots about ``center``; ``rim`` is at the mouth of one of them.

    ``name`` is that of the slot, ``pin`` the point that runs in it.
    """

    link: str
    center: str
    rim: str
    pin: str
    count: int


@dataclass(frozen=True, kw_only=True)
class Slot(GuidePart):
    """A pin in a slot: a point of one link moves along a line of another link.

    Parameters
    ----------
    name : str
        The displacement, zero at the first point of ``line``, positive towards the second [length].
    point : str
        The pin.
    on : str
        The link with the slot.
    line : (str, str)
        Two points of that link.
    count : number, optional
        The number of equal slots around the first point of ``line``, their mouths as far from it as
        the second: a Geneva wheel, drawn as a star.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Slot(name="s", point="A", on="lever", line=("O4", "Q")).name
    's'
    >>> round(lw.example("crank-shaper").solve(at=90)["s"], 6)
    210.0
    """

    title = "Pin in slot"
    doc = "Pin in slot: a point moves along a line of another link"
    keys = (
        Key("name", Text(), "Name of the displacement, zero at the first point of the line", True),
        Key("point", POINT, "The pin: a point of another link", required=True),
        Key("on", LINK, "The link with the slot", required=True),
        Key("line", POINT_PAIR, "Two points of that link; positive from first to second", True),
        Key(
            "count",
            NumberKey(),
            "For drawings: equal slots around the first point of the line, open at the second",
        ),
    )
    kind = JointKind.PIN_IN_SLOT

    point: str
    count: Number | None = None

    @property
    def point_on_line(self) -> str:
        return self.point

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ()

    @property
    def guided(self) -> tuple[str, str, str]:
        return "point", self.point, self.on

    def joint(self, linkage: Bodies) -> Joint:
        # the pin's name joins the slot to the pin of other links at this point
        links = (pinned(linkage, self.point), self.on)
        return Joint(kind=self.kind, name=self.name, links=links, point=self.point)

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        block = sliding_block(self.name, self.on, self.line, self.point)
        link = pinned(linkage, self.point)
        return block.with_pin(link)

    def check(self, checks: PartChecks) -> None:
        checks.line(self.on, self.line)
        fixed = self.point in checks.linkage.links.get(self.on, ())
        if checks.defined(self.point, "point") and fixed:
            checks.add(
                f'point "{self.point}" is fixed on "{self.on}" and cannot move in its slot', "point"
            )

        if self.count is None:
            return
        count = checks.number(self.count, "count")
        if not (_FEWEST <= count <= _MOST and count == round(count)):
            checks.add(
                f"must be a whole number from {_FEWEST} to {_MOST}, it is {count:g}", "count"
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield Guide(name=self.name, point=self.point, on=self.on, line=self.line)
        if self.count is not None:
            yield GenevaWheel(
                name=self.name,
                link=self.on,
                center=self.line[0],
                rim=self.line[1],
                pin=self.point,
                count=round(linkage.numbers(self.count)),
            )
