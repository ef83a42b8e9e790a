"""The paths of points: dotted lines, broken at missing positions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Path, Pose
from linkwork.drawing.scene import Disc, Polyline, Primitive, Role, xy
from linkwork.drawing.smooth_path import UNSEEN, smoothed
from linkwork.foundation.arrays import ComplexArray, IndexArray

__all__ = ["drawn_once", "thinned", "trace_symbols"]


def trace_symbols(pose: Pose, names: tuple[str, ...], measures: Measures) -> Iterator[Primitive]:
    """The path of every named point; an isolated position is a dot."""
    width = measures.stroke / 2
    for name in names:
        path = smoothed(pose.paths[name], UNSEEN * measures.size, *pose.rates[name])
        for run in drawn_once(thinned(path, width), width):
            if len(run) > 1:
                yield Polyline(role=Role.TRACE, of=name, points=tuple(map(xy, run)))
            else:
                yield Disc(role=Role.TRACE, of=name, centre=xy(run[0]), radius=0.4 * measures.dot)


def thinned(path: Path, width: float) -> Path:
    """A path (m,) without points less than ``width`` after the preceding one, along the path.

    Ends are kept, also those next to NaN; a path of larger steps is unchanged.
    """
    finite = np.isfinite(path)
    along = np.concatenate(([0.0], np.cumsum(np.nan_to_num(np.abs(np.diff(path))))))
    stretch = np.floor(along / width)
    padded = np.concatenate(([False], finite, [False]))
    inner = padded[:-2] & finite & padded[2:]
    return path[~inner | (np.diff(stretch, prepend=-1.0) > 0)]


def drawn_once(path: Path, width: float) -> list[Path]:
    """The runs of a path (m,) without NaN and without pieces that overlap earlier ones.

    The point of a rocker moves back and forth on one arc: dots drawn twice would merge to a line.
    Pieces overlap if they are within ``width``. A run of one point is an isolated position.
    """
    finite = np.isfinite(path)
    length = np.abs(np.diff(path))
    # At a gap, the path length increases enough to exclude all earlier pieces.
    reached = np.concatenate(([0.0], np.cumsum(np.where(np.isfinite(length), length, 9 * width))))
    covered = np.zeros(len(path), dtype=bool)
    point, piece = _near_each_other(path, width)
    # Neighbours along the path are always near: only pieces some distance back count.
    behind = reached[point] - reached[piece + 1] > 4 * width
    point, piece = point[behind], piece[behind]
    step, offset = path[piece + 1] - path[piece], path[point] - path[piece]
    squared = np.where(step == 0, 1.0, step.real**2 + step.imag**2)
    share = np.clip((offset.real * step.real + offset.imag * step.imag) / squared, 0.0, 1.0)
    covered[point[np.abs(offset - share * step) <= width]] = True
    kept = np.isfinite(length) & ~(covered[:-1] & covered[1:])
    edges = np.flatnonzero(np.diff(np.concatenate(([0], kept.astype(int), [0]))))
    runs = [(a, b + 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    padded = np.concatenate(([False], finite, [False]))
    lone = np.flatnonzero(finite & ~padded[:-2] & ~padded[2:] & ~covered)
    return [path[a:b] for a, b in sorted([*runs, *((k, k + 1) for k in lone)])]


def _near_each_other(path: Path, width: float) -> tuple[IndexArray, IndexArray]:
    """Candidate pairs of points and pieces, including all within ``width`` of each other.

    The plane is divided into squares as wide as the longest piece: near objects have their middles
    in the same or an adjacent square.
    """
    points, pieces = np.flatnonzero(np.isfinite(path)), np.flatnonzero(np.isfinite(np.diff(path)))
    if not len(pieces):
        return pieces, pieces
    middles, places = 0.5 * (path[pieces] + path[pieces + 1]), path[points]
    side = width + 0.5 * float(np.abs(path[pieces + 1] - path[pieces]).max())
    corner = complex(places.real.min(), places.imag.min())
    column, row = _squares((middles - corner) / side)
    high = int(row.max()) + 4
    number = column * high + row
    order = np.argsort(number, kind="stable")
    column, row = _squares((places - corner) / side)
    found_points, found_pieces = [], []
    for beside in (-1, 0, 1):
        middle = (column + beside) * high + row
        first = np.searchsorted(number[order], middle - 1)
        count = np.searchsorted(number[order], middle + 1, side="right") - first
        found_points.append(np.repeat(points, count))
        within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        found_pieces.append(pieces[order[np.repeat(first, count) + within]])
    return np.concatenate(found_points), np.concatenate(found_pieces)


def _squares(places: ComplexArray) -> tuple[IndexArray, IndexArray]:
    """Integer coordinates from 1, so that every square has neighbours."""
    return np.floor(places.real).astype(np.intp) + 1, np.floor(places.imag).astype(np.intp) + 1
