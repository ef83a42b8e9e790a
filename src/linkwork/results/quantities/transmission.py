"""Transmission angles, a measure of the transmission of force at the pin of a dyad.

Between two pinned links it is the angle of their arms at the common pin; between a link and a
block, the angle between the link and the normal of the block's line. All of the force is
transmitted at a right angle, none at 0 and at π.

References
----------
H. Alt, Der Übertragungswinkel und seine Bedeutung für das Konstruieren periodischer Getriebe,
Werkstattstechnik 26 (1932) 61-64.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.foundation.angles import FULL_TURN
from linkwork.results.quantities.definition import MechanismNames, RowQuantity, Solved, folded
from linkwork.results.quantity import Kind

__all__ = ["RECOMMENDED", "TRANSMISSION", "TRANSMISSION_ANGLE"]

#: Recommended angles, 40° to 140° [rad].
RECOMMENDED = (2 * np.pi / 9, 7 * np.pi / 9)


def _pins(names: MechanismNames) -> Mapping[str, Kind]:
    return {dyad.pin: Kind.ANGLE for dyad in names.dyads}


def _angle(names: MechanismNames, solved: Solved, pin: str) -> Jet:
    dyad = next(dyad for dyad in names.dyads if dyad.pin == pin)
    place = solved.place(pin)
    one = (solved.place(dyad.arms[0]) - place).direction()
    if dyad.guide is None:
        other = (solved.place(dyad.arms[1]) - place).direction()
    else:
        # the block passes its force on across its line
        start, end = (solved.place(point) for point in dyad.guide.line)
        other = (end - start).direction() + np.pi / 2
    return folded(one - other, FULL_TURN)  # eq. (57)


TRANSMISSION_ANGLE = RowQuantity(
    word="transmission",
    about="transmission angle at the pin, 0 to half a turn",
    kind=Kind.ANGLE,
    needs=0,
    of=_pins,
    evaluate=_angle,
)
TRANSMISSION = (TRANSMISSION_ANGLE,)
