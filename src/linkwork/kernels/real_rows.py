"""Real equations of a loop table: linear ones, and those given by functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["EnclosedRow", "FunctionRow", "LinearRows", "hessian_of"]


class FunctionRow(Protocol):
    """A real equation given by any smooth function of a few variables."""

    @property
    def variables(self) -> tuple[int, ...]:
        """Indices of the variables it depends on."""

    def moved(self, new_index: dict[int, int]) -> FunctionRow:
        """The same row over renumbered variables."""

    def value_and_gradient(self, v: Array) -> tuple[Array, Array]:
        """Value (B,) and derivatives by ``variables`` (B, len(variables))."""

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """Second derivative along d, (B,)."""

    def repeats_after(self, turns: Array) -> bool:
        """Whether ``variables`` (k,) moved by these whole turns are known to satisfy the same."""


@runtime_checkable
class EnclosedRow(FunctionRow, Protocol):
    """A row that is known over boxes."""

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest value (2, B), and derivatives by ``variables`` (2, B, k), over boxes
        around v (B, N) with half widths ``box`` (B, N).
        """


def hessian_of(row: FunctionRow, v: Array) -> Array:
    """The second derivatives of a row at one position v (N,), (N, N)."""
    # a row may name a variable twice
    i, j = (index.ravel() for index in np.meshgrid(*[np.unique(row.variables)] * 2))
    steps, places = np.eye(len(v)), np.tile(v, (len(i), 1))
    along = row.second_directional_derivative(places, steps[i] + steps[j])
    across = row.second_directional_derivative(places, steps[i] - steps[j])
    found = np.zeros((len(v), len(v)))
    found[i, j] = 0.25 * (along - across)  # eq. (5)
    return found


@dataclass(frozen=True, kw_only=True)
class LinearRows:
    """Rows Σ_k weight v_k + constant = 0 as sparse entries."""

    constant: Array
    row: IndexArray
    variable: IndexArray
    weight: Array

    @classmethod
    def none(cls) -> LinearRows:
        """No rows."""
        empty = np.zeros(0, dtype=np.intp)
        return cls(constant=np.zeros(0), row=empty, variable=empty, weight=np.zeros(0))
