"""Mechanical advantage: the force or moment at a part for one at the input, without friction.

Virtual work of forces in balance: Q δx = P δu, so that Q/P = du/dx. Where the part is at rest to
rounding while the input moves, as at the dead centre of a press, it is infinite and has no
derivatives; at dead points of the input, where no such derivative exists, it is NaN.

References
----------
R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, section 6.5.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import BoolArray
from linkwork.foundation.rounding import REST
from linkwork.results.quantities.definition import UNKNOWN, MechanismNames, RowQuantity, Solved
from linkwork.results.quantity import Kind

__all__ = ["MECHANICAL_ADVANTAGE"]


def _parts(names: MechanismNames) -> Mapping[str, Kind]:
    """Links and sliders, or all unknowns where nothing else is named, with what it measures."""
    if not names.lead or names.inputs[names.lead] is Kind.NUMBER:
        return {}
    by_angle = names.inputs[names.lead] is Kind.ANGLE
    other = Kind.PER_LENGTH if by_angle else Kind.LENGTH
    of_angle, of_length = (Kind.NUMBER, other) if by_angle else (other, Kind.NUMBER)
    parts = {*names.links, *names.sliders} if names.links else {*names.unknowns}
    return {
        part: of_angle if kind is Kind.ANGLE else of_length
        for part, kind in names.unknowns.items()
        if part in parts and kind is not Kind.NUMBER
    }


def _advantage(names: MechanismNames, solved: Solved, part: str) -> Jet:
    moved = solved.own(part)
    rests = _rests(names, solved, part, moved)
    value = np.where(rests, np.inf, 1.0 / moved.d1)  # eq. (61)
    rate = np.where(rests, np.nan, -moved.d2 / moved.d1**2)
    return Jet(value, rate, UNKNOWN)


def _rests(names: MechanismNames, solved: Solved, part: str, moved: Jet) -> BoolArray:
    """Whether the rate of a part is 0 to the accuracy of the input and of its own position."""
    reach = 1.0 if names.by == "rad" else np.nanmax(np.abs(solved.own(names.lead).v), initial=0.0)
    size = 1.0 if names.unknowns[part] is Kind.ANGLE else np.abs(moved.v)
    own = size / reach if reach else 0.0
    found: BoolArray = np.abs(moved.d1) <= REST * (reach * np.abs(moved.d2) + own)
    return found


MECHANICAL_ADVANTAGE = (
    RowQuantity(
        word="mechanical_advantage",
        about="its force or moment for one at the input, no friction",
        needs=1,
        of=_parts,
        evaluate=_advantage,
    ),
)
