"""The proof of a position and of the step to it as recorded arithmetic, block by block.

The constants are those of :mod:`linkwork.kernels.curvature` and the Newton-Kantorovich theorem as in
``numerics.certificate``, in the usual weights: Y, Z, ω and r± row by row for every value that the
known variables may have. Bounds of rounding are taken coarser where that costs nothing that matters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.kernels.lanes.closure import Closure, solved
from linkwork.kernels.lanes.program import Recorder, Value

__all__ = ["BlockProof", "Found"]

_UNIT = float(np.finfo(float).eps) / 2.0
_SLACK = 1.0 + 1e-12
_PHASOR = 14.0  # roundings in one term: sine and cosine, products


@dataclass(frozen=True, eq=False)
class Found:
    """``holds`` as a mask; a solution within ``each``, no other within ``alone`` (own units), and
    within ``radius``, weighted.
    """

    holds: Value
    radius: Value
    each: list[Value]
    alone: list[Value]


class BlockProof:
    """What a proof of one block takes from a position.

    Parameters
    ----------
    closure : Closure
        At the position, by the variables of its recorder.
    scale : Mapping[int, Value]
        Weights of the block's unknowns and of what it takes as known.
    """

    def __init__(self, closure: Closure, scale: Mapping[int, Value]) -> None:
        self.closure, self.rec = closure, closure.rec
        rec, part = self.rec, closure.part
        self.unknowns, self.known = part.unknowns, closure.known()
        self.scale = scale
        jacobian = closure.jacobian(self.unknowns)
        f = closure.residual()
        n = len(self.unknowns)
        unit = [[1.0 if i == k else 0.0 for i in range(n)] for k in range(n)]
        columns = solved(rec, jacobian, [[rec.constant(x) for x in side] for side in unit]).columns
        self.inverse = [[columns[k][i] for k in range(n)] for i in range(n)]
        size = [[rec.absolute(a) for a in row] for row in self.inverse]
        self._group()
        row_error, slope_error = self._rounding()
        self.residual = []
        for i in range(n):
            shift = rec.absolute(self._product(self.inverse[i], f))
            noise = [
                rec.multiply(a, rec.add(e, (n + 2.0) * _UNIT * rec.absolute(x)))
                for a, e, x in zip(size[i], row_error, f, strict=True)
            ]
            self.residual.append(rec.add(shift, rec.total(noise)))
        self.loss = [self._product(size[i], slope_error) for i in range(n)]
        self.defect = []
        for i in range(n):
            row: list[Value | float] = []
            for k in range(n):
                entry = self._product(self.inverse[i], [jacobian[r][k] for r in range(n)])
                row.append(rec.absolute(rec.subtract(entry, 1.0 if i == k else 0.0)))
            self.defect.append(row)
        slopes = closure.jacobian(self.known)
        lines = range(2 * len(closure.loops), n)
        self.signed = [
            [
                self._product(self.inverse[i], [row[m] for row in slopes])
                for m in range(len(self.known))
            ]
            for i in range(n)
        ]
        self.slope = [[rec.absolute(x) for x in row] for row in self.signed]
        self.lines = [
            [
                rec.absolute(
                    rec.total([rec.multiply(self.inverse[i][r], slopes[r][m]) for r in lines])
                )
                for m in range(len(self.known))
            ]
            for i in range(n)
        ]

    def rates(self, rate: Callable[[Recorder, int], Value]) -> list[Value]:
        """Derivatives of the unknowns by t, given those of the known variables."""
        moved = [rate(self.rec, k) for k in self.known]
        return [-self._product(row, moved) for row in self.signed]

    def _product(self, row: Sequence[Value | float], column: Sequence[Value | float]) -> Value:
        rec = self.rec
        return rec.total([rec.multiply(a, b) for a, b in zip(row, column, strict=True)])

    def _group(self) -> None:
        """Terms sorted by phase; what bends along each phase, seen through the inverse."""
        rec, closure = self.rec, self.closure
        groups: dict[tuple[tuple[int, float], ...], list[tuple[int, int]]] = {}
        pairs: dict[tuple[int, tuple[tuple[int, float], ...]], list[tuple[int, int]]] = {}
        for row, loop in enumerate(closure.loops):
            for term in closure.terms[loop]:
                phase = closure.phases.get(term, ())
                length = int(closure.table.loops.length[term])
                if phase:  # what does not turn does not bend
                    groups.setdefault(phase, []).append((row, term))
                if length >= 0:
                    pairs.setdefault((length, phase), []).append((row, term))
        self.phases = list(groups)
        self.pairs = list(pairs)
        count = len(closure.loops)
        n = len(self.unknowns)
        self.phase = [
            [self._modulus(i, count, groups[g], sliding=True) for g in self.phases]
            for i in range(n)
        ]
        self.slide = [
            [self._modulus(i, count, pairs[p], sliding=False) for p in self.pairs]
            for i in range(n)
        ]

    def _modulus(
        self, i: int, count: int, members: Sequence[tuple[int, int]], sliding: bool
    ) -> Value:
        """|Σ α c (s)| over the members of a phase, with the rounding of the sum."""
        rec, closure = self.rec, self.closure
        real: Value | float = 0.0
        imag: Value | float = 0.0
        size: Value | float = 0.0
        for row, term in members:
            a, b = self.inverse[i][row], self.inverse[i][count + row]
            cr, ci = closure.coefficient(term)
            length = int(closure.table.loops.length[term])
            s: Value | float = closure.v[length] if sliding and length >= 0 else 1.0
            cr, ci = rec.multiply(cr, s), rec.multiply(ci, s)
            # (a - i b)(cr + i ci)
            real = rec.add(real, rec.add(rec.multiply(a, cr), rec.multiply(b, ci)))
            imag = rec.add(imag, rec.subtract(rec.multiply(a, ci), rec.multiply(b, cr)))
            extent = rec.add(rec.absolute(cr), rec.absolute(ci))
            size = rec.add(
                size, rec.multiply(rec.add(rec.absolute(a), rec.absolute(b)), extent)
            )
        square = rec.add(rec.multiply(real, real), rec.multiply(imag, imag))
        noise = _UNIT * (4.0 * len(members) + 12.0)
        return rec.add(rec.sqrt(rec.add(square, 0.0)), rec.multiply(noise, size))

    def _rounding(self) -> tuple[list[Value | float], list[Value | float]]:
        """Bounds of the error of F row by row, and of dF/dv times the weights."""
        rec, closure = self.rec, self.closure
        n = len(self.unknowns)
        errors: list[Value | float] = []
        slopes: list[Value | float] = []
        for loop in closure.loops:
            terms = closure.terms[loop]
            error: Value | float = 0.0
            slope: Value | float = 0.0
            for term in terms:
                cr, ci = closure.coefficient(term)
                bare = rec.add(rec.absolute(cr), rec.absolute(ci))
                length = int(closure.table.loops.length[term])
                whole = bare if length < 0 else rec.multiply(bare, abs(closure.v[length]))
                factor: Value | float = len(terms) + _PHASOR
                phase = closure.phases.get(term, ())
                if len(phase) > 1 or any(abs(w) != 1.0 for _, w in phase):
                    parts = rec.total([abs(closure.v[k]) * abs(w) for k, w in phase])
                    factor = rec.add(factor, rec.multiply(float(len(phase) + 1), parts))
                error = rec.add(error, rec.multiply(factor, whole))
                turning = rec.total([self.scale[k] * abs(w) for k, w in phase if k in self.scale])
                slope = rec.add(slope, rec.multiply(rec.add(factor, n + 2.0), rec.multiply(whole, turning)))
                if length >= 0:
                    slope = rec.add(
                        slope,
                        rec.multiply(rec.add(factor, n + 2.0), rec.multiply(bare, self.scale[length])),
                    )
            errors.append(rec.multiply(_UNIT, error))
            slopes.append(rec.multiply(_UNIT, slope))
        errors, slopes = errors * 2, slopes * 2
        linear = closure.table.linear
        for row in closure.lines:
            mine = np.flatnonzero(linear.row == row)
            entries = [
                (int(linear.variable[k]), abs(float(linear.weight[k]))) for k in mine
            ]
            name = f"k{row}"
            constant = 0.0 if name in closure.zeros else rec.absolute(rec.input(name))
            size = rec.total([constant, *[abs(closure.v[k]) * w for k, w in entries]])
            errors.append(rec.multiply(_UNIT * (len(entries) + 4.0), size))
            spread = rec.total([self.scale[k] * w for k, w in entries])
            slopes.append(rec.multiply(_UNIT * (n + 4.0), spread))
        return errors, slopes

    def within(self, known: Mapping[int, Value]) -> Found:
        """The proof for every value of the known variables so far from theirs."""
        rec, n = self.rec, len(self.unknowns)
        mine, given = set(self.unknowns), set(self.known)
        bent_along = [*self.phases, ()]  # a fixed direction does not turn
        own = [
            rec.total([self.scale[k] * abs(w) for k, w in phase if k in mine])
            for phase in bent_along
        ]
        turned = [
            rec.total([known[k] * abs(w) for k, w in phase if k in given]) for phase in bent_along
        ]
        number = {phase: g for g, phase in enumerate(bent_along)}
        free = [(p, j, number[phase]) for p, (j, phase) in enumerate(self.pairs) if j in mine]
        held = [(p, j, number[phase]) for p, (j, phase) in enumerate(self.pairs) if j in given]
        rows = []
        for i in range(n):
            w = self.scale[self.unknowns[i]]
            phase, slide = self.phase[i], self.slide[i]
            spreads = [known[m] for m in self.known]
            by_slope = rec.total([s * d for s, d in zip(self.slope[i], spreads, strict=True)])
            whole = rec.total(
                [rec.multiply(s, d) for s, d in zip(self.lines[i], spreads, strict=True)]
            )
            for g, turn in enumerate(turned[:-1]):
                by_slope = rec.add(by_slope, 0.5 * rec.multiply(phase[g], rec.multiply(turn, turn)))
                whole = rec.add(whole, rec.multiply(phase[g], turn))
            for p, j, g in held:
                by_slope = rec.add(by_slope, slide[p] * known[j] * turned[g])
                whole = rec.add(whole, rec.multiply(slide[p], known[j]))
            # the rounding of the slopes by the known is below that of the whole Jacobian
            least = rec.smallest([by_slope, whole])
            noise = rec.multiply(
                self.loss[i],
                rec.largest([rec.divide(d, self.scale[m]) for m, d in known.items() if m in given])
                if given
                else 0.0,
            )
            y = rec.add(self.residual[i], rec.add(least, noise))
            z: Value | float = rec.total(
                [rec.multiply(d, self.scale[k]) for d, k in zip(self.defect[i], self.unknowns, strict=True)]
            )
            z = rec.add(z, self.loss[i])
            omega: Value | float = 0.0
            bent: Value | float = 0.0
            for g in range(len(self.phases)):
                z = rec.add(z, rec.multiply(phase[g], rec.multiply(own[g], turned[g])))
                omega = rec.add(omega, rec.multiply(phase[g], rec.multiply(own[g], own[g])))
            for p, j, g in free:
                z = rec.add(z, slide[p] * self.scale[j] * turned[g])
                omega = rec.add(omega, 2.0 * slide[p] * self.scale[j] * own[g])
                bent = rec.add(bent, slide[p] * self.scale[j] * own[g] * own[g])
            for p, j, g in held:
                z = rec.add(z, slide[p] * known[j] * own[g])
                omega = rec.add(omega, slide[p] * known[j] * own[g] * own[g])
            per = rec.divide(_SLACK, w) if rec._number(w) != 1.0 else rec.constant(_SLACK)
            rows.append(tuple(rec.multiply(x, per) for x in (y, z, omega, bent)))
        return self._radii(rows)

    def _radii(self, rows: Sequence[tuple[Value, Value, Value, Value]]) -> Found:
        rec = self.rec
        y, z, omega, bent = (rec.largest([row[c] for row in rows]) for c in range(4))
        straight = rec._number(bent) == 0.0
        room = 1.0 - z
        if straight:
            whole: Value = omega
            reach = None
        else:
            root = rec.sqrt(omega * omega + 8.0 * bent * rec.largest([room, 0.0]))
            reach = 4.0 * room / (omega + root)
            whole = omega + reach * bent
        square = room * room - 2.0 * _SLACK * whole * y
        holds = rec.all_of([rec.at_most(1e-9, room), rec.at_most(1e-300, square)])
        root = rec.sqrt(rec.largest([square, 0.0]))
        total = room + root
        exists = 2.0 * _SLACK * y / total
        unique = total / (whole * _SLACK)
        if reach is not None:
            unique = rec.smallest([unique, reach / _SLACK])
        each, alone = [], []
        for (yi, zi, oi, bi), k in zip(rows, self.unknowns, strict=True):
            curve = oi if reach is None else rec.add(oi, rec.multiply(reach, bi))
            own = yi + exists * (zi + 0.5 * curve * exists)
            each.append(rec.smallest([own * _SLACK, exists]) * self.scale[k])
            alone.append(unique * self.scale[k])
        return Found(holds, exists, each, alone)
