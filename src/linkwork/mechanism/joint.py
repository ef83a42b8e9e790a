"""Joints of a kinematic chain: their links and kinds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

__all__ = ["Joint", "JointKind"]


@dataclass(frozen=True)
class JointKind:
    """A kind of joint: its letter, number of freedoms and name."""

    letter: str
    freedom: int
    noun: str

    REVOLUTE: ClassVar[JointKind]
    PRISMATIC: ClassVar[JointKind]
    PIN_IN_SLOT: ClassVar[JointKind]

    @property
    def lower(self) -> bool:
        """Whether it is a lower pair: surface contact and one freedom."""
        return self in (JointKind.REVOLUTE, JointKind.PRISMATIC)


JointKind.REVOLUTE = JointKind("R", 1, "revolute joint")
JointKind.PRISMATIC = JointKind("P", 1, "prismatic joint")
JointKind.PIN_IN_SLOT = JointKind("RP", 2, "pin in slot")


@dataclass(frozen=True, kw_only=True)
class Joint:
    """A joint of two links, or a multiple pin.

    Parameters
    ----------
    name : str
        The point of a pin; otherwise the name of slider, slot or cylinder.
    links : tuple of str
        Two links, or k > 2 for a multiple pin, which counts as k - 1 joints.
    point : str
        For a pin in a slot: the point of the pin.
    """

    kind: JointKind
    name: str
    links: tuple[str, ...]
    point: str = ""

    @property
    def count(self) -> int:
        """Its number of simple joints."""
        return len(self.links) - 1

    def across(self, link: str) -> Iterator[str]:
        """The other links of the joint."""
        return (other for other in self.links if other != link)
