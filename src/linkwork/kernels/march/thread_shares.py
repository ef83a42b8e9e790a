"""Sharing designs out among threads."""

from __future__ import annotations

from linkwork.kernels.program.interpreter import LANES

__all__ = ["LEAST_LANES", "MOST_DESIGNS", "share_of_threads"]

MOST_DESIGNS = 4096  # designs that one thread works on at a time, at most
LEAST_LANES = 2  # times LANES: designs in a part where threads share them, at least


def share_of_threads(count: int, threads: int) -> list[slice]:
    """Parts of ``count`` designs, each of whole groups of lanes.

    Of several threads each takes half of its share of the designs that are left, so that the last
    parts are small and no thread waits long for the others.
    """
    parts, first = list[slice](), 0
    while first < count:
        size = MOST_DESIGNS
        if threads > 1:
            lanes = -(-(count - first) // (LANES * 2 * threads))
            size = min(MOST_DESIGNS, max(LEAST_LANES, lanes) * LANES)
        parts.append(slice(first, min(first + size, count)))
        first += size
    return parts
