"""Newton-Raphson made visible: from any guess, every iterate kept."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.motion.model import Model
from linkwork.motion.positions import target_values
from linkwork.motion.reading import named_series
from linkwork.motion.solving import solve
from linkwork.numerics.block_solver import Block
from linkwork.numerics.newton import NewtonOptions
from linkwork.results.iterates import Iterate, Iterates
from linkwork.results.quantity import Kind

__all__ = ["iterates"]


def iterates(
    model: Model,
    guess: Mapping[str, float] | None = None,
    at: float | Mapping[str, float] | None = None,
    *,
    options: NewtonOptions | None = None,
) -> Iterates:
    """Newton-Raphson from a guess at the asked input values directly, nothing followed.

    Parameters
    ----------
    guess : Mapping[str, number], optional
        Unknowns in everyday units; those left out start where the mechanism's own guess does.
    at : number or Mapping[str, number], optional
        Input value(s) in everyday units; the guess's own if left out.

    Raises
    ------
    UnknownNameError, InputError
        For names that are no unknowns, and values that are no numbers.
    """
    options = options or NewtonOptions()
    model = model.guessed(guess or {})
    position = solve(model, at, from_guess=True, options=options)
    solver = model.compiled.solver
    v = model.equations.start.copy()
    v[solver.unknowns :] = target_values(model, at) * model.input_scale
    seen = [_Seen(block) for block in solver.blocks]
    done = solver.solve(v[None, :], options, list(seen))
    found: list[Iterate] = []
    for watched in seen:
        found += watched.told(model, v)
        v[watched.block.unknowns] = done.v[0, watched.block.unknowns]
    return Iterates(position=position, iterates=tuple(found))


class _Seen:
    """Keeps the iterates of one block: variables (N,), residuals (m,), corrections (n,)."""

    def __init__(self, block: Block) -> None:
        self.block = block
        self.kept: list[tuple[int, Array, Array, Array | None]] = []

    def __call__(self, k: int, v: Array, residual: Array, change: Array | None) -> None:
        self.kept.append(
            (k, v[0].copy(), residual[0].copy(), None if change is None else change[0])
        )

    def told(self, model: Model, start: Array) -> list[Iterate]:
        """The iterates by name; ``start`` (N,) is where all other variables stand."""
        if not self.kept:
            return []
        block, n = self.block, len(self.block.unknowns)
        unknowns = [model.equations.unknowns[k] for k in block.unknowns]
        scales = [model.units.scale(Kind(u.kind)) for u in unknowns]
        x = np.stack([v[:n] for _, v, _, _ in self.kept])
        whole = np.repeat(start[None, :], len(x), axis=0)
        whole[:, block.unknowns] = x
        jacobians = block.system.jacobian(whole[:, block.variables])[:, :, :n]
        points = _points(model, whole)
        weights = block.system.variable_scale[:n]
        return [
            Iterate(
                equations=tuple(model.equations.labels[e] for e in block.equations),
                k=k,
                unknowns={
                    u.name: float(value / scale)
                    for u, value, scale in zip(unknowns, x[row], scales, strict=True)
                },
                residuals=tuple(map(float, residual)),
                norm=float(np.linalg.norm(residual)),
                jacobian=tuple(tuple(map(float, line)) for line in jacobians[row]),
                step=None if change is None else float(np.abs(change / weights).max()),
                points=points[row],
            )
            for row, (k, _, residual, change) in enumerate(self.kept)
        ]


def _points(model: Model, v: Array) -> list[dict[str, tuple[float, float]]]:
    """The points at every row of v (B, N)."""
    none = np.zeros_like(v)
    inputs = v[:, model.compiled.solver.unknowns :] / model.input_scale
    named = named_series(model, v, none, none, inputs, np.ones(len(v), dtype=bool))
    return [
        {p: (float(x.value[row]), float(y.value[row])) for p, (x, y) in named.points.items()}
        for row in range(len(v))
    ]
