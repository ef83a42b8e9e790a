"""A motor on an input: its torque, or force, over its speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from linkwork.foundation.errors import ExpressionError
from linkwork.foundation.file_keys import Key, ListOf, Number as NumberKey, Speed
from linkwork.foundation.internal import internal
from linkwork.foundation.value_types import check_values, is_listed
from linkwork.mechanism.dimensions import Number, Numbers
from linkwork.mechanism.speed import speed_per_second

if TYPE_CHECKING:
    from linkwork.foundation.arrays import Array

__all__ = ["MOTOR_KEYS", "Motor"]

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
        for name in ("speeds", "torques"):
            if is_listed(getattr(self, name)):
                object.__setattr__(self, name, tuple(getattr(self, name)))
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
