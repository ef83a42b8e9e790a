"""Turns of an input straight across change points, by analytic continuation.

Where branches cross, the Jacobian is singular but the motion that goes straight on is smooth. The
polynomial through the last positions is continued beyond the crossing; there the branches are apart
again, and Newton-Raphson corrects it. Positions next to a crossing are those of the polynomial.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.status import CONVERGED
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.local_parametrization import Parametrizations
from linkwork.numerics.proof.position_proof import prove
from linkwork.numerics.rows import SolvedRows

__all__ = ["Turn", "turn_of"]

_POINTS = 10  # of a polynomial
_SINGULAR = 100.0  # condition beyond which a position is taken from its polynomial
_FIRST, _LARGEST, _SHORTEST = 0.01, 0.07, 1e-4  # steps [rad]
_OFF = 1e-5  # weighted: how far a prediction may be from the position
_CONTINUED = 1e-8  # weighted: how well two polynomials must agree at a crossing
_EXACT = 1e-10  # weighted: the same for nodes that are kept
_MOST = 4000  # steps in a turn
_MOST_TURNS = 12  # after which a motion straight on counts as never closing
_CLOSED = 1e-9  # weighted: how well a turn ends where it began


@dataclass(frozen=True, kw_only=True, eq=False)
class Turn:
    """Positions (K, N) at rising values (K,) of the input, until they repeat and a little more.

    ``turns``: of the input, after which they do.
    """

    solver: BlockSolver
    begin: float
    at: Array
    v: Array
    turns: int = 1

    @property
    def end(self) -> float:
        """Where the positions repeat."""
        return self.begin + self.turns * FULL_TURN

    def gain(self, leads: Parametrizations) -> Array:
        """What the variables gain until then, (N,)."""
        ends, _ = self.interpolate(np.array([self.begin, self.end]))
        grown = ends[1] - ends[0]
        return np.where(leads.is_angle, FULL_TURN * np.round(grown / FULL_TURN), 0.0)

    def repeats(self, leads: Parametrizations) -> bool:
        """Whether they do."""
        (first, last), _ = self.interpolate(np.array([self.begin, self.end]))
        gap = np.abs(last - first - self.gain(leads)) / self.solver.variable_scale
        return bool(gap.max() < _CLOSED)

    def interpolate(self, values: Array) -> tuple[Array, tuple[Array, Array]]:
        """Positions (B, N) at values of the input, with both derivatives, by polynomials."""
        last = len(self.at) - _POINTS
        first = np.clip(np.searchsorted(self.at, values) - _POINTS // 2, 0, last)
        near = first[:, None] + np.arange(_POINTS)
        nodes, v = self.at[near] - values[:, None], self.v[near]
        size = np.abs(nodes).max(axis=1, keepdims=True)
        # Taylor coefficients about each value
        powers = (nodes / size)[:, :, None] ** np.arange(_POINTS)
        found = np.linalg.solve(powers, v)
        return found[:, 0], (found[:, 1] / size, 2.0 * found[:, 2] / size**2)

    def rows(self, values: Array, certify: bool) -> SolvedRows:
        """Positions and derivatives by the input at values (B,)."""
        solver = self.solver
        guess, (first, second) = self.interpolate(values)
        guess[:, -1] = values
        solved = solver.solve(guess)
        rates = solver.rates(solved.v, np.ones(1))
        fine = (solved.status == CONVERGED) & (rates.nearness < _SINGULAR)
        fine &= (np.abs(solved.v - guess) / solver.variable_scale).max(axis=1) < _OFF
        pick = fine[:, None]
        v = np.where(pick, solved.v, guess)
        count = len(values)
        code = np.full(count, Certification.NOT_ASKED.code, dtype=np.int8)
        radius = unique = np.full(count, np.nan)
        if certify and all(block.system.has_curvature_bound for block in solver.blocks):
            proof = prove(solver, v, 4.0 * EPSILON * np.abs(v[:, -1:]))
            proved = Certification.BRANCH_CHOSEN.code
            code = np.where(proof.holds, proved, Certification.POSITION_NOT_PROVED.code)
            radius = np.where(proof.holds, proof.radius, np.nan)
            unique = np.where(proof.holds, proof.least_uniqueness_radius, np.nan)
        return SolvedRows(
            v=v,
            first=np.where(pick, rates.first, first),
            second=np.where(pick, rates.second, second),
            status=np.full(count, CONVERGED, dtype=np.int8),
            residual=solver.residual(v),
            iterations=solved.iterations.copy(),
            condition=rates.condition.copy(),
            certification=code.astype(np.int8),
            radius=radius,
            uniqueness_radius=unique,
        )


def turn_of(leads: Parametrizations, solver: BlockSolver, start: Array) -> Turn | None:
    """The turns from a regular position (N,) until positions repeat; ``None`` if they cannot be
    followed, or never do.
    """
    turns = 1
    begin = float(start[-1])
    sharp = [True]  # which nodes are kept: those next to a crossing are polynomials
    scale = solver.variable_scale
    at, v = [begin], [start]
    h = _FIRST
    quick = replace(solver.options, max_steps=8)
    for _ in range(_MOST_TURNS * _MOST):
        if at[-1] > begin + turns * FULL_TURN + _LARGEST:
            nodes = np.array(at)[sharp], np.stack(v)[sharp]
            turn = Turn(solver=solver, begin=begin, at=nodes[0], v=nodes[1], turns=turns)
            if turn.repeats(leads):
                return turn
            turns += 1
            if turns > _MOST_TURNS:
                return None
        t = at[-1] + h
        guess, doubt = _continued(solver, at, v, t)
        found = solver.solve(guess[None, :], quick)
        off = float((np.abs(found.v[0] - guess) / scale).max())
        rates = solver.rates(found.v, np.ones(1))
        near = not rates.nearness[0] < _SINGULAR
        doubtful = float((np.abs(doubt) / scale).max())
        if near and doubtful < _CONTINUED:
            at.append(t)
            v.append(guess)
            sharp.append(doubtful < _EXACT)
        elif found.status[0] == CONVERGED and off < _OFF and not near:
            at.append(t)
            v.append(found.v[0])
            sharp.append(True)
            h = min(1.3 * h, _LARGEST)
        else:
            h *= 0.5
            if h < _SHORTEST:
                return None
    return None


def _continued(
    solver: BlockSolver, at: list[float], v: list[Array], t: float
) -> tuple[Array, Array]:
    """The polynomial through the last positions at t, and its difference from one of less order."""
    if len(at) < 3:
        rates = solver.rates(v[-1][None, :], np.ones(1))
        h = t - at[-1]
        found = v[-1] + h * rates.first[0] + 0.5 * h * h * rates.second[0]  # eq. (17)
        doubt = np.full_like(found, np.inf)
    else:
        found = _extrapolate(at[-_POINTS:], v[-_POINTS:], t)
        doubt = found - _extrapolate(at[-_POINTS + 1 :], v[-_POINTS + 1 :], t)
    found[-1] = t
    return found, doubt


def _extrapolate(at: list[float], v: list[Array], t: float) -> Array:
    """Neville's scheme."""
    rows = [np.array(row) for row in v]
    for k in range(1, len(rows)):
        for j in range(len(rows) - k):
            low, high = at[j], at[j + k]
            rows[j] = ((t - high) * rows[j] + (low - t) * rows[j + 1]) / (low - high)
    return rows[0]
