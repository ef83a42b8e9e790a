"""Numbers as text: sensible digits, no negative zeros, a dash for what is missing."""

from __future__ import annotations

import math
from collections.abc import Iterable
from decimal import ROUND_FLOOR, Context

__all__ = ["NOTHING", "fixed", "lengths", "rounded_down", "short", "significant"]

_ANGLE_DECIMALS = 6
_LENGTH_DIGITS = 6
#: Printed for a missing number.
NOTHING = "-"


def fixed(value: float, decimals: int = _ANGLE_DECIMALS) -> str:
    """A number with the given decimals, without a negative zero."""
    if not math.isfinite(value):
        return NOTHING
    text = f"{value:.{decimals}f}"
    # rounding -0.0000001 gives "-0.000000"
    return text.lstrip("-") if float(text) == 0 else text


def lengths(values: Iterable[float]) -> list[str]:
    """Lengths with common decimals; the largest has six significant digits."""
    numbers = list(values)
    largest = max((abs(v) for v in numbers if math.isfinite(v)), default=0.0)
    # fixed decimals would show only zeros, or meaningless digits
    if largest and not 1e-6 <= largest < 1e9:
        return [significant(v, _LENGTH_DIGITS) for v in numbers]
    decimals = max(_LENGTH_DIGITS - 1 - _exponent(largest), 0)
    return [fixed(v, decimals) for v in numbers]


def significant(value: float, digits: int = 6, noise: float = 0.0) -> str:
    """A number with the given significant digits; 0 if it is at most ``noise``."""
    if not math.isfinite(value):
        return NOTHING
    if abs(value) <= noise:
        return "0"
    exponent = _exponent(value)
    if -4 <= exponent < max(digits, 7):
        return f"{value:.{max(digits - 1 - exponent, 0)}f}"
    return f"{value:.{digits - 1}e}"


def short(value: float, digits: int = 10) -> str:
    """A number with at most the given significant digits, without trailing zeros."""
    return f"{value:.{digits}g}" if math.isfinite(value) else NOTHING


def rounded_down(value: float, digits: int) -> float:
    """The largest number of so many significant digits that is not above a lower bound."""
    return float(Context(prec=digits, rounding=ROUND_FLOOR).create_decimal_from_float(value))


def _exponent(value: float) -> int:
    """The decimal exponent after rounding to six digits: 2 for 100 and for 99.99999."""
    return int(f"{value:.{_LENGTH_DIGITS - 1}e}".partition("e")[2])
