"""The tracker of solution paths: compiled where that saves time, else in batches of NumPy."""

from __future__ import annotations

from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.sharing import cores
from linkwork.kernels.paths.path_kernel import PathKernel
from linkwork.marching.solution_path import PathOptions
from linkwork.numerics.homotopy.parameter_path import (
    ParameterPath,
    ParametrizedSystem,
    StraightHomotopy,
    Tracker,
)
from linkwork.numerics.homotopy.path_tracking import Paths

__all__ = ["CompiledTracker"]

_KERNELS: dict[ParametrizedSystem, PathKernel] = {}


class CompiledTracker:
    """Follows solution paths in the lanes of compiled code, on all cores."""

    def __init__(self, threads: int | None = None) -> None:
        self.threads = threads or cores()

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        kernel = _KERNELS.get(path.system)
        if kernel is None:
            kernel = _KERNELS[path.system] = PathKernel(StraightHomotopy(path.system))
        w, near, state, attempts = kernel.follow(path.ends, start, options, self.threads)
        return Paths(w=w, near=near, state=state, steps=int(attempts.max(initial=0)))
