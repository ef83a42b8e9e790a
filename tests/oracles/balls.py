"""Loop tables in ball arithmetic: every number is an interval that is certain to hold the truth.

Written from the equations F_l = Σ c s exp(i Σ W v), not from the product's arrays: terms are kept
one by one, phases are compared after their weights are added, nothing is batched.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt
from flint import acb, arb, arb_mat, ctx, fmpq

from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LawRow
from tests.oracles.ball_laws import ball_jet

__all__ = ["BallTable", "ball", "certainly_above", "exactly", "newton"]

BITS = 200
Array = npt.NDArray[np.float64]
Balls = list[arb]


def exactly(numbers: Sequence[float] | Array) -> Balls:
    """Floats as balls without a radius."""
    ctx.prec = BITS
    return [arb(float(x)) for x in numbers]


def ball(middle: float, radius: float) -> arb:
    """An interval."""
    ctx.prec = BITS
    return arb(float(middle), float(radius))


def certainly_above(exact: arb, claimed: float) -> bool:
    """Whether the true value is proved to be larger than a bound that claims to hold."""
    return bool(exact > arb(float(claimed)))


class BallTable:
    """A loop table; of function rows only laws, and those not in ``bend`` and ``defect``."""

    def __init__(self, table: LoopTable) -> None:
        ctx.prec = BITS
        self.laws = [row for row in table.functions if isinstance(row, LawRow)]
        assert len(self.laws) == len(table.functions)
        self.loops, self.unknowns = table.loops.rows, table.unknowns
        self.variables, self.equations = table.variables, table.equations
        rows = table.loops
        weights: list[dict[int, Fraction]] = [{} for _ in rows.row]
        for t, k, w in zip(rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True):
            weights[t][int(k)] = weights[t].get(int(k), Fraction(0)) + Fraction(float(w))
        self.terms = [
            (int(row), acb(complex(c)), int(length), self._phase(weights[t]))
            for t, (row, c, length) in enumerate(
                zip(rows.row, rows.coefficient, rows.length, strict=True)
            )
        ]
        self.constants = exactly(table.linear.constant)
        self.lines = [
            (int(r), int(k), arb(float(w)))
            for r, k, w in zip(
                table.linear.row, table.linear.variable, table.linear.weight, strict=True
            )
        ]
        self.weights = exactly(table.variable_scale)

    @staticmethod
    def _phase(weights: dict[int, Fraction]) -> tuple[tuple[int, fmpq], ...]:
        return tuple((k, fmpq(w.numerator, w.denominator)) for k, w in sorted(weights.items()) if w)

    def _phasor(self, c: acb, phase: tuple[tuple[int, fmpq], ...], v: Balls) -> acb:
        angle = arb(0)
        for k, w in phase:
            angle += v[k] * arb(w)
        return c * acb(angle.cos(), angle.sin())

    def residual(self, v: Balls) -> Balls:
        """F: real parts, imaginary parts, linear rows, laws."""
        total = [acb(0)] * self.loops
        for row, c, length, phase in self.terms:
            z = self._phasor(c, phase, v)
            total[row] += z * v[length] if length >= 0 else z
        lines = list(self.constants)
        for r, k, w in self.lines:
            lines[r] += w * v[k]
        for law in self.laws:
            straight = arb(law.constant) + _sum(law, law.weights, v)
            lines.append(straight - ball_jet(law.law, _argument(law, v))[0])
        return [z.real for z in total] + [z.imag for z in total] + lines

    def jacobian(self, v: Balls) -> arb_mat:
        """dF/dv, (m, N)."""
        slope = [[acb(0)] * self.variables for _ in range(self.loops)]
        for row, c, length, phase in self.terms:
            z = self._phasor(c, phase, v)
            whole = z * v[length] if length >= 0 else z
            for k, w in phase:
                slope[row][k] += acb(0, 1) * whole * arb(w)
            if length >= 0:
                slope[row][length] += z
        lines = [[arb(0)] * self.variables for _ in self.constants]
        for r, k, weight in self.lines:
            lines[r][k] += weight
        for law in self.laws:
            row_of_law = [arb(0)] * self.variables
            steep = ball_jet(law.law, _argument(law, v))[1]
            for k, a, w in zip(law.variables, law.weights, law.inner, strict=True):
                row_of_law[k] += arb(float(a)) - steep * arb(float(w))
            lines.append(row_of_law)
        real = [[z.real for z in row] for row in slope]
        imaginary = [[z.imag for z in row] for row in slope]
        return arb_mat(real + imaginary + lines)

    def bend(self, v: Balls, matrix: Array) -> Balls:
        """Σ_jk |(A ∂²F/∂x_j∂x_k)_i| w_j w_k / w_i over the unknowns, row by row."""
        assert not self.laws
        n = self.unknowns
        second: dict[tuple[int, int, int], acb] = {}

        def add(row: int, j: int, k: int, z: acb) -> None:
            if j < n and k < n:
                second[row, j, k] = second.get((row, j, k), acb(0)) + z

        for row, c, length, phase in self.terms:
            z = self._phasor(c, phase, v)
            whole = z * v[length] if length >= 0 else z
            for j, wj in phase:
                for k, wk in phase:
                    add(row, j, k, -whole * arb(wj * wk))
                if length >= 0:
                    add(row, j, length, acb(0, 1) * z * arb(wj))
                    add(row, length, j, acb(0, 1) * z * arb(wj))
        found = []
        for i in range(n):
            alpha = self._alpha(matrix, i)
            seen: dict[tuple[int, int], arb] = {}
            for (row, j, k), z in second.items():
                seen[j, k] = seen.get((j, k), arb(0)) + (alpha[row] * z).real
            total = arb(0)
            for (j, k), x in seen.items():
                total += abs(x) * self.weights[j] * self.weights[k]
            found.append(total / self.weights[i])
        return found

    def modulus_bound(self, v: Balls, matrix: Array) -> tuple[Balls, Balls]:
        """The closed bound of :meth:`bend` at v and its growth by the radius, row by row.

        Per phase |Σ_l α_il Σ c s| Ω², twice |Σ_l α_il Σ c| w Ω per variable length and phase, and
        |Σ_l α_il Σ c| w Ω² for the growth.
        """
        n = self.unknowns
        still, grown = [], []
        for i in range(n):
            alpha = self._alpha(matrix, i)
            groups: dict[tuple[tuple[int, fmpq], ...], acb] = {}
            pairs: dict[tuple[int, tuple[tuple[int, fmpq], ...]], acb] = {}
            for row, c, length, phase in self.terms:
                z = alpha[row] * c
                if 0 <= length < n:
                    key = (length, phase)
                    pairs[key] = pairs.get(key, acb(0)) + z
                z = z * v[length] if length >= 0 else z
                groups[phase] = groups.get(phase, acb(0)) + z
            total, slope = arb(0), arb(0)
            for phase, z in groups.items():
                total += abs(z) * self._turn(phase) ** 2
            for (length, phase), z in pairs.items():
                omega = self._turn(phase)
                total += 2 * abs(z) * self.weights[length] * omega
                slope += abs(z) * self.weights[length] * omega**2
            still.append(total / self.weights[i])
            grown.append(slope / self.weights[i])
        return still, grown

    def _turn(self, phase: tuple[tuple[int, fmpq], ...]) -> arb:
        total = arb(0)
        for k, w in phase:
            if k < self.unknowns:
                total += self.weights[k] * arb(abs(w))
        return total

    def _alpha(self, matrix: Array, i: int) -> list[acb]:
        count = self.loops
        return [acb(float(matrix[i, r]), -float(matrix[i, count + r])) for r in range(count)]

    def reduced_residual(self, v: Balls, matrix: Array) -> Balls:
        """A F."""
        f = self.residual(v)
        found = []
        for row in matrix:
            total = arb(0)
            for a, x in zip(row, f, strict=True):
                total += arb(float(a)) * x
            found.append(total)
        return found

    def defect(self, v: Balls, matrix: Array) -> Balls:
        """Σ_j |I - A J|_ij w_j / w_i over the unknowns, row by row; an upper end for balls.

        Coefficients, times the middles of variable lengths, are added behind A before a phasor is
        taken, so that boxes stay tight.
        """
        assert not self.laws
        n = self.unknowns
        product = []
        for i in range(n):
            alpha = self._alpha(matrix, i)
            row = [arb(1) if i == j else arb(0) for j in range(n)]
            sums: dict[tuple[int, tuple[tuple[int, fmpq], ...]], acb] = {}
            for r, c, length, phase in self.terms:
                sums[length, phase] = sums.get((length, phase), acb(0)) + alpha[r] * c
            whole: dict[tuple[tuple[int, fmpq], ...], acb] = {}
            for (length, phase), z in sums.items():
                middle = v[length].mid() if length >= 0 else arb(1)
                whole[phase] = whole.get(phase, acb(0)) + z * middle
            parts = [(z, arb(1), -1, phase) for phase, z in whole.items()]
            parts += [
                (z, v[length] - v[length].mid(), length, phase)
                for (length, phase), z in sums.items()
                if length >= 0
            ]
            for z, size, length, phase in parts:
                angle = z.arg() if z != 0 else arb(0)
                for k, w in phase:
                    angle += v[k] * arb(w)
                for k, w in phase:
                    if k < n:
                        row[k] += abs(z) * size * angle.sin() * arb(w)
                if 0 <= length < n:
                    row[length] -= abs(z) * angle.cos()
            for r, k, weight in self.lines:
                if k < n:
                    row[k] -= arb(float(matrix[i, 2 * self.loops + r])) * weight
            product.append(row)
        return [
            sum((abs(x) * w for x, w in zip(row, self.weights, strict=False)), arb(0))
            / self.weights[i]
            for i, row in enumerate(product)
        ]


def _sum(law: LawRow, weights: Array, v: Balls) -> arb:
    total = arb(0)
    for k, w in zip(law.variables, weights, strict=True):
        total += v[k] * arb(float(w))
    return total


def _argument(law: LawRow, v: Balls) -> arb:
    return _sum(law, law.inner, v) + arb(law.offset)


def newton(table: BallTable, v: Balls, steps: int = 60) -> tuple[Balls, bool]:
    """A root near v to 150 bits by Newton-Raphson, proved by one Krawczyk step in balls."""
    ctx.prec = BITS
    n = table.unknowns
    here = [x.mid() for x in v]
    small = arb(2) ** -150
    for _ in range(steps):
        f = arb_mat([[x] for x in table.residual(here)])
        try:
            change = _square(table.jacobian(here), n).mid().solve(f)
        except ZeroDivisionError:
            return here, False
        size = arb(0)
        for k in range(n):
            here[k] = (here[k] - change[k, 0]).mid()
            size = max(size, abs(change[k, 0].mid()) / table.weights[k])
        if size < small:
            return here, _krawczyk(table, here)
    return here, False


def _square(jacobian: arb_mat, n: int) -> arb_mat:
    return arb_mat([[jacobian[i, j] for j in range(n)] for i in range(n)])


def _krawczyk(table: BallTable, v: Balls) -> bool:
    """Whether a box of 2^-110 around v is mapped into its inside: one root in there."""
    n = table.unknowns
    radius = arb(2) ** -110
    try:
        inverse = _square(table.jacobian(v), n).inv().mid()
    except ZeroDivisionError:
        return False
    box = [arb(x, radius * w) for x, w in zip(v[:n], table.weights, strict=False)] + v[n:]
    change = inverse * arb_mat([[x] for x in table.residual(v)])
    defect = inverse * _square(table.jacobian(box), n)
    for i in range(n):
        reach = abs(change[i, 0])
        for j in range(n):
            z = (arb(1) if i == j else arb(0)) - defect[i, j]
            reach += abs(z) * radius * table.weights[j]
        if not reach < radius * table.weights[i]:
            return False
    return True
