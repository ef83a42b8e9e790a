"""Blocks of loop equations as bilinear systems: unknown directions e^{iθ} instead of angles.

Every term c s e^{i(Σ w θ + known)} of a block must have one unknown direction, or none. Linear rows
between angles are solved first; then the sums of angles in the terms become the unknown directions.
This requires as many sums as remaining angles, and angles that follow from them with integer
weights. Otherwise the block has no such form, and the error gives the reason.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.kernels.loop_table import LoopTable
from linkwork.numerics.homotopy.bilinear import BilinearSystem

__all__ = ["DirectionForm", "NoDirectionForm", "check_independent", "direction_form"]

_MOST_LOOPS = 6  # C(12, 6) = 924 paths for a random system
_DEPENDENT = 1e-12  # smallest singular value of a closure matrix, relative to the largest
_WHOLE = 1e-12  # tolerance of integer weights


class NoDirectionForm(Exception):
    """A block has no such form; the message continues a sentence after "its equations"."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DirectionForm:
    """A block over M unknown directions and lengths, for any values of its known variables.

    Parameters
    ----------
    table : LoopTable
        The block, with n unknowns.
    column : (T,) int
        The column of each term: a direction, then the lengths, M for known terms.
    rows : (4, M) int
        The products of :class:`~linkwork.numerics.homotopy.bilinear.BilinearSystem`.
    angles : (A, D)
        Unknown angles = ``angles`` · directions + ``shift`` · (known variables, 1).
    shift : (A, p + 1)
    tied : (A, D)
        Turns of the angles per turn of the ``free`` (D,) ones, by linear rows.
    along : tuple of int
        The direction of each unknown length, -1 if it is known.
    """

    table: LoopTable
    column: IndexArray
    rows: IndexArray
    angles: Array
    shift: Array
    tied: Array
    free: IndexArray
    along: tuple[int, ...]

    @property
    def directions(self) -> int:
        """D, the number of unknown directions."""
        return int(self.angles.shape[1])

    @cached_property
    def turning(self) -> IndexArray:
        """The unknowns of the block that are angles."""
        return np.flatnonzero(self.table.is_angle[: self.table.unknowns])

    @cached_property
    def sliding(self) -> IndexArray:
        """The unknowns of the block that are lengths."""
        return np.flatnonzero(~self.table.is_angle[: self.table.unknowns])

    def closures(self, known: Array, spread: Array) -> tuple[ComplexArray, Array]:
        """``left`` of the bilinear systems, (B, L, M + 1), and bounds of its errors.

        Parameters
        ----------
        known, spread : (B, p)
            Values of the known variables and bounds of their errors.
        """
        table, loops = self.table, self.table.loops
        n, scale = table.unknowns, table.variable_scale
        ones = np.ones((len(known), 1))
        shifted = np.concatenate([known, ones], axis=1) @ self.shift.T
        shifted_off = np.concatenate([spread, 0.0 * ones], axis=1) @ np.abs(self.shift).T
        v = np.zeros((len(known), table.variables))
        v[:, self.turning], v[:, n:] = shifted, known
        off = np.zeros_like(v)
        off[:, self.turning], off[:, n:] = shifted_off, spread
        size = float(table.equation_scale[0])
        weights = loops.weight_matrix
        phase = v @ weights
        turned = np.abs(v) @ np.abs(weights)
        slack = off @ np.abs(weights) + UNIT_ROUNDOFF * (4.0 * turned + 16.0 + len(loops.row))
        length = np.ones(phase.shape)
        length_off = np.zeros(phase.shape)
        for t, j in enumerate(loops.length):
            if j >= n:
                length[:, t], length_off[:, t] = v[:, j], off[:, j]
            elif j >= 0:
                length[:, t] = scale[j]
        term = loops.coefficient * length * np.exp(1j * phase) / size
        error = np.abs(loops.coefficient) / size * (np.abs(length) * slack + length_off)
        left = np.zeros((len(known), loops.rows, self.rows.shape[1] + 1), dtype=complex)
        away = np.zeros(left.shape)
        for t, (row, column) in enumerate(zip(loops.row, self.column, strict=True)):
            left[:, row, column] += term[:, t]
            away[:, row, column] += error[:, t]
        return left, away

    def system(self, left: ComplexArray) -> BilinearSystem:
        """The bilinear system of one closure matrix (L, M + 1), or those of stacked ones.

        Raises
        ------
        NoDirectionForm
            If the loops are not independent.
        """
        check_independent(left)
        return BilinearSystem(left=left, right=left.conj(), rows=self.rows)

    def unknowns(self, x: ComplexArray, known: Array, near: Array) -> Array:
        """The block's unknowns (R, n) of real solutions (U, V) (R, 2M) for known values (R, p).

        Angles are within half a turn of ``near`` (n,) unless a linear row prevents it.
        """
        count, m = self.directions, self.rows.shape[1]
        # the mean of e^{iθ} from U and from V
        psi = np.angle(x[:, :count] + x[:, m : m + count].conj())
        ones = np.ones((len(x), 1))
        angles = psi @ self.angles.T + np.concatenate([known, ones], axis=1) @ self.shift.T
        away = angles[:, self.free] - near[self.turning][self.free]
        # whole turns of the free angles; dependent ones follow
        turns = np.floor((away + np.pi) / (2.0 * np.pi))
        found = np.zeros((len(x), self.table.unknowns))
        found[:, self.turning] = angles - 2.0 * np.pi * (turns @ self.tied.T)
        for k, (j, a) in enumerate(zip(self.sliding, self.along, strict=True)):
            z = x[:, count + k]
            turned = z * np.exp(-1j * psi[:, a]) if a >= 0 else z
            found[:, j] = turned.real * self.table.variable_scale[j]
        return found


def check_independent(left: ComplexArray) -> None:
    """Reject closures (..., L, M + 1) that are not independent.

    Raises
    ------
    NoDirectionForm
        If the loops are not independent.
    """
    sizes = np.linalg.svd(left, compute_uv=False)
    if (sizes[..., -1] <= _DEPENDENT * sizes[..., 0]).any():
        raise NoDirectionForm("are not independent: one follows from the others")


def direction_form(table: LoopTable, free: int = 0) -> DirectionForm:
    """The form of a block, or of several blocks with ``free`` undetermined unknowns.

    Raises
    ------
    NoDirectionForm
        If the block has no such form.
    """
    if table.functions:
        cams = table.has_curvature_bound
        raise NoDirectionForm(
            "contain a law of a cam or curve" if cams else "are plain equations, not loops"
        )
    n, loops = table.unknowns, table.loops
    turning = np.flatnonzero(table.is_angle[:n])
    sliding = np.flatnonzero(~table.is_angle[:n])
    reduce, shift, free_angles = _solve_lines(table, turning, sliding)
    if np.abs(loops.weight_matrix[sliding]).max(initial=0.0) > 0.0:
        raise NoDirectionForm("relate an angle to a length, as racks and rolling wheels do")
    sums = loops.weight_matrix[turning].T @ reduce
    directions, number = _directions(sums)
    angles = reduce @ _inverse(directions, reduce.shape[1])
    along = _along(table, number, sliding)
    if loops.rows > _MOST_LOOPS:
        raise NoDirectionForm(
            f"are {loops.rows} coupled loops; paths are followed for at most {_MOST_LOOPS}"
        )
    size = len(directions) + len(sliding)
    if size != 2 * loops.rows + free:
        raise NoDirectionForm("do not have two unknown directions or lengths for every loop")
    place = {int(j): len(directions) + k for k, j in enumerate(sliding)}
    column = np.where(number < 0, size, number)
    column = np.array(
        [place.get(int(j), int(c)) for j, c in zip(loops.length, column, strict=True)],
        dtype=np.intp,
    )
    one = size
    products = [(k, k, one, one) for k in range(len(directions))]
    for k, a in enumerate(along, len(directions)):
        products.append((k, one, one, k) if a < 0 else (k, a, a, k))
    return DirectionForm(
        table=table,
        column=column,
        rows=np.array(products, dtype=np.intp).reshape(size, 4).T,
        angles=angles,
        shift=shift,
        tied=reduce,
        free=np.array(free_angles, dtype=np.intp),
        along=along,
    )


def _solve_lines(
    table: LoopTable, turning: IndexArray, sliding: IndexArray
) -> tuple[Array, Array, list[int]]:
    """Solve linear rows: angles = first · (remaining angles) + second · (known, 1)."""
    n, lines = table.unknowns, table.linear
    rows = np.zeros((len(lines.constant), table.variables + 1))
    np.add.at(rows, (lines.row, lines.variable), lines.weight)
    rows[:, -1] = lines.constant
    _check_lengths_untied(rows, turning, sliding)
    own = rows[:, turning].copy()
    rest = np.concatenate([rows[:, n:-1], rows[:, -1:]], axis=1)
    pivots = _eliminate(own, rest)
    free = [j for j in range(len(turning)) if j not in pivots]
    reduce = np.zeros((len(turning), len(free)))
    shift = np.zeros((len(turning), rest.shape[1]))
    for column, j in enumerate(free):
        reduce[j, column] = 1.0
    for k, j in enumerate(pivots):
        reduce[j] = -own[k, free]
        shift[j] = -rest[k]
    return reduce, shift, free


def _check_lengths_untied(rows: Array, turning: IndexArray, sliding: IndexArray) -> None:
    tied = np.abs(rows[:, sliding]).max(axis=1, initial=0.0) > 0.0
    if not tied.any():
        return
    lengths_only = (rows[np.ix_(tied, turning)] == 0.0).all()
    if lengths_only and ((rows[np.ix_(tied, sliding)] != 0.0).sum(axis=1) > 1).all():
        raise NoDirectionForm("relate two lengths, as inputs driven together do")
    raise NoDirectionForm("relate an angle to a length, as racks and rolling wheels do")


def _eliminate(own: Array, rest: Array) -> list[int]:
    """Solve lines own · angles + rest · known = 0 in place, each for one angle; returns these.

    An angle that depends on known variables only may have any ratio. Otherwise a turn of one angle
    must be an integer number of turns of the other.
    """
    pivots: list[int] = []
    for k in range(len(own)):
        j = int(np.argmax(np.abs(own[k])))
        if abs(own[k, j]) <= _WHOLE:
            raise NoDirectionForm("relate the same angles twice")
        pivots.append(j)
        _solve_for(own, rest, k, j)
    for k, j in enumerate(pivots):
        others = [i for i in np.flatnonzero(np.abs(own[k]) > _WHOLE).tolist() if i != j]
        for choice in (j, *others) if others else ():
            turns = own[k] / own[k, choice]
            if np.abs(turns - np.round(turns)).max() <= _WHOLE:
                pivots[k] = choice
                _solve_for(own, rest, k, choice)
                break
        else:
            if others:
                raise NoDirectionForm("relate angles with ratios other than 1, as gears do")
    return pivots


def _solve_for(own: Array, rest: Array, row: int, angle: int) -> None:
    """Eliminate one angle from all rows but one, where its weight is 1."""
    own[row], rest[row] = own[row] / own[row, angle], rest[row] / own[row, angle]
    for other in range(len(own)):
        if other != row and own[other, angle]:
            factor = own[other, angle]
            own[other] -= factor * own[row]
            rest[other] -= factor * rest[row]


def _directions(sums: Array) -> tuple[list[tuple[float, ...]], IndexArray]:
    """The distinct sums of angles in the terms, and each term's index, -1 for none."""
    rows = [tuple(row) for row in sums.tolist()]
    # in the order of the angles, independent of the order of the terms
    found = sorted({row for row in rows if any(row)}, reverse=True)
    place = {row: k for k, row in enumerate(found)}
    # its direction would be needed in U and V
    if any(tuple(-w for w in row) in place for row in found):
        raise NoDirectionForm("contain an angle both forwards and backwards")
    number = np.array([place.get(row, -1) for row in rows], dtype=np.intp)
    return found, number


def _inverse(directions: list[tuple[float, ...]], angles: int) -> Array:
    """Angles in terms of directions: an integer inverse."""
    if len(directions) > angles:
        raise NoDirectionForm("contain more sums of angles than angles, as gears do")
    if len(directions) < angles:
        raise NoDirectionForm("do not determine an angle")
    matrix = np.array(directions, dtype=float).reshape(angles, angles)
    # only a unimodular matrix has an integer inverse
    if angles and abs(abs(float(np.linalg.det(matrix))) - 1.0) > 1e-9:
        raise NoDirectionForm("contain angles with ratios other than 1, as gears do")
    inverse = np.linalg.inv(matrix)
    whole = np.asarray(np.round(inverse), dtype=float)
    if (
        np.abs(inverse - whole).max(initial=0.0) > 1e-9
        or np.abs(matrix - np.round(matrix)).max(initial=0.0) > _WHOLE
    ):
        raise NoDirectionForm("contain angles with ratios other than 1, as gears do")
    return whole


def _along(table: LoopTable, number: IndexArray, sliding: IndexArray) -> tuple[int, ...]:
    """The direction of each unknown length, -1 for a known one."""
    found = []
    for j in sliding:
        mine: BoolArray = table.loops.length == j
        ways = set(number[mine].tolist())
        if len(ways) != 1:
            raise NoDirectionForm("use one length along several directions")
        found.append(int(ways.pop()))
    return tuple(found)
