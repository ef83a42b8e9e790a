"""Trains of four-bars, the rocker of each the crank of the next; closed forms for their motions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import linkwork as lw

__all__ = ["Loop", "apart", "parallelogram", "straight_motion", "train", "turned"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Loop:
    """Ground, crank, coupler, rocker; the crank's angle is that of the link before plus ``offset``
    [rad]; ``side``: +1 or -1, which way coupler and rocker close the loop at the start.
    """

    ground: float
    crank: float
    coupler: float
    rocker: float
    offset: float = 0.0
    side: float = 1.0

    def rocker_angles(self, crank_angle: Array) -> tuple[Array, Array]:
        """The rocker's angles on both sides."""
        x = self.crank * np.cos(crank_angle) - self.ground
        y = self.crank * np.sin(crank_angle)
        away = np.hypot(x, y)
        cosine = (self.rocker**2 + away**2 - self.coupler**2) / (2.0 * self.rocker * away)
        opening = np.arccos(np.clip(cosine, -1.0, 1.0))
        towards = np.arctan2(y, x)
        return towards + opening, towards - opening

    def straight_rocker_angle(self, crank_angle: Array) -> Array:
        """The rocker's angle, continuous through change points; the first one is on ``side``."""
        g, a, b, c = self.ground, self.crank, self.coupler, self.rocker
        half = 0.5 * crank_angle
        # (g + a)² less the square of the diagonal
        below = 4.0 * g * a * np.cos(half) ** 2
        diagonal = np.sqrt((g + a) ** 2 - below)
        over = np.sqrt(g * a * (b + diagonal - c) / (c * diagonal * (b + c + diagonal)))
        opening = 2.0 * np.arcsin(np.cos(half) * over)
        # the diagonal's angle, without jumps
        if a > g:
            towards = crank_angle + np.arctan2(g * np.sin(crank_angle), a - g * np.cos(crank_angle))
        else:
            towards = np.pi - np.arctan2(a * np.sin(crank_angle), g - a * np.cos(crank_angle))
        found: Array = towards + self.side * np.sign(opening[0]) * opening
        return found


def parallelogram(ground: float, crank: float, offset: float = 0.0) -> Loop:
    """A loop whose rocker stays parallel to its crank at first, for cranks that point upwards."""
    return Loop(ground, crank, ground, crank, offset, -1.0)


def train(loops: Sequence[Loop], rows: tuple[float, float, float]) -> lw.Mechanism:
    """Loops in a row with the unknowns k1, t1, k2, t2, …; ``rows``: from, to, step of t0 [deg]."""
    start, stop, step = (math.radians(x) for x in rows)
    texts, guess, angle = {}, {"t0": start}, np.array([start])
    for k, loop in enumerate(loops, start=1):
        crank = f"{loop.crank!r}*e^(i*({loop.offset!r} + t{k - 1}))"
        rocker = f"{loop.rocker!r}*e^(i*t{k})"
        texts[f"loop {k}"] = f"{crank} + {loop.coupler!r}*e^(i*k{k}) = {loop.ground!r} + {rocker}"
        driving = angle + loop.offset
        both = loop.rocker_angles(driving)
        angle = _near(both[0] if loop.side > 0 else both[1], angle)
        end = loop.ground + loop.rocker * np.exp(1j * angle) - loop.crank * np.exp(1j * driving)
        guess |= {f"k{k}": float(np.angle(end)[0]), f"t{k}": float(angle[0])}
    count = round((stop - start) / step)
    return lw.loops(
        angle="rad",
        loops=texts,
        guess=guess,
        inputs=lw.Input(variable="t0", from_=start, to=stop, step=(stop - start) / count),
    )


def turned(ground: float, crank: float, angle: Array) -> Array:
    """The rocker of an antiparallelogram."""
    half = 0.5 * angle
    found: Array = 2.0 * np.arctan2(
        -(ground + crank) * np.sin(half), (ground - crank) * np.cos(half)
    )
    return found


def straight_motion(loops: Sequence[Loop], t: Array) -> list[Array]:
    """The angles t1, t2, … at values of t0, every loop going smoothly through change points.

    For parallelograms, and loops with ground + crank = coupler + rocker, which have one change
    point a turn, where the crank points away from the rocker's pivot. There the opening between
    rocker and diagonal is proportional to cos(θ/2) and changes its sign: nothing is chosen on the
    way, and no digits cancel.
    """
    driving, found = np.asarray(t, dtype=float), []
    for loop in loops:
        theta = driving + loop.offset
        start = _near(loop.rocker_angles(theta[:1])[0 if loop.side > 0 else 1], theta[:1])
        if loop.ground == loop.coupler and loop.crank == loop.rocker:
            own = theta
            if abs(_near(own[0], start[0]) - start[0]) > 1e-6:
                own = turned(loop.ground, loop.crank, theta)
            assert abs(_near(own[0], start[0]) - start[0]) < 1e-6
        else:
            own = loop.straight_rocker_angle(theta)
        found.append(own)
        driving = own
    return found


def apart(a: Array, b: Array) -> float:
    """The largest difference of angles, whole turns aside."""
    gap: Array = np.remainder(a - b + math.pi, 2.0 * math.pi) - math.pi
    return float(np.abs(gap).max(initial=0.0))


def _near(angle: Array | float, other: Array | float) -> Array:
    """The angle moved by whole turns to where another one is."""
    moved: Array = angle + 2.0 * np.pi * np.round((np.asarray(other) - angle) / (2.0 * np.pi))
    return moved
