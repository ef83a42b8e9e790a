"""The settings of an improvement: what varies, goals, starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from linkwork.core.foundation.errors import MechanismError, Problem, choices
from linkwork.core.foundation.values import as_told, plain_number

#: How misses count.
FITS = ("least squares", "minimax")
#: The least and the largest of whole numbers.
WHOLE = {"starts": (1, 10**6), "front": (2, 1000), "seed": (0, 2**31)}

_LARGEST = 1e12  # of goals: squares of misses stay far from overflow

Problems = Iterator[tuple[tuple[str | int, ...], str]]


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A target of a quantity in some rows, or of a number of the whole motion, in file units.

    Parameters
    ----------
    of : str
        ``B.y``, ``rocker``, an output; or ``stroke(d)``, ``min(transmission)``.
    target, least, most : float, optional
        The target value, or bounds.
    at, values : tuple of float
        Inputs, and the target values there.
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

    @property
    def is_bound(self) -> bool:
        """Whether only values beyond bounds are misses."""
        return not self.values and self.target is None

    def problems(self) -> Problems:
        """What contradicts itself."""
        bounds = self.least, self.most
        limits = {"target": (self.target,), "least": (self.least,), "most": (self.most,)}
        for key, numbers in {**limits, "values": self.values}.items():
            for number in numbers:
                if number is not None and not abs(number) <= _LARGEST:
                    yield (key,), f"must be within ±{_LARGEST:g}, got {number:g}"
        if self.values:
            if len(self.values) != len(self.at):
                message = f"{len(self.values)} values for {len(self.at)} inputs: give as many"
                yield ("values",), message
            value_at: dict[float, float] = {}
            for k, (at, value) in enumerate(zip(self.at, self.values, strict=False)):
                if value_at.setdefault(at, value) != value:
                    message = f"is another value than {value_at[at]:g} at {at:g}: leave one out"
                    yield ("values", k), message
            if self.target is not None or bounds != (None, None):
                yield ("values",), "exclude target, least and most: give one goal for each"
        elif self.target is None and bounds == (None, None):
            yield (), "has no target, least, most or values: add one"
        if None not in bounds and self.least > self.most:  # type: ignore[operator]  # not None
            yield ("least",), f"{self.least:g} and most = {self.most:g} contradict each other"
        if self.target is not None and bounds != (None, None):
            yield ("target",), "excludes least and most: give one goal for each"
        if not (self.weight > 0.0 and math.isfinite(self.weight)):
            yield ("weight",), f"must be above 0, got {self.weight:g}"


@dataclass(frozen=True, kw_only=True)
class Aid(Goal):
    """A bound that leads a fit: whether a design keeps it is judged in its whole motion."""


@dataclass(frozen=True, kw_only=True)
class Points:
    """Points that a point of the mechanism passes.

    Parameters
    ----------
    points : tuple of (float, float)
        In order of travel [length].
    point : str
        The point that passes them; "": the first traced one.
    inputs : tuple of float, optional
        The leading inputs there [file units]; ``None``: free timing.
    order : str
        "as given" or "any", of free timing.
    """

    points: tuple[tuple[float, float], ...]
    point: str = ""
    inputs: tuple[float, ...] | None = None
    order: str = "as given"

    def problems(self) -> Problems:
        """What contradicts itself."""
        if len(self.points) < 2:
            yield ("points",), f"{len(self.points)} points are no path: give two or more"
        for k, (one, other) in enumerate(zip(self.points, self.points[1:], strict=False), start=2):
            if one == other:
                yield ("points", k - 1), f"is the same as point {k - 1}: leave one out"
        if self.inputs is not None and len(self.inputs) != len(self.points):
            message = f"{len(self.points)} points need as many inputs, got {len(self.inputs)}"
            yield ("inputs",), message
        if self.order not in _ORDERS:
            yield ("order",), f'must be "as given" or "any", got "{self.order}"'
        if self.order == "any" and self.inputs is not None:
            yield ("order",), "has no effect on points with inputs: leave it out"


_ORDERS = ("as given", "any")


def read_goal(table: Mapping[str, Any]) -> Goal | Points:
    """A goal, or points, from a table with their fields.

    Raises
    ------
    MechanismError
        For a key that neither has, or one that is missing.
    """
    kind: type[Goal] | type[Points] = Points if "points" in table else Goal
    known = [field.name for field in fields(kind)]
    problems = [
        Problem(key=(key,), message=f"is no key of a goal {choices('keys', known, key)}")
        for key in table
        if key not in known
    ]
    if kind is Goal and "of" not in table:
        problems.append(Problem(key=("of",), message="is missing: the quantity of the goal"))
    if problems:
        raise MechanismError(problems, "the improvement")
    return kind(**{key: _read_entry(entry) for key, entry in table.items()})


def _read_entry(value: Any) -> Any:
    """Arrays and lists as tuples of plain numbers."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return tuple(map(_read_entry, value)) if isinstance(value, list | tuple) else value


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
        Relative spread of the starts about the mechanism as it is; of numbers that are 0 relative
        to its longest link, of angles to a radian.
    front : int
        The largest number of designs of a front between the goals; 0 for a weighted sum.
    seed : int
    fit : str
        "least squares", or "minimax": the largest weighted miss counts.
    """

    point: str = ""
    vary: tuple[str, ...] = ()
    goals: tuple[Goal, ...] = ()
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    starts: int | None = None
    spread: float = 0.05
    front: int = 0
    seed: int = 1
    fit: str = "least squares"

    def problems(self) -> Problems:
        """What contradicts itself."""
        for k, goal in enumerate(self.goals):
            for key, message in goal.problems():
                yield ("goals", k, *key), message
        if self.fit not in FITS:
            yield ("goal",), f'must be "least squares" or "minimax", got "{self.fit}"'
        for name, (least, most) in WHOLE.items():
            number = getattr(self, name)
            whole = isinstance(number, int | np.integer) and least <= number <= most
            if not whole and number is not getattr(Improvement, name):
                text = f"must be a whole number of {least} to {most}, got {as_told(number)}"
                yield (name,), text
        if self.front and self.fit == "minimax":
            text = "has no effect on a front, which does not add up its goals: leave it out"
            yield ("goal",), text
        for name, pair in self.bounds.items():
            ends = [plain_number(end) for end in np.ravel(np.asarray(pair, dtype=object))]
            if len(ends) != 2 or None in ends:
                yield ("bounds", name), f"must be two numbers, got {as_told(pair)}"
            elif not pair[0] <= pair[1]:
                yield ("bounds", name), f"from {pair[0]:g} to {pair[1]:g} hold no number"
        spread = plain_number(self.spread)
        if spread is None or not 0.0 <= spread < 1.0:
            yield ("spread",), f"must be at least 0 and below 1, got {as_told(self.spread)}"

    def front_problems(self, goals: Sequence[Goal | Points]) -> Problems:
        """Goals between which there is no front."""
        if not self.front:
            return
        targets = [goal for goal in goals if isinstance(goal, Points) or not goal.is_bound]
        if len(targets) < 2:
            count = len(targets) or "none"
            message = f"lies between two goals or more, and {count} is given with a target"
            yield ("front",), f"{message}: bounds only limit it"
        for k, goal in enumerate(goals):
            if isinstance(goal, Goal) and goal.weight != 1.0 and not goal.is_bound:
                message = "has no effect on a front, whose goals are not summed: leave it out"
                yield ("goals", k, "weight"), message
