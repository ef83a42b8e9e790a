"""Dyads and loops that linear equations determine: circumcentres and Freudenstein's equation."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = ["circumcentres", "solve_with_bound"]

# roundings of one coordinate of a pose carried to another frame, and of products of two of them
_LOSS = 16.0


def circumcentres(points: ComplexArray, far: Array) -> tuple[ComplexArray, Array]:
    """The centres of circles through three points, with bounds of their errors.

    Parameters
    ----------
    points : (B, 3) complex
    far : (B,)
        The largest size of a number that the points were computed from.

    Returns
    -------
    (B,) complex, (B,)
        Infinite bounds where the points are, to rounding, on one line.
    """
    v, w = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    area = 2.0 * (v.real * w.imag - v.imag * w.real)
    longest = np.maximum(np.abs(v), np.abs(w))
    doubt = _LOSS * UNIT_ROUNDOFF * (far + longest)
    # eq. (148): c (v × w) 2 = i (|w|² v - |v|² w)
    numerator = 1j * (np.abs(w) ** 2 * v - np.abs(v) ** 2 * w)
    with np.errstate(all="ignore"):
        centre = numerator / area
        divisor = np.abs(area) - 8.0 * longest * doubt
        error = (16.0 * longest**2 + 8.0 * np.abs(centre) * longest) * doubt / divisor
    error = np.where(divisor > 0, error + doubt, np.inf)
    return points[:, 0] + centre, error


def solve_with_bound(
    matrix: Array, right: Array, doubt: Array, right_doubt: Array
) -> tuple[Array, Array]:
    """The solutions x (B, n) of linear systems, and bounds of their errors.

    Parameters
    ----------
    matrix : (B, n, n)
    right : (B, n)
    doubt, right_doubt : (B,)
        Bounds of the errors of all entries of the matrices, and of the right sides.

    Returns
    -------
    (B, n), (B, n)
        Infinite bounds where a matrix may be singular.
    """
    n = matrix.shape[-1]
    regular = _regular(matrix)
    safe = np.where(regular[:, None, None], matrix, np.eye(n))
    inverse = np.linalg.inv(safe)
    x = (inverse @ right[..., None])[..., 0]
    size = np.abs(inverse)
    rest = right - (safe @ x[..., None])[..., 0]
    entries = right_doubt[:, None] + doubt[:, None] * np.abs(x).sum(axis=1, keepdims=True)
    loss = (n + 2) * UNIT_ROUNDOFF
    rest = (
        np.abs(rest)
        + entries
        + loss * (np.abs(right) + (np.abs(safe) @ np.abs(x)[..., None])[..., 0])
    )
    away = np.abs(np.eye(n) - inverse @ safe) + size @ (loss * np.abs(safe) + doubt[:, None, None])
    norm = away.sum(axis=2).max(axis=1)
    with np.errstate(all="ignore"):
        # Rump 2010: |x - x*| ≤ |R rest| / (1 - ‖I - R A‖)
        bound = (size @ rest[..., None])[..., 0].max(axis=1) / (1.0 - norm)
    bound = np.where(regular & (norm < 1.0), bound, np.inf)
    return x, np.broadcast_to(bound[:, None], x.shape)


def _regular(matrix: Array) -> BoolArray:
    sizes = np.linalg.svd(matrix, compute_uv=False)
    # an elimination may find no pivot in what is singular to its rounding
    return np.asarray(sizes[..., -1] > _LOSS * UNIT_ROUNDOFF * sizes[..., 0])
