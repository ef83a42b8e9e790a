"""Masses of links, and gravity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.errors import ExpressionError
from linkwork.foundation.file_keys import Key, ListOf, Measured, Number as NumberKey, Text
from linkwork.foundation.internal import internal
from linkwork.foundation.units import LENGTHS
from linkwork.foundation.value_types import check_values, is_listed
from linkwork.mechanism.dimensions import Number, Numbers

__all__ = ["GRAVITY_KEYS", "MASS_KEYS", "Gravity", "Mass"]

_SHAPES = ("rod",)

MASS_KEYS = (
    Key("mass", NumberKey(), "Mass of the link", required=True),
    Key(
        "center",
        ListOf(NumberKey("length"), "coordinate", 2, 2),
        "Centre of mass, from the link's first point towards its second",
    ),
    Key("inertia", NumberKey("area"), "Moment of inertia about the centre of mass; default 0"),
    Key("shape", Text(_SHAPES), "A uniform rod between the link's first two points"),
)
GRAVITY_KEYS = (
    Key("size", Measured("9.81 m/s^2"), 'Acceleration; "9.81 m/s^2" unless given'),
    Key("angle", NumberKey("angle"), "Direction; downwards unless given"),
)


@dataclass(frozen=True, kw_only=True)
class Mass:
    """The mass of a link.

    Parameters
    ----------
    mass : number
        In the unit of masses.
    center : (number, number), optional
        The centre of mass in the frame of the link: origin at its first point, x axis towards its
        second [length]. A link of one point has it there by default.
    inertia : number
        The moment of inertia about the centre of mass [mass · length²].
    shape : str, optional
        ``rod``: a uniform thin rod between the first two points, instead of centre and inertia.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Mass(mass=1.2, center=(20, 0), inertia=800).center
    (20, 0)
    """

    mass: Number
    center: tuple[Number, Number] | None = None
    inertia: Number = 0
    shape: str | None = None

    def __post_init__(self) -> None:
        given: object = self.center
        if isinstance(given, np.ndarray | list) and is_listed(given):
            object.__setattr__(self, "center", tuple(given))
        check_values(self)


@internal("acceleration")
@dataclass(frozen=True, kw_only=True)
class Gravity:
    """The acceleration of free fall.

    Parameters
    ----------
    size : str or number
        ``"9.81 m/s^2"``; a number is in the file's length unit per square second.
    angle : number
        Its direction from the x axis [file's angle unit]; by default downwards.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Gravity().size
    '9.81 m/s^2'
    """

    size: Number = "9.81 m/s^2"
    angle: Number | None = None

    def __post_init__(self) -> None:
        check_values(self)

    def acceleration(self, numbers: Numbers, length: str) -> float:
        """Its size in length per square second.

        Raises
        ------
        ExpressionError
            If the number cannot be read, or the unit is not known.
        """
        size = self.size
        if not isinstance(size, str):
            return numbers(size)
        number, _, unit = size.strip().replace("s²", "s^2").partition(" ")
        own, slash, seconds = unit.partition("/")
        if not unit:
            return numbers(number)
        if not slash or seconds.strip() != "s^2" or own.strip() not in LENGTHS:
            message = f'must be a number and a unit such as "9.81 m/s^2", got "{size[:40]}"'
            raise ExpressionError(message, size, 1)
        if length not in LENGTHS:
            message = f"cannot be converted to {length}/s^2: write the number alone"
            raise ExpressionError(message, size, 1)
        return numbers(number) * float(LENGTHS[own.strip()] / LENGTHS[length])
