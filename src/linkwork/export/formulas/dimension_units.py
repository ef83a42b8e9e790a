"""The units of named dimensions, which follow from their place in the equations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from linkwork.equations.model import Term
from linkwork.export.formulas.traced_equations import TracedEquations, forms_of
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number, names_in
from linkwork.results.quantity import Kind

__all__ = ["dimension_kinds"]

_OF_ANGLE = ("sin", "cos", "tan", "radians", "degrees")
_KINDS = {"lengths": Kind.LENGTH, "angles": Kind.ANGLE, "points": Kind.LENGTH}  # of tables
_ALIKE = ("abs", "min", "max", "hypot")


def dimension_kinds(traced: TracedEquations) -> dict[str, Kind]:
    """The kind of every dimension whose place in the equations decides it, by key.

    A dimension that is added to a length, or scaled by plain numbers to one, is a length; the
    argument of a sine is an angle. A factor of a product of dimensions is left open, and so is a
    dimension that is used as two kinds.
    """
    found = _Kinds()
    equations = traced.equations
    for form, kind in _given(traced):
        found.read(form, kind)
    for line in equations.linear:
        kind = Kind.ANGLE if line.kind == "angle" else Kind.LENGTH
        found.read(forms_of(line.constant)[0].node, kind)
    for angle in equations.links.values():
        found.read(forms_of(angle.constant)[0].node, Kind.ANGLE)
    for dimension in traced.dimensions:
        if dimension.kind in _KINDS and dimension.formula is not None:
            found.read(dimension.formula, _KINDS[dimension.kind])
    for _ in traced.dimensions:  # a chain of derived dimensions is as long as their number
        known = len(found.of)
        for dimension in traced.dimensions:
            if dimension.formula is None:
                continue
            own = found.of.get(dimension.key) or found.kind_of(dimension.formula)
            if own is not None:
                found.read(Name(dimension.key), own)
                found.read(dimension.formula, own)
        if len(found.of) == known:
            break
    return {key: kind for key, kind in found.of.items() if kind is not None}


def _given(traced: TracedEquations) -> Iterator[tuple[Node, Kind]]:
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
        """Note what the parts of a formula of a kind must be."""
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
            case Binary() | Call() | Number():
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
        case Number():
            return True
        case Call() if node.function in ("sin", "cos", "tan"):
            return True
        case Negative():
            return _is_plain(node.operand)
        case Binary("*" | "/"):
            return _is_plain(node.left) and _is_plain(node.right)
        case _:
            return not any(True for _ in names_in(node))
