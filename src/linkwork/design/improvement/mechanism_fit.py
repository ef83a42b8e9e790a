"""The numbers of any mechanism that meet goals best: least squares of many starts in lanes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwork.design.improvement.settings import Goal
from linkwork.design.improvement.solved_lanes import LanePositions, SolvedLanes
from linkwork.design.sensitivity import is_of_motion
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.operand import NotElementwise
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.model import Model
from linkwork.numerics.lane_least_squares import (
    Box,
    LaneFit,
    Residuals,
    Sequenced,
    minimise,
    starts_of,
)
from linkwork.results.motion import Motion
from linkwork.results.quantities.definition import MotionRows
from linkwork.results.quantity import Kind

__all__ = ["FittedNumbers", "PathGoal", "fit_numbers", "path_misses"]

_GAP = 1e-7  # between inputs of positions in order [rad or length]
_ROUNDS = (60, 200, 200)  # steps of all lanes, then of the better half
_ALL = 64  # so few lanes all go on
_APPROACH = 4  # parts of the way from the mechanism to a start


@dataclass(frozen=True, kw_only=True, eq=False)
class PathGoal:
    """Points that a point of the mechanism passes.

    Parameters
    ----------
    point : str
    places : (N,) complex
        [length]
    inputs : (N,)
        Leading inputs there, or with free timing where to begin [rad or length].
    timed : bool
        Whether the inputs are given.
    ordered : bool
        Whether free inputs keep their order.
    falling : bool
        Whether the points are listed from the last to the first, so that inputs rise.
    """

    point: str
    places: ComplexArray
    inputs: Array
    timed: bool
    ordered: bool
    falling: bool = False

    @property
    def lost(self) -> float:
        """The miss of a point at which the mechanism does not close [length]."""
        return 4.0 * float(np.abs(self.places - self.places.mean()).max())


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedNumbers:
    """D designs, one for each start that went to the end.

    Parameters
    ----------
    x : (D, P)
        The numbers, file units.
    t : (D, N)
        Leading inputs at the points [rad or length].
    total : (D,)
        Weighted sums of squares of all misses.
    path : (D,)
        Sums of squares of the distances from the points [length²].
    interrupted : bool
    """

    x: Array
    t: Array
    total: Array
    path: Array
    interrupted: bool


def fit_numbers(
    model: Model,
    motion: Motion,
    numbers: Sequence[VariedNumber],
    box: Box,
    starts: Array,
    path: PathGoal | None,
    goals: Sequence[Goal],
    progress: Callable[[float], None] | None = None,
) -> FittedNumbers:
    """Improve starts (D, P); the motion is that of the mechanism as it is.

    Raises
    ------
    InputError
        For goals whose derivatives are not known.
    """
    problem = _Problem(model, motion, numbers, path, goals, len(starts))
    fit = problem.begun(starts)
    lanes = np.arange(len(starts))
    for k, steps in enumerate(_ROUNDS):
        left = np.flatnonzero(~fit.done if k else np.ones(len(fit), dtype=bool))
        # of many lanes only the better half goes on
        most = len(starts) if len(fit) <= _ALL or not k else len(starts) // 2
        keep = left[np.argsort(fit.total[left], kind="stable")[:most]]
        if not len(keep):
            break
        rest = np.setdiff1d(np.arange(len(fit)), keep)
        further = problem.minimised(fit.take(keep), lanes[keep], box, steps)
        fit = LaneFit.joined([further, fit.take(rest)])
        lanes = np.concatenate([lanes[keep], lanes[rest]])
        if progress is not None:
            progress((k + 1) / len(_ROUNDS))
        if fit.interrupted:
            break
    order = np.argsort(lanes)
    fit = fit.take(order)
    timed = path is None or path.timed
    t = np.broadcast_to(path.inputs, (len(fit), len(path.places))) if path else fit.t
    return FittedNumbers(
        x=fit.x,
        t=t if timed else fit.t,
        total=fit.total,
        path=problem.missed_points(fit, np.arange(len(fit))),
        interrupted=fit.interrupted,
    )


def path_misses(
    model: Model, motion: Motion, numbers: Sequence[VariedNumber], path: PathGoal, x: Array
) -> Array:
    """The distances of one mechanism from timed points, (N,), reached from the nearest rows of its
    motion; NaN where it has no position on their branch.
    """
    away = _inputs_away(path.inputs, motion, model)
    solved = SolvedLanes(model, numbers, x, motion.q[away.argmin(axis=1)], path.inputs, 1)
    found = solved.at(x[None], path.inputs[None], np.zeros(1, dtype=int))
    place = found.rows.place(path.point).v
    value = found.values([place.real, place.imag])[0][0]
    return np.asarray(np.abs(value[:, 0] + 1j * value[:, 1] - path.places))


def _inputs_away(at: Array, motion: Motion, model: Model) -> Array:
    """The distances of inputs (N,) from those of rows (R,), infinite from lost ones, (N, R)."""
    lead = next(iter(motion.inputs))
    table = np.asarray(motion.inputs[lead]) * float(model.input_scale[0])
    away = at[:, None] - table
    if model.equations.inputs[0].kind == Kind.ANGLE.value:
        away = np.mod(away + 0.5 * FULL_TURN, FULL_TURN) - 0.5 * FULL_TURN
    return np.where(motion.found, np.abs(away), np.inf)


class _Problem:
    def __init__(
        self,
        model: Model,
        motion: Motion,
        numbers: Sequence[VariedNumber],
        path: PathGoal | None,
        goals: Sequence[Goal],
        lanes: int,
    ) -> None:
        self.model, self.numbers, self.path = model, numbers, path
        self.motion, self.lanes = motion, lanes
        description = model.description
        self.x = np.array([float(q.of(description)) for q in numbers])
        lead = next(iter(motion.inputs))
        self.scale = float(model.input_scale[0])
        self.table = np.asarray(motion.inputs[lead]) * self.scale
        self.turns = model.equations.inputs[0].kind == Kind.ANGLE.value
        self.points = None if path is None else self._rows(path.inputs)
        self.row_goals = [self._of_rows(goal) for goal in goals if not is_of_motion(goal.of)]
        self.numbers_of_motion = [goal for goal in goals if is_of_motion(goal.of)]
        self.whole = self._rows(self.table) if self.numbers_of_motion else None
        self.asked = [self._asked(goal) for goal in self.numbers_of_motion]

    def _asked(self, goal: Goal) -> Any:
        asked = self.model.quantities.find_of_motion(goal.of)
        if asked.needs > 0 or asked.quantity.of_point:
            raise InputError(
                f'"{goal.of}" cannot be a goal: its derivatives need rates; ask for min, max, '
                "mean or stroke, or for values of a quantity at inputs"
            )
        return asked

    def _of_rows(self, goal: Goal) -> tuple[Goal, SolvedLanes, Array]:
        at = np.array(goal.at) * self.scale if goal.at else self.table
        asked = self.model.quantities.find(goal.of)
        if asked.needs:
            raise InputError(f'"{goal.of}" cannot be a goal: it needs rates; ask for positions')
        return goal, self._rows(at), at

    def _rows(self, at: Array) -> SolvedLanes:
        """Lanes at inputs, begun at the nearest rows of the mechanism's motion."""
        away = _inputs_away(at, self.motion, self.model)
        q = self.motion.q[away.argmin(axis=1)]
        return SolvedLanes(self.model, self.numbers, self.x, q, at, self.lanes)

    def begun(self, starts: Array) -> LaneFit:
        """The starts, reached from the mechanism in some steps; infinite where lost."""
        own = 0 if self.path is None or self.path.timed else len(self.path.places)
        t = np.broadcast_to(
            self.path.inputs[:own] if self.path else np.zeros(0), (len(starts), own)
        )
        lanes = np.arange(len(starts))
        for part in range(1, _APPROACH + 1):
            x = self.x + (starts - self.x) * (part / _APPROACH)
            for solved in self._solvers:
                solved.total[:] = np.inf
            self.evaluate(x, np.asarray(t), lanes)
        for solved in self._solvers:
            solved.total[:] = np.inf
        return starts_of(starts, np.array(t))

    @property
    def _solvers(self) -> list[SolvedLanes]:
        own = [solved for solved in (self.points, self.whole) if solved is not None]
        return own + [solved for _, solved, _ in self.row_goals]

    def minimised(self, fit: LaneFit, numbers: IndexArray, box: Box, steps: int) -> LaneFit:
        """Lanes after some steps."""
        sequenced = None
        if self.path is not None and not self.path.timed and self.path.ordered:
            sequenced = Sequenced(gap=_GAP, span=(FULL_TURN if self.turns else np.inf) - _GAP)

        def evaluate(x: Array, t: Array, lanes: IndexArray) -> Residuals:
            return self.evaluate(x, t, numbers[lanes])

        return minimise(evaluate, fit, box, steps, sequenced=sequenced)

    def evaluate(self, x: Array, t: Array, lanes: IndexArray) -> Residuals:
        """All misses of designs (D, P); NaN where a design cannot be built like the others."""
        try:
            return self._together(x, t, lanes)
        except NotElementwise:
            half = len(x) // 2
        if half:
            first, second = slice(0, half), slice(half, None)
            return Residuals.joined(
                self.evaluate(x[first], t[first], lanes[first]),
                self.evaluate(x[second], t[second], lanes[second]),
            )
        # the mechanism itself can be built: its residuals have the shapes
        known = self._together(self.x[None], t, lanes, keep=False)
        return replace(known, rows=known.rows * np.nan, shared=known.shared * np.nan)

    def _together(self, x: Array, t: Array, lanes: IndexArray, *, keep: bool = True) -> Residuals:
        count, parameters = x.shape
        rows, by_x = np.zeros((count, 0, 2)), np.zeros((count, 0, 2, parameters))
        by_t: Array | None = None
        kept = []
        if self.path is not None and self.points is not None:
            at = np.broadcast_to(self.path.inputs, (count, len(self.path.places)))
            at = at if self.path.timed else t
            found = self.points.at(x, at, lanes)
            place = found.rows.place(self.path.point).v
            rows, by_x, slope = found.values([place.real, place.imag])
            rows = rows - np.stack([self.path.places.real, self.path.places.imag], axis=1)
            # a row that does not close yet counts as a large miss, and waits
            lost = ~found.found.reshape(found.shape)
            rows[lost], by_x[lost], slope[lost] = self.path.lost, 0.0, 0.0
            by_t = None if self.path.timed else slope
            kept.append((self.points, found, at))
        shared, shared_by_x = [np.zeros((count, 0))], [np.zeros((count, 0, parameters))]
        for goal, solved, inputs in self.row_goals:
            at = np.broadcast_to(inputs, (count, len(inputs)))
            found = solved.at(x, at, lanes)
            own, slopes = self._row_misses(goal, found)
            shared.append(own)
            shared_by_x.append(slopes)
            kept.append((solved, found, at))
        if self.whole is not None:
            at = np.broadcast_to(self.table, (count, len(self.table)))
            found = self.whole.at(x, at, lanes)
            for goal, asked in zip(self.numbers_of_motion, self.asked, strict=True):
                own, slopes = self._number_misses(goal, asked, found)
                shared.append(own)
                shared_by_x.append(slopes)
            kept.append((self.whole, found, at))
        result = Residuals(
            rows, by_x, by_t, np.concatenate(shared, axis=1), np.concatenate(shared_by_x, axis=1)
        )
        for solver, found, at in kept if keep else ():
            solver.keep(found, x, at, lanes, result.total)
        return result

    def missed_points(self, fit: LaneFit, lanes: IndexArray) -> Array:
        """Sums of squares of the distances from the points, (D,)."""
        rows = self.evaluate(fit.x, fit.t, lanes).rows
        return np.asarray(np.einsum("dnm,dnm->d", rows, rows))

    def _row_misses(self, goal: Goal, found: LanePositions) -> tuple[Array, Array]:
        asked = self.model.quantities.find(goal.of)
        value, by_x, _ = found.values([asked.values(found.rows, None)])
        value, by_x = value[:, :, 0], by_x[:, :, 0]
        turn = 0.0
        if asked.own.kind is Kind.ANGLE:
            turn = FULL_TURN / self.model.units.scale(Kind.ANGLE)
        return _missed(goal, np.array(goal.values) if goal.values else None, value, by_x, turn)

    def _number_misses(self, goal: Goal, asked: Any, found: LanePositions) -> tuple[Array, Array]:
        """A number of the motion, whose derivatives weigh those of rows."""
        column = asked.of.values(found.rows, None)
        value, by_x, _ = found.values([column])
        value, by_x = value[:, :, 0], by_x[:, :, 0]
        numbers = asked.evaluate(self.table, value)
        slopes = np.zeros((len(value), by_x.shape[2]))
        unknown = np.full(value.shape[1], np.nan)
        for k in np.flatnonzero(np.isfinite(numbers)):
            rows = MotionRows(input=self.table, value=value[k], first=unknown, second=unknown,
                              unit=1.0, turn=FULL_TURN if self.turns else 0.0)  # fmt: skip
            weights = asked.quantity.slopes(rows, asked.numbers).value
            slopes[k] = np.broadcast_to(weights, unknown.shape) @ by_x[k]
        return _missed(goal, None, numbers[:, None], slopes[:, None, :], 0.0)


def _missed(
    goal: Goal, values: Array | None, found: Array, by_x: Array, turn: float
) -> tuple[Array, Array]:
    """Weighted misses (D, K) of values found, and their derivatives."""
    wanted = goal.target if values is None else values
    if wanted is not None:
        away = found - wanted
        if turn:
            away = np.mod(away + 0.5 * turn, turn) - 0.5 * turn
        return goal.weight * away, goal.weight * by_x
    low = np.zeros_like(found) if goal.least is None else np.minimum(0.0, found - goal.least)
    high = np.zeros_like(found) if goal.most is None else np.maximum(0.0, found - goal.most)
    away = low + high + 0.0 * found
    return goal.weight * away, goal.weight * np.where((away != 0.0)[:, :, None], by_x, 0.0)
