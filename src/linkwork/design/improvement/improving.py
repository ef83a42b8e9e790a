"""Improve a mechanism: better numbers for its goals, each design swept and proved."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from linkwork.design.differentiable_numbers import chosen_numbers
from linkwork.design.improvement.fit_problem import FittedNumbers, Fitting
from linkwork.design.improvement.free_timing import freely_timed
from linkwork.design.improvement.front_designs import front_designs
from linkwork.design.improvement.front_fit import fit_front
from linkwork.design.improvement.goals import PathGoal
from linkwork.design.improvement.improved_design import ImprovedDesign
from linkwork.design.improvement.mechanism_fit import fit_numbers
from linkwork.design.improvement.proved_design import fitted_design, interrupted_design
from linkwork.design.improvement.settings import Goal, Improvement, Points
from linkwork.design.improvement.written_designs import DesignWriter
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import (
    InputError,
    MechanismError,
    Problem,
    UnknownNameError,
    choices,
)
from linkwork.foundation.names import GROUND, find_spelling
from linkwork.foundation.operand import NotElementwise
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.varied_number import VariedNumber, number_named
from linkwork.motion.model import Model
from linkwork.motion.sweeping import sweep
from linkwork.numerics.lane_bounds import Box
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
_SEARCH = 0.9  # share of the search in the work; the rest is proofs
_FAR = 2.0  # longest numbers or links, by which others may change
# near a number that a goal does not depend on, such as a rod's length in a stroke without offset,
# all steps would fail that move it by its effect alone
_LEAST_EFFECT = 0.3
_EQUAL_NUMBERS = 1e-6  # relative difference of numbers of equal designs


def improved_designs(
    model: Model,
    goals: Sequence[Goal | Points],
    settings: Improvement,
    progress: Callable[[float], None] | None = None,
    *,
    is_sound: Callable[[ImprovedDesign], bool] = lambda design: design.sound,
    enough: int | None = None,
) -> tuple[ImprovedDesign, ...]:
    """Different local minima, sound ones first, then by their misses; or a front, in its order,
    and the designs found on the way to it that are not sound.

    ``is_sound``: what a design of a front has to be, besides undominated. ``enough``: so many sound
    designs end the proofs of an interrupted search. An interruption of the proofs keeps those done.

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
    box = box_of(model, numbers, settings)
    try:
        fits = _fits(model, numbers, box, points, others, settings, progress)
    except NotElementwise:
        raise InputError(_unfollowed(model, numbers)) from None
    if settings.front:
        return front_designs(model, numbers, box, others, fits, settings.front, is_sound)
    best = sorted(
        (float((found.largest if settings.fit == "minimax" else found.total)[k]), part, int(k))
        for part, (_, found) in enumerate(fits)
        for k in np.flatnonzero(np.isfinite(found.total))
    )
    designs: list[ImprovedDesign] = []
    sound, interrupted = 0, any(found.interrupted for _, found in fits)
    try:
        for done, (_, part, k) in enumerate(best):
            if progress is not None and not interrupted:
                interrupted = _is_stopped(progress, _SEARCH + (1.0 - _SEARCH) * done / len(best))
            if interrupted and sound == enough:
                break
            path, found = fits[part]
            if not _is_known(found.x[k], designs):
                designs.append(fitted_design(model, numbers, path, found, k))
                sound += is_sound(designs[-1])
    except KeyboardInterrupt:
        interrupted = True
    if interrupted and not designs:
        raise KeyboardInterrupt
    if interrupted:
        designs = [interrupted_design(design) for design in designs]
    return tuple(sorted(designs, key=lambda design: not design.sound))


def _fits(
    model: Model,
    numbers: Sequence[VariedNumber],
    box: Box,
    points: Points | None,
    goals: Sequence[Goal],
    settings: Improvement,
    progress: Callable[[float], None] | None,
) -> list[tuple[PathGoal | None, FittedNumbers]]:
    """Fits from all starts, one for each way to time the points."""
    motion = sweep(model, certify=False)
    if not motion.found.any():
        raise InputError(f'"{model.description.name}" has no position: improve one that moves')
    x = np.array([float(q.of(model.description)) for q in numbers])
    rng = np.random.default_rng(settings.seed)
    count = settings.starts or STARTS
    # a number of 0 spreads by the size of what it measures
    sizes = np.where(x == 0.0, _sizes(model, numbers, x), x)
    starts = x + settings.spread * sizes * rng.uniform(-1.0, 1.0, (count, len(x)))
    starts[0] = x
    paths = _paths(model, motion, points) if points else (None,)
    fits: list[tuple[PathGoal | None, FittedNumbers]] = []
    for part, path in enumerate(paths):

        def tell(fraction: float, done: int = part) -> None:
            if progress is not None:
                progress(_SEARCH * (done + fraction) / len(paths))

        begin = box.inside(starts)
        given = Fitting(
            model=model, motion=motion, numbers=numbers, box=box, path=path, goals=goals
        )
        if settings.front:
            found = fit_front(given, begin, settings.front, progress=tell)
        else:
            found = fit_numbers(given, begin, minimax=settings.fit == "minimax", progress=tell)
        fits.append((path, found))
        if found.interrupted:
            break
    return fits


def _is_stopped(progress: Callable[[float], None], fraction: float) -> bool:
    try:
        progress(fraction)
    except KeyboardInterrupt:
        return True
    return False


def _sizes(model: Model, numbers: Sequence[VariedNumber], x: Array) -> Array:
    """Sizes of what numbers (P,) measure: a radian, or the longest link or distance of points."""
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


def _check(settings: Improvement, goals: Sequence[Goal | Points]) -> None:
    found = [*settings.problems(), *settings.front_problems(goals)]
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
    return Box(least=least, most=most, least_effect=_LEAST_EFFECT)


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


def _unfollowed(model: Model, numbers: Sequence[VariedNumber]) -> str:
    """Which numbers a fit cannot vary, in words."""
    names = []
    for number in numbers:
        try:
            DesignWriter(model, [number])
        except NotElementwise:
            names.append(f'"{number.name}"')
    own = f'of "{model.description.name}"'
    if not names:
        return f"a fit cannot vary all these numbers {own} together: vary fewer"
    return f"a fit cannot vary {', '.join(names)} {own}: vary other numbers"


def _is_known(x: Array, designs: Sequence[ImprovedDesign]) -> bool:
    others = [np.array(list(design.numbers.values())) for design in designs]
    return any(np.abs(other - x).max() <= _EQUAL_NUMBERS * np.abs(x).max() for other in others)
