"""A motor whose torque goes on straight beyond the corners of its table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from linkwork.core.foundation.arrays import Array
from linkwork.core.motion.model import Model
from linkwork.core.motion.rows_between import between_rows
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Solved
from linkwork.forces.dynamics.collocation import Panels, fit_panels
from linkwork.forces.reactions.switches import switch_places


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
_DEEPEST = 45  # halvings of a panel towards a jump that no load announces: its place to rounding
_DIFFERS = 1e-7  # of the size: a row that differs more lies in a feature that the panels missed
_TRIES = 3  # to find such features
_NODES = 32  # of Gauss' rule: exact for squares of the polynomials
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
        x, w = np.polynomial.legendre.leggauss(_NODES)
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
        panels = fit_panels(quantity, edges, one, none, _DEEPEST)
        near = np.abs(t[:, None] - panels.edges).min(axis=1) <= _SAME_EDGE * (t[-1] - t[0])
        wrong = np.abs(panels(t)[:, 0] - rows) > _DIFFERS * np.abs(rows).max()
        if not (wrong & ~near).any():
            break
        edges = np.append(edges, t[wrong])
    return Piecewise(panels=panels)
