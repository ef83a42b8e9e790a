"""The value of a joint as a polynomial of the driven joint's value, with its error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev

from linkwork.export.robot.joint_tree import TreeJoint
from linkwork.export.robot.robot import Robot
from linkwork.foundation.arrays import Array, BoolArray, CountArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.rounding import EPSILON
from linkwork.results.motion import LimitKind, Motion

__all__ = ["Couplings", "JointPolynomial", "couplings_of"]

_HIGHEST = 40
_NEAR = 1e-9  # rad or m
_ENOUGH = 1e-10  # rad or m: no higher degree is tried


@dataclass(frozen=True, kw_only=True)
class JointPolynomial:
    """Chebyshev series on a domain of the driven joint, and the best straight line.

    ``error`` and ``line_error`` are the largest differences in the rows, enlarged by what their
    derivatives allow between rows; they are no proofs. ``range`` is that of the joint's values.
    """

    series: Chebyshev
    error: float
    line: tuple[float, float]
    line_error: float
    range: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Couplings:
    """All joints by the driven one; ``limits`` are dead points, or the ends of the table."""

    leading: TreeJoint
    limits: tuple[float, float]
    stopped: tuple[bool, bool]
    joints: dict[str, JointPolynomial]


def couplings_of(robot: Robot, motion: Motion) -> Couplings:
    """Fit the joints of a motion, on the rows without a gap around the start.

    Raises
    ------
    InputError
        If the input is no joint of the tree, or the table has too few positions.
    """
    leading = robot.leading() if robot.linkage.inputs else None
    if leading is None:
        raise InputError(
            "URDF has no loops: all joints follow the driven one, but the input is no angle or "
            "displacement of one joint; write MJCF or SDF"
        )
    values = robot.values(motion)
    x, rate = values.pop(leading.name)
    with np.errstate(all="ignore"):
        slopes = {name: own_rate / rate for name, (_, own_rate) in values.items()}
    # at a dead point slopes are infinite, at rest they are unknown
    known = np.logical_and.reduce(np.isfinite([x, *slopes.values()]))
    rows = _rows(x, motion, known)
    if len(rows) < 5:
        raise InputError(
            f"{len(rows)} positions around the start are too few for the polynomials of a URDF "
            "file: give a table with more rows"
        )
    joints, condition = {}, float(np.max(motion.condition[rows]))
    limits, stopped = _limits(robot, motion, leading, x[rows], int(rows[0]))
    # dead points too, where slopes are unknown
    inside = motion.found & (x >= limits[0] - _NEAR) & (x <= limits[1] + _NEAR)
    for name, (y, _) in values.items():
        joints[name] = _fit(x[rows], y[rows], slopes[name][rows], condition, y[inside])
    return Couplings(leading=leading, limits=limits, stopped=stopped, joints=joints)


def _rows(x: Array, motion: Motion, known: BoolArray) -> CountArray:
    """The rows around the start position without a gap, by increasing value of the joint."""
    asked = np.flatnonzero(motion.asked)
    good = motion.found[asked] & known[asked]
    if not good.any():
        return asked[:0]
    here = int(np.argmin(np.where(good, np.abs(x[asked]), np.inf)))
    gaps = np.flatnonzero(~good)
    low = max(gaps[gaps < here], default=-1) + 1
    high = min(gaps[gaps > here], default=len(asked))
    part = asked[low:high]
    return part[np.argsort(x[part])]


def _fit(x: Array, y: Array, slope: Array, condition: float, every: Array) -> JointPolynomial:
    """The series of the lowest degree that is accurate enough, or the most accurate one."""
    best: tuple[float, Chebyshev] | None = None
    for degree in range(1, min(_HIGHEST, len(x) // 4) + 1):
        series = Chebyshev.fit(x, y, degree)
        error = _error(series, x, y, slope, condition)
        if best is None or error < best[0]:
            best = error, series
        if error < _ENOUGH:
            break
    assert best is not None
    line = Chebyshev.fit(x, y, 1)
    # of a joint at rest the factor is left out
    offset, factor, *_ = (*line.convert(kind=np.polynomial.Polynomial).coef.tolist(), 0.0)
    return JointPolynomial(
        series=best[1],
        error=best[0],
        line=(factor, offset),
        line_error=_error(line, x, y, slope, condition),
        range=(float(every.min()), float(every.max())),
    )


def _error(series: Chebyshev, x: Array, y: Array, slope: Array, condition: float) -> float:
    """The largest difference in the rows and half a row away from them."""
    wrong, steep = np.abs(series(x) - y), np.abs(series.deriv()(x) - slope)
    half = 0.5 * np.diff(x)
    # Newton-Raphson stops within some roundings of a position, times its condition
    rounding = 16.0 * condition * EPSILON * (1.0 + np.abs(y).max())
    ends = np.maximum(wrong[1:] + half * steep[1:], wrong[:-1] + half * steep[:-1])
    return float(ends.max() + rounding)


def _limits(
    robot: Robot, motion: Motion, leading: TreeJoint, x: Array, row: int
) -> tuple[tuple[float, float], tuple[bool, bool]]:
    """The ends of the driven joint's range, and whether dead points are there."""
    names = robot.model.motion_quantities.names
    kind = names.inputs[names.lead]
    own = motion.inputs[names.lead]
    scale = robot.model.units.scale(kind) / robot.per_metre(leading.name)
    values, rates = robot.values(motion)[leading.name]
    slope = float(np.sign(rates[row])) * scale
    ends, stopped = [float(x[0]), float(x[-1])], [False, False]
    if robot.model.untimed is not None:  # limits are given by time
        return (ends[0], ends[1]), (False, False)
    step = 1.001 * float(np.diff(x).max())
    for limit in motion.limits:
        at = values[row] + slope * (limit.input - own[row])
        for k, beyond in ((0, ends[0] - at), (1, at - ends[1])):
            if limit.kind is LimitKind.DEAD_POINT and 0.0 <= beyond <= step:
                ends[k], stopped[k] = float(at), True
    return (ends[0], ends[1]), (stopped[0], stopped[1])
