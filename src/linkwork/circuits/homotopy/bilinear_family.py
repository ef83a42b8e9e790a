"""Families of bilinear systems: mechanisms with the same structure.

Systems with the same products, the same zeros and the same sums within the columns of their closure
matrices (a link with three joints enters three loops with a, b and a + b) form a family.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import ParameterHomotopy, StartHomotopy
from linkwork.circuits.homotopy.counts import (
    SolutionBound,
    Theorem,
    bound_by_products,
    bound_by_sums,
)
from linkwork.circuits.homotopy.isolated_roots import RootFamily
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.numerics.bilinear import BilinearSystem, columns_of, sums_hold


@dataclass(frozen=True)
class Structure(RootFamily[BilinearSystem]):
    """The structure of a family of systems: products, and columns as sums of free coefficients."""

    def bound(self, found: int) -> SolutionBound:
        """The bound that ``found`` solutions reach, else the smallest one known."""
        simple = bound_by_products(self.rows)
        if found == simple.number:  # the other one takes longer
            return simple
        sharper = bound_by_sums(self.rows, self.columns)
        return simple if sharper is None or sharper.number >= simple.number else sharper

    def bound_of(self, system: BilinearSystem, spread: Array, found: int) -> SolutionBound:
        """The same for one member whose ``left`` (L, M + 1) is known within ``spread``.

        Its sums have to hold within rounding.
        """
        best = self.bound(found)
        if best.theorem is Theorem.LAMAN and not sums_hold(self.columns, system.left, spread):
            return bound_by_products(self.rows)
        return best

    def complete(self, found: int) -> bool:
        """Whether this many solutions of a member are all, by a theorem."""
        return found == self.bound(found).number

    def member(self, left: ComplexArray, right: ComplexArray) -> BilinearSystem:
        """The member with these closures."""
        return BilinearSystem(left=left, right=right, rows=np.array(self.rows))

    def from_products(self, goal: BilinearSystem, rng: np.random.Generator) -> StartHomotopy:
        """C(2L, L) paths to all isolated solutions of a member."""
        return StartHomotopy.of(goal, rng)

    def between(
        self,
        start: BilinearSystem,
        goal: BilinearSystem,
        rng: np.random.Generator,
        *,
        nearest: bool = False,
    ) -> ParameterHomotopy:
        """Paths from member to member."""
        return ParameterHomotopy.between(start, goal, rng, nearest=nearest)


def structure_of(system: BilinearSystem) -> Structure:
    """The family of a system."""
    return Structure(rows=system.products, columns=columns_of(system.left))
