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


def _driver(names: MechanismNames) -> str:
    """The input that moves the parts: the leading one, or the only one where time leads."""
    return names.driven if names.lead and names.inputs[names.lead] is Kind.TIME else names.lead


def _parts(names: MechanismNames) -> Mapping[str, Kind]:
    """Links and sliders, or all unknowns where nothing else is named, with what it measures."""
    driver = _driver(names)
    own = {**names.unknowns, **names.inputs}.get(driver, Kind.NUMBER)
    if own is Kind.NUMBER:
        return {}
    by_angle = own is Kind.ANGLE
    other = Kind.PER_LENGTH if by_angle else Kind.LENGTH
    of_angle, of_length = (Kind.NUMBER, other) if by_angle else (other, Kind.NUMBER)
    parts = {*names.links, *names.sliders} if names.links else {*names.unknowns}
    return {
        part: of_angle if kind is Kind.ANGLE else of_length
        for part, kind in names.unknowns.items()
        if part in parts and part != driver and kind is not Kind.NUMBER
    }


def _advantage(names: MechanismNames, solved: Solved, part: str) -> Jet:
    moved = solved.own(part)
    if _driver(names) != names.lead:
        return _in_time(names, solved, part, moved)
    rests = _rests(names, solved, part, moved)
    value = np.where(rests, np.inf, 1.0 / moved.d1)  # eq. (61)
    rate = np.where(rests, np.nan, -moved.d2 / moved.d1**2)
    return Jet(value, rate, UNKNOWN)


def _in_time(names: MechanismNames, solved: Solved, part: str, moved: Jet) -> Jet:
    """The same where time leads, from the rates of part and input."""
    driver = solved.own(names.driven)
    # a motion that begins at rest has the ratio of its accelerations
    still = driver.d1 == 0.0
    first = np.where(still, moved.d2, moved.d1) / np.where(still, driver.d2, driver.d1)
    second = np.where(still, 0.0, (moved.d2 - first * driver.d2) / driver.d1**2)
    rests = _rests(names, solved, part, Jet(moved.v, first, second))
    rate = np.where(rests | still, np.nan, -second / first**2 * driver.d1)
    return Jet(np.where(rests, np.inf, 1.0 / first), rate, UNKNOWN)


def _rests(names: MechanismNames, solved: Solved, part: str, moved: Jet) -> BoolArray:
    """Whether the rate of a part is 0 to the accuracy of the input and of its own position."""
    driver = _driver(names)
    angle = {**names.unknowns, **names.inputs}[driver] is Kind.ANGLE
    reach = 1.0 if angle else np.nanmax(np.abs(solved.own(driver).v), initial=0.0)
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
