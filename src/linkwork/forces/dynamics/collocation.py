"""Steps of s̈ = a(s, ṡ, t), of one number or several, by collocation at Gauss points.

At n points the polynomial of degree n - 1 for s̈ equals a; its integrals give ṡ and s. The ends of
steps are of order 2n (Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3); between
them the last coefficients of the polynomial show its error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from linkwork.core.foundation.arrays import AnyArray, Array, IndexArray
from linkwork.core.foundation.rounding import EPSILON

POINTS = 12
_MOST_ROUNDS = 12
_SETTLED = 1e-15  # of the accelerations: a change that is rounding
_UNSETTLED = 1e-10  # a larger change after all rounds: the iteration has failed
_TOLERANCE = 1e-13  # of the speed: error of the polynomial between the ends of a step
_ROUNDING = 1e-9  # of the accelerations: last coefficients above that are not rounding
_LARGEST, _SMALLEST, _SAFETY, _GROWTH = 3.0, 0.2, 0.8, 1.5  # of steps; the last with rounding
_LOOKS = 33  # places of a step at which it may have left its leg
_NOISE = 16.0  # roundings of a place in an acceleration

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

#: Accelerations (B, ...) at places (B, ...), speeds (B, ...) and times (B,).
Acceleration = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True, kw_only=True, eq=False)
class Step:
    """A step from ``t`` to ``t + h``: s, ṡ at its beginning, accelerations at its points.

    s and ṡ are numbers with accelerations (n,), or vectors (p,) with accelerations (n, p).
    """

    t: float
    h: float
    s: float | Array
    speed: float | Array
    accelerations: Array

    @cached_property
    def _coefficients(self) -> Array:
        """Of the place beyond that at constant speed, the gained speed, the acceleration."""
        found = np.zeros((POINTS + 2, 3, *self.accelerations.shape[1:]))
        found[:, 0] = self.h**2 * (PLACE @ self.accelerations)
        found[:-1, 1] = self.h * (SPEED @ self.accelerations)
        found[:-2, 2] = FIT @ self.accelerations
        return found

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """s, ṡ and s̈ at times (B,) within the step."""
        x = 2.0 * (np.asarray(t) - self.t) / self.h - 1.0
        powers = legendre.legvander(x, POINTS + 1)
        moved, gained, bend = np.moveaxis(np.tensordot(powers, self._coefficients, 1), 1, 0)
        place: Array = self.s + np.multiply.outer(0.5 * (x + 1.0) * self.h, self.speed) + moved
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
    acceleration: Acceleration,
    t: float,
    s: float | Array,
    speed: float | Array,
    h: float,
    *,
    unit: float = 0.0,
    rougher: float = math.inf,
) -> tuple[Step | None, float, float]:
    """A step of the length ``h``, ``None`` if it does not succeed, the length to try next, and its
    last coefficients relative to the accelerations.

    ``unit``: the natural size of places, all of one size, if they have one; ``rougher``: the last
    coefficients of the longer step before.
    """
    times = t + h * C
    a = np.repeat(acceleration(np.array([s]), np.array([speed]), np.array([t])), POINTS, axis=0)
    if not np.isfinite(a).all():
        return None, _SMALLEST * h, math.inf
    jacobian, floor = None, 0.0
    for round_ in range(_MOST_ROUNDS):
        w = speed + h * (AT_SPEED @ a)
        place = s + np.multiply.outer(h * C, speed) + h**2 * (AT_PLACE @ a)  # eq. (97)
        if jacobian is None or round_ == _MOST_ROUNDS // 2:
            found, jacobian, steepest = _linearise(acceleration, place, w, times, h, unit)
            floor = _NOISE * EPSILON * (unit + float(np.abs(place).max())) * steepest
        else:
            found = acceleration(place, w, times)
        if not np.isfinite(found).all() or not np.isfinite(jacobian).all():
            return None, _SMALLEST * h, math.inf
        change = np.linalg.solve(jacobian, (found - a).ravel()).reshape(a.shape)
        a = a + change
        if not np.isfinite(a).all():
            return None, _SMALLEST * h, math.inf
        size = np.abs(a).max() + np.abs(speed).max() / abs(h)
        if np.abs(change).max() <= max(_SETTLED * POINTS * size, floor):
            break
    else:
        if np.abs(change).max() > max(_UNSETTLED * size, floor):
            return None, 0.5 * h, math.inf
    tail, largest = float(np.abs((FIT @ a)[-2:]).max()), float(np.abs(a).max())
    scale = max(float(np.abs(speed).max()), abs(h) * largest)
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
    acceleration: Acceleration, place: Array, w: Array, times: Array, h: float, unit: float
) -> tuple[Array, Array, float]:
    """Accelerations at all points, the Jacobian of the collocation equations, (np, np), and the
    largest derivative by a place.
    """
    count, p = len(place), place[0].size
    eps = math.sqrt(EPSILON)
    # of the way of the step, so that units change nothing
    way = max(float(np.abs(h * w).max()), unit, float(np.abs(place).max()) * eps)
    ds = eps * (way or 1.0)
    dw = eps * max(float(np.abs(w).max()), abs(ds / h))
    units = np.eye(p).reshape(p, *place.shape[1:])
    places = [place, *(place + ds * one for one in units), *[place] * p]
    speeds = [w] * (p + 1) + [w + dw * one for one in units]
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
    steepest = float(np.abs(by_place).max())
    return many[0].reshape(place.shape), jacobian.reshape(count * p, count * p), steepest


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


# ----------------------------------------------------------------------
# Functions along a leg as Chebyshev polynomials on panels, refined until they are resolved.


_NODES = 24
_TAIL = 3  # coefficients that show whether a function is resolved
_RESOLVED = 2e-14  # of the size on the leg
_FALLS = 1e-10  # of the size: coefficients below that do not fall with the panel are rounding
_FARTHEST = 100.0  # half panels: polynomials have no meaning there
_DEEPEST = 20  # halvings of a panel: what is then not resolved is rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Panels:
    """K functions on P panels of a leg.

    Parameters
    ----------
    edges : (P + 1,)
        Rising.
    coefficients : (P, nodes, K)
        Of Chebyshev polynomials on every panel.
    """

    edges: Array
    coefficients: Array

    def locate(self, at: Array) -> tuple[IndexArray, Array]:
        """The panel of every place (B,), and its place there from -1 to 1; beyond at the ends."""
        panel = np.clip(np.searchsorted(self.edges, at, side="right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        return panel, (2.0 * at - low - high) / (high - low)

    def __call__(self, at: Array) -> Array:
        """The functions at places (B,), (B, K); NaN far beyond the ends."""
        panel, x = self.locate(at)
        count = self.coefficients.shape[1]
        powers = np.cos(np.arccos(np.clip(x, -1.0, 1.0))[:, None] * np.arange(count))
        beyond = np.abs(x) > 1.0
        if beyond.any():
            known = np.where(np.abs(x) < _FARTHEST, x, np.nan)
            powers[beyond] = np.polynomial.chebyshev.chebvander(known[beyond], count - 1)
        if len(self.coefficients) == 1:
            return np.asarray(powers @ self.coefficients[0])
        found: Array = np.einsum("bm,bmk->bk", powers, self.coefficients[panel])
        return found

    def part(self, columns: slice) -> Panels:
        """Some of the functions."""
        return Panels(edges=self.edges, coefficients=self.coefficients[:, :, columns].copy())

    def with_slope(self) -> Panels:
        """The functions, and behind them the derivative of the first one."""
        own = np.polynomial.chebyshev.chebder(self.coefficients[:, :, 0], axis=1)
        half = 0.5 * np.diff(self.edges)
        slope = np.zeros((*self.coefficients.shape[:2], 1))
        slope[:, :-1, 0] = own / half[:, None]
        return Panels(
            edges=self.edges, coefficients=np.concatenate([self.coefficients, slope], axis=2)
        )


def fit_panels(
    function: Callable[[Array], Array],
    edges: Sequence[float] | Array,
    groups: IndexArray,
    least: Array,
    deepest: int | None = None,
) -> Panels:
    """Fit functions, (B,) → (B, K), between rising edges, and on halves of these panels where
    needed.

    ``groups`` (K,): functions of one number have one size, which is at least ``least`` (K,).
    """
    x = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    fit = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, _NODES - 1))
    done: list[tuple[float, float, Array]] = []
    waiting = [(float(a), float(b)) for a, b in pairwise(edges)]
    before = np.full((len(waiting), len(groups)), np.inf)
    size = least
    deepest = _DEEPEST if deepest is None else deepest
    for depth in range(deepest + 1):
        places = np.concatenate(
            [0.5 * (a + b) + 0.5 * (b - a) * x for a, b in waiting] or [np.zeros(0)]
        )
        values = function(places).reshape(len(waiting), _NODES, -1)
        largest = np.maximum(size, np.abs(values).max(axis=(0, 1)))
        size = np.array([largest[groups == own].max() for own in groups])
        coefficients = np.einsum("mn,pnk->pmk", fit, values)
        tails = np.abs(coefficients[:, -_TAIL:]).max(axis=1)
        noise = (tails < _FALLS * size) & (tails > 0.1 * before)
        rough = ((tails > _RESOLVED * size) & ~noise).any(axis=1) & (depth < deepest)
        parts: list[tuple[float, float]] = []
        for (a, b), own, split in zip(waiting, coefficients, rough, strict=True):
            if split:
                parts += [(a, 0.5 * (a + b)), (0.5 * (a + b), b)]
            else:
                done.append((a, b, own))
        waiting, before = parts, np.repeat(tails[rough], 2, axis=0)
        if not waiting:
            break
    done.sort(key=lambda panel: panel[0])
    return Panels(
        edges=np.array([edges[0], *(b for _, b, _ in done)]),
        coefficients=np.stack([own for _, _, own in done]),
    )
