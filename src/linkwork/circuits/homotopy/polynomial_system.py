"""Square systems of polynomial equations, as the tracking of their solutions sees them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.circuits.results import PathCount
from linkwork.core.foundation.arrays import ComplexArray, CountArray, solutions

SAME_ROOT = 1e-6  # two solutions are the same one
_POLISH = 12  # steps of Newton's method at most


class PolynomialSystem(Protocol):
    """n equations in n complex unknowns."""

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F, (B, n), and its derivative, (B, n, n), at x (B, n)."""


class ClosureSystem(PolynomialSystem, Protocol):
    """Polynomials that follow from closures, ``left`` (L, K) of U and ``right`` of V."""

    @property
    def left(self) -> ComplexArray: ...

    @property
    def right(self) -> ComplexArray: ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Roots:
    """Isolated solutions of one system, and the outcome of every path.

    Parameters
    ----------
    x : (R, n) complex
        Regular finite solutions.
    multiple : (S, n) complex
        Ends of paths at singular finite solutions, one for each cluster.
    paths, at_infinity, singular, failed : int
        Paths tracked; those that ran to infinity, ended at a singular solution, were lost.
    expected : int
        How many solutions random systems of this structure have.
    sure : bool
        Whether that number was confirmed.
    continuum : bool
        Whether a singular end belongs to a curve of solutions.
    curves : (C, n) complex
        Points on such curves, as far as they are known.
    """

    x: ComplexArray
    multiple: ComplexArray
    paths: int
    at_infinity: int
    singular: int
    failed: int
    expected: int
    sure: bool
    continuum: bool
    curves: ComplexArray

    @property
    def accounted_for(self) -> bool:
        """Whether every path has an end of its own."""
        return self.paths == len(self.x) + self.at_infinity + self.singular and not self.failed

    def counted(
        self, unknowns: tuple[str, ...], real: int, bound: int, theorem: str = ""
    ) -> PathCount:
        """The counts of all ends, and of ``real`` solutions."""
        return PathCount(
            unknowns=unknowns,
            paths=self.paths,
            finite=len(self.x),
            real=real,
            at_infinity=self.at_infinity,
            multiple=self.singular,
            failed=self.failed,
            expected=self.expected,
            bound=bound,
            theorem=theorem,
        )


def polish_roots(system: PolynomialSystem, x: ComplexArray) -> tuple[ComplexArray, CountArray]:
    """Newton's method from x (B, n) until nothing changes; the steps taken, -1 if it failed."""
    x = x.copy()
    steps = np.full(len(x), -1, dtype=np.int64)
    live = np.arange(len(x))
    last = np.full(len(x), np.inf)
    for k in range(_POLISH):
        f, j = system.residual_and_jacobian(x[live])
        change = solutions(j, f[:, :, None])[:, :, 0]
        x[live] -= change
        size = np.abs(change).max(axis=1, initial=0.0)
        size /= 1.0 + np.abs(x[live]).max(axis=1, initial=0.0)
        # no longer quadratic: what remains is rounding
        done = (size <= 1e-13) | ((size <= 1e-8) & (size > 0.25 * last))  # rounding is all
        steps[live[done]] = k + 1
        stay = ~done & np.isfinite(size)
        live, last = live[stay], size[stay]
        if not len(live):
            break
    return x, steps


def distinct_solutions(x: ComplexArray, same: float = SAME_ROOT) -> ComplexArray:
    """The rows of (B, n) without repetitions, first ones kept."""
    kept: list[int] = []
    for k in range(len(x)):
        size = 1.0 + np.abs(x[k]).max()
        if not kept or np.abs(x[kept] - x[k]).max(axis=1).min() >= same * size:
            kept.append(k)
    return x[kept]


def nearest_solution(system: PolynomialSystem, x: ComplexArray, steps: int) -> ComplexArray:
    """Gauss-Newton with the shortest corrections."""
    for _ in range(steps):
        f, jacobian = system.residual_and_jacobian(x[None])
        if not math.isfinite(float(np.abs(f).max())):
            break
        x = x - np.linalg.lstsq(jacobian[0], f[0], rcond=1e-7)[0]
    return x
