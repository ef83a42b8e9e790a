"""Classify why Newton-Raphson missed the intended position."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.newton_trouble import NewtonTrouble
from linkwork.foundation.status import Status
from linkwork.motion.failure.other_positions import block_positions, distance, roots_in_block
from linkwork.numerics.block_solver import Block
from linkwork.numerics.least_squares import nearest_miss
from linkwork.numerics.newton import NewtonOptions, newton
from linkwork.numerics.proof.enclosed import excluded

__all__ = ["DoubtfulRoot", "Miss", "doubtful_root", "miss_of", "root_beside_guess", "trouble_of"]

_CLOSED = 1e-10  # scaled residual of a position
_FLAT = 1e-8  # of its natural size: a slope or curvature that is zero
_SHRINKS = 0.4  # ratio of steps from which on a root may be multiple: 1/2 for a double one
_HIGHEST_ORDER = 100  # of a root that steps are taken to lead to
_ASIDE = 0.5  # of the way from the root to the guess, where the bending is compared


@dataclass(frozen=True, kw_only=True, eq=False)
class Miss:
    """Where a damped iteration ends: ``v`` in the block's order, unscaled residuals ``f`` (m,),
    ``closed`` if that is a position after all.
    """

    v: Array
    f: Array
    closed: bool

    @property
    def known(self) -> bool:
        """Whether the equations have values there."""
        return bool(np.isfinite(self.f).all())


def miss_of(block: Block, v: Array) -> Miss:
    """The block as near to closure as a damped iteration from v (N,) gets."""
    nearest, f = nearest_miss(block.system, v[block.variables])
    closed = np.isfinite(f).all() and np.abs(f / block.system.equation_scale).max() <= _CLOSED
    if closed and block.system.is_enclosed:
        closed = roots_in_block(block, nearest[None, :])[0]
    return Miss(v=nearest, f=f, closed=bool(closed))


@dataclass(frozen=True, kw_only=True, eq=False)
class DoubtfulRoot:
    """Formulas that are small where no root is proved: ``f`` (m,) unscaled.

    ``free``: half width (n,) of a box without a root, 0 if none is known. ``order`` of a multiple
    root as the last steps of Newton-Raphson suggest, 0 if they do not; it would be at about
    ``away`` (n,).
    """

    f: Array
    free: Array
    order: int
    away: Array


def doubtful_root(block: Block, start: Array, found: Array, options: NewtonOptions) -> DoubtfulRoot:
    """What is known of a place ``found`` (N,) that Newton-Raphson reached from ``start`` (N,).

    Near a root of order m steps shrink by 1 - 1/m, so that m times the next step leads there.
    """
    n, steps = len(block.unknowns), []
    weights = block.system.variable_scale[:n]

    def watch(_: int, x: Array, residual: Array, change: Array | None) -> None:
        if change is not None:
            steps.append(change[0])

    newton(block.system, start[block.variables][None, :], options, watch)
    order, away = 0, np.zeros(n)
    if len(steps) > 1:
        last, before = (float(np.abs(step / weights).max()) for step in (steps[-1], steps[-2]))
        ratio = last / before
        if _SHRINKS < ratio < 1.0 - 1.0 / _HIGHEST_ORDER:
            order = round(1.0 / (1.0 - ratio))
            away = order * ratio * np.abs(steps[-1])
    here = found[block.variables]
    free = excluded(block.system, here) * weights
    return DoubtfulRoot(
        f=block.system.residual(here[None, :])[0], free=free, order=order, away=away
    )


def trouble_of(
    block: Block, v: Array, status: Status, miss: Miss, options: NewtonOptions
) -> NewtonTrouble | None:
    """Why Newton-Raphson failed on a block from v (N,), where a position exists; ``None``: other.

    - stopped where J is singular: an extremum if F lies across the range of J and bends there,
      else a singular derivative;
    - the damped iteration is held where Jᵀ F = 0, F ≠ 0: a local extremum;
    - it finds a root near which the equations bend both ways, and Newton's steps grew: an
      inflection.
    """
    iterates: list[Array] = []
    sizes: list[float] = []
    n = len(block.unknowns)
    weights = block.system.variable_scale[:n]

    def watch(k: int, x: Array, residual: Array, change: Array | None) -> None:
        iterates.append(x[0].copy())
        if change is not None:
            sizes.append(float(np.abs(change[0] / weights).max()))

    newton(block.system, v[block.variables][None, :], options, watch)
    if status is Status.SINGULAR_JACOBIAN:
        extremum = _is_extremum(block, iterates[-1])
        return NewtonTrouble.LOCAL_EXTREMUM if extremum else NewtonTrouble.SINGULAR_DERIVATIVE
    if not miss.closed:
        return NewtonTrouble.LOCAL_EXTREMUM if miss.known else None
    grew = sum(b > a for a, b in pairwise(sizes))
    # around an inflection Newton-Raphson swings with growing steps
    if 2 * grew > len(sizes) - 1 and _bends_both_ways(block, miss.v, v[block.variables]):
        return NewtonTrouble.INFLECTION
    return None


def _is_extremum(block: Block, v: Array) -> bool:
    """Whether |F| is stationary at v (N,) and bends along the null direction of J."""
    system, n = block.system, len(block.unknowns)
    weights, scale = system.variable_scale[:n], system.equation_scale
    f, jacobian = (part[0] for part in system.residual_and_jacobian(v[None, :]))
    r, j = f / scale, jacobian[:, :n] * weights / scale[:, None]
    if not (np.isfinite(r).all() and np.isfinite(j).all()):
        return False
    size = float(np.linalg.norm(r))
    # at a singular J that is no extremum F has a part within the range of J
    if not size or np.linalg.norm(j.T @ r) > _FLAT * size:
        return False
    _, _, right = np.linalg.svd(j)
    direction = np.zeros_like(v)
    direction[:n] = right[-1] * weights
    bend = system.second_directional_derivative(v[None, :], direction[None, :])[0] / scale
    return bool(abs(r @ bend) > _FLAT * size)


def _bends_both_ways(block: Block, root: Array, guess: Array) -> bool:
    """Whether J⁻¹ D²F[d, d] points to opposite sides before and after the root on the line d."""
    system, n = block.system, len(block.unknowns)
    d = np.zeros_like(root)
    d[:n] = guess[:n] - root[:n]
    sides = np.stack([root + _ASIDE * d, root - _ASIDE * d])
    bends = system.second_directional_derivative(sides, np.stack([d, d]))
    try:
        inverse = np.linalg.inv(system.jacobian(root[None, :])[0, :, :n])
    except np.linalg.LinAlgError:
        return False
    before, behind = (inverse @ bend / system.variable_scale[:n] for bend in bends)
    return bool(before @ behind < 0.0)


def root_beside_guess(block: Block, guess: Array, found: Array) -> Array | None:
    """The position (n,) that was meant where another one was found; ``None`` if it was found.

    A root was passed over if det J has another sign at the root found than at the guess, and one
    with the guess's sign lies nearer to the guess. Both ``guess`` and ``found`` (N,) hold the
    known variables as solved.
    """
    n = len(block.unknowns)
    ends = np.stack([guess[block.variables], found[block.variables]])
    weights, scale = block.system.variable_scale[:n], block.system.equation_scale
    slopes = block.system.jacobian(ends)[:, :, :n] * weights / scale[:, None]
    # divided by the size of J, so that the limit of flatness has no unit
    with np.errstate(all="ignore"):  # J may vanish or overflow: then it has no sign
        signs = np.linalg.det(slopes) / np.linalg.norm(slopes, axis=(1, 2)) ** n
    if not (np.abs(signs) > _FLAT).all() or signs[0] * signs[1] > 0.0:
        return None
    others, _ = block_positions(block, guess)
    start = guess[block.unknowns]
    reached = distance(block, start, found[block.unknowns])
    for x in sorted(others, key=lambda x: distance(block, start, x)):
        if distance(block, start, x) >= reached * (1.0 - 1e-9):
            return None
        there = guess[block.variables].copy()
        there[:n] = x
        if np.linalg.det(block.system.jacobian(there[None, :])[0, :, :n]) * signs[0] > 0.0:
            return np.asarray(x)
    return None
