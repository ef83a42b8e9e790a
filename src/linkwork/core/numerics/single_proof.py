"""The proof of one block at one position in plain numbers; see :mod:`kantorovich`.

The constants are the same, row by row.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.kantorovich import BENDING, FITTINGS, LEAST, MOST, SHIFTING, TINY
from linkwork.core.numerics.single_rows import SingleBlock, SingleLinear, dot, linearise_singly
from linkwork.core.numerics.system import SingleSystem

__all__ = [
    "PlacesOfRow",
    "SingleExpansion",
    "SingleExpansions",
    "SingleRadii",
    "chain_radii",
    "expand_rows",
    "fitted_radii_singly",
    "radii_singly",
    "rows_of",
]

Row = list[float]


@dataclass(frozen=True, slots=True)
class SingleExpansion:
    """``Expansion`` at one position, each array as a list of its rows."""

    one: SingleSystem
    residual: Row
    defect: list[Row]
    slope: list[Row]
    lines: list[Row]
    phase: list[Row]
    slide: list[Row]


def expand_singly(
    block: SingleBlock, v: Row, part: SingleLinear, exact: tuple[Row, Row] | None = None
) -> SingleExpansion:
    """A block at a position of its own variables (N,).

    ``exact``: F rounded once, and its error bounds.
    """
    one, n = block.one, block.n
    matrix, jacobian, first = part.inverse, part.jacobian, block.one.loop_rows
    bend = one.curvature(v, matrix)
    f, rounding = (one.residual(v), bend.rounding) if exact is None else exact
    printing = bend.printing if exact is None else [0.0] * n
    own = (n + 2) * UNIT_ROUNDOFF
    rounding = [x + own * abs(y) for x, y in zip(rounding, f, strict=True)]
    residual, defect, slope, lines = [], [], [], []
    columns = list(zip(*jacobian, strict=True))
    losses = list(zip(*bend.jacobian_rounding, strict=True))
    known = len(v) - n
    for i, row in enumerate(matrix):
        size = [abs(a) for a in row]
        residual.append(abs(dot(row, f)) + dot(size, rounding) + printing[i])  # eq. (25): Y
        entries = [
            abs(dot(row, column) - (1.0 if i == k else 0.0) if k < n else dot(row, column))
            + dot(size, loss)
            for k, (column, loss) in enumerate(zip(columns, losses, strict=True))
        ]
        defect.append(entries[:n])  # eq. (25): Z0
        slope.append(entries[n:])
        if first == n:
            lines.append([0.0] * known)
        else:
            row, size = row[first:], size[first:]
            lines.append(
                [
                    abs(dot(row, column[first:])) + dot(size, loss[first:])
                    for column, loss in zip(columns[n:], losses[n:], strict=True)
                ]
            )
    return SingleExpansion(one, residual, defect, slope, lines, bend.phase, bend.slide)


@dataclass(frozen=True, slots=True)
class SingleExpansions:
    """A block at B positions, one by one."""

    rows: list[SingleExpansion]

    def take(self, index: IndexArray | slice) -> SingleExpansions:
        """At some of the positions, in the order of ``index``."""
        if isinstance(index, slice):
            return SingleExpansions(self.rows[index])
        return SingleExpansions([self.rows[k] for k in index.tolist()])


#: The data of all blocks at one position.
PlacesOfRow = Sequence[SingleExpansion]


def expand_rows(solver: BlockSolver, v: Array, *, exact: bool) -> list[SingleExpansions]:
    """Every block at positions v (B, N)."""
    rows, found = v.tolist(), []
    for block, own in zip(solver.blocks, solver.singles, strict=True):
        places = []
        for number, row in enumerate(rows):
            here = [row[k] for k in own.variables]
            f = None
            if exact:
                value, error = block.system.exact_residual(v[number, block.variables])
                f = value.tolist(), error.tolist()
            places.append(expand_singly(own, here, linearise_singly(own, here), f))
        found.append(SingleExpansions(places))
    return found


def rows_of(places: Sequence[object]) -> list[PlacesOfRow] | None:
    """The data of all blocks row by row; ``None`` if they are arrays."""
    singly = [place.rows for place in places if isinstance(place, SingleExpansions)]
    if not singly or len(singly) != len(places):
        return None
    return list(zip(*singly, strict=True))


@dataclass(frozen=True, slots=True)
class SingleRadii:
    """``Radii`` of one position."""

    holds: bool
    existence_radius: float
    uniqueness_radius: float
    error_bound: Row
    isolation_radius: Row


class SingleMajorant:
    """``Majorant`` at one position, for known variables that may be off by ``known`` (p,)."""

    def __init__(self, at: SingleExpansion, known: Row) -> None:
        one, n = at.one, len(at.residual)
        self.defect = at.defect
        self.bent = [[*a, *b] for a, b in zip(at.phase, at.slide, strict=True)]
        self.phases, self.count = one.phases, n
        moves = [*[0.0] * n, *known]
        # how far the known angles turn each phase
        self.turned = [sum([abs(w) * moves[k] for k, w in phase]) for phase in one.phases]
        self.pairs = [(j, g, moves[j], self.turned[g]) for j, g in one.pairs]
        self.y = at.residual
        if any(known):
            self.y = self._shifted(at, known)

    def _shifted(self, at: SingleExpansion, known: Row) -> Row:
        turned = self.turned
        slide = [spread * turn for _, _, spread, turn in self.pairs]
        by_slope = [*[0.5 * turn * turn for turn in turned], *slide]
        # a law's phase is a second derivative, no bound of the change itself
        first = at.one.loop_phases
        laws = [0.5 * turn * turn for turn in turned[first:]]
        whole = [*turned[:first], *laws, *[spread for _, _, spread, _ in self.pairs]]
        found = []
        for y, bent, slope, lines in zip(at.residual, self.bent, at.slope, at.lines, strict=True):
            low = dot(slope, known) + dot(bent, by_slope)
            high = dot(lines, known) + dot(bent, whole)
            found.append(y + (low if low <= high else high))  # eq. (31)
        return found

    def _turns(self, x: Row) -> Row:
        """How far unknowns that move by x turn each phase."""
        n, found = self.count, []
        for phase in self.phases:
            turn = 0.0
            for k, w in phase:
                if k < n:
                    turn += abs(w) * x[k]
            found.append(turn)
        return found

    def _linear(self, x: Row, own: Row) -> Row:
        """What Z x takes of every phase and pair."""
        n = self.count
        found = [a * b for a, b in zip(own, self.turned, strict=True)]
        found += [x[j] * turn if j < n else spread * own[g] for j, g, spread, turn in self.pairs]
        return found

    def _quadratic(self, x: Row, own: Row) -> Row:
        """What M(x, x) takes of every phase and pair."""
        n = self.count
        found = [a * a for a in own]  # eq. (30)
        found += [
            2.0 * x[j] * own[g] if j < n else spread * own[g] * own[g]
            for j, g, spread, _ in self.pairs
        ]
        return found

    def fit_weights(self, scale: Row) -> Row:
        """Weights (n,) in which the proof nearly always succeeds where there are any such."""
        largest = max([y / s for y, s in zip(self.y, scale, strict=True)])
        least = max(LEAST * largest, TINY)
        start = [max(y, least * s) for y, s in zip(self.y, scale, strict=True)]
        most = [MOST * s for s in scale]
        w = start
        for _ in range(FITTINGS):
            own = self._turns(w)
            linear, quadratic = self._linear(w, own), self._quadratic(w, own)
            both = [BENDING * a + SHIFTING * b for a, b in zip(quadratic, linear, strict=True)]
            w = [
                max(first, min(SHIFTING * dot(defect, w) + dot(bent, both), end))  # eq. (32)
                for first, end, defect, bent in zip(
                    start, most, self.defect, self.bent, strict=True
                )
            ]
        return w

    def radii(self, w: Row) -> SingleRadii:
        """Existence and uniqueness in weights w (n,)."""
        own = self._turns(w)
        linear, quadratic = self._linear(w, own), self._quadratic(w, own)
        cubic = self._cubic(w, own) if self.pairs else None
        ys, zs, omegas, slopes = [], [], [], []
        for i, scale in enumerate(w):
            share = PROOF_SLACK / scale
            bent = self.bent[i]
            ys.append(self.y[i] * share)
            zs.append((dot(self.defect[i], w) + dot(bent, linear)) * share)
            omegas.append(dot(bent, quadratic) * share)
            slopes.append(0.0 if cubic is None else dot(bent, cubic) * share)
        return _radii(ys, zs, omegas, slopes, w)

    def _cubic(self, x: Row, own: Row) -> Row:
        """What the growth of M(x, x) with unknown lengths takes of every phase and pair."""
        n = self.count
        found = [0.0] * len(own)
        # eq. (30): the part that grows with ρ
        found += [x[j] * own[g] * own[g] if j < n else 0.0 for j, g, _, _ in self.pairs]
        return found


def _radii(ys: Row, zs: Row, omegas: Row, slopes: Row, weights: Row) -> SingleRadii:
    """From the constants row by row, in units of the weights; see ``kantorovich.radii``."""
    n, total = len(weights), sum(ys) + sum(zs) + sum(omegas) + sum(slopes)
    y, room, omega, slope = max(ys), 1.0 - max(zs), max(omegas), max(slopes)
    holds = total < math.inf and room > 0.0  # the largest of some numbers may hide a NaN
    rho = square = 0.0
    if holds:
        if slope > 0.0:  # eq. (28)
            rho = 4.0 * room / (omega + math.sqrt(omega * omega + 8.0 * slope * room))
        else:
            rho = 2.0 * room / omega if omega else math.inf
        whole = omega + (rho * slope if slope > 0.0 else 0.0)
        square = room * room - 2.0 * whole * y * PROOF_SLACK
        holds = square > 0.0  # eq. (26)
    if not holds:
        return SingleRadii(False, math.inf, 0.0, [math.inf] * n, [0.0] * n)
    both = room + math.sqrt(square)
    # eq. (27): r- without cancellation
    existence = 2.0 * y / both * PROOF_SLACK
    uniqueness = min(both / whole, rho) / PROOF_SLACK if whole else math.inf
    error_bound, isolation = [], []
    for own, z, bent, growth, w in zip(ys, zs, omegas, slopes, weights, strict=True):
        if growth > 0.0:
            bent += rho * growth
        # eq. (29)
        bound = own + existence * (z + 0.5 * bent * existence)
        error_bound.append(min(bound * PROOF_SLACK, existence) * w)
        isolation.append(uniqueness * w / PROOF_SLACK)
    return SingleRadii(True, existence, uniqueness, error_bound, isolation)


def radii_singly(block: SingleBlock, at: SingleExpansion, known: Row) -> SingleRadii:
    """In the block's own weights; where they do not suffice, in fitted ones."""
    majorant = SingleMajorant(at, known)
    found = majorant.radii(block.weights)
    if found.holds:
        return found
    found = majorant.radii(majorant.fit_weights(block.weights))
    # back in the usual weights, in which radii are reported
    errors = zip(found.error_bound, block.weights, strict=True)
    isolations = zip(found.isolation_radius, block.weights, strict=True)
    return SingleRadii(
        found.holds,
        max([e / w for e, w in errors]),
        min([e / w for e, w in isolations]),
        found.error_bound,
        found.isolation_radius,
    )


def fitted_radii_singly(block: SingleBlock, at: SingleExpansion, known: Row) -> SingleRadii:
    """In weights fitted to the known variables' errors."""
    majorant = SingleMajorant(at, known)
    return majorant.radii(majorant.fit_weights(block.weights))


def chain_radii(
    solver: BlockSolver,
    places: PlacesOfRow,
    given: Row,
    prove: Callable[[SingleBlock, SingleExpansion, Row], SingleRadii],
) -> tuple[list[SingleRadii], Row]:
    """The blocks of one row, each for all values that those before may have; the errors (N,).

    ``given`` (p,): how far the inputs may be from their values.
    """
    error_bound = [*[0.0] * solver.unknowns, *given]
    found = []
    for block, place in zip(solver.singles, places, strict=True):
        own = prove(block, place, [error_bound[k] for k in block.variables[block.n :]])
        for k, x in zip(block.unknowns, own.error_bound, strict=True):
            error_bound[k] = x
        found.append(own)
    return found, error_bound
