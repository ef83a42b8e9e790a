"""Arrays aligned to cache lines, without which vector instructions take a third longer."""

from __future__ import annotations

import math

import numpy as np

from linkwork.foundation.arrays import Array

__all__ = ["allocate_aligned"]

_LINE = 64  # bytes


def allocate_aligned(*shape: int) -> Array:
    """Numbers that are not set, in a C-contiguous array at a multiple of 64 bytes."""
    size = math.prod(shape)
    room: Array = np.empty(size + _LINE // 8 - 1)
    # NumPy aligns to 16 bytes only: skip numbers up to the next line
    first = -room.ctypes.data // 8 % (_LINE // 8)
    return room[first : first + size].reshape(shape)
