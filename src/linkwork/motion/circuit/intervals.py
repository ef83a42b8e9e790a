"""Trial input values: one in each interval between neighbouring dead points.

Between them the number of configurations is constant, so each configuration at one value represents
a piece of a circuit over the whole interval.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array

__all__ = ["Interval", "intervals_between"]

#: Input values of one interval, in the order in which they are tried.
Interval = tuple[float, ...]

_PLACES = (0.5, 0.45, 0.62, 0.31)  # of an interval; the middle is the furthest from both ends
_OUTSIDE = (0.5, 0.37, 0.83)  # natural sizes of the input, beyond the outermost values
_INSIDE = 0.2  # of an interval: how far from its ends its sample value lies
_NARROW = 1e-12  # relative width: nothing fits between the ends


def intervals_between(
    cuts: Array, guess: float | None, scale: float, *, turns: bool
) -> list[Interval]:
    """The intervals between cuts (K,), rising, without the one that holds ``guess``.

    Parameters
    ----------
    turns : bool
        Whether the input is an angle, with ``cuts`` from -π to π; a length has two more intervals
        that are open at one side.
    """
    if not len(cuts):
        return []
    if turns:
        # around the circle the last cut is followed by the first one
        ends = [*cuts, cuts[0] + FULL_TURN]
        if guess is not None:
            guess = float(cuts[0] + np.remainder(guess - cuts[0], FULL_TURN))
        return [_inside(a, b) for a, b in _open(ends, guess)]
    found = [_inside(a, b) for a, b in _open(cuts, guess)]
    below = tuple(float(cuts[0] - place * scale) for place in _OUTSIDE)
    above = tuple(float(cuts[-1] + place * scale) for place in _OUTSIDE)
    if guess is None or guess > cuts[0] - _INSIDE * scale:
        found.insert(0, below)
    if guess is None or guess < cuts[-1] + _INSIDE * scale:
        found.append(above)
    return found


def _open(ends: Sequence[float] | Array, guess: float | None) -> Iterable[tuple[float, float]]:
    for a, b in pairwise(ends):
        width = b - a
        if width <= _NARROW * max(1.0, abs(a), abs(b)):
            continue
        # a guess too near to an end may see a double configuration there
        inside = _INSIDE * width
        if guess is None or not a + inside <= guess <= b - inside:
            yield float(a), float(b)


def _inside(a: float, b: float) -> Interval:
    return tuple(a + place * (b - a) for place in _PLACES)
