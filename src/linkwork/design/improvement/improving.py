"""Improve a mechanism: better numbers for its goals, each design swept and proved."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwork.design.differentiable_numbers import chosen_numbers
from linkwork.design.improvement.free_timing import freely_timed
from linkwork.design.improvement.mechanism_fit import PathGoal, fit_numbers, path_misses
from linkwork.design.improvement.settings import Goal, Improvement
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError, LinkworkError, MechanismError, Problem
from linkwork.foundation.internal import internal
from linkwork.foundation.names import GROUND, find_spelling
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.varied_number import VariedNumber, number_named, with_numbers
from linkwork.motion.model import Model, model_of
from linkwork.motion.sweeping import sweep
from linkwork.numerics.lane_least_squares import Box
from linkwork.results.motion import Motion

__all__ = ["ImprovedDesign", "improved_designs"]

_STARTS = 16
_FACTOR = 4.0  # by which lengths may change, unless bounds are given
_FAR = 2.0  # longest numbers, by which others may change
_EQUAL_NUMBERS = 1e-6  # relative difference of numbers of equal designs


@internal("description", "motion")
@dataclass(frozen=True, kw_only=True, eq=False)
class ImprovedDesign:
    """A mechanism with improved numbers.

    Parameters
    ----------
    description : Description
        With its new numbers.
    numbers : Mapping[str, float]
        Those that varied [file units].
    total : float
        The weighted sum of squares of all misses.
    rms : float
        The root mean square of the distances from the points; 0 without points [length].
    sound : bool
        Whether all rows of its table are proved to be on one branch.
    message : str
        Why it is not sound, and how the search ended.
    inputs : tuple of float
        The leading inputs at the points; none without points [file units].
    misses : tuple of float
        The distances from the points, on the branch of the table; NaN where this has no position.
    motion : Motion, optional
        Its table with the proofs; ``None`` if it has no position.

    Examples
    --------
    >>> import linkwork as lw
    >>> goal = {"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}
    >>> best = lw.example("four-bar").improve(goal, vary=["A B", "O4 B"], starts=4)[0]
    >>> sorted(best.numbers), best.sound
    (['A B', 'O4 B'], True)
    """

    description: Description
    numbers: Mapping[str, float]
    total: float
    rms: float
    sound: bool
    message: str
    inputs: tuple[float, ...] = ()
    misses: tuple[float, ...] = ()
    motion: Motion | None = None


def improved_designs(
    model: Model,
    goals: Sequence[Mapping[str, Any]],
    settings: Improvement,
    progress: Callable[[float], None] | None = None,
) -> tuple[ImprovedDesign, ...]:
    """Different local minima, sound ones first, then by their misses.

    Parameters
    ----------
    goals : sequence of Mapping
        ``{"of": "stroke(d)", "target": 40}``, or points: ``{"point": "F", "points": [...],
        "inputs": [...]}``; without inputs timing is free, in order or with ``"order": "any"``.

    Raises
    ------
    InputError, MechanismError
        For goals that contradict themselves, or a mechanism without a motion.
    """
    points = [goal for goal in goals if "points" in goal]
    others = [
        Goal(**{k: _plain(v) for k, v in goal.items()}) for goal in goals if goal not in points
    ]
    _check(settings, points, others)
    numbers = _varied(model, settings.vary)
    x = np.array([float(q.of(model.description)) for q in numbers])
    motion = sweep(model, certify=False)
    if not motion.found.any():
        raise InputError(f'"{model.description.name}" has no position: improve one that moves')
    rng = np.random.default_rng(settings.seed)
    count = settings.starts or _STARTS
    starts = x * (1.0 + settings.spread * rng.uniform(-1.0, 1.0, (count, len(x))))
    starts[0] = x
    box = _box(model, numbers, x, settings)
    paths = _paths(model, motion, points[0]) if points else (None,)
    fits = []
    for part, path in enumerate(paths):

        def tell(fraction: float, done: int = part) -> None:
            if progress is not None:
                progress((done + fraction) / len(paths))

        begin = box.inside(starts)
        fits.append((path, fit_numbers(model, motion, numbers, box, begin, path, others, tell)))
        if fits[-1][1].interrupted:
            break
    best = sorted(
        (float(found.total[k]), part, int(k))
        for part, (_, found) in enumerate(fits)
        for k in np.flatnonzero(np.isfinite(found.total))
    )
    designs: list[ImprovedDesign] = []
    for total, part, k in best:
        path, found = fits[part]
        if _is_known(found.x[k], designs):
            continue
        told = "interrupted: the best so far; " if found.interrupted else ""
        design = replace(_design(model, numbers, found.x[k], told), total=total)
        if path is not None:
            rms = float(np.sqrt(found.path[k] / len(path.places)))
            design = _on_path(replace(design, rms=rms), model, numbers, path, found.t[k])
        designs.append(design)
    return tuple(sorted(designs, key=lambda design: not design.sound))


def _plain(value: Any) -> Any:
    return tuple(value) if isinstance(value, list | tuple | np.ndarray) else value


def _check(settings: Improvement, points: Sequence[object], goals: Sequence[Goal]) -> None:
    found = [(key, message) for key, message in settings.problems()]
    for k, goal in enumerate(goals):
        found += [(("goals", k, *key), message) for key, message in goal.problems()]
    if not points and not goals:
        found.append((("goals",), "are missing: say what is wanted"))
    if len(points) > 1:
        found.append((("goals",), "name points twice: one point follows them"))
    if found:
        raise MechanismError([Problem(key=k, message=m) for k, m in found], "the improvement")


def _varied(model: Model, names: Sequence[str]) -> tuple[VariedNumber, ...]:
    """The numbers asked for, or all lengths, angles, offsets, dimensions and fixed pivots."""
    numbers, _ = chosen_numbers(model, names or None)
    if names:
        return numbers
    description = model.description
    fixed = set(description.links.get(GROUND, ())) if isinstance(description, Draft) else set()
    # a given distance of fixed pivots holds their coordinates, and follows from them
    lengths = description.lengths if isinstance(description, Draft) else ()
    given = [set(name.split()) for name in lengths]
    held = set().union(*(ends for ends in given if ends <= fixed))
    return tuple(
        q
        for q in numbers
        if (q.table == "points" and q.key in fixed - held)
        or (q.table == "lengths" and not set(q.key.split()) <= fixed)
        or q.table in ("angles", "sliders", "dimensions")
    )


def _box(model: Model, numbers: Sequence[VariedNumber], x: Array, settings: Improvement) -> Box:
    far = _FAR * float(np.abs(x).max())
    is_length = np.array([q.table == "lengths" for q in numbers])
    least = np.where(is_length, x / _FACTOR, x - far)
    most = np.where(is_length, x * _FACTOR, x + far)
    for name, (low, high) in settings.bounds.items():
        number = number_named(model.description, name)
        if number not in numbers:
            raise InputError(f'"{name}" has bounds and does not vary: add it to vary')
        k = numbers.index(number)
        least[k], most[k] = low, high
    return Box(least=least, most=most)


def _paths(model: Model, motion: Motion, goal: Mapping[str, Any]) -> tuple[PathGoal, ...]:
    description = model.description
    traced = next(iter(description.trace), None)
    name = goal.get("point", traced)
    if name is None:
        raise InputError(f'"{description.name}" traces no point: name one, "point": "P"')
    spelled = find_spelling(name, model.equations.points)
    if spelled not in model.equations.points:
        raise InputError(f'"{name}" is no point of {description.name}')
    places = np.array([complex(*place) for place in goal["points"]])
    if len(places) < 2:
        raise InputError(f"{len(places)} points are no path: give two or more")
    if goal.get("inputs") is None:
        ordered = goal.get("order", "as given") != "any"
        return freely_timed(model, motion, spelled, places, ordered)
    inputs = np.asarray(goal["inputs"], dtype=float)
    if len(inputs) != len(places):
        raise InputError(f"{len(places)} points need as many inputs, got {len(inputs)}")
    scale = float(model.input_scale[0])
    timed = PathGoal(
        point=spelled, places=places, inputs=inputs * scale, timed=True, ordered=True
    )
    return (timed,)


def _is_known(x: Array, designs: Sequence[ImprovedDesign]) -> bool:
    others = [np.array(list(design.numbers.values())) for design in designs]
    return any(np.abs(other - x).max() <= _EQUAL_NUMBERS * np.abs(x).max() for other in others)


def _design(
    model: Model, numbers: Sequence[VariedNumber], x: Array, told: str
) -> ImprovedDesign:
    """The design with its proof: a certified sweep of its whole table."""
    new = dict(zip(numbers, map(float, x), strict=True))
    description = with_numbers(model.description, new)
    motion = None
    try:
        motion = sweep(model_of(description))
        lost = int(np.count_nonzero(~motion.certified))
        told += f"{lost} of {len(motion)} rows are not proved" if lost else "all rows are proved"
    except LinkworkError as error:
        lost, told = 1, f"{told}{error}"
    return ImprovedDesign(
        description=description,
        numbers={q.name: value for q, value in new.items()},
        total=np.nan,
        rms=0.0,
        sound=not lost,
        message=told,
        motion=motion,
    )


def _on_path(
    design: ImprovedDesign,
    model: Model,
    numbers: Sequence[VariedNumber],
    path: PathGoal,
    t: Array,
) -> ImprovedDesign:
    """The design with its distances from the points, measured on its own proved branch."""
    order = slice(None, None, -1 if path.falling else 1)
    own = tuple(map(float, t[order] / model.input_scale[0]))
    misses = np.full(len(own), np.nan)
    if design.motion is not None and design.motion.found.any():
        x = np.array(list(design.numbers.values()))
        at = replace(path, inputs=t, timed=True)
        misses = path_misses(model_of(design.description), design.motion, numbers, at, x)[order]
    told, sound = design.message, design.sound
    if not np.isfinite(misses).all():
        told, sound = f"{told}; not all points lie on the branch of its table", False
    return replace(
        design, inputs=own, misses=tuple(map(float, misses)), sound=sound, message=told
    )
