"""What kind of mechanism it is: chain, inversion, type by lengths, Assur groups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

__all__ = ["AssurGroup", "Classification", "Inversion", "LoopType", "roman"]

_ROMAN = ("", "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X")


def roman(number: int) -> str:
    """A class in the customary way: ``II``."""
    return _ROMAN[number] if number < len(_ROMAN) else str(number)


@dataclass(frozen=True, kw_only=True)
class LoopType:
    """The type of a four-bar or slider-crank loop, from its exact lengths.

    Parameters
    ----------
    links : tuple of str
        Around the loop: ground, the driven link (else the first one), coupler, output.
    name : str
        ``crank-rocker``, ``crank shaper``, …
    barker : str
        Barker's name of a four-bar (``GCRR``), empty for other loops.
    grashof : bool or None
        Whether a link turns fully; ``None`` for a change point.
    margin : float
        p + q - s - l of a four-bar, l - s - e of a slider-crank; positive if a link turns fully.
    relative_margin : float
        The margin by the longest of the lengths compared.
    turns_fully : bool or None
        Whether the driven joint can turn fully; ``None`` if no joint of this loop is driven, or a
        sliding one, or at a change point.
    condition : str
        The comparison of lengths as a sentence.
    """

    links: tuple[str, ...]
    name: str
    barker: str = ""
    grashof: bool | None
    margin: float
    relative_margin: float
    turns_fully: bool | None
    condition: str

    @property
    def text(self) -> str:
        """``crank-rocker (GCRR): Grashof, s + l < p + q by 40 mm``."""
        code = f" ({self.barker})" if self.barker else ""
        return f"{self.name}{code}: {self.condition}"

    def to_dict(self) -> dict[str, Any]:
        """The type as JSON-ready data."""
        return {
            "links": list(self.links),
            "name": self.name,
            "barker": self.barker or None,
            "grashof": self.grashof,
            "margin": self.margin,
            "relative_margin": self.relative_margin,
            "turns_fully": self.turns_fully,
        }


@dataclass(frozen=True, kw_only=True)
class AssurGroup:
    """Links that are determined together once everything before them is known.

    Parameters
    ----------
    links : tuple of str
        Links that the input holds together are one: ``crank + coupler``.
    name : str
        ``dyad RRR``, ``triad RR-RR-RP``, ``tetrad``, ``group of 6 links``; or why it is none.
    class_number, order : int or None
        Class and order after Artobolevskii; ``None`` if it is no Assur group.
    """

    links: tuple[str, ...]
    name: str
    class_number: int | None
    order: int | None

    @property
    def text(self) -> str:
        """``dyad RRR, class II``."""
        if self.class_number is None:
            return self.name
        return f"{self.name}, class {roman(self.class_number)}"

    def to_dict(self) -> dict[str, Any]:
        """The group as JSON-ready data."""
        return {
            "links": list(self.links),
            "name": self.name,
            "class": self.class_number,
            "order": self.order,
        }


@dataclass(frozen=True, kw_only=True)
class Classification:
    """What a textbook calls a mechanism.

    Parameters
    ----------
    chain : str
        The kinematic chain: ``four-bar chain``, ``Watt chain``, …
    inversion : str or None
        What the choice of ground makes of it: ``Stephenson III``, ``Scotch yoke``, …
    links : int
        How many links the chain has.
    blocks : tuple of str
        The slots whose pins are counted among the links, as blocks.
    loop : LoopType or None
        The four-bar or slider-crank that the mechanism is, or that its driven link is in.
    groups : tuple of AssurGroup
        In the order in which they are determined.
    class_number : int or None
        The highest class of a group, 1 if there are none; ``None`` if it has no class.
    """

    chain: str
    inversion: str | None
    links: int
    blocks: tuple[str, ...]
    loop: LoopType | None
    groups: tuple[AssurGroup, ...]
    class_number: int | None

    @property
    def type(self) -> str:
        """The type by ground and lengths, empty if there is no name for it."""
        if self.loop is not None and self.links == len(self.loop.links):
            return self.loop.text
        told = [self.inversion] if self.inversion is not None else []
        if self.loop is not None:
            told.append(f"its loop {', '.join(self.loop.links)}: {self.loop.text}")
        return "; ".join(told)

    def to_dict(self) -> dict[str, Any]:
        """The classification as JSON-ready data."""
        return {
            "chain": self.chain,
            "links": self.links,
            "inversion": self.inversion,
            "type": self.type or None,
            "blocks": list(self.blocks),
            "loop": None if self.loop is None else self.loop.to_dict(),
            "groups": [group.to_dict() for group in self.groups],
            "class": self.class_number,
        }


@dataclass(frozen=True, kw_only=True)
class Inversion:
    """A mechanism's chain with one of its links as ground.

    Parameters
    ----------
    ground : str
        The link that would stand still.
    type : str
        What that makes of the chain; empty if there is no name for it.
    like : str
        The first link with which, as ground, the chain is the same but for its lengths.
    problem : str
        Why ``mechanism.inversion`` cannot make it; empty if it can.
    """

    ground: str
    type: str
    like: str
    problem: str = ""

    @property
    def text(self) -> str:
        """``coupler: double-rocker (GRCR): …``."""
        return f"{self.ground}: {self.type or self.problem or 'no name of its own'}"
