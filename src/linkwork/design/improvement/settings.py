"""The settings of an improvement: what varies, goals, starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

__all__ = ["Goal", "Improvement"]

Problems = Iterator[tuple[tuple[str | int, ...], str]]


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A wanted value of a quantity in some rows, or of a number of the whole motion, file units.

    Parameters
    ----------
    of : str
        ``B.y``, ``rocker``, an output; or ``stroke(d)``, ``min(transmission)``.
    target, least, most : float, optional
        The wanted value, or bounds.
    at, values : tuple of float
        Inputs, and the values wanted there.
    weight : float
        How much a unit of the miss counts.
    """

    of: str
    target: float | None = None
    least: float | None = None
    most: float | None = None
    at: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    weight: float = 1.0

    def problems(self) -> Problems:
        """What contradicts itself."""
        bounds = self.least, self.most
        if self.values:
            if len(self.values) != len(self.at):
                told = f"{len(self.values)} values for {len(self.at)} inputs: give as many"
                yield ("values",), told
            if self.target is not None or bounds != (None, None):
                yield ("values",), "exclude target, least and most: give one goal for each"
        elif self.target is None and bounds == (None, None):
            yield (), "has no target, least, most or values: say what is wanted"
        if None not in bounds and self.least > self.most:  # type: ignore[operator]  # not None
            yield ("least",), f"{self.least:g} and most = {self.most:g} contradict each other"
        if self.target is not None and bounds != (None, None):
            yield ("target",), "excludes least and most: give one goal for each"
        if not (self.weight > 0.0 and math.isfinite(self.weight)):
            yield ("weight",), f"must be above 0, got {self.weight:g}"


@dataclass(frozen=True, kw_only=True)
class Improvement:
    """How dimensions are improved.

    Parameters
    ----------
    point : str
        The point that follows the positions of a task; "": the first traced one.
    vary : tuple of str
        Numbers that vary; none: all lengths and coordinates.
    goals : tuple of Goal
    bounds : Mapping[str, (float, float)]
        Bounds of numbers by name [file units].
    starts : int
    spread : float
        Relative spread of the starts about the mechanism as it is.
    front : int
        Designs between two goals; 0 for a weighted sum.
    seed : int
    """

    point: str = ""
    vary: tuple[str, ...] = ()
    goals: tuple[Goal, ...] = ()
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    starts: int | None = None
    spread: float = 0.05
    front: int = 0
    seed: int = 1

    def problems(self) -> Problems:
        """What contradicts itself."""
        for k, goal in enumerate(self.goals):
            for key, message in goal.problems():
                yield ("goals", k, *key), message
        for name, (low, high) in self.bounds.items():
            if not low <= high:
                yield ("bounds", name), f"from {low:g} to {high:g} hold no number"
        if not 0.0 <= self.spread < 1.0:
            yield ("spread",), f"must be at least 0 and below 1, got {self.spread:g}"
