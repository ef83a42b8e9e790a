"""Joints of a kinematic chain: which links they join, and what they let them do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

__all__ = ["Joint", "JointKind"]


@dataclass(frozen=True)
class JointKind:
    """What a joint lets its links do: its letter, its freedoms, and what it is called."""

    letter: str
    freedom: int
    noun: str

    REVOLUTE: ClassVar[JointKind]
    PRISMATIC: ClassVar[JointKind]
    PIN_IN_SLOT: ClassVar[JointKind]

    @property
    def lower(self) -> bool:
        """Whether it is a lower pair: its links touch in a surface, and have one freedom."""
        return self in (JointKind.REVOLUTE, JointKind.PRISMATIC)


JointKind.REVOLUTE = JointKind("R", 1, "revolute joint")
JointKind.PRISMATIC = JointKind("P", 1, "prismatic joint")
JointKind.PIN_IN_SLOT = JointKind("RP", 2, "pin in slot")


@dataclass(frozen=True, kw_only=True)
class Joint:
    """A joint of two links, or a pin of more.

    Parameters
    ----------
    name : str
        The point of a pin; otherwise the name of slider, slot or cylinder.
    links : tuple of str
        Two; a multiple pin has more and counts as one joint less than it has links.
    point : str
        For a pin in a slot: where the pin is.
    """

    kind: JointKind
    name: str
    links: tuple[str, ...]
    point: str = ""

    @property
    def count(self) -> int:
        """How many simple joints it stands for."""
        return len(self.links) - 1

    def across(self, link: str) -> Iterator[str]:
        """The links on its other side."""
        return (other for other in self.links if other != link)
