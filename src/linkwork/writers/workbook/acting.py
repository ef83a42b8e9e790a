"""What acts on links: forces at points and moments, as numbers that know their formulas of cells.

Such a number is a :class:`~linkwork.writers.formulas.traced.TracedNumber`, complex for a vector, or
a plain number.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Where a part pushes links in contact: a place and a unit vector."""

    name: str
    place: Any
    way: Any


@dataclass(frozen=True)
class Act:
    """What a unit of something, or a load, does to a link at a point."""

    link: str
    point: str
    force: Any = 0.0
    moment: Any = 0.0


def opposite(on: str, against: str, point: str, along: Any) -> tuple[Act, ...]:
    """A unit force on one link, and its reaction on another."""
    return Act(on, point, along), Act(against, point, -along)


@dataclass(frozen=True)
class Unknown:
    """A reaction: its name, unit and acts."""

    name: str
    unit: str
    acts: tuple[Act, ...]


@dataclass(frozen=True)
class Follower:
    """A force whose size is a function of one unknown, which it must not change."""

    name: str
    unit: str
    of: str
    size: Callable[[Any], Any]
    acts: tuple[Act, ...]


@dataclass(frozen=True)
class Reading:
    """A sum of reactions by name, with weights."""

    name: str
    unit: str
    weights: dict[str, Any]
