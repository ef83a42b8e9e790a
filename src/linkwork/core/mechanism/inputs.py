"""Driven quantities: ranges, speeds, laws in time, motors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import names_in
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import ExpressionError, internal
from linkwork.core.foundation.units import split_unit
from linkwork.core.foundation.values import (
    Key,
    ListOf,
    Measured,
    NumberValue as NumberKey,
    Speed,
    Text,
    check_values,
)
from linkwork.core.mechanism.dimensions import Number, Numbers

# ----------------------------------------------------------------------
# Motion laws of cam followers and inputs: rises from 0 to 1 while x goes from 0 to 1.
#
# A law is a polynomial, or is integrated from rest from accelerations α + A sin(ω t + ψ) (Norton,
# Cam Design and Manufacturing Handbook, chapters 3 and 4; VDI 2143).


@dataclass(frozen=True)
class Piece:
    """Σ c_k t^k + A sin(ω t + ψ) for t from 0 to ``over``; ``sine`` is (A, ω, ψ)."""

    over: float
    powers: tuple[float, ...]
    sine: tuple[float, float, float] = (0.0, 0.0, 0.0)


_POLYNOMIALS: dict[str, tuple[float, ...]] = {
    "3-4-5": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
    "4-5-6-7": (0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
}
_PI, _STEADY = math.pi, (0.0, 1.0, 0.0)
#: Accelerations α + A sin(ω t + ψ) as pieces of degree 0.
_ACCELERATIONS: dict[str, tuple[Piece, ...]] = {
    "harmonic": (Piece(1.0, (0.0,), (1.0, _PI, _PI / 2)),),
    "cycloidal": (Piece(1.0, (0.0,), (1.0, 2 * _PI, 0.0)),),
    "modified sine": (
        Piece(1 / 8, (0.0,), (1.0, 4 * _PI, 0.0)),
        Piece(3 / 4, (0.0,), (1.0, 4 * _PI / 3, _PI / 2)),
        Piece(1 / 8, (0.0,), (1.0, 4 * _PI, 3 * _PI / 2)),
    ),
    "modified trapezoid": (
        Piece(1 / 8, (0.0,), (1.0, 4 * _PI, 0.0)),
        Piece(1 / 4, (1.0,), _STEADY),
        Piece(1 / 4, (0.0,), (1.0, 4 * _PI, _PI / 2)),
        Piece(1 / 4, (-1.0,), _STEADY),
        Piece(1 / 8, (0.0,), (1.0, 4 * _PI, 3 * _PI / 2)),
    ),
}

#: The laws by name; a dwell has no pieces.
LAWS = ("dwell", *_ACCELERATIONS, *_POLYNOMIALS)
_ACCELERATIONS["trapezoid"] = tuple(Piece(1 / 3, (a,), _STEADY) for a in (1.0, 0.0, -1.0))
#: Further laws of inputs, which a cam could not follow: its follower would be thrown off. A ramp
#: begins at the speed of the segment before it.
INPUT_LAWS = (*LAWS, "constant", "ramp", "trapezoid")


def pieces_of(law: str) -> tuple[Piece, ...]:
    """The pieces of a law in order."""
    if law == "dwell":
        return (Piece(1.0, (0.0,)),)
    if law == "constant":
        return (Piece(1.0, (0.0, 1.0)),)
    if law in _POLYNOMIALS:
        return (Piece(1.0, _POLYNOMIALS[law]),)
    found, place, speed = [], 0.0, 0.0
    for part in _ACCELERATIONS[law]:
        (constant,), (a, w, p) = part.powers, part.sine
        shift = (place + a * math.sin(p) / w**2, speed + a * math.cos(p) / w, constant / 2)
        found.append((part.over, shift, (-a / w**2, w, p)))
        end = w * part.over + p
        place = shift[0] + shift[1] * part.over + shift[2] * part.over**2
        place -= a * math.sin(end) / w**2
        speed += constant * part.over - a * (math.cos(end) - math.cos(p)) / w
    return tuple(
        Piece(over, tuple(c / place for c in powers), (a / place, w, p))
        for over, powers, (a, w, p) in found
    )


# ----------------------------------------------------------------------
# Laws of inputs over time: segments one after the other, or one formula of t.


#: Laws given by points instead of a duration and a displacement.
THROUGH = ("spline", "table")
_SECONDS = {"ms": 1e-3, "s": 1.0, "min": 60.0}

LAW_KEYS = (
    Key("law", Text((*INPUT_LAWS, *THROUGH)), "Motion law of the input", required=True),
    Key("over", Measured("0.5 s"), "Duration; a number is in seconds"),
    Key("by", NumberKey("driven"), "Displacement of the input; a dwell has none"),
    Key("times", ListOf(NumberKey(), "time", 1), "Of a spline or table: seconds since its begin"),
    Key("values", ListOf(NumberKey("driven"), "value", 1), "The displacements at these times"),
)


@internal("through", "duration", "displacement")
@dataclass(frozen=True, kw_only=True)
class LawSegment:
    """A segment of an input's law: the input moves by ``by`` in the time ``over``.

    Parameters
    ----------
    law : str
        ``dwell``; ``constant`` speed; ``ramp``: the speed changes evenly from that at the end of
        the segment before; ``trapezoid``: a third each of the time speeding up, at constant speed
        and slowing down; a motion law of cams: ``3-4-5``, ``cycloidal``, …; ``spline``: cubic,
        from rest to rest; ``table``: straight lines.
    over : number or str, optional
        The duration: ``"0.5 s"``, ``"200 ms"``; a number is in seconds.
    by : number, optional
        The displacement, in file units; only a dwell has none.
    times, values : tuple of number
        Of ``spline`` and ``table``: times [s] and displacements since the segment's beginning.

    Examples
    --------
    >>> import linkwork as lw
    >>> rise = lw.LawSegment(law="3-4-5", over="0.5 s", by=90)
    >>> bar = lw.example("four-bar").changed(inputs=lw.Input(link="crank", law=[rise]))
    >>> len(bar.sweep()), bar.sweep().quantity("rocker.velocity").unit
    (361, 'rad/s')
    """

    law: str
    over: Number | None = None
    by: Number | None = None
    times: tuple[Number, ...] = ()
    values: tuple[Number, ...] = ()

    def __post_init__(self) -> None:
        check_values(self)

    def through(self, numbers: Numbers) -> tuple[tuple[float, float], ...]:
        """The points of a spline or table, from its beginning."""
        pairs = zip(self.times, self.values, strict=True)
        return ((0.0, 0.0), *((numbers(t), numbers(by)) for t, by in pairs))

    def duration(self, numbers: Numbers) -> float:
        """How long it takes [s]."""
        if self.law in THROUGH:
            return self.through(numbers)[-1][0]
        assert self.over is not None
        return seconds(self.over, numbers)

    def displacement(self, numbers: Numbers) -> float:
        """How far the input moves, in file units."""
        return self.through(numbers)[-1][1] if self.law in THROUGH else numbers(self.by or 0)


def seconds(time: Number, numbers: Numbers) -> float:
    """A time with or without its unit [s].

    Raises
    ------
    ExpressionError
        If it cannot be read.
    """
    if isinstance(time, str) and (split := split_unit(time, _SECONDS)) is not None:
        amount, unit = split
        return numbers(amount) * _SECONDS[unit]
    return numbers(time)


def law_mistakes(
    segments: tuple[LawSegment, ...], numbers: Numbers
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """What is wrong with segments: the key below the law and a message."""
    if not segments:
        yield (), "is empty: write at least one segment"
    for k, segment in enumerate(segments):
        for key, message in _mistakes(segment, numbers):
            yield (k, *key), message


def _mistakes(segment: LawSegment, numbers: Numbers) -> Iterator[tuple[tuple[str | int, ...], str]]:
    known = (*INPUT_LAWS, *THROUGH)
    if segment.law not in known:
        yield ("law",), f"must be one of {', '.join(known)}, got {segment.law}"
        return
    by_points = segment.law in THROUGH
    if by_points and (segment.over is not None or segment.by is not None):
        yield (), f"a {segment.law} has times and values instead of over and by: leave these out"
        return
    if by_points and not (segment.times and len(segment.times) == len(segment.values)):
        counts = f"{len(segment.times)} times and {len(segment.values)} values"
        yield ("times",), f"need as many times as values, at least one; there are {counts}"
        return
    if not by_points and (segment.times or segment.values):
        yield ("times",), "are used with spline and table only"
    if not by_points and segment.over is None:
        yield ("over",), 'is missing: the duration, as in over = "0.5 s"'
        return
    if not by_points and segment.by is None and segment.law != "dwell":
        yield ("by",), "is missing: how far the input moves, as in by = 90"
        return
    own: list[tuple[tuple[str | int, ...], Number | None]]
    own = [(("over",), segment.over), (("by",), segment.by)]
    for name in ("times", "values"):
        own += [((name, k), number) for k, number in enumerate(getattr(segment, name))]
    wrong = False
    for key, number in own:
        try:
            seconds(0 if number is None else number, numbers)
        except ExpressionError as error:
            wrong = True
            yield key, error.message
    if wrong:
        return
    over, by = segment.duration(numbers), segment.displacement(numbers)
    steps = np.diff([t for t, _ in segment.through(numbers)]) if by_points else np.ones(1)
    if min(steps) <= 0.0:
        yield ("times", int(np.flatnonzero(steps <= 0.0)[0])), "must increase from 0"
    elif over <= 0.0:
        yield ("over",), f"must be a positive time, got {over:g}"
    elif segment.law == "dwell" and by:
        yield ("by",), "must be 0: a dwell does not move"


def formula_mistake(formula: str, numbers: Numbers) -> str | None:
    """What is wrong with a formula of t."""
    try:
        tree = parse(formula, comparing=True)
    except ExpressionError as error:
        return str(error)
    for node in names_in(tree):
        if node.name != "t" and node.name not in numbers.known and node.name not in CONSTANTS:
            return (
                f'column {node.column}: "{node.spelling}" is not defined: a law is a formula of t '
                "and of dimensions"
            )
    return None


# ----------------------------------------------------------------------
# The speed of an input: ``"300 rpm"``, ``"25 rad/s"``, ``"50 mm/s"``, or a bare number.


_ANGULAR = {"rpm": math.tau / 60.0, "rad/s": 1.0, "deg/s": math.pi / 180.0}  # [rad/s]


def speed_per_second(speed: Number, kind: str, numbers: Numbers, length: str) -> float:
    """The speed in the mechanism's unit per second.

    Parameters
    ----------
    speed : number or str
        A number or formula, optionally with a unit.
    kind : str
        The driven kind: ``slider`` and ``cylinder`` have a linear speed, ``link`` and ``joint`` an
        angular one, ``variable`` either.
    numbers : Numbers
        The dimensions, and the unit of angles.
    length : str
        The unit of lengths; nothing is converted.

    Raises
    ------
    ExpressionError
        If the number cannot be read, or the unit does not fit the driven quantity.
    """
    if not isinstance(speed, str):
        return numbers(speed)
    if (split := split_speed(speed, kind, length)) is not None:
        amount, unit = split
        return numbers(amount) * (
            _ANGULAR[unit] / numbers.unit.radians if unit in _ANGULAR else 1.0
        )
    try:
        return numbers(speed.rstrip())
    except ExpressionError:
        known = ", ".join(_units(kind, length))
        raise ExpressionError(
            f'must be a number and a unit ({known}), got "{speed[:40]}"', speed, 1
        ) from None


def split_speed(speed: str, kind: str, length: str) -> tuple[str, str] | None:
    """The amount and the unit of a speed; ``None`` without a unit. Parameters as above."""
    text = speed.rstrip()
    for unit in sorted(_units(kind, length), key=len, reverse=True):
        amount = text[: -len(unit)]
        # rpm is also written RPM
        if text[-len(unit) :].lower() == unit.lower() and not amount[-1:].isalpha():
            return amount, unit
    return None


def _units(kind: str, length: str) -> list[str]:
    """The units of a driven kind's speed."""
    angular = [] if kind in ("slider", "cylinder") else list(_ANGULAR)
    linear = [] if kind in ("link", "joint") else [f"{length}/s"]
    return angular + linear


# ----------------------------------------------------------------------
# A motor on an input: its torque, or force, over its speed.


#: A path of keys.
Keys = tuple[str | int, ...]
MOTOR_KEYS = (
    Key("stall", NumberKey("length"), "Torque, or force, at rest; constant without a free speed"),
    Key("free_speed", Speed(), "Speed at which it has no torque, as 1500 rpm"),
    Key("speeds", ListOf(Speed(), "speed", 2), "Or a table: rising speeds"),
    Key("torques", ListOf(NumberKey("length"), "torque", 2), "The torques at these speeds"),
)


@internal("mistakes", "curve", "corners", "constant")
@dataclass(frozen=True, kw_only=True)
class Motor:
    """A motor on an input, for simulations.

    Parameters
    ----------
    stall : number, optional
        The torque, or for a length the force, at rest.
    free_speed : str or number, optional
        The speed at which it has no torque: ``"1500 rpm"``; between, the torque falls evenly, and
        beyond it brakes. Without it the torque is constant.
    speeds, torques : tuple of number or str
        Instead: a table, straight between its speeds and level beyond.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Motor(stall=12, free_speed="1500 rpm").free_speed
    '1500 rpm'
    """

    stall: Number | None = None
    free_speed: Number | None = None
    speeds: tuple[Number, ...] = ()
    torques: tuple[Number, ...] = ()

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def constant(self) -> bool:
        """Whether its torque is the same at all speeds."""
        return self.free_speed is None and not self.speeds

    def mistakes(self, kind: str, numbers: Numbers, length: str) -> Iterator[tuple[Keys, str]]:
        """Keys below the motor with what is wrong; parameters as of :func:`speed_per_second`."""
        contradiction = self._contradiction()
        if contradiction is not None:
            yield contradiction
            return
        problems: list[tuple[Keys, str]] = []
        torques: dict[Keys, Number] = {
            ("torques", k): torque for k, torque in enumerate(self.torques)
        }
        if self.stall is not None:
            torques = {("stall",): self.stall}
        for key, torque in torques.items():
            numbers.check_amount(
                lambda at, message: problems.append((tuple(at), message)), key, torque
            )
        yield from problems
        below = -math.inf
        for key, speed in self._speeds:
            try:
                found = speed_per_second(speed, kind, numbers, length)
            except ExpressionError as error:
                yield key, error.message
                continue
            if key == ("free_speed",) and found == 0.0:
                yield key, "must not be 0"
            elif self.stall is not None and not problems and numbers(self.stall) * found < 0.0:
                yield key, "must have the sign of stall: the torque falls with the speed"
            elif found <= below:
                yield key, f"must rise: {speed} is not above the speed before it"
            below = found

    @property
    def _speeds(self) -> Iterator[tuple[Keys, Number]]:
        if self.free_speed is not None:
            yield ("free_speed",), self.free_speed
        for k, speed in enumerate(self.speeds):
            yield ("speeds", k), speed

    def _contradiction(self) -> tuple[Keys, str] | None:
        """Fields that exclude each other, or are incomplete."""
        if (self.stall is None) == (not self.speeds):
            what = "both" if self.speeds else "neither"
            return ("stall",), f"a motor has either a stall torque or a table, this has {what}"
        if self.speeds and self.free_speed is not None:
            return ("free_speed",), "is used with stall only"
        if len(self.speeds) != len(self.torques):
            counts = f"{len(self.speeds)} speeds and {len(self.torques)} torques"
            return ("speeds",), f"need as many torques as speeds; there are {counts}"
        if len(self.speeds) == 1:
            return ("speeds",), "need two at least: a constant torque is written as stall"
        return None

    def curve(self, kind: str, numbers: Numbers, length: str) -> Callable[[Array], Array]:
        """The torque over speeds (B,) in the unit of the file per second."""
        if self.speeds:
            known = self.corners(kind, numbers, length)
            torques = [numbers(each) for each in self.torques]
            return lambda speed: np.interp(speed, known, torques)
        assert self.stall is not None
        stall = numbers(self.stall)
        if self.free_speed is None:
            return lambda speed: np.full_like(speed, stall)
        free = speed_per_second(self.free_speed, kind, numbers, length)
        return lambda speed: stall * (1.0 - speed / free)

    def corners(self, kind: str, numbers: Numbers, length: str) -> Array:
        """The speeds of its table in the unit of the file per second, (C,)."""
        known = (speed_per_second(each, kind, numbers, length) for each in self.speeds)
        return np.array([float(speed) for speed in known])


# ----------------------------------------------------------------------
# An input of a mechanism: the driven quantity and its range.


@dataclass(frozen=True, kw_only=True)
class Input:
    """An input: the driven quantity, its range and its speed.

    Exactly one of ``link``, ``joint``, ``slider``, ``cylinder`` and ``variable`` is given.

    Parameters
    ----------
    link : str, optional
        The link whose angle is driven.
    joint : str, optional
        The pin between two links whose relative angle is driven.
    slider, cylinder : str, optional
        The slider or slot whose displacement, or the cylinder whose length, is driven.
    variable : str, optional
        The driven variable of loop equations.
    relative_to : str, optional
        With ``link``: the link from which the angle is measured; by default ground.
    from_, to, step : number or formula, optional
        The input values in file units (in a file ``from``, ``to``, ``step``). An angle without them
        makes one turn in steps of one degree. With a law they are times [s].
    speed : str or number, optional
        ``"300 rpm"``, ``"25 rad/s"``, ``"90 deg/s"``, for lengths ``"50 mm/s"``; a number is in
        file units per second.
    law : tuple of LawSegment, or str, optional
        How the input moves in time: segments one after the other from t = 0, or its value as a
        formula of t.
    begin : number or formula, optional
        With segments: its value at t = 0, by default that of the sketch or guess.
    motor : Motor, optional
        What drives it in simulations.
    inertia : number, optional
        In simulations: the moment of inertia that turns with it, a flywheel [mass · length²]; of a
        length a mass.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Input(link="crank", from_=0, to=90, step=30, speed="300 rpm").column
    'crank'
    >>> lw.Input(link="stick", relative_to="boom").column
    'stick-boom'
    """

    link: str | None = None
    joint: str | None = None
    slider: str | None = None
    cylinder: str | None = None
    variable: str | None = None
    relative_to: str | None = None
    from_: Number | None = None
    to: Number | None = None
    step: Number | None = None
    speed: Number | None = None
    law: tuple[LawSegment, ...] | str | None = None
    begin: Number | None = None
    motor: Motor | None = None
    inertia: Number | None = None

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def drives(self) -> tuple[str, str]:
        """``(kind, name)`` of the driven quantity; ``("", "")`` if none is named."""
        for kind in ("link", "joint", "slider", "cylinder", "variable"):
            name: str | None = getattr(self, kind)
            if name is not None:
                return kind, name
        return "", ""

    @property
    def column(self) -> str:
        """The name of the input in results, ``crank``, ``stick-boom``, ``s16``."""
        kind, name = self.drives
        if kind == "link" and self.relative_to not in (None, "ground"):
            return f"{name}-{self.relative_to}"
        return name
