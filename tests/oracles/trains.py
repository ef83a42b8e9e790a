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
        inputs=lw.Input(variable="t0", start=start, stop=stop, step=(stop - start) / count),
    )


def turned(ground: float, crank: float, angle: Array) -> Array:
    """The rocker of an antiparallelogram."""
    half = 0.5 * angle
    found: Array = 2.0 * np.arctan2(
        -(ground + crank) * np.sin(half), (ground - crank) * np.cos(half)
    )
    return found


def straight_motion(loops: Sequence[Loop], t: Array, fine: int) -> list[Array]:
    """The angles t1, t2, … at values of t0, every loop going smoothly through change points.

    Between neighbouring values ``fine`` steps are taken; each goes to the angle that lies nearer to
    where the last steps lead.
    """
    steps = np.linspace(t[:-1], t[1:], fine, endpoint=False).T.ravel()
    driving, found = np.append(steps, t[-1]), []
    for loop in loops:
        both = loop.rocker_angles(driving + loop.offset)
        own = np.empty_like(driving)
        own[0] = _near(both[0][0] if loop.side > 0 else both[1][0], driving[0])
        for k in range(1, len(own)):
            ahead = own[k - 1] if k < 3 else 3.0 * (own[k - 1] - own[k - 2]) + own[k - 3]
            ways = [float(_near(side[k], ahead)) for side in both]
            own[k] = min(ways, key=lambda way: abs(way - ahead))
        found.append(own[::fine])
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
