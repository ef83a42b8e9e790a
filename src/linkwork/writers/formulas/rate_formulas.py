"""Velocities and accelerations as formulas: the closure equations differentiated by time.

J q̇ = -∂F/∂u u̇ and J q̈ = -(the second derivative of F without the terms of q̈), block by block.
Rates of angles are in radians per second; a rate's key is that of its quantity with its order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Term
from linkwork.core.expression.derivatives import derivative, product_of, sum_of
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import CellFormula, ClosureFormulas, NoFormula
from linkwork.writers.formulas.traced import LinearForm, TracedEquations, forms_of

Pair = tuple[CellFormula, CellFormula]
Vector = tuple[LinearForm, LinearForm]

_ZERO = LinearForm()


def rate_key(quantity: str, order: int) -> str:
    """The key of a quantity's velocity (order 1) or acceleration (order 2)."""
    return f"{quantity} rate {order}"


@dataclass
class RateFormulas:
    """The right-hand sides of every block, and the rates of links, points and outputs.

    ``sides[block]`` has velocity and acceleration of every row with the rates of the unknowns of
    the block at 0, and nothing without formulas; ``of`` the rates of other quantities by key, as
    far as they have formulas.
    """

    closure: ClosureFormulas
    sides: list[tuple[Pair, ...]] = field(default_factory=list)
    of: dict[str, Pair] = field(default_factory=dict)

    def __post_init__(self) -> None:
        equations = self.closure.model.equations
        self._moved = {v.symbol for v in equations.unknowns}
        self._every = {v.symbol for v in equations.variables}
        for (numbers, unknowns), block in zip(
            self.closure.model.compiled.form.blocks, self.closure.blocks, strict=True
        ):
            solved = {equations.unknowns[k].symbol for k in unknowns}
            try:
                pairs = (pair for k in numbers for pair in self._side(k, solved))
                self.sides.append(tuple(pairs) if block.rows else ())
            except NoFormula:
                self.sides.append(())
        for name, angle in self.closure.traced.equations.links.items():
            if name in self.closure.links and angle.variable is not None:
                symbol = canonical(angle.variable)
                second: Node = (
                    Name(rate_key(symbol, 2)) if symbol in self._moved else NumberNode(0.0)
                )
                pair = CellFormula(Name(rate_key(symbol, 1))), CellFormula(second)
                self.of[canonical(name)] = pair
        self._place_points()
        self._differentiate_outputs()

    # Right-hand sides

    def _side(self, number: int, solved: set[str]) -> Iterator[Pair]:
        """The rates of the rows of one equation."""
        equations = self.closure.traced.equations
        loops, lines = len(equations.loops), len(equations.linear)
        if number < loops:
            terms = equations.loops[number].terms
            x1, y1 = _total(self._velocity(term, self._every - solved) for term in terms)
            x2, y2 = _total(self._acceleration(term, self._moved - solved) for term in terms)
            yield CellFormula(x1.node), CellFormula(x2.node)
            yield CellFormula(y1.node), CellFormula(y2.node)
        elif number < loops + lines:
            weights = equations.linear[number - loops].terms
            first = self._turning(weights, 1, self._every - solved)
            second = self._turning(weights, 2, self._moved - solved)
            yield CellFormula(first.node), CellFormula(second.node)
        else:
            equation = equations.real[number - loops - lines]
            whole = Binary("-", equation.left, equation.right)
            yield self._differentiated(whole, held=solved)

    @staticmethod
    def _turning(weights: Iterable[tuple[str, float]], order: int, symbols: set[str]) -> LinearForm:
        """Σ weight · rate of some symbols."""
        total = _ZERO
        for symbol, weight in weights:
            if symbol in symbols:
                total += LinearForm.named(rate_key(symbol, order)) * weight
        return total

    def _velocity(self, term: Term, symbols: set[str]) -> Vector:
        """ω i z + ṡ z/s of a term z, by the rates of ``symbols``."""
        x, y = _scaled(self._turning(term.phase, 1, symbols), self.closure.vector, term, True)
        if term.length in symbols:
            along = LinearForm.named(rate_key(term.length or "", 1))
            x, y = _total([(x, y), _scaled(along, self.closure.vector, term, False, length=False)])
        return x, y

    def _acceleration(self, term: Term, symbols: set[str]) -> Vector:
        """α i z - ω² z + 2 ω ṡ i z/s + s̈ z/s, with α and s̈ of ``symbols`` only."""
        vector = self.closure.vector
        spin = self._turning(term.phase, 1, self._every)
        parts = [
            _scaled(self._turning(term.phase, 2, symbols), vector, term, True),
            _scaled(-(spin * spin), vector, term, False),
        ]
        if term.length is not None and term.length in self._every:
            rate = LinearForm.named(rate_key(term.length, 1))
            parts.append(_scaled(spin * rate * 2.0, vector, term, True, length=False))
            if term.length in symbols:
                rate = LinearForm.named(rate_key(term.length, 2))
                parts.append(_scaled(rate, vector, term, False, length=False))
        return _total(parts)

    # Points and outputs

    def _place_points(self) -> None:
        for point, path in self.closure.traced.equations.points.items():
            if point not in self.closure.points:
                continue
            pairs = [
                _total(self._velocity(term, self._every) for term in path.terms),
                _total(self._acceleration(term, self._moved) for term in path.terms),
            ]
            for k, axis in enumerate("xy"):
                forms = [pair[k] for pair in pairs]
                parent = coordinate_name(path.parent, axis) if path.parent else ""
                if parent in self.of:
                    forms = [
                        LinearForm.named(rate_key(parent, order)) + form
                        for order, form in zip((1, 2), forms, strict=True)
                    ]
                if not all(form.zero for form in forms):  # else it is at rest
                    first, second = (CellFormula(form.node) for form in forms)
                    self.of[coordinate_name(point, axis)] = (first, second)

    def _differentiate_outputs(self) -> None:
        """Add the outputs whose formulas have derivatives."""
        equations = self.closure.model.equations
        for name, formula in self.closure.outputs.items():
            try:
                pair = self._differentiated(formula.node, held=set())
            except NoFormula:
                continue
            if equations.outputs[name].kind == "angle" and self._degrees:
                first, second = (
                    CellFormula(Call("radians", (part.node,)), part.unit) for part in pair
                )
                pair = first, second
            self.of[f"output {name}"] = pair

    @property
    def _degrees(self) -> bool:
        return self.closure.model.equations.angle is AngleUnit.DEGREE

    def _differentiated(self, node: Node, held: set[str]) -> Pair:
        """Both rates of a formula in file units; the accelerations of ``held`` are left out."""
        unit = self.closure.model.equations.angle
        moving = {n.name: n for n in names_in(node) if self._moves(n.name)}
        first: Node = NumberNode(0.0)
        second: Node = NumberNode(0.0)
        try:
            for symbol in moving:
                slope = derivative(node, symbol, unit.radians)
                self.closure.check_length(CellFormula(slope))
                if symbol not in held:
                    first = sum_of(first, product_of(slope, self._rate(symbol, 1)))
                    if symbol in self._moved or symbol in self.of:
                        second = sum_of(second, product_of(slope, self._rate(symbol, 2)))
                for other in moving:
                    bend = derivative(slope, other, unit.radians)
                    rates = product_of(self._rate(symbol, 1), self._rate(other, 1))
                    second = sum_of(second, product_of(bend, rates))
        except ValueError as error:
            raise NoFormula(str(error)) from None
        pair = CellFormula(first, unit), CellFormula(second, unit)
        self.closure.check_length(*pair)
        return pair

    def _moves(self, name: str) -> bool:
        return name in self._every or name in self.of

    def _rate(self, name: str, order: int) -> Node:
        """A rate in file units."""
        rate = Name(rate_key(name, order))
        variable = self.closure.variables.get(name)
        turns = variable.kind == "angle" if variable else "." not in name
        return Call("degrees", (rate,)) if turns and self._degrees else rate


def _scaled(
    factor: LinearForm,
    vector: Callable[..., Vector],
    term: Term,
    turned: bool,
    length: bool = True,
) -> Vector:
    """A factor times a term's vector."""
    if factor.zero:
        return _ZERO, _ZERO
    x, y = vector(term, turned=turned, length=length)
    return x * factor, y * factor


def _total(parts: Iterable[Vector]) -> Vector:
    x, y = _ZERO, _ZERO
    for part_x, part_y in parts:
        x, y = x + part_x, y + part_y
    return x, y


# ----------------------------------------------------------------------
# The units of named dimensions, which follow from their place in the equations.


_OF_ANGLE = ("sin", "cos", "tan", "radians", "degrees")
_KINDS = {"lengths": Kind.LENGTH, "angles": Kind.ANGLE, "points": Kind.LENGTH}  # of tables
_ALIKE = ("abs", "min", "max", "hypot")


def dimension_kinds(traced: TracedEquations) -> dict[str, Kind]:
    """The kind of every dimension whose place in the equations decides it, by key.

    A dimension that is added to a length, or scaled by plain numbers to one, is a length; the
    argument of a sine is an angle. A factor of a product of dimensions is left open, and so is a
    dimension that is used as two kinds.
    """
    kinds = _Kinds()
    equations = traced.equations
    for form, kind in _known_kinds(traced):
        kinds.read(form, kind)
    for line in equations.linear:
        kind = Kind.ANGLE if line.kind == "angle" else Kind.LENGTH
        kinds.read(forms_of(line.constant)[0].node, kind)
    for angle in equations.links.values():
        kinds.read(forms_of(angle.constant)[0].node, Kind.ANGLE)
    for dimension in traced.dimensions:
        if dimension.kind in _KINDS and dimension.formula is not None:
            kinds.read(dimension.formula, _KINDS[dimension.kind])
    for _ in traced.dimensions:  # a chain of derived dimensions is as long as their number
        known = len(kinds.of)
        for dimension in traced.dimensions:
            if dimension.formula is None:
                continue
            dimension_kind = kinds.of.get(dimension.key) or kinds.kind_of(dimension.formula)
            if dimension_kind is not None:
                kinds.read(Name(dimension.key), dimension_kind)
                kinds.read(dimension.formula, dimension_kind)
        if len(kinds.of) == known:
            break
    return {key: kind for key, kind in kinds.of.items() if kind is not None}


def _known_kinds(traced: TracedEquations) -> Iterator[tuple[Node, Kind]]:
    """The coefficients of all vectors with their kinds."""
    equations = traced.equations
    terms: list[Term] = [term for loop in equations.loops for term in loop.terms]
    terms += [term for path in equations.points.values() for term in path.terms]
    for term in terms:
        kind = Kind.LENGTH if term.length is None else Kind.NUMBER
        for form in forms_of(term.value):
            yield form.node, kind


@dataclass
class _Kinds:
    """The kinds read so far; ``None`` for a dimension used as two kinds."""

    of: dict[str, Kind | None] = field(default_factory=dict)

    def read(self, node: Node, kind: Kind) -> None:
        """Derive the kinds of the parts of a formula from the kind of the formula."""
        match node:
            case Name():
                known = self.of.setdefault(node.name, kind)
                if known is not kind:
                    self.of[node.name] = None
            case Negative():
                self.read(node.operand, kind)
            case Binary("+" | "-"):
                self.read(node.left, kind)
                self.read(node.right, kind)
            case Binary("*" | "/"):
                self._product(node, kind)
            case Call() if node.function in _OF_ANGLE:
                self.read(node.arguments[0], Kind.ANGLE)
            case Call() if node.function in _ALIKE:
                for argument in node.arguments:
                    self.read(argument, kind)
            case Binary() | Call() | NumberNode():
                return

    def kind_of(self, node: Node) -> Kind | None:
        """The kind of a formula of dimensions whose kinds are known."""
        match node:
            case Name():
                return self.of.get(node.name)
            case Negative():
                return self.kind_of(node.operand)
            case Binary("+" | "-"):
                return self.kind_of(node.left) or self.kind_of(node.right)
            case Binary("*" | "/") if _is_plain(node.right):
                return self.kind_of(node.left)
            case Binary("*") if _is_plain(node.left):
                return self.kind_of(node.right)
            case _:
                return None

    def _product(self, node: Binary, kind: Kind) -> None:
        """A product: its only factor with a dimension has its kind."""
        left, right = (not _is_plain(part) for part in (node.left, node.right))
        for part in (node.left, node.right):
            if _is_plain(part):
                self.read(part, Kind.NUMBER)
        if left and not right:
            self.read(node.left, kind)
        elif right and not left and node.operator == "*":
            self.read(node.right, kind)


def _is_plain(node: Node) -> bool:
    """Whether a factor is a number: it has no dimensions, or they are in angles."""
    match node:
        case NumberNode():
            return True
        case Call() if node.function in ("sin", "cos", "tan"):
            return True
        case Negative():
            return _is_plain(node.operand)
        case Binary("*" | "/"):
            return _is_plain(node.left) and _is_plain(node.right)
        case _:
            return not any(True for _ in names_in(node))
