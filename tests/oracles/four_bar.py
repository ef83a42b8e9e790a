"""Closed forms of the four-bar, independent of the product: circles that meet.

Pivots at 0 and r1 on the x axis; crank r2 at angle θ2 from 0, coupler r3, rocker r4 from r1.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["FourBar", "random_crank_rockers"]

Angles = npt.NDArray[np.floating]
Points = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class FourBar:
    """Lengths of ground, crank, coupler and rocker."""

    r1: float
    r2: float
    r3: float
    r4: float

    def crank_end(self, theta2: Angles) -> Points:
        """A = r2 exp(i θ2)."""
        return np.asarray(self.r2 * np.exp(1j * np.asarray(theta2)))

    def coupler_end(self, theta2: Angles, side: int) -> Points:
        """B, left (+1) or right (-1) of the line from A to the rocker's pivot; NaN out of reach.

        With d = |r1 - A| the point lies x = (d² + r3² - r4²)/2d along that line and
        √(r3² - x²) beside it.
        """
        a = self.crank_end(theta2)
        span = self.r1 - a
        d = np.abs(span)
        x = (d + (self.r3 - self.r4) * (self.r3 + self.r4) / d) / 2
        with np.errstate(invalid="ignore"):
            h = np.sqrt((self.r3 - x) * (self.r3 + x))
        return np.asarray(a + span / d * (x + 1j * side * h))

    def phasors(self, theta2: Angles, side: int) -> tuple[Points, Points]:
        """exp(i θ3) and exp(i θ4)."""
        b = self.coupler_end(theta2, side)
        return (b - self.crank_end(theta2)) / self.r3, (b - self.r1) / self.r4

    def side_of(self, theta2: float, theta3: float) -> int:
        """On which side of the line from A to the rocker's pivot a coupler of angle θ3 lies."""
        span = self.r1 - self.r2 * cmath.exp(1j * theta2)
        return 1 if (cmath.exp(1j * theta3) * span.conjugate()).imag > 0 else -1

    def dead_points(self) -> tuple[float, ...]:
        """Crank angles in (0, π) with coupler and rocker in line, folded and stretched."""
        found = []
        for reach in (self.r3 - self.r4, self.r3 + self.r4):
            cosine = (self.r1**2 + self.r2**2 - reach**2) / (2 * self.r1 * self.r2)
            if -1 < cosine < 1:
                found.append(math.acos(cosine))
        return tuple(found)

    def points(self, theta2: float, side: int) -> dict[str, tuple[float, float]]:
        """Coordinates of O2, A, B, O4."""
        a = complex(self.crank_end(np.array(theta2)))
        b = complex(self.coupler_end(np.array(theta2), side))
        places = {"O2": 0j, "A": a, "B": b, "O4": complex(self.r1)}
        return {name: (z.real, z.imag) for name, z in places.items()}


def random_crank_rockers(count: int, seed: int) -> list[FourBar]:
    """Four-bars whose shortest link is the crank and which satisfy Grashof's condition strictly.

    The sum of the shortest and longest link is at most 98 % of the other two, so that no
    position is nearer to a change point than a table's step could tell apart.
    """
    rng = np.random.default_rng(seed)
    found: list[FourBar] = []
    while len(found) < count:
        crank, *others = sorted(rng.uniform(0.2, 4.0, 4))
        if crank + others[2] > 0.98 * (others[0] + others[1]):
            continue
        rng.shuffle(others)
        found.append(FourBar(float(others[0]), float(crank), float(others[1]), float(others[2])))
    return found
