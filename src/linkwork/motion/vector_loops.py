"""The terms of the loop equations at a position or over a motion, as vectors for a diagram."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from linkwork.equations.model import Term
from linkwork.equations.notation import PlainText
from linkwork.expression.tree import Number
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.foundation.value_types import check_class
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.position import Position
from linkwork.results.vector_loop import MovingLoop, MovingVector, VectorLoop

__all__ = ["moving_loops", "vector_loops"]

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
    equations = model.equations
    found = np.append(position.q, [position.input[v.name] for v in equations.inputs])
    found[len(position.q) :] *= model.input_scale
    return tuple(loop.at(0) for loop in _loops(model, found[None, :]))


def moving_loops(model: Model, motion: Motion) -> tuple[MovingLoop, ...]:
    """Every loop equation over the rows of a motion of the mechanism, term by term; none if it is
    not written in loops.
    """
    check_class("the cycle", motion, Motion)
    inputs = [motion.inputs[v.name] for v in model.equations.inputs]
    v = np.column_stack([motion.q, *inputs])
    v[:, motion.q.shape[1] :] *= model.input_scale
    return _loops(model, v)


def _loops(model: Model, v: Array) -> tuple[MovingLoop, ...]:
    """The loops at variables (N, n), internal units."""
    equations = model.equations
    values = {variable.symbol: v[:, k] for k, variable in enumerate(equations.variables)}
    shown = {variable.symbol: variable.shown for variable in equations.variables}
    return tuple(
        MovingLoop(
            label=loop.label,
            left=tuple(_vector(term, values, shown) for term in loop.left),
            right=tuple(_vector(term, values, shown) for term in loop.right),
        )
        for loop in equations.loops
    )


def _vector(term: Term, values: Mapping[str, Array], shown: Mapping[str, str]) -> MovingVector:
    any_of_them = next(iter(values.values()))
    angle = np.zeros_like(any_of_them)
    for name, weight in term.phase:
        angle = angle + weight * values[name]
    length = np.where(np.isnan(any_of_them), np.nan, 1.0)
    if term.length is not None:
        length = values[term.length]
    return MovingVector(
        name=_name(term, shown),
        values=term.value * length * np.exp(1j * angle),
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
    """A summand with its sign, as it follows the text before it."""
    return ("\u2212" if number < 0 else "+" if before else "") + shown
