"""A design from outside the search of a task, judged by the requirements of the task."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum
from typing import Protocol

import numpy as np

from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft, Linkage
from linkwork.core.mechanism.varied_numbers import VariedNumber
from linkwork.core.motion.model import model_of
from linkwork.synthesis.atlas import NearPath, PathAtlas, placed_on_curve
from linkwork.synthesis.improvement.curves import point_named
from linkwork.synthesis.improvement.improving import numbers_to_vary
from linkwork.synthesis.improvement.proved_design import ImprovedDesign, proved_design
from linkwork.synthesis.improvement.settings import Improvement
from linkwork.synthesis.loops.limits import Drive
from linkwork.synthesis.solvers.improvement import improve_description, mechanism_of
from linkwork.synthesis.solvers.solving import wishes_of
from linkwork.synthesis.solvers.swept_design import SweptDesign
from linkwork.synthesis.tasks.conditions import EQUAL_LENGTHS, Point, Wishes, distances_to_segments
from linkwork.synthesis.tasks.task import Task


class Origin(Enum):
    """Where a design comes from."""

    GIVEN = "as given"
    ATLAS = "atlas"
    IMPROVED = "improved"


@dataclass(frozen=True, kw_only=True, eq=False)
class SuggestedDesign:
    """A mechanism of any kind with its motion.

    Parameters
    ----------
    origin : Origin
    mechanism : str
        Its kind in words.
    improved : ImprovedDesign
    point : str
        The point that passes the positions; "" if there are none.
    positions : tuple of (float, float)
        The positions at which its inputs and misses are known; for others its path is measured.
    """

    origin: Origin
    mechanism: str
    improved: ImprovedDesign
    point: str
    positions: tuple[Point, ...]

    def judged(self, task: Task, wishes: Wishes) -> SweptDesign:
        """The design with its defects. The order of positions is judged only where the inputs at
        them are known.
        """
        improved, points = self.improved, tuple(position.point for position in task.positions)
        if points != self.positions:
            improved = replace(improved, inputs=(), misses=self._misses(points))
        return SweptDesign.of(task, improved, wishes)

    def _misses(self, points: tuple[Point, ...]) -> tuple[float, ...]:
        """The distances of points from the path; NaN without a path."""
        motion = self.improved.motion
        if motion is None or not self.point:
            return tuple(float("nan") for _ in points)
        path = motion.trace(self.point)
        steps = motion.found[:-1] & motion.found[1:]
        one, other = path[:-1][steps], path[1:][steps]
        return tuple(
            float(distances_to_segments(np.array(complex(*p)), one, other).min(initial=np.inf))
            for p in points
        )


class Suggesting(Protocol):
    """The functions that make such designs; ``progress`` may raise an error to end the work."""

    def wishes(self, task: Task) -> Wishes:
        """The requirements of a task."""

    def starting_design(self, task: Task) -> SuggestedDesign | None:
        """The mechanism that a task improves; ``None`` for other tasks."""

    def nearest(
        self, task: Task, count: int, progress: Callable[[float], None]
    ) -> tuple[SuggestedDesign, ...]:
        """The designs of the atlas whose paths are nearest to the positions."""

    def improved(
        self,
        task: Task,
        description: Description,
        mechanism: str,
        progress: Callable[[float], None],
    ) -> SuggestedDesign:
        """A better design; at an interruption the best so far."""


# ----------------------------------------------------------------------
# Designs near a curve from the atlas, and improved designs.


_FEWEST = 5  # positions of a curve
_READ = 0.2  # of the progress
_STARTS, _SPREAD = 2, 0.02  # near a chosen design
_FACTOR, _REACH = 2.0, 0.5  # by which lengths may change, and pivots [longest length]


def wishes(task: Task) -> Wishes:
    """The requirements of a task, in radians and complex points."""
    return wishes_of(task, Drive.A0)


def starting_design(task: Task) -> SuggestedDesign | None:
    """The mechanism that a task improves as it is; ``None`` for tasks of other kinds.

    Raises
    ------
    MechanismError
        If the mechanism does not exist, or [wanted] input cannot drive it.
    UnknownNameError
        If it does not have the point that follows the positions.
    """
    if task.kind != "improve":
        return None
    description = mechanism_of(task)
    settings = task.improvement or Improvement()
    point = next(iter(description.trace), "")
    if settings.point:
        point = point_named(model_of(description), settings.point)
    return _suggested(Origin.GIVEN, task.mechanisms[0], description, point)


def nearest(
    task: Task, count: int, progress: Callable[[float], None]
) -> tuple[SuggestedDesign, ...]:
    """The designs of the shipped atlas whose paths are nearest to the positions, nearest first.

    The positions are the corners of a closed curve. Place, size, direction, timing and order do
    not count; each design is placed on the curve, swept and proved.

    Raises
    ------
    InputError
        For fewer than five positions, or positions at one place.
    """
    points = _points(task)
    if len(points) > 1 and points[0] == points[-1]:
        points = points[:-1]
    if len(points) < _FEWEST:
        raise InputError(f"a curve needs {_FEWEST} positions or more, got {len(points)}")
    curve: ComplexArray = np.array([complex(*point) for point in points])
    progress(0.0)
    atlas = PathAtlas.shipped()
    progress(_READ)
    designs = []
    for k, near in enumerate(atlas.nearest(curve, count), start=1):
        designs.append(_near(near, task))
        progress(_READ + (1.0 - _READ) * k / count)
    return tuple(designs)


def improved(
    task: Task, description: Description, mechanism: str, progress: Callable[[float], None]
) -> SuggestedDesign:
    """The best design near another one; at an interruption the best so far.

    The goals are those of a task that improves, otherwise the positions of a path.

    Raises
    ------
    InputError
        If the task has no goal, or the search gives no better design.
    """
    improvement_task = _improvement_of(task, description)
    designs, _, _ = improve_description(description, improvement_task, wishes(task), progress)
    settings = improvement_task.improvement or Improvement()
    point = settings.point or next(iter(description.trace), "")
    before = math.inf
    if task.positions:
        start = _suggested(Origin.GIVEN, mechanism, description, point)
        before = start.judged(task, wishes(task)).error
    better = [design for design in designs if design.improved.sound and design.error < before]
    if not better:
        raise InputError("the search near this design gave no better one: choose another design")
    best = min(better, key=lambda design: (bool(design.kinds), design.improved.total))
    return SuggestedDesign(
        origin=Origin.IMPROVED,
        mechanism=mechanism,
        improved=best.improved,
        point=point,
        positions=_points(task),
    )


def _improvement_of(task: Task, description: Description) -> Task:
    """The task of improving a mechanism."""
    if task.kind == "improve":
        return task
    if task.kind != "path":
        raise InputError(
            'designs are improved towards points: this is no path, and no task = "improve"'
        )
    numbers = _free_numbers(task, description)
    settings = Improvement(
        vary=tuple(q.name for q in numbers),
        bounds=dict(_bounds(task, description, numbers)),
        starts=_STARTS,
        spread=_SPREAD,
        point=next(iter(description.trace), ""),
    )
    return replace(
        task,
        kind="improve",
        mechanisms=("chosen",),
        positions=tuple(replace(position, tolerance=0.0) for position in task.positions),
        given=replace(task.given, lengths={}),
        curve=None,
        improvement=settings,
    )


def _free_numbers(task: Task, description: Description) -> tuple[VariedNumber, ...]:
    """All numbers but the coordinates of given pivots and given lengths.

    Raises
    ------
    InputError
        If no number may vary, or the design does not have the given lengths.
    """
    numbers = numbers_to_vary(model_of(description), ())
    fixed = np.array([complex(*pivot) for pivot in task.given.fixed_pivots])
    held: set[str] = set()
    if len(fixed) and isinstance(description, Draft):
        value = description.numbers
        near = EQUAL_LENGTHS * max(abs(complex(*point)) for point in _points(task))
        held = {
            name
            for name, (x, y) in description.points.items()
            if np.abs(fixed - complex(value(x), value(y))).min() <= near
        }
    lengths = {q.key: float(q.of(description)) for q in numbers if q.table == "lengths"}
    for name, length in task.given.lengths.items():
        if abs(lengths.get(name, math.inf) - length) > EQUAL_LENGTHS * length:
            raise InputError(
                f'the length "{name}" is given as {length:g}, which this design does not have: '
                "choose one from the search"
            )
    free = tuple(
        q
        for q in numbers
        if not (q.table == "points" and q.key in held)
        and not (q.table == "lengths" and q.key in task.given.lengths)
    )
    if not free:
        raise InputError("every number of this design is given: nothing can be improved")
    return free


def _bounds(
    task: Task, description: Description, numbers: tuple[VariedNumber, ...]
) -> Iterator[tuple[str, tuple[float, float]]]:
    """Bounds near the design, without which fits of curves run off to infinite links; [wanted]
    replaces them.
    """
    wanted = task.wanted
    bounded = bool(wanted.shortest) or math.isfinite(wanted.longest)
    lengths = {q: float(q.of(description)) for q in numbers if q.table == "lengths"}
    reach = _REACH * max(lengths.values(), default=0.0)
    for q, length in lengths.items() if not bounded else ():
        yield q.name, (length / _FACTOR, length * _FACTOR)
    for q in numbers:
        if q.table == "points" and reach and not wanted.region:
            place = float(q.of(description))
            yield q.name, (place - reach, place + reach)


def _points(task: Task) -> tuple[Point, ...]:
    return tuple(position.point for position in task.positions)


def _near(near: NearPath, task: Task) -> SuggestedDesign:
    placed, _ = placed_on_curve(near, near.family)
    return _suggested(Origin.ATLAS, near.family, _in_units_of(placed, task), near.designs.point)


def _in_units_of(linkage: Linkage, task: Task) -> Linkage:
    """A mechanism whose lengths are those of a task, with its names of units."""
    share = task.angle.from_radians(linkage.angle.radians)
    value = linkage.numbers
    inputs = tuple(
        replace(
            drive,
            from_=share * value(drive.from_ or 0.0),
            to=share * value(drive.to or 0.0),
            step=share * value(drive.step or 0.0),
        )
        for drive in linkage.inputs
    )
    angles = {name: share * value(x) for name, x in linkage.angles.items()}
    return replace(linkage, length=task.length, angle=task.angle, inputs=inputs, angles=angles)


def _suggested(
    origin: Origin, mechanism: str, description: Description, point: str
) -> SuggestedDesign:
    """A mechanism as it is with its proved motion, if it has one."""
    return SuggestedDesign(
        origin=origin,
        mechanism=mechanism,
        improved=proved_design(description),
        point=point,
        positions=(),
    )
