"""The compiled tracker of one homotopy: it follows solution paths for any parameters."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray, CountArray, StatusArray
from linkwork.foundation.sharing import share_out
from linkwork.kernels.paths.lane_paths import Care, PathEnds, follow_paths
from linkwork.kernels.paths.path_program import Recordable, record_homotopy
from linkwork.kernels.program.interpreter import LANES
from linkwork.marching.solution_path import LOST, PathOptions

__all__ = ["PathKernel"]


class PathKernel:
    """The compiled tracker of one homotopy.

    Parameters
    ----------
    homotopy : Recordable
        Its arithmetic is recorded once.
    """

    def __init__(self, homotopy: Recordable) -> None:
        self.recorded = record_homotopy(homotopy)

    def follow(
        self,
        parameters: ComplexArray,
        start: ComplexArray,
        options: PathOptions,
        threads: int = 1,
        more: PathOptions | None = None,
    ) -> tuple[ComplexArray, ComplexArray, StatusArray, CountArray]:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0.

        Parameters
        ----------
        parameters : (P,)
            The numbers that all paths share.
        more : PathOptions, optional
            For paths that are lost with ``options``.

        Returns
        -------
        w, near : (B, n)
            Ends, and where singular paths were before them.
        state, attempts : (B,)
            ARRIVED, SINGULAR or LOST, and the steps that were tried.
        """
        count = len(start)
        care, second = (Care(*map(float, astuple(given))) for given in (options, more or options))
        w, near = (np.zeros_like(start, dtype=complex) for _ in range(2))
        state, attempts = np.full(count, LOST, dtype=np.int8), np.zeros(count, dtype=np.int64)
        recorded = self.recorded

        def follow_part(part: slice) -> None:
            given = _as_real(start[part])
            ends = PathEnds(
                np.zeros_like(given), np.zeros_like(given),
                np.full(given.shape[1], LOST, dtype=np.int8), np.zeros(given.shape[1], np.int64),
            )  # fmt: skip
            space = self._workspace(parameters)
            follow_paths(recorded.program.code, recorded.layout, space, given, care, second, ends)
            w[part], near[part] = _as_complex(ends.w), _as_complex(ends.near)
            state[part], attempts[part] = ends.state, ends.attempts

        if count:
            # neighbours may be equally long: every part takes each so-many-th path
            parts = max(1, min(threads, count // LANES))
            share_out(follow_part, [slice(k, None, parts) for k in range(parts)], threads)
        return w, near, state, attempts

    def _workspace(self, parameters: ComplexArray) -> Array:
        recorded = self.recorded
        space = recorded.registers.filled(recorded.program.height, LANES)
        space[recorded.parameters] = np.ascontiguousarray(parameters).view(float)[:, None]
        return space


def _as_real(w: ComplexArray) -> Array:
    """Complex (B, n) as real (2n, B)."""
    return np.ascontiguousarray(np.ascontiguousarray(w).view(float).T)


def _as_complex(w: Array) -> ComplexArray:
    """The inverse of :func:`_as_real`."""
    return np.ascontiguousarray(w.T).view(complex)
