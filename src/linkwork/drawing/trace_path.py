"""The paths of points: dotted lines, broken where there is no position."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Path, Pose
from linkwork.drawing.scene import Disc, Polyline, Primitive, Role, xy
from linkwork.foundation.arrays import Array

__all__ = ["drawn_once", "found_runs", "trace_symbols"]


def trace_symbols(pose: Pose, names: tuple[str, ...], measures: Measures) -> Iterator[Primitive]:
    """The path of every named point; a lone position between failed ones is a dot."""
    for name in names:
        runs = found_runs(pose.paths[name])
        for run in (part for whole in runs for part in drawn_once(whole, measures.stroke / 2)):
            if len(run) > 1:
                yield Polyline(role=Role.TRACE, of=name, points=tuple(map(xy, run)))
            else:
                yield Disc(role=Role.TRACE, of=name, centre=xy(run[0]), radius=0.4 * measures.dot)


def found_runs(path: Path) -> list[Path]:
    """The stretches of a path without NaN, each at least one point long."""
    rows = np.flatnonzero(np.isfinite(path))
    if not rows.size:
        return []
    breaks = np.flatnonzero(np.diff(rows) > 1) + 1
    return [path[run] for run in np.split(rows, breaks)]


def drawn_once(path: Path, width: float) -> list[Path]:
    """A path of m points without the pieces that run over earlier ones within ``width``.

    The point of a rocker goes forth and back on one arc: drawn twice, dots would close to a line.
    Costs O(m²) time and memory.
    """
    if len(path) < 4:
        return [path]
    start, step = path[:-1], np.diff(path)
    length = np.abs(step)
    reached = np.concatenate(([0.0], np.cumsum(length)))
    squared = np.where(length > 0, length**2, 1.0)
    # Distance of every point (rows) from every piece (columns).
    offset = path[:, None] - start
    share = np.clip((offset * step.conj()).real / squared, 0.0, 1.0)
    distance: Array = np.abs(offset - share * step)
    # Neighbours along the path are always near: only pieces left behind for a while count.
    behind = reached[:, None] - reached[1:] > 4 * width
    covered = np.any((distance <= width) & behind, axis=1)
    kept = ~(covered[:-1] & covered[1:])
    edges = np.flatnonzero(np.diff(np.concatenate(([0], kept.astype(int), [0]))))
    return [path[a : b + 1] for a, b in zip(edges[::2], edges[1::2], strict=True)]
