"""The rows of Newton-Raphson as formulas: equations, Jacobian, points, outputs.

Formulas refer to unknowns and inputs by symbol, in file units, and to dimensions by key. Long
coefficients have their own cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from linkwork.equations.compiling import coordinate_name
from linkwork.equations.model import LinearEquation, RealEquation, Redundant, Term
from linkwork.export.formulas.cell_formula import CellFormula
from linkwork.export.formulas.linear_form import LinearForm, cosine, sine
from linkwork.export.formulas.traced_equations import TracedEquations, forms_of
from linkwork.expression.derivative import derivative
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number, names_in
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.names import canonical
from linkwork.motion.model import Model
from linkwork.results import quantities

__all__ = ["BlockFormulas", "ClosureFormulas", "Coefficient", "NoFormula", "Row"]

_MOST_NODES = 7  # longer coefficients get their own cell
_OF_CELLS = 40, 7_000  # unknowns of a block, characters: a cell takes 8,192
_PER_NODE, _PER_PART = 4, 24  # characters at most: parentheses; a number or a function


@dataclass(frozen=True, kw_only=True)
class Coefficient:
    """A number computed from dimensions in its own cell; ``key`` is its name in formulas."""

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
            if any(quantities.row_quantity(node.name) for node in names_in(output.formula)):
                continue  # a value on the sheet Linkwork
            self.outputs[name] = CellFormula(output.formula, self._angle)
            for node in names_in(output.formula):
                self._need_link(node.name)

    @property
    def _angle(self) -> AngleUnit:
        return self.model.equations.angle

    # Coefficients

    def _coefficient(self, form: LinearForm, wanted: str) -> LinearForm:
        """The form, or the name of its cell."""
        if form.fixed and _is_short(form.constant):
            return form
        if not form.fixed and _size(form.node) <= _MOST_NODES and _plain(form.node):
            return form
        weight = -1.0 if isinstance(form.node, Negative) else 1.0
        node = (form * weight).node
        if node not in self.coefficients:
            key = f"coefficient {len(self.coefficients) + 1}"
            formula = CellFormula(node)
            self.coefficients[node] = Coefficient(key=key, wanted=wanted, formula=formula)
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
            own = LinearForm.named(term.length)
            x, y = own * x, own * y
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
            rows = tuple(row for k in equations for row in self._rows(k, symbols))
            for row in rows:
                self.check_length(row.formula, *row.slopes)
        except NoFormula as error:
            return BlockFormulas(unknowns=unknowns, reason=str(error))
        return BlockFormulas(unknowns=unknowns, rows=rows)

    def _rows(self, number: int, symbols: list[str]) -> Iterator[Row]:
        """The real rows of an equation, numbered as they are printed."""
        found = self.traced.equations
        loops, lines, plain = len(found.loops), len(found.linear), len(found.real)
        if number < loops:
            yield from self._loop_rows(number, symbols)
        elif number < loops + lines:
            yield self._linear_row(found.linear[number - loops], f"F{number + loops + 1}", symbols)
        elif number < loops + lines + plain:
            equation = found.real[number - loops - lines]
            yield self._real_row(equation, f"F{number + loops + 1}", symbols)
        else:
            law = found.laws[number - loops - lines - plain]
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
            slopes=tuple(CellFormula(Number(weights.get(symbol, 0.0))) for symbol in symbols),
        )

    def _real_row(self, equation: RealEquation, name: str, symbols: list[str]) -> Row:
        whole: Node = equation.left
        if equation.right != Number(0.0):
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
    for own_x, own_y in parts:
        x, y = x + own_x, y + own_y
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
        case Name() | Number():
            return


def _size(node: Node) -> int:
    return sum(1 for _ in _parts_of(node))


def _plain(node: Node) -> bool:
    """Whether a formula is simple: no functions, long numbers or quotients."""
    return all(
        not isinstance(part, Call)
        and not (isinstance(part, Number) and not _is_short(part.value))
        and not (isinstance(part, Binary) and part.operator in "/^")
        for part in _parts_of(node)
    )
