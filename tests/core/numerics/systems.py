"""Small systems for the numerical methods: cubics, and loop tables written by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from linkwork.core.numerics.block_solver import Block, BlockSolver
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LinearRows, PhasorRows
from tests.oracles.four_bar import FourBar

__all__ = ["Cubic", "blocks_of", "four_bar_table", "loop_table", "watt_table"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Cubic:
    """x³ + p x + q = 0 for x; p and q are inputs, so that every lane has its own equation."""

    unknowns: int = 1

    @property
    def equation_scale(self) -> Array:
        return np.ones(1)

    @property
    def variable_scale(self) -> Array:
        return np.ones(3)

    @property
    def is_angle(self) -> npt.NDArray[np.bool_]:
        return np.zeros(3, dtype=bool)

    def residual(self, v: Array) -> Array:
        x, p, q = v.T
        return np.asarray((x**3 + p * x + q)[:, None])

    def exact_residual(self, v: Array) -> tuple[Array, Array]:
        return np.asarray(self.residual(v[None, :])[0]), np.full(1, np.inf)

    def jacobian(self, v: Array) -> Array:
        x, p, _ = v.T
        return np.stack([3 * x**2 + p, x, np.ones_like(x)], axis=1)[:, None, :]

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        return self.residual(v), self.jacobian(v)

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        return np.asarray((6 * v[:, 0] * d[:, 0] ** 2 + 2 * d[:, 0] * d[:, 1])[:, None])

    def hessians(self, v: Array, weights: Array) -> Array:
        x = float(v[0])
        return np.asarray(
            weights[:, :, None] * np.array([[6.0 * x, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        )

    @property
    def single(self) -> None:
        return None

    @property
    def has_curvature_bound(self) -> bool:
        return False

    def curvature(self, v: Array, matrix: Array) -> NoReturn:
        raise NotImplementedError("a cubic bends without bound")

    @property
    def is_enclosed(self) -> bool:
        return False

    def enclosure(self, v: Array, box: Array) -> NoReturn:
        raise NotImplementedError("a cubic is not enclosed")


#: (loop, coefficient, angle variable or None)
Term = tuple[int, complex, int | None]


def loop_table(terms: Sequence[Term], unknowns: int, inputs: int, scale: float) -> LoopTable:
    """Loops of fixed vectors on turning links; every variable is an angle."""
    loops = 1 + max(row for row, _, _ in terms)
    phases = [(t, k) for t, (_, _, k) in enumerate(terms) if k is not None]
    count = unknowns + inputs
    return LoopTable(
        unknowns=unknowns,
        loops=PhasorRows(
            rows=loops,
            variables=count,
            row=np.array([row for row, _, _ in terms], dtype=np.intp),
            coefficient=np.array([c for _, c, _ in terms], dtype=complex),
            length=np.full(len(terms), -1, dtype=np.intp),
            phase_term=np.array([t for t, _ in phases], dtype=np.intp),
            phase_variable=np.array([k for _, k in phases], dtype=np.intp),
            phase_weight=np.ones(len(phases)),
        ),
        linear=LinearRows.none(),
        functions=(),
        equation_scale=np.full(2 * loops, scale),
        variable_scale=np.ones(count),
        is_angle=np.ones(count, dtype=bool),
    )


def four_bar_table(bar: FourBar) -> LoopTable:
    """r2 e^{iθ2} + r3 e^{iθ3} - r4 e^{iθ4} - r1 = 0 for θ3, θ4."""
    terms: list[Term] = [
        (0, bar.r3, 0),
        (0, -bar.r4, 1),
        (0, bar.r2, 2),
        (0, -bar.r1, None),
    ]
    return loop_table(terms, 2, 1, max(bar.r1, bar.r2, bar.r3, bar.r4))


def watt_table(c: npt.NDArray[np.complex128]) -> LoopTable:
    """Two loops that share two links: four angles, one input, from ten complex constants."""
    terms: list[Term] = [
        (0, complex(c[0]), 0),
        (0, complex(c[1]), 1),
        (0, complex(c[2]), 2),
        (0, complex(c[3]), 4),
        (0, complex(c[4]), None),
        (1, complex(c[5]), 1),
        (1, complex(c[6]), 2),
        (1, complex(c[7]), 3),
        (1, complex(c[8]), 4),
        (1, complex(c[9]), None),
    ]
    return loop_table(terms, 4, 1, float(np.abs(c).max()))


def blocks_of(table: LoopTable) -> BlockSolver:
    """The table as one block."""
    n, count = table.unknowns, table.variables
    equations = tuple(range(len(table.pattern())))
    block = Block(
        system=table, equations=equations, unknowns=np.arange(n), variables=np.arange(count)
    )
    return BlockSolver([block], n, count, table.variable_scale)
