"""The equations of a mechanism with the formulas of their coefficients."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.batch.building import write_equations
from linkwork.equations.model import LoopEquations
from linkwork.export.formulas.linear_form import LinearForm
from linkwork.export.formulas.traced_number import Trace, TracedNumber
from linkwork.expression.grammar import parse
from linkwork.expression.tree import Name, Node, names_in
from linkwork.foundation.names import GROUND, canonical
from linkwork.foundation.operand import NotElementwise
from linkwork.mechanism.description import Description
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.varied_number import VariedNumber, varied_numbers, with_numbers

__all__ = ["Dimension", "TracedEquations", "forms_of", "traced"]


@dataclass(frozen=True, kw_only=True)
class Dimension:
    """A number of the mechanism's description with a cell.

    ``key`` is its name in formulas, ``kind`` its table in the file, ``formula`` its formula of
    other dimensions in the file, ``live`` whether the equations follow its cell.
    """

    key: str
    name: str
    kind: str
    value: float
    formula: Node | None
    live: bool


@dataclass(frozen=True, kw_only=True)
class TracedEquations:
    """Equations whose coefficients are traced numbers.

    ``settled``: keys of dimensions that had to be evaluated as numbers, such as gear ratios.
    """

    equations: LoopEquations
    dimensions: tuple[Dimension, ...]
    settled: tuple[str, ...]


def forms_of(z: object) -> tuple[LinearForm, LinearForm]:
    """The formulas of the real and imaginary part of a coefficient."""
    if isinstance(z, TracedNumber):
        return z.re, z.im
    assert isinstance(z, int | float | complex)
    plain = complex(z)
    return LinearForm(plain.real), LinearForm(plain.imag)


def traced(description: Description) -> TracedEquations:
    """The equations with all dimensions traced for which the builder has formulas."""
    plain = _without_tables(description)
    asked = list(_dimensions(description))
    live = asked
    found = _built(plain, live)
    if found is None:
        live = [q for q in asked if _built(plain, [q]) is not None]
        found = _built(plain, live)
    if found is None:
        live = []
        found = _built(plain, [])
    assert found is not None
    equations, trace = found
    used = {_key(q) for q in live}
    return TracedEquations(
        equations=equations,
        dimensions=tuple(_dimension(description, q, _key(q) in used) for q in asked),
        settled=tuple(dict.fromkeys(n.name for node in trace.settled for n in names_in(node))),
    )


def _without_tables(description: Description) -> Description:
    """The mechanism with plain input ranges, which are not part of the equations."""
    numbers = description.numbers

    def plain(number: Number | None) -> float | None:
        return None if number is None else numbers(number)

    inputs = tuple(
        replace(
            which,
            start=plain(which.start),
            stop=plain(which.stop),
            step=plain(which.step),
            speed=None,
        )
        for which in description.inputs
    )
    return replace(description, inputs=inputs)


def _dimensions(description: Description) -> Iterator[VariedNumber]:
    """All numbers with cells; ground lengths follow from its points."""
    ground = set(description.links[GROUND]) if isinstance(description, Linkage) else set()
    for quantity in varied_numbers(description):
        if quantity.table == "guess":
            continue
        if quantity.table in ("lengths", "angles"):
            if ground.issuperset(quantity.key.split()):
                continue
            if isinstance(_formula(description, quantity), Name):
                continue  # a named dimension
        yield quantity


def _key(quantity: VariedNumber) -> str:
    if quantity.table == "dimensions":
        return canonical(quantity.name)
    return f"{quantity.table} {quantity.name}"


def _formula(description: Description, quantity: VariedNumber) -> Node | None:
    written = quantity.written(description)
    return parse(written) if isinstance(written, str) else None


def _dimension(description: Description, quantity: VariedNumber, live: bool) -> Dimension:
    formula = _formula(description, quantity)
    return Dimension(
        key=_key(quantity),
        name=quantity.name,
        kind=quantity.table,
        value=float(quantity.of(description)),
        formula=formula,
        live=live,
    )


def _built(
    description: Description, asked: Sequence[VariedNumber]
) -> tuple[LoopEquations, Trace] | None:
    """The equations with these numbers traced; ``None`` if the builder has no formulas."""
    trace = Trace()
    numbers = {
        quantity: trace.number(quantity.of(description), LinearForm.named(_key(quantity)))
        for quantity in asked
    }
    try:
        with np.errstate(all="ignore"):
            return write_equations(with_numbers(description, numbers)), trace
    except NotElementwise:
        return None
