"""The equation of a linear coupling."""

from __future__ import annotations

from linkwork.core.equations.frames import PartRows
from linkwork.core.equations.writing import write_rows
from linkwork.core.mechanism.description import Key
from linkwork.couplings.coupling import LinearCoupling


@write_rows.register
def write_coupling(coupling: LinearCoupling, key: Key, rows: PartRows) -> None:
    """q2 - ratio · q1 = offset."""
    linkage = rows.frames.linkage
    turns, slides = coupling.weights(linkage)
    total = None
    if coupling.offset is not None:
        numbers = linkage.numbers
        exact = numbers.precise if slides else numbers.precise_angle
        total = exact(coupling.offset)
    rows.tie(coupling.name, list(turns), slides, total=total, measured=("offset", 1.0))
