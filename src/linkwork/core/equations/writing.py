"""MathML notation, which browsers display directly."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, singledispatch
from html import escape
from typing import Any, TypeVar

from linkwork.core.equations.frames import Frames, PartRows
from linkwork.core.equations.model import LawEquation, LoopEquation, LoopEquations, Variable
from linkwork.core.equations.notation import Latex, Notation, PlainText, Signed, TermWriter
from linkwork.core.expression.derivatives import derivative
from linkwork.core.expression.tree import (
    ATOM,
    NEGATIVE,
    STRENGTH,
    Binary,
    Call,
    Name,
    Negative,
    Node,
    NumberNode,
    number_text,
    strength,
)
from linkwork.core.foundation.arrays import UNIT_ROUNDOFF
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.lanes import choose, is_batched, leader_value, uniform_value
from linkwork.core.foundation.names import as_latex, pretty
from linkwork.core.foundation.precise import Precise, precise
from linkwork.core.mechanism.description import Key, Problems
from linkwork.core.mechanism.part.gears import Rack, WheelPair
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.index import open_room
from linkwork.core.mechanism.part.part import Part
from linkwork.core.mechanism.part.rolling import Rolling

_INVISIBLE_TIMES, _APPLY, _MINUS = "\u2062", "\u2061", "\u2212"


@dataclass(frozen=True)
class Markup:
    """A sequence of MathML elements; ``loose``: needs parentheses or grouping in a product."""

    xml: str
    loose: bool = False

    def element(self) -> str:
        """The sequence as a displayed equation."""
        return f'<math display="block">{self.xml}</math>'


class MathML:
    """``<msub><mi>a</mi><mn>2</mn></msub>…``."""

    imaginary = Markup("<mi>i</mi>")

    def name(self, name: str) -> Markup:
        """A variable or dimension."""
        shown = pretty(name)
        stem = shown.rstrip("0123456789'")
        index = shown[len(stem) :]
        primes = index.count("'") * "′"
        index = index.rstrip("'")
        head, _, tail = stem.partition("_")
        base = f"<mi>{escape(head or stem)}</mi>"
        below = [f"<mi>{escape(tail)}</mi>"] if tail and head else []
        below += [f"<mn>{index}</mn>"] if index else []
        if below:
            base = f"<msub>{base}<mrow>{'<mo>,</mo>'.join(below)}</mrow></msub>"
        return Markup(f"<msup>{base}<mo>{primes}</mo></msup>" if primes else base)

    def number(self, text: str) -> Markup:
        """A number as its digits."""
        digits = text.removeprefix("-")
        sign = _operator("-") if digits != text else ""
        return Markup(f"{sign}<mn>{digits}</mn>", loose=True)

    def formula(self, node: Node) -> Markup:
        """A complete formula."""
        match node:
            case NumberNode():
                return self.number(number_text(node.value))
            case Name():
                return self.name(node.spelling or node.name)
            case Negative():
                inside = self._inside(node.operand, NEGATIVE)
                return Markup(f"{_operator('-')}{inside.xml}", loose=True)
            case Call("sqrt"):
                return Markup(f"<msqrt>{self.formula(node.arguments[0]).xml}</msqrt>")
            case Call():
                shown = _operator(",").join(self.formula(a).xml for a in node.arguments)
                return self._apply(f"<mi>{node.function}</mi>", self.fenced(Markup(shown)))
            case Binary("/"):
                above, below = self.formula(node.left), self.formula(node.right)
                return Markup(f"<mfrac>{_mathml_row(above)}{_mathml_row(below)}</mfrac>")
            case Binary("^"):
                base, power = self._inside(node.left, ATOM), self.formula(node.right)
                return Markup(f"<msup>{_mathml_row(base)}{_mathml_row(power)}</msup>")
            case Binary():
                own = STRENGTH[node.operator]
                left, right = self._inside(node.left, own), self._inside(node.right, own + 1)
                if node.operator == "*":
                    return self.product([left, right])
                return Markup(f"{left.xml}{_operator(node.operator)}{right.xml}", loose=True)

    def _inside(self, node: Node, least: int) -> Markup:
        shown = self.formula(node)
        return self.fenced(shown) if strength(node) < least else shown

    def node(self, node: Node) -> Markup:
        """A formula as one factor of a product."""
        shown = self.formula(node)
        loose = isinstance(node, Binary) and node.operator in "+-"
        return (
            self.fenced(shown)
            if loose or isinstance(node, Negative)
            else Markup(_mathml_row(shown))
        )

    def degrees(self, radians: float) -> Markup:
        """A fixed angle."""
        return Markup(f"<mn>{number_text(round(math.degrees(radians), 6))}°</mn>")

    def phasor(self, angle: Sequence[Signed[Markup]]) -> Markup:
        """e to the i times an angle."""
        sign = ""
        if len(angle) == 1 and angle[0].sign < 0:
            sign, angle = _operator("-"), [Signed(1, angle[0].product)]
        return Markup(
            f"<msup><mi>e</mi><mrow>{sign}<mi>i</mi>{self._fitted(angle).xml}</mrow></msup>"
        )

    def function(self, name: str, angle: Sequence[Signed[Markup]]) -> Markup:
        """cos or sin of an angle."""
        return self._apply(f"<mi>{name}</mi>", self._fitted(angle))

    def law(self, name: str, primes: int, argument: Markup) -> Markup:
        """A named function, or a derivative of it."""
        return self._apply(self.name(name + primes * "'").xml, self.fenced(argument))

    def weighted(self, weight: str, name: Markup) -> Markup:
        """A number directly before a name."""
        return Markup(f"<mn>{weight}</mn>{name.xml}", loose=True)

    def product(self, factors: Sequence[Markup]) -> Markup:
        """Factors in a row; 1 if there are none."""
        if not factors:
            return self.number("1")
        shown = (_mathml_row(factor) if factor.loose else factor.xml for factor in factors)
        return Markup(_operator(_INVISIBLE_TIMES).join(shown))

    def sum(self, terms: Iterable[Signed[Markup]]) -> Markup:
        """Signed products in a row; 0 if there are none."""
        shown = ""
        for term in terms:
            sign = _operator("-") if term.sign < 0 else _operator("+") if shown else ""
            shown += f"{sign}{term.product.xml}"
        return Markup(shown, loose=True) if shown else self.number("0")

    def fenced(self, inside: Markup) -> Markup:
        """In parentheses."""
        return Markup(f"<mrow><mo>(</mo>{inside.xml}<mo>)</mo></mrow>")

    def equation(self, left: Markup, right: Markup) -> Markup:
        """Both sides of an equation."""
        return Markup(f"{left.xml}{_operator('=')}{right.xml}", loose=True)

    def _fitted(self, angle: Sequence[Signed[Markup]]) -> Markup:
        """An angle as an argument: in parentheses if it has a sign or several terms."""
        shown = self.sum(angle)
        return self.fenced(shown) if len(angle) > 1 or angle[0].sign < 0 else shown

    def _apply(self, function: str, argument: Markup) -> Markup:
        return Markup(f"<mrow>{function}{_operator(_APPLY)}{argument.xml}</mrow>")


def _mathml_row(inside: Markup) -> str:
    return f"<mrow>{inside.xml}</mrow>"


def _operator(sign: str) -> str:
    shown = _MINUS if sign == "-" else sign
    return f"<mo>{shown}</mo>"


# ----------------------------------------------------------------------
# Display of the equations: loops, real form, and the Jacobian in complex and real form.


Matrix = list[list[str]]
_NONE = "none: all positions follow from the inputs"
T = TypeVar("T")


@internal("equations", "loop", "real_rows", "complex_jacobian", "real_jacobian")
@dataclass(frozen=True)
class EquationSheet:
    """The closure equations of a mechanism for display.

    Examples
    --------
    >>> import linkwork as lw
    >>> sheet = lw.example("four-bar").equations()
    >>> print(sheet.text().splitlines()[0])
    unknowns  θ_coupler (angle), θ_rocker (angle)
    >>> sheet.latex().startswith("%")
    False
    """

    equations: LoopEquations

    @cached_property
    def _names(self) -> dict[str, str]:
        return {v.symbol: v.shown for v in self.equations.variables}

    def _writer(self, notation: Notation[T]) -> TermWriter[T]:
        return TermWriter(notation, self._names)

    # Equations in one notation

    def loop(self, loop: LoopEquation, notation: Notation[T]) -> T:
        """``a2·e^(iθ12) + … = …``."""
        write = self._writer(notation)
        left = notation.sum(write.complex_form(term) for term in loop.left)
        right = notation.sum(write.complex_form(term) for term in loop.right)
        return notation.equation(left, right)

    def real_rows(self, notation: Notation[T]) -> list[T]:
        """Every real equation F_k = …: real parts, imaginary parts, linear, plain, laws."""
        write = self._writer(notation)
        rows = []
        for imaginary in (False, True):
            for loop in self.equations.loops:
                forms = [write.real_form(term, imaginary=imaginary) for term in loop.terms]
                rows.append(notation.sum(signed for form in forms for signed in form))
        for line in self.equations.linear:
            parts = self._sum(line.terms, line.constant, notation, angle=line.kind == "angle")
            rows.append(notation.sum(parts))
        rows += [notation.formula(_difference(e.left, e.right)) for e in self.equations.real]
        for law in self.equations.laws:
            parts = self._sum(law.terms, law.constant, notation, angle=law.kind == "angle")
            rows.append(notation.sum([*parts, Signed(-1, self._law(law, notation))]))
        return rows

    def _sum(
        self,
        terms: tuple[tuple[str, float], ...],
        constant: float,
        notation: Notation[T],
        *,
        angle: bool,
    ) -> list[Signed[T]]:
        """Σ weight · name + constant."""
        parts = []
        for symbol, weight in terms:
            shown = notation.name(self._names[symbol])
            if abs(weight) != 1:
                shown = notation.weighted(number_text(abs(weight)), shown)
            parts.append(Signed(-1 if weight < 0 else 1, shown))
        if constant:
            size = abs(constant)
            fixed = number_text(float(f"{size:.10g}"))
            shown = notation.degrees(size) if angle else notation.number(fixed)
            parts.append(Signed(-1 if constant < 0 else 1, shown))
        return parts

    def _law(self, law: LawEquation, notation: Notation[T], primes: int = 0) -> T:
        """The function of a law equation, or its derivative, at its argument."""
        angle = {v.symbol: v.kind for v in self.equations.variables}[law.inner[0][0]] == "angle"
        argument = notation.sum(self._sum(law.inner, law.offset, notation, angle=angle))
        return notation.law(law.shown, law.primes + primes, argument)

    def _law_entry(self, law: LawEquation, symbol: str, notation: Notation[str]) -> str:
        """∂/∂symbol of a law equation."""
        straight, turned = dict(law.terms).get(symbol, 0.0), dict(law.inner).get(symbol, 0.0)
        parts = []
        if straight:
            parts.append(Signed(-1 if straight < 0 else 1, number_text(abs(straight))))
        if turned:
            slope = self._law(law, notation, primes=1)
            weight = [] if abs(turned) == 1 else [number_text(abs(turned))]
            parts.append(Signed(1 if turned < 0 else -1, notation.product([*weight, slope])))
        return notation.sum(parts)

    def complex_jacobian(self, notation: Notation[str]) -> Matrix:
        """Derivatives of the loops, then of their conjugates, with respect to the unknowns."""
        write = self._writer(notation)
        rows = []
        for conjugate in (False, True):
            for loop in self.equations.loops:
                row = []
                for unknown in self.equations.unknowns:
                    parts = []
                    for term in loop.terms:
                        weight = dict(term.phase).get(unknown.symbol, 0.0)
                        if weight:
                            parts.append(
                                write.complex_form(term, factor_i=weight, conjugate=conjugate)
                            )
                        if term.length == unknown.symbol:
                            parts.append(
                                write.complex_form(term, length=False, conjugate=conjugate)
                            )
                    row.append(notation.sum(parts))
                rows.append(row)
        return rows

    def real_jacobian(
        self, notation: Notation[str], variables: Sequence[Variable] | None = None
    ) -> Matrix:
        """∂F/∂x as real numbers: real parts, imaginary parts, linear, plain equations, laws.

        By the unknowns, or by other variables.
        """
        write = self._writer(notation)
        by = self.equations.unknowns if variables is None else variables
        rows = []
        for imaginary in (False, True):
            rows += [
                [self._real_entry(write, loop, u, imaginary) for u in by]
                for loop in self.equations.loops
            ]
        for line in self.equations.linear:
            weights = dict(line.terms)
            rows.append([number_text(weights.get(u.symbol, 0.0)) for u in by])
        for equation in self.equations.real:
            whole = _difference(equation.left, equation.right)
            row = []
            for unknown in by:
                try:
                    row.append(
                        notation.formula(
                            derivative(whole, unknown.symbol, self.equations.angle.radians)
                        )
                    )
                except ValueError:
                    row.append("…")
            rows.append(row)
        for law in self.equations.laws:
            rows.append([self._law_entry(law, unknown.symbol, notation) for unknown in by])
        return rows

    def _real_entry(
        self, write: TermWriter[str], loop: LoopEquation, unknown: Variable, imaginary: bool
    ) -> str:
        parts: list[Signed[str]] = []
        for term in loop.terms:
            weight = dict(term.phase).get(unknown.symbol, 0.0)
            if weight:
                parts += write.real_form(term, imaginary=imaginary, weight=weight)
            if term.length == unknown.symbol:
                parts += write.real_form(term, imaginary=imaginary, length=False)
        return write.notation.sum(parts)

    # Plain text

    def __repr__(self) -> str:
        return self.text().rstrip()

    def text(self, width: int = 80) -> str:
        """All equations as text of the given width."""
        return "\n".join(self._text_lines(width)) + "\n"

    def _text_lines(self, width: int) -> Iterator[str]:
        notation, equations = PlainText(), self.equations
        described = ", ".join(map(self._described, equations.unknowns)) or _NONE
        yield from _wrap("unknowns  ", described, width)
        if equations.inputs:
            yield from _wrap("inputs    ", ", ".join(map(self._described, equations.inputs)), width)
        values = [f"{pretty(n)} = {number_text(v)}" for n, v in equations.symbols.items()]
        if values:
            yield from _wrap("with      ", ", ".join(values), width)
        for k, loop in enumerate(equations.loops):
            yield ""
            yield f'Loop {k + 1} "{loop.label}"'
            yield from _wrap("  ", self.loop(loop, notation), width, "      ")
        for k in range(len(equations.loops), len(equations.labels)):
            yield ""
            yield f'Equation "{equations.labels[k]}"'
            row = self.real_rows(notation)[k + len(equations.loops)]
            yield from _wrap("  ", f"{row} = 0", width, "      ")
            if (law := k - len(equations.labels) + len(equations.laws)) >= 0:
                yield from _wrap("  where ", equations.laws[law].meaning, width, "      ")
        if equations.loops:
            yield from ("", "Real form")
            for k, row_text in enumerate(self.real_rows(notation)):
                head = f"  F{k + 1} = "
                yield from _wrap(head, row_text, width, "       ")
        columns = [notation.name(u.shown) for u in equations.unknowns]
        if not columns:
            return
        if equations.loops:
            count = len(equations.loops)
            labels = [f"loop {k + 1}" for k in range(count)] + [
                f"conj {k + 1}" for k in range(count)
            ]
            yield from ("", "Jacobian, complex form")
            yield from _matrix_lines(self.complex_jacobian(notation), labels, columns, width)
        yield from ("", "Jacobian, real form" if equations.loops else "Jacobian")
        rows = self.real_jacobian(notation)
        yield from _matrix_lines(rows, [f"F{k + 1}" for k in range(len(rows))], columns, width)

    def _described(self, variable: Variable) -> str:
        unit = {"angle": "angle", "length": "length"}.get(variable.kind, "")
        shown = pretty(variable.shown)
        return f"{shown} ({unit})" if unit else shown

    # LaTeX

    def latex(self) -> str:
        """The loop equations and both Jacobians as LaTeX displays."""
        notation, equations = Latex(), self.equations
        if not equations.unknowns:
            return f"% unknowns  {_NONE}\n"
        parts = []
        displays = [self.loop(loop, notation).replace(" = ", " &= ", 1) for loop in equations.loops]
        offset = 2 * len(equations.loops)
        displays += [f"{row} &= 0" for row in self.real_rows(notation)[offset:]]
        parts.append(_environment("align*", " \\\\\n".join(f"  {row}" for row in displays)))
        if equations.loops:
            rows = [f"  F_{{{k + 1}}} &= {row}" for k, row in enumerate(self.real_rows(notation))]
            parts.append(_environment("align*", " \\\\\n".join(rows)))
            parts.append(self._latex_matrix(self.complex_jacobian(notation), notation))
        parts.append(self._latex_matrix(self.real_jacobian(notation), notation))
        return "\n".join(parts)

    def _latex_matrix(self, matrix: Matrix, notation: Latex) -> str:
        rows = " \\\\\n".join("    " + " & ".join(row) for row in matrix)
        unknowns = r" \\ ".join(
            rf"\delta {notation.name(u.shown)}" for u in self.equations.unknowns
        )
        body = f"  \\begin{{bmatrix}}\n{rows}\n  \\end{{bmatrix}}\n"
        body += f"  \\begin{{bmatrix}} {unknowns} \\end{{bmatrix}} = -F"
        return f"\\[\n{body}\n\\]\n"

    # MathML

    def mathml(self) -> list[tuple[str, str]]:
        """Every equation as its label and a ``<math>`` element for a page."""
        notation, equations = MathML(), self.equations
        rows = [self.loop(loop, notation) for loop in equations.loops]
        zero = notation.number("0")
        rest = self.real_rows(notation)[2 * len(rows) :]
        rows += [notation.equation(row, zero) for row in rest]
        return [(label, row.element()) for label, row in zip(equations.labels, rows, strict=True)]

    # Data

    def to_dict(self) -> dict[str, Any]:
        """Loops, real form and Jacobians as text and LaTeX."""
        text, latex = PlainText(), Latex()
        equations = self.equations

        def both(write: Callable[[Notation[str]], Any]) -> dict[str, Any]:
            return {"text": write(text), "latex": write(latex)}

        return {
            "unknowns": [v.name for v in equations.unknowns],
            "inputs": [v.name for v in equations.inputs],
            "dimensions": dict(equations.symbols),
            "loops": [
                {"label": p.label, "text": self.loop(p, text), "latex": self.loop(p, latex)}
                for p in equations.loops
            ],
            "real_form": both(self.real_rows),
            "jacobian_complex": both(self.complex_jacobian),
            "jacobian_real": both(self.real_jacobian),
        }


def _difference(left: Any, right: Any) -> Any:
    return left if right == NumberNode(0.0) else Binary("-", left, right)


def _environment(name: str, body: str) -> str:
    return f"\\begin{{{name}}}\n{body}\n\\end{{{name}}}\n"


def _wrap(head: str, body: str, width: int, indent: str = "") -> list[str]:
    return textwrap.wrap(
        body,
        width,
        initial_indent=head,
        subsequent_indent=indent or " " * len(head),
        break_long_words=False,
        break_on_hyphens=False,
    ) or [head]


def _matrix_lines(
    matrix: Matrix, labels: Sequence[str], columns: Sequence[str], width: int
) -> Iterator[str]:
    """A matrix if it fits the width, otherwise its nonzero entries, one per line."""
    table = [[*columns], *matrix]
    widths = [max(len(row[k]) for row in table) for k in range(len(columns))]
    label_width = max(map(len, labels), default=0)
    if 2 + label_width + 2 + sum(widths) + 2 * len(widths) <= width:
        head = "  ".join(f"{c:^{w}}" for c, w in zip(columns, widths, strict=True))
        yield f"  {'':{label_width}}  {head}".rstrip()
        for label, row in zip(labels, matrix, strict=True):
            body = "  ".join(f"{entry:^{w}}" for entry, w in zip(row, widths, strict=True))
            yield f"  {label:{label_width}}  {body}".rstrip()
        return
    for label, row in zip(labels, matrix, strict=True):
        for column, entry in zip(columns, row, strict=True):
            if entry != "0":
                yield from _wrap(f"  ∂({label})/∂{column} = ", entry, width, "      ")
    if any("0" in row for row in matrix):
        yield "  all others = 0"


# ----------------------------------------------------------------------
# From the loops to positions and rates: a LaTeX document with the mechanism's symbols.


_HEAD = r"""\documentclass[11pt,a4paper]{article}
\usepackage[utf8]{inputenc}
\usepackage[margin=25mm]{geometry}
\usepackage{amsmath}
\newcommand{\row}[1]{{\raggedright\smallskip\hangindent=2em\hangafter=1\(\displaystyle #1\)\par}}
\date{}
\author{}"""
_LARGEST = 4  # columns of a matrix that is set as a matrix
_LONGEST = 100  # characters of such a matrix's longest row
_LATEX = Latex()


def derivation(sheet: EquationSheet, title: str) -> str:
    """The document; pdfLaTeX compiles it."""
    return "\n".join(_lines(sheet, title)) + "\n"


def _lines(sheet: EquationSheet, title: str) -> Iterator[str]:
    yield from (_HEAD, f"\\title{{{as_latex(title)}}}", "\\begin{document}", "\\maketitle")
    yield from _variables(sheet)
    if sheet.equations.unknowns:
        yield from _loops(sheet)
        yield from _newton(sheet)
        yield from _rates(sheet)
    yield "\\end{document}"


def _variables(sheet: EquationSheet) -> Iterator[str]:
    equations = sheet.equations
    yield "\\section{Unknowns and dimensions}"
    if equations.unknowns:
        yield f"Unknowns: {_listed(equations.unknowns)}."
    else:
        yield "There is no unknown: all positions follow from the inputs directly."
    if equations.inputs:
        yield f"Inputs: {_listed(equations.inputs)}."
    values = (f"\\({_name(n)} = {number_text(v)}\\)" for n, v in equations.symbols.items())
    if dimensions := ", ".join(values):
        yield f"Dimensions, in the units of the file: {dimensions}."


def _loops(sheet: EquationSheet) -> Iterator[str]:
    equations = sheet.equations
    rows = sheet.real_rows(_LATEX)
    if equations.loops:
        yield "\\section{Closed loops}"
        yield (
            "A vector of length \\(r\\) at the angle \\(\\varphi\\) is the complex number "
            "\\(r\\,e^{i\\varphi}\\). In a loop the vectors of both sides lead to the same point:"
        )
    for loop in equations.loops:
        yield f"\\paragraph{{{as_latex(loop.label)}}}"
        yield _derivation_row(sheet.loop(loop, _LATEX))
    others = equations.labels[len(equations.loops) :]
    if others:
        yield "\\section{Further equations}"
    for label, row in zip(others, rows[2 * len(equations.loops) :], strict=True):
        yield f"\\paragraph{{{as_latex(label)}}}"
        yield _derivation_row(f"{row} = 0")
    yield "\\section{Scalar equations}"
    if equations.loops:
        yield (
            "By \\(e^{i\\varphi} = \\cos\\varphi + i\\sin\\varphi\\), real and imaginary parts of "
            "left side minus right side vanish:"
        )
    for k, row in enumerate(rows):
        yield _derivation_row(f"F_{{{k + 1}}} = {row} = 0")


def _newton(sheet: EquationSheet) -> Iterator[str]:
    yield "\\section{Newton--Raphson}"
    yield (
        "At an estimate \\(x\\) of the unknowns the equations are replaced by their tangents. "
        "Each step solves a linear system and corrects the estimate, until the corrections vanish:"
    )
    yield "\\[ J\\,\\Delta x = -F(x, u), \\qquad x \\leftarrow x + \\Delta x, \\]"
    yield "\\noindent where \\(x\\) is the column of the unknowns above and"
    yield from _matrix(sheet.real_jacobian(_LATEX), sheet.equations.unknowns)


def _rates(sheet: EquationSheet) -> Iterator[str]:
    inputs = sheet.equations.inputs
    if not inputs:
        return
    yield "\\section{Rates}"
    yield (
        "\\(F(x(t), u(t)) = 0\\) holds at all times. Its derivatives are linear systems with one "
        "matrix \\(J\\), which has an inverse except at dead points and change points:"
    )
    yield "\\begin{align*} J\\,\\dot x &= -\\frac{\\partial F}{\\partial u}\\,\\dot u, &"
    yield "J\\,\\ddot x &= -\\frac{\\partial F}{\\partial u}\\,\\ddot u - \\sum_{j,k}"
    yield "\\frac{\\partial^2 F}{\\partial v_j\\,\\partial v_k}\\,\\dot v_j\\,\\dot v_k,"
    yield "& v &= (x, u), \\end{align*}"
    yield "\\noindent where \\(u\\) is the column of the inputs and"
    yield from _matrix(sheet.real_jacobian(_LATEX, inputs), inputs, "u")


def _matrix(entries: list[list[str]], columns: Sequence[Variable], by: str = "x") -> Iterator[str]:
    """A matrix if it fits the page, otherwise its entries that are not zero."""
    entries = [[entry.replace("…", "\\dots") for entry in row] for row in entries]
    longest = max((len(" ".join(row)) for row in entries), default=0)
    if len(columns) <= _LARGEST and longest <= _LONGEST:
        rows = " \\\\\n".join(" & ".join(row) for row in entries)
        left = f"{'J = ' if by == 'x' else ''}\\frac{{\\partial F}}{{\\partial {by}}}"
        yield f"\\[ {left} = \\begin{{bmatrix}}\n{rows}\n\\end{{bmatrix}} \\]"
        return
    for k, row in enumerate(entries):
        for variable, entry in zip(columns, row, strict=True):
            if entry != "0":
                name = _name(variable.shown)
                yield _derivation_row(f"\\partial F_{{{k + 1}}}/\\partial {name} = {entry}")
    if any("0" in row for row in entries):
        yield "\\noindent All others are zero."


def _derivation_row(formula: str) -> str:
    """A formula that TeX may break at its signs, also inside parentheses."""
    flat = formula.replace("\\left(", "(").replace("\\right)", ")")
    return f"\\row{{{flat}}}"


def _listed(variables: Sequence[Variable]) -> str:
    return ", ".join(f"\\({_name(v.shown)}\\) ({v.kind})" for v in variables)


def _name(shown: str) -> str:
    return _LATEX.name(shown)


# ----------------------------------------------------------------------
# Equations of parts, by their kinds.


# ----------------------------------------------------------------------
# Equations of parts, by their kinds.


@singledispatch
def write_rows(part: Part, key: Key, rows: PartRows) -> None:
    """Add the equations of a part and its entries of frames; some parts have none."""


def rows_of_parts(frames: Frames, problems: Problems) -> PartRows:
    """The rows of all parts of a linkage; their positions and rods are added to ``frames``."""
    rows = PartRows(frames, problems)
    for key, part in frames.linkage.keyed_parts:
        open_room(type(part), "equations")
        write_rows(part, key, rows)
    return rows


# ----------------------------------------------------------------------
# The linear equation between the angles of two wheels in mesh or with a belt.


# relative: sizes this near to a ratio of small integers have that ratio, since both are rounded
_RATIO = 4.0 * UNIT_ROUNDOFF
_LARGEST_TEETH = 10_000  # of these integers


@write_rows.register
def write_wheel_pair(pair: WheelPair, key: Key, rows: PartRows) -> None:
    """q (θ2 - θa) ± p (θ1 - θa) = constant, p : q = r1 : r2."""
    numbers = rows.frames.linkage.numbers
    sizes = pair.radii if pair.radii is not None else pair.teeth
    assert sizes is not None
    p, q = ratio(*map(numbers.precise, sizes), whole=pair.teeth is not None)
    p = -p if pair.together else p
    phase = None
    if pair.phase is not None:
        phase = numbers.precise_angle(pair.phase) * q
    first, second = pair.wheels
    turns = [(second, q), (first, p), (pair.arm, -p - q)]
    rows.tie(pair.name, turns, total=phase, measured=("phase", q))


def ratio(
    numerator: float | Precise, denominator: float | Precise, *, whole: bool = False
) -> tuple[float, float]:
    """Two sizes as the smallest integers of their ratio if these exist, otherwise unchanged.

    With integers, whole turns of one wheel give exactly whole turns of the other.
    """
    over = precise(numerator) / precise(denominator)
    first, second = precise(numerator).high, precise(denominator).high
    if is_batched(first) or is_batched(second):
        p, q = ratio(leader_value(first), leader_value(second), whole=whole)
        if q == 1.0 and not whole:
            return uniform_value(over.high), q
        same = abs(q * first - p * second) <= _RATIO * abs(q * first)
        return uniform_value(choose(same, p, math.nan)), q
    if whole:
        fraction = Fraction(int(first), int(second))
    else:
        fraction = Fraction(over.high).limit_denominator(_LARGEST_TEETH)
    if fraction > 0 and abs(float(fraction) * second - first) <= _RATIO * first:
        return float(fraction.numerator), float(fraction.denominator)
    return over.high, 1.0


# ----------------------------------------------------------------------
# Equation of a rack: its pitch line moves with the circumference of the pinion.


@write_rows.register
def write_rack(rack: Rack, key: Key, rows: PartRows) -> None:
    """Write the equation of the rack's displacement and the pinion's angle."""
    linkage = rows.frames.linkage
    slider = rack.guide(linkage)
    assert slider is not None
    side = rows.side(slider.on, slider.line, rack.center, (*key, "center"))
    r = side * linkage.numbers.precise(rack.radius).high
    turns = [(rack.pinion, -r), (slider.on, r)]
    rows.tie(
        rack.name,
        turns,
        lengths=[(rack.slider, 1.0)],
        measured=(f"{rack.slider} at {rack.pinion} = 0", 1.0),
    )


# ----------------------------------------------------------------------
# Equations of a rolling wheel: its angle against its path on a line or around a circle.


@write_rows.register
def write_rolling(rolling: Rolling, key: Key, rows: PartRows) -> None:
    """Write the equations for a line or a circle."""
    if rolling.line is not None:
        _roll_on_line(rolling, key, rows)
    else:
        _roll_on_circle(rolling, rows)


def _roll_on_line(rolling: Rolling, key: Key, rows: PartRows) -> None:
    assert rolling.line is not None
    frames, linkage = rows.frames, rows.frames.linkage
    side = rows.side(rolling.on, rolling.line, rolling.center, (*key, "center"))
    radius = linkage.numbers.precise(rolling.radius) * side
    name = f"{rolling.name}_radius"
    frames.add_guide((rolling.name, rolling.on, rolling.line), rolling.center, radius, name)
    turns = [(rolling.wheel, radius.high), (rolling.on, -radius.high)]
    measured = (f"{rolling.name} at {rolling.wheel} = 0", 1.0)
    rows.tie(rolling.name, turns, [(rolling.name, 1.0)], measured=measured)


def _roll_on_circle(rolling: Rolling, rows: PartRows) -> None:
    """Join the centres by a rod; wheel and circle mesh as gears on it."""
    assert rolling.circle is not None
    assert rolling.circle_radius is not None
    frames, numbers = rows.frames, rows.frames.linkage.numbers
    small, large = numbers.precise(rolling.radius), numbers.precise(rolling.circle_radius)
    length = abs(large - small) if rolling.inside else large + small
    a, b = rolling.circle, rolling.center
    frames.add_rod(rolling.name, (a, b), length)
    p, q = ratio(large, small)
    p = -p if rolling.inside else p
    turns = [(rolling.wheel, q), (rolling.on, p), (rolling.name, -p - q)]
    rows.tie(rolling.name, turns, measured=(f"{rolling.wheel} at {rolling.name} = 0", q))


# ----------------------------------------------------------------------
# Frame entries of a cylinder: a body of variable length.


@write_rows.register
def write_cylinder(cylinder: Cylinder, key: Key, rows: PartRows) -> None:
    """Add a rod with an unknown angle and length."""
    rows.frames.add_rod(cylinder.name, cylinder.between, angle=cylinder.angle_name)


# ----------------------------------------------------------------------
# Frame entries of a slider: its first point moves along a line of known angle.


@write_rows.register
def write_slider(slider: Slider, key: Key, rows: PartRows) -> None:
    """Add the displacement as a length in the frame of the link with the line."""
    offset, name = rows.frames.linkage.numbers.precise(slider.offset), f"{slider.name}_offset"
    guide = (slider.name, slider.on, slider.line)
    rows.frames.add_guide(guide, slider.points[0], offset, name)


# ----------------------------------------------------------------------
# Frame entries of a slot: its point moves along a line.


@write_rows.register
def write_slot(slot: Slot, key: Key, rows: PartRows) -> None:
    """Add the displacement as a length in the frame of the link with the line."""
    rows.frames.add_guide((slot.name, slot.on, slot.line), slot.point)
