"""Display of the equations: loops, real form, and the Jacobian in complex and real form."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

from linkwork.equations.mathml import MathML
from linkwork.equations.model import LawEquation, LoopEquation, LoopEquations, Variable
from linkwork.equations.notation import Latex, Notation, PlainText, Signed
from linkwork.equations.term_writing import TermWriter
from linkwork.expression.derivative import derivative
from linkwork.expression.tree import Binary, Number
from linkwork.expression.writing import number_text
from linkwork.foundation.internal import internal
from linkwork.foundation.names import pretty

__all__ = ["EquationSheet"]

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
        return {
            "unknowns": [v.name for v in equations.unknowns],
            "inputs": [v.name for v in equations.inputs],
            "dimensions": dict(equations.symbols),
            "loops": [
                {"label": p.label, "text": self.loop(p, text), "latex": self.loop(p, latex)}
                for p in equations.loops
            ],
            "real_form": {"text": self.real_rows(text), "latex": self.real_rows(latex)},
            "jacobian_complex": {
                "text": self.complex_jacobian(text),
                "latex": self.complex_jacobian(latex),
            },
            "jacobian_real": {
                "text": self.real_jacobian(text),
                "latex": self.real_jacobian(latex),
            },
        }


def _difference(left: Any, right: Any) -> Any:
    return left if right == Number(0.0) else Binary("-", left, right)


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
