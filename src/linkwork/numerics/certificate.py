"""Proof that a solution exists near computed numbers: Newton-Kantorovich with explicit constants.

For F(x) = 0, A ≈ J(x0)⁻¹ and the weighted norm ‖x‖ = max |x_i|/w_i let

    Y  ≥ ‖A F(x0)‖,   Z0 ≥ ‖I - A J(x0)‖,   ω ≥ Lipschitz constant of A J within ρ of x0.

If (1 - Z0)² > 2 ω Y, there is exactly one solution within min(r+, ρ) of x0, it lies within r-, and
r± = [(1 - Z0) ± √((1 - Z0)² - 2 ω Y)] / ω (Kantorovich 1948; Rump 2010,
doi:10.1017/S096249291000005X). All constants include the rounding of their own computation. Known
quantities (inputs, unknowns of blocks solved before) may be uncertain: the proof then holds for
every value in their intervals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.numerics.system import Curvature, System

__all__ = ["Bounds", "Radii", "bounds", "radii"]

_UNIT = np.finfo(float).eps / 2
_SLACK = 1.0 + 1e-12  # rounding of the bounds' own arithmetic, sums of positive numbers


@dataclass(frozen=True, kw_only=True, eq=False)
class Bounds:
    """The constants row by row, (B, n), in units of the weights: largest entries are Y, Z0, ω.

    The Lipschitz constant within ρ is ``omega`` + ρ ``omega_slope``.
    """

    y: Array
    z: Array
    omega: Array
    omega_slope: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Radii:
    """What was proved, (B,): ``holds``; a solution within ``exists``, no other within ``unique``.

    ``each`` (B, n): a bound of every unknown's error in its own unit, never larger than ``exists``
    times its weight.
    """

    holds: BoolArray
    exists: Array
    unique: Array
    each: Array


def bounds(system: System, v: Array, jacobian: Array, matrix: Array, known: Array) -> Bounds:
    """Constants of the proof at B positions.

    Parameters
    ----------
    system : System
        With n unknowns and p known variables behind; ``bends_boundedly`` must hold.
    v : (B, N)
    jacobian : (B, n, N)
        dF/dv at v.
    matrix : (B, n, n)
        A, any approximate inverse of the Jacobian by the unknowns.
    known : (B, p)
        How far each known variable may be from its value in v, in its own unit.

    Notes
    -----
    A change δ of a phase e^{iψ} is split as iδ plus at most δ²/2, or bounded by |δ| as a whole,
    whichever is smaller row by row.
    """
    n = system.unknowns
    bend = system.curvature(v, matrix)
    w = system.variable_scale[:n]
    size = np.abs(matrix)
    turned = known @ bend.weights[n:]  # (B, G): how far the known angles turn each phase
    own = w @ bend.weights[:n]  # (G,): how far unknowns of norm 1 turn it
    pairs = _Pairs(bend, w, known)
    loss = size @ bend.jacobian_rounding

    residual, slope_known = system.residual(v), jacobian[:, :, n:]
    y = np.abs(_apply(matrix, residual))
    y += _apply(size, bend.rounding + (n + 2) * _UNIT * np.abs(residual))
    y += np.minimum(
        _first_order(bend, pairs, np.abs(matrix @ slope_known) + loss[:, :, n:], known, turned),
        _as_a_whole(bend, pairs, _lines(bend, matrix, slope_known), known, turned),
    )

    z = np.abs(np.eye(n) - matrix @ jacobian[:, :, :n]) + loss[:, :, :n]
    z_rows = (z * w).sum(axis=2) + _apply(bend.phase, own * turned)
    z_rows += _apply(pairs.unknown, pairs.weight * turned[:, pairs.unknown_group])
    z_rows += _apply(pairs.known, pairs.spread * own[pairs.known_group])

    omega = bend.phase @ own**2 + pairs.unknown @ (2.0 * pairs.weight * own[pairs.unknown_group])
    omega += _apply(pairs.known, pairs.spread * own[pairs.known_group] ** 2)
    slope = pairs.unknown @ (pairs.weight * own[pairs.unknown_group] ** 2)
    return Bounds(
        y=_SLACK * y / w,
        z=_SLACK * z_rows / w,
        omega=_SLACK * omega / w,
        omega_slope=_SLACK * slope / w,
    )


class _Pairs:
    """Terms with a variable length, split into those with an unknown and with a known length."""

    def __init__(self, bend: Curvature, weights: Array, known: Array) -> None:
        n = len(weights)
        mine = np.flatnonzero(bend.pair_length < n)
        given = np.flatnonzero(bend.pair_length >= n)
        self.unknown, self.known = bend.slide[:, :, mine], bend.slide[:, :, given]
        self.unknown_group, self.known_group = bend.pair_group[mine], bend.pair_group[given]
        self.weight = weights[bend.pair_length[mine]]
        self.spread = known[:, bend.pair_length[given] - n]


def _first_order(
    bend: Curvature, pairs: _Pairs, slope: Array, known: Array, turned: Array
) -> Array:
    """|A (F(x0, k) - F(x0, k0))| by the derivative (B, n, p), plus what the phases bend."""
    change = _apply(slope, known)
    change += 0.5 * _apply(bend.phase, turned**2)
    return change + _apply(pairs.known, pairs.spread * turned[:, pairs.known_group])


def _as_a_whole(bend: Curvature, pairs: _Pairs, lines: Array, known: Array, turned: Array) -> Array:
    """The same by the moduli alone; better where a phase turns far."""
    change = _apply(bend.phase, turned) + _apply(pairs.known, pairs.spread)
    return change + _apply(lines, known)


def _lines(bend: Curvature, matrix: Array, slope_known: Array) -> Array:
    """What linear rows make of known variables, (B, n, p)."""
    n, rest = matrix.shape[1], slice(bend.loop_rows, None)
    size = np.abs(matrix[:, :, rest]) @ bend.jacobian_rounding[:, rest, n:]
    return np.abs(matrix[:, :, rest] @ slope_known[:, rest]) + size


def _apply(matrix: Array, vector: Array) -> Array:
    product: Array = (matrix @ vector[:, :, None])[:, :, 0]
    return product


def radii(b: Bounds, weights: Array) -> Radii:
    """Existence and uniqueness from the constants.

    ρ is chosen so that the uniqueness radius just fits in: ρ (ω0 + ω1 ρ) = 2 (1 - Z0).
    """
    y, z = b.y.max(axis=1), b.z.max(axis=1)
    omega, slope = b.omega.max(axis=1), b.omega_slope.max(axis=1)
    room = 1.0 - z
    with np.errstate(all="ignore"):
        rho = np.where(
            slope > 0.0,
            4.0 * room / (omega + np.sqrt(omega**2 + 8.0 * slope * np.maximum(room, 0.0))),
            2.0 * room / omega,
        )
        whole = omega + np.where(slope > 0.0, rho * slope, 0.0)
        square = room**2 - 2.0 * whole * y * _SLACK
        holds = (room > 0.0) & (square > 0.0)
        root = np.sqrt(square)
        # r- without cancellation; a system without curvature has r- = Y/(1 - Z0) and r+ = ∞
        exists = np.where(holds, 2.0 * y / (room + root) * _SLACK, np.inf)
        unique = np.where(holds, np.minimum((room + root) / whole, rho) / _SLACK, 0.0)
    with np.errstate(all="ignore"):
        bent = b.omega + np.where(b.omega_slope > 0.0, rho[:, None] * b.omega_slope, 0.0)
        each = b.y + b.z * exists[:, None] + 0.5 * bent * exists[:, None] ** 2
    each = np.minimum(each * _SLACK, exists[:, None]) * weights
    return Radii(holds=holds, exists=exists, unique=unique, each=each)
