"""Motion generation: four-bars and slider-cranks whose coupler passes through poses."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, islice

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, Array, ComplexArray
from linkwork.core.foundation.errors import MechanismError
from linkwork.core.foundation.statuses import Completeness
from linkwork.synthesis.loops.limits import GUIDED, Candidates, Drive, LoopKind
from linkwork.synthesis.poses.burmester import (
    CentrePoints,
    DyadSet,
    PoseSet,
    centre_points,
    dyads_with_pivots,
    pair_dyads,
    pair_guides,
    sampled_dyads,
    sliding_dyad,
)
from linkwork.synthesis.poses.dyads import FIVE, Refusal, solve_five_poses
from linkwork.synthesis.poses.guiding_linkage import (
    drawn_within,
    inverted,
    is_tolerant,
    near_tasks,
    on_lines,
    spread_pivots,
    through_fixed,
    through_line,
    through_moving,
    timed_dyads,
    with_misses,
)
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import Task

_PIVOTS = {2: 12, 3: 60}  # of a family through so many poses; two leave further freedom
_ON_CURVE = 1e-6  # relative to the size of the task: a given pivot on the centre-point curve
_CURVE_SAMPLES = 400
_MOST_PARALLEL = 4  # three parallel poses still have parallelograms
#: The centres of three positions of points of a body that translates differ like these points.
_PARALLELOGRAMS = (
    "; the poses have one angle, so all cranks are equal and parallel and every four-bar is a "
    "parallelogram, whose branch is lost at its change points: turn a pose, or guide the body by "
    "a third crank"
)
_TASKS = 400  # within tolerances
_MOST_DESIGNS = 20_000  # of them
_ROUNDED = 16.0 * EPSILON  # of a pole, relative to coordinates
_PARALLEL = 1e-12  # angles that differ by less are equal to rounding


def poses_of(task: Task) -> tuple[ComplexArray, Array]:
    """The poses of a task, (N,) complex [length] and (N,) [rad]."""
    points = np.array([complex(*position.point) for position in task.positions])
    angles = np.array([position.angle or 0.0 for position in task.positions])
    return points, angles * task.angle.radians


def solve_motion(task: Task, wishes: Wishes) -> SolvedTask:
    """All designs through five poses, or a sample of the family through fewer."""
    points, angles = poses_of(task)
    _check_motion(task, points, angles)
    if len(points) >= FIVE:
        return _through_five(task, points, angles)
    return _through_few(task, wishes, points, angles)


def _check_motion(task: Task, points: ComplexArray, angles: Array) -> None:
    """Refuse poses for which one joint is enough, and no linkage is determined.

    Raises
    ------
    MechanismError
    """
    turns = np.exp(1j * (angles - angles[0]))
    # the pole of the first pose and the one turned most from it
    k = int(np.abs(turns - 1.0).argmax())
    if abs(turns[k] - 1.0) < _PARALLEL:
        ways = points[1:] - points[0]
        off = abs((ways[-1] * ways[0].conj()).imag) / (np.abs(ways) ** 2).max()
        if len(points) >= _MOST_PARALLEL:
            text = "all have the same angle: the body only translates, and two guides (a PP dyad) "
            text += "carry it through any such poses; no dyad with a pivot is determined"
            task.refuse([(("positions",), text)])
        elif len(ways) > 1 and not off > _PARALLEL:
            text = "have one angle and lie on a line: a slider along it carries the body, and no "
            task.refuse([(("positions",), f"{text}linkage is determined")])
    elif len(points) > 2 or points[0] == points[1]:
        # not -0
        pole = complex((turns[k] * points[0] - points[k]) / (turns[k] - 1.0)) + (0.0 + 0.0j)
        size = max(float(np.abs(points - points[0]).max()), abs(points[0] - pole))
        rounding = _ROUNDED * np.abs(points).max() / abs(turns[k] - 1.0)
        away = np.abs(pole + (points[0] - pole) * turns - points).max()
        if away <= _PARALLEL * size + rounding:
            text = f"all lie on a rotation about [{pole.real:.6g}, {pole.imag:.6g}]: a fixed pin "
            text += "there carries the body, and no linkage is determined"
            task.refuse([(("positions",), text)])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Family:
    """Dyads, of which the first ``leading`` are the cranks if that is not 0."""

    dyads: DyadSet
    message: str = ""
    leading: int = 0
    timed: bool = False


def _pairs(task: Task, family: _Family, poses: PoseSet) -> tuple[list[Candidates], str]:
    """The mechanisms of the kinds that the task names, and a note on pairs that make none."""
    made, note = pair_dyads(family.dyads, poses, family.leading), ""
    guides_requested = any(name in GUIDED for name in task.mechanisms)
    if guides_requested and family.leading:
        note = "; given pivots and timing are those of cranks: no mechanisms of two guides are made"
    elif guides_requested:
        guided, immobile = pair_guides(family.dyads, poses)
        made += guided
        if immobile:
            note = f"; {immobile} pairs of guides are parallel or share a pivot: no such mechanism"
    return [part for part in made if part.kind.value in task.mechanisms], note


def _poses(points: ComplexArray, angles: Array) -> PoseSet:
    return PoseSet(points=points[None], turns=np.exp(1j * angles)[None])


def _through_few(task: Task, wishes: Wishes, points: ComplexArray, angles: Array) -> SolvedTask:
    """A sample of the family through the poses, and with tolerances through poses near them."""
    first = _family(task, wishes, points, angles)
    pairs, note = _pairs(task, first, _poses(points, angles))
    if is_tolerant(task):
        near = _near_pairs(task, wishes, points, angles)
        every = [pairs, *islice(near, max(0, _MOST_DESIGNS // max(1, sum(map(len, pairs))) - 1))]
        note += (
            f"; the same for {len(every)} tasks within the tolerances, the exact one first"
            if len(every) > 1
            else "; the poses are met exactly, and tolerances are not used"
        )
        whole: dict[LoopKind, list[Candidates]] = {}
        for part in chain(*every):
            kept = with_misses(task, points, angles, part)
            whole.setdefault(part.kind, []).extend([] if kept is None else [kept])
        pairs = [Candidates.joined(parts) for parts in whole.values() if parts]
    return SolvedTask(
        candidates=tuple(pairs),
        complex=len(first.dyads),
        real=len(first.dyads),
        proved=int((first.dyads.refusal == Refusal.NONE.code).sum()),
        completeness=Completeness.SAMPLED,
        message=first.message + note,
        dyads=first.dyads,
        drives=(Drive.A0,) if first.timed else tuple(Drive),
    )


def _near_pairs(
    task: Task, wishes: Wishes, points: ComplexArray, angles: Array
) -> Iterator[list[Candidates]]:
    """The mechanisms through poses within the tolerances."""
    shift, turn = drawn_within(task, _TASKS)
    for near, turned in zip(points + shift[1:], angles + turn[1:], strict=True):
        with suppress(MechanismError):  # given pivots may be off the curves of the near poses
            yield _pairs(task, _family(task, wishes, near, turned), _poses(near, turned))[0]


def _through_five(task: Task, points: ComplexArray, angles: Array) -> SolvedTask:
    tasks = near_tasks(task, points, angles)
    solved = solve_five_poses(tasks.points, tasks.angles)
    chosen = PoseSet(points=tasks.points, turns=np.exp(1j * tasks.angles))
    dyads = DyadSet.of_solutions(solved, chosen)
    pairs, note = _pairs(task, _Family(dyads=dyads), chosen)
    near = (with_misses(task, points, angles, part) for part in pairs)
    of_task = dyads.take(dyads.task == 0)
    first = solved.refusal[0]
    if (first == Refusal.FAMILY.code).all():
        grade, message = Completeness.CONTINUUM, Refusal.FAMILY.value
    elif not tasks.is_exact:
        grade = Completeness.SAMPLED
        message = f"a sample of {len(tasks.points)} tasks within the tolerances"
    elif bool(solved.complete[0]):
        grade = Completeness.PROVED
        message = "all dyads: four different solutions are proved, and there are no more"
    else:
        grade, message = Completeness.NOT_PROVED, Refusal.COINCIDENT.value
    return SolvedTask(
        candidates=tuple(part for part in near if part is not None),
        complex=solved.x.shape[1],
        real=len(of_task),
        proved=int((of_task.refusal == Refusal.NONE.code).sum()),
        completeness=grade,
        message=message + note,
        dyads=of_task,
    )


def _family(task: Task, wishes: Wishes, points: ComplexArray, angles: Array) -> _Family:
    """Dyads through four, three or two poses, those of given pivots first."""
    turns = np.exp(1j * angles)
    fixed = np.array([complex(*pivot) for pivot in task.given.fixed_pivots])
    moving = np.array([complex(*pivot) for pivot in task.given.moving_pivots])
    moving = (moving - points[0]) * turns[0].conj() if moving.size else moving
    count = len(points)
    if count == 4:
        return _through_four(task, fixed, moving, points, angles)
    spread = spread_pivots(points, wishes, _PIVOTS[count])
    free = [
        through_fixed(spread, points, turns),
        _guided(points, turns, (spread - points[0]) * turns[0].conj()),
        _guided(*inverted(points, turns), spread).inverted(),
    ]
    if task.positions[0].input is not None:
        inputs = np.array([position.input or 0.0 for position in task.positions])
        pivots = fixed[:1] if fixed.size else spread
        cranks = timed_dyads(pivots, points, turns, inputs * task.angle.radians)
        second = [through_fixed(fixed[1:], points, turns)] if len(fixed) > 1 else free
        return _Family(
            dyads=DyadSet.joined([cranks, *second]),
            leading=len(cranks),
            timed=True,
            message="a sample: the crank turns by the given angles, the other link is free",
        )
    given = [through_fixed(fixed, points, turns)] if fixed.size else []
    given += [through_moving(moving, points, turns)] if moving.size else []
    count_given = len(fixed) + len(moving)
    if count_given == 2 and count == 3:
        return _Family(dyads=DyadSet.joined(given), message="the one four-bar with these pivots")
    parallel = count > 2 and bool(np.abs(turns - turns[0]).max() < _PARALLEL)
    parallel &= "four-bar" in task.mechanisms
    return _Family(
        dyads=DyadSet.joined([*given, *free]) if count_given < 2 else DyadSet.joined(given),
        leading=sum(map(len, given)) if count_given == 1 else 0,
        message=f"a sample of the family through {count} poses" + parallel * _PARALLELOGRAMS,
    )


def _guided(points: ComplexArray, turns: ComplexArray, pivots: ComplexArray) -> DyadSet:
    """PR dyads: for three poses one for each direction, for two one for each moving pivot (K,)."""
    if len(points) == 2:
        return through_line(pivots, points, turns)
    directions = np.linspace(0.0, np.pi, len(pivots), endpoint=False)
    return on_lines(np.exp(1j * directions), points, turns)


def _through_four(
    task: Task, fixed: ComplexArray, moving: ComplexArray, points: ComplexArray, angles: Array
) -> _Family:
    turns = np.exp(1j * angles)
    curve = centre_points(points, angles)
    through = []
    if fixed.size:
        _check_on_curve(task, "fixed_pivots", fixed, curve, points, (0j, 1.0 + 0j))
        through.append(_determined(task, "fixed_pivots", fixed, points, angles))
    # the body sees the fixed pivots move: its circle points are centre points of that motion
    body = centre_points(inverted(points, turns)[0], -angles)
    if moving.size:
        _check_on_curve(task, "moving_pivots", moving, body, points, (points[0], turns[0]))
        turned = _determined(task, "moving_pivots", moving, inverted(points, turns)[0], -angles)
        through.append(replace(turned, moving=turned.fixed, fixed=turned.moving))
    free = [sampled_dyads(points, angles), sliding_dyad(points, angles)]
    number = len(fixed) + len(moving)
    arcs = () if curve is None else curve.arcs
    proved = "proved" if curve is not None and all(arc.proved for arc in arcs) else "unproved"
    return _Family(
        dyads=DyadSet.joined(through if number > 1 else [*through, *free]),
        leading=sum(map(len, through)) if number == 1 else 0,
        message=f"a sample of dyads along the centre-point curve: {len(arcs)} {proved} "
        f"arc{'' if len(arcs) == 1 else 's'}",
    )


def _determined(
    task: Task, key: str, pivots: ComplexArray, points: ComplexArray, angles: Array
) -> DyadSet:
    """The dyads of given pivots, fixed in the frame of these poses, through all four of them."""
    reach = 4.0 * _ON_CURVE * float(np.abs(points - points.mean()).max())
    dyads = dyads_with_pivots(pivots, points, angles, reach)
    if len(dyads) == len(pivots):
        return dyads
    unmatched = [k for k, p in enumerate(pivots) if not (np.abs(dyads.fixed - p) < reach).any()]
    message = "determines no dyad: the body turns about it from one pose to another"
    task.refuse([(("given", key, unmatched[0] if unmatched else 0), message)])
    return dyads


def _check_on_curve(
    task: Task,
    key: str,
    pivots: ComplexArray,
    curve: CentrePoints | None,
    points: ComplexArray,
    frame: tuple[complex, complex],
) -> None:
    """Refuse given pivots that are not on their curve, and name its nearest point.

    ``frame``: origin and direction of the curve's frame at the first pose.
    """
    size, (origin, turn) = float(np.abs(points - points.mean()).max()), frame
    name = "centre-point" if key == "fixed_pivots" else "circle-point"
    if curve is None:
        text = f"are not made for four poses of which three are parallel: the {name} curve is no "
        task.refuse([(("given", key), f"{text}cubic; leave them out")])
        return
    for k, pivot in enumerate(pivots):
        near = curve.points(np.angle([pivot - curve.pole]))[0]
        if (np.abs(near - pivot) < _ON_CURVE * size).any():
            continue
        sampled = curve.points(np.linspace(0.0, np.pi, _CURVE_SAMPLES))
        sampled = np.concatenate([near, sampled.ravel()])
        best = origin + turn * sampled[np.nanargmin(np.abs(sampled - pivot))]
        text = f"is not on the {name} curve of the four poses; the nearest point of it is about "
        task.refuse([(("given", key, k), f"{text}[{best.real:.6g}, {best.imag:.6g}]")])
