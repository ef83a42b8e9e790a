"""Proof of the solutions of dyads' equations: Newton-Kantorovich in all eight coordinates.

The system has five linear rows, both quadrics and the norm n·x = 1. Its second derivatives are
constant. Four proved solutions that differ are all there are, since two conics meet in four points.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from linkwork.design.poses.dyad_equations import (
    COORDINATES,
    CURVATURE,
    NormalPoses,
    quadric_gradients,
    quadrics,
)
from linkwork.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.rounding import (
    ALMOST_REAL,
    EXTENDED_EPSILON,
    PROOF_SLACK,
    UNIT_ROUNDOFF,
)

__all__ = ["DyadProofs", "prove_dyads"]

_ROWS = 5
_POLISHES = 2
# roundings of one complex row: a product has three, a sum of eight products eight more
_LOSS = 12.0
#: From the largest coordinate of an error to its length.
_LENGTH = COORDINATES**0.5
# errors longer than this would need the exact angle between lines
_LARGEST = 0.1


@dataclass(frozen=True, kw_only=True, eq=False)
class DyadProofs:
    """Solutions x (N, 4, 8) of length 1, whether they are real, are proved, and differ from all
    others; the errors of their coordinates and the conditions, (N, 4); ``complete`` (N,).
    """

    x: ComplexArray
    is_real: BoolArray
    proved: BoolArray
    error: Array
    condition: Array
    complete: BoolArray

    def with_better(self, index: IndexArray, other: DyadProofs) -> DyadProofs:
        """With the solutions of another attempt where it proved more of them."""
        better = other.proved.sum(axis=1) > self.proved[index].sum(axis=1)
        changes = {}
        for name in ("x", "is_real", "proved", "error", "condition", "complete"):
            values = getattr(self, name).copy()
            values[index[better]] = getattr(other, name)[better]
            changes[name] = values
        return replace(self, **changes)


def prove_dyads(
    rows: Array, null: Array, inverse: Array, y: ComplexArray, precise: AnyArray | None = None
) -> DyadProofs:
    """Refine and prove solutions y (N, 4, 3) in the null space (N, 8, 3) of rows (N, 5, 8), whose
    pseudo-inverse is ``inverse`` (N, 8, 5).

    ``precise``: the rows in extended precision, in which residuals are then evaluated. The largest
    provable condition grows from about 1e7 to 1e9.
    """
    precise = rows if precise is None else precise
    unit = UNIT_ROUNDOFF if precise.dtype == np.float64 else EXTENDED_EPSILON / 2.0
    x = _turned_real(y @ null.transpose(0, 2, 1))
    is_real = (x.imag == 0).all(axis=2)
    x = x.astype(np.result_type(precise, x))
    for step in range(_POLISHES + 1):
        near = x.astype(np.complex128)
        n = near.conj()
        # (N, 4, 3, 8)
        gradients = np.concatenate([n[:, :, None], quadric_gradients(near)], axis=2)
        answer = _inverse(gradients, null, inverse)
        f = np.concatenate(
            [
                x @ precise.transpose(0, 2, 1),
                np.sum(n * x, axis=2, keepdims=True) - 1.0,
                quadrics(x),
            ],
            axis=2,
        )
        if step < _POLISHES:
            x = x - np.nan_to_num(_matrix_vector(answer, f.astype(np.complex128)))
            x = x / np.sqrt(np.sum(np.abs(x) ** 2, axis=2, keepdims=True))
    jacobian = np.concatenate(
        [np.broadcast_to(rows[:, None], (*x.shape[:2], *rows.shape[1:])), gradients], axis=2
    )
    holds, error = _kantorovich(answer, jacobian, f, near, unit)
    with np.errstate(all="ignore"):
        condition = _row_sums(answer) * _row_sums(jacobian)
    # x is rounded to double precision in the end
    x, error = near, error + (2.0 * UNIT_ROUNDOFF if unit < UNIT_ROUNDOFF else 0.0)
    length = _LENGTH * error
    differs = _distances(x, x.conj()) > 1.5 * 2.0 * length
    proved = holds & (is_real | differs) & (length < _LARGEST)
    for i, j in combinations(range(x.shape[1]), 2):
        apart = _distances(x[:, i], x[:, j]) > 1.5 * (length[:, i] + length[:, j])
        proved[:, i] &= apart
        proved[:, j] &= apart
    return DyadProofs(
        x=x,
        is_real=is_real,
        proved=proved,
        error=error,
        condition=condition,
        complete=proved.all(axis=1),
    )


def _turned_real(x: ComplexArray) -> ComplexArray:
    """Vectors (N, 4, 8) of length 1, turned until their largest coordinate is real; those that are
    almost real become real.
    """
    largest = np.take_along_axis(x, np.abs(x).argmax(axis=2)[..., None], axis=2)
    turned = x * (largest.conj() / np.abs(largest))
    almost = np.abs(turned.imag).max(axis=2, keepdims=True) < ALMOST_REAL
    turned = np.where(almost, turned.real, turned)
    return np.asarray(turned / np.linalg.norm(turned, axis=2, keepdims=True))


def _inverse(gradients: ComplexArray, null: Array, inverse: Array) -> ComplexArray:
    """An approximate inverse (N, 4, 8, 8) of the Jacobian, from that of the linear rows."""
    small = gradients @ null[:, None]  # (N, 4, 3, 3)
    a, b, c = np.moveaxis(small, -2, 0)
    columns = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
    with np.errstate(all="ignore"):
        columns = columns / np.sum(a * columns[..., 0], axis=-1)[..., None, None]
    right = null[:, None] @ np.nan_to_num(columns)
    left = inverse[:, None] - right @ (gradients @ inverse[:, None])
    return np.concatenate([left, right], axis=-1)


def _kantorovich(
    answer: ComplexArray, jacobian: ComplexArray, f: AnyArray, x: ComplexArray, unit: float
) -> tuple[BoolArray, Array]:
    """Whether a solution exists near x (N, 4, 8), and within which distance of every coordinate."""
    size, entries = np.abs(answer), np.abs(jacobian)
    uncertain = _LOSS * entries
    uncertain[:, :, :_ROWS] += NormalPoses.doubt(entries[:, :, :_ROWS])
    of_f = unit * _matrix_vector(uncertain, np.abs(x))
    # singular Jacobians have answers without bounds, and no proof
    with np.errstate(all="ignore"):
        # eq. (25)
        y = np.abs(_matrix_vector(answer, f.astype(np.complex128)))
        y += _matrix_vector(size, of_f + 2.0 * _LOSS * UNIT_ROUNDOFF * np.abs(f).astype(float))
        z = np.abs(np.eye(COORDINATES) - answer @ jacobian)
        z += UNIT_ROUNDOFF * (size @ (uncertain + _LOSS * entries))
        y0 = y.max(axis=2) * PROOF_SLACK
        z0 = z.sum(axis=3).max(axis=2) * PROOF_SLACK
        omega = CURVATURE * size[..., _ROWS + 1 :].sum(axis=3).max(axis=2) * PROOF_SLACK
        rest = (1.0 - z0) ** 2 - 2.0 * omega * y0
        holds = (z0 < 1.0) & (rest > 0)
        radius = 2.0 * y0 / (1.0 - z0 + np.sqrt(np.maximum(rest, 0.0))) * PROOF_SLACK
    return holds, np.where(holds, radius, np.inf)


def _row_sums(matrices: ComplexArray) -> Array:
    return np.asarray(np.abs(matrices).sum(axis=-1).max(axis=-1))


def _distances(x: ComplexArray, other: ComplexArray) -> Array:
    """The sines (…) of the angles between complex lines of unit vectors (…, 8)."""
    along = np.sum(other.conj() * x, axis=-1, keepdims=True)
    return np.asarray(np.linalg.norm(x - along * other, axis=-1))


def _matrix_vector(matrices: AnyArray, vectors: AnyArray) -> AnyArray:
    """A x for matrices (…, n, m) and vectors (…, m), (…, n)."""
    return (matrices @ vectors[..., None])[..., 0]
