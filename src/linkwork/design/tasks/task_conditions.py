"""What a task gives: positions, pivots and lengths, wishes, and the ranking; in file units."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from linkwork.results.quantities.transmission import TRANSMISSION_ANGLE

__all__ = ["LENGTHS", "SAME_GIVEN", "Given", "Point", "PrecisionPosition", "Ranking", "Wanted"]

#: Lengths that a task of points may give.
LENGTHS = ("A0 A", "A B", "B0 B", "A0 B0", "A P", "B P")
_COUPLER = ("A B", "A P", "B P")
#: Lengths, and pivots by the task's size, that differ by less are those given.
SAME_GIVEN = 1e-6

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class PrecisionPosition:
    """A position through which the guided body, or its point, passes.

    Parameters
    ----------
    point : (float, float)
        Where the guided point is [length].
    angle : float, optional
        The angle of the body: with it, a pose [file's angle unit].
    input : float, optional
        The crank's angle at this position, of which differences count [file's angle unit].
    tolerance, angle_tolerance : float
        How far point and angle may miss.
    """

    point: Point
    angle: float | None = None
    input: float | None = None
    tolerance: float = 0.0
    angle_tolerance: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Given:
    """What the author fixes [length]: pivots, moving ones as they are at the first position, and
    distances of A0, B0, A, B and P.
    """

    fixed_pivots: tuple[Point, ...] = ()
    moving_pivots: tuple[Point, ...] = ()
    lengths: Mapping[str, float] = field(default_factory=dict)

    @property
    def ground(self) -> float:
        """The distance of the first two fixed pivots; without them 1."""
        first, second, *_ = *self.fixed_pivots, (1.0, 0.0), (0.0, 0.0)
        return math.dist(first, second)

    @property
    def coupler_trouble(self) -> str:
        """Why the given sides of the coupler, if all three are, make no triangle; or ""."""
        one, other, longest = sorted(self.lengths.get(name, 0.0) for name in _COUPLER)
        slack = one + other - longest
        if one <= 0.0 or slack > SAME_GIVEN * longest:
            return ""
        if slack < -SAME_GIVEN * longest:
            return "A B, A P and B P are no triangle: leave one out"
        return (
            "A B, A P and B P put P on the line of A and B, where all solutions are double: change "
            "one of them by a thousandth, or leave it out"
        )


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """Wishes, each proved over the whole driven range.

    Parameters
    ----------
    turns_fully : bool
        Whether the driven link makes whole turns.
    range : (float, float), optional
        The driven range [file's angle unit, or length].
    transmission : float
        The smallest transmission angle allowed [file's angle unit].
    ordered : bool
        Whether the positions are passed in their order.
    region : tuple of points
        Corners of the polygon that contains all fixed pivots [length].
    shortest, longest, ratio : float
        Bounds of lengths, and of the longest over the shortest.
    obstacles : tuple of (x, y, radius)
        Circles that no link may meet [length].
    """

    turns_fully: bool = False
    range: tuple[float, float] | None = None
    transmission: float = 0.0
    ordered: bool = True
    region: tuple[Point, ...] = ()
    shortest: float = 0.0
    longest: float = math.inf
    ratio: float = math.inf
    obstacles: tuple[tuple[float, float, float], ...] = ()


@dataclass(frozen=True, kw_only=True)
class Ranking:
    """Weights of the ranking, and the largest number of designs that are delivered."""

    transmission: float = 1.0
    size: float = 1.0
    error: float = 5.0
    deliver: int = 20

    def problems(self) -> Iterator[tuple[tuple[str | int, ...], str]]:
        """Weights that rank nothing, with their keys."""
        weights = {
            TRANSMISSION_ANGLE.word: self.transmission, "size": self.size, "error": self.error,
        }  # fmt: skip
        for name, weight in weights.items():
            if weight < 0.0:
                yield ("rank", "by", name), f"must not be negative, got {weight:g}"
        if not any(weights.values()):
            yield ("rank", "by"), "has no weight above 0: give one, or leave it out"
