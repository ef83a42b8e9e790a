"""What is asked of a whole motion: the least transmission angle, and contact with circles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.mechanism.dyad import Dyad
from linkwork.results.motion import Motion
from linkwork.results.quantities.transmission import TRANSMISSION_ANGLE

__all__ = ["Contact", "LeastAngle", "MotionBounds", "least_in_rows", "nearly_dead"]

#: Below this least transmission angle a design is at a dead point, for all that play allows.
_DEAD = math.radians(0.1)
_LOOKED_AT = math.radians(5.0)  # least angles of rows, between which a smaller one may be


@dataclass(frozen=True, kw_only=True)
class LeastAngle:
    """The least angle is between ``low`` and ``high`` [rad], the angle at the input ``at``."""

    low: float
    high: float
    at: float


@dataclass(frozen=True, kw_only=True)
class Contact:
    """``met``: the side in a circle and the input there, if one is found; ``open``: the interval
    of the input in which contact is not excluded.
    """

    met: tuple[int, float] | None
    open: tuple[float, float] | None


class MotionBounds(Protocol):
    """A motion that is proved between its rows, too; inputs in file units."""

    @property
    def dyads(self) -> tuple[Dyad, ...]:
        """The dyads with a transmission angle, one for each pin."""

    def least_transmission(self, wanted: float) -> LeastAngle:
        """The least transmission angle of all dyads, of which there is at least one, folded to 0 to
        a quarter of a turn; ``wanted``: decide whether it is smaller than this [rad].
        """

    def contact(self, sides: Sequence[tuple[str, str]], circles: Array) -> Contact:
        """Whether sides between two points of a link come into circles.

        Parameters
        ----------
        sides : sequence of (str, str)
        circles : (M, 3)
            x, y, radius [length].
        """


def least_in_rows(motion: Motion) -> float:
    """The least transmission angle of all dyads in the rows that have a position, NaN without one
    [file's angle unit].
    """
    half = motion.units.angle.turn / 2.0
    names = [n for n, a in motion.quantities.derived.items() if a.row is TRANSMISSION_ANGLE]
    # 40° and 140° transmit equally well
    rows = [np.minimum(own, half - own) for own in (motion[n][motion.found] for n in names)]
    return min((float(own.min()) for own in rows if len(own)), default=float("nan"))


def nearly_dead(motion: Motion, whole: MotionBounds | None) -> str:
    """That a motion all but reaches a dead point, in words; "" if its transmission angles are not
    that small.
    """
    unit = motion.units.angle
    least, place = least_in_rows(motion) * unit.radians, ""
    if whole is not None and whole.dyads and least < _LOOKED_AT:
        found = whole.least_transmission(_DEAD)
        lead = motion.quantities.names.lead
        # where smaller angles are not excluded, they count
        least, place = found.low, f" near {lead} = {found.at:.6g} {motion.input_units[lead]}"
        least = found.high if found.high < _DEAD else least
    if not least < _DEAD:
        return ""
    shown = f"{unit.from_radians(least):.2g}{unit.sign}"
    told = (
        f"{shown} or less is not excluded" if place and found.high >= _DEAD else f"down to {shown}"
    )
    return f"nearly a dead point: transmission angle {told}{place}"
