"""Path generation by least squares: mechanisms whose coupler point follows a curve best."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import islice

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, ComplexArray
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
from linkwork.synthesis.lane_least_squares import Progress, part_of
from linkwork.synthesis.loops.limits import Candidates, Drive, LoopKind
from linkwork.synthesis.poses.guiding_linkage import drawn_within, is_tolerant
from linkwork.synthesis.precision.given_lengths import four_bars_with_lengths, solved_member
from linkwork.synthesis.precision.positions import GivenLength, PrecisionPositions
from linkwork.synthesis.precision.solving import (
    PrecisionFourBars,
    four_bars_through,
    positions_with_samples,
)
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.tasks.conditions import FEWEST, LENGTHS, Wishes
from linkwork.synthesis.tasks.task import MECHANISMS, Task

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
        candidates=tuple(_curve_candidates(goal, part) for part in fitted if len(part)),
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


def _curve_candidates(goal: CurveGoal, fitted: FittedCurves) -> Candidates:
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


# ----------------------------------------------------------------------
# Path generation: four-bars through points, and through points and poses.


_SAMPLES = 8  # tasks at once, where conditions are missing,
_MOST = 64  # and at most so many while fewer designs are sound than are to be delivered
_PATHS, _SLOW_PATHS = 4000, 500  # followed before the last ones, with Numba and without: a second
_NEAR = 16  # tasks within tolerances
_SEED = 1
#: What a task can do about a list that is not proved: it has no input to change.
_GRADES = {
    Completeness.NOT_PROVED: "not proved: solution paths were lost, so mechanisms may be missing; "
    "move a position a little to see whether it has more",
    Completeness.MULTIPLE: "not proved: some solutions coincide; move a position a little",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class _Near:
    """Positions within the tolerances, tasks with eight conditions that contain them, the solved
    four-bars, and further tasks where conditions are drawn.
    """

    positions: PrecisionPositions
    tasks: tuple[PrecisionPositions, ...]
    further: Iterator[PrecisionPositions]
    solved: list[PrecisionFourBars] = field(default_factory=list)


def solve_path(
    task: Task,
    wishes: Wishes,
    progress: Callable[[float], None] | None,
    sound: Callable[[Candidates], int],
) -> SolvedTask:
    """All four-bars for eight conditions, or those of a sample of tasks with fewer.

    ``sound`` counts the sound designs of candidates: too few of them are worth a larger sample.

    Raises
    ------
    InputError
        For more than eight conditions.
    """
    points = np.array([complex(*position.point) for position in task.positions])
    lengths = [
        GivenLength(one, other, length)
        for (one, other), length in ((name.split(), x) for name, x in task.given.lengths.items())
    ]
    near = list(_near(task, points, wishes, lengths))
    _check_lengths(task, lengths, near[0])
    share = _SharedProgress(progress)
    member, reason = None, ""
    if near[0].tasks[0].lengths:
        result = solved_member(near[0].tasks[0].problem, share.part(1 + len(near)))
        member, reason = result.member, result.reason and f"; {result.reason}"
        if member is None:
            near = list(_near(task, points, wishes, lengths, drawn=True))
    fits = bool(lengths) and member is None
    count = sum(len(part.tasks) for part in near)
    for part in near:
        for positions in part.tasks:
            follow = share.part(count + fits * len(near))
            part.solved.append(
                four_bars_through(positions, member=member, alike=count, progress=follow)
            )
            count -= 1
    if fits:
        return _fitted(task, points, near, share, reason)
    if len(near) == 1:
        _solve_further(task, points, near[0], share, sound)
    solved = [four_bars for part in near for four_bars in part.solved]
    grade, message = _completeness(solved, near)
    return SolvedTask(
        candidates=_candidates(points, solved),
        complex=sum(len(part.roots.x) for part in solved),
        real=sum(part.real for part in solved),
        proved=sum(map(_proved, solved)),
        triples=sum(part.real for part in solved if len(part) > part.real),
        completeness=grade,
        message=message + _of_four_bars(task),
    )


def _solve_further(
    task: Task,
    points: ComplexArray,
    near: _Near,
    share: _SharedProgress,
    sound: Callable[[Candidates], int],
) -> None:
    """Solve further tasks with drawn conditions until enough designs are sound, within a bound."""
    missing = task.rank.deliver - sum(map(sound, _candidates(points, near.solved)))
    most = _PATHS if find_spec("numba") else _SLOW_PATHS
    while (
        missing > 0
        and sum(four_bars.roots.paths for four_bars in near.solved) < most
        and (tasks := tuple(islice(near.further, _SAMPLES)))
    ):
        left = _MOST - len(near.solved)
        more = [
            four_bars_through(positions, alike=left - k, progress=share.part(left - k))
            for k, positions in enumerate(tasks)
        ]
        near.solved.extend(more)
        missing -= sum(map(sound, _candidates(points, more)))


def _fitted(
    task: Task, points: ComplexArray, near: Sequence[_Near], share: _SharedProgress, reason: str
) -> SolvedTask:
    """A sample of four-bars with given lengths, from the four-bars of tasks without lengths."""
    fitted = [
        four_bars_with_lengths(part.positions, part.solved, share.part(len(near) - k))
        for k, part in enumerate(near)
    ]
    number, tasks = sum(map(len, fitted)), sum(len(part.tasks) for part in near)
    return SolvedTask(
        candidates=_candidates(points, fitted),
        complex=number,
        real=number,
        proved=sum(int(np.isfinite(part.error).sum()) for part in fitted),
        completeness=Completeness.SAMPLED,
        message=f"a sample: four-bars with the given lengths, from those of {tasks} tasks"
        + reason
        + _of_four_bars(task),
    )


class _SharedProgress:
    """Progress of parts of the work, each of which takes its share of the rest."""

    def __init__(self, progress: Callable[[float], None] | None) -> None:
        self._progress, self._done = progress, 0.0

    def part(self, left: int) -> Callable[[float], None] | None:
        """The progress function of the first of ``left`` equal parts; earlier parts are done."""
        begin, share = self._done, (1.0 - self._done) / left
        self._done += share
        return part_of(self._progress, begin, share)


def _near(
    task: Task,
    points: ComplexArray,
    wishes: Wishes,
    lengths: Sequence[GivenLength],
    *,
    drawn: bool = False,
) -> Iterator[_Near]:
    """The positions of the task, and a sample of positions within their tolerances.

    ``drawn``: conditions are drawn in place of the lengths, also where these determine the rest.
    """
    angles = np.array(
        [np.nan if p.angle is None else task.in_radians(p.angle) for p in task.positions]
    )
    pivots = np.array([complex(*pivot) for pivot in task.given.fixed_pivots], dtype=complex)
    region = wishes.region if wishes.region.size else None
    rng, known = np.random.default_rng(_SEED), () if drawn else lengths
    tolerant = is_tolerant(task)
    # without tolerances the only shifts are 0
    shifts, turns = drawn_within(task, _NEAR if tolerant else 1, np.random.default_rng(_SEED))
    most, samples = (1, 1) if tolerant else (_MOST, _SAMPLES)
    for shift, turn in zip(shifts, turns, strict=True):
        moved, turned = points + shift, angles + turn
        drawn_tasks = positions_with_samples(moved, turned, pivots, most, rng, region, known)
        yield _Near(
            positions=PrecisionPositions.of(moved, turned, pivots, lengths),
            tasks=tuple(islice(drawn_tasks, samples)),
            further=drawn_tasks,
        )


def _check_lengths(task: Task, lengths: Sequence[GivenLength], near: _Near) -> None:
    """Refuse more lengths than the positions leave freedoms.

    Raises
    ------
    MechanismError
    """
    freedoms = near.positions.problem.freedoms + len(lengths)
    if len(lengths) > freedoms:
        message = f"are {len(lengths)}, but positions and pivots leave {freedoms} freedoms"
        task.refuse([(("given", "lengths"), f"{message}: leave some out")])


def _candidates(points: ComplexArray, solved: Sequence[Candidates]) -> tuple[Candidates, ...]:
    return tuple(
        Candidates(
            kind=LoopKind.FOUR_BAR,
            fixed_a=four_bars.fixed_a,
            fixed_b=four_bars.fixed_b,
            moving_a=four_bars.moving_a,
            moving_b=four_bars.moving_b,
            guided=four_bars.guided,
            error=four_bars.error,
            miss=np.abs(four_bars.guided - points).max(axis=1),
        )
        for four_bars in solved
        if len(four_bars)
    )


def _of_four_bars(task: Task) -> str:
    """That other kinds are not made, if the task names them."""
    others = [name for name in task.mechanisms if name != LoopKind.FOUR_BAR.value]
    if not others or task.mechanisms == MECHANISMS:
        return ""
    return f"; no {' or '.join(others)}: points are solved for four-bars only"


def _proved(four_bars: PrecisionFourBars) -> int:
    """The number of real solutions that are proved with all their cognates."""
    return four_bars.real - len(np.unique(four_bars.triple[~four_bars.proved]))


def _completeness(
    solved: Sequence[PrecisionFourBars], near: Sequence[_Near]
) -> tuple[Completeness, str]:
    if len(solved) > 1:
        drawn = near[0].positions.problem.freedoms > 0
        text = " within the tolerances" if len(near) > 1 else ""
        text += ", in which the missing conditions were drawn" if drawn else ""
        return Completeness.SAMPLED, f"a sample: {len(solved)} tasks{text}"
    roots, grade = solved[0].roots, solved[0].completeness
    closed = "" if roots.closed is None else "closed" if roots.closed else "not closed"
    text = _GRADES.get(grade, grade.value)
    message = (
        f"{text} ({roots.paths} paths, {roots.at_infinity} to infinity, {roots.lost_paths}"
        f"{closed and f'; {closed} under conjugation'})"
    )
    return grade, message
