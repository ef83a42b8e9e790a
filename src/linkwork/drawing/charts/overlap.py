"""Overlapping curves: the lower one is drawn wider, so that both are visible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.charts.chart import Curve
from linkwork.foundation.arrays import Array

__all__ = ["layered"]

_NEAR = 0.004  # of the panel's sides: nearer curves cover each other
_LOOKED_AT = 100  # points of a curve checked for cover by another one
_HIDDEN = 0.4  # a curve with a larger covered share is drawn wider


def layered(curves: Sequence[Curve]) -> list[Curve]:
    """The curves, each with the number of later tones that cover much of it."""
    points = [np.stack([curve.x, curve.y], axis=1) for curve in curves]
    every = np.concatenate(points)
    if not np.isfinite(every).all(axis=1).any():
        return list(curves)
    size = np.nanmax(every, axis=0) - np.nanmin(every, axis=0)
    scaled = [line / np.where(size > 0.0, size, 1.0) for line in points]
    layered = []
    for k, curve in enumerate(curves):
        hiding = {
            other.tone
            for other, line in zip(curves, scaled, strict=True)
            if other.tone > curve.tone and _hidden_share(scaled[k], line) > _HIDDEN
        }
        layered.append(replace(curve, below=len(hiding)))
    return layered


def _hidden_share(line: Array, other: Array) -> float:
    """The share of points of a line (K, 2) on another line (M, 2)."""
    points = line[np.isfinite(line).all(axis=1)]
    points = points[:: max(1, len(points) // _LOOKED_AT)]
    start, step = other[:-1], np.diff(other, axis=0)
    ends = np.sort(np.stack([other[:-1, 0], other[1:, 0]]), axis=0)
    hidden = 0
    for point in points:
        # a curve of many turns has few sides near a point
        close = (ends[0] < point[0] + _NEAR) & (point[0] - _NEAR < ends[1])
        hidden += bool((_distances(point, start[close], step[close]) < _NEAR).any())
    return hidden / max(len(points), 1)


def _distances(point: Array, start: Array, step: Array) -> Array:
    """The distance of a point from sides (M, 2), (M,)."""
    offset = point - start
    squared = np.maximum((step**2).sum(axis=1), 1e-30)
    share = np.clip((offset * step).sum(axis=1) / squared, 0.0, 1.0)
    distances: Array = np.linalg.norm(offset - share[:, None] * step, axis=1)
    return distances
