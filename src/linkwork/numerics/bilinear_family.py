"""Families of bilinear systems: what makes two mechanisms relatives.

Systems with the same products, the same zeros and the same sums within the columns of their closure
matrices (a link with three joints enters three loops with a, b and a + b) form a family.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from linkwork.foundation.arrays import ComplexArray
from linkwork.numerics.bilinear import BilinearSystem
from linkwork.numerics.bilinear_homotopy import ParameterHomotopy, StartHomotopy
from linkwork.numerics.generic_roots import SEED, isolated_roots
from linkwork.numerics.polynomial_system import Roots

__all__ = [
    "Columns",
    "Structure",
    "bilinear_roots",
    "columns_of",
    "random_closures",
    "structure_of",
]

#: For every column of a closure matrix its L coefficients as tuples of weights of free ones.
Columns = tuple[tuple[tuple[int, ...], ...], ...]

_SAME_SUM = 1e-11  # relative: two sums of coefficients are the same by construction
_LARGEST_FREE = 6  # coefficients of a column among which sums are looked for


@dataclass(frozen=True)
class Structure:
    """What systems of one family share: products, and columns as sums of free coefficients.

    ``columns``: for every column of the closure matrix the L coefficients as tuples of weights of
    the column's free ones.
    """

    rows: tuple[tuple[int, ...], ...]
    columns: Columns

    def random(self, rng: np.random.Generator) -> BilinearSystem:
        """A member with random complex free coefficients."""
        left, right = (random_closures(self.columns, rng) for _ in range(2))
        return BilinearSystem(left=left, right=right, rows=np.array(self.rows))

    def generator(self, purpose: int) -> np.random.Generator:
        """Random numbers of the family's own, the same in every run and in any order of calls."""
        flat = [k for row in self.rows for k in row]
        flat += [w + 1 for column in self.columns for entry in column for w in (*entry, 2)]
        return np.random.default_rng([SEED, purpose, *flat])

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
    return Structure(rows=tuple(map(tuple, system.rows.tolist())), columns=columns_of(system.left))


def bilinear_roots(system: BilinearSystem) -> Roots:
    """All isolated solutions of a system with at least two loops."""
    return isolated_roots(system, structure_of(system))


def columns_of(closures: ComplexArray) -> Columns:
    """The columns of a closure matrix (L, K) as sums of free coefficients."""
    return tuple(_sums(column.tolist()) for column in closures.T)


def random_closures(columns: Columns, rng: np.random.Generator) -> ComplexArray:
    """A closure matrix (L, K) with such columns."""
    parts = []
    for column in columns:
        weights = np.array(column, dtype=float)
        free = rng.normal(size=weights.shape[1]) + 1j * rng.normal(size=weights.shape[1])
        parts.append(weights @ free)
    return np.stack(parts, axis=1)


def _sums(column: list[complex]) -> tuple[tuple[int, ...], ...]:
    """Every coefficient of a column as a sum, with weights -1, 0 and 1, of earlier free ones."""
    size = max(map(abs, column))
    free: list[complex] = []
    found: list[tuple[int, ...]] = []
    for value in column:
        few = free[:_LARGEST_FREE]
        for weights in product((0, 1, -1), repeat=len(few)):
            rest = value - sum(w * c for w, c in zip(weights, few, strict=True))
            if abs(rest) <= _SAME_SUM * size:
                found.append(weights)
                break
        else:
            found.append((*(0 for _ in free), 1))
            free.append(value)
    width = len(free)
    return tuple((*weights, *(0 for _ in range(width - len(weights)))) for weights in found)
