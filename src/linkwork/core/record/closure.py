"""The loop-closure equations of one block as recorded arithmetic: F, J, Newton's step, rates.

Registers are named: ``v3`` is the fourth variable, ``c5.re`` a coefficient,
``k0`` the constant of a linear row, ``r3`` a variable's derivative by the path, ``f0`` the first
law, ``f0.constant`` and ``f0.offset`` the constants of its row.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.record.recorder import Recorder, Value
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LawRow

Pair = tuple[Value | float, Value | float]
Moves = Mapping[int, Value | float]
#: Variables with their weights, one twice only where adding these would round; empty for a fixed
#: direction.
Phase = tuple[tuple[int, float], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockPart:
    """A block of a loop table: its equations (numbered as in ``table.pattern``) and its unknowns.

    ``equations``: numbers of loops and linear rows; ``unknowns``: variables of the whole table.
    """

    equations: tuple[int, ...]
    unknowns: tuple[int, ...]


class Closure:
    """The equations of one block over registers.

    Parameters
    ----------
    table : LoopTable
        Its function rows have to be laws.
    part : BlockPart
    recorder : Recorder
    variables : sequence of Value
        All N variables of the table.
    zeros : set of str
        Coefficients that are zero in every design: nothing is computed with them.
    shared : bool
        Whether phasors of phases that only inputs turn have registers of their own.
    """

    def __init__(
        self,
        table: LoopTable,
        part: BlockPart,
        recorder: Recorder,
        variables: Sequence[Value],
        zeros: Set[str] = frozenset(),
        *,
        shared: bool = False,
    ) -> None:
        self.table, self.part, self.rec, self.v = table, part, recorder, variables
        self.zeros, self.shared = zeros, shared
        loops, lines = table.loops, table.loops.rows + len(table.linear.constant)
        self.loops = [k for k in part.equations if k < loops.rows]
        self.lines = [k - loops.rows for k in part.equations if loops.rows <= k < lines]
        self.laws = [k - lines for k in part.equations if k >= lines]
        rows = [table.functions[k] for k in self.laws]
        self.law_rows = [row for row in rows if isinstance(row, LawRow)]
        self.terms = {k: np.flatnonzero(loops.row == k).tolist() for k in self.loops}
        self.phases = _phases(loops.phase_term, loops.phase_variable, loops.phase_weight)
        self._phasors: dict[Phase, Pair] = {}

    def phasor(self, term: int) -> Pair:
        """Cosine and sine of a term's phase."""
        phase = self.phases.get(term, ())
        if phase not in self._phasors:
            self._phasors[phase] = self._turned(phase)
        return self._phasors[phase]

    def _turned(self, phase: Phase) -> Pair:
        if not phase:
            return 1.0, 0.0
        if self.shared and self.given(phase):
            names = (phasor_name(part, phase) for part in ("cos", "sin"))
            cosine, sine = (self.rec.input(name) for name in names)
            return cosine, sine
        return cosine_and_sine(self.rec, self.v, phase)

    def given(self, phase: Phase) -> bool:
        """Whether only inputs turn a phase: its phasor is the same in all blocks."""
        return bool(phase) and all(k >= self.table.unknowns for k, _ in phase)

    def coefficient(self, term: int) -> Pair:
        """A term's complex coefficient; parts that are zero in every design are left out."""
        return self.number(f"c{term}.re"), self.number(f"c{term}.im")

    def bare(self, term: int) -> tuple[Value, Value]:
        """c e^{iψ}, without a variable length."""
        (cr, ci), (x, y) = self.coefficient(term), self.phasor(term)
        rec = self.rec
        real = rec.subtract(rec.multiply(cr, x), rec.multiply(ci, y))
        imag = rec.add(rec.multiply(cr, y), rec.multiply(ci, x))
        return real, imag

    def whole(self, term: int) -> tuple[Value, Value]:
        """c s e^{iψ}."""
        real, imag = self.bare(term)
        length = int(self.table.loops.length[term])
        # eq. (1)
        return (real, imag) if length < 0 else (real * self.v[length], imag * self.v[length])

    def residual(self) -> list[Value]:
        """F, real parts of the block's loops, imaginary parts, linear rows."""
        rec = self.rec
        sums = {k: [self.whole(t) for t in self.terms[k]] for k in self.loops}
        real = [rec.total([x for x, _ in sums[k]]) for k in self.loops]
        imag = [rec.total([y for _, y in sums[k]]) for k in self.loops]
        laws = [self._law(i) for i in range(len(self.laws))]
        return [*real, *imag, *[self._line(row) for row in self.lines], *laws]

    def number(self, name: str) -> Value | float:
        """A number of the block; 0 where it is zero in every design."""
        return 0.0 if name in self.zeros else self.rec.input(name)

    def argument(self, i: int) -> Value:
        """The argument Σ w v + offset of a law."""
        parts = [self.rec.multiply(self.v[k], w) for k, _, w in self.law_rows[i].terms]
        return self.rec.total([*parts, self.number(f"f{self.laws[i]}.offset")])

    def law(self, i: int, part: int) -> Value:
        """The value of a law, its first or its second derivative."""
        return self.rec.call(f"f{self.laws[i]}", self.argument(i), part)

    def _law(self, i: int) -> Value:
        # eq. (4)
        parts = [self.rec.multiply(self.v[k], a) for k, a, _ in self.law_rows[i].terms]
        straight = self.rec.total([*parts, self.number(f"f{self.laws[i]}.constant")])
        return self.rec.subtract(straight, self.law(i, 0))

    def law_slope(self, i: int, variable: int) -> Value | float:
        """The derivative of a law's row by a variable."""
        rec = self.rec
        found: Value | float = 0.0
        for k, a, w in self.law_rows[i].terms:
            if k == variable:  # which a row may name twice
                own = rec.subtract(a, rec.multiply(self.law(i, 1), w)) if w else a
                found = rec.add(found, own)
        return found

    def entries(self, row: int) -> list[tuple[int, float]]:
        """Variables and weights of a linear row."""
        linear = self.table.linear
        mine = np.flatnonzero(linear.row == row)
        return [(int(linear.variable[k]), float(linear.weight[k])) for k in mine]

    def scale(self, variable: int) -> Value:
        """The weight of a variable."""
        return weight_of(self.rec, self.table, variable)

    def printed_constant(self, variable: int) -> Value | float | None:
        """The largest constant that an angle is printed with; ``None`` for a length."""
        constant = self.table.printed_constant[variable]
        return constant if constant == constant else None

    def _line(self, row: int) -> Value:
        # eq. (4) with f = 0
        parts: list[Value | float] = [self.v[k] * weight for k, weight in self.entries(row)]
        return self.rec.total([*parts, self.number(f"k{row}")])

    def jacobian(self, variables: Sequence[int]) -> list[list[Value | float]]:
        """dF/dv by some variables."""
        columns = [self._column(k) for k in variables]
        if not columns:
            return [[] for _ in self.residual()]
        return [list(row) for row in zip(*columns, strict=True)]

    def _column(self, variable: int) -> list[Value | float]:
        rec, real, imag = self.rec, [], []
        for k in self.loops:
            x: Value | float = 0.0
            y: Value | float = 0.0
            for term in self.terms[k]:
                weight = sum(w for k, w in self.phases.get(term, ()) if k == variable)
                if weight:
                    a, b = self.whole(term)
                    # eq. (2): turning, i (a + ib) = -b + ia
                    x, y = rec.subtract(x, weight * b), rec.add(y, weight * a)
                if int(self.table.loops.length[term]) == variable:
                    a, b = self.bare(term)
                    x, y = rec.add(x, a), rec.add(y, b)  # eq. (2): sliding
            real.append(x)
            imag.append(y)
        linear = self.table.linear
        lines = [
            float(linear.weight[(linear.row == row) & (linear.variable == variable)].sum())
            for row in self.lines
        ]
        return [*real, *imag, *lines, *(self.law_slope(i, variable) for i in range(len(self.laws)))]

    def bending(self, first: Moves, second: Moves) -> list[Value | float]:
        """D²F[a, b] for two directions a and b.

        Parameters
        ----------
        first, second : Mapping[int, Value]
            By variable; variables that are missing do not move.
        """
        rec, real, imag = self.rec, [], []
        for k in self.loops:
            parts = [self._bent(term, first, second) for term in self.terms[k]]
            real.append(rec.total([x for x, _ in parts]))
            imag.append(rec.total([y for _, y in parts]))
        laws = [self._law_bent(i, first, second) for i in range(len(self.laws))]
        return [*real, *imag, *[0.0] * len(self.lines), *laws]

    def _law_bent(self, i: int, first: Moves, second: Moves) -> Value:
        """Second derivative of a law's row along two directions."""
        rec, terms = self.rec, self.law_rows[i].terms
        turn, other = (
            rec.total([rec.multiply(moves[k], w) for k, _, w in terms if k in moves])
            for moves in (first, second)
        )
        return -rec.multiply(self.law(i, 2), rec.multiply(turn, other))

    def _bent(self, term: int, first: Moves, second: Moves) -> Pair:
        """d² of c s e^{iψ}: c e^{iψ} (i (δs ψ̇ + ṡ δψ) - s δψ ψ̇)."""
        rec, phase, length = self.rec, self.phases.get(term, ()), int(self.table.loops.length[term])
        turn, other = (
            rec.total([rec.multiply(moves[k], w) for k, w in phase if k in moves])
            for moves in (first, second)
        )
        a, b = self.whole(term)
        product = rec.multiply(turn, other)
        x, y = -rec.multiply(product, a), -rec.multiply(product, b)  # eq. (3): -s α β
        if length >= 0:
            a, b = self.bare(term)
            mixed = rec.add(
                rec.multiply(first.get(length, 0.0), other),
                rec.multiply(second.get(length, 0.0), turn),
            )
            # eq. (3): i (a_s β + b_s α)
            x, y = rec.subtract(x, rec.multiply(mixed, b)), rec.add(y, rec.multiply(mixed, a))
        return x, y

    def known(self) -> list[int]:
        """The known variables that the block's equations contain."""
        found: set[int] = set()
        for k in self.loops:
            for term in self.terms[k]:
                found.update(variable for variable, _ in self.phases.get(term, ()))
                if self.table.loops.length[term] >= 0:
                    found.add(int(self.table.loops.length[term]))
        for row in self.lines:
            found.update(self.table.linear.variable[self.table.linear.row == row].tolist())
        for law in self.law_rows:
            found.update(law.variables)
        return sorted(found - set(self.part.unknowns))


def weight_of(rec: Recorder, table: LoopTable, variable: int) -> Value:
    """The weight of a variable in a register; 1 for angles."""
    return rec.constant(1.0) if table.is_angle[variable] else rec.input(f"scale{variable}")


def _phases(terms: IndexArray, variables: IndexArray, weights: Array) -> dict[int, Phase]:
    """The phase of each term; weights of one variable are added where that rounds nothing."""
    found: dict[int, list[tuple[int, float]]] = {}
    for t, k, w in zip(terms.tolist(), variables.tolist(), weights.tolist(), strict=True):
        found.setdefault(t, []).append((k, w))
    return {t: _merge_phases(phase) for t, phase in found.items()}


def _merge_phases(phase: Sequence[tuple[int, float]]) -> Phase:
    merged: list[tuple[int, float]] = []
    for variable in sorted({k for k, _ in phase}):
        mine = [w for k, w in phase if k == variable]
        total = sum(mine)
        # a rounded sum of weights would turn the phase differently from NumPy's
        exact = Fraction(total) == sum(map(Fraction, mine))
        merged += [(variable, total)] if exact else [(variable, w) for w in sorted(mine)]
    return tuple((k, w) for k, w in merged if w)


def phasor_name(part: str, phase: Phase) -> str:
    """The register of the cosine or sine of a phase that only inputs turn, at the trial."""
    return part + "".join(f" {weight:g}*{k}" for k, weight in phase) + ".0"


def cosine_and_sine(rec: Recorder, variables: Sequence[Value], phase: Phase) -> tuple[Value, Value]:
    """Cosine and sine of a phase."""
    if len(phase) == 1 and phase[0][1] in (1.0, -1.0):
        ((variable, weight),) = phase
        sine, cosine = rec.sin_cos(variables[variable])
        return cosine, sine if weight > 0 else -sine
    sine, cosine = rec.sin_cos(rec.total([variables[k] * weight for k, weight in phase]))
    return cosine, sine


@dataclass(frozen=True, eq=False)
class Linear:
    """The solution of J X = R for several right-hand sides, and the sign of det J."""

    columns: list[list[Value]]
    determinant: Value


#: Entries of a matrix by rows.
Row = Sequence[Value | float]


def solve_linear(rec: Recorder, matrix: Sequence[Row], sides: Sequence[Row]) -> Linear:
    """Solve small linear systems lane by lane.

    One and two unknowns in closed form. Of more, those with the fewest entries are eliminated first
    until two are left; the largest pivot of a column is chosen by swapping rows under masks, so
    that all lanes do the same.

    Parameters
    ----------
    matrix : n rows of n
    sides : right-hand sides of n numbers each
    """
    n = len(matrix)
    if n == 1:
        pivot = rec.add(matrix[0][0], 0.0)
        return Linear([[rec.divide(side[0], pivot)] for side in sides], pivot)
    if n == 2:
        return _by_cramer(rec, matrix, sides)
    return _by_elimination(rec, matrix, sides)


def inverse_of(rec: Recorder, matrix: Sequence[Row]) -> tuple[list[list[Value]], Value]:
    """The inverse of a matrix and its determinant."""
    n = len(matrix)
    units = [[float(i == j) for i in range(n)] for j in range(n)]
    solution = solve_linear(rec, matrix, units)
    return [list(row) for row in zip(*solution.columns, strict=True)], solution.determinant


def weighted_norm(rec: Recorder, matrix: Sequence[Row], columns: Row, rows: Row) -> Value:
    """The largest sum of moduli of a row, columns multiplied and rows divided by weights."""
    return rec.largest(
        rec.divide(
            rec.total(
                [rec.multiply(rec.absolute(x), w) for x, w in zip(row, columns, strict=True)]
            ),
            scale,
        )
        for row, scale in zip(matrix, rows, strict=True)
    )


def driven(closure: Closure, rates: Moves) -> list[Value]:
    """Σ dF/dv times the rates of the known variables."""
    rec, known = closure.rec, closure.known()
    return [
        rec.total([rec.multiply(x, rates[k]) for x, k in zip(row, known, strict=True)])
        for row in closure.jacobian(known)
    ]


def add_rates(
    closure: Closure, first: dict[int, Value | float], second: dict[int, Value | float]
) -> None:
    """Add both derivatives of a block's unknowns to those of its known variables."""
    rec, unknowns = closure.rec, closure.part.unknowns
    matrix = closure.jacobian(unknowns)
    # solved, not multiplied by the inverse: a rate that is exactly 0 or 1 comes out so
    (rates,) = solve_linear(rec, matrix, [driven(closure, first)]).columns
    first |= {k: -x for k, x in zip(unknowns, rates, strict=True)}  # eq. (11)
    bends = zip(closure.bending(first, first), driven(closure, second), strict=True)
    (rates,) = solve_linear(rec, matrix, [[rec.add(a, b) for a, b in bends]]).columns
    second |= {k: -x for k, x in zip(unknowns, rates, strict=True)}  # eq. (12)


def condition_of(closure: Closure, scales: Row) -> tuple[Value, Value]:
    """The condition ‖J‖·‖J⁻¹‖ of a block, and det J; ``scales``: of its residuals."""
    rec, unknowns = closure.rec, closure.part.unknowns
    matrix, weights = closure.jacobian(unknowns), [closure.scale(k) for k in unknowns]
    inverse, determinant = inverse_of(rec, matrix)
    norm, of_inverse = (
        weighted_norm(rec, matrix, weights, scales),
        weighted_norm(rec, inverse, scales, weights),
    )
    return rec.multiply(norm, of_inverse), determinant  # eq. (14)


def _by_cramer(rec: Recorder, m: Sequence[Row], sides: Sequence[Row]) -> Linear:
    (a, b), (c, d) = m
    determinant = rec.subtract(rec.multiply(a, d), rec.multiply(b, c))
    inverse = rec.divide(1.0, determinant)
    columns = []
    for p, q in sides:
        x = rec.subtract(rec.multiply(d, p), rec.multiply(b, q))
        y = rec.subtract(rec.multiply(a, q), rec.multiply(c, p))
        columns.append([x * inverse, y * inverse])
    return Linear(columns, determinant)


def _by_elimination(rec: Recorder, matrix: Sequence[Row], sides: Sequence[Row]) -> Linear:
    n = len(matrix)
    rows: list[list[Value | float]] = [
        [*row, *[side[k] for side in sides]] for k, row in enumerate(matrix)
    ]
    determinant: Value = rec.constant(1.0)
    inverses: list[Value] = []
    order: list[int] = []  # of the unknowns, as they are eliminated
    left = list(range(n))
    for k in range(n - 2):
        # few entries first: zeros of the pattern stay zeros, and cost no instruction
        column = min(left, key=lambda c: sum(not rec.is_zero(row[c]) for row in rows[k:]))
        if left.index(column) % 2:
            determinant = -determinant
        left.remove(column)
        order.append(column)
        if _pivot(rec, rows, k, column):
            determinant = -determinant
        for i in range(k + 1, n):
            determinant = _larger_first(rec, rows, k, i, column, determinant)
        determinant = rec.multiply(determinant, rows[k][column])
        inverses.append(rec.divide(1.0, rows[k][column]))
        for i in range(k + 1, n):
            factor = rec.multiply(rows[i][column], inverses[k])
            rows[i] = [
                0.0 if j in order else rec.subtract(x, rec.multiply(factor, rows[k][j]))
                for j, x in enumerate(rows[i])
            ]
    last = _by_cramer(
        rec,
        [[row[c] for c in left] for row in rows[-2:]],
        [[row[n + s] for row in rows[-2:]] for s in range(len(sides))],
    )
    columns = []
    for s, pair in enumerate(last.columns):
        x = dict(zip(left, pair, strict=True))
        for k in reversed(range(n - 2)):
            rest = rows[k][n + s]
            for c, value in x.items():
                rest = rec.subtract(rest, rec.multiply(rows[k][c], value))
            x[order[k]] = rec.multiply(rest, inverses[k])
        columns.append([x[c] for c in range(n)])
    return Linear(columns, rec.multiply(determinant, last.determinant))


def _pivot(rec: Recorder, rows: list[list[Value | float]], k: int, column: int) -> bool:
    """Bring the first row with an entry to place k; whether it stood elsewhere."""
    first = next((i for i in range(k, len(rows)) if not rec.is_zero(rows[i][column])), k)
    rows[k], rows[first] = rows[first], rows[k]
    return first != k


def _larger_first(
    rec: Recorder, rows: list[list[Value | float]], k: int, i: int, column: int, determinant: Value
) -> Value:
    """Swap rows k and i where i has the larger entry; the determinant with its sign then."""
    if rec.is_zero(rows[i][column]):
        return determinant
    larger = rec.at_most(rec.absolute(rows[i][column]), rec.absolute(rows[k][column]))
    above, below = rows[k], rows[i]
    # lanes differ in their pivots, but run the same instructions: rows are swapped under a mask
    rows[k] = [rec.where(larger, x, y) for x, y in zip(above, below, strict=True)]
    rows[i] = [rec.where(larger, y, x) for x, y in zip(above, below, strict=True)]
    return rec.where(larger, determinant, -determinant)
