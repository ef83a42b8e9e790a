"""The kinds of mechanisms that a task can ask for."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from linkwork.core.foundation.arrays import EQUAL_ROWS
from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.foundation.units import AngleUnit, arc_in_order
from linkwork.core.foundation.values import as_told
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.synthesis.improvement.settings import Improvement, Problems
from linkwork.synthesis.loops.limits import GUIDED
from linkwork.synthesis.tasks.conditions import (
    LENGTHS,
    Curve,
    Given,
    PrecisionPosition,
    Ranking,
    Wanted,
    length_contradictions,
    place_contradictions,
    repeated_inputs,
    repeated_points,
)
from linkwork.synthesis.tasks.function_goal import ExactPairs, FunctionGoal
from linkwork.synthesis.tasks.task_keys import KINDS

MECHANISMS = ("four-bar", "slider-crank", "inverted-slider-crank")
WATT_II = "watt-ii"  # two four-bars with a bell crank in common, for functions
#: Five pairs and fewer are met by four-bars.
WATT_PAIRS = ExactPairs(mechanism=WATT_II, least=6, fixed=9, free=9, fits=False)
#: The kinds of mechanisms that are made for each kind of task.
_MADE = {
    "motion": (*MECHANISMS, *GUIDED),
    "path": MECHANISMS[:2],
    "mixed": MECHANISMS[:2],
    "function": (*MECHANISMS[:2], WATT_II),
}
_WATT_PIVOTS = 3  # A0, B0, C0


def mechanism_problems(kind: str, mechanisms: Sequence[str]) -> Problems:
    """Kinds of mechanisms that are not known, or not made for this kind of task."""
    if kind not in _MADE or mechanisms == MECHANISMS:
        return
    for k, name in enumerate(mechanisms):
        if name not in _MADE[kind]:
            made = " or ".join(f'"{one}"' for one in _MADE[kind])
            yield ("mechanism", k), f'must be {made} for task = "{kind}", got {as_told(name)}'
    if kind == "function" and len({*mechanisms}) > 1:
        yield (
            ("mechanism",),
            "of a function is one kind: four-bars give angles, slider-cranks displacements, and "
            "watt-ii meets more pairs; write a task for each",
        )


# ----------------------------------------------------------------------
# A checked task, in file units.


_MOST_FREE = 4  # poses that leave pivots to choose
_MOST_TIMED = 3  # poses at which the crank's angle may be given
_MOST_CONDITIONS = 8  # that a four-bar's coupler point meets exactly
_MOST_EXACT = 5  # poses: more leave no four-bar in general
_ROUNDED_TURN = 1e-5  # relative: 6.2832 rad is a turn
_FITTED = 3  # of the lengths that may be given: dimensions of mechanisms that are fitted


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a mechanism should do.

    Parameters
    ----------
    kind : str
        motion, path, mixed, function or improve.
    name : str
    length : str
        Unit of lengths.
    angle : AngleUnit
    mechanisms : tuple of str
        The kinds of mechanisms: four-bar, slider-crank, of poses inverted-slider-crank too;
        of poses, and only if named, those without a crank;
        of functions watt-ii alone.
    positions : tuple of PrecisionPosition
        In order of travel.
    given : Given
    function : FunctionGoal, optional
    wanted : Wanted
    rank : Ranking
    curve : Curve, optional
        Points of a curve; they become the positions.
    improvement : Improvement, optional
        How dimensions are improved; of a path task, that points are met approximately.
    folder : Path, optional
        Where files are that the task names.
    mechanism_text : str, optional
        Of the file of the mechanism that is improved; none of the library's, and of files that are
        not there.
    text : str
        The text of the file that the task was read from.

    Raises
    ------
    MechanismError
        Lists all problems.
    """

    kind: str
    name: str = "task"
    length: str = "mm"
    angle: AngleUnit = AngleUnit.DEGREE
    mechanisms: tuple[str, ...] = MECHANISMS
    positions: tuple[PrecisionPosition, ...] = ()
    given: Given = field(default_factory=Given)
    function: FunctionGoal | None = None
    wanted: Wanted = field(default_factory=Wanted)
    rank: Ranking = field(default_factory=Ranking)
    curve: Curve | None = None
    improvement: Improvement | None = None
    folder: Path | None = None
    mechanism_text: str | None = None
    text: str = ""

    def __post_init__(self) -> None:
        if self.curve is not None:
            if self.positions:
                message = "and positions exclude each other: give points in one way"
                self.refuse([(("curve",), message)])
            object.__setattr__(self, "positions", tuple(_curve_positions(self.curve)))
        self.refuse(self._problems())

    @property
    def has_goals_alone(self) -> bool:
        """Whether a mechanism is improved for goals, without points."""
        return self.improvement is not None and bool(self.improvement.goals) and not self.positions

    def refuse(self, problems: Iterable[tuple[tuple[str | int, ...], str]]) -> None:
        """Raise an error that lists the problems, if any: keys with their messages."""
        listed = [Problem(key=key, message=message) for key, message in problems]
        if listed:
            raise MechanismError(listed, f'task "{self.name}"')

    def _problems(self) -> Problems:
        if self.kind not in KINDS:
            yield ("task",), f"must be one of {', '.join(KINDS)}, got {as_told(self.kind)}"
        yield from mechanism_problems(self.kind, self.mechanisms)
        exact = self.kind in ("path", "mixed") and not self.is_approximate
        if exact and "four-bar" not in self.mechanisms:
            text = 'points are solved for the "four-bar" only'
            if self.kind == "path":
                text += ": with [improve] starts = 1000 other kinds are fitted to them"
            yield ("mechanism",), text
        if self.kind == "function":
            if self.function is None:
                yield ("function",), "is missing: give the function of the output"
            else:
                yield from self.function.problems()
        elif self.kind != "improve" or self.positions:
            yield from self._position_problems()
        if self.kind == "mixed":
            yield from self._mixed_problems()
        if self.improvement is not None:
            for key, message in self.improvement.problems():
                yield ("improve", *key), message
            if self.improvement.front and self.kind != "improve":
                yield ("improve", "front"), 'belongs to task = "improve": leave it out'
            if self.improvement.front and self.rank != Ranking():
                text = "has no effect on a front, which is delivered as a whole: leave it out"
                yield ("rank",), text
        yield from self._given_problems()
        yield from self._wish_problems()
        yield from self.rank.problems()

    def _position_problems(self) -> Problems:
        count = len(self.positions)
        if count < 2:
            text = "is only one" if count else "is missing"
            yield ("positions",), f"{text}: a task needs two or more"
        for k, position in enumerate(self.positions):
            if self.kind == "motion" and position.angle is None:
                yield ("positions", k, "angle"), "is missing: a motion task is a list of poses"
            if self.kind in ("path", "improve") and position.angle is not None:
                text = 'belongs to poses: leave it out, or write task = "mixed" or "motion"'
                yield ("positions", k, "angle"), text
            for name in ("tolerance", "angle_tolerance"):
                if getattr(position, name) < 0:
                    yield ("positions", k, name), "must not be negative"
        turn = self.angle.turn
        # a curve may come back to a point
        once = not self.is_approximate
        repeated = [*repeated_points(self.positions, self.curve, turn, once=once)]
        # inputs of sliders have no turns
        turn = math.inf if self.kind == "improve" else turn
        yield from repeated or repeated_inputs(self.positions, self.curve, turn)
        bare = [k for k, position in enumerate(self.positions) if not position.tolerance]
        if self.is_approximate and 0 < len(bare) < count:
            text = "is missing: points that are met by least squares all have tolerances, or none"
            yield ("positions", bare[0], "tolerance"), text
        exact = all(p.tolerance == p.angle_tolerance == 0 for p in self.positions)
        if self.kind == "motion" and count > _MOST_EXACT and exact:
            text = f"{count} exact poses leave no four-bar in general: keep {_MOST_EXACT}"
            yield ("positions",), f"{text}, or give tolerances"
        timed = sum(p.input is not None for p in self.positions)
        if 0 < timed < count:
            missing = next(k for k, p in enumerate(self.positions) if p.input is None)
            yield ("positions", missing, "input"), "is missing: time all positions or none"

    def _mixed_problems(self) -> Problems:
        """Poses alone, and more conditions than a four-bar meets."""
        poses, count = sum(p.angle is not None for p in self.positions), len(self.positions)
        if poses == count:
            yield ("task",), 'has poses only: write task = "motion", or leave out an angle'
        conditions = count - 1 + max(poses - 1, 0) + 2 * len(self.given.fixed_pivots)
        if conditions > _MOST_CONDITIONS:
            most = f"but a four-bar meets at most {_MOST_CONDITIONS}"
            each = "a pose after the first one and a pivot are two, a point is one"
            yield ("positions",), f"and fixed pivots are {conditions} conditions, {most}: {each}"

    def _given_problems(self) -> Problems:
        """Pivots and timing that the kind of task cannot use."""
        fixed, moving = self.given.fixed_pivots, self.given.moving_pivots
        count, timed = len(self.positions), any(p.input is not None for p in self.positions)
        if self.kind == "motion" and count > _MOST_FREE and (fixed or moving):
            yield ("given",), f"leaves no freedom for {count} poses, which determine all pivots"
        if moving and (self.kind != "motion" or timed):
            yield ("given", "moving_pivots"), "belongs to poses without timing: leave it out"
        if self.kind == "motion" and timed and count > _MOST_TIMED:
            text = f"{count} poses leave no freedom to time the crank: time at most {_MOST_TIMED}"
            yield ("positions", 0, "input"), text
        if self.kind in ("path", "mixed", "improve"):
            for k, position in enumerate(self.positions):
                refused = {"input": not self.is_approximate}
                refused["angle_tolerance"] = position.angle is None
                for name, without_effect in refused.items():
                    if without_effect and getattr(position, name):
                        yield ("positions", k, name), "has no effect on points: leave it out"
        yield from self._length_problems()
        if self.is_six_bar:
            if fixed and (len(fixed) != _WATT_PIVOTS or fixed[1] in (fixed[0], fixed[2])):
                text = "must be three pivots, A0, B0 and C0, of which neighbours differ"
                yield ("given", "fixed_pivots"), text
            elif fixed and self.function is not None and self.function.starts_fixed:
                text = "leave the start angles no choice: leave out the pivots, or input and output"
                yield ("given", "fixed_pivots"), text
        elif len(fixed) + len(moving) > 2:
            yield ("given",), "fixes more than two pivots: two determine the four-bar"
        elif self.kind == "function" and fixed:
            level = len(fixed) == 2 and fixed[0][1] == fixed[1][1] and fixed[0][0] < fixed[1][0]
            if not level:
                text = "must be two pivots on a level line, A0 to the left of B0"
                yield ("given", "fixed_pivots"), f"{text}: angles are measured from it"

    def _length_problems(self) -> Problems:
        """Given lengths that are none, or that the kind of task cannot use."""
        lengths, wanted = self.given.lengths, self.wanted
        if lengths and self.kind not in ("path", "mixed"):
            yield ("given", "lengths"), "belongs to points: leave it out"
            return
        known = LENGTHS[:_FITTED] if self.is_approximate else LENGTHS
        for name, length in lengths.items():
            key = ("given", "lengths", name)
            if name not in known:
                fitted = " of a fit" if self.is_approximate else ""
                yield key, f"is no length{fitted}: these are " + ", ".join(f'"{n}"' for n in known)
            elif length <= 0.0:
                yield key, f"must be positive, got {length:g}"
            elif not length <= wanted.longest or (
                "P" not in name and not length >= wanted.shortest
            ):
                yield key, f"{length:g} is out of the bounds of [wanted] lengths"
        if not self.is_approximate and self.given.coupler_trouble:
            yield ("given", "lengths"), self.given.coupler_trouble
        if "A0 B0" in lengths and len(self.given.fixed_pivots) == 2:
            yield ("given", "lengths", "A0 B0"), "is fixed by the given pivots: leave it out"

    def _wish_problems(self) -> Problems:
        wanted = self.wanted
        right = self.angle.turn / 4
        if not 0 <= wanted.transmission < right:
            message = f"must be at least 0 and below {right:g}, got {wanted.transmission:g}"
            yield ("wanted", TRANSMISSION_ANGLE.word, "least"), message
        if wanted.range is not None and wanted.range[0] == wanted.range[1]:
            yield ("wanted", "input"), f"begins and ends at {wanted.range[0]:g}: give a range"
        # ranges of sliders are lengths, and mechanisms of files may make several turns
        cranks = (
            self.mechanisms == ("four-bar",) if self.kind == "motion" else self.kind != "improve"
        )
        span_wanted = abs(wanted.range[1] - wanted.range[0]) if wanted.range and cranks else 0.0
        if span_wanted > self.angle.turn * (1.0 + _ROUNDED_TURN):
            message = f"spans {span_wanted:g}, more than a turn of {self.angle.turn:g}"
            yield ("wanted", "input"), f'{message}: write input = "turns fully"'
        timed = [p.input for p in self.positions if p.input is not None]
        goal, ends = self.function, wanted.range
        if goal is not None and not [*goal.problems()]:
            yield from goal.turn_problems(self.angle.turn, self.mechanisms[0] != "slider-crank")
            if ends and goal.starts_fixed:
                yield from goal.range_problems(ends, self.angle.turn)
            elif not goal.starts_fixed:
                timed = goal.dense_points()[0].tolist()
            if self.is_six_bar and wanted.ordered:
                yield from goal.order_problems()
        count = len(self.positions) or len(timed)
        if wanted.range is not None and len(timed) == count > 0:
            _, span = arc_in_order(np.array(timed, dtype=float), self.angle.turn)
            span_wanted = abs(wanted.range[1] - wanted.range[0])
            if span > span_wanted * (1.0 + EQUAL_ROWS):
                message = f"spans {span_wanted:g}, but the given inputs span {span:g}: widen it"
                yield ("wanted", "input"), message
        yield from length_contradictions(wanted, self._given_ground())
        held = not self.is_approximate or any(p.tolerance for p in self.positions)
        yield from place_contradictions(wanted, self.given, self.positions if held else ())

    def _given_ground(self) -> float | None:
        """The length of the ground, if all kinds of mechanisms of the task have the same."""
        several = self.is_approximate or self.kind == "function"
        if several and "slider-crank" in {*self.mechanisms} - self.left_out.keys():
            return None
        if len(self.given.fixed_pivots) == 2:
            return self.given.ground
        if self.kind == "function" and self.mechanisms[0] == "four-bar":
            return 1.0
        return self.given.lengths.get("A0 B0")

    @property
    def left_out(self) -> dict[str, str]:
        """Kinds of mechanisms that a fit of points leaves out, and why."""
        if self.kind == "path" and len(self.given.fixed_pivots) > 1:
            return {"slider-crank": "two fixed pivots are given, and it has one"}
        if self.kind == "path" and "B0 B" in self.given.lengths:
            return {"slider-crank": 'the length "B0 B" is given, and it has none'}
        return {}

    @property
    def is_six_bar(self) -> bool:
        """Whether the task is for Watt-II six-bars."""
        return self.kind == "function" and self.mechanisms == (WATT_II,)

    @cached_property
    def is_approximate(self) -> bool:
        """Whether points are met as well as possible, instead of exactly."""
        if self.kind != "path":
            return self.kind == "improve"
        conditions = len(self.positions) - 1 + 2 * len(self.given.fixed_pivots)
        conditions += len(self.given.lengths)
        return (
            self.curve is not None
            or self.improvement is not None
            or conditions > _MOST_CONDITIONS
            or any(position.input is not None for position in self.positions)
        )

    @property
    def purpose(self) -> str:
        """What its designs are for, in one sentence."""
        count = len(self.positions)
        if self.function is not None:
            follows = f"y = {self.function.of}" if self.function.of else "given pairs"
            return f"Its output follows {follows}; made for the task {self.name}."
        return f"Passes {count} positions; made for the task {self.name}."

    def in_radians(self, angle: float) -> float:
        """An angle of the file in radians."""
        return angle * self.angle.radians


def _curve_positions(curve: Curve) -> Iterator[PrecisionPosition]:
    inputs: Sequence[float | None] = curve.inputs or [None] * len(curve.points)
    for point, angle in zip(curve.points, inputs, strict=True):
        yield PrecisionPosition(point=point, input=angle)
