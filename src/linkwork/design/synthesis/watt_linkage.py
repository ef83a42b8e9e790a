"""A Watt-II six-bar as the description of an ordinary mechanism, in file units."""

from __future__ import annotations

import math
from itertools import combinations

from linkwork.design.improvement.proved_design import proved_design
from linkwork.design.synthesis.improved_mechanism import ImprovedMechanism
from linkwork.design.synthesis.watt_group import WattGroup
from linkwork.design.tasks.wishes import Wishes
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.names import GROUND
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.linkage import Linkage

__all__ = [
    "ERROR",
    "ROUNDED_ANGLE",
    "SIDES",
    "driven_range",
    "first_angle",
    "swept_mechanism",
    "watt_linkage",
]

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
#: The sides of all links, ground included.
SIDES = (*_BARS, *combinations(_LINKS[GROUND], 2))
_STEP = math.pi / 180.0  # of the table [rad]
_ROUNDING = 1e-12  # of a few angles [rad]
#: Of angles of positions [rad].
ROUNDED_ANGLE = 1e-9


def first_angle(group: WattGroup, k: int, wishes: Wishes) -> float:
    """The angle of the crank at the first position, in the turn in which the wanted range, or else
    the task, has it [rad].
    """
    points, goal, wanted = group.points(k), group.task.function, wishes.range
    crank = points["A"] - points["A0"]
    angle = math.atan2(crank.imag, crank.real)
    if wanted is not None and not wanted.turn:
        least = min(wanted.start, wanted.stop) - ROUNDED_ANGLE
        return angle + FULL_TURN * math.ceil((least - angle) / FULL_TURN)
    if goal is None or goal.input is None:
        # without start angles in the first turn
        return angle if angle > -_ROUNDING else angle + FULL_TURN
    given = group.task.in_radians(goal.precision_points()[0][0])
    return angle + FULL_TURN * round((given - angle) / FULL_TURN)


def driven_range(group: WattGroup, k: int, wishes: Wishes) -> tuple[float, float]:
    """The driven range: as wanted, else the range of the function, or its pairs [rad]."""
    task, wanted, start = group.task, wishes.range, first_angle(group, k, wishes)
    goal, inputs = task.function, group.inputs
    if wanted is not None:
        turn = math.copysign(FULL_TURN, inputs[-1] - inputs[0])
        return (start, start + turn) if wanted.turn else (wanted.start, wanted.stop)
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
    count = max(1, math.ceil(abs(ends[1] - ends[0]) / _STEP - _ROUNDING))
    return Linkage(
        name=name,
        purpose=task.purpose,
        length=task.length,
        angle=task.angle,
        points={point: (place.real, place.imag) for point, place in points.items()},
        links=_LINKS,
        lengths={f"{p} {q}": abs(points[q] - points[p]) for p, q in _BARS},
        inputs=(Input(link="crank", start=start, stop=stop, step=(stop - start) / count),),
        outputs={ERROR: formula} if formula else {},
    )


def swept_mechanism(group: WattGroup, k: int, wishes: Wishes) -> ImprovedMechanism:
    """A design moved through its driven range, each row with its proof."""
    task = group.task
    design = proved_design(watt_linkage(group, k, wishes, task.name))
    return ImprovedMechanism(task=task, improved=design, wishes=wishes)
