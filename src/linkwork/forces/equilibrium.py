"""Solution of the equilibrium of free bodies, and which forces it does not determine.

Forces on all bodies sum to zero: W r + b = 0, with W the transposed Jacobian of the joint
conditions. Its null vectors are self-stresses: what they load is not determined. Null vectors of Wᵀ
are freedoms in which nothing balances the loads, as at a dead point. Without both W is square and
regular.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.products import matrix_vector
from linkwork.foundation.rounding import RANK_TOLERANCE
from linkwork.foundation.stacked_systems import inverses

__all__ = ["Balance", "balance"]

_REGULAR = 1e12  # condition up to which forces have digits
_BALANCED = 1e-8  # relative error of equilibrium
_LOADED = 1e-7  # part of a self-stress that counts as load


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """The inverse of W in B rows.

    Parameters
    ----------
    matrix : (B, E, n)
    inverse : (B, n, E)
        A generalised inverse; NaN where W has no usable rank.
    stress : (B, n, n), optional
        The projector on self-stresses; ``None`` if there are none.
    """

    matrix: Array
    inverse: Array
    stress: Array | None

    def solve(self, loads: Array) -> Array:
        """The unknowns (B, n) for loads (B, E), refined once; NaN where nothing balances them."""
        # eq. (72)
        r = -matrix_vector(self.inverse, loads)
        # an explicit inverse loses digits where W is ill-conditioned
        rest = matrix_vector(self.matrix, r) + loads
        r -= matrix_vector(self.inverse, rest)
        if self.stress is not None:
            # loads on an idle freedom, or at a dead point, are not balanced by any force
            rest = np.abs(matrix_vector(self.matrix, r) + loads).max(axis=1, initial=0.0)
            size = np.abs(loads).max(axis=1, initial=0.0) + np.abs(r).max(axis=1, initial=0.0)
            r[~(rest <= _BALANCED * size)] = np.nan
        return r

    def undetermined(self, factors: Array) -> BoolArray:
        """Whether a self-stress changes Σ factor · unknown, (B,), for factors (B, n)."""
        if self.stress is None:
            return np.zeros(len(factors), dtype=bool)
        # eq. (73)
        part = np.linalg.norm(np.einsum("bi,bij->bj", factors, self.stress), axis=1)
        found: BoolArray = part > _LOADED * np.linalg.norm(factors, axis=1)
        return found


def balance(matrix: Array) -> Balance:
    """Invert W (B, E, n); rows that are not square or regular by singular values."""
    rows, equations, unknowns = matrix.shape
    size = _norms(matrix)
    fine = np.isfinite(size)
    inverse = np.full((rows, unknowns, equations), np.nan)
    regular = np.zeros(rows, dtype=bool)
    if equations == unknowns:
        if fine.all():
            inverse = inverses(matrix)
        else:
            inverse[fine] = inverses(matrix[fine])
        with np.errstate(all="ignore"):
            # forces and scaled moments have one unit, so that rows and columns compare
            regular = size * _norms(inverse) <= _REGULAR
    left = np.flatnonzero(fine & ~regular)
    if not len(left):
        return Balance(matrix=matrix, inverse=inverse, stress=None)
    stress = np.zeros((rows, unknowns, unknowns))
    # the square case is cheaper by far; self-stresses and idle freedoms need singular values
    u, sizes, vh = np.linalg.svd(matrix[left], full_matrices=False)
    kept = sizes > RANK_TOLERANCE * sizes[:, :1]
    with np.errstate(divide="ignore"):
        weights = np.where(kept, 1.0 / sizes, 0.0)
    used = np.where(kept[:, :, None], vh, 0.0)
    inverse[left] = np.einsum("bki,bk,bjk->bij", used, weights, u)
    # eq. (73)
    stress[left] = np.eye(unknowns) - np.einsum("bki,bkj->bij", used, used)
    return Balance(matrix=matrix, inverse=inverse, stress=stress)


def _norms(matrices: Array) -> Array:
    """The largest sum of sizes in a row of every matrix, (B,)."""
    # a product with ones adds up short rows several times faster than a sum
    rows, height, width = matrices.shape
    sums = np.abs(matrices).reshape(rows * height, width) @ np.ones(width)
    found: Array = sums.reshape(rows, height).max(axis=1, initial=0.0)
    return found
