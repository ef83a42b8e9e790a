"""Path generation: four-bars through points, and through points and poses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.design.precision import PrecisionFourBars, four_bars_through, positions_with_samples
from linkwork.design.synthesis.candidates import Candidates, LoopKind
from linkwork.design.synthesis.found import Found
from linkwork.design.synthesis.task import Task
from linkwork.design.synthesis.wishes import Wishes
from linkwork.foundation.completeness import Completeness

__all__ = ["solve_path"]

_SAMPLES = 8  # tasks, where conditions are missing
_SEED = 1


def solve_path(task: Task, wishes: Wishes, progress: Callable[[float], None] | None) -> Found:
    """All four-bars for eight conditions, or those of a sample of tasks with fewer.

    Raises
    ------
    InputError
        For more than eight conditions, or a kind of mechanism other than the four-bar.
    """
    points = np.array([complex(*position.point) for position in task.positions])
    angles = np.array(
        [np.nan if p.angle is None else task.in_radians(p.angle) for p in task.positions]
    )
    pivots = np.array([complex(*pivot) for pivot in task.given.fixed_pivots], dtype=complex)
    region = wishes.region if wishes.region.size else None
    rng = np.random.default_rng(_SEED)
    solved: list[PrecisionFourBars] = []
    tasks = list(positions_with_samples(points, angles, pivots, _SAMPLES, rng, region))

    def go_on(fraction: float) -> None:
        if progress is not None:
            progress((len(solved) + fraction) / len(tasks))

    for given in tasks:
        solved.append(
            four_bars_through(
                given,
                alike=len(tasks) - len(solved),
                progress=None if progress is None else go_on,
            )
        )
        go_on(0.0)
    grade, message = _completeness(solved)
    return Found(
        candidates=tuple(_candidates(part) for part in solved if len(part)),
        complex=sum(len(part.roots.x) for part in solved),
        real=sum(part.real for part in solved),
        proved=sum(map(_proved, solved)),
        triples=sum(part.real for part in solved if len(part) > part.real),
        completeness=grade,
        message=message,
    )


def _candidates(found: PrecisionFourBars) -> Candidates:
    count = len(found)
    return Candidates(
        kind=LoopKind.FOUR_BAR,
        fixed_a=found.fixed_a,
        fixed_b=found.fixed_b,
        direction=np.zeros(count, dtype=complex),
        moving_a=found.moving_a,
        moving_b=found.moving_b,
        guided=found.guided,
        error=found.error,
        miss=np.zeros(count),
    )


def _proved(found: PrecisionFourBars) -> int:
    """The number of real solutions that are proved with all their cognates."""
    return found.real - len(np.unique(found.triple[~found.proved]))


def _completeness(solved: list[PrecisionFourBars]) -> tuple[Completeness, str]:
    if len(solved) > 1:
        return (
            Completeness.SAMPLED,
            f"a sample: {len(solved)} tasks, in which the missing conditions were drawn",
        )
    roots, grade = solved[0].roots, solved[0].completeness
    message = (
        f"{grade.value} ({roots.paths} paths, {roots.at_infinity} to infinity, {roots.lost} lost)"
    )
    return grade, message
