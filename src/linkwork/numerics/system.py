"""What a numerical method needs to know of a set of equations, and nothing else."""

from __future__ import annotations

from typing import Protocol

from linkwork.foundation.arrays import Array, BoolArray

__all__ = ["System"]


class System(Protocol):
    """Equations F(v) = 0 with v = (unknowns, inputs), batched over the first axis of v (B, N)."""

    @property
    def unknowns(self) -> int:
        """n, the first variables."""

    @property
    def equation_scale(self) -> Array:
        """(m,) what residuals are divided by before they are compared."""

    @property
    def variable_scale(self) -> Array:
        """(N,) weights of the variables."""

    @property
    def turns(self) -> BoolArray:
        """(N,) which variables are angles."""

    def residual(self, v: Array) -> Array:
        """F, (B, m)."""

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, m), and dF/dv, (B, m, N)."""

    def jacobian(self, v: Array) -> Array:
        """dF/dv, (B, m, N)."""

    def second(self, v: Array, d: Array) -> Array:
        """D²F[d, d], (B, m)."""
