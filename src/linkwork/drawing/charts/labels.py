"""Labels of columns in figures: ``θ₁₃ [deg]``, ``ds₁₆/dθ₁₂ [mm/rad]``."""

from __future__ import annotations

from linkwork.drawing.captions import printed_name
from linkwork.foundation.names import pretty
from linkwork.results.quantity import Rate

__all__ = ["axis_label", "printed_unit", "rate_label", "size_label", "with_unit"]

_BY_TIME = {rate: rate.value for rate in Rate if rate.by_time}


def printed_unit(unit: str) -> str:
    """A unit as printed: ``mm/rad^2`` → ``mm/rad²``."""
    return unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")


def with_unit(text: str, unit: str) -> str:
    """``ds₁₆/dθ₁₂ [mm/rad]``; without brackets if there is no unit."""
    return f"{text} [{printed_unit(unit)}]" if unit.replace("^2", "") not in ("", "1/1") else text


def axis_label(name: str, unit: str) -> str:
    """The axis label of a quantity: ``θ₁₃ [deg]``."""
    return with_unit(printed_name(name), unit)


def rate_label(name: str, rate: Rate, driver: str) -> str:
    """A rate of a quantity: ``ds₁₆/dθ₁₂``, ``velocity of s₁₆``; ``driver`` is the input."""
    if rate.by_time:
        return f"{_BY_TIME[rate]} of {printed_name(name)}"
    power = "" if rate.order == 1 else "²"
    return f"d{power}{_term(name)}/d{_term(driver)}{power}"


def size_label(point: str, rate: Rate, driver: str) -> str:
    """The magnitude of a point's rate: ``|velocity of B|``."""
    return f"|{rate_label(point, rate, driver)}|"


def _term(name: str) -> str:
    """A name after the d of a derivative; words are separated by a space."""
    stem = pretty(name).partition(".")[0].rstrip("0123456789'")
    return printed_name(name) if len(stem) == 1 else f" {printed_name(name)}"
