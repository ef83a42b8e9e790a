"""The designs that no other one surpasses in every objective, and a spread of them.

References
----------
V. Pareto, Manuale di economia politica, Società Editrice Libraria, Milano 1906.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["alike", "objective_spans", "spread", "undominated"]

_ALIKE = 1e-6  # of the span of an objective: what fits agree to


def objective_spans(values: Array, every: Array | None = None) -> Array:
    """The ranges of objectives over designs (D, K), (K,).

    The largest value instead, of ``every`` design if given, where they differ by a millionth of it
    at most.
    """
    spans = np.ptp(values, axis=0) if len(values) else np.zeros(values.shape[1])
    largest = np.abs(values if every is None else every).max(axis=0, initial=0.0)
    flat = spans <= _ALIKE * largest
    return np.where(flat, np.where(largest > 0.0, largest, 1.0), spans)


def alike(values: Array, k: int, spans: Array) -> IndexArray:
    """The designs whose objectives (D, K) are those of one, to what fits agree to."""
    return np.flatnonzero((np.abs(values - values[k]) <= _ALIKE * spans).all(axis=1))


def undominated(values: Array) -> IndexArray:
    """The designs, by rising first objective, that no other one dominates.

    A design dominates another one if no objective is larger by more than fits agree to, and one is
    smaller by more than that. Of equal designs the one with the smallest sum stays.

    Parameters
    ----------
    values : (D, K)
        Objectives; smaller is better. Designs without all of them are left out.
    """
    known = np.flatnonzero(np.isfinite(values).all(axis=1))
    own = values[known]
    if not len(own):
        return known
    scaled = (own - own.min(axis=0)) / objective_spans(own[_strictly(own)], own)
    kept: list[int] = []
    for k in np.argsort(scaled.sum(axis=1), kind="stable"):
        no_larger = scaled[kept] <= scaled[k] + _ALIKE
        if not no_larger.all(axis=1).any():
            kept.append(int(k))
    order = np.lexsort(own[kept].T[::-1])
    return np.asarray(known[np.array(kept)[order]])


def _strictly(values: Array) -> IndexArray:
    """The designs that no other one dominates by any difference."""
    order = np.lexsort(values.T[::-1])
    kept: list[int] = []
    for k in order:
        if not (values[kept] <= values[k]).all(axis=1).any():
            kept.append(int(k))
    return np.array(kept, dtype=np.intp)


def spread(values: Array, count: int) -> IndexArray:
    """So many of the designs of a front (D, K), in their order: those with the least of an
    objective, then always the one farthest from those taken.
    """
    if len(values) <= count:
        return np.arange(len(values))
    scaled = (values - values.min(axis=0)) / objective_spans(values)
    taken = list(dict.fromkeys(map(int, scaled.argmin(axis=0))))[:count]
    away = np.full(len(values), np.inf)
    for k in taken:
        away = np.minimum(away, np.linalg.norm(scaled - scaled[k], axis=1))
    while len(taken) < count:
        far = int(away.argmax())
        taken.append(far)
        away = np.minimum(away, np.linalg.norm(scaled - scaled[far], axis=1))
    return np.sort(np.array(taken, dtype=np.intp))
