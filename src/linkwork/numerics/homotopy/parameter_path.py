"""Straight paths between members of a family of polynomial systems F(z; c) = 0.

Almost all complex parameters c have the same number of isolated solutions, and the straight path
from random ones to any others leads to all isolated solutions of the latter with probability one
(Morgan & Sommese 1989, Appl. Math. Comput. 29, 123). The equations are written once, with operators
only: they are computed with arrays here, and recorded for compiled code by
``linkwork.kernels.paths``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.stacked_systems import solutions
from linkwork.marching.solution_path import PathOptions
from linkwork.numerics.homotopy.path_tracking import Paths, relative_size, track

__all__ = [
    "QUICK",
    "SURE",
    "Equations",
    "ParameterPath",
    "ParametrizedSystem",
    "PolishedEnds",
    "StraightHomotopy",
    "Tracker",
    "as_batch",
    "polish_ends",
    "track_in_batches",
]

#: Every unknown has a size of its own: isotropic coordinates differ by powers of ten. Near a
#: singular end corrections are as large as rounding makes them; solutions are polished afterwards.
QUICK = PathOptions(error=1e-2, contraction=0.1, rounding=1e-6, floor=0.1, attempts=1500)
#: The same with more care.
SURE = PathOptions(
    error=1e-3, contraction=0.05, rounding=1e-6, floor=0.1, attempts=5000, smallest=1e-11
)
_POLISH = 8  # steps of Newton's method
_NOISE = 1e-10  # relative: the correction after one so small is rounding
_LINEAR, _SLOW = 0.2, 4  # steps between 0.3 and 0.7 of the one before, so many: no quadratic method
_SETTLED = 1e-6  # relative: the last correction of a solution, also of a nearly singular one

#: F (n), ∂F/∂z (n rows of n) and the change of F with the parameters' rate (n).
Equations = tuple[Sequence[Any], Sequence[Sequence[Any]], Sequence[Any]]


class ParametrizedSystem(Protocol):
    """n polynomial equations in n unknowns z, with parameters c."""

    @property
    def unknowns(self) -> int:
        """n."""

    @property
    def parameters(self) -> int:
        """P."""

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        """The equations, with operators on z (n), c (P) and the rates of c (P) alone."""


@dataclass(frozen=True)
class StraightHomotopy:
    """F(z; (1 - σ) c1 + σ c0), for all c0 and c1: its parameters are both, one after the other."""

    system: ParametrizedSystem

    @property
    def unknowns(self) -> int:
        """n."""
        return self.system.unknowns

    @property
    def parameters(self) -> int:
        """2 P."""
        return 2 * self.system.parameters

    def compute(self, w: Sequence[Any], sigma: Any, parameters: Sequence[Any]) -> Equations:
        """H, ∂H/∂w and ∂H/∂σ."""
        half = self.system.parameters
        goal = parameters[half:]
        rate = [a - b for a, b in zip(parameters[:half], goal, strict=True)]
        c = [b + r * sigma for b, r in zip(goal, rate, strict=True)]
        return self.system.equations(w, c, rate)


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterPath:
    """A straight path from the parameters ``start`` (P,) to ``goal`` (P,)."""

    system: ParametrizedSystem
    start: ComplexArray
    goal: ComplexArray

    @property
    def ends(self) -> ComplexArray:
        """Both, (2P,): the parameters of a :class:`StraightHomotopy`."""
        return np.concatenate([self.start, self.goal])

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H (B, n), ∂H/∂w (B, n, n) and ∂H/∂σ (B, n) at w (B, n), σ (B,)."""
        columns = list(np.ascontiguousarray(w.T))
        homotopy = StraightHomotopy(self.system)
        return as_batch(len(w), homotopy.compute(columns, sigma, self.ends.tolist()))

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F (B, n) and its derivative (B, n, n) of the goal, at x (B, n)."""
        columns, c = list(np.ascontiguousarray(x.T)), self.goal.tolist()
        f, jacobian, _ = as_batch(len(x), self.system.equations(columns, c, [0.0] * len(c)))
        return f, jacobian


def as_batch(count: int, found: Equations) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """M equations of numbers (B,) in n unknowns, some of which may be plain zeros, as arrays."""
    rows, n = len(found[0]), len(found[1][0])
    f, change = (np.empty((rows, count), dtype=complex) for _ in range(2))
    jacobian = np.empty((rows, n, count), dtype=complex)
    for k in range(rows):
        f[k], change[k] = found[0][k], found[2][k]
        for i in range(n):
            jacobian[k, i] = found[1][k][i]
    return f.T.copy(), jacobian.transpose(2, 0, 1).copy(), change.T.copy()


@dataclass(frozen=True, kw_only=True, eq=False)
class PolishedEnds:
    """Ends of paths x (B, n), and whether they are ``regular`` or ``multiple`` solutions, (B,)."""

    x: ComplexArray
    regular: BoolArray
    multiple: BoolArray


class Tracker(Protocol):
    """Follows many solution paths, in NumPy or compiled."""

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""


def track_in_batches(path: ParameterPath, start: ComplexArray, options: PathOptions) -> Paths:
    """The tracker that needs no compiler."""
    return track(path, start, options)


def polish_ends(path: ParameterPath, x: ComplexArray) -> PolishedEnds:
    """Newton's method at the goal from x (B, n), until rounding is all that is left."""
    x, live = x.copy(), np.arange(len(x))
    last, slow = np.full(len(x), np.inf), np.zeros(len(x), dtype=np.int64)
    for _ in range(_POLISH):
        here, before = x[live], last[live]
        f, jacobian = path.residual_and_jacobian(here)
        change = solutions(jacobian, f[:, :, None])[:, :, 0]
        size = relative_size(change, here, QUICK.floor)
        better, rounded = size < before, size <= _NOISE
        # a double solution halves the distance at every step
        slow[live] += better & ~rounded & (np.abs(size - 0.5 * before) < _LINEAR * before)
        x[live[better]], last[live[better]] = (here - change)[better], size[better]
        live = live[better & ~rounded]
        if not len(live):
            break
    multiple = slow >= _SLOW
    return PolishedEnds(x=x, regular=(last < _SETTLED) & ~multiple, multiple=multiple)
