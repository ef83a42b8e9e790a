"""Velocities and accelerations as formulas: the closure equations differentiated by time.

J q̇ = -∂F/∂u u̇ and J q̈ = -(the second derivative of F without the terms of q̈), block by block.
Rates of angles are in radians per second; a rate's key is that of its quantity with its order.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, field
from functools import cached_property

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
    kinds: dict[str, Kind | None] = {}  # None for a dimension used as two kinds

    def read(node: Node, kind: Kind) -> None:
        for name in _carriers(node):
            if kinds.setdefault(name, kind) is not kind:
                kinds[name] = None
        for angle in _angles(node):
            read(angle, Kind.ANGLE)

    equations = traced.equations
    terms = [term for loop in equations.loops for term in loop.terms]
    terms += [term for path in equations.points.values() for term in path.terms]
    for term in terms:
        for form in forms_of(term.value):
            read(form.node, Kind.LENGTH if term.length is None else Kind.NUMBER)
    for line in equations.linear:
        kind = Kind.ANGLE if line.kind == "angle" else Kind.LENGTH
        read(forms_of(line.constant)[0].node, kind)
    for angle in equations.links.values():
        read(forms_of(angle.constant)[0].node, Kind.ANGLE)
    derived = [(d, d.formula) for d in traced.dimensions if d.formula is not None]
    for dimension, formula in derived:
        if dimension.kind in _KINDS:
            read(formula, _KINDS[dimension.kind])
    for _ in derived:  # a chain of derived dimensions is as long as their number
        for dimension, formula in derived:
            known = (kinds.get(name) for name in (dimension.key, *_carriers(formula)))
            found = next((kind for kind in known if kind is not None), None)
            if found is not None:
                read(Name(dimension.key), found)
                read(formula, found)
    return {key: kind for key, kind in kinds.items() if kind is not None}


def _carriers(node: Node) -> Iterator[str]:
    """The names that have the kind of the formula."""
    match node:
        case Name():
            yield node.name
        case Negative():
            yield from _carriers(node.operand)
        case Binary("+" | "-"):
            yield from _carriers(node.left)
            yield from _carriers(node.right)
        case Binary("*" | "/") if _is_plain(node.right):
            yield from _carriers(node.left)
        case Binary("*") if _is_plain(node.left):
            yield from _carriers(node.right)
        case Call() if node.function in _ALIKE:
            for argument in node.arguments:
                yield from _carriers(argument)


def _angles(node: Node) -> Iterator[Node]:
    """The arguments of functions of angles."""
    match node:
        case Negative():
            yield from _angles(node.operand)
        case Binary():
            yield from _angles(node.left)
            yield from _angles(node.right)
        case Call() if node.function in _OF_ANGLE:
            yield node.arguments[0]
        case Call():
            for argument in node.arguments:
                yield from _angles(argument)


def _is_plain(node: Node) -> bool:
    """Whether a factor is a number: all its dimensions are in angles."""
    match node:
        case Call() if node.function in ("sin", "cos", "tan"):
            return True
        case Negative():
            return _is_plain(node.operand)
        case Binary("*" | "/"):
            return _is_plain(node.left) and _is_plain(node.right)
        case _:
            return not any(True for _ in names_in(node))
