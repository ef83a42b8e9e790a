"""Path generation: four-bars through points, and through points and poses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import islice

import numpy as np

from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.statuses import Completeness
from linkwork.synthesis.lane_problems import part_of
from linkwork.synthesis.loops.candidates import Candidates, LoopKind
from linkwork.synthesis.poses.pose_families import drawn_within, is_tolerant
from linkwork.synthesis.precision.given_lengths import four_bars_with_lengths, solved_member
from linkwork.synthesis.precision.positions import GivenLength, PrecisionPositions
from linkwork.synthesis.precision.sampling import positions_with_samples
from linkwork.synthesis.precision.solving import PrecisionFourBars, four_bars_through
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import MECHANISMS, Task

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
