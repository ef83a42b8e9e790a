"""Packed columns read back, as the front end reads them."""

from __future__ import annotations

import base64

import numpy as np

from linkwork.app.pages.packing import PLAIN, SHORT
from linkwork.app.pages.page_data import PackedColumn
from linkwork.core.foundation.arrays import Array, BoolArray, CountArray

__all__ = ["unpacked"]

_FLOATS = {PLAIN: "<f8", SHORT: "<f4"}


def unpacked(column: PackedColumn, found: BoolArray) -> Array:
    """The column (N,), NaN where there is no position."""
    content = base64.b64decode(column.content)
    kind = _FLOATS.get(column.order)
    whole = _whole(content) if kind is None else np.frombuffer(content, dtype=kind)
    for _ in range(column.order):
        whole = np.cumsum(whole)
    values, numbers = np.full(len(found), np.nan), whole * column.step
    numbers[list(column.gaps)] = np.nan
    values[found] = numbers
    return values


def _whole(content: bytes) -> CountArray:
    numbers, number, shift = [], 0, 0
    for byte in content:
        number |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            numbers.append((number >> 1) ^ -(number & 1))
            number, shift = 0, 0
    return np.array(numbers, dtype=np.int64)
