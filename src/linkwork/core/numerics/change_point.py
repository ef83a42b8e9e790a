"""The extended system of a crossing of two branches, and the tangents of both.

At a crossing D = [J, F_t] loses rank: a left null vector w has wᵀJ = 0 and wᵀF_t = 0. The system

    F(x, t) + β c = 0,   J(x, t)ᵀ w = 0,   wᵀF_t(x, t) = 0,   wᵀw = 1

for (x, t, β, w), with a fixed vector c near w, is regular at a simple crossing, where β = 0
(Griewank & Reddien 1984, SIAM J. Numer. Anal. 21). With a basis z1, z2 of D's null space the
crossing tangents a z1 + b z2 solve A a² + 2 B ab + C b² = 0 with A = wᵀD²F[z1, z1],
B = wᵀD²F[z1, z2], C = wᵀD²F[z2, z2].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, Array, IndexArray
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Node, predict
from linkwork.core.numerics.decomposition import JoinedBlocks, closure_of
from linkwork.core.numerics.newton import SmallSystem, System

_STEPS = 12


@dataclass(frozen=True)
class KnownJet:
    """The motion of the known variables of some equations: y, y', y'' by t, (p,) each."""

    at: Callable[[float], tuple[Array, Array, Array]]

    @classmethod
    def along(cls, path: InputPath) -> KnownJet:
        """The inputs on a path."""
        return cls(lambda t: (path.at(t), path.rate, np.zeros_like(path.rate)))

    @classmethod
    def resting(cls, y: Array, first: Array, second: Array) -> KnownJet:
        """The same y, y', y'' whatever t is asked for."""
        return cls(lambda t: (y, first, second))


class CrossingSystem:
    """The extended system of some equations, in scaled variables and equations."""

    def __init__(self, system: SmallSystem, known: KnownJet) -> None:
        self.system, self.known = system, known
        self.n = system.unknowns
        self.weights = system.variable_scale[: self.n]
        self.scale = system.equation_scale

    def _at(self, x: Array, t: float) -> tuple[Array, Array, Array]:
        """v (1, N), scaled unit steps of the unknowns and of t, (n + 1, N), and y'' (p,)."""
        y, first, second = self.known.at(t)
        basis = np.zeros((self.n + 1, self.n + len(y)))
        basis[: self.n, : self.n] = np.diag(self.weights)
        basis[self.n, self.n :] = first
        return np.concatenate([x, y])[None, :], basis, second

    def linear(self, x: Array, t: float) -> tuple[Array, Array]:
        """F (n,) and D (n, n + 1), scaled."""
        v, basis, _ = self._at(x, t)
        f, jacobian = self.system.residual_and_jacobian(v)
        d = jacobian[0] @ basis.T / self.scale[:, None]
        return f[0] / self.scale, d

    def bend(self, x: Array, t: float, w: Array) -> Array:
        """wᵀD²F over all pairs of scaled unit steps, (n + 1, n + 1)."""
        v, basis, second = self._at(x, t)
        matrix: Array = basis @ self.system.hessians(v[0], (w / self.scale)[None, :])[0] @ basis.T
        if second.any():  # known variables that do not move at a constant rate
            slope = self.system.residual_and_jacobian(v)[1][0, :, self.n :]
            matrix[self.n, self.n] += float(w @ (slope @ second / self.scale))
        return matrix

    def solve(self, x: Array, t: float) -> tuple[Array, float, Array, float, float] | None:
        """(x, t, w, β) and the last change of t, by Newton-Raphson."""
        n = self.n
        _, d = self.linear(x, t)
        w = np.linalg.svd(d)[0][:, -1]
        # the left singular vector of the smallest singular value is near the null vector
        c, beta, error = w.copy(), 0.0, np.inf
        for _ in range(_STEPS):
            f, d = self.linear(x, t)
            h = self.bend(x, t, w)
            matrix = np.zeros((2 * n + 2, 2 * n + 2))
            matrix[:n, : n + 1] = d  # derivatives of eq. (41): rows F + β c, columns x, t, β, w
            matrix[:n, n + 1] = c
            matrix[n : 2 * n + 1, : n + 1] = h  # rows Dᵀw
            matrix[n : 2 * n + 1, n + 2 :] = d.T
            matrix[2 * n + 1, n + 2 :] = 2.0 * w  # row wᵀw
            right = np.concatenate([f + beta * c, d.T @ w, [w @ w - 1.0]])  # eq. (41)
            try:
                change = -np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(change).all():
                return None
            x = x + change[:n] * self.weights
            t = t + float(change[n])
            beta += float(change[n + 1])
            w = w + change[n + 2 :]
            last, error = error, abs(float(change[n]))
            # the change of t no longer shrinks: rounding is all that is left
            if error <= 2.0 * EPSILON * max(1.0, abs(t)) or (error >= last and last < 1e-10):
                break
        return x, t, w, beta, error

    def tangents(self, x: Array, t: float, w: Array) -> tuple[Array, ...] | None:
        """The directions of both branches in scaled unknowns and t, (n + 1,) each."""
        _, d = self.linear(x, t)
        null = np.linalg.svd(d)[2][-2:]
        h = self.bend(x, t, w)
        a, b, c = null[0] @ h @ null[0], null[0] @ h @ null[1], null[1] @ h @ null[1]  # eq. (42)
        square = b * b - a * c
        # complex tangents: an isolated point, no crossing of real branches
        if square <= 0.0:
            return None
        root = np.sqrt(square)
        # the two roots (p : q) of a p² + 2 b p q + c q², without cancellation
        q = -(b + np.copysign(root, b))
        pairs = ((q, a), (c, q)) if q != 0.0 else ((1.0, 0.0), (0.0, 1.0))
        return tuple(p * null[0] + r * null[1] for p, r in pairs)


# ----------------------------------------------------------------------
# Locating the change point at which two branches cross, and the blocks that may have one.


_DRIVEN = 2e-13  # relative: how well a crossing is located if earlier blocks cross too
_SHARES = 17  # steps in which rates are moved across a kink
_FAR = 1e-3  # ratio of a block's singular values from which on it is far from a singular position
_UNFOLDED = 1e-13  # |β| beyond which the branches pass each other without touching


@dataclass(frozen=True, kw_only=True, eq=False)
class ChangePoint:
    """A crossing of two branches on a path.

    ``t`` with ``bracket``; ``v`` (N,) the position; ``onward`` and ``other`` (N,): derivative by t
    of the branch that was followed and of the branch that crosses it (NaN if t is constant on it);
    ``directions`` (2, N): both as weighted unit vectors, zero where a block takes no part;
    ``block`` the number of the block that becomes singular; ``located`` whether it was found to
    rounding.
    """

    t: float
    bracket: tuple[float, float]
    v: Array
    onward: Array
    other: Array
    directions: Array
    block: int
    located: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossing:
    """A change point: parameter with bracket, position (N,), directions of both curves (2, N)."""

    t: float
    v: Array
    directions: Array
    bracket: tuple[float, float]
    located: bool


def locate_change_point(
    solver: BlockSolver, path: InputPath, last: Node, side: float
) -> ChangePoint | None:
    """The change point just beyond a node at which the Jacobian has become nearly singular.

    Parameters
    ----------
    last : Node
        The last node of a track before it ended.
    side : float
        +1 if t was growing, -1 if it was falling.

    Returns
    -------
    ChangePoint or None
        Of the first block in solving order that has one: where several cross at one input, the
        equations of the others lose more than one rank. ``None`` if the branches only come near
        each other, or there is none on that side.
    """
    inputs = solver.variable_scale[solver.unknowns :]
    near = 1e-3 * float(np.min(inputs[path.rate != 0.0] / np.abs(path.rate[path.rate != 0.0])))
    for block, ratio in enumerate(_ratios(solver, last.v)):
        if ratio > _FAR:
            continue
        system = JoinedBlocks(solver, closure_of(solver, block))
        mine = system.order[: system.unknowns]
        known = KnownJet.along(path)
        # the crossing may lie a little before the last node, but not on the other side of it
        found = _locate(system, known, last.v[mine], last.t, last.first[mine])
        if found is None or (found.t - last.t) * side < -1e-3 * near:
            continue
        if not abs(found.t - last.t) <= near / _drive(solver, path, block, last):
            continue
        # second derivatives of other blocks have no bound where these are nearly singular, too
        places = np.stack([last.v + (found.t - last.t) * last.first, predict(last, found.t)])
        places[:, mine], places[:, solver.unknowns :] = found.x, path.at(found.t)
        v = min(places, key=lambda place: float(solver.residual(place[None, :])[0]))
        return _place_point(solver, path.rate, block, mine, v, found)
    return None


def _drive(solver: BlockSolver, path: InputPath, block: int, here: Node) -> float:
    """How fast the known variables of a block move, relative to the inputs; 0.01 to 1.

    Where slow links drive a block, it comes near its crossing long before the input does.
    """
    scale, unknowns = solver.variable_scale, solver.unknowns
    own = solver.blocks[block]
    known = own.variables[len(own.unknowns) :]
    inputs = float(np.abs(path.rate / scale[unknowns:]).max())
    own_rate = float(np.abs(here.first[known] / scale[known]).max(initial=0.0))
    return float(np.clip(own_rate / inputs, 0.01, 1.0))


def locate_crossing(
    solver: BlockSolver, number: int, known: KnownJet, x: Array, t: float, own: Array
) -> ChangePoint | None:
    """The change point of one block, given how everything moves that it takes as known.

    Parameters
    ----------
    number : int
        Of the block.
    known : KnownJet
        Of the block's known variables.
    x, t : (n,), float
        Near it.
    own : (n,)
        Derivatives by t of the branch that is followed.
    """
    block = solver.blocks[number]
    found = _locate(block.system, known, x, t, own)
    if found is None:
        return None
    y, rate, _ = known.at(found.t)
    v = np.full(solver.variables, np.nan)
    v[block.variables] = np.concatenate([found.x, y])
    moving = np.zeros(solver.variables - solver.unknowns)
    inputs = block.variables[len(found.x) :] - solver.unknowns
    moving[inputs[inputs >= 0]] = rate[inputs >= 0]
    return _place_point(solver, moving, number, block.unknowns, v, found)


def at_one_input(a: ChangePoint, b: ChangePoint) -> bool:
    """Whether two crossings are at one input, as far as they are located."""
    return abs(a.t - b.t) <= sum(0.5 * (p.bracket[1] - p.bracket[0]) for p in (a, b))


def is_at(point: ChangePoint, t: float) -> bool:
    """Whether a crossing that other ones drive is at a value of t."""
    low, high = less_sharp(point).bracket
    return low <= t <= high


def less_sharp(point: ChangePoint) -> ChangePoint:
    """A crossing of a block whose known variables have been led across other crossings."""
    low, high = point.bracket
    # its known variables come from a polynomial through solved positions
    more = _DRIVEN * max(1.0, abs(point.t))
    return replace(point, bracket=(low - more, high + more))


def tangents_behind_kink(
    solver: BlockSolver,
    point: ChangePoint,
    before: tuple[Array, Array, Array],
    after: tuple[Array, Array, Array],
) -> tuple[Array, Array] | None:
    """The rates (n,) of both branches, the followed one first, at a kink of the known variables.

    Parameters
    ----------
    point : ChangePoint
        Of a block, at the kink.
    before, after : y, y', y'' (p,) each
        The block's known variables, on both sides of the kink.

    Notes
    -----
    The rates of the known variables are moved from one side to the other in small steps, and both
    tangents with them; where both rest for a moment they are extrapolated.
    """
    block = solver.blocks[point.block]
    weights = block.system.variable_scale[: len(block.unknowns)]
    x = point.v[block.unknowns]
    here = np.stack([part[block.unknowns] / weights for part in (point.onward, point.other)])
    last, slope = 0.0, np.zeros_like(here)
    for share in np.linspace(0.0, 1.0, _SHARES)[1:].tolist():
        y, first, second = (
            (1.0 - share) * a + share * b for a, b in zip(before, after, strict=True)
        )
        crossing = CrossingSystem(block.system, KnownJet.resting(y, first, second))
        w = np.linalg.svd(crossing.linear(x, point.t)[1])[0][:, -1]
        found = crossing.tangents(x, point.t, w)
        if found is None:
            continue  # the known variables rest
        both = np.stack([_rate(z) for z in found])
        if not np.isfinite(both).all():
            return None
        ahead = here + (share - last) * slope
        # the quadratic equation gives its roots in any order: tangents keep to their extrapolation
        if np.abs(both[::-1] - ahead).max() < np.abs(both - ahead).max():
            both = both[::-1]
        slope = (both - here) / (share - last)
        here, last = both, share
    return (here[0] * weights, here[1] * weights) if last == 1.0 else None


@dataclass(frozen=True, kw_only=True, eq=False)
class _Located:
    """A crossing of some equations: ``onward``, ``other`` as scaled directions (n + 1,)."""

    x: Array
    t: float
    error: float
    onward: Array
    other: Array


def _locate(
    system: SmallSystem, known: KnownJet, x: Array, t: float, own: Array
) -> _Located | None:
    """The crossing near (x, t); ``own`` (n,) is the derivative of the branch that is followed."""
    crossing = CrossingSystem(system, known)
    found = crossing.solve(x, t)
    if found is None:
        return None
    x, t, w, beta, error = found
    # β is the gap between two branches that come near each other and do not cross
    tangents = None if abs(beta) > _UNFOLDED else crossing.tangents(x, t, w)
    if tangents is None:
        return None
    mine = own / crossing.weights
    # the branch that was followed has the tangent nearer to its last rates
    onward, other = sorted(tangents, key=lambda z: _distance(_rate(z), mine))
    return _Located(x=x, t=t, error=error, onward=onward, other=other)


def _place_point(
    solver: BlockSolver, rate: Array, block: int, mine: IndexArray, v: Array, found: _Located
) -> ChangePoint:
    """A crossing in the order of the whole; ``mine``: which variables are the equations' own."""
    weights = solver.variable_scale[mine]
    both = (found.onward, found.other)
    onward, other = (_place_in_whole(solver, mine, _rate(z) * weights) for z in both)
    reach = found.error + 4.0 * EPSILON * max(1.0, abs(found.t))
    return ChangePoint(
        t=found.t,
        bracket=(found.t - reach, found.t + reach),
        v=v,
        onward=onward,
        other=other,
        directions=np.stack([_direction(solver, rate, mine, z, weights) for z in both]),
        block=block,
        located=found.error <= 1e-9 * max(1.0, abs(found.t)),
    )


def crossing_near(solver: BlockSolver, path: InputPath, block: int, v: Array) -> float | None:
    """The path's parameter at the change point of a block next to a position v (N,).

    ``None`` if there is none within a hundredth of the natural size of the inputs.
    """
    system = JoinedBlocks(solver, closure_of(solver, block))
    moving = int(np.argmax(np.abs(path.rate)))
    t = float((v[solver.unknowns + moving] - path.origin[moving]) / path.rate[moving])
    found = CrossingSystem(system, KnownJet.along(path)).solve(
        v[system.order[: system.unknowns]], t
    )
    if found is None or abs(found[3]) > _UNFOLDED:
        return None
    near = 1e-2 * float(solver.variable_scale[solver.unknowns + moving] / abs(path.rate[moving]))
    return found[1] if abs(found[1] - t) <= near else None


def _distance(rate: Array, own: Array) -> float:
    gap = float(np.abs(rate - own).max())
    return gap if np.isfinite(gap) else np.inf


def _rate(z: Array) -> Array:
    """The derivative by t along a direction (n + 1,) whose last entry is t's; NaN if t rests."""
    if abs(z[-1]) <= 1e-9 * np.abs(z).max():
        return np.full(len(z) - 1, np.nan)
    rate: Array = z[:-1] / z[-1]
    return rate


def _direction(
    solver: BlockSolver, rate: Array, where: IndexArray, z: Array, weights: Array
) -> Array:
    whole = np.zeros(solver.variables)
    whole[where] = z[:-1] * weights
    whole[solver.unknowns :] = z[-1] * rate
    unit: Array = whole / np.abs(whole / solver.variable_scale).max()
    return unit


def _place_in_whole(solver: BlockSolver, where: IndexArray, values: Array) -> Array:
    whole = np.full(solver.variables, np.nan)
    whole[where] = values
    return whole


def most_singular(solver: BlockSolver, v: Array) -> int | None:
    """The block nearest to a singular position; ``None`` if all are far from it at v (N,)."""
    ratios = [*_ratios(solver, v)]
    if not ratios or min(ratios) > _FAR:
        return None
    return int(np.argmin(ratios))


def singular_blocks(solver: BlockSolver, v: Array, most: float = _FAR) -> list[int]:
    """The blocks that are near a singular position at v (N,): up to this ratio."""
    return [block for block, ratio in enumerate(_ratios(solver, v)) if ratio <= most]


def _ratios(solver: BlockSolver, v: Array) -> Iterator[float]:
    """The smallest singular value of every block, relative to its largest.

    Columns of J are divided by their sizes near by: those of lengths that differ much are no sign
    of a singular position, one that is about to vanish is.
    """
    for block in solver.blocks:
        n = len(block.unknowns)
        system, here = block.system, v[block.variables]
        j = system.jacobian(here[None, :])[0, :, :n]
        # a column that is about to vanish must not be blown up to size 1
        sizes = np.maximum(
            np.abs(j / system.equation_scale[:, None]).max(axis=0), _near(system, here)
        )
        scaled = j / system.equation_scale[:, None] / np.where(sizes > 0.0, sizes, 1.0)
        values = np.linalg.svd(scaled, compute_uv=False)
        yield float(values[-1] / values[0]) if values[0] > 0 else 0.0


def _near(system: System, v: Array) -> Array:
    """How long the columns of J become near v (N,): the largest change by a natural step, (n,)."""
    n = len(system.equation_scale)
    changes = np.abs(system.hessians(v, np.diag(1.0 / system.equation_scale)))
    largest: Array = (changes[:, :n] * system.variable_scale).max(axis=(0, 2))
    return largest


# ----------------------------------------------------------------------
# Where a family of systems begins to have solutions: the fold between none and two.
#
# At a fold F(x, p) = 0 and dF/dx has the left and right null vectors w and z; near it, on the side
# where -2 (wᵀF_p)(p - p0) / wᵀD²F[z, z] > 0, there are two solutions x + a z ± ..., beyond it none.
# The singularity is measured by bordering (Griewank & Reddien 1984, SIAM J. Numer. Anal. 21).


@dataclass(frozen=True, kw_only=True)
class FoldFamily:
    """Systems with a parameter p and the same unknowns; ``inputs`` are their known variables.

    ``low``, ``high``: the systems at two values ``step`` apart, for derivatives by p; they need
    not lie at the p in question, since loops are linear in lengths.
    ``size``: the natural size of a change of p.
    """

    at: Callable[[float], SmallSystem]
    inputs: Array
    low: SmallSystem
    high: SmallSystem
    step: float
    size: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Fold:
    """``p`` and the unknowns ``x`` (n,) at which a solution just exists; ``opens`` is the sign of
    the change of p that gives two. ``checked``: that a solution was found there, a little further.
    """

    p: float
    x: Array
    opens: float
    checked: bool


_MOST_STEPS = 40  # of Newton-Raphson to a solution next to the fold
_MOST_WRITTEN = 15  # steps to the fold, each with equations written again
_LONGEST = 0.5  # weighted: a step is shortened as a whole
_STILL = 1e-13
_FURTHER = 1e-6  # of the parameter's size: how far beyond the fold a solution is sought
_CLOSED = 1e-10
_SOLVED = 1e-13


class _At:
    """The scaled system and its parameter's derivatives at one (x, p)."""

    def __init__(self, family: FoldFamily, x: Array, system: SmallSystem) -> None:
        self.system, inputs = system, family.inputs
        n = self.n = self.system.unknowns
        self.weights = self.system.variable_scale[:n]
        self.scale = self.system.equation_scale
        self.v = np.concatenate([x, inputs])
        self.f, self.j = self._scale(self.system)
        (f_low, j_low), (f_high, j_high) = map(self._scale, (family.low, family.high))
        self.f_p, self.j_p = (f_high - f_low) / family.step, (j_high - j_low) / family.step
        left, _, right = np.linalg.svd(self.j)
        self.w, self.z = left[:, -1], right[-1]

    def _scale(self, system: SmallSystem) -> tuple[Array, Array]:
        f, j = system.residual_and_jacobian(self.v[None, :])
        return f[0] / self.scale, j[0, :, : self.n] * self.weights / self.scale[:, None]

    def bend(self) -> Array:
        """wᵀ D²F[z, d] for every unit direction d, (n,), all scaled."""
        n, weights = self.n, self.weights
        bent: Array = self.system.hessians(self.v, (self.w / self.scale)[None, :])[0, :n, :n]
        return weights * (bent @ (weights * self.z))

    def correction(self) -> Array:
        """The Newton step of (x / weights, p) for F = 0 and g = 0, where g = 0 when J is singular.

        g solves [[J, w], [zᵀ, 0]] [u; g] = [0; 1], with lᵀ its left counterpart; dg = -lᵀ dJ u.
        """
        n = self.n
        bordered = np.zeros((n + 1, n + 1))
        bordered[:n, :n], bordered[:n, n], bordered[n, :n] = self.j, self.w, self.z  # eq. (43)
        unit = np.eye(n + 1)[n]
        right, left = np.linalg.solve(bordered, unit), np.linalg.solve(bordered.T, unit)
        self.z, self.w = right[:n], left[:n]
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n], whole[:n, n] = self.j, self.f_p
        whole[n, :n] = -self.bend()  # eq. (43): dg
        whole[n, n] = -self.w @ self.j_p @ self.z
        step: Array = -np.linalg.solve(whole, np.concatenate([self.f, [right[n]]]))
        return step


def locate_fold(family: FoldFamily, x: Array, p: float) -> Fold | None:
    """The value of p nearest to ``p``, to first order, at which solutions begin to exist.

    Parameters
    ----------
    x : (n,)
        Where the system at ``p`` comes nearest to a solution: Jᵀ F = 0.

    Returns
    -------
    Fold or None
        ``None`` where the parameter does not help: it does not change the gap, or Newton-Raphson
        on the fold does not converge, or ends at a fold beyond which solutions vanish.

    Notes
    -----
    Starts from the first-order estimate δp = -wᵀF / wᵀF_p.
    """
    begin = p
    with np.errstate(all="ignore"):
        try:
            here = _At(family, x, family.at(p))
            slope = float(here.w @ here.f_p) * family.size
            # the length does not change the gap: it is no remedy
            if abs(slope) < 1e-9:
                return None
            p -= float(here.w @ here.f) / slope * family.size
            found = _refine_fold(family, (x, p))
            return None if found is None else _opening(family, begin, *found)
        except (np.linalg.LinAlgError, ValueError):
            return None


def _refine_fold(family: FoldFamily, begin: tuple[Array, float]) -> tuple[Array, float] | None:
    """Newton-Raphson on the fold, until its steps are nearly zero."""
    x, p = begin
    for _ in range(_MOST_WRITTEN):
        here = _At(family, x, family.at(p))
        step = here.correction()
        if not np.isfinite(step).all():
            return None
        size = max(float(np.abs(step[:-1]).max()), abs(float(step[-1])) / family.size)
        # far from the fold the Newton step of a singular system is too long
        step *= min(1.0, _LONGEST / size) if size else 1.0
        x = x + step[:-1] * here.weights
        p += float(step[-1])
        if size <= _STILL * max(1.0, abs(p) / family.size):
            break
    else:
        if size > 1e-9:
            return None
    return x, p


def _opening(family: FoldFamily, begin: float, x: Array, p: float) -> Fold | None:
    """The fold with the side on which solutions exist, and one of them found there."""
    here = _At(family, x, family.at(p))
    if np.abs(here.f).max() > _CLOSED:
        return None
    # solutions have to exist on the side that leads away from the present length
    towards = np.sign(p - begin) or 1.0
    ratio = -2.0 * np.float64(here.w @ here.f_p) / (here.bend() @ here.z)  # eq. (44)
    if not np.isfinite(ratio) or ratio * towards <= 0.0:
        return None
    further = towards * _FURTHER * family.size
    system, inputs = family.at(p + further), family.inputs
    start = x + np.sqrt(ratio * further) * here.z * here.weights  # eq. (44)
    found = _is_solved_from(system, np.concatenate([start, inputs]))
    return Fold(p=p, x=x, opens=float(towards), checked=found)


def _is_solved_from(system: SmallSystem, v: Array) -> bool:
    """Whether Newton-Raphson from v (N,) finds a solution."""
    n, v = system.unknowns, v.copy()
    for _ in range(_MOST_STEPS):
        f, jacobian = system.residual_and_jacobian(v[None, :])
        if np.abs(f[0] / system.equation_scale).max() <= _SOLVED:
            return True
        v[:n] -= np.linalg.solve(jacobian[0, :, :n], f[0])
    return False
