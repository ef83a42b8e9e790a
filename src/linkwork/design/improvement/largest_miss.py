"""The largest miss, minimised as the limit of sums of growing powers.

Least squares of residuals f |f|^(k-1) minimise the sum of |f|^(2k), eq. (158). Each power begins at
the solution of the one before. The largest of N misses is then above the least possible by a factor
N^(1/2k) at most.

References
----------
G. Pólya, Sur un algorithme toujours convergent pour obtenir les polynomes de meilleure
approximation de Tchebycheff, Comptes Rendus 157 (1913) 840-843.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.numerics.lane_least_squares import Residuals

__all__ = ["POWERS", "largest_misses", "powered"]

#: Powers k in their order.
POWERS = (2, 4, 8, 16, 32, 64, 128, 256, 512)


def largest_misses(found: Residuals, counted: BoolArray) -> Array:
    """The largest distance or counted shared residual of lanes, (D,)."""
    rows = np.sqrt(np.einsum("dnm,dnm->dn", found.rows, found.rows))
    every = np.concatenate([rows, np.abs(found.shared[:, counted])], axis=1)
    return np.asarray(every.max(axis=1, initial=0.0))


@np.errstate(all="ignore")  # lanes without residuals stay without
def powered(found: Residuals, power: int, largest: Array, counted: BoolArray) -> Residuals:
    """Residuals of powers, relative to the largest miss (D,) at the begin of their round.

    ``counted`` (K,): the shared residuals that are misses; the others, broken bounds, stay.
    """
    scale = largest[:, None]
    size = np.sqrt(np.einsum("dnm,dnm->dn", found.rows, found.rows))
    factor = (size / scale) ** (power - 1) / scale
    unit = found.rows / np.where(size > 0.0, size, 1.0)[:, :, None]

    def bent(slope: Array) -> Array:
        # eq. (158): |f|^(k-1) (I + (k - 1) u uᵀ) df
        along = np.einsum("dnm,dnm...->dn...", unit, slope)
        turned = np.einsum("dnm,dn...->dnm...", unit, along)
        whole = slope + (power - 1) * turned
        return np.asarray(factor.reshape(*factor.shape, *[1] * (slope.ndim - 2)) * whole)

    shared, by_x = found.shared / scale, found.shared_by_x / scale[:, :, None]
    own = np.where(counted, np.abs(shared) ** (power - 1), 1.0)
    slope = np.where(counted, power * own, 1.0)
    return Residuals(
        found.rows * factor[:, :, None],
        bent(found.by_x),
        None if found.by_t is None else bent(found.by_t),
        shared * own,
        by_x * slope[:, :, None],
    )
