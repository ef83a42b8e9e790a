"""Masses, friction, stops."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import ExpressionError, InputError, internal, undefined
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import FORCES, LENGTHS, MASSES
from linkwork.core.foundation.values import (
    Key,
    ListOf,
    Measured,
    NumberValue as NumberKey,
    Text,
    as_told,
    check_values,
)
from linkwork.core.mechanism.description import Description, Problems, check_entries
from linkwork.core.mechanism.dimensions import LARGEST, Number, Numbers

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


# ----------------------------------------------------------------------
# Masses, gravity and units of force of a mechanism with links.


@dataclass(frozen=True, kw_only=True)
class LoadedBodies(Description):
    """A description whose links may have masses.

    Parameters
    ----------
    mass, force : str
        Units of masses and forces: kg, g, t, lb, slug; N, kN, lbf.
    gravity : Gravity, optional
        None unless given.
    masses : Mapping[str, Mass]
        By link.
    stops : tuple of Stop
        Bounds of quantities in simulations.
    """

    mass: str = "kg"
    force: str = "N"
    gravity: Gravity | None = None
    masses: Mapping[str, Mass] = FrozenDict()
    stops: tuple[Stop, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        given: object = self.gravity
        if given is not None and not isinstance(given, Gravity):
            raise InputError(f"gravity must be lw.Gravity(…), got {as_told(given)}")
        check_entries("masses", Mass, self.masses.values())
        check_entries("stops", Stop, self.stops)

    @property
    def carried(self) -> Mapping[str, tuple[str, ...]]:
        """The points of every link."""
        raise NotImplementedError

    @property
    def placed(self) -> Iterable[str]:
        """The names of all points."""
        raise NotImplementedError

    @property
    def turning_on_one_point(self) -> frozenset[str]:
        """Links of one point that have a direction all the same."""
        return frozenset()

    @property
    def loaded(self) -> bool:
        """Whether anything loads the mechanism."""
        return bool(self.masses)

    def spelled_masses(self) -> FrozenDict[str, Mass]:
        """The masses under the names of the links."""
        spelled = {canonical(link): link for link in self.carried}
        return FrozenDict(
            {spelled.get(canonical(link), link): mass for link, mass in self.masses.items()}
        )


def check_masses(loaded: LoadedBodies, problems: Problems) -> None:
    """Report unknown units, masses of what is no link, and wrong numbers."""
    for name, unit, known in (("mass", loaded.mass, MASSES), ("force", loaded.force, FORCES)):
        if unit not in known:
            problems.add((name,), f'"{unit}" is not a known unit ({", ".join(known)})')
    if loaded.masses and loaded.length not in LENGTHS:
        message = f"masses need a known unit of length ({', '.join(LENGTHS)})"
        problems.add(("length",), f'"{loaded.length}" cannot be converted: {message}')
    _check_gravity(loaded, problems)
    for k, stop in enumerate(loaded.stops):
        for field, message in stop.mistakes(loaded.numbers):
            problems.add(("stops", k, field), message)
    for link, mass in loaded.masses.items():
        key = ("masses", link)
        if link not in loaded.carried:
            known_links = [name for name in loaded.carried if name != GROUND]
            problems.add(key, undefined("link", link, known_links))
            continue
        if link == GROUND:
            problems.add(key, "is fixed: its mass has no effect, remove it")
        for field, message in _mistakes(loaded, link, mass):
            problems.add((*key, field), message)
        for field in ("mass", "inertia"):
            amount = loaded.numbers.check_amount(problems.add, (*key, field), getattr(mass, field))
            if amount < 0:
                problems.add((*key, field), f"must not be negative, got {amount:g}")
        for k, number in enumerate(mass.center or ()):
            loaded.numbers.check_amount(problems.add, (*key, "center", k), number)


def _check_gravity(loaded: LoadedBodies, problems: Problems) -> None:
    if loaded.gravity is None:
        return
    try:
        size = loaded.gravity.acceleration(loaded.numbers, loaded.length)
        if abs(size) > LARGEST:
            problems.add(("gravity", "size"), f"{size:g} is too large: at most {LARGEST:g}")
    except ExpressionError as error:
        problems.add(("gravity", "size"), error.message)
    if loaded.gravity.angle is not None:
        loaded.numbers.check_number(problems.add, ("gravity", "angle"), loaded.gravity.angle)


def _mistakes(loaded: LoadedBodies, link: str, mass: Mass) -> Iterator[tuple[str, str]]:
    """Keys that contradict each other or are missing."""
    count = len(loaded.carried[link])
    if mass.shape is not None:
        if mass.shape != "rod":
            yield "shape", f'must be "rod", got "{mass.shape}"'
        if mass.center is not None or mass.inertia != 0:
            yield "shape", "gives centre and inertia: leave them out, or the shape"
        if count < 2:
            yield "shape", f'a rod needs two points, "{link}" has only {count}'
    elif mass.center is None and count != 1:
        yield "center", 'is missing: write center = [x, y], or shape = "rod"'
    elif mass.center in (None, (0, 0)) or count > 1:
        return
    elif link not in loaded.turning_on_one_point:
        yield "center", f'"{link}" has only one point and no direction: leave the centre there'
