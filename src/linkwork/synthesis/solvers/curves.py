"""Path generation by least squares: mechanisms whose coupler point follows a curve best."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.units import FULL_TURN, arc_in_order
from linkwork.synthesis.improvement.curve_fit import FittedCurves, fit_curve
from linkwork.synthesis.improvement.curves import (
    INPUT,
    CouplerCurves,
    CurveGoal,
    FourBarCurves,
    SliderCrankCurves,
)
from linkwork.synthesis.improvement.settings import Improvement
from linkwork.synthesis.lane_problems import Progress, part_of
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.tasks.conditions import LENGTHS, Wishes
from linkwork.synthesis.tasks.curve_file import FEWEST
from linkwork.synthesis.tasks.task import Task

_STARTS = 1000
_USUAL = 12.0  # largest distances of a point from their mean: the longest links without a bound
_CLOSES = 2.0  # largest steps: how near the ends of a closed curve are
_ROUNDINGS = 16.0  # of a pivot from lengths and angles
_SAFETY = 4.0  # more than the first order of the error of an intersection of circles
_KINDS: dict[str, type[CouplerCurves]] = {
    LoopKind.FOUR_BAR.value: FourBarCurves,
    LoopKind.SLIDER_CRANK.value: SliderCrankCurves,
}
#: Names of a task's bounds, and of the dimensions they bound.
_BOUNDED = {
    "A0.x": "A0.x", "A0.y": "A0.y", "B0.x": "B0.x", "B0.y": "B0.y",
    "A0 A": "crank", "A B": "coupler", "B0 B": "rocker", INPUT: INPUT,
}  # fmt: skip

#: Keys of improvements that fits of curves do not have, and their fields.
_OF_IMPROVEMENTS = {
    "vary": "vary", "goals": "goals", "front": "front", "point": "point", "goal": "fit",
    "spread": "spread",
}  # fmt: skip


def solve_curve(task: Task, wishes: Wishes, progress: Progress | None) -> SolvedTask:
    """The best four-bars and slider-cranks of a sample of starts: different fits.

    Raises
    ------
    MechanismError
        For bounds of unknown dimensions.
    """
    if {*task.mechanisms} <= task.left_out.keys():
        name, why = next(iter(task.left_out.items()))
        message = f'"{name}" does not fit what is given: {why}; leave one out, or add "four-bar"'
        task.refuse([(("mechanism",), message)])
    goal = curve_goal_of(task, wishes)
    settings = task.improvement or Improvement()
    starts = settings.starts or _STARTS
    requested = [name for name in _KINDS if name in task.mechanisms]
    kinds = [_KINDS[name] for name in requested if name not in task.left_out]
    fitted: list[FittedCurves] = []
    for k, kind in enumerate(kinds):
        rng = np.random.default_rng([settings.seed, k])
        tell = part_of(progress, k / len(kinds), 1.0 / len(kinds))
        fitted.append(fit_curve(kind, goal, starts, rng, tell))
        if not fitted[-1].finished:
            break
    count, usual = sum(map(len, fitted)), usual_longest(task)
    return SolvedTask(
        candidates=tuple(_candidates(goal, part) for part in fitted if len(part)),
        complex=count,
        real=count,
        proved=count,
        completeness=Completeness.SAMPLED,
        message=_message(goal, fitted, settings.seed)
        + "".join(f"; no {name}: {why}" for name, why in task.left_out.items() if name in requested)
        + f"; lengths up to {usual:.4g} {task.length} unless [wanted] bounds them"
        * math.isfinite(usual)
        + ("" if task.curve is None else task.curve.note),
        drives=(Drive.A0,),
        starts=sum(part.starts for part in fitted),
        interrupted=not all(part.finished for part in fitted),
    )


def curve_goal_of(task: Task, wishes: Wishes) -> CurveGoal:
    """The goal of a task in radians and complex points."""
    points = np.array([complex(*position.point) for position in task.positions])
    timed = task.positions[0].input is not None
    inputs = [task.in_radians(p.input or 0.0) for p in task.positions] if timed else None
    driven, turns = None, wishes.range is not None and wishes.range.turn
    if wishes.range is not None and not turns:
        ends = wishes.range.start, wishes.range.stop
        driven = min(ends), max(ends)
    goal = CurveGoal(
        points=points,
        inputs=None if inputs is None else np.array(inputs),
        ordered=wishes.ordered,
        closed=is_closed(task, driven),
        turns_fully=turns,
        range=driven,
        transmission=wishes.transmission,
        bounds=dict(_bounds(task, wishes)),
        shortest=wishes.shortest,
        longest=min(wishes.longest, usual_longest(task)),
        ratio=wishes.ratio,
        reach=wishes.reach if wishes.reach.any() else None,
    )
    low, high = goal.input_bounds
    if low > high:
        message = "leave no angle for the inputs of the positions in the wanted range: widen one"
        task.refuse([(("improve", "bounds", INPUT), message)])
    return goal


def usual_longest(task: Task) -> float:
    """The longest link of a fit whose task bounds no dimensions, but counts size [length]."""
    wanted, given = task.wanted, task.given
    bounded = task.improvement is not None and {*task.improvement.bounds} - {INPUT}
    if bounded or not task.rank.size or min(wanted.longest, wanted.ratio) < math.inf:
        return math.inf
    points = np.array([position.point for position in task.positions])
    away = np.array([*points, *given.fixed_pivots, *wanted.region]) - points.mean(axis=0)
    return float(
        max(_USUAL * np.hypot(*away.T).max(), *given.lengths.values(), 2.0 * wanted.shortest)
    )


def is_closed(task: Task, driven: tuple[float, float] | None = None) -> bool:
    """Whether the positions of a task are a closed curve, passed in a driven range [rad]."""
    points = np.array([complex(*position.point) for position in task.positions])
    if task.curve is not None and task.curve.closed:
        return task.curve.closed == "closed"
    if driven is not None and driven[1] - driven[0] < FULL_TURN:
        return False  # less than a turn passes a part of the curve
    if len(points) < FEWEST:
        return False  # of which any ends are near each other
    inputs = [position.input for position in task.positions if position.input is not None]
    if inputs:
        _, span = arc_in_order(np.array(inputs), task.angle.turn)
        half = task.angle.turn / 2.0
        gaps = np.abs((np.diff(inputs) + half) % task.angle.turn - half)
        if span + _CLOSES * float(gaps.max()) < task.angle.turn:
            return False
    steps = np.abs(np.diff(points))
    return bool(abs(points[-1] - points[0]) <= _CLOSES * steps.max())


def _bounds(task: Task, wishes: Wishes) -> Iterator[tuple[str, tuple[float, float]]]:
    """Bounds from given pivots, the region of pivots and the settings, the narrowest last."""
    if wishes.region.size:
        for name in ("A0", "B0"):
            yield f"{name}.x", (wishes.region.real.min(), wishes.region.real.max())
            yield f"{name}.y", (wishes.region.imag.min(), wishes.region.imag.max())
    for name, pivot in zip(("A0", "B0"), task.given.fixed_pivots, strict=False):
        for axis, value in zip("xy", pivot, strict=True):
            yield f"{name}.{axis}", (value, value)
    for name, length in task.given.lengths.items():
        yield _BOUNDED[name], (length, length)
    settings = task.improvement or Improvement()
    for key, name in _OF_IMPROVEMENTS.items():
        if getattr(settings, name) != getattr(Improvement, name):
            message = 'belongs to task = "improve": leave it out'
            task.refuse([(("improve", key), message)])
    placed = ("A0.x", "A0.y", "B0.x", "B0.y")[: 2 * len(task.given.fixed_pivots)]
    for name, (low, high) in settings.bounds.items():
        message = ""
        if name not in _BOUNDED:
            message = "is no dimension: these are " + ", ".join(f'"{one}"' for one in _BOUNDED)
        elif name in (*task.given.lengths, *placed):
            message = "is given in [given] already: leave one out"
        elif name in LENGTHS and high <= 0.0:
            message = f"must allow lengths above 0, got {low:g} to {high:g}"
        if message:
            task.refuse([(("improve", "bounds", name), message)])
        scale = task.angle.radians if name == INPUT else 1.0
        yield _BOUNDED[name], (low * scale, high * scale)


def _message(goal: CurveGoal, fitted: list[FittedCurves], seed: int) -> str:
    starts = sum(part.starts for part in fitted)
    kind = "a closed curve" if goal.closed else "a part of a curve"
    timing = "given timing" if goal.inputs is not None else "free timing"
    text = f"a sample: different fits from {starts} starts with seed {seed}"
    if not all(part.finished for part in fitted):
        text = f"interrupted: the best so far of {starts} starts with seed {seed}"
    return f"{text}; {kind}, {timing}"


def _candidates(goal: CurveGoal, fitted: FittedCurves) -> Candidates:
    curves, x = fitted.kind(fitted.side), fitted.x
    loop = curves.points(x, fitted.angles)
    a0 = x[:, 0] + 1j * x[:, 1]
    if fitted.kind is FourBarCurves:
        b0, direction = x[:, 2] + 1j * x[:, 3], np.zeros(len(x), dtype=complex)
        sine = np.abs(
            np.sin(np.angle((loop.moving_b - loop.moving_a) / (loop.moving_b - b0[:, None])))
        )
    else:
        direction = np.exp(1j * x[:, 5])
        b0 = a0 + 1j * direction * x[:, 4]
        sine = np.abs(((loop.moving_b - loop.moving_a) / direction[:, None]).real) / x[:, 3, None]
    far = np.abs(loop.moving_b - a0[:, None]).max(axis=1) + np.abs(b0 - a0) + np.abs(a0)
    doubt = _ROUNDINGS * UNIT_ROUNDOFF * (far + np.abs(loop.guided).max(axis=1))
    least = sine.min(axis=1)
    with np.errstate(all="ignore"):
        # the intersection of circles that move by ``doubt``, where it is far from a double one
        error = np.where(doubt < 1e-3 * far * least**2, _SAFETY * doubt / least, math.inf)
    return Candidates(
        kind=LoopKind.FOUR_BAR if fitted.kind is FourBarCurves else LoopKind.SLIDER_CRANK,
        fixed_a=a0,
        fixed_b=b0,
        direction=direction,
        moving_a=loop.moving_a,
        moving_b=loop.moving_b,
        guided=loop.guided,
        error=error,
        miss=np.abs(loop.guided - goal.points).max(axis=1),
    )
