"""Tasks that improve a mechanism: goals, bounds and requirements; designs with verdicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from linkwork.core.foundation.arrays import EQUAL_ROWS
from linkwork.core.foundation.errors import InputError, MechanismError, choices
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import VariedNumber, number_named
from linkwork.core.motion.model import Model, model_of
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.results.quantity import Kind
from linkwork.core.textfile.reader import example_text, examples, read_text
from linkwork.design.derivatives.rows import chosen_numbers
from linkwork.synthesis.improvement.curve_fit import ANGLE_MARGIN
from linkwork.synthesis.improvement.curves import point_named
from linkwork.synthesis.improvement.goals import goal_of
from linkwork.synthesis.improvement.improving import (
    FACTOR,
    box_of,
    improved_designs,
    numbers_to_vary,
    transmission_goals,
)
from linkwork.synthesis.improvement.proved_design import ImprovedDesign, Reach
from linkwork.synthesis.improvement.settings import STARTS, Goal, Improvement, Points, Problems
from linkwork.synthesis.solvers.swept_design import SweptDesign
from linkwork.synthesis.tasks.conditions import Wishes, outside_range
from linkwork.synthesis.tasks.task import Task

_ROWS = 360  # of a turn, unless the mechanism's table has steps
_PARTS = 100  # of a range of lengths


def improve_mechanism(
    task: Task, wishes: Wishes, progress: Callable[[float], None] | None
) -> tuple[tuple[SweptDesign, ...], int, bool]:
    """Designs that are not ranked yet, the number of starts, and whether they were interrupted.

    Raises
    ------
    MechanismError
        For a mechanism that is not there, names that it does not have, or contradicting goals.
    """
    description = mechanism_of(task)
    task.refuse(_ill_timed(model_of(description), task))
    return improve_description(description, task, wishes, progress)


def mechanism_of(task: Task) -> Description:
    """The mechanism that a task improves, with the driven range that it wants.

    Raises
    ------
    MechanismError
        If it is not there, or cannot be driven so.
    """
    return _driven(_mechanism(task), task)


def improve_description(
    description: Description,
    task: Task,
    wishes: Wishes,
    progress: Callable[[float], None] | None,
) -> tuple[tuple[SweptDesign, ...], int, bool]:
    """The same for a mechanism that is at hand.

    Raises
    ------
    MechanismError
        For names that it does not have, or contradicting goals.
    """
    settings = task.improvement or Improvement()
    model = model_of(description)
    task.refuse(_name_problems(model, settings))
    numbers = numbers_to_vary(model, settings.vary)
    settings = replace(settings, bounds=_bounds(description, task, wishes, numbers))
    # rows hold a little more, so that all between them holds
    least = min(wishes.transmission + ANGLE_MARGIN, math.pi / 2.0)
    angles = [*transmission_goals(model, least)] if wishes.transmission else []
    if task.wanted.transmission and not angles:
        lacks = f'"{description.name}" has no dyad of pins and no transmission angle: leave it out'
        task.refuse([(("wanted", TRANSMISSION_ANGLE.word), lacks)])
    goals: list[Goal | Points] = [*settings.goals, *angles]
    if task.positions:
        points = _points(task, settings)
        box = box_of(model, numbers, settings)
        reach = Reach(model.description, numbers, box)
        name = points.point or next(iter(description.trace), "")
        if not name:
            known = choices("points", model.equations.points)
            message = f'is missing: "{description.name}" traces no point; name the one that passes '
            task.refuse([(("improve", "point"), f"{message}the positions {known}")])
        task.refuse(_unreached(reach, name, points))
        goals.append(points)
    task.refuse((("improve", *key), message) for key, message in settings.front_problems(goals))

    def judged(design: ImprovedDesign) -> SweptDesign:
        return SweptDesign.of(task, design, wishes)

    try:
        improved = improved_designs(
            model,
            goals,
            settings,
            progress,
            is_sound=lambda design: not judged(design).kinds,
            enough=task.rank.deliver,
        )
    except MechanismError as error:
        task.refuse((("improve", *problem.key), problem.message) for problem in error.problems)
        raise
    designs = [judged(design) for design in improved]
    interrupted = any(design.message.startswith("interrupted") for design in improved)
    return tuple(designs), settings.starts or STARTS, interrupted


def _mechanism(task: Task) -> Description:
    if len(task.mechanisms) != 1:
        message = 'must be one mechanism, of the library or a file: "four-bar", "leg.toml"'
        task.refuse([(("mechanism",), message)])
    name = task.mechanisms[0]
    if name in examples():
        return read_text(example_text(name), f"{name}.toml").description
    if task.mechanism_text is None:
        known = choices("examples", examples(), name)
        message = f'"{name}" is no file in the folder of the task and no example {known}'
        task.refuse([(("mechanism",), message)])
    assert task.mechanism_text is not None  # refused
    return read_text(task.mechanism_text, str((task.folder or Path()) / name)).description


def _driven(description: Description, task: Task) -> Description:
    """The mechanism with the driven range that the task wants."""
    wanted = task.wanted
    if not (wanted.turns_fully or wanted.range) or not description.inputs:
        return description
    driven, turn, model = description.inputs[0], description.angle.turn, model_of(description)
    kinds = {x.name: x.kind for x in model.equations.inputs}
    is_angle = kinds[driven.column] == Kind.ANGLE.value
    message = ""
    if wanted.turns_fully and not is_angle:
        message = f'"{driven.column}" is a length, which cannot turn: give {{ from = …, to = … }}'
    if driven.law is not None:
        message = "has no effect on a mechanism that is driven by a law of time: leave it out"
    if message:
        task.refuse([(("wanted", "input"), message)])
    begin = 0.0 if driven.from_ is None else description.numbers(driven.from_)
    start, stop = wanted.range or (begin, begin + turn)
    usual = turn / _ROWS if is_angle else abs(stop - start) / _PARTS
    step = abs(description.numbers(driven.step)) if driven.step is not None else usual
    count = max(1, math.ceil(abs(stop - start) / step * (1.0 - EQUAL_ROWS)))
    if len(description.inputs) > 1:  # as many rows as the other inputs have
        count = max(1, len(model.rows) - 1)
    ranged = replace(driven, from_=start, to=stop, step=(stop - start) / count)
    return replace(description, inputs=(ranged, *description.inputs[1:]))


def _name_problems(model: Model, settings: Improvement) -> Problems:
    """Names that the mechanism does not have, or that cannot vary or be goals."""
    there, one = np.ones(1, dtype=bool), np.zeros(1)
    lookups: dict[tuple[str | int, ...], Callable[[], object]] = {}
    for k, name in enumerate(settings.vary):
        lookups["vary", k] = partial(chosen_numbers, model, [name])
    for name in settings.bounds:
        lookups["bounds", name] = partial(number_named, model.description, name)
    for k, goal in enumerate(settings.goals):
        lookups["goals", k, "of"] = partial(goal_of, model, goal, one, there, 1.0)
    if settings.point:
        lookups["point",] = partial(point_named, model, settings.point)
    for key, look_up in lookups.items():
        try:
            look_up()
        except InputError as error:
            message = str(error.args[0] if isinstance(error, KeyError) else error)
            if key[0] == "vary" and not isinstance(error, KeyError):
                free = [number.name for number in numbers_to_vary(model, ())]
                message = f"{message} {choices('numbers that can vary', free)}"
            yield ("improve", *key), message


def _bounds(
    description: Description, task: Task, wishes: Wishes, numbers: Sequence[VariedNumber]
) -> dict[str, tuple[float, float]]:
    """The bounds of the settings, narrowed by [wanted]; contradictions are refused."""
    bounds, problems = dict((task.improvement or Improvement()).bounds), []
    by_number = {number_named(description, name): pair for name, pair in bounds.items()}
    for number, (low, high) in _bounds_of_task(description, wishes, numbers):
        name = next((n for n in bounds if number_named(description, n) == number), number.name)
        least, most = by_number.get(number, (-math.inf, math.inf))
        least, most = max(least, low), min(most, high)
        if least > most:
            message = f"excludes {low:g} to {high:g}, which [wanted] requires: widen one of them"
            problems.append((("improve", "bounds", name), message))
        bounds[name] = least, most
    task.refuse(problems)
    return bounds


def _bounds_of_task(
    description: Description, wishes: Wishes, numbers: Sequence[VariedNumber]
) -> Iterator[tuple[VariedNumber, tuple[float, float]]]:
    """Lengths, and the box around the region of fixed pivots."""
    fixed = description.links.get(GROUND, ()) if isinstance(description, Draft) else ()
    for number in numbers:
        if number.table == "lengths" and (wishes.shortest or math.isfinite(wishes.longest)):
            least = max(wishes.shortest, number.of(description) / FACTOR)
            yield number, (least, min(wishes.longest, number.of(description) * FACTOR))
        if number.table == "points" and number.key in fixed and wishes.region.size:
            along = wishes.region.imag if number.axis else wishes.region.real
            yield number, (float(along.min()), float(along.max()))


def _points(task: Task, settings: Improvement) -> Points:
    timed = task.positions[0].input is not None
    inputs = tuple(p.input for p in task.positions if p.input is not None)
    return Points(
        points=tuple(position.point for position in task.positions),
        point=settings.point,
        inputs=inputs if timed else None,
        order="as given" if task.wanted.ordered or timed else "any",
    )


def _ill_timed(model: Model, task: Task) -> Problems:
    """Inputs of positions and goals outside the driven range."""
    inputs = [position.input for position in task.positions if position.input is not None]
    if not model.equations.inputs:
        return
    turns = model.equations.inputs[0].kind == Kind.ANGLE.value
    turn = model.description.angle.turn if turns else math.inf
    table = model.rows_in_file_units[:, 0]
    for k, _, place in outside_range(inputs, table, turn):
        yield ("positions", k, "input"), f"is {place}: move it, or widen [wanted] input"
    for k, goal in enumerate((task.improvement or Improvement()).goals):
        for j, _, place in outside_range(goal.at, table, turn):
            yield ("improve", "goals", k, "at", j), f"is {place}: move it, or widen [wanted] input"


def _unreached(reach: Reach, name: str, points: Points) -> Problems:
    for k, place in enumerate(points.points):
        pivot, away, most = reach.missing(name, complex(*place))
        if pivot:
            message = (
                f"is {away:g} from {pivot}, out of reach: {name} comes at most {most:g} away from "
                "it; widen the bounds of lengths or move the position"
            )
            yield ("positions", k, "point"), message
