"""Read typed numbers with units, "3 in" or "30 deg", in the units of the file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from linkwork.expression.grammar import parse
from linkwork.expression.values import value
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.errors import ExpressionError, InputError
from linkwork.foundation.units import ANGLES, LENGTHS, conversion, converted, split_unit
from linkwork.mechanism.description import Description
from linkwork.textfile.file_degrees import FileDegrees
from linkwork.textfile.text_edits import TextEdits
from linkwork.textfile.toml_text import data_of

__all__ = ["TypedUnits", "kind_of_name"]


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

    def number(self, given: float | str, kind: str, what: str) -> float | str:
        """A number in the file's unit; a number or formula without a unit stays as it is.

        ``kind``: length, angle, number, or "" if unknown; ``what``: its name in messages.

        Raises
        ------
        InputError
            If the unit is of another kind, or one of unknown size.
        """
        if not isinstance(given, str):
            return given
        split = split_unit(given, [*LENGTHS, *ANGLES, self.length])
        if split is None:
            return given
        amount, unit = split
        own = "angle" if unit in ANGLES else "length"
        if kind and own != kind:
            names = {"length": self.length, "angle": self.angle}.get(kind, "none")
            noun = "a plain number" if kind == "number" else f"{_article(kind)} {kind}"
            raise InputError(
                f'{what} is {noun}, but "{given}" is {_article(own)} {own} (unit here: {names})'
            )
        wanted = self.angle if own == "angle" else self.length
        return converted(_amount(amount, given), self._factor(unit, wanted, given))

    def speed(self, given: float | str | None) -> float | str | None:
        """A speed in a unit that the file reads: "0.5 m/s" becomes "500 mm/s"."""
        rates = {f"{unit}/s": unit for unit in LENGTHS}
        split = split_unit(given, rates) if isinstance(given, str) else None
        if split is None or rates[split[1]] == self.length:
            return given
        assert isinstance(given, str)
        factor = self._factor(rates[split[1]], self.length, given)
        amount = repr(converted(_amount(split[0], given), factor)).removesuffix(".0")
        return f"{amount} {self.length}/s"

    def _factor(self, unit: str, wanted: str, given: str) -> Fraction:
        factor = conversion(unit, wanted)
        if factor is None:
            raise InputError(
                f'"{given}" cannot be converted: the unit of this file, "{wanted}", has no known '
                "size: leave the unit out, or choose another unit for the file"
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


def _amount(amount: str, given: str) -> float:
    """The value of "3", "1/2", "2 1/2" or "3,5"."""
    plain = re.sub(r"^([-+]?\d+),(\d+)$", r"\1.\2", amount)
    plain = re.sub(r"^(\d+)\s+(\d+/\d+)$", r"\1+\2", plain)
    try:
        return value(parse(plain), {}, AngleUnit.DEGREE, plain)
    except ExpressionError:
        raise InputError(
            f'"{given}" is not a number with a unit, such as "3 in" or "1/2 in": formulas are in '
            "the units of the file and carry none"
        ) from None
