"""Short decimal numbers: 180 instead of 180.00000000000003."""

from __future__ import annotations

__all__ = ["short_number"]

_SAME_NUMBER = 1e-13  # relative: rounding of a few operations


def short_number(value: float) -> float:
    """The value to nine decimals where that is the same number to rounding."""
    short = round(float(value), 9)
    return (
        short + 0.0 if abs(short - value) <= _SAME_NUMBER * max(1.0, abs(value)) else float(value)
    )
