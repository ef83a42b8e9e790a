"""Symbol of a Geneva wheel: a star with slots and locking arcs, and the locking disc of its driver.

The locking arcs keep the wheel at rest while the pin is outside the slots.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator

import numpy as np

from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polygon, Primitive, Role, xy
from linkwork.foundation.arrays import ComplexArray
from linkwork.mechanism.part.slot import GenevaWheel

__all__ = ["rounds", "symbols"]

_LOCK = 0.82  # radius of the locking arcs over that of the pin's circle
_PIECE = 0.08  # angle of a piece of an arc [rad]


def symbols(wheel: GenevaWheel, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The star and, if the pin turns about a fixed pivot, the locking disc."""
    centre, pin = pose.points[wheel.center], pose.points[wheel.pin]
    along = pose.points[wheel.rim] - centre
    radius, tone = abs(along), tones(pose)
    driver = _driver(pose, wheel)
    lock, distance, depth = 0.0, 0.0, abs(pin - centre)
    if driver is not None:
        middle = pose.points[driver[1]]
        lock, distance = _LOCK * abs(pin - middle), abs(middle - centre)
        depth = distance - abs(pin - middle)
    star = _star(wheel.count, radius, depth, lock, distance, measures)
    corners = tuple(map(xy, centre + along / radius * star))
    yield Polygon(role=Role.WHEEL, of=wheel.link, tone=tone.get(wheel.link, 0), points=corners)
    if driver is not None:
        room = 0.3 * measures.pin
        disc = _cut_disc(lock - room, radius + room, distance)
        corners = tuple(map(xy, middle + (pin - middle) / abs(pin - middle) * disc))
        yield Polygon(role=Role.WHEEL, of=driver[0], tone=tone.get(driver[0], 0), points=corners)


def rounds(wheel: GenevaWheel, pose: Pose) -> Iterator[tuple[str, float]]:
    """Centre and radius of the wheel, and of the locking disc."""
    yield wheel.center, abs(pose.points[wheel.rim] - pose.points[wheel.center])
    driver = _driver(pose, wheel)
    if driver is not None:
        yield driver[1], _LOCK * abs(pose.points[wheel.pin] - pose.points[driver[1]])


def _driver(pose: Pose, wheel: GenevaWheel) -> tuple[str, str] | None:
    """The link with the pin, and its fixed pivot."""
    fixed = set(pose.skeleton.fixed)
    return next(
        (
            (bar.name, point)
            for bar in pose.skeleton.bars
            for point in bar.points
            if wheel.pin in bar.points and point in fixed and point != wheel.pin
        ),
        None,
    )


def _star(
    count: int, radius: float, depth: float, lock: float, distance: float, measures: Measures
) -> ComplexArray:
    """The outline about the centre, one slot on the real axis."""
    half, step = measures.slot, math.tau / count
    mouth = math.asin(min(half / radius, 0.5))
    bottom = depth + half * np.exp(1j * np.linspace(1.5 * math.pi, 0.5 * math.pi, 12))
    slot = [radius * cmath.exp(-1j * mouth), *bottom, radius * cmath.exp(1j * mouth)]
    start, end = mouth, step - mouth
    rim = _arc(0.0, radius, start, end)
    # the locking arc is about the driver's pivot where the wheel rests, midway between two slots
    reach = _angle(radius, distance, lock)
    if start < step / 2 - reach:
        middle = distance * cmath.exp(0.5j * step)
        far = _angle(lock, distance, radius)
        back = 0.5 * step + math.pi
        rim = np.concatenate((
            _arc(0.0, radius, start, step / 2 - reach),
            _arc(middle, lock, back + far, back - far),
            _arc(0.0, radius, step / 2 + reach, end),
        ))  # fmt: skip
    side = np.concatenate((slot, rim))
    turned: ComplexArray = (np.exp(1j * step * np.arange(count))[:, None] * side).ravel()
    return turned


def _cut_disc(radius: float, cut: float, distance: float) -> ComplexArray:
    """The outline of a disc without the circle ``cut`` at a distance on the real axis."""
    own, other = _angle(radius, distance, cut), _angle(cut, distance, radius)
    disc = _arc(0.0, radius, own, math.tau - own)
    if not own:
        return disc
    return np.concatenate((disc, _arc(distance, cut, math.pi + other, math.pi - other)))


def _angle(one: float, distance: float, other: float) -> float:
    """The angle at the centre of circle ``one`` of its intersection with ``other``; 0 if none."""
    if not abs(one - other) < distance < one + other:
        return 0.0
    return math.acos((one**2 + distance**2 - other**2) / (2.0 * one * distance))


def _arc(centre: complex, radius: float, start: float, end: float) -> ComplexArray:
    count = max(2, math.ceil(abs(end - start) / _PIECE))
    return np.asarray(centre + radius * np.exp(1j * np.linspace(start, end, count)))
