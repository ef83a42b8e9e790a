"""Read typed numbers with units, "3 in" or "30 deg", in the units of the file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from linkwork.app.live.moving_points import Before, put_place
from linkwork.app.live.requests import SetInput, SetNumber
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.values import value
from linkwork.core.foundation.errors import ExpressionError, InputError, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import (
    ANGLES,
    LENGTHS,
    AngleUnit,
    conversion,
    converted,
    split_unit,
)
from linkwork.core.foundation.values import NumberValue
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import VariedNumber, number_named
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.entries import measured_by
from linkwork.design.edits.unit_change import FileDegrees


@dataclass(frozen=True)
class TypedUnits:
    """The units of a file, in which typed numbers are written.

    Parameters
    ----------
    length : str
        The unit of lengths; it may be one of unknown size.
    angle : str
        The unit of angles.
    """

    length: str
    angle: str

    @classmethod
    def of(cls, description: Description) -> TypedUnits:
        """The units of a mechanism."""
        return cls(description.length, description.angle.value)

    def number(self, typed: float | str, kind: str, what: str) -> float | str:
        """A number in the file's unit; a number or formula without a unit stays as it is.

        ``kind``: length, angle, number, or "" if unknown; ``what``: its name in messages.

        Raises
        ------
        InputError
            If the unit is of another kind, or one of unknown size.
        """
        if not isinstance(typed, str):
            return typed
        split = split_unit(typed, [*LENGTHS, *ANGLES, self.length])
        if split is None:
            return typed
        amount, unit = split
        other = "angle" if unit in ANGLES else "length"
        if kind and other != kind:
            names = {"length": self.length, "angle": self.angle}.get(kind, "none")
            noun = "a plain number" if kind == "number" else f"{_article(kind)} {kind}"
            raise InputError(
                f'{what} is {noun}, but "{typed}" is {_article(other)} {other} (unit here: {names})'
            )
        file_unit = self.angle if other == "angle" else self.length
        return converted(_amount(amount, typed), self._factor(unit, file_unit, typed))

    def speed(self, typed: float | str | None) -> float | str | None:
        """A speed in a unit that the file reads: "0.5 m/s" becomes "500 mm/s"."""
        rates = {f"{unit}/s": unit for unit in LENGTHS}
        split = split_unit(typed, rates) if isinstance(typed, str) else None
        if split is None or rates[split[1]] == self.length:
            return typed
        assert isinstance(typed, str)
        factor = self._factor(rates[split[1]], self.length, typed)
        amount = repr(converted(_amount(split[0], typed), factor)).removesuffix(".0")
        return f"{amount} {self.length}/s"

    def _factor(self, unit: str, file_unit: str, typed: str) -> Fraction:
        factor = conversion(unit, file_unit)
        if factor is None:
            raise InputError(
                f'"{typed}" cannot be converted: the unit of this file, "{file_unit}", has no '
                "known size: leave the unit out, or choose another unit for the file"
            )
        return factor


def kind_of_name(name: str, text: TextEdits) -> str:
    """What a named dimension or variable measures: length, angle, number, or "" if unknown."""
    try:
        return FileDegrees(data_of(text.text, "the text")).of_name(name)
    except InputError:  # reported when the file is read
        return ""


def _article(word: str) -> str:
    return "an" if word == "angle" else "a"


def _amount(amount: str, typed: str) -> float:
    """The value of "3", "1/2", "2 1/2" or "3,5"."""
    plain = re.sub(r"^([-+]?\d+),(\d+)$", r"\1.\2", amount)
    plain = re.sub(r"^(\d+)\s+(\d+/\d+)$", r"\1+\2", plain)
    try:
        return value(parse(plain), {}, AngleUnit.DEGREE, plain)
    except ExpressionError:
        raise InputError(
            f'"{typed}" is not a number with a unit, such as "3 in" or "1/2 in": formulas are in '
            "the units of the file and carry none"
        ) from None


# ----------------------------------------------------------------------
# Edits of numbers and ranges in the text of a mechanism file.


#: The kinds of the numbers of tables; formulas determine the rest.
_KINDS = {"lengths": "length", "angles": "angle", "points": "length", "sliders": "length"}
_DRIVES = ("link", "joint", "slider", "cylinder", "variable")
_LENGTHS = ("slider", "cylinder")
_RANGE = {"start": "from", "stop": "to", "step": "step", "speed": "speed"}


def set_number(edit: SetNumber, text: TextEdits, before: Before) -> None:
    """Set a number to a value or formula.

    Raises
    ------
    InputError, UnknownNameError
        If the number does not exist, or the value is of another kind.
    """
    description, units = before.description, TypedUnits.of(before.description)
    try:
        quantity = number_named(description, edit.name)
    except UnknownNameError:
        if (measured := _measured(description, edit.name)) is None:
            raise
        value = units.number(edit.value, "length", f'"{edit.name}"')
        text.put(("lengths", measured), value)
        _stretch(measured, value, text, before)
        return
    value = edit.value
    if isinstance(value, str):
        kind = _KINDS.get(quantity.table) or kind_of_name(quantity.key, text)
        value = units.number(value, kind, f'"{quantity.name}"')
    written = quantity.written(description)
    # a number in place of a formula would silently remove the dependence on dimensions
    if isinstance(written, str) and not isinstance(value, str) and not edit.any_formula:
        raise InputError(
            f'"{quantity.name}" is the formula {written}: change a dimension in '
            "it, or send another formula"
        )
    if quantity.table == "lengths":
        if _move_pivot(quantity, value, text, description):
            return
        _stretch(quantity.key, value, text, before)
    text.put(_path(quantity, text), value)


def _stretch(key: str, length: float | str, text: TextEdits, before: Before) -> None:
    """Give a length to a draft, which is not assembled: its freer end moves in the sketch."""
    draft = before.description
    if not isinstance(draft, Draft) or not draft.problems or isinstance(length, str):
        return
    carriers = draft.drawable.carriers()
    if not set(key.split()) <= carriers.keys():
        return
    fixed, free = sorted(key.split(), key=lambda point: -len(carriers[point]))
    start, end = before.place(fixed), before.place(free)
    if length > 0 and end != start and not any(isinstance(c, str) for c in draft.points[free]):
        put_place(text, free, start + (end - start) / abs(end - start) * length)


def _path(quantity: VariedNumber, text: TextEdits) -> tuple[str | int, ...]:
    """The key path of a number in the text."""
    if quantity.table == "points":
        return ("points", quantity.key, quantity.axis)
    if quantity.table == "sliders":
        names = {canonical(str(row.get("name", ""))): k for k, row in text.entries("sliders")}
        return ("sliders", names[canonical(quantity.key)], "offset")
    return (quantity.table, quantity.key)


def _measured(description: Description, name: str) -> str | None:
    """The key of [lengths] for a named length between sketched points."""
    if not isinstance(description, Draft):
        return None
    points = sorted(map(canonical, name.split()))
    for measured in description.measured:
        if sorted(map(canonical, measured.points)) == points:
            return " ".join(measured.points)
    return None


def _move_pivot(
    quantity: VariedNumber, length: float | str, text: TextEdits, description: Description
) -> bool:
    """Set a distance on ground by moving its second point along the line between the two."""
    assert isinstance(description, Draft)
    first, second = quantity.key.split()
    # a draft may lack the ground, or a point
    fixed = set(description.links.get(GROUND, ())) & description.points.keys()
    if not {first, second} <= fixed or isinstance(length, str):
        return False
    if any(isinstance(c, str) for c in (*description.points[first], *description.points[second])):
        return False
    base = description.sketched(first)
    span = description.sketched(second) - base
    if not span:
        return False
    # lengths on ground follow from coordinates: both change together
    put_place(text, second, base + span / abs(span) * length)
    text.put(("lengths", quantity.key), length)
    return True


def set_input(edit: SetInput, text: TextEdits, before: Before) -> None:
    """Set the input and its range.

    Raises
    ------
    InputError, UnknownNameError
        If the input does not exist, or the value is of another kind.
    """
    if (edit.drive is None) != (edit.name is None):
        raise InputError("an input has a kind and a name: send drive and name, or neither")
    count = len(before.description.inputs)
    if edit.number == count and count and edit.drive is not None:
        text.append("input", {edit.drive: edit.name})
    elif not 0 <= edit.number < max(1, count):
        raise InputError(f"there is no input {edit.number + 1}: the mechanism has {count}")
    here: tuple[str | int, ...] = ("input", edit.number)
    if edit.drive is not None:
        if edit.drive not in _DRIVES:
            raise UnknownNameError(
                f'"{edit.drive}" cannot be driven {choices("kinds", _DRIVES, edit.drive)}'
            )
        text.put((*here, edit.drive), edit.name)
        # an input has exactly one kind
        for other in (*_DRIVES, "relative_to"):
            if other != edit.drive and text.has((*here, other)):
                text.remove((*here, other))
        _write_range(edit.drive, edit.name or "", here, text, before)
    _put_range(edit, here, text, before)


def _put_range(
    edit: SetInput, here: tuple[str | int, ...], text: TextEdits, before: Before
) -> None:
    units, row = TypedUnits.of(before.description), text.get(here) if text.has(here) else {}
    kind = measured_by(NumberValue("driven"), row) or kind_of_name(
        str(row.get("variable", "")), text
    )
    for field, key in _RANGE.items():
        if (entry := getattr(edit, field)) is None:
            continue
        speed = field == "speed"
        text.put((*here, key), units.speed(entry) if speed else units.number(entry, kind, key))


def _write_range(
    drive: str, name: str, here: tuple[str | int, ...], text: TextEdits, before: Before
) -> None:
    """Replace a range that belongs to another kind of quantity; lengths have no natural one."""
    number, inputs = here[-1], before.description.inputs
    assert isinstance(number, int)
    old = inputs[number].drives[0] if number < len(inputs) else "link"
    if (old in _LENGTHS) == (drive in _LENGTHS):
        return
    for key in _RANGE.values():
        if text.has((*here, key)):
            text.remove((*here, key))
    if drive in _LENGTHS:
        span = _span_of(name, before)
        for key, share in (("from", 0.25), ("to", 0.75), ("step", 0.005)):
            text.put((*here, key), float(f"{share * span:.4g}"))


def _span_of(name: str, before: Before) -> float:
    """The length of a slider's line, or twice that of a cylinder."""
    for part in getattr(before.description, "parts", ()):
        if canonical(part.label) == canonical(name):
            line = getattr(part, "line", None)
            a, b = line or part.between
            return abs(before.place(b) - before.place(a)) * (1.0 if line else 2.0) or 1.0
    return 1.0
