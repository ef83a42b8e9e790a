"""Steps of s̈ = a(s, ṡ, t) by collocation at Gauss points, with polynomials between.

At n points the polynomial of degree n - 1 for s̈ equals a; its integrals give ṡ and s. The ends of
steps are of order 2n (Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3); between
them the last coefficients of the polynomial show its error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from linkwork.foundation.arrays import AnyArray, Array
from linkwork.foundation.rounding import EPSILON

__all__ = [
    "AT_PLACE",
    "AT_SPEED",
    "FIT",
    "NOISE",
    "PLACE",
    "POINTS",
    "SPEED",
    "C",
    "Step",
    "shorter_step",
    "try_step",
]

POINTS = 12
_MOST_ROUNDS = 12
_SETTLED = 1e-15  # of the accelerations: a change that is rounding
_TOLERANCE = 1e-13  # of the speed: error of the polynomial between the ends of a step
_ROUNDING, _GROWTH = 1e-9, 1.5  # of the accelerations: more is none; of steps with it
_LARGEST, _SMALLEST, _SAFETY = 3.0, 0.2, 0.8
_LOOKS = 33  # places of a step at which it may have left its leg
NOISE = 16.0  # roundings of a place in an acceleration

_x, _w = legendre.leggauss(POINTS)
FIT = np.linalg.inv(legendre.legvander(_x, POINTS - 1))
C = 0.5 * (_x + 1.0)


def _integrals(once: AnyArray) -> Array:
    """The matrix from values to the coefficients of an integral from 0, for t from 0 to 1."""
    return np.stack([0.5 * legendre.legint(column, lbnd=-1) for column in once.T], axis=1)


SPEED = _integrals(FIT)  # (n + 1, n)
PLACE = _integrals(SPEED)  # (n + 2, n)
AT_SPEED = legendre.legvander(_x, POINTS) @ SPEED
AT_PLACE = legendre.legvander(_x, POINTS + 1) @ PLACE


@dataclass(frozen=True, kw_only=True, eq=False)
class Step:
    """A step from ``t`` to ``t + h``: s, ṡ at its beginning, accelerations at its points (n,)."""

    t: float
    h: float
    s: float
    speed: float
    accelerations: Array

    @property
    def start(self) -> tuple[float, float]:
        """The state at its beginning."""
        return self.s, self.speed

    @cached_property
    def _coefficients(self) -> Array:
        """Of the place beyond that at constant speed, the gained speed, the acceleration."""
        found = np.zeros((POINTS + 2, 3))
        found[:, 0] = self.h**2 * (PLACE @ self.accelerations)
        found[:-1, 1] = self.h * (SPEED @ self.accelerations)
        found[:-2, 2] = FIT @ self.accelerations
        return found

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """s, ṡ and s̈ at times (B,) within the step."""
        x = 2.0 * (np.asarray(t) - self.t) / self.h - 1.0
        moved, gained, bend = (legendre.legvander(x, POINTS + 1) @ self._coefficients).T
        place: Array = self.s + 0.5 * (x + 1.0) * self.h * self.speed + moved
        return place, self.speed + gained, bend

    @property
    def nodes(self) -> Array:
        """The times of its points, (n,)."""
        return self.t + self.h * C

    def integral(self, values: Array, t: Array) -> Array:
        """The integral of a function with values at the points (n,), up to times (B,)."""
        x = 2.0 * (np.asarray(t) - self.t) / self.h - 1.0
        found: Array = legendre.legvander(x, POINTS) @ (self.h * (SPEED @ values))
        return found


def try_step(
    acceleration: Callable[[Array, Array, Array], Array],
    t: float,
    s: float,
    speed: float,
    h: float,
    rougher: float = math.inf,
) -> tuple[Step | None, float, float]:
    """A step of the length ``h``, ``None`` if it does not succeed, the length to try next, and its
    last coefficients relative to the accelerations; ``rougher``: those of the longer step before.
    """
    times = t + h * C
    guess = acceleration(np.array([s]), np.array([speed]), np.array([t]))
    if not np.isfinite(guess[0]):
        return None, _SMALLEST * h, math.inf
    a = np.full(POINTS, float(guess[0]))
    jacobian, floor = None, 0.0
    for round_ in range(_MOST_ROUNDS):
        w = speed + h * (AT_SPEED @ a)
        place = s + h * C * speed + h**2 * (AT_PLACE @ a)
        if jacobian is None or round_ == _MOST_ROUNDS // 2:
            found, jacobian, steepest = _linearise(acceleration, place, w, times, h)
            floor = NOISE * EPSILON * float(np.abs(place).max()) * steepest
        else:
            found = acceleration(place, w, times)
        if not np.isfinite(found).all() or not np.isfinite(jacobian).all():
            return None, _SMALLEST * h, math.inf
        change = np.linalg.solve(jacobian, found - a)
        a = a + change
        if not np.isfinite(a).all():
            return None, _SMALLEST * h, math.inf
        size = np.abs(a).max() + abs(speed) / abs(h)
        if np.abs(change).max() <= _SETTLED * POINTS * size:
            break
    else:
        if np.abs(change).max() > 1e-10 * size:
            return None, 0.5 * h, math.inf
    tail, largest = float(np.abs((FIT @ a)[-2:]).max()), float(np.abs(a).max())
    scale = max(abs(speed), abs(h) * largest)
    rough = tail / largest if largest > 0.0 else 0.0
    error = abs(h) * tail / scale if scale > 0.0 else 0.0
    factor = _LARGEST
    if error > 0.0:
        factor = min(_LARGEST, _SAFETY * (_TOLERANCE / error) ** (1.0 / POINTS))
    # where large forces balance, what a shorter step does not reduce is their rounding
    noise = rough < _ROUNDING and rough > 0.5 * rougher
    # near rest accelerations follow places to rounding only
    noise |= tail <= floor
    if error > 30.0 * _TOLERANCE and not noise:
        return None, max(_SMALLEST, min(factor, 0.7)) * h, rough
    factor = _GROWTH if noise else factor
    step = Step(t=t, h=h, s=s, speed=speed, accelerations=a)
    return step, max(factor, _SMALLEST) * h, rough


def _linearise(
    acceleration: Callable[[Array, Array, Array], Array],
    place: Array,
    w: Array,
    times: Array,
    h: float,
) -> tuple[Array, Array, float]:
    """Accelerations at all points, the Jacobian of the collocation equations, (n, n), and the
    largest derivative by the place.
    """
    eps = math.sqrt(EPSILON)
    # of the way of the step, so that units change nothing
    ds = eps * (max(float(np.abs(h * w).max()), float(np.abs(place).max()) * eps) or 1.0)
    dw = eps * max(float(np.abs(w).max()), abs(ds / h))
    many = acceleration(
        np.concatenate([place, place + ds, place]),
        np.concatenate([w, w, w + dw]),
        np.concatenate([times] * 3),
    ).reshape(3, -1)
    by_place, by_speed = (many[1] - many[0]) / ds, (many[2] - many[0]) / dw
    jacobian = (
        np.eye(POINTS) - by_place[:, None] * (h**2 * AT_PLACE) - by_speed[:, None] * (h * AT_SPEED)
    )
    return many[0], jacobian, float(np.abs(by_place).max())


def shorter_step(step: Step, low: float, high: float) -> float | None:
    """The length that leads just beyond the ends of a leg, of a step that goes on further."""
    times = np.linspace(step.t, step.t + step.h, _LOOKS)
    s = step.at(times)[0]
    outside = np.flatnonzero((s < low) | (s > high))
    if not len(outside):
        return None
    # between the last place that is known and the first one that is not
    k = int(outside[0])
    within = float(times[k - 1] - step.t) if k > 1 else 0.0
    return max(within, 0.5 * float(times[k] - step.t))
