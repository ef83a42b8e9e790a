"""The interface between equations and the numerical methods that solve and prove them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from linkwork.foundation.arrays import Array, BoolArray, IndexArray, StatusArray

__all__ = ["Curvature", "QuickRows", "SingleCurvature", "SingleSystem", "SmallSystem", "System"]


class SmallSystem(Protocol):
    """Equations F(v) = 0 with v = (unknowns, inputs), batched over the first axis of v (B, N)."""

    @property
    def unknowns(self) -> int:
        """The number n of unknowns, which are the first variables."""

    @property
    def equation_scale(self) -> Array:
        """(m,) scales that divide residuals before these are compared."""

    @property
    def variable_scale(self) -> Array:
        """(N,) weights of the variables."""

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, m), and dF/dv, (B, m, N)."""


class System(SmallSystem, Protocol):
    """Equations with the further functions that path following and proofs need."""

    @property
    def single(self) -> SingleSystem | None:
        """The same at one position at a time, where that is known."""

    @property
    def is_angle(self) -> BoolArray:
        """(N,) which variables are angles."""

    def residual(self, v: Array) -> Array:
        """F, (B, m)."""

    def exact_residual(self, v: Array) -> tuple[Array, Array]:
        """F at one position v (N,), (m,), with as little rounding as the equations allow, and a
        bound of its error.
        """

    def jacobian(self, v: Array) -> Array:
        """dF/dv, (B, m, N)."""

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """D²F[d, d], (B, m)."""

    def hessians(self, v: Array, weights: Array) -> Array:
        """Second derivatives of K sums of equations at one position v (N,), (K, N, N); ``weights``
        (K, m): the factor of every equation in each sum.
        """

    @property
    def has_curvature_bound(self) -> bool:
        """Whether :meth:`curvature` gives a bound."""

    @property
    def is_enclosed(self) -> bool:
        """Whether :meth:`enclosure` gives bounds."""

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest F, (2, B, m), and dF/dv, (2, B, m, N), over boxes around v (B, N)
        with half widths ``box`` (B, N), with all rounding.
        """

    def curvature(self, v: Array, matrix: Array) -> Curvature:
        """Moduli of the second derivatives multiplied by a matrix (B, n, m)."""


class SingleSystem(Protocol):
    """Equations at one position v (N,), in plain numbers; results are not to be changed."""

    @property
    def unknowns(self) -> int:
        """n."""

    @property
    def variables(self) -> int:
        """N."""

    @property
    def work(self) -> int:
        """Of one evaluation, about the number of products."""

    @property
    def loop_rows(self) -> int:
        """How many of the m equations belong to loops."""

    @property
    def loop_phases(self) -> int:
        """How many of the phases belong to loops; each later one belongs to one sum."""

    @property
    def phases(self) -> Sequence[Sequence[tuple[int, float]]]:
        """Variables and weights of the G phases."""

    @property
    def packed(self) -> tuple[list[int], list[float]] | None:
        """The terms as numbers, for compiled code; ``None`` if it does not know them."""

    @property
    def pairs(self) -> Sequence[tuple[int, int]]:
        """The variable length and the phase of P pairs."""

    def residual(self, v: Sequence[float]) -> list[float]:
        """F, (m,)."""

    def residual_and_jacobian(self, v: Sequence[float]) -> tuple[list[float], list[list[float]]]:
        """F, (m,), and dF/dv, (m, N)."""

    def second_directional_derivative(self, v: Sequence[float], d: Sequence[float]) -> list[float]:
        """D²F[d, d], (m,)."""

    def curvature(self, v: Sequence[float], matrix: Sequence[list[float]]) -> SingleCurvature:
        """As :meth:`System.curvature`."""


class QuickRows(Protocol):
    """Blocks in compiled code, of which rows v (N,) are solved one by one."""

    def solve(
        self, v: Array, max_steps: int, limits: tuple[float, float, float, float, float]
    ) -> tuple[int, int, int, float, float, float]:
        """Newton-Raphson, in place: status, failed block, iterations, residual, first step and
        contraction.

        ``limits``: both tolerances, the largest turn, the correction that has run away, and the
        smallest one of which a ratio is taken.
        """

    def take_rates(
        self, v: Array, first: Array, second: Array, signs: StatusArray, large: float
    ) -> tuple[float, float]:
        """Rates of the unknowns, after those of the inputs, and signs of determinants, in place:
        condition and nearness.

        ``large``: the condition up to which balanced columns are not tried.
        """


class SingleCurvature(Protocol):
    """As :class:`Curvature` at one position."""

    @property
    def phase(self) -> list[list[float]]:
        """(n, G)."""

    @property
    def slide(self) -> list[list[float]]:
        """(n, P)."""

    @property
    def rounding(self) -> list[float]:
        """(m,)."""

    @property
    def jacobian_rounding(self) -> list[list[float]]:
        """(m, N)."""

    @property
    def printing(self) -> list[float]:
        """(n,)."""


class Curvature(Protocol):
    """Second derivatives and rounding, as proofs need them.

    Terms are grouped by phase g and by pairs p of a variable length with a phase.
    """

    @property
    def loop_rows(self) -> int:
        """How many of the m equations belong to loops."""

    @property
    def loop_phases(self) -> int:
        """How many of the phases belong to loops; each later one belongs to one sum."""

    @property
    def phase(self) -> Array:
        """(B, n, G) second derivatives multiplied by the matrix: |coefficients| of the phases."""

    @property
    def slide(self) -> Array:
        """(B, n, P) the same for terms with a variable length, without that length."""

    @property
    def weights(self) -> Array:
        """(N, G) how much each variable turns each phase."""

    @property
    def pair_length(self) -> IndexArray:
        """(P,) the variable length of each pair."""

    @property
    def pair_group(self) -> IndexArray:
        """(P,) the phase of each pair."""

    @property
    def rounding(self) -> Array:
        """(B, m) bounds of the error of computing F."""

    @property
    def jacobian_rounding(self) -> Array:
        """(B, m, N) bounds of the error of computing dF/dv and its products with m numbers."""

    @property
    def printing(self) -> Array:
        """(B, n) bounds of the error of printing the unknowns."""
