"""Find which numbers of formulas are lengths and angles, from how formulas combine them.

A length has degree (1, 0), an angle (0, 1), an area (2, 0), a ratio (0, 0). Sums require equal
degrees, products add them: linear equations for the degrees of all names and literal numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from linkwork.contacts.curves import Curve
from linkwork.core.expression.grammar import CONSTANTS, number_end, parse, parse_equation
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.expression.values import value
from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import ExpressionError, InputError, key_text
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import ANGLES, LENGTHS, AngleUnit, conversion, converted
from linkwork.core.foundation.values import Formula, Measured, NumberValue, Speed
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.inputs import split_speed
from linkwork.core.mechanism.part.guides import Cylinder, GuidePart
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.part import Part
from linkwork.core.results.quantities.registry import row_quantity
from linkwork.core.textfile.keys import LINKAGE, LOOPS, form_of
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.entries import Entry, entries, measured_by

_ANGLE_OF = ("sin", "cos", "tan", "cis")
_TO_ANGLE = ("asin", "acos", "atan")
_ALIKE = ("abs", "hypot", "min", "max", "atan2")


@dataclass(frozen=True)
class Literal:
    """A literal number, or a constant such as pi, in the formula at a place of the file."""

    where: str
    column: int
    constant: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class Degree:
    """A degree in length and in angle, as far as known, plus multiples of unknown degrees."""

    length: Fraction = Fraction(0)
    angle: Fraction = Fraction(0)
    rest: Mapping[str | Literal, Fraction] = FrozenDict()

    def plus(self, other: Degree, times: Fraction | int = 1) -> Degree:
        rest = dict(self.rest)
        for unknown, factor in other.rest.items():
            rest[unknown] = rest.get(unknown, Fraction(0)) + factor * times
        return Degree(
            self.length + other.length * times,
            self.angle + other.angle * times,
            {unknown: factor for unknown, factor in rest.items() if factor},
        )


PURE, LENGTH, ANGLE = Degree(), Degree(Fraction(1)), Degree(Fraction(0), Fraction(1))


class Degrees:
    """The degrees of names and literal numbers, as far as formulas determine them."""

    def __init__(self) -> None:
        self._known: dict[str | Literal, Degree] = {}
        self._literals: dict[str, list[Literal]] = {}
        self._names: dict[str, None] = {}

    @property
    def names(self) -> list[str]:
        """All names in formulas."""
        return list(self._names)

    def literals(self, where: str) -> list[Literal]:
        """The literal numbers of the formula at a place, in their order."""
        return self._literals.get(where, [])

    def resolved(self, degree: Degree) -> Degree:
        """A degree with all that is known about unknown ones."""
        while (unknown := next((u for u in degree.rest if u in self._known), None)) is not None:
            factor = degree.rest[unknown]
            rest = {u: f for u, f in degree.rest.items() if u != unknown}
            degree = Degree(degree.length, degree.angle, rest).plus(self._known[unknown], factor)
        return degree

    def of(self, unknown: str | Literal) -> Degree | None:
        """The degree of a name or literal number; ``None`` if it is not determined."""
        degree = self.resolved(Degree(rest={unknown: Fraction(1)}))
        return None if degree.rest else degree

    def add(self, where: str, tree: Node, degree: Degree | None = None) -> Degree:
        """Add the formula at a place of the file, with its degree if it is known.

        Raises
        ------
        InputError
            If the formula mixes lengths, angles and plain numbers.
        """
        of_tree = self._of(tree, where)
        return of_tree if degree is None else self.equate(of_tree, degree, where)

    def name(self, name: str) -> Degree:
        """The degree of a name, known or not."""
        self._names[name] = None
        return Degree(rest={name: Fraction(1)})

    def equate(self, one: Degree, other: Degree, where: str) -> Degree:
        """Two degrees are the same; raises like :meth:`add`."""
        gap = self.resolved(one.plus(other, -1))
        if not gap.rest:
            if gap != PURE:
                raise InputError(
                    f"{where} mixes lengths, angles and plain numbers: it cannot be converted"
                )
            return one
        unknown, factor = list(gap.rest.items())[-1]
        self._known[unknown] = PURE.plus(
            Degree(gap.length, gap.angle, {u: f for u, f in gap.rest.items() if u != unknown}),
            -1 / factor,
        )
        return one

    def settle(self) -> None:
        """Make literal numbers that are only factors plain numbers: 2 in ``2*a``."""
        # constants last: pi in pi/2 is the angle
        every = [literal for literals in self._literals.values() for literal in literals]
        for literal in sorted(every, key=lambda one: one.constant):
            degree = self.resolved(Degree(rest={literal: Fraction(1)}))
            if degree.rest:
                self.equate(degree, PURE, "")

    def _literal(self, where: str, column: int, constant: bool = False) -> Degree:
        literal = Literal(where, column, constant)
        self._literals.setdefault(where, []).append(literal)
        return Degree(rest={literal: Fraction(1)})

    def _of(self, node: Node, where: str) -> Degree:
        match node:
            case NumberNode():
                return self._literal(where, node.column)
            case Name("i"):
                return PURE
            case Name(name) if name in CONSTANTS:
                return self._literal(where, node.column, constant=True)
            case Name(name):
                return self.name(name)
            case Negative():
                return self._of(node.operand, where)
            case Binary("^"):
                return self._power(node, where)
            case Binary("*" | "/"):
                sign = 1 if node.operator == "*" else -1
                return self._of(node.left, where).plus(self._of(node.right, where), sign)
            case Binary():
                left = self._of(node.left, where)
                return self.equate(left, self._of(node.right, where), where)
            case Call():
                return self._call(node, where)

    def _power(self, node: Binary, where: str) -> Degree:
        exponent = self._of(node.right, where)
        turned = any(name.name == "i" for name in names_in(node.right))
        if node.left == Name("e") and turned:
            self.equate(exponent, ANGLE, where)  # e^(i*theta)
            return PURE
        self.equate(exponent, PURE, where)
        base = self._of(node.left, where)
        try:
            times = Fraction(value(node.right, {}, AngleUnit.RADIAN)).limit_denominator(1000)
        except ExpressionError:  # the exponent contains names
            self.equate(base, PURE, where)
            return PURE
        return PURE.plus(base, times)

    def _call(self, node: Call, where: str) -> Degree:
        first, *others = (self._of(argument, where) for argument in node.arguments)
        if node.function in _ALIKE:
            for other in others:
                self.equate(first, other, where)
            return ANGLE if node.function == "atan2" else first
        if node.function == "sqrt":
            return PURE.plus(first, Fraction(1, 2))
        self.equate(first, ANGLE if node.function in _ANGLE_OF else PURE, where)
        return ANGLE if node.function in _TO_ANGLE else PURE


# ----------------------------------------------------------------------
# Which numbers of a mechanism file are lengths and which are angles.


_BY_WORD = {
    "length": LENGTH, "angle": ANGLE, "number": PURE, "per length": Degree(Fraction(-1)),
    "area": Degree(Fraction(2)),
}  # fmt: skip
_SLIDING = (GuidePart, Cylinder, Curve)  # parts whose name is that of a length


@dataclass(frozen=True)
class Written:
    """A number or formula at a key path, and the unit behind it, of speeds only."""

    path: tuple[str | int, ...]
    given: float | str
    degree: Degree
    unit: str = ""


class FileDegrees:
    """The degrees of all numbers of a file, from their tables and from the formulas with them.

    Parameters
    ----------
    data : Mapping
        A mechanism file as plain data.

    Raises
    ------
    InputError
        If a formula cannot be read, or mixes kinds of numbers.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self._degrees, self._form = Degrees(), form_of(data)
        self._length = str(data.get("length", Description.length))
        self.written: list[Written] = []
        self._loads: list[str] = []  # formulas of loads, with names of all quantities
        listed = list(entries(data, self._form.keys))
        self._dimensions = {
            canonical(str(e.path[1])): str(e.path[1]) for e in listed if e.path[0] == "dimensions"
        }
        for name, degree in self._known_names(listed):
            if name not in self._dimensions:
                self._degrees.equate(self._degrees.name(name), degree, name)
        for name in self._dimensions:
            self._degrees.name(name)
        for entry in listed:
            self._read(entry)
        self._unclear = self._undetermined()
        self._degrees.settle()

    def of_name(self, name: str) -> str:
        """What a name in formulas measures: length, angle, number, or "" if that is not clear."""
        known = self._degrees.of(canonical(name))
        return next((word for word, degree in _BY_WORD.items() if degree == known), "")

    def check(self, *, turned: bool) -> None:
        """Check that everything can be converted; ``turned``: also angles.

        Raises
        ------
        InputError
            With the name of a number that may be a length or an angle, or of an output that is
            both.
        """
        for where in self._loads:
            raise InputError(
                f"{where} is a formula of a load: it cannot be converted; write it for the new unit"
            )
        unknown = [n for name, n in self._dimensions.items() if self._degrees.of(name) is None]
        for name in [*self._unclear, *unknown]:
            raise InputError(
                f'"{name}" may be a length, an angle or a plain number: nothing in the file says '
                "which, so it cannot be converted"
            )
        for written in self.written:
            degree = self.degree(written)
            if turned and written.path[0] == "outputs" and degree.angle and degree != ANGLE:
                raise InputError(
                    f"{key_text(written.path)} multiplies or divides by angles: the formula holds "
                    "for one unit of angles only and cannot be converted"
                )

    def degree(self, written: Written) -> Degree:
        """The degree of a written number or formula."""
        return self._degrees.resolved(written.degree)

    def literals(self, written: Written) -> list[tuple[Literal, Degree]]:
        """The literal numbers of a formula, with their degrees."""
        literals = self._degrees.literals(key_text(written.path))
        return [(literal, self._degrees.of(literal) or PURE) for literal in literals]

    def _undetermined(self) -> list[str]:
        """Names of variables whose kind nothing says; factors may still show a dimension's."""
        if self._form is LOOPS:
            return []
        undetermined = []
        for name in self._degrees.names:
            if name in self._dimensions or self._degrees.of(name) is not None:
                continue
            if (quantity := row_quantity(name)) is None:
                undetermined.append(name)
            else:
                self._degrees.equate(self._degrees.name(name), _BY_WORD[quantity.kind.value], name)
        return undetermined

    def _known_names(self, listed: list[Entry]) -> Iterator[tuple[str, Degree]]:
        """Names in formulas whose kinds follow from the tables."""
        for entry in listed:
            table, name = entry.path[0], str(entry.path[1:2] and entry.path[1])
            if table == "points":
                yield from ((canonical(f"{name}.{axis}"), LENGTH) for axis in "xy")
                if self._form is LOOPS:
                    yield canonical(name), LENGTH
            elif self._form is not LINKAGE:
                continue
            elif table == "links" and name != GROUND:
                yield canonical(name), ANGLE
            elif entry.path[-1] == "law":
                yield "phi", ANGLE
            elif entry.path[-1] == "name" and issubclass(PARTS.get(str(table), Part), _SLIDING):
                stated = str(entry.given)
                yield canonical(stated), ANGLE if entry.row.get("closed") else LENGTH
                if PARTS[str(table)] is Cylinder:
                    yield canonical(Cylinder(name=stated, between=("", "")).angle_name), ANGLE

    def _read(self, entry: Entry) -> None:
        match entry.kind:
            case NumberValue() if entry.path[0] == "loads" and isinstance(entry.given, str):
                self._loads.append(key_text(entry.path))
            case NumberValue() as kind:
                self._number(entry, entry.given, self._measured(kind, entry))
            case Measured() if not isinstance(entry.given, str):
                self._number(entry, entry.given, LENGTH)
            case Speed():
                self._speed(entry)
            case Formula(equation) if isinstance(entry.given, str):
                self._formula(entry, entry.given, equation)

    def _measured(self, kind: NumberValue, entry: Entry) -> Degree:
        if word := measured_by(kind, entry.row):
            return _BY_WORD[word]
        if kind.of == "varied":
            return self._varied(str(entry.path[1]))
        by_input = entry.path[0] == "input"
        name = str(entry.row.get("variable", "")) if by_input else str(entry.path[1])
        return self._degrees.name(canonical(name))

    def _varied(self, name: str) -> Degree:
        """That of a number that can vary: a length, angle, coordinate, offset or dimension."""
        words, folded = name.split(), canonical(name)
        if len(words) == 2 or "." in name:
            return LENGTH
        return ANGLE if len(words) == 3 else self._degrees.name(folded)

    def _number(self, entry: Entry, number: float | str, degree: Degree, unit: str = "") -> None:
        if isinstance(number, str):
            self._degrees.add(key_text(entry.path), parse(number), degree)
        self.written.append(Written(entry.path, number, degree, unit))

    def _speed(self, entry: Entry) -> None:
        kind = next((k for k in ("link", "joint", "slider", "cylinder") if k in entry.row), "")
        split = (
            split_speed(entry.given, kind, self._length) if isinstance(entry.given, str) else None
        )
        if split is None:
            self._number(entry, entry.given, self._measured(NumberValue("driven"), entry))
        elif split[1] == f"{self._length}/s":
            self._number(entry, split[0], LENGTH, split[1])

    def _formula(self, entry: Entry, formula: str, equation: bool) -> None:
        where, table = key_text(entry.path), entry.path[0]
        degree = LENGTH if self._form is LOOPS and table in ("loops", "points") else None
        degree = ANGLE if entry.path[-1] == "law" and table != "outputs" else degree
        trees = parse_equation(formula) if equation else (parse(formula),)
        for tree in trees:
            degree = self._degrees.add(where, tree, degree)
        assert degree is not None
        self.written.append(Written(entry.path, formula, degree))


# ----------------------------------------------------------------------
# Change the units of a mechanism file: convert all numbers, or keep them and name other units.


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
        If a unit has no known size, or an entry, which is named, cannot be converted.

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
    factor: Fraction | float = Fraction(1)
    for word, exponent in (("length", degree.length), ("angle", degree.angle)):
        power = exponent.numerator if exponent.denominator == 1 else float(exponent)
        factor *= factors[word] ** power
    return factor


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
