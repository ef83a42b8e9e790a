"""The derivative of a formula as a formula, for display; jets compute the numbers."""

from __future__ import annotations

from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number, names_in

__all__ = ["derivative", "product_of", "sum_of"]

_ZERO, _ONE = Number(0.0), Number(1.0)


def derivative(node: Node, name: str, radians: float = 1.0) -> Node:
    """d(node)/d(name), lightly simplified; ``radians`` is the angle unit of the formula.

    Raises
    ------
    ValueError
        For ``min`` and ``max``, which have no derivative in one formula.
    """
    if not _contains(node, name):
        return _ZERO
    match node:
        case Name():
            return _ONE
        case Negative():
            return _negative(derivative(node.operand, name, radians))
        case Binary("+" | "-"):
            left, right = (
                derivative(node.left, name, radians),
                derivative(node.right, name, radians),
            )
            return sum_of(left, right) if node.operator == "+" else sum_of(left, _negative(right))
        case Binary("*"):
            return sum_of(
                product_of(derivative(node.left, name, radians), node.right),
                product_of(node.left, derivative(node.right, name, radians)),
            )
        case Binary("/"):
            top = sum_of(
                product_of(derivative(node.left, name, radians), node.right),
                _negative(product_of(node.left, derivative(node.right, name, radians))),
            )
            return Binary("/", top, Binary("^", node.right, Number(2.0)))
        case Binary("<" | "<=" | ">" | ">="):
            return _ZERO
        case Binary():
            return _power(node, name, radians)
        case Call():
            return _chain(node, name, radians)
        case Number():
            return _ZERO


def _contains(node: Node, name: str) -> bool:
    return any(used.name == name for used in names_in(node))


def _power(node: Binary, name: str, radians: float) -> Node:
    base, exponent = node.left, node.right
    if not _contains(exponent, name):
        if isinstance(exponent, Number):
            lower: Node = Number(exponent.value - 1.0)
            reduced = base if lower == _ONE else Binary("^", base, lower)
        else:
            reduced = Binary("^", base, Binary("-", exponent, _ONE))
        return product_of(product_of(exponent, reduced), derivative(base, name, radians))
    # u^v = exp(v ln u)
    inner = product_of(exponent, Call("ln", (base,)))
    if base == Name("e"):
        inner = exponent
    return product_of(node, derivative(inner, name, radians))


def _chain(node: Call, name: str, radians: float) -> Node:
    x = node.arguments[0]
    square = Binary("^", x, Number(2.0))
    outer: dict[str, Node] = {
        "sin": Call("cos", (x,)),
        "cos": Negative(Call("sin", (x,))),
        "tan": Binary("+", _ONE, Binary("^", node, Number(2.0))),
        "exp": node,
        "ln": Binary("/", _ONE, x),
        "log10": Binary("/", _ONE, Binary("*", Call("ln", (Number(10.0),)), x)),
        "sqrt": Binary("/", _ONE, Binary("*", Number(2.0), node)),
        "asin": Binary("/", _ONE, Call("sqrt", (Binary("-", _ONE, square),))),
        "acos": Negative(Binary("/", _ONE, Call("sqrt", (Binary("-", _ONE, square),)))),
        "atan": Binary("/", _ONE, Binary("+", _ONE, square)),
        "abs": Binary("/", x, node),
    }
    inner = derivative(x, name, radians)
    # the derivative of sin(k x) has the factor k = radians per unit
    if node.function in ("sin", "cos", "tan") and radians != 1.0:
        inner = product_of(Number(radians), inner)
    if node.function in ("asin", "acos", "atan") and radians != 1.0:
        inner = product_of(Number(1.0 / radians), inner)
    if node.function in outer:
        return product_of(outer[node.function], inner)
    if node.function == "hypot":
        y = node.arguments[1]
        top = sum_of(
            product_of(x, derivative(x, name, radians)), product_of(y, derivative(y, name, radians))
        )
        return Binary("/", top, node)
    if node.function == "atan2":
        other = node.arguments[1]
        top = sum_of(
            product_of(other, derivative(x, name, radians)),
            _negative(product_of(x, derivative(other, name, radians))),
        )
        whole = Binary("/", top, Binary("+", square, Binary("^", other, Number(2.0))))
        return whole if radians == 1.0 else product_of(Number(1.0 / radians), whole)
    raise ValueError(f"{node.function} has a derivative that is not a single formula")


def _negative(node: Node) -> Node:
    if node == _ZERO:
        return node
    return node.operand if isinstance(node, Negative) else Negative(node)


def sum_of(left: Node, right: Node) -> Node:
    """left + right, without zeros."""
    if left == _ZERO:
        return right
    if right == _ZERO:
        return left
    if isinstance(right, Negative):
        return Binary("-", left, right.operand)
    return Binary("+", left, right)


def product_of(left: Node, right: Node) -> Node:
    """left · right, without ones, signs first."""
    if _ZERO in (left, right):
        return _ZERO
    if left == _ONE:
        return right
    if right == _ONE:
        return left
    if isinstance(left, Negative):
        return _negative(product_of(left.operand, right))
    if isinstance(right, Negative):
        return _negative(product_of(left, right.operand))
    return Binary("*", left, right)
