"""Named outputs: formulas of unknowns, dimensions and point coordinates, and their kinds."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from linkwork.core.equations.model import Output
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.expression.values import check_real
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.description import Problems
from linkwork.core.results.quantities.registry import row_quantity
from linkwork.core.results.quantity import Kind


def read_outputs(
    formulas: Mapping[str, str],
    kinds: Mapping[str, str],
    points: Mapping[str, object],
    dimensions: Mapping[str, float],
    problems: Problems,
) -> dict[str, Output]:
    """Parse the outputs.

    Parameters
    ----------
    kinds : Mapping[str, str]
        The kind of every usable name, by canonical name.
    points : Mapping
        Points by name; ``A.x`` and ``A.y`` can be used too.

    Notes
    -----
    Names such as ``B.transmission`` are recognised by their last part; whether B has this quantity
    is checked when the mechanism is complete.
    """
    coordinates = {canonical(f"{p}.{axis}"): "length" for p in points for axis in "xy"}
    known = {**dict.fromkeys(dimensions, "number"), **kinds, **coordinates}
    found: dict[str, Output] = {}
    for name, formula in formulas.items():
        try:
            tree = parse(formula)
            known |= _derived(tree, known)
            _check_names(tree, known, formula)
        except ExpressionError as error:
            problems.add(("outputs", name), str(error))
            continue
        found[name] = Output(formula=tree, kind=_kind(tree, known.__getitem__))
    return found


def _derived(tree: Node, known: Mapping[str, str]) -> dict[str, str]:
    """Kinds of the names in a formula that are quantities of the registry."""
    rows = {node.name: row_quantity(node.name) for node in names_in(tree) if node.name not in known}
    kinds = {name: row.kind for name, row in rows.items() if row is not None}
    plain = (Kind.ANGLE, Kind.LENGTH)
    return {name: (k if k in plain else Kind.NUMBER).value for name, k in kinds.items()}


def _check_names(tree: Node, known: Mapping[str, str], text: str) -> None:
    for node in names_in(tree):
        if node.name not in known and node.name not in CONSTANTS:
            raise ExpressionError(
                f'column {node.column}: "{node.spelling}" is not defined '
                f"{choices('names', known, node.name)}",
                text,
                node.column,
            )
    check_real(tree, text, "an output")


def _kind(tree: Node, kind_of: Callable[[str], str]) -> str:
    """Angle, length or number, as far as the formula determines it."""
    match tree:
        case NumberNode():
            return "number"
        case Name():
            return "number" if tree.name in CONSTANTS else kind_of(tree.name)
        case Negative():
            return _kind(tree.operand, kind_of)
        case Call("atan2" | "atan" | "asin" | "acos"):
            return "angle"
        case Call("abs" | "hypot" | "min" | "max"):
            found = {_kind(argument, kind_of) for argument in tree.arguments} - {"number"}
            return found.pop() if len(found) == 1 else "number"
        case Call():
            return "number"
        case Binary("+" | "-"):
            kinds = {_kind(tree.left, kind_of), _kind(tree.right, kind_of)} - {"number"}
            return kinds.pop() if len(kinds) == 1 else "number"
        case Binary("*" | "/"):
            left, right = _kind(tree.left, kind_of), _kind(tree.right, kind_of)
            if right == "number":
                return left
            return right if left == "number" and tree.operator == "*" else "number"
        case Binary():
            return "number"
