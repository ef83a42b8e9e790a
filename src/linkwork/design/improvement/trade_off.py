"""Several objectives of lanes as one sum of squares: weights, and limits of some of them.

An objective f is the root mean square of the misses of one goal. A lane minimises the sum of w² f²
over the objectives, eq. (169); a limit f ≤ e is a constraint with a multiplier, eq. (155). Weights
reach the convex parts of a front only, limits reach every point of it.

References
----------
Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, On a bicriterion formulation of the problems of integrated
system identification and system optimization, IEEE Transactions on Systems, Man, and Cybernetics 1
(1971) 296-297.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.numerics.lane_least_squares import Residuals

__all__ = ["Objectives", "TradeOff", "told_apart"]

_STIFF = 10.0  # weight of limits, in spans of their objectives: their shifts converge faster
_MARGIN = 1e-9  # of an objective's scale: by which limits hold in the end


@dataclass(frozen=True, kw_only=True, eq=False)
class Objectives:
    """Which residuals are the misses of which goal.

    Parameters
    ----------
    names : tuple of str
    columns : tuple of slice, optional
        Of the shared residuals; ``None``: the rows.
    weights : (K,)
        Of the goals, which the residuals contain.
    bounds : sequence of slice
        The shared residuals that are broken bounds.
    """

    names: tuple[str, ...]
    columns: tuple[slice | None, ...]
    weights: Array
    bounds: tuple[slice, ...]

    def misses(self, found: Residuals, k: int) -> tuple[Array, Array]:
        """The misses of an objective, (D, n), and by the numbers, (D, n, P)."""
        own = self.columns[k]
        if own is not None:
            return found.shared[:, own], found.shared_by_x[:, own]
        count = len(found.rows)
        return found.rows.reshape(count, -1), found.by_x.reshape(count, -1, found.by_x.shape[-1])

    def count(self, found: Residuals, k: int) -> int:
        """The number of misses of an objective; a distance from a point is one."""
        own = self.columns[k]
        return int(found.rows.shape[1] if own is None else own.stop - own.start)

    def values(self, found: Residuals) -> Array:
        """The objectives, (D, K), without the weights of their goals."""
        values = [
            np.linalg.norm(self.misses(found, k)[0], axis=1) / np.sqrt(self.count(found, k))
            for k in range(len(self.names))
        ]
        # there may be bounds only
        return np.array(values).reshape(len(values), len(found.shared)).T / self.weights

    def broken(self, found: Residuals) -> Array:
        """The largest residual of a bound, (D,)."""
        every = [np.abs(found.shared[:, own]).max(axis=1, initial=0.0) for own in self.bounds]
        return np.asarray(np.max([np.zeros(len(found.shared)), *every], axis=0))


class TradeOff:
    """The weights and limits of lanes.

    Parameters
    ----------
    objectives : Objectives
    scale : (K,)
        Units of the objectives.
    weights, limits : (L, K)
        Of scaled objectives; infinite: no limit.

    Attributes
    ----------
    stiffness : (L, K)
        Further weights of broken limits.
    """

    def __init__(self, objectives: Objectives, scale: Array, weights: Array, limits: Array) -> None:
        self.objectives, self.units = objectives, scale
        self.scale = scale * objectives.weights
        self.weights, self.limits = weights, limits
        self.stiffness = np.ones_like(limits)
        self._shift = np.zeros_like(limits)
        self._new = np.zeros_like(limits)

    @property
    def has_limits(self) -> bool:
        """Whether an objective of a lane is limited."""
        return bool(np.isfinite(self.limits).any())

    def applied(self, found: Residuals, lanes: IndexArray) -> Residuals:
        """Weighted residuals of lanes, and those of broken limits after them."""
        rows, by_x, by_t = found.rows, found.by_x, found.by_t
        shared, shared_by_x = np.array(found.shared), np.array(found.shared_by_x)
        broken, slopes = [], []
        for k, own in enumerate(self.objectives.columns):
            unit = self.scale[k] * np.sqrt(self.objectives.count(found, k))
            misses, slope = self.objectives.misses(found, k)
            value, rise = self._over(k, misses / unit, slope / unit, lanes)
            broken.append(value)
            slopes.append(rise)
            # eq. (169)
            factor = self.weights[lanes, k] / unit
            if own is None:
                rows, by_x = rows * factor[:, None, None], by_x * factor[:, None, None, None]
                by_t = None if by_t is None else by_t * factor[:, None, None]
            else:
                shared[:, own] *= factor[:, None]
                shared_by_x[:, own] *= factor[:, None, None]
        return Residuals(
            rows,
            by_x,
            by_t,
            np.concatenate([shared, np.stack(broken, axis=1)], axis=1),
            np.concatenate([shared_by_x, np.stack(slopes, axis=1)], axis=1),
        )

    def _over(self, k: int, misses: Array, slope: Array, lanes: IndexArray) -> tuple[Array, Array]:
        """How far an objective is above its limit, (D,), and by the numbers, (D, P)."""
        limit, shift = self.limits[lanes, k], self._shift[lanes, k]
        value = np.linalg.norm(misses, axis=1)
        with np.errstate(invalid="ignore"):
            # eq. (155)
            over = np.maximum(0.0, value - limit + _MARGIN + shift)
        self._new[lanes, k] = np.nan_to_num(over)
        unit = misses / np.where(value > 0.0, value, 1.0)[:, None]
        rise = np.einsum("dn,dnp->dp", unit, slope)
        active, stiff = (over > 0.0)[:, None], _STIFF * self.stiffness[lanes, k]
        # no number where there is no position
        return stiff * over, stiff[:, None] * np.where(active, rise, 0.0)

    def update(self, lanes: IndexArray) -> None:
        """New shifts for lanes that were evaluated."""
        self._shift[lanes] = self._new[lanes]


def told_apart(names: Sequence[str]) -> tuple[str, ...]:
    """Names of which equal ones are numbered."""
    return tuple(
        name if name not in names[:k] else f"{name} ({1 + list(names[:k]).count(name)})"
        for k, name in enumerate(names)
    )
