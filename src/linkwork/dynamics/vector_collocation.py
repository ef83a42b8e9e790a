"""Steps of q̈ = a(q, q̇, t) for several numbers at once, by collocation at Gauss points.

The scheme is that of :mod:`linkwork.dynamics.collocation`, for vectors (p,).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from linkwork.dynamics.collocation import (
    AT_PLACE,
    AT_SPEED,
    FIT,
    NOISE,
    PLACE,
    POINTS,
    SPEED,
    C,
)  # fmt: skip
from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import EPSILON

__all__ = ["Acceleration", "VectorStep", "try_vector_step"]

_MOST_ROUNDS = 12
_SETTLED = 1e-14  # of the accelerations: a change that is rounding
_UNSETTLED = 1e-10  # a larger change after all rounds: the iteration has failed
_TOLERANCE = 1e-13  # of the speed: error of the polynomial between the ends of a step
_LARGEST, _SMALLEST, _SAFETY, _GROWTH = 3.0, 0.2, 0.8, 1.5

#: Accelerations (B, p) at places (B, p), speeds (B, p) and times (B,).
Acceleration = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True, kw_only=True, eq=False)
class VectorStep:
    """A step from ``t`` to ``t + h``: q, q̇ (p,) at its beginning, accelerations (n, p)."""

    t: float
    h: float
    q: Array
    speed: Array
    accelerations: Array

    @property
    def start(self) -> tuple[Array, Array]:
        """The state at its beginning."""
        return self.q, self.speed

    @cached_property
    def _coefficients(self) -> Array:
        """Of the place beyond that at constant speed, the gained speed, the acceleration."""
        found = np.zeros((POINTS + 2, 3, len(self.q)))
        found[:, 0] = self.h**2 * (PLACE @ self.accelerations)
        found[:-1, 1] = self.h * (SPEED @ self.accelerations)
        found[:-2, 2] = FIT @ self.accelerations
        return found

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """q, q̇ and q̈ at times (B,) within the step, (B, p) each."""
        x = 2.0 * (np.asarray(t) - self.t) / self.h - 1.0
        powers = legendre.legvander(x, POINTS + 1)
        moved, gained, bend = np.einsum("bm,mkp->kbp", powers, self._coefficients)
        place: Array = self.q + 0.5 * (x + 1.0)[:, None] * self.h * self.speed + moved
        return place, self.speed + gained, bend


def try_vector_step(
    acceleration: Acceleration, t: float, q: Array, speed: Array, h: float
) -> tuple[VectorStep | None, float]:
    """A step of the length ``h``, ``None`` if it does not succeed, and the length to try next.

    All numbers must be of one size: radians, and lengths in longest links.
    """
    times = t + h * C
    a = np.repeat(acceleration(q[None], speed[None], np.array([t])), POINTS, axis=0)
    if not np.isfinite(a).all():
        return None, _SMALLEST * h
    inverse, noise = None, 0.0
    for round_ in range(_MOST_ROUNDS):
        w = speed + h * (AT_SPEED @ a)
        place = q + h * C[:, None] * speed + h**2 * (AT_PLACE @ a)  # eq. (97)
        if inverse is None or round_ == _MOST_ROUNDS // 2:
            found, jacobian, steepest = _linearise(acceleration, place, w, times, h)
            if not np.isfinite(jacobian).all():
                return None, _SMALLEST * h
            inverse = np.linalg.inv(jacobian)
            noise = NOISE * EPSILON * (1.0 + np.abs(place).max()) * steepest
        else:
            found = acceleration(place, w, times)
        if not np.isfinite(found).all():
            return None, _SMALLEST * h
        change = (inverse @ (found - a).ravel()).reshape(a.shape)
        a = a + change
        if not np.isfinite(a).all():
            return None, _SMALLEST * h
        size = np.abs(a).max() + np.abs(speed).max() / abs(h)
        if np.abs(change).max() <= max(_SETTLED * POINTS * size, noise):
            break
    else:
        if np.abs(change).max() > max(_UNSETTLED * size, noise):
            return None, 0.5 * h
    tail, largest = float(np.abs((FIT @ a)[-2:]).max()), float(np.abs(a).max())
    scale = max(float(np.abs(speed).max()), abs(h) * largest)
    error = abs(h) * tail / scale if scale > 0.0 else 0.0
    factor = _LARGEST
    if error > 0.0:
        factor = min(_LARGEST, _SAFETY * (_TOLERANCE / error) ** (1.0 / POINTS))
    # accelerations follow places to rounding, which a shorter step does not reduce
    if error > 30.0 * _TOLERANCE and tail > noise:
        return None, max(_SMALLEST, min(factor, 0.7)) * h
    factor = max(factor, _GROWTH) if tail <= noise else factor
    step = VectorStep(t=t, h=h, q=q, speed=speed, accelerations=a)
    return step, max(factor, _SMALLEST) * h


def _linearise(
    acceleration: Acceleration, place: Array, w: Array, times: Array, h: float
) -> tuple[Array, Array, float]:
    """Accelerations at all points, the Jacobian of the collocation equations, (np, np), and the
    largest derivative by a place.
    """
    count, p = place.shape
    eps = math.sqrt(EPSILON)
    # places are radians and longest links
    ds = eps * max(float(np.abs(h * w).max()), 1.0)
    dw = eps * max(float(np.abs(w).max()), abs(ds / h))
    one = np.eye(p)
    places = [place] + [place + ds * each for each in one] + [place] * p
    speeds = [w] * (p + 1) + [w + dw * each for each in one]
    many = acceleration(
        np.concatenate(places), np.concatenate(speeds), np.tile(times, 2 * p + 1)
    ).reshape(2 * p + 1, count, p)
    # (n, p, p): which acceleration, by which number
    by_place = np.moveaxis(many[1 : p + 1] - many[0], 0, -1) / ds
    by_speed = np.moveaxis(many[p + 1 :] - many[0], 0, -1) / dw
    jacobian = (
        np.eye(count * p).reshape(count, p, count, p)
        - np.einsum("iab,ij->iajb", by_place, h**2 * AT_PLACE)
        - np.einsum("iab,ij->iajb", by_speed, h * AT_SPEED)
    )
    return many[0], jacobian.reshape(count * p, count * p), float(np.abs(by_place).max())
