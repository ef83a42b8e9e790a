"""Functions by Watt-II six-bars: all of them through nine pairs, or through fewer with samples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.design.six_bars.watt_six_bars import PAIRS, WattSixBars, watt_six_bars
from linkwork.design.synthesis.watt_design import WattDesign
from linkwork.design.synthesis.watt_group import watt_group
from linkwork.design.tasks.task import Task
from linkwork.design.tasks.wishes import Wishes
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.completeness import Completeness

__all__ = ["solve_watt"]

_EQUAL_ANGLES = 1e-9  # rad: angles that differ by whole turns


def solve_watt(
    task: Task, wishes: Wishes, progress: Callable[[float], None] | None
) -> tuple[tuple[WattDesign, ...], WattSixBars, tuple[Completeness, str]]:
    """Designs that are not ranked yet, the solutions, and whether they are complete.

    Raises
    ------
    MechanismError
        If two pairs are the same but for whole turns.
    """
    goal = task.function
    assert goal is not None, "a task of functions has one"
    inputs, outputs = (values * task.angle.radians for values in goal.precision_points())
    _refuse_equal(task, inputs, outputs)
    every, wanted = _nine_pairs(np.stack([inputs, outputs]))
    found = watt_six_bars(*every, progress=progress)
    zero = np.array([inputs[0], outputs[0]]) if goal.starts_fixed else None
    group = watt_group(task, found, wanted, zero)
    designs = tuple(WattDesign.of(group, k, wishes) for k in range(len(group)))
    return designs, found, _completeness(found, len(inputs))


def _completeness(solved: WattSixBars, given: int) -> tuple[Completeness, str]:
    roots, grade = solved.roots, solved.completeness
    found = f"{len(roots.x)} of {roots.paths} solutions found"
    if given < PAIRS:
        more = PAIRS - given
        told = f"a sample: {given} pairs leave a family; {more} more were taken between them"
        return Completeness.SAMPLED, f"{told} ({found})"
    if grade.complete:
        return grade, f"{grade.value} ({found})"
    why = "other paths met or were lost"
    if len(roots.x) == roots.paths:
        why = f"{np.count_nonzero(~solved.proved)} of the real ones without a proof"
    return grade, f"not proved: {found}, {why}"


def _refuse_equal(task: Task, inputs: Array, outputs: Array) -> None:
    """Two pairs in which both links point the same way are one condition."""
    for k in range(len(inputs)):
        for j in range(k):
            apart = np.array([inputs[k] - inputs[j], outputs[k] - outputs[j]])
            if np.abs(apart - FULL_TURN * np.round(apart / FULL_TURN)).max() < _EQUAL_ANGLES:
                told = f"is pair {j + 1} after whole turns: leave one out"
                task.refuse([(("function", "pairs", k), told)])


def _nine_pairs(pairs: Array) -> tuple[Array, IndexArray]:
    """Nine pairs (2, 9) with the places of the given ones (2, N) among them.

    Those that are missing lie in the middle of the widest steps of the input, on the cubic through
    four neighbours.
    """
    places = np.arange(pairs.shape[1], dtype=float)
    while len(places) < PAIRS:
        at = np.interp(places, np.arange(pairs.shape[1]), pairs[0])
        k = int(np.abs(np.diff(at)).argmax())
        places = np.insert(places, k + 1, 0.5 * (places[k] + places[k + 1]))
    every = np.stack([_between(row, places) for row in pairs])
    return every, np.flatnonzero(places == np.floor(places))


def _between(values: Array, places: Array) -> Array:
    """Values (N,) at places between their indices: the cubic through the four nearest ones."""
    first = np.clip(np.floor(places).astype(int) - 1, 0, len(values) - 4)
    found = np.zeros(len(places))
    for i in range(4):
        weight = np.ones(len(places))
        for j in range(4):
            if i != j:
                weight *= (places - first - j) / (i - j)
        found += weight * values[first + i]
    return found
