"""Real equations of a loop table: linear ones, and those given by functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["FunctionRow", "LinearRows"]


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
