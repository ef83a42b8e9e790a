"""Requests about what moves: a simulation, its end, the quantities that are shown."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Cancel", "ShowQuantities", "Simulate"]


@dataclass(frozen=True, kw_only=True)
class ShowQuantities:
    """The quantities, rates and numbers of the motion that the page needs besides the usual ones;
    replaces those of the request before. ``simulated``: of the simulation.
    """

    names: tuple[str, ...]
    simulated: bool = False


@dataclass(frozen=True, kw_only=True)
class Simulate:
    """Compute the motion in time, from 0 s to ``until``.

    ``at``: input values at the start, in file units, by default those of the guess; ``start_speed``
    may have a unit, "60 rad/s"; ``start_speeds``: of several inputs by name; ``change_points``:
    stop or straight; ``step``: between rows [s].
    """

    until: float | str
    start_speed: float | str = 0
    start_speeds: dict[str, float | str] | None = None
    at: dict[str, float | str] | None = None
    change_points: str = "stop"
    step: float | str | None = None


@dataclass(frozen=True, kw_only=True)
class Cancel:
    """End the computation under way."""
