"""The terms of the loop equations at a position, as vectors for a diagram."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping

from linkwork.equations.model import Term
from linkwork.equations.notation import PlainText
from linkwork.expression.tree import Number
from linkwork.foundation.errors import InputError
from linkwork.motion.model import Model
from linkwork.results.position import Position
from linkwork.results.quantity import Kind
from linkwork.results.vector_loop import LoopVector, VectorLoop

__all__ = ["vector_loops"]

_PLAIN = PlainText()


def vector_loops(model: Model, position: Position) -> tuple[VectorLoop, ...]:
    """Every loop equation at a position of the mechanism, term by term.

    Raises
    ------
    InputError
        If the mechanism is not written in loops, or the position was not found.
    """
    if not model.equations.loops:
        raise InputError(f'"{model.description.name}" has no loop equations to show as vectors')
    if not position.status.ok:
        raise InputError(f'"{model.description.name}" has no position here: {position.message}')
    values = _values(model, position)
    shown = {variable.symbol: variable.shown for variable in model.equations.variables}
    return tuple(
        VectorLoop(
            label=loop.label,
            left=tuple(_vector(term, values, shown) for term in loop.left),
            right=tuple(_vector(term, values, shown) for term in loop.right),
        )
        for loop in model.equations.loops
    )


def _values(model: Model, position: Position) -> dict[str, float]:
    """Every variable by its symbol, internal units."""
    equations = model.equations
    found = {v.symbol: float(x) for v, x in zip(equations.unknowns, position.q, strict=True)}
    for variable in equations.inputs:
        scale = model.units.scale(Kind(variable.kind))
        found[variable.symbol] = position.input[variable.name] * scale
    return found


def _vector(term: Term, values: Mapping[str, float], shown: Mapping[str, str]) -> LoopVector:
    angle = sum(weight * values[name] for name, weight in term.phase)
    length = 1.0 if term.length is None else values[term.length]
    return LoopVector(
        name=_name(term, shown),
        value=complex(term.value * length * cmath.exp(1j * angle)),
        backwards=term.sign < 0,
    )


def _name(term: Term, shown: Mapping[str, str]) -> str:
    """Modulus and direction in polar form: ``a2∠θ12``; the modulus alone along the x-axis."""
    factors = []
    if term.magnitude is not None and term.magnitude != Number(1.0):
        factors.append(_PLAIN.node(term.magnitude))
    if term.length is not None:
        factors.append(_PLAIN.name(shown[term.length]))
    angle = ""
    for name, weight in term.phase:
        size = "" if abs(weight) == 1.0 else f"{abs(weight):.6g}"
        angle += _signed(weight, f"{size}{_PLAIN.name(shown[name])}", angle)
    if term.turn:
        angle += _signed(term.turn, f"{round(abs(math.degrees(term.turn)), 2):g}°", angle)
    return ("·".join(factors) or "1") + (f"∠{angle}" if angle else "")


def _signed(number: float, shown: str, before: str) -> str:
    """A summand behind what is written before it."""
    return ("\u2212" if number < 0 else "+" if before else "") + shown
