"""Dyads through three and two poses, with pivots that are given or spread over a region."""

from __future__ import annotations

import numpy as np

from linkwork.design.loops.closed_forms import circumcentres, solve_with_bound
from linkwork.design.poses.dyad_set import DyadSet
from linkwork.design.precision.polygon_points import points_in_polygon
from linkwork.design.tasks.wishes import Wishes
from linkwork.foundation.arrays import Array, ComplexArray, CountArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = [
    "inverted",
    "on_lines",
    "spread_pivots",
    "through_fixed",
    "through_line",
    "through_moving",
    "timed_dyads",
]

_SHARES = np.array([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0])  # along the bisector of two poses
_AROUND = 1.5  # sizes of the task, for pivots without a region
_LOSS = 16.0 * UNIT_ROUNDOFF


def spread_pivots(points: ComplexArray, wishes: Wishes, count: int) -> ComplexArray:
    """Pivots spread evenly over the region of wishes, or around the points of a task."""
    corners = wishes.region
    if not corners.size:
        middle, size = points.mean(), np.abs(points - points.mean()).max()
        size = max(float(size), UNIT_ROUNDOFF) * _AROUND
        corners = middle + size * np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j])
    low = complex(corners.real.min(), corners.imag.min())
    extent = complex(np.ptp(corners.real), np.ptp(corners.imag))
    found: list[ComplexArray] = []
    number, inside = 0, 0
    # Halton's sequence fills any box evenly; a polygon takes its share of it
    while inside < count and number < 64 * count:
        k = np.arange(number + 1, number + count + 1)
        z = np.zeros(count, dtype=complex) + low
        z.real += _halton(k, 2) * extent.real
        z.imag += _halton(k, 3) * extent.imag
        z = z[wishes.within_region(z, np.zeros(count))]
        found.append(z)
        number, inside = number + count, inside + len(z)
    if inside >= count:
        return np.concatenate(found)[:count]
    # of a narrow polygon the box has too few points: all of them are mapped into it
    k = np.arange(1, count + 1)
    return points_in_polygon(corners, np.stack([_halton(k, 2), _halton(k, 3)], axis=1))


def _halton(k: CountArray, base: int) -> Array:
    """Numbers of Halton's sequence in (0, 1)."""
    rest, share, total = np.asarray(k, dtype=float), 1.0, np.zeros(len(k))
    while (rest > 0).any():
        share /= base
        total += share * np.mod(rest, base)
        rest = np.floor(rest / base)
    return total


def through_fixed(pivots: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The RR dyads with fixed pivots (K,): one each for three poses, several for two."""
    images = (pivots[:, None] - points) * turns.conj()
    far = np.abs(pivots) + np.abs(points).max()
    if len(points) == 2:
        middle, across = images.mean(axis=1), 1j * (images[:, 1] - images[:, 0])
        moving = (middle[:, None] + across[:, None] * _SHARES).ravel()
        fixed, error = np.repeat(pivots, len(_SHARES)), _LOSS * (np.repeat(far, len(_SHARES)))
        error = error + _LOSS * np.abs(moving)
    else:
        moving, error = circumcentres(images, far)
        fixed = pivots
    return DyadSet.made(0, moving, fixed, error)


def through_moving(moving: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The RR dyads with moving pivots (K,) in the body's frame."""
    images = points + moving[:, None] * turns
    far = np.abs(moving) + np.abs(points).max()
    if len(points) == 2:
        middle, across = images.mean(axis=1), 1j * (images[:, 1] - images[:, 0])
        fixed = (middle[:, None] + across[:, None] * _SHARES).ravel()
        own, error = np.repeat(moving, len(_SHARES)), _LOSS * np.repeat(far, len(_SHARES))
        return DyadSet.made(0, own, fixed, error + _LOSS * np.abs(fixed))
    fixed, error = circumcentres(images, far)
    return DyadSet.made(0, moving, fixed, error)


def timed_dyads(
    pivots: ComplexArray, points: ComplexArray, turns: ComplexArray, inputs: Array
) -> DyadSet:
    """The cranks that turn by given angles from pose to pose.

    d + m e^{iθ} = p + w e^{iβ}: three poses determine m, p and the crank w; two poses m and w for
    each of the fixed pivots (K,). ``inputs``: β (N,) [rad].
    """
    cranks = np.exp(1j * (inputs - inputs[0]))
    if len(points) == 2:
        # m e^{iθ} - w e^{iβ} = p - d for each of the pivots
        columns = np.array([turns, -cranks]).T
        right = pivots[:, None] - points
    else:
        columns = np.array([turns, -cranks, -np.ones(3)]).T
        right = -points[None]
    many = len(right)
    # as real equations: complex numbers as matrices
    real = np.block([[columns.real, -columns.imag], [columns.imag, columns.real]])
    vector = np.concatenate([right.real, right.imag], axis=1)
    doubt, own = np.full(many, _LOSS), _LOSS * np.abs(vector).max(axis=1)
    x, error = solve_with_bound(np.tile(real, (many, 1, 1)), vector, doubt, own)
    n = columns.shape[1]
    solution = x[:, :n] + 1j * x[:, n:]
    fixed = pivots if n == 2 else solution[:, 2]
    return DyadSet.made(0, solution[:, 0], fixed, 1.5 * error.max(axis=1))


def on_lines(normals: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The PR dyads through three poses whose lines have given unit normals (K,)."""
    # Re(n̄ (d + m e^{iθ})) = k, linear in m and k
    lever = normals.conj()[:, None] * turns
    matrix = np.stack([lever.real, -lever.imag, -np.ones(lever.shape)], axis=-1)
    right = -(normals.conj()[:, None] * points).real
    doubt = np.full(len(right), _LOSS)
    x, error = solve_with_bound(matrix, right, doubt, doubt * np.abs(points).max())
    moving, fixed = x[:, 0] + 1j * x[:, 1], x[:, 2] * normals
    return DyadSet.made(1, moving, fixed, 1.5 * error[:, 0], normals)


def through_line(moving: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The PR dyads through two poses with moving pivots (K,) in the body's frame."""
    images = points + moving[:, None] * turns
    along = images[:, 1] - images[:, 0]
    with np.errstate(all="ignore"):
        normals = 1j * along / np.abs(along)
    error = _LOSS * (np.abs(moving) + np.abs(points).max())
    return DyadSet.made(1, moving, images[:, 0], np.where(along != 0, error, np.inf), normals)


def inverted(points: ComplexArray, turns: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """The ground's poses as the body sees them: there an RP dyad is a PR dyad."""
    return np.asarray(-points * turns.conj()), turns.conj()
