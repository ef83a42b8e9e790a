"""Least-norm solutions of small linear systems, of one or many designs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.foundation.lanes import Lanes, is_batched

__all__ = ["independent", "least_norm"]

_CUT = 1e-12  # relative: smaller singular values count as zero
_APART = 1e-9  # relative: a row nearer to those before depends on them
_REGULAR = 1e-8  # the determinant of the Gram matrix of rows of length 1


def least_norm(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> Sequence[float]:
    """The shortest least-squares solution of m equations in k unknowns, m <= k.

    Parameters
    ----------
    matrix : m rows of k numbers
    right : m numbers

    Raises
    ------
    LinAlgError
        If the numbers are not finite.
    """
    lanes = _lanes_in(matrix, right)
    if lanes is None:
        known, wanted = np.array(matrix), np.array(right)
        # LAPACK prints a line about such numbers
        if not (np.isfinite(known).all() and np.isfinite(wanted).all()):
            raise np.linalg.LinAlgError
        found: Array = np.linalg.lstsq(known, wanted, rcond=_CUT)[0]
        return [float(number) for number in found]
    shortest = lanes.arithmetic.solve_shortest(matrix, right)
    if shortest is not None:
        return shortest
    a, b = _stacked(matrix, lanes), _stacked([right], lanes)[:, 0]
    finite: BoolArray = np.isfinite(np.concatenate([a, b[:, :, None]], axis=2)).all(axis=(1, 2))
    if lanes.arithmetic.decide(~finite):
        raise np.linalg.LinAlgError
    x = np.full((len(a), a.shape[2]), np.nan)
    regular, rows, sizes = _regular(a)
    gram = rows @ rows.swapaxes(1, 2)
    y = np.linalg.solve(gram[regular], (b / sizes)[regular][:, :, None])
    x[regular] = (rows[regular].swapaxes(1, 2) @ y)[:, :, 0]
    others = np.flatnonzero(~regular & finite)
    x[others] = (np.linalg.pinv(a[others], rcond=_CUT) @ b[others][:, :, None])[:, :, 0]
    return [lanes.arithmetic.lanes(column) for column in x.T]


def independent(matrix: Sequence[Sequence[float]]) -> list[int]:
    """The rows, from the first on, that do not depend on those before."""
    found: list[int] = []
    base = np.empty((0, len(matrix[0])))
    for k, row in enumerate(np.array(matrix)):
        rest = row - base.T @ (base @ row)
        rest -= base.T @ (base @ rest)  # once more, against rounding
        if (size := np.linalg.norm(rest)) > _APART * np.linalg.norm(row):
            found.append(k)
            base = np.vstack([base, rest / size])
    return found


def _lanes_in(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> Lanes | None:
    numbers: list[object] = [number for row in (*matrix, right) for number in row]
    return next((number for number in numbers if isinstance(number, Lanes)), None)


def _stacked(matrix: Sequence[Sequence[float]], lanes: Lanes) -> Array:
    """One matrix per lane, (n, m, k)."""
    found = np.empty((len(lanes.values), len(matrix), len(matrix[0])))
    for i, row in enumerate(matrix):
        for j, number in enumerate(row):
            found[:, i, j] = number.values if is_batched(number) else number
    return found


def _regular(a: Array) -> tuple[BoolArray, Array, Array]:
    """Lanes with clearly independent rows; all rows normalised; their lengths."""
    sizes: Array = np.linalg.norm(a, axis=2)
    rows: AnyArray = a / sizes[:, :, None]
    gram = rows @ rows.swapaxes(1, 2)
    regular: BoolArray = np.linalg.det(gram) > _REGULAR
    return regular, rows, sizes
