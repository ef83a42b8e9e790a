"""Improve a mechanism: better numbers for its goals, each design swept and proved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from linkwork.design.differentiable_numbers import chosen_numbers
from linkwork.design.improvement.free_timing import freely_timed
from linkwork.design.improvement.goals import PathGoal
from linkwork.design.improvement.improved_design import ImprovedDesign
from linkwork.design.improvement.mechanism_fit import fit_numbers, path_misses
from linkwork.design.improvement.settings import Goal, Improvement, Points
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import (
    InputError,
    LinkworkError,
    MechanismError,
    Problem,
    UnknownNameError,
    choices,
)
from linkwork.foundation.names import GROUND, find_spelling
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.varied_number import VariedNumber, number_named, with_numbers
from linkwork.motion.model import Model, model_of
from linkwork.motion.sweeping import sweep
from linkwork.numerics.lane_least_squares import Box
from linkwork.results.motion import Motion

__all__ = [
    "FACTOR",
    "STARTS",
    "box_of",
    "improved_designs",
    "numbers_to_vary",
    "point_named",
]

STARTS = 16
FACTOR = 4.0  # by which lengths may change, unless bounds are given
_FAR = 2.0  # longest numbers or links, by which others may change
_EQUAL_NUMBERS = 1e-6  # relative difference of numbers of equal designs


def improved_designs(
    model: Model,
    goals: Sequence[Goal | Points],
    settings: Improvement,
    progress: Callable[[float], None] | None = None,
) -> tuple[ImprovedDesign, ...]:
    """Different local minima, sound ones first, then by their misses.

    Raises
    ------
    InputError, MechanismError
        For goals that contradict themselves, or a mechanism without a motion.
    """
    _check(settings, goals)
    points = next((goal for goal in goals if isinstance(goal, Points)), None)
    others = [goal for goal in goals if isinstance(goal, Goal)]
    numbers = numbers_to_vary(model, settings.vary)
    if not numbers:
        raise InputError(f'"{model.description.name}" has no number that can vary alone')
    x = np.array([float(q.of(model.description)) for q in numbers])
    motion = sweep(model, certify=False)
    if not motion.found.any():
        raise InputError(f'"{model.description.name}" has no position: improve one that moves')
    rng = np.random.default_rng(settings.seed)
    count = settings.starts or STARTS
    starts = x * (1.0 + settings.spread * rng.uniform(-1.0, 1.0, (count, len(x))))
    starts[0] = x
    box = box_of(model, numbers, settings)
    paths = _paths(model, motion, points) if points else (None,)
    minimax = settings.fit == "minimax"
    fits = []
    for part, path in enumerate(paths):

        def tell(fraction: float, done: int = part) -> None:
            if progress is not None:
                progress((done + fraction) / len(paths))

        begin = box.inside(starts)
        found = fit_numbers(
            model, motion, numbers, box, begin, path, others, minimax=minimax, progress=tell
        )
        fits.append((path, found))
        if found.interrupted:
            break
    best = sorted(
        (float((found.largest if minimax else found.total)[k]), part, int(k))
        for part, (_, found) in enumerate(fits)
        for k in np.flatnonzero(np.isfinite(found.total))
    )
    designs: list[ImprovedDesign] = []
    for _, part, k in best:
        path, found = fits[part]
        if _is_known(found.x[k], designs):
            continue
        told = "interrupted: the best so far; " if found.interrupted else ""
        design = replace(
            _design(model, numbers, found.x[k], told),
            total=float(found.total[k]),
            largest=float(found.largest[k]),
        )
        if path is not None:
            rms = float(np.sqrt(found.path[k] / len(path.places)))
            design = _on_path(replace(design, rms=rms), model, numbers, path, found.t[k])
        designs.append(design)
    return tuple(sorted(designs, key=lambda design: not design.sound))


def _check(settings: Improvement, goals: Sequence[Goal | Points]) -> None:
    found = [(key, message) for key, message in settings.problems()]
    for k, goal in enumerate(goals):
        found += [(("goals", k, *key), message) for key, message in goal.problems()]
    if not goals:
        found.append((("goals",), "are missing: say what is wanted"))
    if sum(isinstance(goal, Points) for goal in goals) > 1:
        found.append((("goals",), "name points twice: one point follows them"))
    if found:
        raise MechanismError([Problem(key=k, message=m) for k, m in found], "the improvement")


def numbers_to_vary(model: Model, names: Sequence[str]) -> tuple[VariedNumber, ...]:
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


def box_of(model: Model, numbers: Sequence[VariedNumber], settings: Improvement) -> Box:
    """The bounds of numbers.

    Raises
    ------
    InputError
        For bounds of a number that does not vary.
    """
    x = np.array([float(q.of(model.description)) for q in numbers])
    description = model.description
    lengths = description.lengths.values() if isinstance(description, Draft) else ()
    # a coordinate of 0 may vary by itself too
    longest = max((abs(float(description.numbers(length))) for length in lengths), default=0.0)
    far = _FAR * max(float(np.abs(x).max()), longest)
    is_length = np.array([q.table == "lengths" for q in numbers])
    least = np.where(is_length, x / FACTOR, x - far)
    most = np.where(is_length, x * FACTOR, x + far)
    for name, (low, high) in settings.bounds.items():
        number = number_named(model.description, name)
        if number not in numbers:
            raise InputError(f'"{name}" has bounds and does not vary: add it to vary')
        k = numbers.index(number)
        least[k], most[k] = low, high
    return Box(least=least, most=most)


def point_named(model: Model, name: str) -> str:
    """A point as the mechanism spells it.

    Raises
    ------
    UnknownNameError
        If there is none.
    """
    spelled = find_spelling(name, model.equations.points)
    if spelled not in model.equations.points:
        known = choices("points", model.equations.points, name)
        raise UnknownNameError(f'there is no point "{name}" {known}')
    return spelled


def _paths(model: Model, motion: Motion, goal: Points) -> tuple[PathGoal, ...]:
    description = model.description
    name = goal.point or next(iter(description.trace), None)
    if name is None:
        raise InputError(f'"{description.name}" traces no point: name one, point = "P"')
    spelled = point_named(model, name)
    places = np.array([complex(*place) for place in goal.points])
    if goal.inputs is None:
        return freely_timed(model, motion, spelled, places, goal.order != "any")
    inputs = np.asarray(goal.inputs, dtype=float) * float(model.input_scale[0])
    return (PathGoal(point=spelled, places=places, inputs=inputs, timed=True, ordered=True),)


def _is_known(x: Array, designs: Sequence[ImprovedDesign]) -> bool:
    others = [np.array(list(design.numbers.values())) for design in designs]
    return any(np.abs(other - x).max() <= _EQUAL_NUMBERS * np.abs(x).max() for other in others)


def _design(model: Model, numbers: Sequence[VariedNumber], x: Array, told: str) -> ImprovedDesign:
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
        largest=np.nan,
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
    return replace(design, inputs=own, misses=tuple(map(float, misses)), sound=sound, message=told)
