"""The tracker of solution paths: compiled where that saves time, else in batches of NumPy."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np

from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.sharing import cores
from linkwork.kernels import paths
from linkwork.kernels.program.kernel_cache import PATH_LOOP, is_compiled, is_loaded
from linkwork.marching.solution_path import PathOptions
from linkwork.numerics.homotopy.parameter_path import (
    ParameterPath,
    ParametrizedSystem,
    StraightHomotopy,
    Tracker,
    track_in_batches,
)
from linkwork.numerics.homotopy.path_tracking import Paths, track

__all__ = ["CompiledTracker", "ReportingTracker", "tracker_for"]

# A path takes about 0.3 ms compiled and 2 ms in NumPy.
_FEW = 100  # paths: recording a program takes as long in NumPy
_LOADING = 500  # paths in NumPy take as long as loading compiled code,
_COMPILING = 4000  # and these as long as compiling it
_AT_A_TIME = 400  # compiled, between reports
_KERNELS = dict[ParametrizedSystem, "paths.PathKernel"]()
_FOLLOWED = [0]  # paths that a process has asked for


class CompiledTracker:
    """Follows solution paths in the lanes of compiled code, on all cores."""

    def __init__(self, threads: int | None = None) -> None:
        self.threads = threads or cores()

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        kernel = _KERNELS.get(path.system)
        if kernel is None:
            kernel = _KERNELS[path.system] = paths.PathKernel(StraightHomotopy(path.system))
        w, near, state, attempts = kernel.follow(path.ends, start, options, self.threads)
        return Paths(w=w, near=near, state=state, steps=int(attempts.max(initial=0)))


class ReportingTracker:
    """Follows paths by another tracker and reports the finished fraction: compiled code some at a
    time, NumPy after every round.

    ``progress`` may raise an error to end the work.
    """

    def __init__(self, tracker: Tracker, progress: Callable[[float], None]) -> None:
        self._tracker, self._progress = tracker, progress

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        if self._tracker is track_in_batches:
            return track(path, start, options, self._progress)
        if len(start) <= _AT_A_TIME:
            return self._tracker(path, start, options)
        parts = np.array_split(start, math.ceil(len(start) / _AT_A_TIME))
        found = []
        for part in parts:
            found.append(self._tracker(path, part, options))
            self._progress(len(found) / len(parts))
        return Paths(
            w=np.concatenate([one.w for one in found]),
            near=np.concatenate([one.near for one in found]),
            state=np.concatenate([one.state for one in found]),
            steps=max(one.steps for one in found),
        )


def tracker_for(count: int) -> Tracker:
    """The tracker that takes less time for this many paths, and those asked for before.

    Where there is no Numba, NumPy follows all of them.
    """
    _FOLLOWED[0] += count
    if count < _FEW or find_spec("numba") is None:
        return track_in_batches
    if is_loaded(PATH_LOOP):
        return CompiledTracker()
    least = _LOADING if is_compiled(PATH_LOOP) else _COMPILING
    return CompiledTracker() if _FOLLOWED[0] >= least else track_in_batches
