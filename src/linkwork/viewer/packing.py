"""Compact columns of smooth numbers: rounded, differenced, and written as short integers.

A column of a cycle changes slowly from row to row, and its differences even less. Values are
rounded to multiples of a step and differenced; the order that needs the fewest bytes is written as
zigzag integers in groups of seven bits. The front end sums them.
"""

from __future__ import annotations

import base64
import math
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, CountArray
from linkwork.viewer.page_data import PackedColumn

__all__ = ["Pack", "packed", "shortened", "unpressed"]

#: The ``order`` of a column of plain floats of eight or four bytes.
PLAIN, SHORT = -1, -2

_FLOATS = {PLAIN: "<f8", SHORT: "<f4"}
_RATE_DIGITS = 7
_BITS = 34  # relative to the largest value: ten digits
_ORDERS = range(8)
_LARGEST = 2.0**52
_LEAST = -1022  # exponent of two of the smallest number written in full


class Pack(Protocol):
    """An encoding of a column."""

    def __call__(
        self, values: Array, found: BoolArray, *, step: float | None = None, rate: bool = False
    ) -> PackedColumn:
        """The ``found`` rows of a column (N,)."""


def packed(
    values: Array, found: BoolArray, *, step: float | None = None, rate: bool = False
) -> PackedColumn:
    """Pack the ``found`` rows of a column (N,); values that are not finite become gaps.

    Parameters
    ----------
    values : array (N,)
    found : array (N,) of bool
    step : float, optional
        Rounding step; by default ten digits of the largest value.
    rate : bool
        A derivative, which is unbounded near a dead point: seven digits of usual values.
    """
    known = np.isfinite(values[found])
    kept = np.where(known, values[found], 0.0)
    if rate:
        kept, step = _clipped(kept)
    largest = float(np.abs(kept).max(initial=0.0))
    power = math.floor(math.log2(largest)) + 1 - _BITS if largest > 0 else 0
    size = 2.0 ** max(power, _LEAST)
    chosen = size if step is None else step
    whole = np.rint(kept / chosen)
    if np.abs(whole).max(initial=0.0) > _LARGEST / 2 ** max(_ORDERS):
        raise ValueError(f"step {chosen:g} is too fine for values up to {largest:g}")
    order, differences = _smallest(whole.astype(np.int64))
    content = _bytes(differences)
    text = base64.b64encode(content).decode()
    gaps = tuple(np.flatnonzero(~known).tolist())
    return PackedColumn(step=chosen, order=order, content=text, gaps=gaps)


def unpressed(
    values: Array, found: BoolArray, *, step: float | None = None, rate: bool = False
) -> PackedColumn:
    """Pack a column as plain floats: fast and exact."""
    return _plain(values, found, PLAIN)


def shortened(
    values: Array, found: BoolArray, *, step: float | None = None, rate: bool = False
) -> PackedColumn:
    """Pack a column with seven digits, in half the size."""
    return _plain(values, found, SHORT)


def _clipped(kept: Array) -> tuple[Array, float]:
    """Derivatives limited near dead points, and their rounding step."""
    size = np.abs(kept)
    largest = float(size.max(initial=0.0))
    usual = min(largest, 1e3 * float(np.median(size))) if len(kept) else 0.0
    usual = usual or largest
    step = 10.0 ** np.floor(np.log10(usual) - _RATE_DIGITS) if usual else 1.0
    return np.clip(kept, -1e4 * usual, 1e4 * usual), float(step)


def _plain(values: Array, found: BoolArray, order: int) -> PackedColumn:
    own = values if found.all() else values[found]
    with np.errstate(over="ignore"):
        kept = own.astype(_FLOATS[order])
    # larger values are gaps, as those that are not finite
    fitting = np.isfinite(kept)
    if not fitting.all():
        kept[~fitting] = np.nan
    return PackedColumn(step=1.0, order=order, content=base64.b64encode(kept.tobytes()).decode())


def _smallest(whole: CountArray) -> tuple[int, CountArray]:
    """The differences that need the fewest bytes, and their order."""
    best, least, order = whole, _length(whole), 0
    for k in _ORDERS[1:]:
        whole = np.diff(whole, prepend=0)
        length = _length(whole)
        if length < least:
            best, least, order = whole, length, k
        elif k > order + 1:
            break
    return order, best


def _length(whole: CountArray) -> float:
    """The approximate number of bytes of numbers."""
    return float(np.log2(2.0 * np.abs(whole) + 1.0).sum()) / 7 + len(whole)


def _bytes(whole: CountArray) -> bytes:
    """Zigzag: 0, -1, 1, -2, …; then groups of seven bits, the lowest first."""
    left = ((whole << 1) ^ (whole >> 63)).astype(np.uint64)
    groups = []
    while True:
        groups.append((left & np.uint64(0x7F)).astype(np.uint8))
        left = left >> np.uint64(7)
        if not left.any():
            break
    table = np.stack(groups, axis=1)
    # The last nonzero group of a number ends it; the groups before it are marked.
    last = table.shape[1] - 1 - (table[:, ::-1] != 0).argmax(axis=1)
    last[~table.any(axis=1)] = 0
    place = np.arange(table.shape[1])
    table[place < last[:, None]] |= 0x80
    content: bytes = table[place <= last[:, None]].tobytes()
    return content
