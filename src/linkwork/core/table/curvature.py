"""How fast a loop table bends: exact bounds of its second derivatives, multiplied by a matrix.

Terms with the same phase turn together, so their complex coefficients are added before a modulus is
taken: with α = A_re - i A_im the row i of A·D²F along unit directions is at most

    Σ_g |Σ_l α_il C_lg| Ω_g² + 2 Σ_{j,g} |Σ_l α_il D_ljg| w_j Ω_g

where C_lg sums c·s and D_ljg sums c over the terms of loop l with phase g (and variable length j).
Linear rows do not bend. A row Σ a v - f(Σ w v) bends along its own sum, |A_ir| sup|f''| |w|²; such
rows count as further phases after those of the loops. Rows of any formula have no bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray, tall_product
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.table.rows import PhasorRows


@dataclass(frozen=True, kw_only=True, eq=False)
class Curvature:
    """Moduli of second derivatives multiplied by a matrix A with n rows, for B positions.

    ``loop_rows``: how many of the m equations belong to loops; other rows follow.
    ``phase`` (B, n, G): |Σ_l α_il C_lg|, after those of loops |A_ir| sup|f''| of the laws;
    ``loop_phases`` of them belong to loops. ``slide`` (B, n, P): |Σ_l α_il D_lp| for every
    pair p of a variable length and a phase. ``weights`` (N, G): |W|. ``pair_length``,
    ``pair_group`` (P,): the pair's variable and phase. ``rounding`` (B, m): bounds of the error of
    computing F. ``jacobian_rounding`` (B, m, N): of computing dF/dv and its products with m numbers
    of size 1. ``printing`` (B, n): of printing the unknowns.
    """

    loop_rows: int
    loop_phases: int
    phase: Array
    slide: Array
    weights: Array
    pair_length: IndexArray
    pair_group: IndexArray
    rounding: Array
    jacobian_rounding: Array
    printing: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class PhaseGroups:
    """The terms of some rows sorted by phase; everything that does not depend on a position."""

    rows: PhasorRows

    @cached_property
    def _grouped(self) -> tuple[Array, IndexArray, IndexArray]:
        """|W| by group, (N, G), the group of each term, and roundings in computing a phase."""
        rows = self.rows
        columns: list[list[tuple[int, float]]] = [[] for _ in rows.row]
        for t, k, w in zip(rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True):
            columns[t].append((int(k), float(w)))
        number: dict[tuple[tuple[int, float], ...], int] = {}
        group = [number.setdefault(tuple(sorted(column)), len(number)) for column in columns]
        weights = np.zeros((rows.variables, len(number)))
        for column, g in number.items():
            for k, w in column:
                weights[k, g] += abs(w)
        roundings = [
            # every product, and the weights themselves
            0 if len(column) < 2 and all(_doubles(w) for _, w in column) else len(column) + 1
            for column in number
        ]
        return weights, np.array(group, dtype=np.intp), np.array(roundings, dtype=np.intp)

    @property
    def weights(self) -> Array:
        """|W| by group, (N, G)."""
        return self._grouped[0]

    @property
    def members(self) -> IndexArray:
        """The group of each term, (T,)."""
        return self._grouped[1]

    @property
    def roundings(self) -> IndexArray:
        """How many roundings there are in computing a phase, (G,)."""
        return self._grouped[2]

    @cached_property
    def _sorted_in(self) -> ComplexArray:
        """Adds terms into (row, group) places, (T, R G)."""
        rows, group = self.rows, self._grouped[1]
        count = self.weights.shape[1]
        m = np.zeros((len(rows.row), rows.rows * count), dtype=complex)
        m[np.arange(len(rows.row)), rows.row * count + group] = rows.coefficient
        return m

    @cached_property
    def pairs(self) -> tuple[IndexArray, IndexArray, ComplexArray]:
        """Variable length and phase of every pair that occurs, and its coefficients D (R, P)."""
        rows, group = self.rows, self._grouped[1]
        sliding = np.flatnonzero(rows.length >= 0)
        number: dict[tuple[int, int], int] = {}
        place = [
            number.setdefault((int(rows.length[t]), int(group[t])), len(number)) for t in sliding
        ]
        d = np.zeros((rows.rows, len(number)), dtype=complex)
        np.add.at(d, (rows.row[sliding], np.array(place, dtype=np.intp)), rows.coefficient[sliding])
        lengths = np.array([j for j, _ in number], dtype=np.intp)
        groups = np.array([g for _, g in number], dtype=np.intp)
        return lengths, groups, d

    def moduli(self, v: Array, alpha: ComplexArray) -> tuple[Array, Array]:
        """``phase`` (B, n, G) and ``slide`` (B, n, P) of :class:`Curvature`.

        With the rounding of the sums, which is all that is left where their terms cancel.
        """
        rows = self.rows
        s = np.ones((len(v), len(rows.row)))
        sliding = np.flatnonzero(rows.length >= 0)
        s[:, sliding] = v[:, rows.length[sliding]]
        c = tall_product(s, self._sorted_in).reshape(len(v), rows.rows, self.weights.shape[1])
        size = tall_product(np.abs(s), np.abs(self._sorted_in)).reshape(c.shape)
        # where terms of one phase cancel, rounding is all that is left of their sum
        slip = UNIT_ROUNDOFF * (len(rows.row) + rows.rows + 8) * np.abs(alpha)
        d = self.pairs[2]
        phase = np.abs(alpha @ c) + slip @ size  # eq. (30): |α C|
        return phase, np.abs(alpha @ d) + slip @ self.pair_size  # eq. (30): |α D|

    @cached_property
    def pair_size(self) -> Array:
        """Sums of moduli in the pairs' coefficients, (R, P)."""
        rows, (lengths, groups, d) = self.rows, self.pairs
        size = np.zeros(d.shape)
        for p, (j, g) in enumerate(zip(lengths, groups, strict=True)):
            mine = (rows.length == j) & (self._grouped[1] == g)
            np.add.at(size[:, p], rows.row[mine], np.abs(rows.coefficient[mine]))
        return size

    def rounding(self, v: Array, products: int) -> tuple[Array, Array]:
        """Bounds of |error of F|, (B, R), and of |error of dF/dv|, (B, R, N).

        A phase that has to be computed from its variables is itself rounded, in proportion to its
        parts. ``products``: of how many summands the Jacobian's products with a matrix are.
        """
        rows = self.rows
        _, group, roundings = self._grouped
        parts = tall_product(np.abs(v), self.weights)  # (B, G)
        terms_in_row = np.bincount(rows.row, minlength=rows.rows)[rows.row]
        factor = terms_in_row + 8.0 + (roundings * parts)[:, group]  # eq. (34)
        modulus, slopes = rows.moduli(v, factor + products + 2.0)
        gather = np.zeros((len(rows.row), rows.rows))
        gather[np.arange(len(rows.row)), rows.row] = 1.0
        return UNIT_ROUNDOFF * tall_product(modulus * factor, gather), UNIT_ROUNDOFF * slopes


def _doubles(weight: float) -> bool:
    """Whether multiplying by it rounds nothing: a power of two."""
    return abs(math.frexp(weight)[0]) == 0.5
