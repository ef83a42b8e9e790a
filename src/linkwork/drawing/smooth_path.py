"""Adds points to a path between its rows, so that a quick turn is drawn as a curve."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["UNSEEN", "smoothed"]

UNSEEN = 1.25e-4  # of the size of a drawing: 0.1 pixels of 800

_CORNER = np.radians(60.0)  # a path that turns by more between two rows has a corner
_MOST = 40  # pieces between two rows
_MORE = 0.5 * (np.sqrt(5.0) - 1.0)
_LESS = 0.5 * (3.0 - np.sqrt(5.0))


def smoothed(
    path: ComplexArray,
    width: float,
    first: ComplexArray | None = None,
    second: ComplexArray | None = None,
) -> ComplexArray:
    """A path with points between its rows, where a straight line would differ visibly.

    Every two neighbouring rows are joined by a cubic curve with the tangents at both; where the
    path turns by more than 60° it has a corner, and the line stays straight. At a dead
    point, where the derivatives are infinite, the tangent follows from the chord and from tangent
    and curvature at the neighbouring row.

    Parameters
    ----------
    path : array (N,)
        Points x + iy; NaN interrupts it.
    width : float
        The largest deviation from the curve that cannot be seen.
    first, second : array (N,), optional
        The derivatives of the path by any parameter. Without them, the tangents are those of
        circles through three points.

    References
    ----------
    J. D. Hobby: Smooth, Easy to Compute Interpolating Splines. Discrete & Computational Geometry 1
    (1986), 123-140, doi:10.1007/BF02187690; the lengths of the handles.
    """
    if len(path) < 2:
        return path
    chord = np.diff(path)
    with np.errstate(all="ignore"):
        along = chord / np.abs(chord)
        tangent, bend = _tangents(path, first, second)
        # the angles from the tangents to the chord, and from the chord to the tangents
        before, after = _turn(tangent[:-1], along), -_turn(tangent[1:], along)
        half = 0.5 * np.abs(chord)
        ahead, behind = 3.0 * after - half * bend[1:], 3.0 * before - half * bend[:-1]
        unknown, unknown_after = np.isnan(before), np.isnan(after)
        before = np.where(unknown, _likely(ahead, after), before)
        after = np.where(unknown_after, _likely(behind, before), after)
        visible = np.abs(chord) * np.maximum(np.abs(before), np.abs(after)) / (4.0 * width)
        curved = (np.abs(before) < _CORNER) & (np.abs(after) < _CORNER) & (visible > 1.0)
    pieces = np.ones(len(chord), dtype=int)
    pieces[curved] = np.minimum(np.ceil(np.sqrt(visible[curved])), _MOST).astype(int)
    if not curved.any():
        return path
    row = np.repeat(np.arange(len(chord)), pieces)
    share = 1.0 - (np.cumsum(pieces)[row] - np.arange(len(row)) - 1) / pieces[row]
    inner = _cubic(path[row], chord[row], before[row], after[row], share)
    found: ComplexArray = np.concatenate((path[:1], np.where(share < 1.0, inner, path[row + 1])))
    return found


def _turn(tangent: ComplexArray, along: ComplexArray) -> Array:
    """The angle from a tangent, in the sense of the path, to the chord; NaN at a corner."""
    ahead = np.where((tangent * along.conj()).real < 0.0, -tangent, tangent)
    angle: Array = np.angle(along * ahead.conj())
    return np.where(np.isfinite(ahead) & np.isfinite(along), angle, np.nan)


def _likely(angle: Array, other: Array) -> Array:
    """The angle at an end without tangent, by the curvature at the other end, else of a circle."""
    likely: Array = np.where(np.abs(angle - 2.0 * other) < np.abs(other), angle - other, other)
    return likely


def _tangents(
    path: ComplexArray, first: ComplexArray | None, second: ComplexArray | None
) -> tuple[ComplexArray, Array]:
    """Tangents and curvatures at the rows, in the sense of the path; NaN where unknown."""
    middle = np.full(len(path), complex(np.nan, np.nan))
    bend = np.full(len(path), np.nan)
    chord = np.diff(path)
    inverse = 1.0 / chord.conj()
    turn = np.abs(np.angle(chord[1:] / chord[:-1]))
    middle[1:-1] = np.where(turn < _CORNER, inverse[:-1] + inverse[1:], np.nan)
    if first is None:
        return middle, bend
    if second is not None:
        bend = (first.conj() * second).imag / np.abs(first) ** 3
        step = np.diff(path, append=path[-1:])
        step = np.where(np.isfinite(step) & (step != 0.0), step, np.roll(step, 1))
        bend = np.where((step * first.conj()).real < 0.0, -bend, bend)
    return np.where(np.isfinite(first) & (first != 0.0), first, complex(np.nan, np.nan)), bend


def _cubic(
    start: ComplexArray, chord: ComplexArray, before: Array, after: Array, share: Array
) -> ComplexArray:
    """A point of the curve at a share of its parameter."""
    out = start + _handle(before, after) * chord * np.exp(-1j * before)
    back = start + chord - _handle(after, before) * chord * np.exp(1j * after)
    rest = 1.0 - share
    point: ComplexArray = (
        rest**3 * start
        + 3.0 * rest**2 * share * out
        + 3.0 * rest * share**2 * back
        + share**3 * (start + chord)
    )
    return point


def _handle(near: Array, far: Array) -> Array:
    """The length of a handle by its own angle to the chord and that at the other end."""
    odd = (np.sin(near) - np.sin(far) / 16.0) * (np.sin(far) - np.sin(near) / 16.0)
    rise = 2.0 + np.sqrt(2.0) * odd * (np.cos(near) - np.cos(far))
    handle: Array = rise / (3.0 * (1.0 + _MORE * np.cos(near) + _LESS * np.cos(far)))
    return handle
