"""States of a simulated motion at times."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Sample"]


@dataclass(frozen=True, kw_only=True)
class Sample:
    """A state at a time: the leg, laps gained, place, speed and acceleration of the leader.

    ``event``: what happens there, "" for one that was asked for; ``lost``: the work of friction;
    ``stop``: the number of the bound that pushes, -1 for none, with its ``push`` or ``impulse``.
    """

    t: float
    leg: int
    lap: int
    s: float
    speed: float
    acceleration: float
    event: str = ""
    lost: float = 0.0
    stop: int = -1
    push: float = 0.0
    impulse: float = 0.0
