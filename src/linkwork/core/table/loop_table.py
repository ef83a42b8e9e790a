"""How fast a loop table bends: exact bounds of its second derivatives, multiplied by a matrix.

Terms with the same phase turn together, so their complex coefficients are added before a modulus is
taken: with α = A_re - i A_im the row i of A·D²F along unit directions is at most

    Σ_g |Σ_l α_il C_lg| Ω_g² + 2 Σ_{j,g} |Σ_l α_il D_ljg| w_j Ω_g

where C_lg sums c·s and D_ljg sums c over the terms of loop l with phase g (and variable length j).
Linear rows do not bend. A row Σ a v - f(Σ w v) bends along its own sum, |A_ir| sup|f''| |w|²; such
rows count as further phases after those of the loops. Rows of any formula have no bound.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import (
    PRINTED_ANGLE,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    tall_product,
)
from linkwork.core.table.rows import (
    TURN_ROUNDING,
    EnclosedRow,
    FunctionRow,
    LawRow,
    LinearRows,
    PhasorRows,
    exact_line,
    exact_rows,
    hessian_of,
)


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


# ----------------------------------------------------------------------
# The loop table.


# ----------------------------------------------------------------------
# The loop table: every equation of a mechanism as arrays.
#
# Rows, in this order: real parts of L loops, imaginary parts of L loops, linear rows
# A v + b = 0 (relative angles, gears), function rows. Columns: n unknowns, then the inputs.


@dataclass(frozen=True, kw_only=True)
class LoopTable:
    """All equations over n unknowns and the inputs after them.

    Parameters
    ----------
    unknowns : int
        n; the variables after them are inputs.
    loops : PhasorRows
        L complex rows over all N variables.
    linear : LinearRows
    functions : tuple of FunctionRow
    equation_scale : (m,)
        The scale that divides each real row's residual before it is compared.
    variable_scale : (N,)
        Weight of each variable: 1 for angles, a length of the mechanism for lengths.
    is_angle : (N,) bool
        Which variables are angles.
    link_constant : (N,), optional
        No smaller than the constants of links that turn with each variable [rad].
    """

    unknowns: int
    loops: PhasorRows
    linear: LinearRows
    functions: tuple[FunctionRow, ...]
    equation_scale: Array
    variable_scale: Array
    is_angle: BoolArray
    link_constant: Array | None = None

    @property
    def variables(self) -> int:
        """N, unknowns and inputs."""
        return len(self.variable_scale)

    @property
    def equations(self) -> int:
        """m, real equations."""
        return len(self.equation_scale)

    @cached_property
    def structure(self) -> bytes:
        """A digest of all but function rows, coefficients, constants and scales."""
        loops, lines = self.loops, self.linear
        sizes = np.array([self.unknowns, self.variables, loops.rows, len(lines.constant)])
        of_loops = [loops.row, loops.length, loops.phase_term, loops.phase_variable]
        of_lines = [lines.row, lines.variable, lines.weight]
        printed = [self.is_angle, np.asarray(self.printed_constant)]
        parts = [sizes, *of_loops, loops.phase_weight, *of_lines, *printed]
        digest = hashlib.sha256()
        for part in parts:
            digest.update(f"{part.dtype} {part.shape} ".encode() + part.tobytes())
        return digest.digest()

    @cached_property
    def printed_constant(self) -> list[float]:
        """The largest constant printed with each variable, NaN for lengths: N numbers."""
        constant = np.zeros(self.variables) if self.link_constant is None else self.link_constant
        return list(np.where(self.is_angle, constant, np.nan).tolist())

    @cached_property
    def _linear_matrix(self) -> Array:
        a = np.zeros((len(self.linear.constant), self.variables))
        # add.at: a variable may occur twice in a row, and "+=" would count it once
        np.add.at(a, (self.linear.row, self.linear.variable), self.linear.weight)
        return a

    @property
    def _only_loops(self) -> bool:
        return not len(self.linear.constant) and not self.functions

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, m), and dF/dv, (B, m, N)."""
        value, slope = self.loops.value_and_jacobian(v)
        residual = np.concatenate([value.real, value.imag], axis=1)
        jacobian = np.concatenate([slope.real, slope.imag], axis=1)
        if self._only_loops:
            return residual, jacobian
        extra, extra_slope = self._real_rows(v)
        return (
            np.concatenate([residual, extra], axis=1),
            np.concatenate([jacobian, extra_slope], axis=1),
        )

    def residual(self, v: Array) -> Array:
        """F, (B, m)."""
        value = self.loops.value(v)
        residual = np.concatenate([value.real, value.imag], axis=1)
        if self._only_loops:
            return residual
        return np.concatenate([residual, self._real_rows(v)[0]], axis=1)

    def exact_residual(self, v: Array) -> tuple[Array, Array]:
        """F at one position v (N,), (m,), each loop and line rounded once, and its error bounds."""
        value = exact_rows(self.loops, v)
        lines = [
            exact_line(constant, row.tolist(), v.tolist())
            for constant, row in zip(self.linear.constant, self._linear_matrix, strict=True)
        ]
        found = np.concatenate([value.real, value.imag, lines])
        rows = [row.value_and_gradient(v[None, :])[0][0] for row in self.functions]
        errors = [
            row.rounding(v[None, :])[0][0] if isinstance(row, LawRow) else np.inf
            for row in self.functions
        ]
        return np.append(found, rows), np.append(UNIT_ROUNDOFF * np.abs(found), errors)

    def jacobian(self, v: Array) -> Array:
        """dF/dv, (B, m, N): the Jacobian by the unknowns, then the derivative by the inputs."""
        return self.residual_and_jacobian(v)[1]

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """D²F[d, d], the directional second derivative, (B, m)."""
        value = self.loops.jet(v, d, np.zeros_like(d))[2]
        parts = [value.real, value.imag]
        if not self._only_loops:
            parts.append(np.zeros((len(v), len(self.linear.constant))))
            parts += [row.second_directional_derivative(v, d)[:, None] for row in self.functions]
        return np.concatenate(parts, axis=1)

    def hessians(self, v: Array, weights: Array) -> Array:
        """Second derivatives of K sums of equations at one position v (N,), (K, N, N).

        ``weights`` (K, m): the factor of every equation in each sum.
        """
        rows = self.loops.rows
        found = self.loops.hessians(v, weights[:, :rows] - 1j * weights[:, rows : 2 * rows])
        first = self.equations - len(self.functions)
        for k, row in enumerate(self.functions, first):
            found += weights[:, k, None, None] * hessian_of(row, v)
        return found

    def repeats_after(self, turns: Array) -> bool:
        """Whether variables (N,) moved by this many whole turns each satisfy the same equations.

        Not so for a phase that they change by a fraction of a turn, nor for a linear row that they
        change at all. A length may gain 2π times its entry: in loops only along fixed directions
        in which such gains cancel.
        """
        rows = self.loops
        each = rows.phase_weight * turns[rows.phase_variable]
        phase, size = (
            np.bincount(rows.phase_term, part, minlength=len(rows.row))
            for part in (each, np.abs(each))
        )
        moved, bulk = self._linear_matrix @ turns, np.abs(self._linear_matrix) @ np.abs(turns)
        return self._gains_cancel(turns) and bool(
            (np.abs(phase - np.round(phase)) <= TURN_ROUNDING * size).all()
            and (np.abs(moved) <= TURN_ROUNDING * bulk).all()
            and all(row.repeats_after(turns[list(row.variables)]) for row in self.functions)
        )

    def _gains_cancel(self, turns: Array) -> bool:
        """Whether lengths that gain by ``turns`` (N,) leave every loop closed at all angles."""
        rows = self.loops
        gained = np.where(rows.length >= 0, turns[rows.length], 0.0)
        if not gained.any() or gained[rows.phase_term].any():  # along a direction that may turn
            return not gained.any()
        added = [(rows.coefficient * gained)[rows.row == row] for row in range(rows.rows)]
        return all(abs(sum(each)) <= TURN_ROUNDING * np.abs(each).sum() for each in added)

    @property
    def straight_parts(self) -> Array:
        """The weights of every equation that is linear in some variables, (rows, N)."""
        laws = np.zeros((len(self._bounded), self.variables))
        for weights, law in zip(laws, self._bounded, strict=True):
            np.add.at(weights, list(law.variables), law.weights)
        return np.concatenate([self._linear_matrix, laws])

    @property
    def has_curvature_bound(self) -> bool:
        """Whether :meth:`curvature` knows a bound: not for rows of any formula."""
        return len(self._bounded) == len(self.functions)

    @property
    def is_enclosed(self) -> bool:
        """Whether :meth:`enclosure` knows bounds: of rows of any formula alone."""
        only = not self.loops.rows and not len(self.linear.constant) and bool(self.functions)
        return only and all(isinstance(row, EnclosedRow) for row in self.functions)

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest F, (2, B, m), and dF/dv, (2, B, m, N), over boxes around v (B, N)
        with half widths ``box`` (B, N).
        """
        values = np.zeros((2, len(v), self.equations))
        slopes = np.zeros((2, len(v), self.equations, self.variables))
        for k, row in enumerate(self.functions):
            assert isinstance(row, EnclosedRow)
            values[:, :, k], slopes[:, :, k, list(row.variables)] = row.enclosure(v, box)
        return values, slopes

    @property
    def is_straight(self) -> bool:
        """Whether the unknowns enter linearly: lines, and laws of known variables."""
        if self.loops.rows or not self.has_curvature_bound:
            return False
        return not any(
            weight and variable < self.unknowns
            for row in self._bounded
            for variable, weight in zip(row.variables, row.inner, strict=True)
        )

    @cached_property
    def _bounded(self) -> list[LawRow]:
        return [row for row in self.functions if isinstance(row, LawRow)]

    @cached_property
    def _groups(self) -> PhaseGroups:
        return PhaseGroups(rows=self.loops)

    def curvature(self, v: Array, matrix: Array) -> Curvature:
        """Bounds of the second derivatives multiplied by a matrix.

        Parameters
        ----------
        v : (B, N)
        matrix : (B, n, m or more)
            The rows A; columns after the table's m equations are ignored.
        """
        count = self.loops.rows
        alpha = matrix[:, :, :count] - 1j * matrix[:, :, count : 2 * count]
        groups = self._groups
        phase, slide = groups.moduli(v, alpha)
        error, slopes = groups.rounding(v, self.equations)
        a = np.abs(self._linear_matrix)
        line_error = (np.abs(v) @ a.T + np.abs(self.linear.constant)) * (
            UNIT_ROUNDOFF * (self.variables + 3)
        )
        lines = np.broadcast_to(UNIT_ROUNDOFF * (self.equations + 4) * a, (len(v), *a.shape))
        lengths, group, _ = groups.pairs
        found = Curvature(
            loop_rows=2 * count,
            loop_phases=phase.shape[2],
            phase=phase,
            slide=slide,
            weights=groups.weights,
            pair_length=lengths,
            pair_group=group,
            rounding=np.concatenate([error, error, line_error], axis=1),
            jacobian_rounding=np.concatenate([slopes, slopes, lines], axis=1),
            printing=PRINTED_ANGLE
            * np.nan_to_num(np.abs(v) + np.array(self.printed_constant))[:, : self.unknowns],
        )
        return self._with_laws(found, v, matrix) if self.functions else found

    def _with_laws(self, found: Curvature, v: Array, matrix: Array) -> Curvature:
        """Every law bends along one sum of variables, as a phase does."""
        first = self.equations - len(self.functions)
        weights = np.zeros((self.variables, len(self._bounded)))
        phase = np.empty((*matrix.shape[:2], len(self._bounded)))
        errors, slopes = [], []
        for k, row in enumerate(self._bounded):
            variables = list(row.variables)
            np.add.at(weights[:, k], variables, np.abs(row.inner))
            phase[:, :, k] = np.abs(matrix[:, :, first + k]) * row.bend
            error, slope = row.rounding(v)
            errors.append(error)
            whole = np.zeros((len(v), self.variables))
            gradient = np.abs(row.value_and_gradient(v)[1])
            whole[:, variables] = slope + UNIT_ROUNDOFF * (self.equations + 4) * gradient
            slopes.append(whole)
        return replace(
            found,
            phase=np.concatenate([found.phase, phase], axis=2),
            weights=np.concatenate([found.weights, weights], axis=1),
            rounding=np.concatenate([found.rounding, np.stack(errors, axis=1)], axis=1),
            jacobian_rounding=np.concatenate(
                [found.jacobian_rounding, np.stack(slopes, axis=1)], axis=1
            ),
        )

    def _real_rows(self, v: Array) -> tuple[Array, Array]:
        a = self._linear_matrix
        values = [v @ a.T + self.linear.constant]  # eq. (4) with f = 0
        slopes = [np.broadcast_to(a, (len(v), *a.shape))]
        for row in self.functions:
            value, gradient = row.value_and_gradient(v)
            slope = np.zeros((len(v), 1, self.variables))
            slope[:, 0, list(row.variables)] = gradient
            values.append(value[:, None])
            slopes.append(slope)
        return np.concatenate(values, axis=1), np.concatenate(slopes, axis=1)

    def pattern(self) -> list[tuple[int, ...]]:
        """The variables in each equation: L loops (two real rows each), then the real rows."""
        found: list[set[int]] = [set() for _ in range(self.loops.rows + len(self.linear.constant))]
        loops = self.loops
        for term, variable in zip(loops.phase_term, loops.phase_variable, strict=True):
            found[loops.row[term]].add(int(variable))
        for row, length in zip(loops.row, loops.length, strict=True):
            if length >= 0:
                found[row].add(int(length))
        for row, variable in zip(self.linear.row, self.linear.variable, strict=True):
            found[loops.rows + row].add(int(variable))
        return [tuple(sorted(f)) for f in found] + [row.variables for row in self.functions]


# ----------------------------------------------------------------------
# Cutting a loop table into the tables of its blocks.


class TableSplitter:
    """Cuts a table into smaller ones; sparse, so that n cuts cost no more than the table."""

    def __init__(self, table: LoopTable) -> None:
        self.table = table
        loops, linear = table.loops, table.linear
        self._terms_of_row = _by_value(loops.row, loops.rows)
        self._entries_of_term = _by_value(loops.phase_term, len(loops.row))
        self._entries_of_linear = _by_value(linear.row, len(linear.constant))

    def part(self, equations: list[int], unknowns: list[int]) -> tuple[LoopTable, list[int]]:
        """The table of some equations (numbered as in ``pattern``) for some unknowns.

        Returns the table and the variables of the whole that it takes as inputs.
        """
        whole = self.table
        loops, lines, functions = self._sorted_out(equations)
        pattern = self._pattern(loops, lines) | {
            k for f in functions for k in whole.functions[f].variables
        }
        known = sorted(pattern - set(unknowns))
        index = {old: new for new, old in enumerate([*unknowns, *known])}
        order = np.array([*unknowns, *known], dtype=np.intp)
        n_loops, n_lines = whole.loops.rows, len(whole.linear.constant)
        real = [
            *loops,
            *[n_loops + k for k in loops],
            *[2 * n_loops + k for k in lines],
            *[2 * n_loops + n_lines + k for k in functions],
        ]
        part = LoopTable(
            unknowns=len(unknowns),
            loops=self._loops(loops, index),
            linear=self._linear(lines, index),
            functions=tuple(whole.functions[k].moved(index) for k in functions),
            equation_scale=whole.equation_scale[np.array(real, dtype=np.intp)],
            variable_scale=whole.variable_scale[order],
            is_angle=whole.is_angle[order],
            link_constant=None if whole.link_constant is None else whole.link_constant[order],
        )
        return part, known

    def _sorted_out(self, equations: list[int]) -> tuple[list[int], list[int], list[int]]:
        n_loops, n_lines = self.table.loops.rows, len(self.table.linear.constant)
        loops = [k for k in equations if k < n_loops]
        lines = [k - n_loops for k in equations if n_loops <= k < n_loops + n_lines]
        functions = [k - n_loops - n_lines for k in equations if k >= n_loops + n_lines]
        return loops, lines, functions

    def _pattern(self, loops: list[int], lines: list[int]) -> set[int]:
        table = self.table
        found: set[int] = set()
        for row in loops:
            for term in self._terms_of_row[row]:
                if table.loops.length[term] >= 0:
                    found.add(int(table.loops.length[term]))
                found.update(
                    int(table.loops.phase_variable[e]) for e in self._entries_of_term[term]
                )
        for row in lines:
            found.update(int(table.linear.variable[e]) for e in self._entries_of_linear[row])
        return found

    def _loops(self, rows: list[int], index: dict[int, int]) -> PhasorRows:
        loops = self.table.loops
        terms = [(new, t) for new, row in enumerate(rows) for t in self._terms_of_row[row]]
        entries = [(new, e) for new, (_, t) in enumerate(terms) for e in self._entries_of_term[t]]
        own = np.array([t for _, t in terms], dtype=np.intp)
        return PhasorRows(
            rows=len(rows),
            variables=len(index),
            row=np.array([new for new, _ in terms], dtype=np.intp),
            coefficient=loops.coefficient[own],
            length=np.array([index.get(int(k), -1) for k in loops.length[own]], dtype=np.intp),
            phase_term=np.array([new for new, _ in entries], dtype=np.intp),
            phase_variable=np.array(
                [index[int(loops.phase_variable[e])] for _, e in entries], dtype=np.intp
            ),
            phase_weight=np.array([loops.phase_weight[e] for _, e in entries], dtype=float),
        )

    def _linear(self, rows: list[int], index: dict[int, int]) -> LinearRows:
        linear = self.table.linear
        entries = [(new, e) for new, row in enumerate(rows) for e in self._entries_of_linear[row]]
        return LinearRows(
            constant=linear.constant[np.array(rows, dtype=np.intp)],
            row=np.array([new for new, _ in entries], dtype=np.intp),
            variable=np.array([index[int(linear.variable[e])] for _, e in entries], dtype=np.intp),
            weight=np.array([linear.weight[e] for _, e in entries], dtype=float),
        )


def _by_value(values: IndexArray, count: int) -> list[list[int]]:
    found: list[list[int]] = [[] for _ in range(count)]
    for k, value in enumerate(values):
        found[value].append(k)
    return found
