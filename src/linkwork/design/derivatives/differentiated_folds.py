"""Dead points as functions of a mechanism's numbers.

At a dead point J is singular, and the position at a fixed input has no derivative. The dead point
itself moves smoothly: with null vectors w and φ of J, F = 0 and wᵀ J φ = 0 are regular equations
of the unknowns and the leading input.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from linkwork.design.derivatives.differentiated_rows import DifferentiatedRows
from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import Array

__all__ = ["DifferentiatedFolds"]

_REGULAR = 1e12  # condition up to which a dead point has digits


class DifferentiatedFolds(DifferentiatedRows):
    """Quantities at B dead points on a tape; parameters as of the base class."""

    @cached_property
    def _null_vectors(self) -> tuple[Array, Array]:
        """w (B, n) and φ (B, N): φ is 0 for inputs."""
        jacobian = self.model.compiled.table.jacobian(self.solution)[:, :, : self.count]
        # the last singular value is the one that vanishes
        u, _, vh = np.linalg.svd(jacobian)
        along = np.zeros_like(self.solution)
        along[:, : self.count] = vh[:, -1]
        return u[:, :, -1], along

    @cached_property
    def variables(self) -> dict[str, Jet]:
        """All variables by symbol; without derivatives by the input, which do not exist here."""
        left, along = self._null_vectors
        zero = np.zeros(len(self.solution))
        jets = {
            symbol: Jet(self.solution[:, k], along[:, k], zero)
            for k, symbol in enumerate(self._symbols)
        }
        rows = self._residuals(jets)
        # eq. (123)
        bend: Any = zero
        for k, row in enumerate(rows):
            bend = bend + row.d1 * left[:, k]
        inverse = self._bordered()
        parts = [row.v for row in rows] + [bend]
        unknown = [*range(self.count), self.lead]
        values = {
            k: self.tape.combine(
                self.solution[:, k], [(-inverse[:, place, i], x) for i, x in enumerate(parts)]
            )
            for place, k in enumerate(unknown)
        }
        # inputs in lock-step follow the leading one
        for k, rate in enumerate(self._input_rate, start=self.count):
            if k != self.lead:
                values[k] = self.tape.combine(self.solution[:, k], [(rate, values[self.lead])])
        # rates by the input are infinite at a dead point
        none = np.full(len(self.solution), np.nan)
        return {symbol: Jet(values[k], none, none) for k, symbol in enumerate(self._symbols)}

    @property
    def lead(self) -> int:
        """The column of the leading input."""
        return self.count + int(np.flatnonzero(self._input_rate == 1.0)[0])

    def _bordered(self) -> Array:
        """The inverse of the derivatives of F and of wᵀ J φ by unknowns and leading input."""
        left, along = self._null_vectors
        table, v = self.model.compiled.table, self.solution
        jacobian = table.jacobian(v)
        directions = [np.eye(v.shape[1])[k] for k in range(self.count)]
        directions.append(np.append(np.zeros(self.count), self._input_rate))
        matrix = np.zeros((len(v), self.count + 1, self.count + 1))
        own = table.second_directional_derivative(v, along)
        for k, direction in enumerate(directions):
            moved = np.broadcast_to(direction, v.shape)
            matrix[:, : self.count, k] = jacobian @ direction
            # D²F[φ, d] by polarisation
            both = table.second_directional_derivative(v, along + moved)
            mixed = 0.5 * (both - own - table.second_directional_derivative(v, moved))
            matrix[:, self.count, k] = (left * mixed).sum(axis=1)
        inverse = np.full_like(matrix, np.nan)
        for k, one in enumerate(matrix):
            # two branches cross at a change point, which a change of a number removes
            if np.isfinite(one).all() and np.linalg.cond(one) < _REGULAR:
                inverse[k] = np.linalg.inv(one)
        return inverse
