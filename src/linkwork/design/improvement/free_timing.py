"""Points without inputs: where a fit begins along the path of a mechanism."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from linkwork.design.improvement.goals import PathGoal
from linkwork.design.improvement.settings import Points
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import find_spelling
from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.motion.model import Model
from linkwork.numerics.lane_bounds import OwnVariables
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["own_inputs", "paths_of", "point_named"]

_SHARES = (0.1, 0.25, 0.5, 0.75, 1.0)  # of the path's length, for points along a part of it
_SHIFTS = 36  # of the first point along the path
_GAP = 1e-7  # between inputs of positions in order [rad or length]


def own_inputs(path: PathGoal | None, model: Model, table: Array) -> OwnVariables:
    """Where inputs of points with free timing may be: in the table, unless it is a turn."""
    if path is None or path.timed:
        return OwnVariables()
    turns = model.equations.inputs[0].kind == Kind.ANGLE.value
    least, most = float(table.min()), float(table.max())
    if turns and most - least >= FULL_TURN * (1.0 - EQUAL_ROWS):
        least, most = -np.inf, np.inf
    if not path.ordered:
        return OwnVariables(least=least, most=most)
    gap = min(_GAP, 0.5 * (most - least) / len(path.places))
    span = (FULL_TURN if turns else np.inf) - gap
    return OwnVariables(least=least, most=most, in_order=True, gap=gap, span=span)


def _freely_timed(
    model: Model, motion: Motion, point: str, places: ComplexArray, ordered: bool
) -> tuple[PathGoal, ...]:
    """Goals with free timing, with inputs at which the mechanism as it is comes near the points.

    In any order each point takes the nearest row. In order there is one goal for each sense of the
    input: points at the same shares of arc length on a part of the path. The part and where it
    begins are those of least squares.
    """
    lead = next(iter(motion.inputs))
    rows = np.flatnonzero(motion.found)
    at = np.asarray(motion.inputs[lead])[rows] * float(model.input_scale[0])
    path = np.asarray(motion[f"{point}.x"])[rows] + 1j * np.asarray(motion[f"{point}.y"])[rows]
    goal = PathGoal(point=point, places=places, inputs=at[:0], timed=False, ordered=ordered)
    if not ordered:
        nearest = np.abs(places[:, None] - path).argmin(axis=1)
        return (replace(goal, inputs=at[nearest]),)
    around = model.equations.inputs[0].kind == Kind.ANGLE.value and bool(
        abs(abs(at[-1] - at[0]) - FULL_TURN) <= EQUAL_ROWS * FULL_TURN
    )
    goals = []
    for falling in (False, True):
        listed = places[::-1] if falling else places
        matches = _matches(at, path, listed, around)
        best = min(matches, key=lambda match: float(np.sum(np.abs(match[1] - listed) ** 2)))
        goals.append(replace(goal, places=listed, inputs=best[0], falling=falling))
    return tuple(goals)


def _matches(
    at: Array, path: ComplexArray, places: ComplexArray, around: bool
) -> Iterator[tuple[Array, ComplexArray]]:
    """Rising inputs for the points, and where the mechanism is then, for each part and begin."""
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path)))])
    steps = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(places)))])
    along = steps / steps[-1] if steps[-1] > 0.0 else np.linspace(0.0, 1.0, len(places))
    total, turn = length[-1], at[-1] - at[0]
    # the last of N points on a whole closed path is one step before its end
    shares = (*_SHARES[:-1], 1.0 - 1.0 / len(places)) if around else _SHARES
    for share in shares:
        free = 1.0 if around else 1.0 - share
        for first in np.linspace(0.0, free, _SHIFTS, endpoint=not around):
            s = first + share * along
            laps, inside = np.divmod(s, 1.0) if around else (0.0 * s, s)
            where = np.interp(inside * total, length, np.arange(len(at)))
            inputs = np.interp(where, np.arange(len(at)), at) + laps * turn
            low = where.astype(int)
            high = np.minimum(low + 1, len(at) - 1)
            yield inputs, path[low] + (where - low) * (path[high] - path[low])


def point_named(model: Model, name: str) -> str:
    """A point as the mechanism spells it.

    Raises
    ------
    UnknownNameError
        If there is none.
    """
    spelled = find_spelling(name, model.equations.points)
    if spelled not in model.equations.points:
        known = choices("points", model.equations.points, name)
        raise UnknownNameError(f'there is no point "{name}" {known}')
    return spelled


def paths_of(model: Model, motion: Motion, goal: Points) -> tuple[PathGoal, ...]:
    """The path through points, one for each way to time them."""
    description = model.description
    name = goal.point or next(iter(description.trace), None)
    if name is None:
        raise InputError(f'"{description.name}" traces no point: name one, point = "P"')
    spelled = point_named(model, name)
    places = np.array([complex(*place) for place in goal.points])
    if goal.inputs is None:
        return _freely_timed(model, motion, spelled, places, goal.order != "any")
    inputs = np.asarray(goal.inputs, dtype=float) * float(model.input_scale[0])
    return (PathGoal(point=spelled, places=places, inputs=inputs, timed=True, ordered=True),)
