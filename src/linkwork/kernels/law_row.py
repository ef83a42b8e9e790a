"""Rows that tie variables by a function of one sum: Σ a v + constant - f(Σ w v + offset) = 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.kernels.piecewise import Piecewise

__all__ = ["TURN_ROUNDING", "LawRow"]

_TURN = 2.0 * np.pi
TURN_ROUNDING = 8.0 * UNIT_ROUNDOFF  # a third is no float, but three of them are one turn


@dataclass(frozen=True, kw_only=True, eq=False)
class LawRow:
    """One real equation with a function whose bend is bounded.

    Parameters
    ----------
    variables : tuple of int
    weights, constant
        a (k,) and the constant of the straight part.
    law : Piecewise
    inner, offset
        w (k,) and the offset of the function's argument.
    error
        How far the function may be from the one that it stands for.
    """

    variables: tuple[int, ...]
    weights: Array
    constant: float
    law: Piecewise
    inner: Array
    offset: float
    error: float = 0.0

    def moved(self, new_index: dict[int, int]) -> LawRow:
        """The same row over renumbered variables."""
        return replace(self, variables=tuple(new_index[k] for k in self.variables))

    @cached_property
    def terms(self) -> list[tuple[int, float, float]]:
        """Every variable with its weight and inner weight."""
        parts = self.weights.tolist(), self.inner.tolist()
        return list(zip(self.variables, *parts, strict=True))

    def jet_at(self, v: Sequence[float]) -> tuple[float, float, float]:
        """The row's value at one position v (N,), and both derivatives of the law there."""
        straight, argument = self.constant, self.offset
        for k, a, w in self.terms:
            straight += a * v[k]
            argument += w * v[k]
        value, slope, bend = self.law.jet_at(argument)
        return straight - value, slope, bend

    def _argument(self, v: Array) -> Array:
        argument: Array = v[:, list(self.variables)] @ self.inner + self.offset
        return argument

    def value_and_gradient(self, v: Array) -> tuple[Array, Array]:
        """Value (B,) and derivatives by ``variables`` (B, k)."""
        value, slope, _ = self.law.jet(self._argument(v))
        straight = v[:, list(self.variables)] @ self.weights + self.constant
        return straight - value, self.weights - slope[:, None] * self.inner  # eq. (4)

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """Second derivative along d, (B,)."""
        turned = d[:, list(self.variables)] @ self.inner
        # second derivative of eq. (4)
        second: Array = -self.law.jet(self._argument(v))[2] * turned**2
        return second

    def repeats_after(self, turns: Array) -> bool:
        """Whether ``variables`` (k,) moved by this many whole turns satisfy the same equation."""
        straight, bulk = self.weights @ turns, np.abs(self.weights) @ np.abs(turns)
        inner, size = self.inner @ turns, np.abs(self.inner) @ np.abs(turns)
        if self.law.periodic:
            unit = _TURN / self.law.period
            inner, size = inner * unit - np.round(inner * unit), size * unit
        return bool(abs(straight) <= TURN_ROUNDING * bulk and abs(inner) <= TURN_ROUNDING * size)

    @property
    def bend(self) -> float:
        """No smaller than the second derivative of the function anywhere."""
        return self.law.bend

    def rounding(self, v: Array) -> tuple[Array, Array]:
        """Bounds of the error of the value (B,) and of its derivatives (B, k)."""
        x = v[:, list(self.variables)]
        value, slope = self.law.rounding(self._argument(v))
        argument = np.abs(x) @ np.abs(self.inner) + abs(self.offset)
        count = len(self.variables) + 3.0
        moved = count * UNIT_ROUNDOFF * argument
        straight = np.abs(x) @ np.abs(self.weights) + abs(self.constant)
        steepest = np.abs(self.law.jet(self._argument(v))[1]) + self.law.bend * moved
        size = np.abs(self.law(self._argument(v)))
        # polynomials of degree five that are off by so much have slopes off by 50 of it a piece
        slope = slope + 50.0 * self.error * len(self.law.powers) / self.law.period
        value = value + self.error
        error = value + steepest * moved + UNIT_ROUNDOFF * (count * straight + 2.0 * size)
        slopes = (slope + self.law.bend * moved + 2.0 * UNIT_ROUNDOFF * steepest)[:, None] * np.abs(
            self.inner
        )
        return error, slopes + 2.0 * UNIT_ROUNDOFF * np.abs(self.weights)
