"""Formulas in spreadsheet notation, and their values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import LinearEquation, RealEquation, Redundant, Term
from linkwork.core.expression.derivatives import derivative
from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import (
    ATOM,
    COMPARISONS,
    STRENGTH,
    Binary,
    Call,
    Name,
    Negative,
    Node,
    NumberNode,
    names_in,
    strength,
)
from linkwork.core.expression.values import FUNCTIONS
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.motion.model import Model
from linkwork.core.results.quantities.registry import row_quantity
from linkwork.writers.formulas.traced import LinearForm, TracedEquations, cosine, forms_of, sine

_OF_ANGLE = ("sin", "cos", "tan")
_TO_ANGLE = ("asin", "acos", "atan", "atan2")
_CONVERSIONS: dict[str, Callable[..., Any]] = {"radians": np.radians, "degrees": np.degrees}


@dataclass(frozen=True)
class CellFormula:
    """A formula with its angle unit.

    Parameters
    ----------
    node : Node
        May call ``radians`` and ``degrees``.
    unit : AngleUnit
        Unit of the arguments of sin, cos, tan and of the results of asin, acos, atan, atan2.
    """

    node: Node
    unit: AngleUnit = AngleUnit.RADIAN

    def text(self, cells: Mapping[str, str]) -> str:
        """The formula in spreadsheet notation without equals sign; ``cells`` by name."""
        return _Writer(cells, self.unit is AngleUnit.DEGREE).text(self.node)

    def value(self, names: Mapping[str, Any]) -> Any:
        """The value, element by element; NaN if undefined."""
        with np.errstate(all="ignore"):
            return _value(self.node, names, self.unit.radians)


@dataclass(frozen=True)
class _Writer:
    """Spreadsheet precedence: a sign binds tighter than ``^``, which is left-associative."""

    cells: Mapping[str, str]
    degrees: bool

    def text(self, node: Node) -> str:
        match node:
            case NumberNode():
                return cell_number(node.value)
            case Name():
                return self._name(node)
            case Negative():
                # in a spreadsheet -a^2 is (-a)^2
                least = ATOM if _begins_with_power(node.operand) else STRENGTH["*"]
                return "-" + self._inside(node.operand, least)
            case Call():
                return self._call(node.function, [self.text(part) for part in node.arguments])
            case Binary() if node.operator in COMPARISONS:
                # a comparison alone would be TRUE, not 1
                left, right = self.text(node.left), self.text(node.right)
                return f"IF({left}{node.operator}{right},1,0)"
            case Binary("^"):
                left, right = (self._inside(part, ATOM) for part in (node.left, node.right))
                return f"{left}^{right}"
            case Binary():
                least = STRENGTH[node.operator]
                left = self._inside(node.left, least)
                # a - (b - c) keeps its parentheses, (a - b) - c needs none
                return f"{left}{node.operator}{self._inside(node.right, least + 1)}"

    def _name(self, node: Name) -> str:
        if node.name in self.cells:
            return self.cells[node.name]
        return {"pi": "PI()", "e": "EXP(1)"}[node.name]

    def _call(self, function: str, arguments: list[str]) -> str:
        listed = ",".join(arguments)
        if function == "hypot":
            # spreadsheets have no hypot
            return f"SQRT(({arguments[0]})^2+({arguments[1]})^2)"
        if function == "atan2":  # spreadsheets take x first
            listed = f"{arguments[1]},{arguments[0]}"
        if function in _OF_ANGLE and self.degrees:
            listed = f"RADIANS({listed})"
        shown = f"{function.upper()}({listed})"
        return f"DEGREES({shown})" if function in _TO_ANGLE and self.degrees else shown

    def _inside(self, node: Node, least: int) -> str:
        shown = self.text(node)
        return f"({shown})" if strength(node) < least else shown


def _begins_with_power(node: Node) -> bool:
    """Whether a sign before the formula would be included in a power."""
    while isinstance(node, Binary) and node.operator != "^":
        node = node.left
    return isinstance(node, Binary)


def cell_number(value: float) -> str:
    """A number in spreadsheet notation."""
    shown = repr(float(value))
    return (shown[:-2] if shown.endswith(".0") else shown).replace("e", "E")


def _value(node: Node, names: Mapping[str, Any], radians: float) -> Any:
    match node:
        case NumberNode():
            return node.value
        case Name():
            return names[node.name] if node.name in names else CONSTANTS[node.name]
        case Negative():
            return -_value(node.operand, names, radians)
        case Binary():
            left = np.asarray(_value(node.left, names, radians), dtype=float)
            right = np.asarray(_value(node.right, names, radians), dtype=float)
            return _OPERATIONS[node.operator](left, right)
        case Call():
            arguments = [_value(part, names, radians) for part in node.arguments]
            if node.function in _CONVERSIONS:
                return _CONVERSIONS[node.function](*arguments)
            if node.function in _OF_ANGLE:
                arguments = [arguments[0] * radians]
            value = FUNCTIONS[node.function](*arguments)
            return value / radians if node.function in _TO_ANGLE else value


_OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "^": np.power,
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
}  # fmt: skip


# ----------------------------------------------------------------------
# The rows of Newton-Raphson as formulas: equations, Jacobian, points, outputs.
#
# Formulas refer to unknowns and inputs by symbol, in file units, and to dimensions by key. Long
# coefficients have separate cells.


_MOST_NODES = 7  # longer coefficients get a separate cell
_OF_CELLS = 40, 7_000  # unknowns of a block, characters: a cell takes 8,192
_PER_NODE, _PER_PART = 4, 24  # characters at most: parentheses; a number or a function


@dataclass(frozen=True, kw_only=True)
class Coefficient:
    """A number computed from dimensions in a cell; ``key`` is its name in formulas."""

    key: str
    wanted: str
    formula: CellFormula


@dataclass(frozen=True, kw_only=True)
class Row:
    """One real equation F = 0: name, formula, and derivatives by the block's unknowns."""

    name: str
    formula: CellFormula
    slopes: tuple[CellFormula, ...]


@dataclass(frozen=True, kw_only=True)
class BlockFormulas:
    """A block of the equations: indices of its unknowns, and its rows; none without formulas.

    ``reason`` explains missing formulas.
    """

    unknowns: tuple[int, ...]
    rows: tuple[Row, ...] = ()
    reason: str = ""


@dataclass
class ClosureFormulas:
    """All formulas of a mechanism.

    Parameters
    ----------
    model : Model
    traced : TracedEquations
        The same equations with the formulas of their coefficients.
    most_unknowns : int
        Of a block: the corrections of a larger one do not fit into one cell.
    longest : int
        Characters of a formula.
    """

    model: Model
    traced: TracedEquations
    most_unknowns: int = _OF_CELLS[0]
    longest: int = _OF_CELLS[1]
    coefficients: dict[Node, Coefficient] = field(default_factory=dict)
    blocks: list[BlockFormulas] = field(default_factory=list)
    points: dict[str, tuple[CellFormula, CellFormula]] = field(default_factory=dict)
    links: dict[str, CellFormula] = field(default_factory=dict)
    outputs: dict[str, CellFormula] = field(default_factory=dict)
    released: list[tuple[Redundant, CellFormula]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.variables = {v.symbol: v for v in self.model.equations.variables}
        self._units: dict[str, float] = {
            v.symbol: self._angle.radians if v.kind == "angle" else 1.0
            for v in self.variables.values()
        }
        for equations, unknowns in self.model.compiled.form.blocks:
            self.blocks.append(self._block(equations, unknowns))
        for redundant in self.traced.equations.redundant:
            length = self._coefficient(forms_of(redundant.length)[0], f"{redundant.variable}_given")
            self.released.append((redundant, CellFormula(length.node)))
        self._place_points()
        for link in self.model.riding:
            self.links[link] = self._link(link)
        for name, output in self.traced.equations.outputs.items():
            if any(row_quantity(node.name) for node in names_in(output.formula)):
                continue  # a value on the sheet Linkwork
            self.outputs[name] = CellFormula(output.formula, self._angle)
            for node in names_in(output.formula):
                self._need_link(node.name)

    @property
    def _angle(self) -> AngleUnit:
        return self.model.equations.angle

    # Coefficients

    def _coefficient(self, form: LinearForm, preferred: str) -> LinearForm:
        """The form, or the name of its cell."""
        if form.fixed and _is_short(form.constant):
            return form
        if not form.fixed and _size(form.node) <= _MOST_NODES and _is_simple(form.node):
            return form
        weight = -1.0 if isinstance(form.node, Negative) else 1.0
        node = (form * weight).node
        if node not in self.coefficients:
            key = f"coefficient {len(self.coefficients) + 1}"
            formula = CellFormula(node)
            self.coefficients[node] = Coefficient(key=key, wanted=preferred, formula=formula)
        return LinearForm.named(self.coefficients[node].key) * weight

    def _parts(self, term: Term) -> tuple[LinearForm, LinearForm]:
        """Real and imaginary part of a term's coefficient."""
        stem = term.magnitude.name if isinstance(term.magnitude, Name) else "u"
        if stem == "u" and term.length is not None:
            stem = f"{term.length}_way"
        re, im = forms_of(term.value)
        return self._coefficient(re, f"{stem}_x"), self._coefficient(im, f"{stem}_y")

    # Vectors

    def turn(self, term: Term) -> LinearForm:
        """Σ weight θ in radians."""
        total = LinearForm()
        for symbol, weight in term.phase:
            total += LinearForm.named(symbol) * (weight * self._units[symbol])
        return total

    def vector(
        self, term: Term, *, length: bool = True, turned: bool = False
    ) -> tuple[LinearForm, LinearForm]:
        """Real and imaginary part of a term, or of i times the term."""
        re, im = self._parts(term)
        if turned:
            re, im = -im, re
        angle = self.turn(term)
        c, s = cosine(angle), sine(angle)
        x, y = re * c - im * s, re * s + im * c
        if length and term.length is not None:
            size = LinearForm.named(term.length)
            x, y = size * x, size * y
        return x, y

    def _slope(self, term: Term, symbol: str) -> tuple[LinearForm, LinearForm]:
        """Derivative of a term by an unknown; by angles in radians."""
        weight = dict(term.phase).get(symbol, 0.0)
        x, y = LinearForm(), LinearForm()
        if weight:
            x, y = (part * weight for part in self.vector(term, turned=True))
        if term.length == symbol:
            along = self.vector(term, length=False)
            x, y = x + along[0], y + along[1]
        return x, y

    # Blocks

    def _block(self, equations: tuple[int, ...], unknowns: tuple[int, ...]) -> BlockFormulas:
        symbols = [self.model.equations.unknowns[k].symbol for k in unknowns]
        try:
            if len(symbols) > self.most_unknowns:
                raise NoFormula(f"more than {self.most_unknowns} unknowns depend on each other")
            rows = tuple(row for k in equations for row in self._rows_of_equation(k, symbols))
            for row in rows:
                self.check_length(row.formula, *row.slopes)
        except NoFormula as error:
            return BlockFormulas(unknowns=unknowns, reason=str(error))
        return BlockFormulas(unknowns=unknowns, rows=rows)

    def _rows_of_equation(self, number: int, symbols: list[str]) -> Iterator[Row]:
        """The real rows of an equation, numbered as they are printed."""
        traced = self.traced.equations
        loops, lines, plain = len(traced.loops), len(traced.linear), len(traced.real)
        if number < loops:
            yield from self._loop_rows(number, symbols)
        elif number < loops + lines:
            yield self._linear_row(traced.linear[number - loops], f"F{number + loops + 1}", symbols)
        elif number < loops + lines + plain:
            equation = traced.real[number - loops - lines]
            yield self._real_row(equation, f"F{number + loops + 1}", symbols)
        else:
            law = traced.laws[number - loops - lines - plain]
            raise NoFormula(f'"{law.label}" is a motion law or a curve, given piece by piece')

    def _loop_rows(self, number: int, symbols: list[str]) -> Iterator[Row]:
        terms = self.traced.equations.loops[number].terms
        sums = [_total(self.vector(term) for term in terms)]
        sums += [_total(self._slope(term, symbol) for term in terms) for symbol in symbols]
        count = len(self.traced.equations.loops)
        for axis in (0, 1):
            first, *slopes = (CellFormula(pair[axis].node) for pair in sums)
            name = f"F{number + axis * count + 1}"
            yield Row(name=name, formula=first, slopes=tuple(slopes))

    def _linear_row(self, line: LinearEquation, name: str, symbols: list[str]) -> Row:
        constant = self._coefficient(forms_of(line.constant)[0], f"{line.label}_constant")
        total = constant
        for symbol, weight in line.terms:
            total += LinearForm.named(symbol) * (weight * self._units[symbol])
        weights = dict(line.terms)
        return Row(
            name=name,
            formula=CellFormula(total.angle),
            slopes=tuple(CellFormula(NumberNode(weights.get(symbol, 0.0))) for symbol in symbols),
        )

    def _real_row(self, equation: RealEquation, name: str, symbols: list[str]) -> Row:
        whole: Node = equation.left
        if equation.right != NumberNode(0.0):
            whole = Binary("-", equation.left, equation.right)
        try:
            slopes = [derivative(whole, symbol, self._angle.radians) for symbol in symbols]
        except ValueError as error:
            raise NoFormula(f'"{equation.label}": {error}') from None
        return Row(
            name=name,
            formula=CellFormula(whole, self._angle),
            slopes=tuple(CellFormula(slope, self._angle) for slope in slopes),
        )

    def check_length(self, *formulas: CellFormula) -> None:
        """Raise :class:`NoFormula` for a formula that is too long."""
        for formula in formulas:
            length = 0
            for part in _parts_of(formula.node):  # stops early: a derivative can have millions
                length += len(part.name) + _PER_NODE if isinstance(part, Name) else _PER_PART
                if length > self.longest:
                    raise NoFormula("its formula is too long")

    # Links, points and outputs

    def _place_points(self) -> None:
        order = getattr(self.model.description, "points", {})
        paths = self.traced.equations.points
        for point, path in paths.items():
            if point not in order and all(path.parent != point for path in paths.values()):
                continue
            x, y = _total(self.vector(term) for term in path.terms)
            if path.parent is not None:
                x = LinearForm.named(coordinate_name(path.parent, "x")) + x
                y = LinearForm.named(coordinate_name(path.parent, "y")) + y
            self.points[point] = (CellFormula(x.node), CellFormula(y.node))

    def _need_link(self, name: str) -> None:
        """Add a link whose angle is used by an output but is not an unknown."""
        for link in self.traced.equations.links:
            if canonical(link) == name and name not in self.variables:
                self.links[link] = self._link(link)

    def _link(self, link: str) -> CellFormula:
        angle = self.traced.equations.links[link]
        total = forms_of(angle.constant)[0]
        if angle.variable is not None:
            symbol = canonical(angle.variable)
            total += LinearForm.named(symbol) * self._units[symbol]
        return CellFormula(total.in_degrees if self._angle is AngleUnit.DEGREE else total.node)


class NoFormula(Exception):
    """A quantity without a cell formula."""


def _total(parts: Iterator[tuple[LinearForm, LinearForm]]) -> tuple[LinearForm, LinearForm]:
    x, y = LinearForm(), LinearForm()
    for part_x, part_y in parts:
        x, y = x + part_x, y + part_y
    return x, y


def _is_short(number: float) -> bool:
    return float(f"{number:.12g}") == number


def _parts_of(node: Node) -> Iterator[Node]:
    yield node
    match node:
        case Negative():
            yield from _parts_of(node.operand)
        case Binary():
            yield from _parts_of(node.left)
            yield from _parts_of(node.right)
        case Call():
            for argument in node.arguments:
                yield from _parts_of(argument)
        case Name() | NumberNode():
            return


def _size(node: Node) -> int:
    return sum(1 for _ in _parts_of(node))


def _is_simple(node: Node) -> bool:
    """Whether a formula is simple: no functions, long numbers or quotients."""
    return all(
        not isinstance(part, Call)
        and not (isinstance(part, NumberNode) and not _is_short(part.value))
        and not (isinstance(part, Binary) and part.operator in "/^")
        for part in _parts_of(node)
    )
