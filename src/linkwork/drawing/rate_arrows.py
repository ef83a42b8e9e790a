"""Velocities and accelerations as arrows at points.

All arrows of all pictures of a motion have the same scale, a round number of length units per unit
of the rate; the longest arrow of the motion is at most
:data:`~linkwork.drawing.point_arrows.LONGEST` of the drawn size. If rates are unbounded, as near a
dead point, the fastest rows are ignored, unless the drawn position is one of these.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.drawing.annotation import Annotation, round_up
from linkwork.drawing.measures import Measures
from linkwork.drawing.point_arrows import LONGEST, ArrowLook, point_arrows, scale_caption
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Role
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.results.position import Position
from linkwork.results.quantity import Kind, Rate

__all__ = ["rate_arrows", "rate_of", "usual_most"]

_WORD = {1: "velocity", 2: "acceleration"}
_LOOK = {
    1: ArrowLook(role=Role.VELOCITY, name_role=Role.VELOCITY_NAME, letter="v"),
    2: ArrowLook(role=Role.ACCELERATION, name_role=Role.ACCELERATION_NAME, letter="a"),
}
_FAST = 0.95  # share of the rows that are not counted as fastest
_BEYOND = 3.0  # speed ratio to the others for rows near a dead point


def rate_arrows(
    position: Position, motion: Motion | None, pose: Pose, measures: Measures, order: int
) -> Annotation:
    """Arrows of the velocity (order 1) or acceleration (2) of every moving point.

    Derivatives are with respect to time if the input has a speed, otherwise to the input.

    Raises
    ------
    InputError
        If these rates do not exist, as at a dead point.
    """
    rates = _rates(position, pose, order)
    by_time = bool(position.velocity)
    most = max(abs(rate) for rate in rates.values())
    if motion is not None:
        rows = [
            np.abs(motion.trace(f"{name}.{rate_of(order, by_time).value}"))[motion.found]
            for name in rates
        ]
        most = max(usual_most(np.concatenate(rows)), most)
    if not most:
        return Annotation(caption=f"{_WORD[order]}: none, no point moves")
    scale = 1.0 / round_up(most / (LONGEST * measures.size))
    arrows, short = point_arrows(rates, pose.points, scale, _LOOK[order], measures)
    rate = rate_of(order, by_time)
    unit = rate.unit(Kind.LENGTH, position.units, position.derivative_unit).replace("^2", "²")
    caption = scale_caption(_WORD[order], scale, position.units.length, unit, measures.size)
    if short:
        caption += f" (too short to draw: {', '.join(short)})"
    return replace(arrows, caption=caption)


def rate_of(order: int, by_time: bool) -> Rate:
    """The rate of this order with respect to time or the input."""
    if by_time:
        return Rate.VELOCITY if order == 1 else Rate.ACCELERATION
    return Rate.FIRST if order == 1 else Rate.SECOND


def usual_most(sizes: np.ndarray) -> float:
    """The largest of sizes (N,), ignoring rows near a dead point; 0 if empty."""
    finite = sizes[np.isfinite(sizes)]
    if not len(finite):
        return 0.0
    usual = float(np.quantile(finite, _FAST))
    most = float(finite.max())
    return usual if usual and most > _BEYOND * usual else most


def _rates(position: Position, pose: Pose, order: int) -> dict[str, complex]:
    """The rates of all drawn moving points."""
    by_time, by_input = (
        (position.velocity, position.first) if order == 1
        else (position.acceleration, position.second)
    )  # fmt: skip
    table = by_time or by_input
    found = {
        name: complex(table[f"{name}.x"], table[f"{name}.y"])
        for name in pose.points
        if name not in pose.construction and name not in pose.skeleton.fixed
        and f"{name}.x" in table
    }  # fmt: skip
    bad = [name for name, rate in found.items() if not np.isfinite(rate)]
    if bad or not found:
        why = (
            f"not that of {', '.join(bad)}: the input is at a dead point" if bad else "of no point"
        )
        raise InputError(
            f'"{position.mechanism}" has no {_WORD[order]} to draw at this input value ({why})'
        )
    return found
