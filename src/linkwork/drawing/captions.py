"""Names and values as printed in figures."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from linkwork.drawing.scene import text_width
from linkwork.foundation.arrays import Array
from linkwork.foundation.names import pretty
from linkwork.results.motion import Motion
from linkwork.results.quantity import Units

__all__ = [
    "inputs_caption",
    "lead_text",
    "lines_within",
    "printed_formula",
    "printed_name",
    "printed_value",
    "reached_caption",
]

_INDEX = re.compile(r"(?<=[^\W\d_])\d+(?![.\d])")  # after a letter
_SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@lru_cache(maxsize=4096)  # asked for again and again while a dimension is dragged
def printed_name(name: str) -> str:
    """A name as printed in a figure: ``theta12`` → ``θ₁₂``, ``O2.x`` → ``O₂.x``."""
    point, _, axis = name.rpartition(".")
    if point and axis[:1].isalpha():
        return f"{printed_name(point)}.{axis.replace('_', ' ')}"
    shown = pretty(name)
    stem = shown.rstrip("0123456789'")
    return stem + shown[len(stem) :].translate(_SUBSCRIPT) if stem else shown


def printed_formula(text: str) -> str:
    """A formula as printed in a figure: ``(a4 - b4)∠θ14`` → ``(a₄ − b₄)∠θ₁₄``."""
    return _INDEX.sub(lambda found: found[0].translate(_SUBSCRIPT), text).replace("-", "\u2212")


def printed_value(value: float, unit: str, units: Units) -> str:
    """A number with its unit, to six digits: ``60°``, ``100 mm``."""
    sign = units.angle.sign if unit == units.angle.value else f" {unit}"
    shown = value + 0.0  # no negative zero
    return f"{shown:.6g}{sign}".rstrip().replace("-", "\u2212")


def inputs_caption(
    values: Mapping[str, float], input_units: Mapping[str, str], units: Units
) -> str:
    """Input values with units: ``θ₂ = 60°, s = 100 mm``."""
    return ", ".join(
        f"{printed_name(name)} = {printed_value(value, input_units.get(name, ''), units)}"
        for name, value in values.items()
    )


def lines_within(text: str, width: float) -> list[str]:
    """Break a text into lines of at most ``width`` [em]; longer words are broken."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}", 1.0) <= width:
            lines[-1] += f" {word}"
            continue
        lines.append("")
        for letter in word:
            if lines[-1] and text_width(lines[-1] + letter, 1.0) > width:
                lines.append("")
            lines[-1] += letter
    return lines


def lead_text(motion: Motion, row: int) -> str:
    """The leading input at a row: ``148.131°``; with its name if there are several."""
    name, values = _lead(motion)
    text = printed_value(float(values[row]), motion.input_units[name], motion.units)
    return f"{printed_name(name)} = {text}" if len(motion.inputs) > 1 else text


def reached_caption(motion: Motion) -> str:
    """The ranges of the leading input in which positions were found: ``0° to 149.6°, 201.3° to
    360°``.

    Rows that were not found leave a gap; branches reached only around the circuit are omitted.
    """
    name, values = _lead(motion)
    home = {branch for branch, asked in zip(motion.branch, motion.asked, strict=True) if asked}
    rows = np.flatnonzero(motion.found & np.array([branch in home for branch in motion.branch]))
    runs = np.split(values[rows], np.flatnonzero(np.diff(rows) > 1) + 1)
    stretches: list[tuple[float, float]] = []
    for low, high in sorted((float(run.min()), float(run.max())) for run in runs):
        if stretches and low <= stretches[-1][1]:
            low, before = stretches.pop()
            high = max(high, before)
        stretches.append((low, high))
    shown = [
        [printed_value(end, motion.input_units[name], motion.units) for end in stretch]
        for stretch in stretches
    ]
    text = ", ".join(low if low == high else f"{low} to {high}" for low, high in shown)
    return f"{printed_name(name)} {text}" if len(motion.inputs) > 1 else text


def _lead(motion: Motion) -> tuple[str, Array]:
    """The first input that varies."""
    return next(
        ((name, values) for name, values in motion.inputs.items() if np.ptp(values[motion.asked])),
        next(iter(motion.inputs.items())),
    )
