"""The settings of an improvement: what varies, goals, starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import LinkworkError, MechanismError, Problem, choices
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import as_told, plain_number
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import write_text
from linkwork.design.edits.unit_change import FileDegrees
from linkwork.synthesis.lane_least_squares import Box

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


# ----------------------------------------------------------------------
# Where fits begin: numbers around those of a mechanism.


STARTS = 16


def spread_starts(model: Model, numbers: Sequence[VariedNumber], settings: Improvement) -> Array:
    """Numbers (D, P) around those of the mechanism, which come first."""
    x = np.array([float(q.of(model.description)) for q in numbers])
    rng = np.random.default_rng(settings.seed)
    count = settings.starts or STARTS
    # a number of 0 spreads by the size of its quantity
    sizes = np.where(x == 0.0, _sizes(model, numbers, x), x)
    starts = x + settings.spread * sizes * rng.uniform(-1.0, 1.0, (count, len(x)))
    starts[0] = x
    return starts


def _sizes(model: Model, numbers: Sequence[VariedNumber], x: Array) -> Array:
    """Sizes of numbers (P,): a radian, or the longest link or distance of points."""
    description = model.description
    # of dimensions the kind is not known
    largest = float(np.abs(x[[q.table != "angles" for q in numbers]]).max(initial=0.0))
    size = largest or 1.0
    if isinstance(description, Draft):
        lengths = [float(description.numbers(length)) for length in description.lengths.values()]
        places = [[float(description.numbers(c)) for c in p] for p in description.points.values()]
        spans = np.ptp(places, axis=0) if places else np.zeros(2)
        size = max(lengths, default=0.0) or float(spans.max()) or size
    radian = description.angle.from_radians(1.0)
    return np.array([radian if q.table == "angles" else size for q in numbers])


# ----------------------------------------------------------------------
# Numbers that change together, so that a mechanism keeps its special dimensions.
#
# Equal sides of parallelograms, centre distances of gears and the sides of inversors are relations
# without which designs lock, or have no position. A fit of single numbers soon breaks them.


_EQUAL = 1e-9  # relative difference of numbers that are equal, or that are a distance of pivots
_TRIED = 1e-3  # relative change of a group, to see whether it can change alone


@dataclass(frozen=True, kw_only=True, eq=False)
class Together:
    """Sizes of groups, by which numbers change in proportion.

    Parameters
    ----------
    x : (P,)
        The numbers as they are [file units].
    sizes : (G,)
        The sizes of the groups as they are.
    slopes : (P, G)
        The changes of the numbers by those of the sizes; at most one in a row is not zero.
    """

    x: Array
    sizes: Array
    slopes: Array

    @classmethod
    def of(cls, x: Array, groups: Sequence[Array]) -> Together:
        """Groups by their directions (P,), which are disjoint and not zero."""
        sizes = np.array([np.abs(group).max() for group in groups])
        return cls(x=x, sizes=sizes, slopes=np.stack(groups, axis=1) / sizes)

    def numbers(self, sizes: Array) -> Array:
        """All numbers (D, P) at sizes (D, G)."""
        return np.asarray(self.x + (sizes - self.sizes) @ self.slopes.T)

    def box(self, box: Box) -> Box:
        """The bounds of the sizes, within which all numbers are in a box."""
        with np.errstate(all="ignore"):
            ends = [
                np.where(self.slopes != 0.0, (end - self.x)[:, None] / self.slopes, np.nan)
                for end in (box.least, box.most)
            ]
        least = self.sizes + np.nanmax(np.minimum(*ends), axis=0)
        most = self.sizes + np.nanmin(np.maximum(*ends), axis=0)
        # of a mechanism out of its bounds the sizes stay
        least, most = np.minimum(least, self.sizes), np.maximum(most, self.sizes)
        return Box(least=least, most=most, least_effect=box.least_effect)


def kept_relations(
    model: Model, motion: Motion, numbers: Sequence[VariedNumber]
) -> Iterator[Together]:
    """Directions of change: equal lengths stay equal and the ground in proportion; numbers that
    cannot change alone are left out. Last, all lengths in proportion.
    """
    x = np.array([float(q.of(model.description)) for q in numbers])
    if len(x) < 2:
        return
    scaled = _scaled(model, numbers, x)
    free = []
    for group in _groups(model, numbers, x, scaled):
        # numbers that cannot change together may change alone
        alone = [group, *(np.eye(len(x)) * group)[group != 0.0]]
        moving = [step for step in alone if _moves(model, motion, numbers, x + _TRIED * step)]
        free += moving[:1] if moving and moving[0] is group else moving
    if free and len(free) < len(numbers):
        yield Together.of(x, free)
    if scaled.any() and not any(np.array_equal(scaled, step) for step in free):
        yield Together.of(x, [scaled])


def _scaled(model: Model, numbers: Sequence[VariedNumber], x: Array) -> Array:
    """The change of numbers (P,) if all lengths grow about the first fixed pivot, else 0."""
    description = model.description
    center = np.zeros(2)
    if isinstance(description, Draft):
        for name in description.links.get(GROUND, ())[:1]:
            center = np.array([description.numbers(c) for c in description.points[name]])
    try:
        degrees = FileDegrees(data_of(write_text(description), description.name))
        kinds = {q: degrees.of_name(q.key) for q in numbers if q.table == "dimensions"}
    except LinkworkError:  # formulas that mix kinds
        kinds = {}
    about = [center[q.axis] if q.table == "points" else 0.0 for q in numbers]
    lengths = [
        q.table in ("lengths", "points", "sliders") or kinds.get(q) == "length" for q in numbers
    ]
    return np.where(lengths, x - about, 0.0)


def _groups(
    model: Model, numbers: Sequence[VariedNumber], x: Array, scaled_all: Array
) -> Iterator[Array]:
    """The directions of groups: equal lengths, the ground, and every other number alone."""
    description = model.description
    fixed = description.links.get(GROUND, ()) if isinstance(description, Draft) else ()
    pivots = [q.table == "points" and q.key in fixed for q in numbers]
    spans: list[float] = []
    if isinstance(description, Draft) and any(pivots):
        places = [complex(*map(description.numbers, description.points[n])) for n in fixed]
        spans = [abs(a - b) for k, a in enumerate(places) for b in places[:k]]
    left = {k for k, pivot in enumerate(pivots) if not pivot}
    # coordinates of a sketch are no lengths that could be equal
    scaled = np.where([q.table == "points" for q in numbers], 0.0, scaled_all)
    alike = _same(x, left, scaled, spans)
    ground = np.where(pivots, scaled_all, 0.0)
    ground[alike] = scaled[alike]
    if ground.any():
        yield ground
    left -= set(alike)
    while left:
        k = min(left)
        members = _same(x, left, scaled, (abs(x[k]),)) if scaled[k] else [k]
        direction = np.zeros(len(x))
        # a number of 0 has no proportion
        direction[members] = np.where(x[members] == 0.0, 1.0, x[members])
        yield direction
        left -= set(members)


def _same(x: Array, among: set[int], scaled: Array, sizes: Sequence[float]) -> list[int]:
    """The lengths among numbers that have one of some sizes."""
    return [
        k
        for k in sorted(among)
        if scaled[k] and any(abs(abs(x[k]) - size) <= _EQUAL * size for size in sizes)
    ]


def _moves(model: Model, motion: Motion, numbers: Sequence[VariedNumber], x: Array) -> bool:
    """Whether a mechanism with other numbers has as many positions."""
    try:
        other = with_numbers(model.description, dict(zip(numbers, map(float, x), strict=True)))
        solved = sweep(model_of(other), certify=False).found
    except LinkworkError:
        return False
    return int(solved.sum()) >= int(motion.found.sum())
