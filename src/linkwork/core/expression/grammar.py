"""Parse a formula by recursive descent.

::

    equation = sum "=" sum
    sum      = product { ("+" | "-") product }
    product  = unary { ("*" | "/") unary }
    unary    = ("+" | "-") unary | power
    power    = atom [ "^" unary ]
    atom     = number | name | function "(" sum { "," sum } ")" | "(" sum ")"

In formulas that may compare, ``sum`` in parentheses and the whole formula are ``sum [ ("<" | "<=" |
">" | ">=") sum ]``, 1 where it holds and else 0.

Accepted in addition to ASCII: ``· × − √ ² ³ …``, Greek letters and subscripts in names, and
``iθ12`` for ``i*θ12``. ``**`` is ``^``. Multiplication signs are required.
"""

from __future__ import annotations

import math
import unicodedata
from dataclasses import dataclass
from functools import lru_cache

from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.names import GREEK, canonical
from linkwork.core.foundation.units import FORCES, LENGTHS, MASSES

#: Functions and their numbers of arguments (minimum, maximum).
FUNCTIONS = {
    "sin": (1, 1), "cos": (1, 1), "tan": (1, 1), "asin": (1, 1), "acos": (1, 1),
    "atan": (1, 1), "atan2": (2, 2), "sqrt": (1, 1), "exp": (1, 1), "ln": (1, 1),
    "log10": (1, 1), "abs": (1, 1), "hypot": (2, 2), "min": (2, 9), "max": (2, 9),
    "cis": (1, 1),
}  # fmt: skip
CONSTANTS = {"pi": math.pi, "e": math.e}
#: Reserved names, which cannot name a dimension or unknown.
RESERVED = frozenset({*FUNCTIONS, *CONSTANTS, "i"})

_SUPERSCRIPT = {c: str(d) for d, c in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")}
_OPERATORS = {
    "+": "+", "-": "-", "−": "-", "–": "-", "*": "*", "·": "*", "⋅": "*", "×": "*",
    "/": "/", "^": "^", "(": "(", ")": ")", ",": ",", "=": "=",
}  # fmt: skip
_LONGEST = 10_000  # characters
#: Units that are written behind a number by mistake, and the key that sets them.
_UNITS = {
    **dict.fromkeys(LENGTHS, "length"), **dict.fromkeys(("deg", "rad"), "angle"),
    **dict.fromkeys(FORCES, "force"), **dict.fromkeys(MASSES, "mass"),
}  # fmt: skip
del _UNITS["t"]  # the time
_MOST_TOKENS = 400  # a sum of n terms has depth n: keeps recursion below Python's limit
_DEEPEST = 60


@dataclass(frozen=True)
class _Token:
    kind: str  # number | name | operator | end
    text: str
    column: int


def _is_name_start(c: str) -> bool:
    return (c.isalpha() or c == "_") and c not in _SUPERSCRIPT


def _is_name_part(c: str) -> bool:
    return (c.isalnum() or c in "_'") and c not in _SUPERSCRIPT


def number_end(text: str, start: int) -> int:
    """Index after the number that begins at ``start``."""
    end = start
    while end < len(text) and text[end] in "0123456789.":
        end += 1
    if end < len(text) and text[end] in "eE":
        digits = end + 1
        if digits < len(text) and text[digits] in "+-":
            digits += 1
        if digits < len(text) and text[digits] in "0123456789":
            while digits < len(text) and text[digits] in "0123456789":
                digits += 1
            end = digits
    return end


def _name_tokens(word: str, column: int) -> list[_Token]:
    """``iθ12`` is the imaginary unit times a Greek name; any other word is one name."""
    folded = unicodedata.normalize("NFKC", word)
    if len(word) > 1 and word[0] == "i" and folded[1] in GREEK:
        return [
            _Token("name", "i", column),
            _Token("operator", "*", column + 1),
            _Token("name", word[1:], column + 1),
        ]
    return [_Token("name", word, column)]


_COMPARISONS = {"<=": "<=", ">=": ">=", "≤": "<=", "≥": ">=", "<": "<", ">": ">"}


def _tokens(text: str, comparing: bool) -> list[_Token]:
    found: list[_Token] = []
    k = 0
    while k < len(text):
        c, column = text[k], k + 1
        if c.isspace():
            k += 1
        # a dot without a digit does not begin a number
        elif c in "0123456789." and text[k : k + 2].strip("."):
            end = number_end(text, k)
            found.append(_Token("number", text[k:end], column))
            k = end
        elif c in _SUPERSCRIPT:
            end = k
            while end < len(text) and text[end] in _SUPERSCRIPT:
                end += 1
            digits = "".join(_SUPERSCRIPT[d] for d in text[k:end])
            found += [_Token("operator", "^", column), _Token("number", digits, column)]
            k = end
        elif c == "√":
            found.append(_Token("name", "sqrt", column))
            k += 1
        elif _is_name_start(c):
            end = k + 1
            while end < len(text) and (
                # the name of a coordinate contains a dot: B.x
                _is_name_part(text[end])
                or (text[end] == "." and end + 1 < len(text) and _is_name_start(text[end + 1]))
            ):
                end += 1
            found += _name_tokens(text[k:end], column)
            k = end
        elif text.startswith("**", k):
            found.append(_Token("operator", "^", column))
            k += 2
        elif comparing and c in "<>≤≥":
            sign = text[k : k + 2] if text[k : k + 2] in _COMPARISONS else c
            found.append(_Token("operator", _COMPARISONS[sign], column))
            k += len(sign)
        elif c in _OPERATORS:
            found.append(_Token("operator", _OPERATORS[c], column))
            k += 1
        else:
            raise ExpressionError(f"column {column}: unexpected character {c!r}", text, column)
    found.append(_Token("end", "", len(text) + 1))
    return found


class _Reader:
    """Reads the tokens of one formula."""

    def __init__(self, text: str, comparing: bool = False) -> None:
        if len(text) > _LONGEST:
            raise ExpressionError(
                f"the formula has {len(text)} characters, at most {_LONGEST} are allowed",
                text[:60],
                1,
            )
        self.text = text
        self.tokens = _tokens(text, comparing)
        if len(self.tokens) > _MOST_TOKENS:
            column = self.tokens[_MOST_TOKENS].column
            raise ExpressionError(
                f"column {column}: more than {_MOST_TOKENS} numbers, names and signs: "
                "split the formula with a named dimension",
                text,
                column,
            )
        self.at = 0
        self.depth = 0

    @property
    def token(self) -> _Token:
        return self.tokens[self.at]

    def error(self, message: str, column: int | None = None) -> ExpressionError:
        where = self.token.column if column is None else column
        return ExpressionError(f"column {where}: {message}", self.text, where)

    def take(self, *operators: str) -> _Token | None:
        token = self.token
        if token.kind == "operator" and token.text in operators:
            self.at += 1
            return token
        return None

    def found(self) -> str:
        return f'"{self.token.text}"' if self.token.kind != "end" else "the end"

    def deeper(self) -> None:
        self.depth += 1
        if self.depth > _DEEPEST:
            raise self.error(f"nested deeper than {_DEEPEST} levels")

    def whole(self) -> Node:
        node = self.sum()
        if token := self.take(*_COMPARISONS):
            node = Binary(token.text, node, self.sum(), token.column)
        return node

    def sum(self) -> Node:
        self.deeper()
        node = self.product()
        # left to right: a - b - c is (a - b) - c
        while token := self.take("+", "-"):
            node = Binary(token.text, node, self.product(), token.column)
        self.depth -= 1
        return node

    def product(self) -> Node:
        node = self.unary()
        while token := self.take("*", "/"):
            node = Binary(token.text, node, self.unary(), token.column)
        return node

    def unary(self) -> Node:
        self.deeper()
        if token := self.take("-"):
            # the sign binds less than ^: -a^2 is -(a^2)
            node: Node = Negative(self.unary(), token.column)
        elif self.take("+"):
            node = self.unary()
        else:
            node = self.power()
        self.depth -= 1
        return node

    def power(self) -> Node:
        base = self.atom()
        if token := self.take("^"):
            # right to left, and after a sign: a^-b^c is a^(-(b^c))
            return Binary("^", base, self.unary(), token.column)
        return base

    def atom(self) -> Node:
        token = self.token
        if token.kind == "number":
            self.at += 1
            return self.number(token)
        if token.kind == "name":
            self.at += 1
            return self.name(token)
        if self.take("("):
            node = self.whole()
            self.close(token)
            return node
        raise self.error(f'expected a number, a name or "(", found {self.found()}')

    def number(self, token: _Token) -> Node:
        try:
            value = float(token.text)
        except ValueError:
            raise self.error(f'"{token.text}" is not a number', token.column) from None
        if not math.isfinite(value):
            raise self.error(f"{token.text} is too large", token.column)
        follower = self.token
        if follower.kind == "name" and follower.text in _UNITS:
            unit = follower.text
            raise self.error(
                f'numbers carry no unit here: write {token.text} and set {_UNITS[unit]} = "{unit}" '
                f'for the whole file; a product is written "{token.text}*{unit}"',
                follower.column,
            )
        if follower.kind == "name":
            raise self.error(
                f'write the multiplication sign: "{token.text}*{follower.text}"', follower.column
            )
        return NumberNode(value, token.column)

    def name(self, token: _Token) -> Node:
        name = canonical(token.text)
        if name in FUNCTIONS:
            return self.call(name, token)
        if self.token.kind == "operator" and self.token.text == "(":
            raise self.error(
                f'"{token.text}" is not a function {choices("functions", FUNCTIONS, name)}; '
                f'for a product write "{token.text}*("',
                token.column,
            )
        return Name(name, token.text, token.column)

    def call(self, function: str, token: _Token) -> Node:
        opening = self.take("(")
        if opening is None:
            raise self.error(f'"{function}" is a function: write {function}(…)', token.column)
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        self.close(_Token("operator", "(", opening.column))
        least, most = FUNCTIONS[function]
        if not least <= len(arguments) <= most:
            wanted = str(least) if least == most else f"{least} to {most}"
            raise self.error(
                f"{function} takes {wanted} argument{'s' if wanted != '1' else ''}, "
                f"got {len(arguments)}",
                token.column,
            )
        return Call(function, tuple(arguments), token.column)

    def close(self, opening: _Token) -> None:
        if self.take(")"):
            return
        if self.token.kind in ("number", "name") or self.token.text == "(":
            raise self.error(f"an operator such as * is missing before {self.found()}")
        raise self.error(
            f'expected ")" for the "(" in column {opening.column}, found {self.found()}'
        )

    def finish(self) -> None:
        token = self.token
        if token.kind == "end":
            return
        if token.text == ")":
            raise self.error('")" without "("')
        if token.text == "=":
            raise self.error('unexpected "="')
        raise self.error(f"an operator such as * is missing before {self.found()}")


def parse(text: str, *, comparing: bool = False) -> Node:
    """Read one expression, which may compare numbers if ``comparing``.

    Raises
    ------
    ExpressionError
        With the column and the expected token.
    """
    return _parsed(text, comparing)


# the same formulas are read for every design of a family and every step of a drag
@lru_cache(maxsize=1024)
def _parsed(text: str, comparing: bool) -> Node:
    reader = _Reader(text, comparing)
    node = reader.whole()
    reader.finish()
    return node


def parse_equation(text: str) -> tuple[Node, Node]:
    """Read ``left = right``.

    Raises
    ------
    ExpressionError
        Also if the number of equals signs is not one.
    """
    reader = _Reader(text)
    left = reader.sum()
    if reader.token.kind == "end":
        raise reader.error('an equation needs "=": write "… = 0"')
    if reader.take("=") is None:
        reader.finish()
    right = reader.sum()
    reader.finish()
    return left, right
