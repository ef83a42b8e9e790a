"""Former public functions for transmission angles, kept at their former path until version 0.4."""

from __future__ import annotations

from collections.abc import Mapping
from warnings import warn

from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict
from linkwork.mechanism.dyad import Dyad, dyads_of
from linkwork.results.motion import Motion

__all__ = ["dyad_angle", "transmission_angles"]


def transmission_angles(motion: Motion) -> Mapping[Dyad, Array]:
    """The transmission angle of every dyad, (N,) [rad]; ``motion["B.transmission"]`` is it now."""
    return FrozenDict({dyad: dyad_angle(motion, dyad) for dyad in dyads_of(motion.skeleton)})


def dyad_angle(motion: Motion, dyad: Dyad) -> Array:
    """The transmission angle of one dyad, (N,) [rad]."""
    name = f"{dyad.pin}.transmission"
    message = f'this is now motion["{name}"]; the former function is removed in version 0.4'
    warn(message, DeprecationWarning, stacklevel=2)
    found: Array = motion[name] * motion.units.angle.radians
    return found
