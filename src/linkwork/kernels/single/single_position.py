"""The equations of a loop table at one position, in plain numbers.

An operation on an array takes a microsecond however short it is, one on a number a thirtieth of
that: where a march takes one step after the other on small blocks, lists are several times faster.
The formulas are those of :mod:`phasor_rows` and :mod:`curvature`; bounds of rounding hold for both.
"""

from __future__ import annotations

import math
from cmath import rect
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import hypot

from linkwork.foundation.rounding import PRINTED_ANGLE, UNIT_ROUNDOFF
from linkwork.kernels.curvature import PhaseGroups
from linkwork.kernels.real_rows import LinearRows
from linkwork.kernels.single.packed_blocks import Packed, packed_terms

__all__ = ["SingleCurvature", "SinglePosition"]

_NOWHERE = complex(math.nan, math.nan)

Row = list[float]


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
