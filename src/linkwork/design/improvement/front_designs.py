"""The proved designs of a front: those that no other sound design surpasses in every goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from linkwork.design.improvement.fit_problem import FitProblem, FittedNumbers, Fitting
from linkwork.design.improvement.front_fit import BROKEN
from linkwork.design.improvement.goals import PathGoal
from linkwork.design.improvement.improved_design import ImprovedDesign
from linkwork.design.improvement.pareto_front import alike, objective_spans, spread, undominated
from linkwork.design.improvement.proved_design import fitted_design, interrupted_design
from linkwork.design.improvement.settings import Goal
from linkwork.foundation.arrays import Array
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.model import Model, model_of
from linkwork.numerics.lane_bounds import Box
from linkwork.numerics.lane_least_squares import starts_of

__all__ = ["front_designs"]

Fits = Sequence[tuple[PathGoal | None, FittedNumbers]]


def front_designs(
    model: Model,
    numbers: Sequence[VariedNumber],
    box: Box,
    goals: Sequence[Goal],
    fits: Fits,
    count: int,
    is_sound: Callable[[ImprovedDesign], bool],
    tell: Callable[[float], None],
) -> tuple[ImprovedDesign, ...]:
    """The front by rising first goal, then the designs that are not sound.

    Goals are measured anew on the motion that proves a design. A design that is not sound makes
    room for those that only it dominates. An interruption ends the proofs: the front is that of the
    designs proved by then.

    Parameters
    ----------
    goals : sequence of Goal
        Those of the fits.
    fits : sequence of (PathGoal or None, FittedNumbers)
    count : int
        The largest number of designs of the front.
    is_sound : callable
        Whether a proved design keeps every wish.
    tell : callable
        Told before each proof which fraction of the proofs is done.

    Raises
    ------
    KeyboardInterrupt
        If no design was proved before it.
    """
    lanes = [
        (path, found, k)
        for path, found in fits
        for k in range(len(found.x))
        if np.isfinite(found.total[k])
    ]
    values = np.array([found.objectives[k] for _, found, k in lanes])
    values = values.reshape(len(lanes), len(fits[0][1].names))
    broken = np.array([found.broken[k] for _, found, k in lanes])
    kept = broken <= BROKEN
    if len(lanes) and not kept.any():
        # the design that comes nearest to the bounds is shown, and refused
        kept[broken.argmin()] = True
    values = np.where(kept[:, None], values, np.inf)
    proved: dict[int, ImprovedDesign] = {}
    refused: dict[int, ImprovedDesign] = {}
    told, stopped = 0.0, False
    while True:
        front = undominated(values)
        chosen = [int(k) for k in front[spread(values[front], count)]]
        new = [k for k in chosen if k not in proved]
        if not new:
            break
        spans = objective_spans(values[front])
        every = len(proved) + len(new)
        try:
            for k in new:
                told = max(told, len(proved) / every)
                tell(told)
                path, found, lane = lanes[k]
                design = fitted_design(model, numbers, path, found, lane)
                design = _measured(design, numbers, box, path, goals, found.t[lane])
                if is_sound(design):
                    # equal designs would take its place by rounding
                    values[alike(values, k, spans)] = np.inf
                    values[k] = list(design.goals.values())
                else:
                    values[k] = np.inf
                    refused[k] = design
                proved[k] = design
        except KeyboardInterrupt:
            stopped = True
            values[[k not in proved for k in range(len(lanes))]] = np.inf
    if stopped and not proved:
        raise KeyboardInterrupt
    designs = (*(proved[k] for k in chosen), *refused.values())
    return tuple(map(interrupted_design, designs)) if stopped else designs


def _measured(
    design: ImprovedDesign,
    numbers: Sequence[VariedNumber],
    box: Box,
    path: PathGoal | None,
    goals: Sequence[Goal],
    t: Array,
) -> ImprovedDesign:
    """The design with its goals on its own proved motion."""
    if design.motion is None or not design.motion.found.any():
        return design
    at = None if path is None else replace(path, inputs=t, timed=True)
    own = FitProblem(
        Fitting(
            model=model_of(design.description),
            motion=design.motion,
            numbers=numbers,
            box=box,
            path=at,
            goals=goals,
        ),
        1,
    )
    x = np.array(list(design.numbers.values()))[None]
    misses = own.measured(starts_of(x, np.zeros((1, 0))), np.zeros(1, dtype=int))
    values = own.objectives.values(misses)[0]
    design = replace(design, goals=dict(zip(design.goals, map(float, values), strict=True)))
    if np.isfinite(values).all():
        return design
    told = f"{design.message}; a goal has no value on the branch of its table"
    return replace(design, sound=False, message=told)
