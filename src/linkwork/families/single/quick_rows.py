"""Rows solved one by one in compiled code, from when on that pays."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from importlib.util import find_spec

from linkwork.core.foundation.arrays import Array, IndexArray, StatusArray
from linkwork.core.table.packed_blocks import PackedBlock, pack
from linkwork.families import single
from linkwork.families.compiled.code_cache import LOOPS, SINGLE_LOOP, is_loaded, loop_serves

__all__ = ["QuickRows", "quick_rows"]

# solved blocks: in plain numbers they take as long as to load compiled code,
_LOADING = 30_000
# or to compile it
_COMPILING = 300_000
#: Blocks that were to be solved in this process, until compiled code is loaded or cannot be.
_WORK = {"blocks": 0}
_FAILED: list[Exception] = []


class QuickRows:
    """Blocks that are packed, in compiled code.

    Results equal those of :mod:`linkwork.core.numerics.single_rows`, bit for bit where a machine
    rounds every operation by itself.
    """

    def __init__(self, code: IndexArray, numbers: Array) -> None:
        self._solve_row, self._take_rates = single.solve_row, single.take_rates
        self._code, self._numbers = code, numbers

    def solve(
        self, v: Array, max_steps: int, limits: tuple[float, float, float, float, float]
    ) -> tuple[int, int, int, float, float, float]:
        """Solve all blocks from ``v`` (N,), in place; see :func:`compiled_rows.solve_row`."""
        return self._solve_row(self._code, self._numbers, v, max_steps, *limits)

    def take_rates(
        self, v: Array, first: Array, second: Array, signs: StatusArray, large: float
    ) -> tuple[float, float]:
        """Fill in the rates of the unknowns; see :func:`compiled_rows.take_rates`."""
        own = v.copy()  # which may not be contiguous, or not to be written to
        return self._take_rates(self._code, self._numbers, own, first, second, signs, large)


def quick_rows(blocks: Sequence[PackedBlock], rows: int) -> QuickRows | None:
    """Blocks in compiled code, if that pays after as many rows as a process has solved by now, and
    no block has laws.

    Parameters
    ----------
    rows : int
        Rows of these blocks that have been solved since the last call.
    """
    if _FAILED or not (is_loaded(SINGLE_LOOP) or _pays(rows * len(blocks))):
        return None
    packed = pack(blocks)
    if packed is None:
        return None
    try:
        return QuickRows(*packed)
    except Exception as reason:  # whatever Numba lacks here
        _FAILED.append(reason)
        logging.getLogger("linkwork").warning(
            "compiled code cannot be used here, plain numbers take longer: %s", reason
        )
        return None


def _pays(blocks: int) -> bool:
    """Whether it pays to load, or to compile, code for so many more blocks."""
    _WORK["blocks"] += blocks
    work = _WORK["blocks"]
    if work < _LOADING and not any(map(is_loaded, LOOPS)):
        return False
    serves = loop_serves(SINGLE_LOOP, 0) or work >= _COMPILING
    return serves and find_spec("numba") is not None
