"""The equations of a mechanism as formulas of its dimensions, unknowns and inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Redundant, Term
from linkwork.core.expression.derivatives import Functions, derivative, evaluate_by
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
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.traced import (
    LinearForm,
    TracedEquations,
    cosine,
    form_of,
    forms_of,
    in_radians,
    sine,
)

_OF_ANGLE = ("sin", "cos", "tan")
_TO_ANGLE = ("asin", "acos", "atan", "atan2")


def rebuilt(node: Node, change: Callable[[Node], Node]) -> Node:
    """A formula whose parts are changed, inner ones first."""
    match node:
        case Negative():
            node = Negative(rebuilt(node.operand, change))
        case Binary():
            node = Binary(node.operator, rebuilt(node.left, change), rebuilt(node.right, change))
        case Call():
            node = Call(node.function, tuple(rebuilt(part, change) for part in node.arguments))
    return change(node)


def of_radians(node: Node, unit: AngleUnit) -> Node:
    """A formula of the file with functions of radians: in degrees ``sin(x)`` is sin(radians(x))."""

    def converted(part: Node) -> Node:
        if isinstance(part, Call) and part.function in _OF_ANGLE:
            return Call(part.function, (Call("radians", part.arguments),))
        if isinstance(part, Call) and part.function in _TO_ANGLE:
            return Call("degrees", (part,))
        return part

    return node if unit is AngleUnit.RADIAN else rebuilt(node, converted)


_COMPARE = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}
_ARRAYS: Functions[Any] = Functions(
    literal=np.float64,
    rounded=np.float64,
    plain={name: f for name, f in FUNCTIONS.items() if name not in (*_OF_ANGLE, *_TO_ANGLE)}
    | {"radians": np.radians, "degrees": np.degrees},
    of_angle={name: FUNCTIONS[name] for name in _OF_ANGLE},
    to_angle={name: FUNCTIONS[name] for name in _TO_ANGLE},
    compared=lambda operator, left, right: _COMPARE[operator](left, right).astype(float),
)


def value_of(node: Node, names: Mapping[str, Any]) -> Any:
    """The value of a formula, element by element; NaN if undefined."""
    used = {n.name for n in names_in(node)} & names.keys()
    numbers = {name: np.asarray(names[name], dtype=float) for name in used}
    with np.errstate(all="ignore"):
        return evaluate_by(_ARRAYS, node, numbers, AngleUnit.RADIAN)


# ----------------------------------------------------------------------
# Formulas as texts of spreadsheets and programs.


class UniqueNames:
    """Names by key, which differ in more than upper and lower case; ``of`` has them."""

    def __init__(self) -> None:
        self.of: dict[str, str] = {}
        self._used: set[str] = set()

    def stem(self, preferred: str) -> str:
        """A preferred name in the characters that are allowed."""
        raise NotImplementedError

    def is_taken(self, name: str) -> bool:
        """Whether a name means something else."""
        return name.casefold() in self._used

    def claim(self, key: str, preferred: str) -> str:
        """The name for ``key``, a new one as similar as possible to the preferred one."""
        if key not in self.of:
            stem, count = self.stem(preferred), 1
            name = stem
            while self.is_taken(name):
                count += 1
                name = f"{stem.rstrip('_')}_{count}"
            self._used.add(name.casefold())
            self.of[key] = name
        return self.of[key]


@dataclass(frozen=True, kw_only=True)
class Notation:
    """How formulas are written.

    Parameters
    ----------
    functions : Mapping[str, str]
        Forms of functions, ``^``, comparisons, and the constants ``pi`` and ``e``; ``square``, if
        it exists, of a name to the power 2.
    number : callable
        The text of a number.
    space : str
        Before and after ``+`` and ``-``.
    """

    functions: Mapping[str, str]
    number: Callable[[float], str]
    space: str = " "


@dataclass
class FormulaText:
    """Formulas in a notation.

    Parameters
    ----------
    notation : Notation
    names : Mapping[str, str]
        Names in the text by the names of formulas.
    """

    notation: Notation
    names: Mapping[str, str]

    def text(self, node: Node) -> str:
        """The text of a formula."""
        forms = self.notation.functions
        match node:
            case NumberNode():
                return self.notation.number(node.value)
            case Name():
                return self.name(node.name)
            case Negative():
                # in a spreadsheet -a^2 is (-a)^2
                power = _begins_with_power(node.operand)
                return "-" + self._inside(node.operand, ATOM if power else STRENGTH["*"])
            case Call():
                return self.call(node)
            case Binary("^", Name(name), NumberNode(2.0)) if "square" in forms:
                return forms["square"].format(self.name(name))
            case Binary("+" | "-" | "*" | "/"):
                least = STRENGTH[node.operator]
                space = self.notation.space if node.operator in "+-" else ""
                left = self.text(node.left)
                left = f"({left})" if strength(node.left) < least else left
                # a - (b - c) keeps its parentheses, (a - b) - c needs none
                return f"{left}{space}{node.operator}{space}{self._inside(node.right, least + 1)}"
            case Binary():
                form = forms[node.operator]
                least = ATOM if form.startswith("{") else 0
                parts = (self._inside(part, least) for part in (node.left, node.right))
                return form.format(*parts)

    def name(self, name: str) -> str:
        """The text of a name or of a constant."""
        return self.names[name] if name in self.names else self.notation.functions[name]

    def call(self, node: Call) -> str:
        """The text of a function, of three or more numbers pair by pair."""
        form = self.notation.functions[node.function]
        first, *others = (self.text(part) for part in node.arguments)
        if len(others) < 2:
            return form.format(first, *others)
        for other in others:
            first = form.format(first, other)
        return first

    def _inside(self, node: Node, least: int) -> str:
        """A part that is weaker than its surroundings, or has a sign, in parentheses."""
        shown = self.text(node)
        return f"({shown})" if strength(node) < least or shown.startswith("-") else shown


def _begins_with_power(node: Node) -> bool:
    """Whether a sign before the formula would be included in a power."""
    while isinstance(node, Binary) and node.operator != "^":
        node = node.left
    return isinstance(node, Binary)


def cell_number(value: float) -> str:
    """A number in spreadsheet notation."""
    shown = repr(float(value))
    return (shown[:-2] if shown.endswith(".0") else shown).replace("e", "E")


_PLAIN = (*_OF_ANGLE, "asin", "acos", "atan", "sqrt", "exp", "ln", "log10", "abs", "radians")
#: The formulas of cells.
CELLS = Notation(
    functions={name: f"{name.upper()}({{}})" for name in (*_PLAIN, "degrees")}
    | {name: f"{name.upper()}({{}},{{}})" for name in ("min", "max")}
    | {sign: f"IF({{}}{sign}{{}},1,0)" for sign in COMPARISONS}  # alone it would be TRUE, not 1
    | {
        "atan2": "ATAN2({1},{0})",  # spreadsheets take x first
        "hypot": "SQRT(({})^2+({})^2)",  # and have no hypot
        "^": "{}^{}", "pi": "PI()", "e": "EXP(1)",
    },
    number=cell_number,
    space="",
)  # fmt: skip


def cell_text(node: Node, cells: Mapping[str, str]) -> str:
    """A formula in spreadsheet notation without equals sign; ``cells`` by name."""
    return FormulaText(CELLS, cells).text(node)


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
    formula: Node


@dataclass(frozen=True, kw_only=True)
class Row:
    """One real equation F = 0: name, formula, and derivatives by the block's unknowns."""

    name: str
    formula: Node
    slopes: tuple[Node, ...]


@dataclass(frozen=True, kw_only=True)
class BlockFormulas:
    """A block of the equations: indices of its unknowns, and its rows; none without formulas.

    ``reason`` explains missing formulas.
    """

    unknowns: tuple[int, ...]
    rows: tuple[Row, ...] = ()
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A number computed from the unknowns: the angle of a link, a coordinate, or an output.

    ``of`` is ``link``, ``point`` or ``output``; ``key`` its name in formulas.
    """

    of: str
    key: str
    shown: str
    kind: Kind
    formula: Node


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

    Notes
    -----
    ``quantities`` are links that turn with other links, points and outputs, each after its
    operands; ``points`` the names of the points; ``released`` the stated lengths of redundant
    links.
    """

    model: Model
    traced: TracedEquations
    most_unknowns: int = _OF_CELLS[0]
    longest: int = _OF_CELLS[1]
    coefficients: dict[Node, Coefficient] = field(default_factory=dict)
    blocks: list[BlockFormulas] = field(default_factory=list)
    quantities: list[Quantity] = field(default_factory=list)
    points: list[str] = field(default_factory=list)
    released: list[tuple[Redundant, Node]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._units: dict[str, float] = {
            v.symbol: self.model.units.scale(Kind(v.kind)) for v in self.model.equations.variables
        }
        for equations, unknowns in self.model.compiled.form.blocks:
            self.blocks.append(self._block(equations, unknowns))
        for redundant in self.traced.equations.redundant:
            length = self._coefficient(forms_of(redundant.length)[0], f"{redundant.variable}_given")
            self.released.append((redundant, length.node))
        outputs = {
            name: output
            for name, output in self.traced.equations.outputs.items()
            # others are values on the sheet Linkwork
            if not any(row_quantity(node.name) for node in names_in(output.formula))
        }
        used = {node.name for output in outputs.values() for node in names_in(output.formula)}
        needed = [link for link in self.traced.equations.links if canonical(link) in used]
        for link in dict.fromkeys([*self.model.riding, *needed]):
            if canonical(link) not in self._units:
                self._add("link", canonical(link), link, Kind.ANGLE, self._link(link))
        self._place_points()
        for name, output in outputs.items():
            formula = of_radians(output.formula, self._angle)
            self._add("output", f"output {name}", name, Kind(output.kind), formula)

    def _add(self, of: str, key: str, shown: str, kind: Kind, formula: Node) -> None:
        made = Quantity(of=of, key=key, shown=shown, kind=kind, formula=formula)
        self.quantities.append(made)

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
            self.coefficients[node] = Coefficient(key=key, wanted=preferred, formula=node)
        return LinearForm.named(self.coefficients[node].key) * weight

    def _parts(self, term: Term) -> tuple[LinearForm, LinearForm]:
        """Real and imaginary part of a term's coefficient."""
        stem = term.magnitude.name if isinstance(term.magnitude, Name) else "u"
        if stem == "u" and term.length is not None:
            stem = f"{term.length}_way"
        re, im = forms_of(term.value)
        return self._coefficient(re, f"{stem}_x"), self._coefficient(im, f"{stem}_y")

    # Vectors

    def _vector(self, term: Term) -> tuple[LinearForm, LinearForm]:
        """Real and imaginary part of a term."""
        re, im = self._parts(term)
        angle = LinearForm()
        for symbol, weight in term.phase:
            angle += LinearForm.named(symbol) * (weight * self._units[symbol])
        c, s = cosine(angle), sine(angle)
        x, y = re * c - im * s, re * s + im * c
        if term.length is not None:
            size = LinearForm.named(term.length)
            x, y = size * x, size * y
        return x, y

    def _sum(self, terms: Iterable[Term]) -> tuple[LinearForm, LinearForm]:
        """Real and imaginary part of a sum of terms."""
        x, y = LinearForm(), LinearForm()
        for term in terms:
            re, im = self._vector(term)
            x, y = x + re, y + im
        return x, y

    @cached_property
    def rates(self) -> dict[str, LinearForm]:
        """How fast each variable changes in file units, by a unit of its angle in radians."""
        return {symbol: LinearForm(1.0 / unit) for symbol, unit in self._units.items()}

    # Blocks

    def _block(self, equations: tuple[int, ...], unknowns: tuple[int, ...]) -> BlockFormulas:
        symbols = [self.model.equations.unknowns[k].symbol for k in unknowns]
        try:
            if len(symbols) > self.most_unknowns:
                raise NoFormula(f"more than {self.most_unknowns} unknowns depend on each other")
            rows = tuple(
                self._row(name, formula, symbols)
                for k in equations
                for name, formula in self._formulas_of_equation(k)
            )
        except NoFormula as error:
            return BlockFormulas(unknowns=unknowns, reason=str(error))
        return BlockFormulas(unknowns=unknowns, rows=rows)

    def _row(self, name: str, formula: Node, symbols: list[str]) -> Row:
        slopes = (rate_of(formula, {symbol: self.rates[symbol]}).node for symbol in symbols)
        row = Row(name=name, formula=formula, slopes=tuple(slopes))
        self.check_length(row.formula, *row.slopes)
        return row

    def _formulas_of_equation(self, number: int) -> Iterator[tuple[str, Node]]:
        """Name and formula of the real rows of an equation, numbered as they are printed."""
        traced = self.traced.equations
        loops, lines, plain = len(traced.loops), len(traced.linear), len(traced.real)
        if number < loops:
            x, y = self._sum(traced.loops[number].terms)
            yield f"F{number + 1}", x.node
            yield f"F{number + loops + 1}", y.node
        elif number < loops + lines:
            line = traced.linear[number - loops]
            total = self._coefficient(forms_of(line.constant)[0], f"{line.label}_constant")
            for symbol, weight in line.terms:
                total += LinearForm.named(symbol) * (weight * self._units[symbol])
            yield f"F{number + loops + 1}", total.angle
        elif number < loops + lines + plain:
            equation = traced.real[number - loops - lines]
            whole: Node = equation.left
            if equation.right != NumberNode(0.0):
                whole = Binary("-", equation.left, equation.right)
            yield f"F{number + loops + 1}", of_radians(whole, self._angle)
        else:
            law = traced.laws[number - loops - lines - plain]
            raise NoFormula(f'"{law.label}" is a motion law or a curve, given piece by piece')

    def check_length(self, *formulas: Node) -> None:
        """Raise :class:`NoFormula` for a formula that is too long."""
        for formula in formulas:
            length = 0
            for part in _parts_of(formula):  # stops early: a derivative can have millions
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
            self.points.append(point)
            for axis, form in zip("xy", self._sum(path.terms), strict=True):
                if path.parent is not None:
                    form = LinearForm.named(coordinate_name(path.parent, axis)) + form
                key, shown = coordinate_name(point, axis), f"{point}.{axis}"
                self._add("point", key, shown, Kind.LENGTH, form.node)

    def _link(self, link: str) -> Node:
        angle = self.traced.equations.links[link]
        total = forms_of(angle.constant)[0]
        if angle.variable is not None:
            symbol = canonical(angle.variable)
            total += LinearForm.named(symbol) * self._units[symbol]
        return total.in_degrees if self._angle is AngleUnit.DEGREE else total.node


class NoFormula(Exception):
    """A quantity without a cell formula."""


def rate_of(node: Node, rates: Mapping[str, LinearForm]) -> LinearForm:
    """The derivative of a formula by time.

    Parameters
    ----------
    rates : Mapping[str, LinearForm]
        The derivatives of names; all others are constant.

    Raises
    ------
    NoFormula
        For functions without a derivative in one formula.
    """
    match node:
        case NumberNode():
            return LinearForm()
        case Name():
            return rates.get(node.name, LinearForm())
        case Negative():
            return -rate_of(node.operand, rates)
        case Binary("+"):
            return rate_of(node.left, rates) + rate_of(node.right, rates)
        case Binary("-"):
            return rate_of(node.left, rates) - rate_of(node.right, rates)
        case Binary("*"):
            left, right = form_of(node.left), form_of(node.right)
            return left * rate_of(node.right, rates) + rate_of(node.left, rates) * right
        case Call("radians", (angle,)):
            return in_radians(rate_of(angle, rates))
        case Call("degrees", (angle,)):
            return rate_of(angle, rates) * (1.0 / AngleUnit.DEGREE.radians)
        case Binary():
            return _chained(node, (node.left, node.right), rates)
        case Call():
            return _chained(node, node.arguments, rates)


def _chained(
    node: Binary | Call, parts: tuple[Node, ...], rates: Mapping[str, LinearForm]
) -> LinearForm:
    """The derivative of a function of some parts."""
    total = LinearForm()
    for k, part in enumerate(parts):
        change = rate_of(part, rates)
        if not change.zero:
            total += form_of(_slope(node, parts, k)) * change
    return total


def _slope(node: Binary | Call, parts: tuple[Node, ...], k: int) -> Node:
    """The derivative of a function by one of its arguments."""
    moved: list[Node] = [*parts]
    moved[k] = hole = Name("argument")
    whole: Node
    if isinstance(node, Call):
        whole = Call(node.function, tuple(moved))
    else:
        whole = Binary(node.operator, moved[0], moved[1])
    try:
        slope = derivative(whole, hole.name)
    except ValueError as error:
        raise NoFormula(str(error)) from None
    return rebuilt(slope, lambda part: parts[k] if part == hole else part)


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
