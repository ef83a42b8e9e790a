"""Inflection circle of a link at a position."""

from __future__ import annotations

import math

from linkwork.forces.geometry import Geometry
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import GROUND, find_spelling
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.motion.model import Model
from linkwork.results.machine_design import InflectionCircle
from linkwork.results.position import Position
from linkwork.results.quantity import Kind

__all__ = ["inflection_circle"]

_STILL = 1e-12  # rad per longest link: a link that does not turn


def inflection_circle(
    model: Model, position: Position, link: str | None = None
) -> InflectionCircle:
    """The inflection circle from the derivatives of one point by the angle of the link.

    Raises
    ------
    UnknownNameError
        If there is no such link.
    InputError
        If the link does not turn there, or there is no position.
    """
    description = model.description
    if not isinstance(description, LoadedBodies):
        raise InputError("an inflection circle needs a mechanism with links")
    moving = [name for name in description.carried if name != GROUND]
    if link is None:
        fixed = description.carried.get(GROUND, ())
        # the coupler, in four links
        free = [name for name in moving if not set(description.carried[name]) & set(fixed)]
        if len(free) != 1:
            raise InputError(f"name the link {choices('links', moving)}")
        link = free[0]
    link = find_spelling(link, moving)
    if link not in moving:
        raise UnknownNameError(f'there is no link "{link}" {choices("links", moving, link)}')
    if not position.status.ok:
        raise InputError(f"there is no position: {position.message}")
    geometry = Geometry(model, position)
    point = geometry.place(description.carried[link][0])
    turn = geometry.angle(link)
    first, second = float(turn.d1[0]), float(turn.d2[0])
    place, rate, bend = (complex(part.flat[0]) for part in (point.v, point.d1, point.d2))
    size = max(abs(rate) / geometry.length, float(geometry.fastest[0]))
    if not abs(first) > _STILL * size or not math.isfinite(first + second):
        raise InputError(
            f'"{link}" does not turn there: its points have no common inflection circle'
        )
    # derivatives by the angle of the link
    by_angle = rate / first
    bend_by_angle = (bend - by_angle * second) / first**2
    # eq. (81)
    pole, opposite = place + 1j * by_angle, place + bend_by_angle
    return InflectionCircle(
        link=link,
        pole=(pole.real, pole.imag),
        inflection_pole=(opposite.real, opposite.imag),
        unit=model.units.of(Kind.LENGTH),
    )
