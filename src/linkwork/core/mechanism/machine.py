"""Masses, friction, stops."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.core.foundation.errors import ExpressionError, internal
from linkwork.core.foundation.units import LENGTHS
from linkwork.core.foundation.values import (
    Key,
    ListOf,
    Measured,
    NumberValue as NumberKey,
    Text,
    check_values,
)
from linkwork.core.mechanism.dimensions import Number, Numbers

# ----------------------------------------------------------------------
# Masses of links, and gravity.


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


# ----------------------------------------------------------------------
# Friction of joints: coefficients, and the sizes on which moments of friction depend.


FRICTION_KEYS = (
    Key("mu", NumberKey(), "Coefficient of friction", required=True),
    Key(
        "radius",
        NumberKey("length"),
        "Of a pin its radius; of teeth the mean distance of their contact from the pitch point",
    ),
    Key(
        "length",
        NumberKey("length"),
        "Guided length of a slider, whose moment presses its two ends; by default it has no effect",
    ),
)


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Friction in a pin or a part.

    Parameters
    ----------
    mu : number
        The coefficient of friction; of a rolling wheel that of adhesion, beyond which it slips.
    radius : number, optional
        The radius of a pin, or for teeth the mean distance of their contact from the pitch point
        [length].
    length : number, optional
        The guided length of a slider [length].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Friction(mu=0.1, radius=5).radius
    5
    """

    mu: Number
    radius: Number | None = None
    length: Number | None = None

    def __post_init__(self) -> None:
        check_values(self)


# ----------------------------------------------------------------------
# Stops: bounds of a quantity at which a simulated motion bounces or rests.


STOP_KEYS = (
    Key("of", Text(), "The quantity that is bounded: a link, a slider, B.x", required=True),
    Key("from", NumberKey("named"), "Its least value", field="from_"),
    Key("to", NumberKey("named"), "Its greatest value"),
    Key("restitution", NumberKey(), "Speed after a shock over that before; default 0"),
)


@internal("keys", "mistakes")
@dataclass(frozen=True, kw_only=True)
class Stop:
    """Stops that keep a quantity within bounds, in simulations.

    Parameters
    ----------
    of : str
        The quantity: a link, a slider, ``B.x``.
    from_, to : number, optional
        Its bounds in file units (``from`` and ``to`` in a file).
    restitution : number
        The speed after a shock over that before, from 0 to 1.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Stop(of="rocker", to=130, restitution=0.3).of
    'rocker'
    """

    of: str
    from_: Number | None = None
    to: Number | None = None
    restitution: Number = 0

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def keys(self) -> tuple[Key, ...]:
        """Its keys in a file."""
        return STOP_KEYS

    def mistakes(self, numbers: Numbers) -> Iterator[tuple[str, str]]:
        """Keys with what is wrong."""
        if self.from_ is None and self.to is None:
            yield "from", "is missing: a stop needs from, to, or both"
            return
        amounts = {}
        for key, number in (("from", self.from_), ("to", self.to)):
            if number is not None:
                try:
                    amounts[key] = numbers(number)
                except ExpressionError as error:
                    yield key, error.message
        if len(amounts) == 2 and amounts["from"] >= amounts["to"]:
            yield "to", f"must be greater than from, got {amounts['from']:g} and {amounts['to']:g}"
        try:
            if not 0.0 <= numbers(self.restitution) <= 1.0:
                yield "restitution", f"must be from 0 to 1, got {numbers(self.restitution):g}"
        except ExpressionError as error:
            yield "restitution", error.message
