"""The start position: Newton-Raphson from the guess at its input value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.status import Status
from linkwork.motion import failure as why
from linkwork.motion.model import Model
from linkwork.numerics.newton import NewtonOptions, Watch
from linkwork.numerics.proof.position_proof import roots_proved
from linkwork.results.failure import Failure
from linkwork.results.position import NewtonStep, NewtonTrail
from linkwork.results.quantity import Kind

__all__ = ["Start", "first_position"]


@dataclass(frozen=True, kw_only=True)
class Start:
    """A solved (or failed) first position: variables (N,), evidence and the iterates.

    ``failure`` explains why there is none.
    """

    v: Array
    status: Status
    message: str
    iterations: int
    residual: float
    trails: tuple[NewtonTrail, ...]
    failure: Failure | None = None


def first_position(
    model: Model,
    inputs: Array,
    options: NewtonOptions,
    with_steps: bool = False,
    *,
    explained: bool = True,
) -> Start:
    """Newton-Raphson from the guess with the given input values (p,), internal units.

    Explaining why there is no position takes many times longer than looking for it.
    """
    solver = model.compiled.solver
    v = model.equations.start.copy()
    v[solver.unknowns :] = inputs
    watchers = [_Watcher(model, k) for k in range(len(solver.blocks))]
    watches: list[Watch | None] | None = list(watchers) if with_steps else None
    done = solver.solve(v[None, :], options, watches)
    status = Status.of_code(int(done.status[0]))
    failure = None
    if not status.ok and explained:
        status, failure = why.no_position(model, v, status, int(done.failed_block[0]), options)
    if status.ok and not roots_proved(solver, done.v)[0]:
        status = Status.ROOT_NOT_PROVED
        if explained:
            failure = why.root_not_proved(model, v, done.v[0], options)
    trails = []
    for k, watcher in enumerate(watchers):
        if watcher.steps:
            failed = k == done.failed_block[0]
            code = int(done.status[0]) if failed else Status.CONVERGED.code
            trails.append(watcher.trail(Status.of_code(code)))
    return Start(
        v=done.v[0],
        status=status,
        message=status.value if failure is None else failure.message,
        iterations=int(done.iterations[0]),
        residual=float(done.residual[0]),
        trails=tuple(trails),
        failure=failure,
    )


class _Watcher:
    """Notes the iterates of one block in file units."""

    def __init__(self, model: Model, number: int) -> None:
        self.block = model.compiled.solver.blocks[number]
        labels, loops = model.equations.labels, len(model.equations.loops)
        self.equations = tuple(labels[e] for e in self.block.equations)
        closed = [labels[e] for e in self.block.equations if e < loops]
        others = (labels[e] for e in self.block.equations if e >= loops)
        # the parts of all loops, then the equations that are real themselves
        self.rows = (*(f"{name}, {part}" for part in "xy" for name in closed), *others)
        self.variables = [model.equations.unknowns[k] for k in self.block.unknowns]
        self.scales = [model.units.scale(Kind(v.kind)) for v in self.variables]
        self.steps: list[NewtonStep] = []

    def __call__(self, k: int, v: Array, residual: Array, change: Array | None) -> None:
        n = len(self.variables)
        weights = self.block.system.variable_scale[:n]
        jacobian = self.block.system.jacobian(v[:1])[0, :, :n]
        self.steps.append(
            NewtonStep(
                k=k,
                unknowns=self._named(v[0, :n]),
                residual=float(np.linalg.norm(residual[0])),
                step=None if change is None else float(np.abs(change[0] / weights).max()),
                values=tuple(residual[0].tolist()),
                jacobian=tuple(map(tuple, jacobian.tolist())),
                changes={} if change is None else self._named(change[0]),
            )
        )

    def _named(self, values: Array) -> dict[str, float]:
        """Values of the unknowns (n,) by name, in file units."""
        triples = zip(self.variables, values, self.scales, strict=True)
        return {variable.name: float(value / scale) for variable, value, scale in triples}

    def trail(self, status: Status) -> NewtonTrail:
        """The iterates with how they ended."""
        return NewtonTrail(
            equations=self.equations, rows=self.rows, steps=tuple(self.steps), status=status
        )
