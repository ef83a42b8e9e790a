"""The linear equation between the angles of two wheels in mesh or with a belt."""

from __future__ import annotations

import math
from fractions import Fraction

from linkwork.equations.part_rows import PartRows
from linkwork.foundation.elementwise import choose, leader_value, uniform_value
from linkwork.foundation.lanes import is_batched
from linkwork.foundation.precise import Precise, precise
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.wheel_pair import WheelPair

__all__ = ["ratio", "write"]


# relative: sizes this near to a ratio of small integers have that ratio, since both are rounded
_RATIO = 4.0 * UNIT_ROUNDOFF
_LARGEST = 10_000  # of these integers


def write(pair: WheelPair, key: Key, rows: PartRows) -> None:
    """q (θ2 - θa) ± p (θ1 - θa) = constant, p : q = r1 : r2."""
    numbers = rows.frames.linkage.numbers
    sizes = pair.radii if pair.radii is not None else pair.teeth
    assert sizes is not None
    p, q = ratio(*map(numbers.precise, sizes), whole=pair.teeth is not None)
    p = -p if pair.together else p
    phase = None
    if pair.phase is not None:
        phase = numbers.precise_angle(pair.phase) * q
    first, second = pair.wheels
    turns = [(second, q), (first, p), (pair.arm, -p - q)]
    rows.tie(pair.name, turns, total=phase, measured=("phase", q))


def ratio(
    numerator: float | Precise, denominator: float | Precise, *, whole: bool = False
) -> tuple[float, float]:
    """Two sizes as the smallest integers of their ratio if these exist, otherwise unchanged.

    With integers, whole turns of one wheel give exactly whole turns of the other.
    """
    over = precise(numerator) / precise(denominator)
    first, second = precise(numerator).high, precise(denominator).high
    if is_batched(first) or is_batched(second):
        p, q = ratio(leader_value(first), leader_value(second), whole=whole)
        if q == 1.0 and not whole:
            return uniform_value(over.high), q
        same = abs(q * first - p * second) <= _RATIO * abs(q * first)
        return uniform_value(choose(same, p, math.nan)), q
    if whole:
        fraction = Fraction(int(first), int(second))
    else:
        fraction = Fraction(over.high).limit_denominator(_LARGEST)
    if fraction > 0 and abs(float(fraction) * second - first) <= _RATIO * first:
        return float(fraction.numerator), float(fraction.denominator)
    return over.high, 1.0
