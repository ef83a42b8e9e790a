"""Watt-II six-bars of a task: placed as the task measures angles, and judged loop by loop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.design.defects.defect_messages import Defect
from linkwork.design.defects.verdicts import DefectKind
from linkwork.design.loops.candidates import Candidates, Drive, LoopKind
from linkwork.design.loops.driven_loop import driven_loops
from linkwork.design.loops.travel import NOWHERE, Travel, travel_of
from linkwork.design.six_bars.watt_six_bars import WattSixBars
from linkwork.design.tasks.task import Task
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = ["WattGroup", "watt_group"]

_ROUNDING = 16.0 * UNIT_ROUNDOFF  # of a sum of few products, relative to its largest


@dataclass(frozen=True, kw_only=True, eq=False)
class WattGroup:
    """D six-bars at the N positions of a task.

    Parameters
    ----------
    task : Task
    first, second : Candidates
        The four-bars A0 A B B0, with the crank, and B0 C D C0, whose driven link is the bell crank.
    inputs : (N,)
        Angles of the crank from its first one, unwrapped [rad].
    """

    task: Task
    first: Candidates
    second: Candidates
    inputs: Array

    def __len__(self) -> int:
        return len(self.first)

    @cached_property
    def travels(self) -> tuple[Travel, Travel]:
        """The way of both loops through the positions."""
        # the order is that of the inputs of the task
        one, other = (
            travel_of(driven_loops(loop, Drive.A0), None, ordered=False)
            for loop in (self.first, self.second)
        )
        return one, other

    def points(self, k: int) -> dict[str, complex]:
        """The points of a design at the first position [length]."""
        one, other = self.first, self.second
        places = {
            "A0": one.fixed_a[k], "B0": one.fixed_b[k], "C0": other.fixed_b[k],
            "A": one.moving_a[k, 0], "B": one.moving_b[k, 0],
            "C": other.moving_a[k, 0], "D": other.moving_b[k, 0],
        }  # fmt: skip
        return {name: complex(place) for name, place in places.items()}

    def defect(self, k: int) -> Defect | None:
        """The circuit or branch defect of a design, or why it is not decided."""
        travels = dict(zip(("A0 A B B0", "B0 C D C0"), self.travels, strict=True))
        return next(self._defects(travels, k), None)

    def _defects(self, travels: dict[str, Travel], k: int) -> Iterator[Defect]:
        decided = {name: travel for name, travel in travels.items() if travel.decided[k]}
        for kind, word in ((DefectKind.CIRCUIT, "circuit"), (DefectKind.BRANCH, "branch")):
            for name, travel in decided.items():
                after = int(getattr(travel, word)[k]) + 1
                if after != NOWHERE + 1:
                    told = f"{word} of the loop {name} changes between positions {after} and"
                    yield Defect(
                        kind=kind, between=(after, after + 1), message=f"{told} {after + 1}"
                    )
        for name in travels.keys() - decided.keys():
            told = f"not proved: to rounding, the loop {name} is at a dead point or change point"
            yield Defect(kind=DefectKind.NOT_PROVED, between=None, message=told)


def watt_group(task: Task, found: WattSixBars, wanted: IndexArray, zero: Array | None) -> WattGroup:
    """The six-bars of a task.

    Parameters
    ----------
    task : Task
    found : WattSixBars
    wanted : (N,)
        The task's positions among the nine.
    zero : (2,), optional
        Angles of crank and rocker at the first position [rad]; without them the fixed pivots are
        given, or level.
    """
    a, b, c, e = found.arms.T
    count = len(found)
    crank, rocker = np.exp(1j * found.inputs), np.exp(1j * found.outputs)
    origin, first, second = (np.zeros(count, dtype=complex), *_grounds(task, found, zero))
    turns = found.turns

    def placed(place: ComplexArray, ground: ComplexArray, arm: ComplexArray) -> ComplexArray:
        moved: ComplexArray = (place[:, None] + ground[:, None] * arm)[:, wanted]
        return moved

    pivots = task.given.fixed_pivots
    if pivots:
        origin = origin + complex(*pivots[0])
    centre, last = origin + first, origin + first + second
    size = np.maximum(np.abs(first), np.abs(second))
    far = np.abs(np.stack([origin, centre, last])).max(axis=0)
    error = found.error * size + _ROUNDING * (far + size * np.abs(found.arms).max(axis=1))
    one = _four_bars(
        (origin, centre),
        (
            placed(origin, first, a[:, None] * crank),
            placed(centre, first, b[:, None] * turns),
        ),
        error,
    )
    other = _four_bars(
        (centre, last),
        (
            placed(centre, second, c[:, None] * turns),
            placed(last, second, e[:, None] * rocker),
        ),
        error,
    )
    return WattGroup(task=task, first=one, second=other, inputs=found.inputs[wanted])


def _grounds(
    task: Task, found: WattSixBars, zero: Array | None
) -> tuple[ComplexArray, ComplexArray]:
    """B0 - A0 and C0 - B0 (D,): as the pivots are given, or turned to the start angles.

    The first ground is 1 long; the second four-bar is as large as the first one.
    """
    pivots = [complex(*pivot) for pivot in task.given.fixed_pivots]
    ones = np.ones(len(found), dtype=complex)
    if pivots:
        return ones * (pivots[1] - pivots[0]), ones * (pivots[2] - pivots[1])
    a, b, c, e = found.arms.T
    first, second = (
        np.abs(np.stack([x, y, 1.0 + y - x, ones])).max(axis=0) for x, y in ((a, b), (c, e))
    )
    ratio = first / second
    if zero is None:
        return ones, ones * ratio
    return (
        np.exp(1j * zero[0]) * np.abs(a) / a,
        ratio * np.exp(1j * zero[1]) * np.abs(e) / e,
    )


def _four_bars(
    fixed: tuple[ComplexArray, ComplexArray],
    moving: tuple[ComplexArray, ComplexArray],
    error: Array,
) -> Candidates:
    count = len(error)
    return Candidates(
        kind=LoopKind.FOUR_BAR,
        fixed_a=fixed[0],
        fixed_b=fixed[1],
        direction=np.zeros(count, dtype=complex),
        moving_a=moving[0],
        moving_b=moving[1],
        guided=moving[0],
        error=error,
        miss=np.zeros(count),
    )
