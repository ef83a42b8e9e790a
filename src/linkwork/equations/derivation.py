"""From the loops to positions and rates: a LaTeX document with the mechanism's symbols."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from linkwork.equations.model import Variable
from linkwork.equations.notation import Latex
from linkwork.equations.writing import EquationSheet
from linkwork.expression.writing import number_text
from linkwork.foundation.latex_text import as_latex

__all__ = ["derivation"]

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
        yield _row(sheet.loop(loop, _LATEX))
    others = equations.labels[len(equations.loops) :]
    if others:
        yield "\\section{Further equations}"
    for label, row in zip(others, rows[2 * len(equations.loops) :], strict=True):
        yield f"\\paragraph{{{as_latex(label)}}}"
        yield _row(f"{row} = 0")
    yield "\\section{Scalar equations}"
    if equations.loops:
        yield (
            "By \\(e^{i\\varphi} = \\cos\\varphi + i\\sin\\varphi\\), real and imaginary parts of "
            "left side minus right side vanish:"
        )
    for k, row in enumerate(rows):
        yield _row(f"F_{{{k + 1}}} = {row} = 0")


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
                yield _row(f"\\partial F_{{{k + 1}}}/\\partial {name} = {entry}")
    if any("0" in row for row in entries):
        yield "\\noindent All others are zero."


def _row(formula: str) -> str:
    """A formula that TeX may break at its signs, also inside parentheses."""
    flat = formula.replace("\\left(", "(").replace("\\right)", ")")
    return f"\\row{{{flat}}}"


def _listed(variables: Sequence[Variable]) -> str:
    return ", ".join(f"\\({_name(v.shown)}\\) ({v.kind})" for v in variables)


def _name(shown: str) -> str:
    return _LATEX.name(shown)
