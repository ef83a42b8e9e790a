"""The proof of a position and of the step to it as recorded arithmetic, block by block.

The constants are those of :mod:`linkwork.core.table.loop_table` and of the Newton-Kantorovich
theorem as in ``numerics.proof.kantorovich``, in the usual weights: Y, Z, ω and r± row by row for
every value that the known variables may have. Bounds of rounding are coarser where that costs
nothing that matters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass

from linkwork.core.foundation.arrays import PRINTED_ANGLE, PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.core.record.closure import Closure, Phase, solve_linear
from linkwork.core.record.recorder import Recorder, Value

_PHASOR = 14.0  # roundings in one term: sine and cosine (2.5 each), products
_ROOM = 1e-9  # 1 - Z below which nothing is proved
_TINY = 1e-300

Number = Value | float


@dataclass(frozen=True, eq=False)
class BlockRadii:
    """``holds`` as a mask; a solution within ``error_bound``, no other within ``isolation_radius``
    (own units); the same as ``radius`` and ``uniqueness_radius``, weighted.
    """

    holds: Value
    radius: Value
    uniqueness_radius: Value
    error_bound: list[Value]
    isolation_radius: list[Value]


@dataclass(frozen=True, eq=False)
class Constants:
    """One row of the proof in units of its weight; the Lipschitz constant is ω + ρ ``bent``."""

    y: Value
    z: Value
    omega: Value
    bent: Value


class BlockProof:
    """The constants of a block's proof at one position.

    Parameters
    ----------
    closure : Closure
        At the position, by the variables of its recorder.
    """

    def __init__(self, closure: Closure) -> None:
        self.closure, self.rec = closure, closure.rec
        self.unknowns, self.known = closure.part.unknowns, closure.known()
        #: Weights of the block's unknowns and of its known variables.
        self.scale = {k: closure.scale(k) for k in (*self.unknowns, *self.known)}
        self.count = n = len(self.unknowns)
        jacobian = closure.jacobian(self.unknowns)
        unit = [[1.0 if i == k else 0.0 for i in range(n)] for k in range(n)]
        columns = solve_linear(self.rec, jacobian, unit).columns
        self.inverse = [[columns[k][i] for k in range(n)] for i in range(n)]
        self.size = [[self.rec.absolute(a) for a in row] for row in self.inverse]
        row_error, slope_error = _Rounding(closure, self.scale).bounds()
        self.loss = [self.product(row, slope_error) for row in self.size]
        self.residual = self._bound_residual(row_error)
        self.defect = [self._bound_defect(i, jacobian) for i in range(n)]
        self._bound_slopes()
        self._group_terms()

    def moved_to(self, closure: Closure, moved: Callable[[Number], Value]) -> BlockProof:
        """The proof as numbers of another recorder; ``moved``: a number of this one there."""
        other = copy(self)
        other.closure, other.rec = closure, closure.rec
        other.scale = {k: closure.scale(k) for k in self.scale}

        def rows(matrix: Sequence[Sequence[Number]]) -> list[list[Value]]:
            return [[moved(x) for x in row] for row in matrix]

        (other.residual,), (other.loss,) = rows([self.residual]), rows([self.loss])
        other.defect, other.slope, other.lines = map(rows, (self.defect, self.slope, self.lines))
        other.phase, other.slide = rows(self.phase), rows(self.slide)
        return other

    def product(self, row: Sequence[Number], column: Sequence[Number]) -> Value:
        """Σ a b."""
        rec = self.rec
        return rec.total([rec.multiply(a, b) for a, b in zip(row, column, strict=True)])

    def _bound_residual(self, error: Sequence[Number]) -> list[Value]:
        """|A F| with its rounding, and that of printing the unknowns."""
        rec, f = self.rec, self.closure.residual()
        own = (self.count + 2.0) * UNIT_ROUNDOFF
        noise = [rec.add(e, own * rec.absolute(x)) for e, x in zip(error, f, strict=True)]
        found = [
            rec.add(rec.absolute(self.product(row, f)), self.product(size, noise))  # eq. (25): Y
            for row, size in zip(self.inverse, self.size, strict=True)
        ]
        for i, k in enumerate(self.unknowns):
            constant = self.closure.printed_constant(k)
            if constant is not None:
                printed = rec.add(rec.absolute(self.closure.v[k]), constant)
                found[i] = rec.add(found[i], rec.multiply(PRINTED_ANGLE, printed))
        return found

    def _bound_defect(self, i: int, jacobian: Sequence[Sequence[Number]]) -> list[Value]:
        """Row i of |I - A J|."""
        found = []
        for k in range(self.count):
            entry = self.product(self.inverse[i], [row[k] for row in jacobian])
            # eq. (25): Z0
            found.append(self.rec.absolute(self.rec.subtract(entry, 1.0 if i == k else 0.0)))
        return found

    def _bound_slopes(self) -> None:
        """A F_k by the known variables; of linear rows alone."""
        rec, slopes = self.rec, self.closure.jacobian(self.known)
        lines = range(2 * len(self.closure.loops), self.count)
        columns = range(len(self.known))
        self.signed = [
            [self.product(row, [slope[m] for slope in slopes]) for m in columns]
            for row in self.inverse
        ]
        self.slope = [[rec.absolute(x) for x in row] for row in self.signed]
        self.lines = [
            [
                rec.absolute(rec.total([rec.multiply(row[r], slopes[r][m]) for r in lines]))
                for m in columns
            ]
            for row in self.inverse
        ]

    def _group_terms(self) -> None:
        """Sort terms by phase; second derivatives along each phase, multiplied by the inverse."""
        closure = self.closure
        groups: dict[Phase, list[tuple[int, int]]] = {}
        pairs: dict[tuple[int, Phase], list[tuple[int, int]]] = {}
        for row, loop in enumerate(closure.loops):
            for term in closure.terms[loop]:
                phase = closure.phases.get(term, ())
                length = int(closure.table.loops.length[term])
                if phase:  # a term that does not turn is linear
                    groups.setdefault(phase, []).append((row, term))
                if length >= 0:
                    pairs.setdefault((length, phase), []).append((row, term))
        self.phases, self.pairs = list(groups), list(pairs)
        self.loop_phases = len(groups)
        rows = range(self.count)
        self.phase = [
            [self._modulus(i, groups[g], sliding=True) for g in self.phases] for i in rows
        ]
        self._add_laws()
        self.slide = [[self._modulus(i, pairs[p], sliding=False) for p in self.pairs] for i in rows]

    def _add_laws(self) -> None:
        """Every law bends along one sum of variables, as a phase does."""
        closure = self.closure
        first = self.count - len(closure.laws)
        for i, law in enumerate(closure.law_rows):
            self.phases.append(tuple((k, w) for k, _, w in law.terms if w))
            bend = closure.number(f"f{closure.laws[i]}.bend")
            for row, size in zip(self.phase, self.size, strict=True):
                row.append(self.rec.multiply(size[first + i], bend))

    def _modulus(self, i: int, members: Sequence[tuple[int, int]], sliding: bool) -> Value:
        """|Σ (A_re - i A_im) c (s)| over the members of a phase, with the rounding of the sum."""
        rec, closure = self.rec, self.closure
        real: Number = 0.0
        imag: Number = 0.0
        extent: Number = 0.0
        for row, term in members:
            a, b = self.inverse[i][row], self.inverse[i][len(closure.loops) + row]
            length = int(closure.table.loops.length[term])
            s: Number = closure.v[length] if sliding and length >= 0 else 1.0
            cr, ci = (rec.multiply(c, s) for c in closure.coefficient(term))
            real = rec.add(real, rec.add(rec.multiply(a, cr), rec.multiply(b, ci)))
            imag = rec.add(imag, rec.subtract(rec.multiply(a, ci), rec.multiply(b, cr)))
            size = rec.add(rec.absolute(cr), rec.absolute(ci))
            seen = rec.add(rec.absolute(a), rec.absolute(b))
            extent = rec.add(extent, rec.multiply(seen, size))
        square = rec.add(rec.multiply(real, real), rec.multiply(imag, imag))
        noise = rec.multiply(UNIT_ROUNDOFF * (4.0 * len(members) + 12.0), extent)
        return rec.add(rec.sqrt(square), noise)  # eq. (30): |α C| or |α D|

    def rates(self, rate: Callable[[Recorder, int], Value]) -> list[Value]:
        """Derivatives of the unknowns by t, given those of the known variables."""
        moved = [rate(self.rec, k) for k in self.known]
        return [-self.product(row, moved) for row in self.signed]  # eq. (11)

    def within(self, known: Mapping[int, Value]) -> BlockRadii:
        """The proof for every value of the known variables so far from theirs."""
        return self._radii(self.constants(known))

    def constants(self, known: Mapping[int, Value]) -> list[Constants]:
        """Y, Z and ω row by row for known variables within some distance (own units)."""
        spread = _Spread(self, known)
        return [spread.constants(i) for i in range(self.count)]

    def _radii(self, rows: Sequence[Constants]) -> BlockRadii:
        """Existence and uniqueness from the constants, as ``numerics.proof.kantorovich.radii``."""
        rec = self.rec
        y, z = rec.largest(row.y for row in rows), rec.largest(row.z for row in rows)
        omega = rec.largest(row.omega for row in rows)
        bent = rec.largest(row.bent for row in rows)
        room = 1.0 - z
        reach: Value | None = None
        whole = omega
        if not rec.is_zero(bent):
            root = rec.sqrt(omega * omega + 8.0 * bent * rec.largest([room, 0.0]))
            reach = 4.0 * room / (omega + root)  # eq. (28)
            whole = omega + reach * bent
        square = room * room - 2.0 * PROOF_SLACK * whole * y  # eq. (26)
        holds = rec.all_of([rec.at_most(_ROOM, room), rec.at_most(_TINY, square)])
        total = room + rec.sqrt(rec.largest([square, 0.0]))
        existence_radius = 2.0 * PROOF_SLACK * y / total  # eq. (27) without cancellation
        uniqueness_radius = total / (whole * PROOF_SLACK)  # eq. (27)
        if reach is not None:
            uniqueness_radius = rec.smallest([uniqueness_radius, reach / PROOF_SLACK])
        error_bound, isolation_radius = [], []
        for row, k in zip(rows, self.unknowns, strict=True):
            curve = row.omega if reach is None else row.omega + reach * row.bent
            own = row.y + existence_radius * (row.z + 0.5 * curve * existence_radius)  # eq. (29)
            error_bound.append(rec.smallest([own * PROOF_SLACK, existence_radius]) * self.scale[k])
            isolation_radius.append(uniqueness_radius * self.scale[k])
        return BlockRadii(holds, existence_radius, uniqueness_radius, error_bound, isolation_radius)


class _Spread:
    """The constants of a block's proof for known variables within some distance."""

    def __init__(self, proof: BlockProof, known: Mapping[int, Value]) -> None:
        self.proof, self.rec, self.known = proof, proof.rec, known
        mine, given = set(proof.unknowns), set(proof.known)
        phases: list[Phase] = [*proof.phases, ()]  # a fixed direction does not turn
        self.own = [self._turn(phase, proof.scale, mine) for phase in phases]
        self.turned = [self._turn(phase, known, given) for phase in phases]
        number = {phase: g for g, phase in enumerate(phases[: proof.loop_phases])} | {
            (): len(proof.phases)
        }
        pairs = [(p, j, number[phase]) for p, (j, phase) in enumerate(proof.pairs)]
        self.free = [pair for pair in pairs if pair[1] in mine]
        self.held = [pair for pair in pairs if pair[1] in given]
        shares = [self.rec.divide(known[m], proof.scale[m]) for m in proof.known]
        self.share = self.rec.largest([0.0, *shares])

    def _turn(self, phase: Phase, moves: Mapping[int, Value], among: set[int]) -> Value:
        """How far a phase turns when some variables move."""
        return self.rec.total([moves[k] * abs(w) for k, w in phase if k in among])

    def constants(self, i: int) -> Constants:
        """Row i."""
        proof, rec = self.proof, self.rec
        z, omega, bent = self._bending(i)
        y = rec.add(proof.residual[i], self._shift(i))
        weight = proof.scale[proof.unknowns[i]]
        per = rec.divide(PROOF_SLACK, weight)
        return Constants(*(rec.multiply(x, per) for x in (y, z, omega, bent)))

    def _shift(self, i: int) -> Value:
        """By how much the known variables may move the solution: along slopes, or as a whole."""
        proof, rec = self.proof, self.rec
        phase, slide = proof.phase[i], proof.slide[i]
        spreads = [self.known[m] for m in proof.known]
        by_slope, whole = (proof.product(row[i], spreads) for row in (proof.slope, proof.lines))
        for g, turn in enumerate(self.turned[:-1]):
            by_slope = rec.add(by_slope, 0.5 * rec.multiply(phase[g], rec.multiply(turn, turn)))
            # a law's phase is a second derivative, no bound of the change itself
            change = turn if g < proof.loop_phases else 0.5 * rec.multiply(turn, turn)
            whole = rec.add(whole, rec.multiply(phase[g], change))
        for p, j, g in self.held:
            moved = rec.multiply(slide[p], self.known[j])
            by_slope = rec.add(by_slope, rec.multiply(moved, self.turned[g]))
            whole = rec.add(whole, moved)
        # the slopes by known variables are rounded less than the whole Jacobian
        # eq. (31)
        return rec.add(rec.smallest([by_slope, whole]), rec.multiply(proof.loss[i], self.share))

    def _bending(self, i: int) -> tuple[Value, Value, Value]:
        """Z, ω and the growth of ω in row i, times its weight."""
        proof, rec = self.proof, self.rec
        phase, slide = proof.phase[i], proof.slide[i]
        weights = [proof.scale[k] for k in proof.unknowns]
        z: Value = rec.total(
            [
                proof.loss[i],
                *[rec.multiply(d, w) for d, w in zip(proof.defect[i], weights, strict=True)],
            ]
        )
        omega: Value = rec.constant(0.0)
        bent: Value = rec.constant(0.0)
        for g in range(len(proof.phases)):
            z = rec.add(z, rec.multiply(phase[g], rec.multiply(self.own[g], self.turned[g])))
            # eq. (30)
            omega = rec.add(omega, rec.multiply(phase[g], rec.multiply(self.own[g], self.own[g])))
        for p, j, g in self.free:
            along = rec.multiply(slide[p], proof.scale[j])
            z = rec.add(z, rec.multiply(along, self.turned[g]))
            turning = rec.multiply(along, self.own[g])
            omega = rec.add(omega, 2.0 * turning)  # eq. (30)
            # eq. (30): the part that grows with ρ
            bent = rec.add(bent, rec.multiply(turning, self.own[g]))
        for p, j, g in self.held:
            turning = rec.multiply(rec.multiply(slide[p], self.known[j]), self.own[g])
            z = rec.add(z, turning)
            omega = rec.add(omega, rec.multiply(turning, self.own[g]))
        return z, omega, bent


class _Rounding:
    """Bounds of the errors of F, and of dF/dv times the weights, loop by loop."""

    def __init__(self, closure: Closure, scale: Mapping[int, Value]) -> None:
        self.closure, self.rec, self.scale = closure, closure.rec, scale
        self.products = len(closure.part.unknowns) + 2.0

    def bounds(self) -> tuple[list[Number], list[Number]]:
        """For real parts, imaginary parts, linear rows."""
        loops = [self._loop(loop) for loop in self.closure.loops]
        lines = [self._line(row) for row in self.closure.lines]
        laws = [self._law(i) for i in range(len(self.closure.laws))]
        found = [*loops, *loops, *lines, *laws]
        return [error for error, _ in found], [slope for _, slope in found]

    def _loop(self, loop: int) -> tuple[Number, Number]:
        rec, closure = self.rec, self.closure
        terms = closure.terms[loop]
        error: Number = 0.0
        slope: Number = 0.0
        for term in terms:
            bare = rec.total([rec.absolute(c) for c in closure.coefficient(term)])
            length = int(closure.table.loops.length[term])
            whole = bare if length < 0 else rec.multiply(bare, rec.absolute(closure.v[length]))
            phase = closure.phases.get(term, ())
            factor = self._roundings(phase, len(terms) + _PHASOR)
            error = rec.add(error, rec.multiply(factor, whole))  # eq. (34)
            turning = rec.total([self.scale[k] * abs(w) for k, w in phase if k in self.scale])
            along = rec.multiply(whole, turning)
            if length >= 0:
                along = rec.add(along, rec.multiply(bare, self.scale[length]))
            slope = rec.add(slope, rec.multiply(rec.add(factor, self.products), along))
        return rec.multiply(UNIT_ROUNDOFF, error), rec.multiply(UNIT_ROUNDOFF, slope)

    def _roundings(self, phase: Phase, usual: float) -> Number:
        """A phase that has to be computed is itself rounded, in proportion to its parts."""
        if len(phase) < 2 and all(abs(w) == 1.0 for _, w in phase):
            return usual
        parts = self.rec.total([abs(self.closure.v[k]) * abs(w) for k, w in phase])
        return self.rec.add(usual, parts * float(len(phase) + 1))

    def _line(self, row: int) -> tuple[Number, Number]:
        rec, closure = self.rec, self.closure
        entries = closure.entries(row)
        constant = rec.absolute(closure.number(f"k{row}"))
        size = rec.total([constant, *[abs(closure.v[k]) * abs(w) for k, w in entries]])
        spread = rec.total([self.scale[k] * abs(w) for k, w in entries])
        error = rec.multiply(UNIT_ROUNDOFF * (len(entries) + 5.0), size)
        return error, rec.multiply(UNIT_ROUNDOFF * (self.products + len(entries)), spread)

    def _law(self, i: int) -> tuple[Number, Number]:
        """As :meth:`LawRow.rounding`, and of products with the derivatives."""
        rec, closure, terms = self.rec, self.closure, self.closure.law_rows[i].terms
        name, count = f"f{closure.laws[i]}", len(terms) + 3.0

        def size(weights: list[tuple[int, float]], constant: str) -> Value:
            parts = [rec.multiply(abs(closure.v[k]), abs(w)) for k, w in weights]
            return rec.total([*parts, rec.absolute(closure.number(f"{name}.{constant}"))])

        moved = (count * UNIT_ROUNDOFF) * size([(k, w) for k, _, w in terms], "offset")
        straight = size([(k, a) for k, a, _ in terms], "constant")
        rounding, argument = f"{name}.rounding", closure.argument(i)
        turned = rec.multiply(closure.number(f"{name}.bend"), moved)
        steepest = rec.add(rec.absolute(closure.law(i, 1)), turned)
        error = rec.total(
            [
                rec.call(rounding, argument, 0), closure.number(f"{name}.error"),
                rec.multiply(steepest, moved), (UNIT_ROUNDOFF * count) * straight,
                (2.0 * UNIT_ROUNDOFF) * rec.absolute(closure.law(i, 0)),
            ]
        )  # fmt: skip
        steeper = rec.total(
            [
                rec.call(rounding, argument, 1), closure.number(f"{name}.steeper"), turned,
                (2.0 * UNIT_ROUNDOFF) * steepest,
            ]
        )  # fmt: skip
        products = UNIT_ROUNDOFF * (self.products + 2.0)
        slopes = []
        for k, a, w in terms:
            own = rec.add(rec.multiply(steeper, abs(w)), 2.0 * UNIT_ROUNDOFF * abs(a))
            gradient = rec.absolute(closure.law_slope(i, k))
            slopes.append(
                rec.multiply(self.scale[k], rec.add(own, rec.multiply(products, gradient)))
            )
        return error, rec.total(slopes)
