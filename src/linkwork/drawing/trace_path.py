"""The paths of points: dotted lines, broken where there is no position."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Path, Pose
from linkwork.drawing.scene import Disc, Polyline, Primitive, Role, xy
from linkwork.foundation.arrays import Array

__all__ = ["drawn_once", "thinned", "trace_symbols"]

_AT_ONCE = 256  # points compared with a whole path at a time: bounds the memory


def trace_symbols(pose: Pose, names: tuple[str, ...], measures: Measures) -> Iterator[Primitive]:
    """The path of every named point; a lone position between failed ones is a dot."""
    width = measures.stroke / 2
    for name in names:
        for run in drawn_once(thinned(pose.paths[name], width), width):
            if len(run) > 1:
                yield Polyline(role=Role.TRACE, of=name, points=tuple(map(xy, run)))
            else:
                yield Disc(role=Role.TRACE, of=name, centre=xy(run[0]), radius=0.4 * measures.dot)


def thinned(path: Path, width: float) -> Path:
    """A path (m,) without points that lie less than ``width`` along it behind the one before.

    Ends are kept, also those beside NaN; a path of larger steps is kept as it is.
    """
    finite = np.isfinite(path)
    along = np.concatenate(([0.0], np.cumsum(np.nan_to_num(np.abs(np.diff(path))))))
    stretch = np.floor(along / width)
    padded = np.concatenate(([False], finite, [False]))
    inner = padded[:-2] & finite & padded[2:]
    return path[~inner | (np.diff(stretch, prepend=-1.0) > 0)]


def drawn_once(path: Path, width: float) -> list[Path]:
    """The runs of a path (m,) without NaN, less the pieces that lie over earlier ones.

    The point of a rocker goes forth and back on one arc: drawn twice, dots would close to a line.
    Pieces count as lying over each other within ``width``. A run of one point is a lone position.
    Costs O(m²) time.
    """
    finite = np.isfinite(path)
    start, step = path[:-1], np.diff(path)
    length = np.abs(step)
    # Over a gap the way grows by enough to leave everything before it behind.
    reached = np.concatenate(([0.0], np.cumsum(np.where(np.isfinite(length), length, 9 * width))))
    squared = np.where(length > 0, length**2, 1.0)
    covered = np.zeros(len(path), dtype=bool)
    for rows in np.split(np.arange(len(path)), range(_AT_ONCE, len(path), _AT_ONCE)):
        # Distance of every point (rows) from every piece (columns).
        offset = path[rows, None] - start
        share = np.clip((offset * step.conj()).real / squared, 0.0, 1.0)
        distance: Array = np.abs(offset - share * step)
        # Neighbours along the path are always near: only pieces left behind for a while count.
        behind = reached[rows, None] - reached[1:] > 4 * width
        covered[rows] = np.any((distance <= width) & behind, axis=1)
    kept = np.isfinite(length) & ~(covered[:-1] & covered[1:])
    edges = np.flatnonzero(np.diff(np.concatenate(([0], kept.astype(int), [0]))))
    runs = [(a, b + 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    padded = np.concatenate(([False], finite, [False]))
    lone = np.flatnonzero(finite & ~padded[:-2] & ~padded[2:] & ~covered)
    return [path[a:b] for a, b in sorted([*runs, *((k, k + 1) for k in lone)])]
