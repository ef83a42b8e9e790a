"""Where loads switch: the comparisons, and the kinks of functions, in their formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from linkwork.expression.grammar import parse
from linkwork.expression.tree import Binary, Node, names_in, switches_in
from linkwork.forces.applied import AppliedLoads, load_formulas
from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict
from linkwork.mechanism.description import Description

__all__ = ["held_switches", "load_switches", "switch_margins"]

_RISING = ("<", ">=")  # comparisons whose margin is the right side minus the left one


def load_switches(description: Description) -> tuple[Binary, ...]:
    """The comparisons at which loads jump or have a kink, each once: ``F >= 0`` for ``abs(F)``."""
    known = description.numbers.known
    found = (
        each
        for _, formula in load_formulas(description)
        for each in switches_in(parse(formula, comparing=True))
        if any(name.name not in known for name in names_in(each))
    )
    return tuple(dict.fromkeys(found))


def switch_margins(switches: Sequence[Binary], applied: AppliedLoads) -> list[Array]:
    """Of all switches, (B,) each: positive where "<" or ">" is true, "<=" or ">=" is not.

    So 0 is on its right side. A load is smooth between two changes of their signs, and beyond
    these with the :func:`held_switches` of the signs before.
    """
    formula = applied.formula
    return [
        (formula(each.left) - formula(each.right)) * (-1.0 if each.operator in _RISING else 1.0)
        for each in switches
    ]


def held_switches(switches: Sequence[Binary], margins: Sequence[float]) -> Mapping[Node, float]:
    """The value of every switch that belongs to its margin, for :class:`AppliedLoads`."""
    values: dict[Node, float] = {}
    for each, margin in zip(switches, margins, strict=True):
        values[each] = float((margin > 0.0) == (each.operator in ("<", ">")))
    return FrozenDict(values)
