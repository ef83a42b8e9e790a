"""Rest under friction: which way the loads overcome it, and when."""

from __future__ import annotations

import numpy as np

from linkwork.dynamics.joint_friction import Rubbing
from linkwork.dynamics.reduced_leg import ReducedLeg
from linkwork.foundation.arrays import Array

__all__ = ["release", "starting_directions"]

_LOOKS = 401  # times at which a machine at rest is looked at
_HALVINGS = 60
_ROUNDING = 1e-12  # of the larger acceleration


def starting_directions(leg: ReducedLeg, s: float, times: Array, gain: Array) -> Array:
    """Which way a machine at rest starts at times (B,): 1 or -1, and 0 where friction holds it.

    It starts in a direction if friction against this motion leaves an acceleration along it. That
    is where the effort of the input lies beyond those that hold it: see
    ``crank.effort.backward``.
    """
    assert leg.friction is not None
    here, still = np.full_like(times, s), np.zeros_like(times)
    pulls = [
        leg.acceleration(
            here, still, times, gain,
            Rubbing(direction=way, ways=leg.friction.ways(s, way)),
        )
        for way in (1.0, -1.0)
    ]  # fmt: skip
    forwards, backwards = (np.nan_to_num(pull) for pull in pulls)
    size = _ROUNDING * np.maximum(np.abs(forwards), np.abs(backwards))
    # friction that locks one way leaves the other; both at once is for the larger
    ahead = np.where(forwards > size, forwards, 0.0)
    back = np.where(backwards < -size, -backwards, 0.0)
    found: Array = np.sign(ahead - back)
    return found


def release(leg: ReducedLeg, s: float, t: float, until: float, gain: Array) -> float | None:
    """When a machine at rest starts to move; ``None`` if it does not up to a time.

    Located to rounding between the times that are looked at.
    """
    if "t" not in leg.reduction.names:
        return None
    times = np.linspace(t, until, _LOOKS)
    moves = np.flatnonzero(starting_directions(leg, s, times, gain))
    if not len(moves):
        return None
    if moves[0] == 0:
        return t
    low, high = float(times[moves[0] - 1]), float(times[moves[0]])
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if starting_directions(leg, s, np.array([middle]), gain)[0]:
            high = middle
        else:
            low = middle
    return high
