"""Functions along a leg as Chebyshev polynomials on panels, refined until they are resolved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["Panels", "fit_panels"]

_NODES = 24
_TAIL = 3  # coefficients that show whether a function is resolved
_RESOLVED = 2e-14  # of the size on the leg
_ROUNDING = 1e-10  # of the size: coefficients below that do not fall with the panel are rounding
_FARTHEST = 100.0  # half panels: polynomials have no meaning there
_DEEPEST = 20  # halvings of a panel: what is then not resolved is rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Panels:
    """K functions on P panels of a leg.

    Parameters
    ----------
    edges : (P + 1,)
        Rising.
    coefficients : (P, nodes, K)
        Of Chebyshev polynomials on every panel.
    """

    edges: Array
    coefficients: Array

    def locate(self, at: Array) -> tuple[IndexArray, Array]:
        """The panel of every place (B,), and its place there from -1 to 1; beyond at the ends."""
        panel = np.clip(np.searchsorted(self.edges, at, side="right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        return panel, (2.0 * at - low - high) / (high - low)

    def __call__(self, at: Array) -> Array:
        """The functions at places (B,), (B, K); NaN far beyond the ends."""
        panel, x = self.locate(at)
        count = self.coefficients.shape[1]
        powers = np.cos(np.arccos(np.clip(x, -1.0, 1.0))[:, None] * np.arange(count))
        beyond = np.abs(x) > 1.0
        if beyond.any():
            known = np.where(np.abs(x) < _FARTHEST, x, np.nan)
            powers[beyond] = np.polynomial.chebyshev.chebvander(known[beyond], count - 1)
        if len(self.coefficients) == 1:
            return np.asarray(powers @ self.coefficients[0])
        found: Array = np.einsum("bm,bmk->bk", powers, self.coefficients[panel])
        return found

    def part(self, columns: slice) -> Panels:
        """Some of the functions."""
        return Panels(edges=self.edges, coefficients=self.coefficients[:, :, columns].copy())

    def with_slope(self) -> Panels:
        """The functions, and behind them the derivative of the first one."""
        own = np.polynomial.chebyshev.chebder(self.coefficients[:, :, 0], axis=1)
        half = 0.5 * np.diff(self.edges)
        slope = np.zeros((*self.coefficients.shape[:2], 1))
        slope[:, :-1, 0] = own / half[:, None]
        return Panels(
            edges=self.edges, coefficients=np.concatenate([self.coefficients, slope], axis=2)
        )


def fit_panels(
    function: Callable[[Array], Array],
    edges: Sequence[float] | Array,
    groups: IndexArray,
    least: Array,
    deepest: int | None = None,
) -> Panels:
    """Fit functions, (B,) → (B, K), between rising edges, and on halves of these panels where
    needed.

    ``groups`` (K,): functions of one number have one size, which is at least ``least`` (K,).
    """
    x = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    fit = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, _NODES - 1))
    done: list[tuple[float, float, Array]] = []
    waiting = [(float(a), float(b)) for a, b in pairwise(edges)]
    before = np.full((len(waiting), len(groups)), np.inf)
    size = least
    deepest = _DEEPEST if deepest is None else deepest
    for depth in range(deepest + 1):
        places = np.concatenate(
            [0.5 * (a + b) + 0.5 * (b - a) * x for a, b in waiting] or [np.zeros(0)]
        )
        values = function(places).reshape(len(waiting), _NODES, -1)
        largest = np.maximum(size, np.abs(values).max(axis=(0, 1)))
        size = np.array([largest[groups == own].max() for own in groups])
        coefficients = np.einsum("mn,pnk->pmk", fit, values)
        tails = np.abs(coefficients[:, -_TAIL:]).max(axis=1)
        noise = (tails < _ROUNDING * size) & (tails > 0.1 * before)
        rough = ((tails > _RESOLVED * size) & ~noise).any(axis=1) & (depth < deepest)
        parts: list[tuple[float, float]] = []
        for (a, b), own, split in zip(waiting, coefficients, rough, strict=True):
            if split:
                parts += [(a, 0.5 * (a + b)), (0.5 * (a + b), b)]
            else:
                done.append((a, b, own))
        waiting, before = parts, np.repeat(tails[rough], 2, axis=0)
        if not waiting:
            break
    done.sort(key=lambda panel: panel[0])
    return Panels(
        edges=np.array([edges[0], *(b for _, b, _ in done)]),
        coefficients=np.stack([own for _, _, own in done]),
    )
