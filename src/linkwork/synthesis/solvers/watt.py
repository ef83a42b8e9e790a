"""Watt-II six-bars of a task: placed as the task measures angles, and judged loop by loop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, ComplexArray, IndexArray
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.synthesis.defects.verdicts import Defect, DefectKind
from linkwork.synthesis.improvement.proved_design import ImprovedDesign, proved_design
from linkwork.synthesis.loops.driven_loop import NOWHERE, Travel, travel_of
from linkwork.synthesis.loops.limits import Candidates, Drive, LoopKind, driven_loops
from linkwork.synthesis.six_bars import PAIRS, WattSixBars, watt_six_bars
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.solvers.swept_design import SweptDesign
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import WATT_II, Task

_WATT_GROUP_ROUNDING = 16.0 * UNIT_ROUNDOFF  # of a sum of few products, relative to its largest


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
        travels = [*zip(("A0 A B B0", "B0 C D C0"), self.travels, strict=True)]
        for kind in (DefectKind.CIRCUIT, DefectKind.BRANCH):
            word = kind.name.lower()
            for name, travel in travels:
                after = int(getattr(travel, word)[k]) + 1
                if travel.decided[k] and after != NOWHERE + 1:
                    message = f"{word} of the loop {name} changes between positions {after} and"
                    message = f"{message} {after + 1}"
                    return Defect(kind=kind, between=(after, after + 1), message=message)
        for name, travel in travels:
            if not travel.decided[k]:
                message = f"not proved: to rounding, the loop {name} is at a dead point or change"
                return Defect(kind=DefectKind.NOT_PROVED, message=f"{message} point")
        return None


def watt_group(task: Task, bars: WattSixBars, kept: IndexArray, zero: Array | None) -> WattGroup:
    """The six-bars of a task.

    Parameters
    ----------
    task : Task
    bars : WattSixBars
    kept : (N,)
        The task's positions among the nine.
    zero : (2,), optional
        Angles of crank and rocker at the first position [rad]; without them the fixed pivots are
        given, or level.
    """
    a, b, c, e = bars.arms.T
    count = len(bars)
    crank, rocker = np.exp(1j * bars.inputs), np.exp(1j * bars.outputs)
    origin, first, second = (np.zeros(count, dtype=complex), *_grounds(task, bars, zero))
    turns = bars.turns

    def placed(place: ComplexArray, ground: ComplexArray, arm: ComplexArray) -> ComplexArray:
        moved: ComplexArray = (place[:, None] + ground[:, None] * arm)[:, kept]
        return moved

    pivots = task.given.fixed_pivots
    if pivots:
        origin = origin + complex(*pivots[0])
    centre, last = origin + first, origin + first + second
    size = np.maximum(np.abs(first), np.abs(second))
    far = np.abs(np.stack([origin, centre, last])).max(axis=0)
    error = bars.error * size + _WATT_GROUP_ROUNDING * (far + size * np.abs(bars.arms).max(axis=1))
    one, other = (
        Candidates(
            kind=LoopKind.FOUR_BAR,
            fixed_a=fixed_a,
            fixed_b=fixed_b,
            moving_a=placed(fixed_a, ground, arm_a),
            moving_b=placed(fixed_b, ground, arm_b),
            error=error,
        )
        for fixed_a, fixed_b, ground, arm_a, arm_b in (
            (origin, centre, first, a[:, None] * crank, b[:, None] * turns),
            (centre, last, second, c[:, None] * turns, e[:, None] * rocker),
        )
    )
    return WattGroup(task=task, first=one, second=other, inputs=bars.inputs[kept])


def _grounds(
    task: Task, six_bars: WattSixBars, zero: Array | None
) -> tuple[ComplexArray, ComplexArray]:
    """B0 - A0 and C0 - B0 (D,): as the pivots are given, or turned to the start angles.

    The first ground is 1 long; the second four-bar is as large as the first one.
    """
    pivots = [complex(*pivot) for pivot in task.given.fixed_pivots]
    ones = np.ones(len(six_bars), dtype=complex)
    if pivots:
        return ones * (pivots[1] - pivots[0]), ones * (pivots[2] - pivots[1])
    a, b, c, e = six_bars.arms.T
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


# ----------------------------------------------------------------------
# A Watt-II six-bar as the description of an ordinary mechanism, in file units.


ERROR = "structural_error"
_LINKS = {
    GROUND: ("A0", "B0", "C0"),
    "crank": ("A0", "A"),
    "coupler": ("A", "B"),
    "bell_crank": ("B0", "B", "C"),
    "rod": ("C", "D"),
    "rocker": ("C0", "D"),
}
_BARS = tuple(
    pair for name, own in _LINKS.items() if name != GROUND for pair in combinations(own, 2)
)
_STEP = math.pi / 180.0  # of the table [rad]
_WATT_LINKAGE_ROUNDING = 1e-12  # of a few angles [rad]
#: Of angles of positions [rad].
ROUNDED_ANGLE = 1e-9


def first_angle(group: WattGroup, k: int, wishes: Wishes) -> float:
    """The angle of the crank at the first position, in the turn in which the wanted range, or else
    the task, has it [rad].
    """
    points, goal, driven = group.points(k), group.task.function, wishes.range
    crank = points["A"] - points["A0"]
    angle = math.atan2(crank.imag, crank.real)
    if driven is not None and not driven.turn:
        least = min(driven.start, driven.stop) - ROUNDED_ANGLE
        return angle + FULL_TURN * math.ceil((least - angle) / FULL_TURN)
    if goal is None or goal.input is None:
        # without start angles in the first turn
        return angle if angle > -_WATT_LINKAGE_ROUNDING else angle + FULL_TURN
    first_input = group.task.in_radians(goal.precision_points()[0][0])
    return angle + FULL_TURN * round((first_input - angle) / FULL_TURN)


def driven_range(group: WattGroup, k: int, wishes: Wishes) -> tuple[float, float]:
    """The driven range: as wanted, else the range of the function, or its pairs [rad]."""
    task, requested, start = group.task, wishes.range, first_angle(group, k, wishes)
    goal, inputs = task.function, group.inputs
    if requested is not None:
        turn = math.copysign(FULL_TURN, inputs[-1] - inputs[0])
        return (start, start + turn) if requested.turn else (requested.start, requested.stop)
    if goal is not None and goal.of and goal.input is not None:
        return task.in_radians(goal.input[0]), task.in_radians(goal.input[1])
    low, high = float(inputs.min()), float(inputs.max())
    if inputs[-1] < inputs[0]:
        low, high = high, low
    return start + low, start + high


def watt_linkage(group: WattGroup, k: int, wishes: Wishes, name: str) -> Linkage:
    """The description of a design."""
    task, points = group.task, group.points(k)
    goal = task.function
    formula = "" if goal is None else goal.formula("crank", "rocker", task.angle)
    ends = driven_range(group, k, wishes)
    start, stop = (task.angle.from_radians(end) for end in ends)
    count = max(1, math.ceil(abs(ends[1] - ends[0]) / _STEP - _WATT_LINKAGE_ROUNDING))
    return Linkage(
        name=name,
        purpose=task.purpose,
        length=task.length,
        angle=task.angle,
        points={point: (place.real, place.imag) for point, place in points.items()},
        links=_LINKS,
        lengths={f"{p} {q}": abs(points[q] - points[p]) for p, q in _BARS},
        inputs=(Input(link="crank", from_=start, to=stop, step=(stop - start) / count),),
        outputs={ERROR: formula} if formula else {},
    )


# ----------------------------------------------------------------------
# A Watt-II six-bar of a task, with the verdict on it.


def watt_design(group: WattGroup, k: int, wishes: Wishes) -> SweptDesign:
    """The k-th six-bar; only one that changes neither circuit nor branch is swept."""
    task, changed = group.task, group.defect(k)
    inputs = (group.inputs + first_angle(group, k, wishes)).tolist()
    linkage = watt_linkage(group, k, wishes, task.name)
    if changed is None:
        improved = proved_design(linkage)
    else:
        improved = ImprovedDesign.unproved(linkage, changed.message)
    return SweptDesign(
        task=task,
        mechanism=WATT_II,
        driven=Drive.A0.value,
        error_unit=task.angle.value,
        improved=replace(
            improved,
            largest=np.nan if changed else _largest_error(task, improved),
            inputs=tuple(map(task.angle.from_radians, inputs)),
        ),
        wishes=wishes,
        place=group.points(k),
        changed=changed,
    )


def _largest_error(task: Task, improved: ImprovedDesign) -> float:
    """The largest structural error in the rows of the function's range, 0 for pairs [file's angle
    unit].
    """
    goal, motion = task.function, improved.motion
    if motion is None or goal is None or ERROR not in improved.description.outputs:
        return 0.0
    solved = motion.found
    wrong = goal.errors(motion["crank"][solved], motion["rocker"][solved], task.angle.turn)
    return float(np.abs(wrong).max(initial=0.0))


# ----------------------------------------------------------------------
# Functions by Watt-II six-bars: all of them through nine pairs, or through fewer with samples.


_EQUAL_ANGLES = 1e-9  # rad: angles that differ by whole turns


def solve_watt(
    task: Task, wishes: Wishes, progress: Callable[[float], None] | None
) -> tuple[tuple[SweptDesign, ...], SolvedTask]:
    """Designs that are not ranked yet, and the solutions.

    Raises
    ------
    MechanismError
        If two pairs are the same but for whole turns.
    """
    group, solved = solved_group(task, progress)
    return tuple(watt_design(group, k, wishes) for k in range(len(group))), solved


def solved_group(
    task: Task, progress: Callable[[float], None] | None
) -> tuple[WattGroup, SolvedTask]:
    """The six-bars of a task, and the solutions; raises like :func:`solve_watt`."""
    goal = task.function
    assert goal is not None, "a task of functions has one"
    inputs, outputs = (values * task.angle.radians for values in goal.precision_points())
    _refuse_equal(task, inputs, outputs)
    every, taken = _nine_pairs(np.stack([inputs, outputs]))
    six_bars = watt_six_bars(*every, progress=progress)
    zero = np.array([inputs[0], outputs[0]]) if goal.starts_fixed else None
    grade, message = _completeness(six_bars, len(inputs))
    return watt_group(task, six_bars, taken, zero), SolvedTask(
        complex=len(six_bars.roots.x),
        real=len(six_bars),
        proved=int(six_bars.proved.sum()),
        completeness=grade,
        message=message,
    )


def _completeness(solved: WattSixBars, pairs: int) -> tuple[Completeness, str]:
    roots, grade = solved.roots, solved.completeness
    counts = f"{len(roots.x)} of {roots.paths} solutions found"
    if pairs < PAIRS:
        more = PAIRS - pairs
        message = f"a sample: {pairs} pairs leave a family; {more} more were taken between them"
        return Completeness.SAMPLED, f"{message} ({counts})"
    if grade.complete:
        return grade, f"{grade.value} ({counts})"
    why = "other paths met or were lost"
    if len(roots.x) == roots.paths:
        why = f"{np.count_nonzero(~solved.proved)} of the real ones without a proof"
    return grade, f"not proved: {counts}, {why}"


def _refuse_equal(task: Task, inputs: Array, outputs: Array) -> None:
    """Two pairs in which both links point the same way are one condition."""
    for k in range(len(inputs)):
        for j in range(k):
            apart = np.array([inputs[k] - inputs[j], outputs[k] - outputs[j]])
            if np.abs(apart - FULL_TURN * np.round(apart / FULL_TURN)).max() < _EQUAL_ANGLES:
                message = f"is pair {j + 1} after whole turns: leave one out"
                task.refuse([(("function", "pairs", k), message)])


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
    between = np.zeros(len(places))
    for i in range(4):
        weight = np.ones(len(places))
        for j in range(4):
            if i != j:
                weight *= (places - first - j) / (i - j)
        between += weight * values[first + i]
    return between
