"""Proofs by boxes: where no bound of the curvature is known, but dF/dv is enclosed over any box.

For F(x, k) = 0 with known variables k, A ≈ J(x0)⁻¹, and G a set of matrices that contains dF/dv all
over the box |x - x0| ≤ w, |k - k0| ≤ κ, the mean value theorem gives (Krawczyk 1969,
doi:10.1007/BF02234767; Rump 2010, doi:10.1017/S096249291000005X)

    e = |A F(x0)| + |A G_k| κ + |I - A G_x| w.

If e < w there is, for every k, a solution in the box, and it lies within e; if |I - A G_x| w < w
there is at most one. Boxes of many sizes are tried at once: the smallest that holds one solution
bounds the error, the largest without a second one is the isolation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray, matrix_vector
from linkwork.core.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.core.numerics.block_solver import Block
from linkwork.core.numerics.kantorovich import Radii
from linkwork.core.numerics.system import System

#: Half widths of boxes in units of the usual weights: from far beyond them down to rounding.
_SIZES = 4.0 ** -np.arange(-3.0, 27.0)
_TWICE = 2.0  # times the error at the centre: room for what the slopes change


@dataclass(frozen=True, kw_only=True, eq=False)
class Enclosed:
    """A system at B positions v (B, N) with an approximate inverse A (B, n, n) of its Jacobian."""

    system: System
    v: Array
    matrix: Array

    def take(self, index: IndexArray | slice) -> Enclosed:
        """At some of the positions, in the order of ``index``."""
        return replace(self, v=self.v[index], matrix=self.matrix[index])

    def slopes(self, box: Array) -> tuple[Array, Array]:
        """Centre and half width of A G, (B, n, N), over boxes (B, N)."""
        low, high = self.system.enclosure(self.v, box)[1]
        return self._product(low, high)

    @property
    def residual(self) -> Array:
        """|A F| with all its rounding, (B, n)."""
        low, high = self.system.enclosure(self.v, np.zeros_like(self.v))[0]
        centre, spread = self._product(low[:, :, None], high[:, :, None])
        return np.asarray((np.abs(centre) + spread)[:, :, 0])

    def _product(self, low: Array, high: Array) -> tuple[Array, Array]:
        """A times the matrices from ``low`` to ``high``."""
        centre, spread = 0.5 * (low + high), 0.5 * (high - low)
        size = np.abs(self.matrix)
        # the centre and the spread are rounded, and so are the sums of n products
        lost = (self.matrix.shape[1] + 4) * UNIT_ROUNDOFF * np.abs(centre)
        return self.matrix @ centre, PROOF_SLACK * (size @ (spread + lost))

    def radii(self, block: Block, known: Array, *, fitted: bool = False) -> Radii:
        """Existence and uniqueness for known variables that may be off by ``known`` (B, p).

        The boxes are of all sizes, so no weights are fitted.
        """
        count, n = self.matrix.shape[:2]
        weights = self.system.variable_scale[:n]
        with np.errstate(all="ignore"):
            still = np.zeros_like(self.v)
            still[:, n:] = known
            centre, spread = self.slopes(still)
            shift = matrix_vector((np.abs(centre) + spread)[:, :, n:], known)
            least = _TWICE * (self.residual + shift)
            size = least + _SIZES[:, None, None] * weights
            w = size.reshape(-1, n)
            lanes = self.take(np.tile(np.arange(count), len(_SIZES)))
            box = np.concatenate([w, np.tile(known, (len(_SIZES), 1))], axis=1)
            error, alone = lanes._errors(box)
            isolated = alone.reshape(len(_SIZES), count)
            inside = np.asarray((error < w).all(axis=1)).reshape(isolated.shape)
            holds: BoolArray = inside & isolated
        bound = np.where(holds[:, :, None], error.reshape(size.shape), np.inf)
        best = (bound / weights).max(axis=2, initial=0.0).argmin(axis=0)
        rows = np.arange(count)
        # sizes fall: the first box without a second solution is the largest
        isolation = size[isolated.argmax(axis=0), rows]
        proved = np.asarray(holds.any(axis=0))
        error_bound = bound[best, rows]
        isolation = np.where(proved[:, None], isolation, 0.0)
        return Radii(
            holds=proved,
            existence_radius=(error_bound / weights).max(axis=1, initial=0.0),
            uniqueness_radius=(isolation / weights).min(axis=1, initial=np.inf),
            error_bound=error_bound,
            isolation_radius=isolation,
        )

    def _errors(self, box: Array) -> tuple[Array, BoolArray]:
        """e (B, n) over boxes (B, N), and whether there is at most one solution in each, (B,)."""
        n = self.matrix.shape[1]
        w, known = box[:, :n], box[:, n:]
        centre, spread = self.slopes(box)
        own = np.abs(np.eye(n) - centre[:, :, :n]) + spread[:, :, :n]
        shift = self.residual + matrix_vector((np.abs(centre) + spread)[:, :, n:], known)
        moved = PROOF_SLACK * matrix_vector(own, w)
        error = PROOF_SLACK * (shift + moved)  # eq. (33a)
        alone, inside = (np.asarray((size < w).all(axis=1)) for size in (moved, error))
        # the solution lies within e, so that the same bound holds with e for w
        closer = PROOF_SLACK * (shift + PROOF_SLACK * matrix_vector(own, error))
        return np.where(inside[:, None], np.minimum(closer, error), error), alone


def excluded(system: System, v: Array) -> float:
    """The largest tried distance from a position v (N,), weighted, within which F has no zero for
    the same known variables; 0 if that is proved for none.
    """
    n = system.unknowns
    box = np.zeros((len(_SIZES), len(v)))
    box[:, :n] = _SIZES[:, None] * system.variable_scale[:n]
    low, high = system.enclosure(np.tile(v, (len(_SIZES), 1)), box)[0]
    without = ((low > 0.0) | (high < 0.0)).any(axis=1)
    return float(_SIZES[without].max(initial=0.0))
