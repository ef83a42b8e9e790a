"""Alternative starts of a sketch: an input value at which the loops close, and the points there."""

from __future__ import annotations

from collections.abc import Mapping

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.linkage import Linkage
from linkwork.viewer.live.requests import MovePoint
from linkwork.viewer.live.solvable import Solvable

__all__ = ["closing_input", "sketch_at"]

_LOOKED_AT = 24  # rows at which closure is tried
_CLOSED = 1e-9  # relative to the gap at the start: closed


def closing_input(mechanism: Solvable) -> Mapping[str, float]:
    """The value of a single input at which a mechanism closes that is open at its start.

    Some rows of the table are tried, those next to the start first. Empty if none of them closes,
    or if the start is not that of a sketch.
    """
    description = mechanism.description
    if not isinstance(description, Linkage) or len(description.inputs) != 1:
        return {}
    start = mechanism.nearest_assembly()
    ((name, here),) = start.input.items()
    rows = description.rows(description.inputs[0])
    some = rows[:: max(1, len(rows) // _LOOKED_AT)].tolist()
    for value in sorted(some, key=lambda value: abs(value - here)):
        if mechanism.nearest_assembly({name: value}).gap <= _CLOSED * start.gap:
            return {name: value}
    return {}


def sketch_at(mechanism: Solvable, at: Mapping[str, float]) -> tuple[MovePoint, ...]:
    """Edits that move the points of a sketch to their assembled positions at given input values.

    Raises
    ------
    InputError
        If the points are given by equations, or values do not match the inputs.
    """
    description = mechanism.description
    if not isinstance(description, Linkage):
        raise InputError("only the points of a sketch can be moved")
    fixed = description.links[GROUND]
    return tuple(
        MovePoint(point=name, x=x, y=y)
        for name, (x, y) in mechanism.nearest_assembly(at).points.items()
        if name in description.points and name not in fixed
    )
