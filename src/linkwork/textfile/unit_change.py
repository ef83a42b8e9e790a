"""Change the units of a mechanism file: convert all numbers, or keep them and name other units."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from linkwork.expression.degrees import Degree
from linkwork.expression.grammar import CONSTANTS, number_end
from linkwork.foundation.errors import InputError
from linkwork.foundation.file_keys import Speed
from linkwork.foundation.units import ANGLES, LENGTHS, conversion, converted
from linkwork.mechanism.description import Description
from linkwork.mechanism.speed import split_speed
from linkwork.textfile.entries import entries
from linkwork.textfile.file_degrees import FileDegrees, Written
from linkwork.textfile.keys import form_of
from linkwork.textfile.text_edits import TextEdits
from linkwork.textfile.toml_text import data_of

__all__ = ["change_units"]


def change_units(edits: TextEdits, *, length: str = "", angle: str = "", convert: bool) -> None:
    """Give a mechanism file another unit of lengths, of angles, or of both.

    Parameters
    ----------
    edits : TextEdits
        The text of a mechanism file.
    length, angle : str
        The new units; empty: as before.
    convert : bool
        Convert every number, so that the mechanism stays as large as it is; otherwise the numbers
        stay, and only the unit has another name.

    Raises
    ------
    InputError
        If a unit has no known size, or with the name of what cannot be converted.

    Examples
    --------
    >>> edits = TextEdits('length = "mm"\\n[lengths]\\n"A B" = 76.2')
    >>> change_units(edits, length="in", convert=True)
    >>> print(edits.text)
    length = "in"
    [lengths]
    "A B" = 3.0
    """
    data = data_of(edits.text, "the text")
    before = {
        "length": str(data.get("length", Description.length)),
        "angle": str(data.get("angle", Description.angle.value)),
    }
    after = {"length": length or before["length"], "angle": angle or before["angle"]}
    if convert:
        _convert(edits, FileDegrees(data), {key: _factor(before[key], after[key]) for key in after})
    for entry in entries(data, form_of(data).keys):
        if isinstance(entry.kind, Speed) and isinstance(entry.given, str):
            split = split_speed(str(edits.get(entry.path)), "", before["length"])
            if split is not None and split[1] == f"{before['length']}/s":
                edits.put(entry.path, f"{split[0].strip()} {after['length']}/s")
    for key, unit in after.items():
        if unit != before[key]:
            edits.put((key,), unit)


def _factor(unit: str, other: str) -> Fraction:
    factor = conversion(unit, other)
    if factor is None:
        known = ", ".join([*LENGTHS, *ANGLES])
        raise InputError(
            f'"{unit}" cannot be converted to "{other}": units of known size are {known}; the '
            "numbers can stay under another unit"
        )
    return factor


def _convert(edits: TextEdits, degrees: FileDegrees, factors: Mapping[str, Fraction]) -> None:
    degrees.check(turned=factors["angle"] != 1)
    for written in degrees.written:
        if isinstance(written.given, str):
            new: float | str = _rewritten(written, degrees, factors)
        else:
            new = converted(written.given, _power(degrees.degree(written), factors))
        if new != written.given:
            edits.put(written.path, f"{new} {written.unit}" if written.unit else new)


def _power(degree: Degree, factors: Mapping[str, Fraction]) -> Fraction | float:
    """The factor of numbers of a degree."""
    found: Fraction | float = Fraction(1)
    for word, exponent in (("length", degree.length), ("angle", degree.angle)):
        power = exponent.numerator if exponent.denominator == 1 else float(exponent)
        found *= factors[word] ** power
    return found


def _rewritten(written: Written, degrees: FileDegrees, factors: Mapping[str, Fraction]) -> str:
    """A formula with its literal numbers converted, otherwise as it was written."""
    text = str(written.given)
    for literal, degree in reversed(degrees.literals(written)):
        factor, start = _power(degree, factors), literal.column - 1
        if factor == 1:
            continue
        if literal.constant:
            end = start + (2 if text.startswith("pi", start) else 1)
            number = CONSTANTS["e" if text[start] == "e" else "pi"]
        else:
            end = number_end(text, start)
            number = float(text[start:end])
        shown = repr(converted(number, factor)).removesuffix(".0")
        text = f"{text[:start]}{shown}{text[end:]}"
    return text
