"""Proof that a solution exists near computed numbers: Newton-Kantorovich with explicit constants.

For F(x) = 0, A ≈ J(x0)⁻¹ and the weighted norm ‖x‖ = max |x_i|/w_i let

    Y ≥ ‖A F(x0)‖,   Z0 ≥ ‖I - A J(x0)‖,   ω ≥ Lipschitz constant of A J within ρ of x0.

There is exactly one solution within min(r+, ρ) of x0, and it lies within r-, if

    (1 - Z0)² > 2 ω Y,
    r± = [(1 - Z0) ± √((1 - Z0)² - 2 ω Y)] / ω

(Kantorovich 1948; Rump 2010, doi:10.1017/S096249291000005X). With ω = ω0 + ω1 ρ, ρ is chosen so
that the uniqueness radius just fits in:

    ρ (ω0 + ω1 ρ) = 2 (1 - Z0).

All constants include the rounding of their own computation. Known quantities (inputs, unknowns of
blocks solved before) may be uncertain: the proof then holds for every value in their intervals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import (
    PROOF_SLACK,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    IndexArray,
    matrix_vector,
)
from linkwork.core.numerics.block_solver import Block, BlockSolver, Linearised
from linkwork.core.numerics.newton import Columns, System
from linkwork.core.table.loop_table import Curvature

# Rounds in which weights are fitted; empirical, any number near it serves. The bounds are computed
# for the weights found, so that too few rounds can lose a proof, but never give a wrong one.
FITTINGS = 4
# c and d of fitted weights. In them Y ≤ 1, and every row has c ω + d Z ≤ 1. If one row has both
# largest values, (1 - Z)² - 2 ω Y is at least (1 - 2/c) + 2 (d/c - 1) Z + Z²: positive for c > 2
# and d ≥ c. With these it is 0.2 or more, room for rounds that have not converged.
BENDING, SHIFTING = 2.5, 3.0
LEAST = 1e-12  # of the largest weight: an unknown that does not move has this one
MOST = 1e3  # of the usual weight: where the proof fails weights grow without end
TINY = 1e-200


@dataclass(frozen=True, kw_only=True, eq=False)
class Bounds:
    """The constants row by row, (B, n), in units of the weights: largest entries are Y, Z0, ω.

    The Lipschitz constant within ρ is ``omega`` + ρ ``omega_slope``.
    """

    y: Array
    z: Array
    omega: Array
    omega_slope: Array


class Radii(Columns):
    """Results of proofs, (B,): ``holds``; a solution within ``existence_radius``, no other within
    ``uniqueness_radius``.

    ``error_bound`` (B, n): a bound of every unknown's error in its own unit, never larger than
    ``existence_radius`` times its weight. ``isolation_radius`` (B, n): ``uniqueness_radius`` in
    their own units.
    """

    holds: BoolArray
    existence_radius: Array
    uniqueness_radius: Array
    error_bound: Array
    isolation_radius: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Expansion:
    """A system at B positions, multiplied by an approximate inverse A of its Jacobian.

    All data that a proof needs, whatever the uncertainty of the p known variables.

    ``residual`` (B, n): |A F| with its rounding and that of printing the unknowns. ``defect``
    (B, n, n): |I - A J|. ``slope`` (B, n, p): |A F_k| by the known variables; ``lines`` (B, n, p):
    the part of linear rows. ``bend``: its second derivatives; rows whose phases are not those of
    loops are among ``lines``.
    """

    residual: Array
    defect: Array
    slope: Array
    lines: Array
    bend: Curvature

    def take(self, index: IndexArray | slice) -> Expansion:
        """At some of the positions, in the order of ``index``."""
        return replace(
            self,
            residual=self.residual[index],
            defect=self.defect[index],
            slope=self.slope[index],
            lines=self.lines[index],
            bend=replace(self.bend, phase=self.bend.phase[index], slide=self.bend.slide[index]),
        )

    def radii(self, block: Block, known: Array, *, fitted: bool = False) -> Radii:
        """The proofs for known variables that may be off by ``known`` (B, p).

        In the block's own weights, or in fitted ones.
        """
        weights = block.system.variable_scale[: len(block.unknowns)]
        with np.errstate(all="ignore"):
            majorant = Majorant(self, known)
            if fitted:
                weights = majorant.fit_weights(weights)
            return weighted_radii(majorant.bounds(weights), weights)

    def slopes_change(self, a: Array, b: Array) -> Array:
        """|A (J(v + a) - J(v)) b| at most, (B, n), for a and b of known size (B, N)."""
        bend = self.bend
        turned, turning = a @ bend.weights, b @ bend.weights
        rows = matrix_vector(bend.phase, turned * turning)
        if bend.pair_length.size:
            longer, slides = a[:, bend.pair_length], b[:, bend.pair_length]
            by = turned[:, bend.pair_group], turning[:, bend.pair_group]
            rows += matrix_vector(bend.slide, longer * by[1] + slides * by[0])
        return rows


def expansion(
    system: System, v: Array, jacobian: Array, matrix: Array, *, exact: bool = False
) -> Expansion:
    """A system at B positions.

    Parameters
    ----------
    system : System
        With n unknowns followed by p known variables; ``has_curvature_bound`` must hold.
    v : (B, N)
    jacobian : (B, n, N)
        dF/dv at v.
    matrix : (B, n, n)
        A, any approximate inverse of the Jacobian by the unknowns.
    exact : bool
        Take residuals that are rounded once: slow, for places where rounding decides.
    """
    n = system.unknowns
    bend = system.curvature(v, matrix)
    size, rest = np.abs(matrix), slice(bend.loop_rows, None)
    loss = size @ bend.jacobian_rounding
    f, rounding, slope = system.residual(v), bend.rounding, jacobian[:, :, n:]
    printing = bend.printing
    if exact:
        # near change points the rounding of F decides where a dead point lies
        f, rounding = (np.stack(part) for part in zip(*map(system.exact_residual, v), strict=True))
        printing = np.zeros_like(printing)
    lines = np.abs(matrix[:, :, rest] @ slope[:, rest])
    return Expansion(
        residual=np.abs(matrix_vector(matrix, f))  # eq. (25): Y
        + matrix_vector(size, rounding + (n + 2) * UNIT_ROUNDOFF * np.abs(f))
        + printing,
        defect=np.abs(np.eye(n) - matrix @ jacobian[:, :, :n]) + loss[:, :, :n],  # eq. (25): Z0
        slope=np.abs(matrix @ slope) + loss[:, :, n:],
        lines=lines + size[:, :, rest] @ bend.jacobian_rounding[:, rest, n:],
        bend=bend,
    )


class Majorant:
    """How far a solution may be, unknown by unknown: x with y + Z x + ½ M(x, x) ≤ x.

    The constants of the proof before weights are chosen, for B positions.

    Parameters
    ----------
    at : Expansion
    known : (B, p)
        How far each known variable may be from its value, in its own unit.

    Notes
    -----
    A change δ of a phase e^{iψ} is split as iδ plus at most δ²/2, or bounded by |δ| as a whole,
    whichever is smaller row by row.
    """

    def __init__(self, at: Expansion, known: Array) -> None:
        n, bend = at.residual.shape[1], at.bend
        self.defect, self.turning = at.defect, bend.weights[:n]
        self.turned = known @ bend.weights[n:]  # (B, G): how far the known angles turn each phase
        # terms with a variable length, split into those with an unknown and with a known length
        mine = np.flatnonzero(bend.pair_length < n)
        given = np.flatnonzero(bend.pair_length >= n)
        self.lengths, self.free_group = bend.pair_length[mine], bend.pair_group[mine]
        self.held_group = bend.pair_group[given]
        self.spread = known[:, bend.pair_length[given] - n]
        #: |A D²F| of every phase, of pairs with an unknown length, of those with a known one.
        self.bent = bend.phase
        if len(bend.pair_length):
            self.bent = np.concatenate([bend.phase, bend.slide[:, :, [*mine, *given]]], axis=2)
        self.y = at.residual
        if known.any():
            self.y = at.residual + self._shift(at, known)

    def _shift(self, at: Expansion, known: Array) -> Array:
        """How far the known variables move the residual, (B, n)."""
        # eq. (31)
        square = 0.5 * self.turned**2
        none = np.zeros((len(known), len(self.lengths)))
        by_slope = [square, none, self.spread * self.turned[:, self.held_group]]
        # a law's phase is a second derivative, no bound of the change itself
        loops = at.bend.loop_phases
        as_a_whole = [self.turned[:, :loops], square[:, loops:], none, self.spread]
        return np.minimum(
            matrix_vector(at.slope, known) + matrix_vector(self.bent, np.hstack(by_slope)),
            matrix_vector(at.lines, known) + matrix_vector(self.bent, np.hstack(as_a_whole)),
        )

    def _linear(self, x: Array, own: Array) -> Array:
        """What Z x takes of every phase and pair; ``own`` (B, G): how far x (B, n) turns phases."""
        found: Array = own * self.turned
        if self.lengths.size or self.held_group.size:
            free = x[:, self.lengths] * self.turned[:, self.free_group]
            found = np.concatenate([found, free, self.spread * own[:, self.held_group]], axis=1)
        return found

    def _quadratic(self, x: Array, own: Array) -> Array:
        """What M(x, x) takes of every phase and pair."""
        square = own * own
        found: Array = square  # eq. (30)
        if self.lengths.size or self.held_group.size:
            free = 2.0 * x[:, self.lengths] * own[:, self.free_group]
            found = np.concatenate([found, free, self.spread * square[:, self.held_group]], axis=1)
        return found

    def _cubic(self, x: Array, own: Array) -> Array:
        """The growth of M(x, x) where unknown lengths have changed by x (B, n), (B, n)."""
        if not self.lengths.size:
            return np.zeros_like(self.y)
        begin = own.shape[1]
        free = self.bent[:, :, begin : begin + len(self.lengths)]
        # eq. (30): the part that grows with ρ
        return matrix_vector(free, x[:, self.lengths] * own[:, self.free_group] ** 2)

    def bounds(self, weights: Array) -> Bounds:
        """The constants in weights (n,) or (B, n)."""
        w = np.broadcast_to(weights, self.y.shape)
        own, share = w @ self.turning, PROOF_SLACK / w
        linear = matrix_vector(self.defect, w) + matrix_vector(self.bent, self._linear(w, own))
        return Bounds(
            y=self.y * share,
            z=linear * share,
            omega=matrix_vector(self.bent, self._quadratic(w, own)) * share,
            omega_slope=self._cubic(w, own) * share,
        )

    def fit_weights(self, scale: Array) -> Array:
        """Weights (B, n) in which the proof nearly always succeeds where there are any such.

        An unknown's weight is how far it may move: y, or the effect of the others. With
        w ≥ y, w ≥ c M(w, w) and w ≥ d Z w the rows of the proof are balanced, whatever the ratio
        of the lengths; a long link that hardly turns does not spoil the proof of a short one.

        Parameters
        ----------
        scale : (n,)
            The usual weights.
        """
        largest = (self.y / scale).max(axis=1, keepdims=True)
        start: Array = np.maximum(self.y, np.maximum(LEAST * largest, TINY) * scale)
        w, most, defect = start, MOST * scale, SHIFTING * self.defect
        for _ in range(FITTINGS):
            own = w @ self.turning
            both = BENDING * self._quadratic(w, own) + SHIFTING * self._linear(w, own)
            grown = matrix_vector(defect, w) + matrix_vector(self.bent, both)  # eq. (32)
            # where the proof fails weights would grow without end
            w = np.maximum(start, np.minimum(grown, most))
        return w


def radii(y: Array, z: Array, omega: Array, slope: Array) -> tuple[BoolArray, Array, Array, Array]:
    """Whether the theorem holds, r-, the uniqueness radius and ρ, from Y, Z0, ω0 and ω1 (B,)."""
    room = 1.0 - z
    with np.errstate(all="ignore"):
        rho = np.where(  # eq. (28)
            slope > 0.0,
            4.0 * room / (omega + np.sqrt(omega**2 + 8.0 * slope * np.maximum(room, 0.0))),
            2.0 * room / omega,
        )
        whole = omega + np.where(slope > 0.0, rho * slope, 0.0)
        square = room**2 - 2.0 * whole * y * PROOF_SLACK
        holds = (room > 0.0) & (square > 0.0)  # eq. (26)
        root = np.sqrt(square)
        # eq. (27): r- without cancellation; without curvature r- = Y/(1 - Z0) and r+ = ∞
        existence = np.where(holds, 2.0 * y / (room + root) * PROOF_SLACK, np.inf)
        uniqueness = np.where(holds, np.minimum((room + root) / whole, rho) / PROOF_SLACK, 0.0)
    return holds, existence, uniqueness, rho


def weighted_radii(b: Bounds, weights: Array) -> Radii:
    """Existence and uniqueness from the constants, unknown by unknown."""
    holds, existence, uniqueness, rho = radii(
        b.y.max(axis=1), b.z.max(axis=1), b.omega.max(axis=1), b.omega_slope.max(axis=1)
    )
    with np.errstate(all="ignore"):
        bent = b.omega + np.where(b.omega_slope > 0.0, rho[:, None] * b.omega_slope, 0.0)
        # eq. (29)
        error_bound = b.y + b.z * existence[:, None] + 0.5 * bent * existence[:, None] ** 2
    return Radii(
        holds=holds,
        existence_radius=existence,
        uniqueness_radius=uniqueness,
        error_bound=np.minimum(error_bound * PROOF_SLACK, existence[:, None]) * weights,
        isolation_radius=uniqueness[:, None] * weights / PROOF_SLACK,
    )


# ----------------------------------------------------------------------
# How far a motion in a box is at most from its tangent: second order in the size of the box.
#
# A box is a position with all solutions for inputs of an interval around its own, proved to be
# within bounds (:func:`~linkwork.core.numerics.position_proof.reach`).


def tangent_errors(
    solver: BlockSolver,
    linear: Sequence[Linearised],
    places: Sequence[Expansion],
    first: Array,
    span: Array,
    bound: Array,
    rounding: Array,
) -> Array:
    """How far solutions in boxes around B positions are at most from the tangent, (B, N).

    A solution v + e with |e| ≤ ``bound`` is at most this far from v + s x', where s is the change
    of the path's parameter, |s| ≤ ``span``.

    Parameters
    ----------
    linear, places : sequences
        The blocks at the positions, with curvature bounds.
    first : (B, N)
        x', the rates of all variables.
    span : (B,)
    bound : (B, N)
    rounding : (B, p)
        How far inputs are from their straight line.
    """
    found = np.zeros_like(bound)
    found[:, solver.unknowns :] = rounding
    reached = np.abs(first) * span[:, None]
    with np.errstate(all="ignore"):
        for block, part, at in zip(solver.blocks, linear, places, strict=True):
            n, own = len(block.unknowns), block.variables
            here, known = bound[:, own], own[n:]
            lost = np.abs(part.inverse) @ np.abs(part.jacobian[:, :, n:])
            rounded = matrix_vector(lost, reached[:, known]) * (len(own) + 4) * UNIT_ROUNDOFF
            # eq. (190)
            found[:, block.unknowns] = PROOF_SLACK * (
                at.residual
                + matrix_vector(at.defect, here[:, :n])
                + matrix_vector(at.slope, found[:, known])
                + _remainder(at, here)
                + rounded
            )
    return found


def _remainder(at: Expansion, bound: Array) -> Array:
    """What the second derivatives of a block change at most in boxes, (B, n)."""
    bend = at.bend
    turned = bound @ bend.weights
    found = matrix_vector(bend.phase, 0.5 * turned**2)
    if len(bend.pair_length):
        longer, own = bound[:, bend.pair_length], turned[:, bend.pair_group]
        found += matrix_vector(bend.slide, longer * own * (1.0 + 0.5 * own))
    return found


# ----------------------------------------------------------------------
# Proofs by boxes: where no bound of the curvature is known, but dF/dv is enclosed over any box.
#
# For F(x, k) = 0 with known variables k, A ≈ J(x0)⁻¹, and G a set of matrices that contains dF/dv
# all over the box |x - x0| ≤ w, |k - k0| ≤ κ, the mean value theorem gives (Krawczyk 1969,
# doi:10.1007/BF02234767; Rump 2010, doi:10.1017/S096249291000005X)
#
#     e = |A F(x0)| + |A G_k| κ + |I - A G_x| w.
#
# If e < w there is, for every k, a solution in the box, and it lies within e; if |I - A G_x| w < w
# there is at most one. Boxes of many sizes are tried at once: the smallest that holds one solution
# bounds the error, the largest without a second one is the isolation.


#: Half widths of boxes in units of the usual weights: from far beyond them down to rounding.
_SIZES = 4.0 ** -np.arange(-3.0, 27.0)
_TWICE = 2.0  # times the error at the centre: room for what the slopes change


@dataclass(frozen=True, kw_only=True, eq=False)
class Enclosed:
    """A system at B positions v (B, N) with an approximate inverse A (B, n, n) of its Jacobian."""

    system: System
    v: Array
    matrix: Array

    def take(self, index: IndexArray | slice) -> Enclosed:
        """At some of the positions, in the order of ``index``."""
        return replace(self, v=self.v[index], matrix=self.matrix[index])

    def slopes(self, box: Array) -> tuple[Array, Array]:
        """Centre and half width of A G, (B, n, N), over boxes (B, N)."""
        low, high = self.system.enclosure(self.v, box)[1]
        return self._product(low, high)

    @property
    def residual(self) -> Array:
        """|A F| with all its rounding, (B, n)."""
        low, high = self.system.enclosure(self.v, np.zeros_like(self.v))[0]
        centre, spread = self._product(low[:, :, None], high[:, :, None])
        return np.asarray((np.abs(centre) + spread)[:, :, 0])

    def _product(self, low: Array, high: Array) -> tuple[Array, Array]:
        """A times the matrices from ``low`` to ``high``."""
        centre, spread = 0.5 * (low + high), 0.5 * (high - low)
        size = np.abs(self.matrix)
        # the centre and the spread are rounded, and so are the sums of n products
        lost = (self.matrix.shape[1] + 4) * UNIT_ROUNDOFF * np.abs(centre)
        return self.matrix @ centre, PROOF_SLACK * (size @ (spread + lost))

    def radii(self, block: Block, known: Array, *, fitted: bool = False) -> Radii:
        """Existence and uniqueness for known variables that may be off by ``known`` (B, p).

        The boxes are of all sizes, so no weights are fitted.
        """
        count, n = self.matrix.shape[:2]
        weights = self.system.variable_scale[:n]
        with np.errstate(all="ignore"):
            still = np.zeros_like(self.v)
            still[:, n:] = known
            centre, spread = self.slopes(still)
            shift = matrix_vector((np.abs(centre) + spread)[:, :, n:], known)
            least = _TWICE * (self.residual + shift)
            size = least + _SIZES[:, None, None] * weights
            w = size.reshape(-1, n)
            lanes = self.take(np.tile(np.arange(count), len(_SIZES)))
            box = np.concatenate([w, np.tile(known, (len(_SIZES), 1))], axis=1)
            error, alone = lanes._errors(box)
            isolated = alone.reshape(len(_SIZES), count)
            inside = np.asarray((error < w).all(axis=1)).reshape(isolated.shape)
            holds: BoolArray = inside & isolated
        bound = np.where(holds[:, :, None], error.reshape(size.shape), np.inf)
        best = (bound / weights).max(axis=2, initial=0.0).argmin(axis=0)
        rows = np.arange(count)
        # sizes fall: the first box without a second solution is the largest
        isolation = size[isolated.argmax(axis=0), rows]
        proved = np.asarray(holds.any(axis=0))
        error_bound = bound[best, rows]
        isolation = np.where(proved[:, None], isolation, 0.0)
        return Radii(
            holds=proved,
            existence_radius=(error_bound / weights).max(axis=1, initial=0.0),
            uniqueness_radius=(isolation / weights).min(axis=1, initial=np.inf),
            error_bound=error_bound,
            isolation_radius=isolation,
        )

    def _errors(self, box: Array) -> tuple[Array, BoolArray]:
        """e (B, n) over boxes (B, N), and whether there is at most one solution in each, (B,)."""
        n = self.matrix.shape[1]
        w, known = box[:, :n], box[:, n:]
        centre, spread = self.slopes(box)
        own = np.abs(np.eye(n) - centre[:, :, :n]) + spread[:, :, :n]
        shift = self.residual + matrix_vector((np.abs(centre) + spread)[:, :, n:], known)
        moved = PROOF_SLACK * matrix_vector(own, w)
        error = PROOF_SLACK * (shift + moved)  # eq. (33a)
        alone, inside = (np.asarray((size < w).all(axis=1)) for size in (moved, error))
        # the solution lies within e, so that the same bound holds with e for w
        closer = PROOF_SLACK * (shift + PROOF_SLACK * matrix_vector(own, error))
        return np.where(inside[:, None], np.minimum(closer, error), error), alone


def excluded(system: System, v: Array) -> float:
    """The largest tried distance from a position v (N,), weighted, within which F has no zero for
    the same known variables; 0 if that is proved for none.
    """
    n = system.unknowns
    box = np.zeros((len(_SIZES), len(v)))
    box[:, :n] = _SIZES[:, None] * system.variable_scale[:n]
    low, high = system.enclosure(np.tile(v, (len(_SIZES), 1)), box)[0]
    without = ((low > 0.0) | (high < 0.0)).any(axis=1)
    return float(_SIZES[without].max(initial=0.0))
