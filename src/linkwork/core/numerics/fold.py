"""Where a family of systems begins to have solutions: the fold between none and two.

At a fold F(x, p) = 0 and dF/dx has the left and right null vectors w and z; near it, on the side
where -2 (wᵀF_p)(p - p0) / wᵀD²F[z, z] > 0, there are two solutions x + a z ± ..., beyond it none.
The singularity is measured by bordering (Griewank & Reddien 1984, SIAM J. Numer. Anal. 21).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.numerics.system import SmallSystem


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
