"""Transmission angles between the two links of a dyad."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict
from linkwork.mechanism.dyad import Dyad, dyads_of

if TYPE_CHECKING:
    from linkwork.results.motion import Motion

__all__ = ["dyad_angle", "transmission_angles"]


def transmission_angles(motion: Motion) -> Mapping[Dyad, Array]:
    """The transmission angle at the pin of every dyad, row by row, in (0, π) [rad].

    Between two pinned links it is the angle of their arms at the common pin; of a link that moves
    a block, that between the link and the normal of the block's line: a right angle passes on all
    of the force, none of it is passed on at 0 and at π.

    Parameters
    ----------
    motion : Motion
        Of a mechanism with points and links; N rows.

    Returns
    -------
    Mapping[Dyad, array (N,)]
        NaN where there is no position; empty if nothing is a dyad.

    References
    ----------
    H. Alt, Der Übertragungswinkel und seine Bedeutung für das Konstruieren periodischer Getriebe,
    Werkstattstechnik 26 (1932) 61-64.
    """
    return FrozenDict({dyad: dyad_angle(motion, dyad) for dyad in dyads_of(motion.skeleton)})


def dyad_angle(motion: Motion, dyad: Dyad) -> Array:
    """The transmission angle of one dyad, shape (N,) [rad]."""
    pin = motion.trace(dyad.pin)
    one = motion.trace(dyad.arms[0]) - pin
    if dyad.guide is None:
        other = motion.trace(dyad.arms[1]) - pin
    else:
        start, end = (motion.trace(point) for point in dyad.guide.line)
        other = 1j * (end - start)
    found: Array = np.abs(np.angle(one * other.conj()))
    return found
