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
        self, parameters: ComplexArray, start: ComplexArray, options: PathOptions, threads: int = 1
    ) -> tuple[ComplexArray, ComplexArray, StatusArray, CountArray]:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0.

        Parameters
        ----------
        parameters : (P,)
            The numbers that all paths share.

        Returns
        -------
        w, near : (B, n)
            Ends, and where singular paths were before them.
        state, attempts : (B,)
            ARRIVED, SINGULAR or LOST, and the steps that were tried.
        """
        count, care = len(start), Care(*(float(x) for x in astuple(options)))
        ends = [np.zeros((count, start.shape[1]), dtype=complex) for _ in range(2)]
        state, attempts = np.full(count, LOST, dtype=np.int8), np.zeros(count, dtype=np.int64)

        def follow_part(part: slice) -> None:
            given = start[part]
            room = PathEnds(*(_as_real(w[part]) for w in ends), state[part].copy(), attempts[part].copy())
            follow_paths(
                self.recorded.program.code, self.recorded.layout, self._workspace(parameters),
                _as_real(given), care,
                room,
            )  # fmt: skip
            for whole, found in zip(ends, room[:2], strict=True):
                whole[part] = np.ascontiguousarray(found.T).view(complex)
            state[part], attempts[part] = room.state, room.attempts

        # neighbours may be equally long: every part takes each so-many-th path
        parts = max(1, min(threads, count // LANES))
        share_out(follow_part, [slice(k, None, parts) for k in range(parts)] if count else [], threads)
        return ends[0], ends[1], state, attempts

    def _workspace(self, parameters: ComplexArray) -> Array:
        recorded = self.recorded
        space = recorded.registers.filled(recorded.program.height, LANES)
        space[recorded.parameters] = np.ascontiguousarray(parameters).view(float)[:, None]
        return space


def _as_real(w: ComplexArray) -> Array:
    """Complex (B, n) as real (2n, B)."""
    return np.ascontiguousarray(np.ascontiguousarray(w).view(float).T)
