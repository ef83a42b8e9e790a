"""All quantities beyond a mechanism's own: those of every row, and those of a whole motion."""

from __future__ import annotations

from linkwork.results.quantities.definition import MotionQuantity, RowQuantity
from linkwork.results.quantities.dwell import DWELL
from linkwork.results.quantities.extremes import EXTREMES
from linkwork.results.quantities.mechanical_advantage import MECHANICAL_ADVANTAGE
from linkwork.results.quantities.path_curvature import PATH_CURVATURE
from linkwork.results.quantities.path_length import PATH_LENGTH
from linkwork.results.quantities.pressure_angle import PRESSURE_ANGLE
from linkwork.results.quantities.stroke import STROKE
from linkwork.results.quantities.time_ratio import TIME_RATIO
from linkwork.results.quantities.transmission import TRANSMISSION

__all__ = ["MOTION_QUANTITIES", "ROW_QUANTITIES", "row_quantity"]

ROW_QUANTITIES: tuple[RowQuantity, ...] = (
    *TRANSMISSION,
    *MECHANICAL_ADVANTAGE,
    *PATH_CURVATURE,
    *PRESSURE_ANGLE,
)

MOTION_QUANTITIES: tuple[MotionQuantity, ...] = (
    *EXTREMES,
    *STROKE,
    *TIME_RATIO,
    *PATH_LENGTH,
    *DWELL,
)


def row_quantity(name: str) -> RowQuantity | None:
    """The quantity that a name ends with: that of ``B.transmission``."""
    return next((row for row in ROW_QUANTITIES if name.endswith(f".{row.word}")), None)
