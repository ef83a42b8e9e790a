"""pylinkage: a four-bar's coupler point through timed points, by each of its optimisers.

The user of pylinkage writes the objective; this one is the fastest that it allows: one call of its
compiled solver on arrays that stay. All ten dimensions vary, and the side of the loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray

__all__ = ["OPTIMISERS", "PathFit", "installed"]

_WIDE = 4.0  # sizes of the path: how far pivots may be from its middle
_SHORT, _LONG = 0.05, 6.0  # sizes: lengths
_FIXED, _ARMS = slice(0, 4), slice(4, 9)


def installed() -> str:
    """The version that is installed; "" if it is not."""
    try:
        return version("pylinkage") if find_spec("pylinkage") else ""
    except PackageNotFoundError:
        return ""


class PathFit:
    """A task: points, and the angle of the crank from one to the next.

    Dimensions: A0, B0, crank, coupler, rocker, distance and angle of P at A, first angle of the
    crank, side of the loop by its sign.
    """

    def __init__(self, points: Sequence[tuple[float, float]], step: float) -> None:
        self.points: ComplexArray = np.array([complex(*point) for point in points])
        self.step, middle = step, complex(self.points.mean())
        size = float(np.abs(self.points - middle).max())
        wide, lengths = _WIDE * size, [(_SHORT * size, _LONG * size)] * 4
        along = (middle.real - wide, middle.real + wide)
        across = (middle.imag - wide, middle.imag + wide)
        turn = (-math.pi, math.pi)
        ranges = [along, across, along, across, *lengths, turn, turn, (-1.0, 1.0)]
        self.bounds = [low for low, _ in ranges], [high for _, high in ranges]
        self.linkage = self._linkage(len(ranges))
        conversion = import_module("pylinkage.bridge.solver_conversion")
        self.data = conversion.linkage_to_solver_data(self.linkage)
        self.simulate: Callable[..., Array] = import_module("pylinkage.solver.simulation").simulate
        self.count = 0

    def _linkage(self, count: int) -> Any:
        pylinkage = import_module("pylinkage")
        a0, b0 = pylinkage.Ground(0.0, 0.0), pylinkage.Ground(4.0, 0.0)
        a = pylinkage.Crank(anchor=a0, radius=1.0, angular_velocity=self.step, initial_angle=0.0)
        b = pylinkage.RRRDyad(anchor1=a, anchor2=b0, distance1=4.0, distance2=3.0, x=3.0, y=3.0)
        p = pylinkage.FixedDyad(anchor1=a, anchor2=b, distance=1.0, angle=0.5)

        class Varied(pylinkage.Linkage):  # type: ignore[misc, name-defined]
            """All dimensions count, not the lengths alone: some optimisers ask for their number."""

            def get_constraints(self) -> list[float]:
                return [0.5] * count

        return Varied([a0, b0, a, b, p])

    def score(self, _linkage: Any, given: Sequence[float], _coordinates: Any) -> float:
        """The sum of squares of the distances; infinite where the loop is open."""
        self.count += 1
        x = [float(value) for value in given]
        a0, b0 = complex(x[0], x[1]), complex(x[2], x[3])
        crank, coupler, rocker, distance, angle, first, side = x[4:]
        # one step before the first row: every step turns the crank first
        a = a0 + crank * complex(math.cos(first - self.step), math.sin(first - self.step))
        base = b0 - a
        away = abs(base)
        if not abs(coupler - rocker) < away < coupler + rocker:
            return math.inf
        along = (away**2 + coupler**2 - rocker**2) / (2.0 * away)
        across = math.copysign(math.sqrt(max(0.0, coupler**2 - along**2)), side)
        b = a + base / away * complex(along, across)
        places, data = (a0, b0, a, b, a), self.data
        data.positions[:, 0] = [place.real for place in places]
        data.positions[:, 1] = [place.imag for place in places]
        data.constraints[:] = (crank, self.step, coupler, rocker, distance, angle)
        rows = self.simulate(
            data.positions, data.constraints, data.joint_types, data.parent_indices,
            data.constraint_offsets, data.solve_order, len(self.points), 1.0,
        )  # fmt: skip
        missed = rows[:, 4, 0] + 1j * rows[:, 4, 1] - self.points
        total = float(np.sum(missed.real**2 + missed.imag**2))
        return total if math.isfinite(total) else math.inf

    def best(self, found: Any) -> float:
        """The score of what an optimiser returns, evaluated anew."""
        return self.score(None, list(np.asarray(found.dimensions).reshape(-1)), None)


def _swarm(fit: PathFit, particles: int, iterations: int) -> Any:
    # draws its own random numbers
    return import_module("pylinkage.optimization").particle_swarm_optimization(
        fit.score, fit.linkage, dimensions=len(fit.bounds[0]), bounds=fit.bounds,
        n_particles=particles, iterations=iterations, order_relation=min, verbose=False,
    )  # fmt: skip


def _scipy(name: str, **settings: Any) -> Callable[[PathFit, int], Any]:
    def run(fit: PathFit, seed: int) -> Any:
        function = getattr(import_module("pylinkage.optimization"), name)
        return function(
            fit.score, fit.linkage, bounds=fit.bounds, order_relation=min, seed=seed,
            verbose=False, **settings,
        )  # fmt: skip

    return run


#: One run of each optimiser, by what it is called in tables.
OPTIMISERS: dict[str, Callable[[PathFit, int], Any]] = {
    "particle swarm, 100 × 200": lambda fit, seed: _swarm(fit, 100, 200),
    "particle swarm, 300 × 600": lambda fit, seed: _swarm(fit, 300, 600),
    "differential evolution": _scipy("differential_evolution_optimization", tol=0.0, atol=0.0),
    "dual annealing": _scipy("dual_annealing_optimization"),
}
