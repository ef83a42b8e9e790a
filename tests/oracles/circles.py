"""Points where circles and lines meet, for closed forms of slider-cranks and of dyad chains."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Jansen", "SliderCrank", "circles_meet"]

Angles = npt.NDArray[np.floating]
Lengths = npt.NDArray[np.float64]
Points = npt.NDArray[np.complex128]


def circles_meet(
    a: Points, ra: float | Lengths, b: Points, rb: float | Lengths, side: int
) -> Points:
    """The point at distances ra from a and rb from b, left (+1) or right (-1) of a → b; NaN: none.

    x = (d² + ra² - rb²)/2d along the line of centres, √(ra² - x²) beside it.
    """
    d = np.abs(b - a)
    x = (d * d + (ra - rb) * (ra + rb)) / (2 * d)
    with np.errstate(invalid="ignore"):
        h = np.sqrt((ra - x) * (ra + x))
    return np.asarray(a + (b - a) / d * (x + 1j * side * h))


@dataclass(frozen=True)
class SliderCrank:
    """Crank about the origin; its rod's end runs along the line through ``base`` at ``slope``."""

    crank: float
    rod: float
    base: complex
    slope: float

    @property
    def along(self) -> complex:
        """The unit vector of the line."""
        return cmath.exp(1j * self.slope)

    def slide(self, theta: Angles, side: int) -> npt.NDArray[np.floating]:
        """s = Re w ± √(rod² - (Im w)²) with w = (A - base)/u; NaN out of reach."""
        w = (self.crank * np.exp(1j * np.asarray(theta)) - self.base) / self.along
        with np.errstate(invalid="ignore"):
            half = np.sqrt((self.rod - w.imag) * (self.rod + w.imag))
        return np.asarray(w.real + side * half)

    def points(self, theta: float, side: int, length: float) -> dict[str, tuple[float, float]]:
        """A, B, and S, T of the line, which is ``length`` long."""
        a = self.crank * cmath.exp(1j * theta)
        s = float(self.slide(np.array(theta), side))
        places = {
            "A": a,
            "B": self.base + s * self.along,
            "S": self.base,
            "T": self.base + length * self.along,
        }
        return {name: (z.real, z.imag) for name, z in places.items()}


@dataclass(frozen=True)
class Jansen:
    """Theo Jansen's leg: crank about the origin, the foot's path from five dyads."""

    a: float = 38.0
    b: float = 41.5
    c: float = 39.3
    d: float = 40.1
    e: float = 55.8
    f: float = 39.4
    g: float = 36.7
    h: float = 65.7
    i: float = 49.0
    j: float = 50.0
    k: float = 61.9
    low: float = 7.8
    m: float = 15.0

    def foot(self, theta: Angles) -> Points:
        """The foot F in the usual assembly."""
        pivot = np.full(np.shape(theta), complex(-self.a, -self.low))
        crank = np.asarray(self.m * np.exp(1j * np.asarray(theta)))
        upper = circles_meet(crank, self.j, pivot, self.b, -1)
        lower = circles_meet(crank, self.k, pivot, self.c, 1)
        left = circles_meet(pivot, self.d, upper, self.e, 1)
        heel = circles_meet(left, self.f, lower, self.g, -1)
        return circles_meet(heel, self.h, lower, self.i, -1)
