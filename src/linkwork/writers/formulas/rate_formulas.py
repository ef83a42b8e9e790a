"""Velocities and accelerations as formulas: the closure equations differentiated by time.

J q̇ = -∂F/∂u u̇ and J q̈ = -(the second derivative of F without the terms of q̈), block by block.
Rates of angles are in radians per second; a rate's key is that of its quantity with its order.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, field
from functools import cached_property

from linkwork.core.equations.model import Term
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import ClosureFormulas, NoFormula, rate_of
from linkwork.writers.formulas.traced import LinearForm, TracedEquations, forms_of

Pair = tuple[Node, Node]


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
        closure, equations = self.closure, self.closure.model.equations
        unknowns = {v.symbol for v in equations.unknowns}
        # names of formulas with their derivatives, then these with theirs: inputs are even
        self._rates = {
            symbol: self._named(symbol, 1, form) for symbol, form in closure.rates.items()
        }
        self._bends = {rate_key(symbol, 1): self._named(symbol, 2) for symbol in unknowns}
        for block in closure.blocks:
            held = {equations.unknowns[k].symbol for k in block.unknowns}
            try:
                self.sides.append(tuple(self._pair(row.formula, held) for row in block.rows))
            except NoFormula:
                self.sides.append(())
        for quantity in closure.quantities:
            key = quantity.key
            turns = quantity.kind is Kind.ANGLE
            unit = closure.model.units.scale(Kind.ANGLE) if turns else 1.0
            try:
                pair = self._pair(quantity.formula, unit=unit)
            except NoFormula:
                continue
            if quantity.of == "output" or any(part != NumberNode(0.0) for part in pair):
                self.of[key] = pair  # else it is at rest
                self._rates[key] = self._named(key, 1, LinearForm(1.0 / unit))
                self._bends[rate_key(key, 1)] = self._named(key, 2)

    @staticmethod
    def _named(key: str, order: int, weight: LinearForm | float = 1.0) -> LinearForm:
        return LinearForm.named(rate_key(key, order)) * weight

    def _pair(self, node: Node, held: Set[str] = frozenset(), unit: float = 1.0) -> Pair:
        """Velocity and acceleration without those rates of one order that are ``held``."""
        velocity = rate_of(node, _without(self._rates, held))
        whole = rate_of(node, self._rates) * unit if held else velocity * unit
        self.closure.check_length(whole.node)
        bends = _without(self._bends, {rate_key(name, 1) for name in held})
        acceleration = rate_of(whole.node, self._rates | bends)
        pair = (velocity * unit).node, acceleration.node
        self.closure.check_length(*pair)
        return pair

    def formulas(self) -> Iterator[Node]:
        """All formulas of the mechanism."""
        closure = self.closure
        yield from (part.formula for part in closure.coefficients.values())
        yield from (quantity.formula for quantity in closure.quantities)
        yield from (length for _, length in closure.released)
        for pair in self.of.values():
            yield from pair
        for block, sides in zip(closure.blocks, self.sides, strict=True):
            for pair in sides:
                yield from pair
            for row in block.rows:
                yield from (row.formula, *row.slopes)

    @cached_property
    def used(self) -> set[str]:
        """The keys of everything that a formula uses, dimensions of other dimensions included."""
        used = {node.name for formula in self.formulas() for node in names_in(formula)}
        for dimension in reversed(self.closure.traced.dimensions):
            if dimension.key in used and dimension.formula is not None:
                used |= {node.name for node in names_in(dimension.formula)}
        return used


def _without(rates: Mapping[str, LinearForm], held: Set[str]) -> dict[str, LinearForm]:
    return {name: rate for name, rate in rates.items() if name not in held}


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
