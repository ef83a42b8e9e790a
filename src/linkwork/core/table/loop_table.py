"""The loop table."""

from __future__ import annotations

import hashlib
import math
from cmath import rect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.rounding import PRINTED_ANGLE, UNIT_ROUNDOFF
from linkwork.core.table.curvature import Curvature, PhaseGroups
from linkwork.core.table.packed_blocks import Packed, packed_terms
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

# ----------------------------------------------------------------------
# The equations of a loop table at one position, in plain numbers.
#
# An operation on an array takes a microsecond however short it is, one on a number a thirtieth of
# that: where a march takes one step after the other on small blocks, lists are several times
# faster.
# The formulas are those of :mod:`phasor_rows` and :mod:`curvature`; bounds of rounding hold for
# both.


_NOWHERE = complex(math.nan, math.nan)


@dataclass(frozen=True, eq=False)
class SingleCurvature:
    """What ``Curvature`` holds of one position, each array as a list of its rows."""

    phase: list[Row]
    slide: list[Row]
    rounding: Row
    jacobian_rounding: list[Row]
    printing: Row


class SinglePosition:
    """Loops and linear rows over N variables, the n unknowns first.

    ``printed``: of every unknown, see :attr:`LoopTable.printed_constant`.
    ``work``: of one evaluation, about the number of products.
    """

    def __init__(
        self, groups: PhaseGroups, lines: LinearRows, unknowns: int, printed: Sequence[float]
    ) -> None:
        loops = groups.rows
        self._printed = [(k, c) for k, c in enumerate(printed) if c == c]
        self.unknowns, self.variables, self.loops = unknowns, loops.variables, loops.rows
        self._take_loops(groups)
        self._take_lines(lines)
        self.equations = 2 * self.loops + len(self._lines)
        self._take_sizes(groups)
        self.loop_rows, self.loop_phases = 2 * self.loops, len(self.phases)
        lengths, pair_phases, _ = groups.pairs
        #: Variable length and phase of every pair that occurs.
        self.pairs: list[tuple[int, int]] = list(
            zip(lengths.tolist(), pair_phases.tolist(), strict=True)
        )
        self.work = len(loops.row) + self.equations * self.variables

    def _take_loops(self, groups: PhaseGroups) -> None:
        """Terms of a loop that turn together are added up; those with a variable length follow."""
        loops, members = groups.rows, groups.members.tolist()
        first = {g: t for t, g in reversed(list(enumerate(members)))}
        shown = {t: g for g, t in first.items()}
        #: The variables and weights of every phase.
        self.phases: list[list[tuple[int, float]]] = [[] for _ in first]
        entries = (loops.phase_term, loops.phase_variable, loops.phase_weight)
        for t, k, w in zip(*(x.tolist() for x in entries), strict=True):
            if t in shown:
                self.phases[shown[t]].append((k, w))
        #: The same, if every phase is the multiple of one variable.
        self._plain = [own[0] for own in self.phases if len(own) == 1]
        if len(self._plain) < len(self.phases):
            self._plain = []
        fixed: dict[tuple[int, int], complex] = {}
        self._sliding: list[tuple[int, int, complex, int]] = []
        terms = (loops.row, loops.coefficient, loops.length)
        for g, row, c, length in zip(members, *(x.tolist() for x in terms), strict=True):
            if length < 0:
                fixed[row, g] = fixed.get((row, g), 0.0) + c
            else:
                self._sliding.append((row, g, c, length))
        self._fixed = [(row, g, c) for (row, g), c in fixed.items()]

    def _take_lines(self, lines: LinearRows) -> None:
        entries: list[dict[int, float]] = [{} for _ in lines.constant]
        parts = (lines.row, lines.variable, lines.weight)
        for row, k, w in zip(*(x.tolist() for x in parts), strict=True):
            entries[row][k] = entries[row].get(k, 0.0) + w  # a variable may occur twice in a row
        self._lines = list(
            zip(lines.constant.tolist(), (list(e.items()) for e in entries), strict=True)
        )
        self._line_slopes = [[own.get(k, 0.0) for k in range(self.variables)] for own in entries]

    def _take_sizes(self, groups: PhaseGroups) -> None:
        """Sums of moduli, for bounds of rounding."""
        loops, members = groups.rows, groups.members.tolist()
        counts = [0] * self.loops
        for row in loops.row.tolist():
            counts[row] += 1
        roundings = groups.roundings.tolist()
        self._parts: list[tuple[int, int, float, int, float]] = []
        terms = (loops.row, loops.coefficient, loops.length)
        for g, row, c, length in zip(members, *(x.tolist() for x in terms), strict=True):
            self._parts.append((row, g, abs(c), length, counts[row] + 8.0))
        self._roundings = roundings
        self._slip = UNIT_ROUNDOFF * (len(loops.row) + loops.rows + 8)
        self._pair_sums: list[list[tuple[int, complex, float]]] = []
        lengths, _, sums = groups.pairs
        for p in range(len(lengths)):
            column = zip(sums[:, p].tolist(), groups.pair_size[:, p].tolist(), strict=True)
            self._pair_sums.append([(r, c, size) for r, (c, size) in enumerate(column) if size])
        self._still = [
            (weights, constant, UNIT_ROUNDOFF * (self.variables + 3))
            for constant, weights in self._lines
        ]
        self._line_rounding = [
            [UNIT_ROUNDOFF * (self.equations + 4) * abs(x) for x in row]
            for row in self._line_slopes
        ]

    @cached_property
    def packed(self) -> Packed:
        """All terms as numbers, for compiled code."""
        return packed_terms(self.loops, self.phases, self._fixed, self._sliding, self._lines)

    # ---------------------------------------------------------------- values

    def _phasors(self, v: Sequence[float]) -> list[complex]:
        """e^{iψ} of every phase."""
        total = sum(v)
        if self._plain and total - total == 0.0:  # all angles are finite
            return [rect(1.0, w * v[k]) for k, w in self._plain]  # eq. (1)
        found = []
        for phase in self.phases:
            psi = 0.0
            for k, w in phase:
                psi += w * v[k]
            # an infinite angle has no direction
            found.append(rect(1.0, psi) if psi - psi == 0.0 else _NOWHERE)  # eq. (1)
        return found

    def residual(self, v: Sequence[float]) -> Row:
        """F, (m,)."""
        e = self._phasors(v)
        value = [0j] * self.loops
        for row, g, c in self._fixed:
            value[row] += c * e[g]
        for row, g, c, length in self._sliding:
            value[row] += c * e[g] * v[length]
        found = [z.real for z in value]
        found += [z.imag for z in value]
        return found + self._line_values(v) if self._lines else found

    def _line_values(self, v: Sequence[float]) -> Row:
        found = []
        for constant, weights in self._lines:
            total = constant
            for k, w in weights:
                total += w * v[k]
            found.append(total)
        return found

    def residual_and_jacobian(self, v: Sequence[float]) -> tuple[Row, list[Row]]:
        """F, (m,), and dF/dv, (m, N), rows of which are not to be changed."""
        e, phases, columns = self._phasors(v), self.phases, self.variables
        value = [0j] * self.loops
        real, imag = ([[0.0] * columns for _ in value] for _ in range(2))
        for row, g, c in self._fixed:
            term = c * e[g]
            value[row] += term
            x, y, above, below = term.real, term.imag, real[row], imag[row]
            for k, w in phases[g]:  # eq. (2): turning
                above[k] -= w * y
                below[k] += w * x
        for row, g, c, length in self._sliding:
            bare = c * e[g]
            term = bare * v[length]
            value[row] += term
            x, y, above, below = term.real, term.imag, real[row], imag[row]
            above[length] += bare.real  # eq. (2): sliding
            below[length] += bare.imag
            for k, w in phases[g]:
                above[k] -= w * y
                below[k] += w * x
        found = [z.real for z in value]
        found += [z.imag for z in value]
        if self._lines:
            return found + self._line_values(v), real + imag + self._line_slopes
        return found, real + imag

    def second_directional_derivative(self, v: Sequence[float], d: Sequence[float]) -> Row:
        """D²F[d, d], (m,)."""
        value = [0j] * self.loops
        e, turns = self._phasors(v), []
        for phase in self.phases:
            turn = 0.0
            for k, w in phase:
                turn += w * d[k]
            turns.append(turn)
        for row, g, c in self._fixed:
            value[row] -= c * e[g] * (turns[g] * turns[g])  # eq. (3) with a = b
        for row, g, c, length in self._sliding:
            turn = turns[g]
            value[row] += c * e[g] * complex(-v[length] * turn * turn, 2.0 * d[length] * turn)
        found = [z.real for z in value]
        found += [z.imag for z in value]
        return found + [0.0] * len(self._lines) if self._lines else found

    # ---------------------------------------------------------------- bounds

    def curvature(self, v: Sequence[float], matrix: Sequence[Row]) -> SingleCurvature:
        """Bounds of the second derivatives multiplied by a matrix, (n, m) or wider."""
        loops = self.loops
        sums = [[0j] * loops for _ in self.phases]
        sizes = [[0.0] * loops for _ in self.phases]
        for row, g, c in self._fixed:
            sums[g][row] += c
        for row, g, c, length in self._sliding:
            sums[g][row] += c * v[length]
        rounding, slopes = self._rounding(v, sizes)
        phase, slide = [], []
        for own in matrix:
            alpha = [complex(own[r], -own[loops + r]) for r in range(loops)]
            slip = [self._slip * hypot(a.real, a.imag) for a in alpha]
            moduli = []
            for total, size in zip(sums, sizes, strict=True):
                z, rest = 0j, 0.0
                for a, s, c, x in zip(alpha, slip, total, size, strict=True):
                    z += a * c
                    rest += s * x
                moduli.append(hypot(z.real, z.imag) + rest)  # eq. (30): |α C|
            phase.append(moduli)
            moduli = []
            for members in self._pair_sums:
                z, rest = 0j, 0.0
                for r, c, x in members:
                    z += alpha[r] * c
                    rest += slip[r] * x
                moduli.append(hypot(z.real, z.imag) + rest)  # eq. (30): |α D|
            slide.append(moduli)
        printing = [0.0] * self.unknowns
        for k, constant in self._printed:
            printing[k] = PRINTED_ANGLE * (abs(v[k]) + constant)
        return SingleCurvature(phase, slide, rounding, slopes, printing)

    def _rounding(self, v: Sequence[float], sizes: list[Row]) -> tuple[Row, list[Row]]:
        """Bounds of the errors of F and of dF/dv; ``sizes`` (G, L): filled with sums of moduli."""
        parts = []
        for count, phase in zip(self._roundings, self.phases, strict=True):
            extent = 0.0
            if count:
                for k, w in phase:
                    extent += abs(w * v[k])
            parts.append(count * extent)
        error = [0.0] * self.loops
        slopes = [[0.0] * self.variables for _ in error]
        products = self.equations + 2.0
        for row, g, size, length, terms in self._parts:
            whole = size if length < 0 else size * abs(v[length])
            sizes[g][row] += whole
            factor = terms + parts[g]  # eq. (34)
            error[row] += whole * factor
            factor = (factor + products) * UNIT_ROUNDOFF
            own = slopes[row]
            for k, w in self.phases[g]:
                own[k] += abs(w) * whole * factor
            if length >= 0:
                own[length] += size * factor
        error = [UNIT_ROUNDOFF * x for x in error]
        error += error
        slopes += slopes
        for weights, constant, unit in self._still:
            total = abs(constant)
            for k, w in weights:
                total += abs(w * v[k])
            error.append(unit * total)
        return error, slopes + self._line_rounding


# ----------------------------------------------------------------------
# The equations of a loop table with laws at one position, in plain numbers.
#
# The formulas are those of :mod:`law_row` and :mod:`piecewise`.


Row = list[float]
_Bounds = Callable[[Array, Array], Curvature]
_WORK = 12  # products of one law


class SingleWithLaws:
    """Loops and linear rows, and the laws after them; see :class:`SinglePosition`.

    ``curvature``: bounds as of arrays.
    """

    #: Compiled code knows no laws.
    packed = None

    def __init__(self, rest: SinglePosition, laws: Sequence[LawRow], curvature: _Bounds) -> None:
        self.rest, self.laws, self._curvature = rest, laws, curvature
        self.unknowns, self.variables = rest.unknowns, rest.variables
        self.loop_rows, self.loop_phases, self.pairs = rest.loop_rows, rest.loop_phases, rest.pairs
        #: Every law turns along one sum of variables, as a phase does.
        self.phases = [*rest.phases, *([(k, w) for k, _, w in law.terms] for law in laws)]
        self.work = rest.work + len(laws) * (_WORK + rest.variables)

    def residual(self, v: Sequence[float]) -> Row:
        """F, (m,)."""
        return self.rest.residual(v) + [law.jet_at(v)[0] for law in self.laws]

    def residual_and_jacobian(self, v: Sequence[float]) -> tuple[Row, list[Row]]:
        """F, (m,), and dF/dv, (m, N), rows of which are not to be changed."""
        value, slopes = self.rest.residual_and_jacobian(v)
        jets = [law.jet_at(v) for law in self.laws]
        own = [self._gradient(law, jet[1]) for law, jet in zip(self.laws, jets, strict=True)]
        return value + [jet[0] for jet in jets], slopes + own

    def _gradient(self, law: LawRow, slope: float) -> Row:
        found = [0.0] * self.variables
        for k, a, w in law.terms:
            found[k] += a - slope * w  # eq. (4)
        return found

    def second_directional_derivative(self, v: Sequence[float], d: Sequence[float]) -> Row:
        """D²F[d, d], (m,)."""
        turned = [sum([w * d[k] for k, _, w in law.terms]) for law in self.laws]
        bends = [-law.jet_at(v)[2] * x * x for law, x in zip(self.laws, turned, strict=True)]
        return self.rest.second_directional_derivative(v, d) + bends

    def curvature(self, v: Sequence[float], matrix: Sequence[Row]) -> SingleCurvature:
        """Bounds of the second derivatives multiplied by a matrix, (n, m) or wider."""
        found = self._curvature(np.array([v]), np.array([matrix]))
        parts = (found.phase, found.slide, found.rounding, found.jacobian_rounding, found.printing)
        return SingleCurvature(*(part[0].tolist() for part in parts))


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

    @cached_property
    def single(self) -> SinglePosition | SingleWithLaws | None:
        """The equations at one position at a time; ``None`` with rows of any formula."""
        if not self.has_curvature_bound:
            return None
        own = SinglePosition(
            self._groups, self.linear, self.unknowns, self.printed_constant[: self.unknowns]
        )
        return SingleWithLaws(own, self._bounded, self.curvature) if self.functions else own

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
