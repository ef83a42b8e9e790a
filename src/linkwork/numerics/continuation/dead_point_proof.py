"""Proof of a dead point: between two values of the leader the parameter's rate changes its sign.

With another variable λ in the lead a dead point is an ordinary position. Kantorovich's theorem
gives one solution x(λ) for every λ of a small interval, all of them in one box. The rates x'(λ)
solve J x' = -F_λ; multiplied by A ≈ J⁻¹, with d the computed direction and e its error,

    |e| ≤ |I - A J| |e| + |A J d| + |A J_k| |e_k|

where J is taken anywhere in the box: it differs from J at the computed position by at most the
bound of the second derivatives times the size of the box. If the parameter's rate has proved and
opposite signs at both ends of the interval, the parameter turns back in between, and the dead point
lies in the box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.products import matrix_vector
from linkwork.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.numerics.block_solver import Block, BlockSolver, Linearised
from linkwork.numerics.continuation.local_parametrization import Parametrization
from linkwork.numerics.proof.enclosed import Enclosed
from linkwork.numerics.proof.kantorovich import Expansion
from linkwork.numerics.proof.position_proof import expansions, prove, reach

__all__ = ["FoldProof", "prove_dead_point"]

_ROOM = 4.0  # times the error of the rate: how far apart the ends of the interval are taken
_LEAST = 16.0  # units of rounding of the leader
_WIDENINGS = 12  # tries, each with an interval this many times as wide
_WIDER = 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class FoldProof:
    """``error_bound`` (N,): how far the dead point may be from the position it was proved from, in
    the solver's order, the leader's own last; ``isolation_radius`` (n,): within this no other
    position has the same leader's value. ``radius``, ``uniqueness_radius``: both weighted.
    """

    error_bound: Array
    isolation_radius: Array
    radius: float
    uniqueness_radius: float


def prove_dead_point(led: Parametrization, v: Array, place: int) -> FoldProof | None:
    """Prove that the parameter turns back next to a position.

    Parameters
    ----------
    v : (N,)
        The position, in the solver's order, at which the parameter's rate is zero to rounding.
    place : int
        The index of the parameter in the solver's order.

    Returns
    -------
    FoldProof or None
        ``None`` where nothing is proved.
    """
    if not led.provable:
        return None
    solver, path = led.solver, led.path
    with np.errstate(all="ignore"):
        rates = solver.rates(v[None, :], path.rate)
        bend = abs(float(rates.second[0, place]))
        own = _rate_errors(solver, v[None, :], rates.first)
    if own is None or not bend > 0.0:
        return None
    off = abs(float(rates.first[0, place])) + float(own.rates[0, place])
    # at both ends t' has to exceed its own error: t' grows by about bend times the width
    width = max(_ROOM * off / bend, _LEAST * UNIT_ROUNDOFF * max(1.0, abs(float(v[-1]))))
    for _ in range(_WIDENINGS):
        found = _turns_within(led, v, place, width)
        if found is not None:
            return found
        width *= _WIDER
    return None


def _turns_within(led: Parametrization, v: Array, place: int, width: float) -> FoldProof | None:
    """The proof with an interval of the leader of that half width, or ``None``."""
    solver = led.solver
    whole = width + 2.0 * UNIT_ROUNDOFF * (
        abs(float(v[-1])) + width
    )  # the ends are rounded themselves
    at_v = expansions(solver, v[None, :], exact=True)
    box = reach(solver, v[None, :], np.full((1, 1), whole), at_v)
    if not box.holds[0]:
        return None
    # first-order guesses of both ends, then solved
    ends = solver.rates(v[None, :], led.path.rate).first * np.array([[-width], [width]]) + v
    # exactly there: the product above has rounded them
    ends[:, -1] = v[-1] + np.array([-width, width])
    found = solver.solve(ends).v
    rates = solver.rates(found, led.path.rate).first
    errors = _rate_errors(solver, found, rates)
    if errors is None:
        return None
    off = np.abs(found - v)[:, :-1] + errors.error_bound[:, :-1]
    slow, error = rates[:, place], errors.rates[:, place]
    turned = slow[0] * slow[1] < 0.0 and (np.abs(slow) > error).all()  # eq. (40)
    if not (turned and (off < box.isolation_radius).all()):
        return None
    weights = solver.variable_scale
    error_bound = np.append(box.error_bound[0], whole)
    return FoldProof(
        error_bound=error_bound,
        isolation_radius=box.isolation_radius[0],
        radius=float((error_bound / weights).max()),
        uniqueness_radius=float((box.isolation_radius[0] / weights[:-1]).min()),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Errors:
    """How far true positions may be from computed ones, and their rates, (B, N) each."""

    error_bound: Array
    rates: Array


def _rate_errors(solver: BlockSolver, v: Array, rates: Array) -> _Errors | None:
    """Bounds for positions v (B, N) at exactly their inputs; ``None`` where nothing is proved."""
    linear = solver.linearise(v)
    places = expansions(solver, v, linear, exact=True)
    position = prove(solver, v, np.zeros((len(v), solver.variables - solver.unknowns)), places)
    if not position.holds.all():
        return None
    errors = np.zeros_like(rates)
    for block, part, at in zip(solver.blocks, linear, places, strict=True):
        here, box, d, known = (
            x[:, block.variables] for x in (v, position.error_bound, rates, errors)
        )
        known[:, : len(block.unknowns)] = 0.0
        if isinstance(at, Enclosed):
            y, z = _terms_over_box(at, box, d, known)
        else:
            assert isinstance(at, Expansion)  # the position is proved, with arrays
            y, z = _terms(block, part, at, here, box, d, known)
        found = _block_errors(block, y, z)
        if found is None:
            return None
        errors[:, block.unknowns] = found
    return _Errors(error_bound=position.error_bound, rates=errors)


def _terms_over_box(at: Enclosed, box: Array, d: Array, known: Array) -> tuple[Array, Array]:
    """As :func:`_terms`, from slopes enclosed over boxes (B, N)."""
    n = at.matrix.shape[1]
    centre, spread = at.slopes(box)
    size = np.abs(centre) + spread
    rounding = (d.shape[1] + 4) * UNIT_ROUNDOFF * matrix_vector(size, np.abs(d))
    # eq. (39): |A J d| and |A J_k| |e_k|
    y = np.abs(matrix_vector(centre, d)) + matrix_vector(spread, np.abs(d)) + rounding
    own = np.abs(np.eye(n) - centre[:, :, :n]) + spread[:, :, :n]
    w = np.broadcast_to(at.system.variable_scale[:n], y.shape)
    return (y + matrix_vector(size, known)) * PROOF_SLACK, matrix_vector(own, w) * PROOF_SLACK


def _terms(
    block: Block,
    part: Linearised,
    at: Expansion,
    here: Array,
    box: Array,
    d: Array,
    known: Array,
) -> tuple[Array, Array]:
    """y and Z times the weights, (B, n) each, with e ≤ y + Z e for the errors e of a block's rates.

    ``here``, ``box``, ``d`` (B, N): its variables, how far they may be off, and their rates;
    ``known``: the errors of the rates of its known variables, 0 for its own.
    """
    n, system = len(block.unknowns), block.system
    bend = _Bend(at.phase, at.slide, at.weights, at.pair_length, at.pair_group)
    # |A J d|: as computed, the rounding of J, and that of the products
    size, along = np.abs(part.inverse), np.abs(d)
    slip = matrix_vector(system.curvature(here, part.inverse).jacobian_rounding, along)
    slip += (d.shape[1] + n + 4) * UNIT_ROUNDOFF * matrix_vector(np.abs(part.jacobian), along)
    # eq. (39): |A J d|
    y = np.abs(matrix_vector(part.inverse, matrix_vector(part.jacobian, d))) + matrix_vector(
        size, slip
    )
    y += bend.between(box, along)
    # eq. (39): |A J_k| |e_k|
    y = (y + matrix_vector(at.slope, known[:, n:]) + bend.between(box, known)) * PROOF_SLACK
    w = system.variable_scale[:n]
    unit = np.zeros_like(d)
    unit[:, :n] = w
    z = (
        matrix_vector(at.defect, np.broadcast_to(w, y.shape)) + bend.between(box, unit)
    ) * PROOF_SLACK
    return y, z


def _block_errors(block: Block, y: Array, z: Array) -> Array | None:
    """The errors of one block's rates, (B, n), from e ≤ y + Z e in its weights."""
    w = block.system.variable_scale[: len(block.unknowns)]
    room = 1.0 - (z / w).max(axis=1)
    if not (room > 0.0).all():
        return None
    # eq. (39) solved for the norm of e, then row by row
    norm = (y / w).max(axis=1) / room * PROOF_SLACK
    found: Array = (y + z * norm[:, None]) * PROOF_SLACK
    return found if np.isfinite(found).all() else None


class _Bend:
    """|A (J(v + a) - J(v)) b| for changes and directions of known size, (B, n)."""

    def __init__(
        self,
        phase: Array,
        slide: Array,
        weights: Array,
        pair_length: IndexArray,
        pair_group: IndexArray,
    ) -> None:
        self.phase, self.slide, self.weights = phase, slide, weights
        self.length, self.group = pair_length, pair_group

    def between(self, a: Array, b: Array) -> Array:
        """For a and b (B, N), neither negative."""
        turned, turning = a @ self.weights, b @ self.weights
        rows = matrix_vector(self.phase, turned * turning)
        if self.length.size:
            longer, slides = a[:, self.length], b[:, self.length]
            by = turned[:, self.group], turning[:, self.group]
            pairs = longer * by[1] + slides * by[0]
            rows += matrix_vector(self.slide, pairs)
        return rows
