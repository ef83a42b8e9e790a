"""How the languages of programs write formulas and statements."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources

from linkwork.export.formulas.cell_formula import CellFormula
from linkwork.expression.precedence import STRENGTH, strength
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation.angles import AngleUnit

__all__ = ["FormulaText", "Syntax"]

_OF_ANGLE = ("sin", "cos", "tan")
_TO_ANGLE = ("asin", "acos", "atan", "atan2")


@dataclass(frozen=True, kw_only=True)
class Syntax:
    """One language.

    Parameters
    ----------
    language : str
        Its name for people.
    suffix : str
        Of its files, with the dot.
    template : str
        The file of the fixed parts, in the folder ``templates``.
    functions : Mapping[str, str]
        Forms of the functions of formulas, of ``^``, and of the constants ``pi`` and ``e``.
    sections : Mapping[str, str]
        Forms of the functions of a program: ``closure``, ``sides1`` and ``sides2`` of a block with
        its number ``{k}``, its titles ``{about}`` and ``{n}`` rows; ``derived``,
        ``derived_rates``. ``{body}`` are statements, ``{locals}`` the names that they define.
    assign : str
        A statement that gives a new ``{name}`` a ``{value}``.
    constant : str
        The same for a number that never changes.
    comment : str
        A comment after a statement.
    first : int
        The index of an array's first element.
    element, entry : str
        Elements of an array and of a matrix, by numbers.
    store : str
        Writes a ``{value}`` to a ``{place}``.
    string : str
        A text between its marks.
    row, rows : tuple of str
        Beginning, separator and end of a list of numbers, and of a list of such lists.
    words : frozenset of str
        Words of the language, in lower case.
    comments : str
        A regular expression of comments in the template.
    indent : str
        Before a statement in a function.
    padded : bool
        Whether lists of lists need lists of one length.
    empty : str
        What a list of no numbers contains.
    shared : str
        How functions call a constant.
    inner : tuple of str, optional
        As ``row``, for a list in a list.
    """

    language: str
    suffix: str
    template: str
    functions: Mapping[str, str]
    sections: Mapping[str, str]
    assign: str
    constant: str
    comment: str
    first: int
    element: str
    entry: str
    store: str
    string: str
    row: tuple[str, str, str]
    rows: tuple[str, str, str]
    words: frozenset[str]
    comments: str
    indent: str = "    "
    padded: bool = True
    empty: str = ""
    shared: str = "{name}"
    inner: tuple[str, str, str] | None = None

    @cached_property
    def text(self) -> str:
        """The template."""
        folder = resources.files("linkwork.export.code") / "templates"
        return (folder / self.template).read_text("utf-8")

    @cached_property
    def reserved(self) -> frozenset[str]:
        """What is no free identifier: the language's words and the names of the fixed parts."""
        fixed = [self.text, *self.sections.values(), *self.functions.values()]
        code = (re.sub(self.comments, " ", part, flags=re.DOTALL).lower() for part in fixed)
        return self.words.union(*(re.findall(r"[a-z]\w*", part) for part in code))

    def number(self, value: float) -> str:
        """A number by all its digits, with a decimal point; NaN does not occur in programs."""
        shown = repr(float(value))
        mantissa, mark, exponent = shown.partition("e")
        if "." not in mantissa:
            mantissa += ".0"
        return mantissa + mark + exponent

    def listed(self, values: Sequence[float], *, inside: bool = False) -> str:
        """A list of numbers, whole ones as such; ``inside``: in a list of lists."""
        begin, between, end = (inside and self.inner) or self.row
        shown = (str(x) if isinstance(x, int) else self.number(x) for x in values)
        return begin + (between.join(shown) or self.empty) + end

    def at(self, array: str, k: int) -> str:
        """An element of an array; k counts from 0."""
        return self.element.format(array=array, k=k + self.first)

    def inside(self, matrix: str, i: int, j: int) -> str:
        """An entry of a matrix; i and j count from 0."""
        return self.entry.format(array=matrix, i=i + self.first, j=j + self.first)


@dataclass(frozen=True)
class FormulaText:
    """Formulas in a language's notation.

    Parameters
    ----------
    syntax : Syntax
    names : Mapping[str, str]
        Identifiers by the names of formulas.
    """

    syntax: Syntax
    names: Mapping[str, str]

    def of(self, formula: CellFormula) -> str:
        """A formula, its trigonometric functions in its unit of angles."""
        return self.text(formula.node, formula.unit is AngleUnit.DEGREE)

    def text(self, node: Node, degrees: bool = False) -> str:
        """A node; ``degrees``: whether sin, cos and their inverses use degrees."""
        match node:
            case Number():
                shown = self.syntax.number(abs(node.value))
                return f"-{shown}" if node.value < 0.0 else shown
            case Name():
                return self._name(node.name)
            case Negative():
                return "-" + self._inside(node.operand, STRENGTH["*"], degrees)
            case Call():
                given = [self.text(x, degrees) for x in node.arguments]
                return self._call(node.function, given, degrees)
            case Binary("^"):
                return self._power(node, degrees)
            case Binary():
                own = STRENGTH[node.operator]
                left = self._inside(node.left, own, degrees)
                right = self._inside(node.right, own + 1, degrees)
                if right.startswith("-"):  # no two operators in succession
                    right = f"({right})"
                space = " " if node.operator in "+-" else ""
                return f"{left}{space}{node.operator}{space}{right}"

    def _name(self, name: str) -> str:
        if name in self.names:
            return self.names[name]
        return self.syntax.functions[name]  # pi, e

    def _power(self, node: Binary, degrees: bool) -> str:
        if node.right == Number(2.0) and isinstance(node.left, Name):
            own = self.text(node.left)
            return f"({own}*{own})"
        return self._call("^", [self.text(x, degrees) for x in (node.left, node.right)], degrees)

    def _call(self, function: str, given: list[str], degrees: bool) -> str:
        forms = self.syntax.functions
        if function in ("min", "max"):
            found = given[0]
            for other in given[1:]:
                found = forms[function].format(found, other)
            return found
        if function in _OF_ANGLE and degrees:
            given = [forms["radians"].format(*given)]
        shown = forms[function].format(*given)
        return forms["degrees"].format(shown) if function in _TO_ANGLE and degrees else shown

    def _inside(self, node: Node, least: int, degrees: bool) -> str:
        shown = self.text(node, degrees)
        return f"({shown})" if strength(node) < least else shown
