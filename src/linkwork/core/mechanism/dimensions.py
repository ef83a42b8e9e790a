"""Named dimensions: numbers and formulas of other dimensions, evaluated in order."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import cast

from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Name, Node, names_in
from linkwork.core.expression.values import precise_value, radians_of, value
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.lanes import finite, is_batched
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.precise import Precise, chosen
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.foundation.values import as_told, plain_number

#: A number, or a formula of the named dimensions.
Number = float | int | str
#: The largest length, mass or load: it keeps squares and quotients finite.
LARGEST = 1e100
_LONGEST_CHAIN = 200
_LARGE = 1e308  # no number below is infinite
Report = Callable[[Iterable[str | int], str], None]


class Numbers:
    """The dimensions of a mechanism as numbers; a call evaluates a number or formula.

    Parameters
    ----------
    dimensions : Mapping[str, number or formula]
    unit : AngleUnit
        Unit of angles in formulas.
    """

    def __init__(self, dimensions: Mapping[str, Number], unit: AngleUnit) -> None:
        self.unit = unit
        self.spelling = {canonical(name): name for name in dimensions}
        self.known: dict[str, float] = {}
        self.wrong: dict[str, str] = {}
        self._given = given = {canonical(name): number for name, number in dimensions.items()}
        self._precise: dict[str, Precise] = {}
        for name in given:
            self._resolve(name, given, [])

    def __call__(self, number: Number) -> float:
        """The value of a number or formula.

        Raises
        ------
        ExpressionError
            If the formula cannot be read or has no finite real value.
        """
        # most are plain: other questions take longer
        if (type(number) is float or type(number) is int) and -_LARGE < number < _LARGE:
            return float(number)
        if isinstance(number, str):
            return value(parse(number), self.known, self.unit, number)
        plain = cast(float, number) if is_batched(number) else plain_number(number)
        if plain is None or not finite(plain):
            shown = as_told(number if plain is None else plain)
            raise ExpressionError(f"must be a finite number, got {shown}", shown, 1)
        return plain

    def precise(self, number: Number) -> Precise:
        """The value as exact as formulas give it: plain numbers are those of the file."""
        if not isinstance(number, str):
            return Precise(self(number))
        return self.precise_tree(parse(number), self(number))

    def precise_tree(self, tree: Node, value: float) -> Precise:
        """The same of a formula that has a value."""
        rounded = Precise(value)
        if not rounded.has_rest:
            return rounded
        for node in names_in(tree):
            if node.name in self.known and node.name not in self._precise:
                self._precise[node.name] = self.precise(self._given[node.name])
        try:
            found = precise_value(tree, self._precise, self.unit)
        except (ArithmeticError, ValueError, KeyError):  # at the end of a domain, or complex
            return rounded
        # NaN likewise
        return chosen(found.low - found.low == 0.0, found, rounded)

    def precise_angle(self, number: Number) -> Precise:
        """The value of an angle [rad]."""
        return self.precise(number) * radians_of(self.unit)

    def check(self, report: Report) -> None:
        """Report every dimension that has no value."""
        for name, message in self.wrong.items():
            report(("dimensions", self.spelling[name]), message)

    def check_number(self, report: Report, key: Iterable[str | int], number: Number) -> float:
        """The number, or NaN after reporting a problem."""
        try:
            return self(number)
        except ExpressionError as error:
            # a consequence of a dimension reported already is not reported again
            if not self._depends_on_wrong(number):
                report(key, str(error) if isinstance(number, str) else error.message)
            return math.nan

    def check_amount(self, report: Report, key: Iterable[str | int], number: Number) -> float:
        """As :meth:`check_number`, also of a number whose products would not be finite."""
        amount = self.check_number(report, key, number)
        if abs(amount) > LARGEST:
            report(key, f"{amount:g} is too large: at most {LARGEST:g}")
            return math.nan
        return amount

    def _depends_on_wrong(self, number: Number) -> bool:
        """Whether the cause is a dimension reported already."""
        try:
            used = {node.name for node in names_in(parse(str(number)))}
        except ExpressionError:
            return False
        return not used.isdisjoint(self.wrong)

    def _undefined(self, node: Name, text: str) -> ExpressionError:
        known = choices("dimensions", self.spelling.values(), node.spelling)
        message = f'column {node.column}: "{node.spelling}" is not defined {known}'
        return ExpressionError(message, text, node.column)

    def _resolve(self, name: str, given: Mapping[str, Number], chain: list[str]) -> None:
        if name in self.known or name in self.wrong:
            return
        if name in chain:
            cycle = [self.spelling[n] for n in [*chain[chain.index(name) :], name]]
            self.wrong[name] = "is defined in terms of itself: " + " → ".join(cycle)
            return
        # the evaluation is recursive: stay below Python's limit
        if len(chain) > _LONGEST_CHAIN:
            self.wrong[name] = f"depends on a chain of more than {_LONGEST_CHAIN} dimensions"
            return
        number = given[name]
        try:
            if isinstance(number, str):
                for node in names_in(parse(number)):
                    if node.name in given and node.name not in CONSTANTS:
                        # a dimension is evaluated after those in its formula; the chain reveals
                        # cycles
                        self._resolve(node.name, given, [*chain, name])
                    elif node.name not in (*given, *CONSTANTS, "i"):
                        raise self._undefined(node, number)
                if name in self.wrong:
                    return
            self.known[name] = self(number)
        except ExpressionError as error:
            if not self._depends_on_wrong(number):
                self.wrong[name] = str(error) if isinstance(number, str) else error.message
            else:
                used = [node for node in names_in(parse(str(number))) if node.name in self.wrong]
                self.wrong[name] = f'depends on "{used[0].spelling}", which has no value'
