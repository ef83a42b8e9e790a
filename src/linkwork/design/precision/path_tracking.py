"""The tracker of solution paths: compiled where that saves time, else in batches of NumPy.

NumPy steps all paths of a batch at once, and a round takes nearly as long for one path as for many:
of paths that creep towards infinity, rounds tell the cost, not their number.
"""

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
    QUICK,
    SURE,
    ParameterPath,
    ParametrizedSystem,
    StraightHomotopy,
)
from linkwork.numerics.homotopy.path_tracking import Paths, track

__all__ = ["CompiledTracker", "SparingTracker", "compiled_pays"]

# A path takes about 0.3 ms compiled and 2 ms in NumPy, where a round of a batch takes 0.8 ms.
_FEW = 100  # paths: recording a program takes as long in NumPy
_LOADING = 500  # paths in NumPy take as long as loading compiled code,
_COMPILING = 4000  # and these as long as compiling it
_AT_A_TIME = 400  # compiled, between reports
_ROUND = 0.4  # paths in NumPy: the least time of a round
_KERNELS = dict[ParametrizedSystem, "paths.PathKernel"]()
_FOLLOWED = [0.0]  # paths that a process has followed in NumPy


class CompiledTracker:
    """Follows solution paths in the lanes of compiled code, on all cores."""

    def __init__(self, threads: int | None = None) -> None:
        self.threads = threads or cores()

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        kernel = _KERNELS.get(path.system)
        if kernel is None:
            kernel = _KERNELS[path.system] = paths.PathKernel(StraightHomotopy(path.system))
        more = SURE if options is QUICK else None
        w, near, state, attempts = kernel.follow(path.ends, start, options, self.threads, more)
        return Paths(w=w, near=near, state=state, steps=int(attempts.max(initial=0)))


class SparingTracker:
    """Follows paths in NumPy until compiled code saves time: asked anew before every batch.

    Parameters
    ----------
    expected : int
        Paths that will be followed, unless some need more care.
    progress : callable, optional
        Called with the finished fraction of each batch; may raise an error to end the work.
    """

    def __init__(self, expected: int, progress: Callable[[float], None] | None = None) -> None:
        self._expected, self._progress = expected, progress

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        if compiled_pays(self._expected):
            return self._compiled(path, start, options)
        found = track(path, start, options, self._progress)
        _FOLLOWED[0] += max(len(start), _ROUND * found.steps)
        return found

    def _compiled(self, path: ParameterPath, start: ComplexArray, options: PathOptions) -> Paths:
        follow, count = CompiledTracker(), math.ceil(len(start) / _AT_A_TIME)
        if self._progress is None or count < 2:
            return follow(path, start, options)
        found = []
        for part in np.array_split(start, count):
            found.append(follow(path, part, options))
            self._progress(len(found) / count)
        return Paths(
            w=np.concatenate([one.w for one in found]),
            near=np.concatenate([one.near for one in found]),
            state=np.concatenate([one.state for one in found]),
            steps=max(one.steps for one in found),
        )


def compiled_pays(expected: int) -> bool:
    """Whether compiled code saves time for this many paths, after those followed in NumPy so far.

    Where there is no Numba, NumPy follows all of them.
    """
    if expected < _FEW or find_spec("numba") is None:
        return False
    if is_loaded(PATH_LOOP):
        return True
    least = _LOADING if is_compiled(PATH_LOOP) else _COMPILING
    return expected + _FOLLOWED[0] >= least
