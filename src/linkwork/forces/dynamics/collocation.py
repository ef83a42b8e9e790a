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
from numpy.polynomial import chebyshev, legendre

from linkwork.core.foundation.arrays import EPSILON, AnyArray, Array, IndexArray
from linkwork.core.motion.branch_rows import between_rows
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Solved
from linkwork.forces.reactions.switches import switch_places

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


# ----------------------------------------------------------------------
# A motor whose torque goes on straight beyond the corners of its table.


class HeldMotor:
    """The motor on the input with a number; ``piece`` counts the corners below its speed."""

    def __init__(self, model: Model, number: int) -> None:
        own, which = model.description, model.description.inputs[number]
        assert which.motor is not None
        kind = "link" if model.equations.inputs[number].kind == "angle" else "slider"
        self.constant = which.motor.constant
        self.scale = float(model.input_scale[number])
        self._curve = which.motor.curve(kind, own.numbers, own.length)
        #: The speeds of its table, (C,); none without.
        self.corners = which.motor.corners(kind, own.numbers, own.length)
        self.piece: int | None = None

    def torque(self, rate: Array) -> Array:
        """Its torque, or force, at rates [rad/s] or [length/s], (B,)."""
        speed = rate / self.scale
        if self.piece is None or not len(self.corners):
            return self._curve(speed)
        ends = np.clip([self.piece - 1, self.piece], 0, len(self.corners) - 1)
        low, high = self.corners[ends]
        first, last = self._curve(self.corners[ends])
        slope = (last - first) / (high - low) if high > low else 0.0
        found: Array = first + slope * (speed - low)
        return found

    def margins(self, rate: Array) -> list[Array]:
        """How far it is above every corner, (B,) each."""
        return [rate / self.scale - corner for corner in self.corners]


def motors_of(model: Model) -> list[HeldMotor | None]:
    """The motors of all inputs."""
    inputs = enumerate(model.description.inputs)
    return [None if which.motor is None else HeldMotor(model, k) for k, which in inputs]


# ----------------------------------------------------------------------
# A quantity of a motion as polynomials between the switches of the loads, with its integrals.


_PARTS = 12  # of the whole way, each a panel at first
_DEEPEST_PANEL = (
    45  # halvings of a panel towards a jump that no load announces: its place to rounding
)
_DIFFERS = 1e-7  # of the size: a row that differs more lies in a feature that the panels missed
_TRIES = 3  # to find such features
_PANEL_NODES = 32  # of Gauss' rule: exact for squares of the polynomials
_WAVES = 8.0  # radians of a wave on a piece for which the nodes suffice
_SAME_EDGE = 1e-14  # of the whole way: edges so near to each other are one


@dataclass(frozen=True, kw_only=True, eq=False)
class Piecewise:
    """A quantity, in its file unit, over the leading input or time, [rad], [length] or [s]."""

    panels: Panels

    @property
    def width(self) -> float:
        """Of the whole range."""
        return float(np.ptp(self.panels.edges))

    def nodes(self, order: float = 0.0) -> tuple[Array, Array]:
        """Places and weights (B,) of Gauss' rule, for products with waves of an order too."""
        x, w = np.polynomial.legendre.leggauss(_PANEL_NODES)
        parts = [
            np.linspace(a, b, 2 + int(order * (b - a) / _WAVES))
            for a, b in pairwise(self.panels.edges)
        ]
        low = np.concatenate([part[:-1] for part in parts])[:, None]
        half = 0.5 * (np.concatenate([part[1:] for part in parts])[:, None] - low)
        return (low + half * (1.0 + x)).ravel(), (half * w).ravel()

    def mean(self, power: int = 1) -> float:
        """The mean of the quantity, or of its square."""
        t, w = self.nodes()
        return float(w @ self.panels(t)[:, 0] ** power) / self.width

    def wave(self, order: int) -> complex:
        """The mean of the quantity times e^(-i order t)."""
        t, w = self.nodes(order)
        return complex((w * self.panels(t)[:, 0]) @ np.exp(-1j * order * t)) / self.width

    def extremes(self) -> tuple[Array, Array]:
        """Places and values, the largest and the smallest among them: on both sides of every edge,
        and where the derivative is zero.
        """
        own = self.panels.coefficients[:, :, 0]
        slopes = np.asarray(chebyshev.chebder(own, axis=1), dtype=float)
        return _at_zeros(self.panels.edges, slopes, own)

    def missing(self, level: float) -> tuple[Array, Array]:
        """The integral of a level less the quantity, with its extremes."""
        edges, own = self.panels.edges, -self.panels.coefficients[:, :, 0]
        own[:, 0] += level
        areas = chebyshev.chebint(own, lbnd=-1, axis=1) * (0.5 * np.diff(edges))[:, None]
        ends = areas.sum(axis=1)  # Chebyshev polynomials are 1 at the end of their panel
        areas[:, 0] += np.cumsum(ends) - ends
        return _at_zeros(edges, own, areas)


def _at_zeros(edges: Array, slopes: Array, values: Array) -> tuple[Array, Array]:
    """Polynomials (P, n) at both ends of their panels and at the zeros of others: places, values.

    Complex zeros add a place near them, which does no harm.
    """
    places, found = [], []
    for (low, high), slope, value in zip(pairwise(edges), slopes, values, strict=True):
        known = chebyshev.chebtrim(slope, 1e-15 * float(np.abs(slope).max()))
        x = np.clip(chebyshev.chebroots(known).real, -1.0, 1.0) if len(known) > 1 else np.zeros(0)
        x = np.sort(np.concatenate([[-1.0, 1.0], x]))
        places.append(0.5 * (low + high) + 0.5 * (high - low) * x)
        places[-1][[0, -1]] = low, high
        found.append(chebyshev.chebval(x, value))
    return np.concatenate(places), np.concatenate(found)


def piecewise(model: Model, motion: Motion, of: Callable[[Solved], Array]) -> Piecewise:
    """A quantity over the table of a motion; all its rows have it.

    Panels end where loads switch; jumps and corners of other origin, as of a cam's law, are closed
    in by halving panels. Where a panel has no value, it is NaN.
    """
    lead = model.motion_quantities.names.lead
    at = between_rows(model, motion)
    scale = float(model.input_scale[list(motion.inputs).index(lead)])
    t, rows = np.asarray(motion.inputs[lead]) * scale, np.asarray(of(motion), dtype=float)
    order = np.argsort(t, kind="stable")
    t, rows = t[order], rows[order]

    def quantity(places: Array) -> Array:
        with np.errstate(all="ignore"):
            return np.asarray(of(at(places)))[:, None]

    edges = np.linspace(t[0], t[-1], _PARTS + 1)
    edges = np.append(edges, switch_places(model, at, t)[1])
    one, none = np.zeros(1, dtype=np.intp), np.zeros(1)
    for _ in range(_TRIES):
        edges = np.unique(edges)
        edges = edges[np.append(True, np.diff(edges) > _SAME_EDGE * (t[-1] - t[0]))]
        panels = fit_panels(quantity, edges, one, none, _DEEPEST_PANEL)
        near = np.abs(t[:, None] - panels.edges).min(axis=1) <= _SAME_EDGE * (t[-1] - t[0])
        wrong = np.abs(panels(t)[:, 0] - rows) > _DIFFERS * np.abs(rows).max()
        if not (wrong & ~near).any():
            break
        edges = np.append(edges, t[wrong])
    return Piecewise(panels=panels)
