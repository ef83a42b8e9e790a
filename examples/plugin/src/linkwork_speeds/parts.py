"""The quantity, and the writer of a table of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from linkwork import Mechanism
from linkwork.core.expression.derivatives import Jet
from linkwork.core.results.quantities.definition import UNKNOWN, MechanismNames, RowQuantity, Solved
from linkwork.core.results.quantity import Kind
from linkwork.core.results.tables import csv_text


def _moving(names: MechanismNames) -> Mapping[str, Kind]:
    return {point: Kind.LENGTH for point in names.points if point not in names.skeleton.fixed}


def _speed(names: MechanismNames, solved: Solved, point: str) -> Jet:
    return Jet(np.abs(solved.place(point).d1), UNKNOWN, UNKNOWN)


SPEED = (
    RowQuantity(
        word="speed",
        about="length of the point's path per unit of the input",
        kind=Kind.LENGTH,
        needs=1,
        of=_moving,
        evaluate=_speed,
    ),
)


def write_speeds(mechanism: Mechanism, path: str | Path) -> None:
    """Write the speeds of all moving points over the cycle as CSV."""
    motion = mechanism.sweep()
    points = [point for point in motion.points if point not in motion.skeleton.fixed]
    Path(path).write_text(csv_text(motion.table(*(f"{point}.speed" for point in points))))
