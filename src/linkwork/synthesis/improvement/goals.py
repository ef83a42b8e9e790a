"""Extremes of a quantity between the rows of a regular table, on the quartic through five rows."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Node, names_in
from linkwork.core.foundation.arrays import (
    EQUAL_ROWS,
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, AskedOfMotion, Group, RowSlopes
from linkwork.core.results.quantities.registry import MOTION_QUANTITIES
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.results.quantity import Kind
from linkwork.design.sensitivities import LIMITS
from linkwork.families.located import interpolated_extremes, parts_of, step_of
from linkwork.synthesis.improvement.lanes import LanePositions
from linkwork.synthesis.improvement.settings import Goal
from linkwork.synthesis.lane_least_squares import Multipliers

_SAFE = 1.5  # fifth differences are known at some rows only
_NEWTON = 3  # steps to an extreme of the quartic from that of the parabola
# from five neighbouring values to the coefficients of their quartic
_QUARTIC = np.linalg.inv(np.vander(np.arange(-2.0, 3.0), increasing=True))
_FIFTH = np.array([-1.0, 5.0, -10.0, 10.0, -5.0, 1.0])


class BetweenRows:
    """Where a quantity is least or greatest half-way to the rows next to each.

    Parameters
    ----------
    at : (R,)
        Inputs of the rows.
    """

    def __init__(self, at: Array) -> None:
        count, steps = len(at), np.diff(at)
        #: Whether five rows or more are equally far apart.
        self.is_regular = count >= len(_QUARTIC) and bool(
            np.ptp(steps) <= EQUAL_ROWS * max(np.abs(at).max(), np.abs(steps).max())
        )
        row = np.arange(count)
        middle = np.clip(row, 2, count - 3)
        self._window = middle[:, None] + np.arange(-2, 3)
        place = (row - middle).astype(float)
        self._low = place - 0.5 * (row > 0)
        self._high = place + 0.5 * (row < count - 1)

    def extremes(self, value: Array, by_x: Array, greatest: BoolArray) -> tuple[Array, Array]:
        """The least or greatest values (D, R) with the derivatives by P numbers, (D, R, P).

        ``value``, ``by_x``: those of the rows. What the quartic may miss makes values more extreme.
        """
        near = value[:, self._window]
        sign = np.where(greatest, -1.0, 1.0)
        with np.errstate(all="ignore"):
            t = self._minima(sign[:, :, None] * (near @ _QUARTIC.T))
            weights = t[:, :, None] ** np.arange(5) @ _QUARTIC
            extremes = (weights * near).sum(axis=2) - sign * self._missed(value, t)
        slopes = np.einsum("drk,drkp->drp", weights, by_x[:, self._window])
        return extremes, slopes

    def _minima(self, c: Array) -> Array:
        """Where quartics with coefficients (D, R, 5) are least, in steps from their middle row."""
        ends = [np.broadcast_to(end, c.shape[:2]) for end in (self._low, self._high)]
        t = np.clip(-0.5 * c[:, :, 1] / c[:, :, 2], *ends)
        for _ in range(_NEWTON):
            slope = c[:, :, 1] + t * (2 * c[:, :, 2] + t * (3 * c[:, :, 3] + t * 4 * c[:, :, 4]))
            bend = 2 * c[:, :, 2] + t * (6 * c[:, :, 3] + t * 12 * c[:, :, 4])
            t = np.clip(t - slope / bend, *ends)
        tried = np.stack([*ends, np.where(np.isfinite(t), t, ends[0])])
        heights = ((tried[..., None] ** np.arange(5)) * c).sum(axis=-1)
        best = np.nan_to_num(heights, nan=np.inf).argmin(axis=0)
        return np.asarray(np.take_along_axis(tried, best[None], axis=0)[0])

    def _missed(self, value: Array, t: Array) -> Array:
        """What quartics miss, from the fifth differences next to a row, (D, R)."""
        if value.shape[1] < len(_FIFTH):
            return np.zeros_like(t)
        windows = np.lib.stride_tricks.sliding_window_view(value, len(_FIFTH), axis=1)
        differences = np.abs(windows @ _FIFTH)
        first = self._window[:, 0]
        last = differences.shape[1] - 1
        largest = np.maximum(
            differences[:, np.minimum(first, last)], differences[:, np.clip(first - 1, 0, last)]
        )
        away = np.abs(t * (t**2 - 1.0) * (t**2 - 4.0))
        return np.asarray(_SAFE * away * largest / math.factorial(5))


# ----------------------------------------------------------------------
# Goals of an improvement: misses of designs in lanes, and their derivatives by the numbers.
#
# A goal is a quantity of rows (``B.y``, ``rocker.d1``), a number of the motion (``stroke(d)``,
# ``time_ratio(d)``, ``dwell(d, 2)``), or a formula of either (``B.y - 2 * rocker``, ``stroke(d) /
# max(B.transmission)``). Misses are in file units.


_WORDS = "|".join(quantity.word for quantity in MOTION_QUANTITIES)
_CALL = re.compile(rf"\b(?:{_WORDS})\s*\([^()]*\)")
_OF_ROWS = re.compile(r"(?:max|min)\s*\([^,]*,")  # the larger or smaller of several in each row
_OF_FORMULA = re.compile(
    r"\b(max|min)\s*\((?:(?:[^(),]|\([^()]*\))*\([^()]*\)[^(),]*|[^(),]*[-+*/^][^(),]*)\)"
)
_NUMBER = "number_{}_of_the_motion"
_ZERO = np.zeros(())
_TILT = 4.0 * EQUAL_ROWS
_STIFF = 100.0  # weight of bounds: their shifts converge faster
_MARGIN = 1e-7  # relative: by which bounds hold in the end
_NONE = 1e-2  # of this margin: rounding


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

    def misses(self, positions: LanePositions) -> tuple[Array, Array, Array]:
        """Vectors from the points (D, N, 2), by the numbers and by the inputs.

        A row that does not close yet counts as a large miss, and waits; a design of other equations
        has no misses.
        """
        place = positions.rows.place(self.point).v
        rows, by_x, by_t = positions.values([place.real, place.imag])
        rows = rows - np.stack([self.places.real, self.places.imag], axis=1)
        lost = ~positions.solved.reshape(positions.shape)
        rows[lost], by_x[lost], by_t[lost] = self.lost, 0.0, 0.0
        rows[~positions.rows.designs.fine] = np.nan
        return rows, by_x, by_t


class Misses(ABC):
    """The misses of a goal.

    Parameters
    ----------
    goal : Goal
    at : (R,)
        The leading inputs of its rows [rad or length].
    order : int
        How many derivatives of the positions it needs.
    """

    def __init__(self, goal: Goal, at: Array, order: int) -> None:
        self.goal, self.at, self.order = goal, at, order

    @abstractmethod
    def values(self, positions: LanePositions) -> tuple[Array, Array]:
        """The quantity (D, K) in file units, and by the numbers, (D, K, P)."""

    #: A full turn, of a quantity that is an angle [file units]; else 0.
    turn = 0.0

    @property
    def count(self) -> int:
        """The number of misses."""
        return len(self.at)

    @property
    def is_bound(self) -> bool:
        """Whether only values beyond bounds are misses."""
        return self.goal.is_bound

    def beyond(self, misses: Array) -> Array:
        """How far values are below and above their bounds, from misses (D, K); (D, 2)."""
        weight, goal = _STIFF * self.goal.weight, self.goal
        low = -misses.min(axis=1) / weight
        high = misses.max(axis=1) / weight
        least, most = (0.0 if bound is None else bound for bound in (goal.least, goal.most))
        away = np.stack([low - _margin(least), high - _margin(most)], axis=1)
        return np.where(away > _NONE * _margin(np.array([least, most])), away, 0.0)

    @np.errstate(all="ignore")  # where there is no position there is no number
    def of(
        self, positions: LanePositions, error: Array, bound: Multipliers | None, lanes: IndexArray
    ) -> tuple[Array, Array]:
        """Weighted misses (D, K) of values less their error (D,), and by the numbers.

        ``bound``: the multipliers (lanes, 2, K) of a goal that is one.
        """
        (value, by_x), goal = self.values(positions), self.goal
        value = value - error[:, None]
        if bound is None:
            target: Any = np.array(goal.values) if goal.values else goal.target
            away = value - target
            if self.turn:
                away = np.mod(away + 0.5 * self.turn, self.turn) - 0.5 * self.turn
            return goal.weight * away, goal.weight * by_x
        least = -np.inf if goal.least is None else _above(goal.least)
        most = -np.inf if goal.most is None else _above(-goal.most)
        (beyond,) = bound.residuals(lanes, np.stack([least - value, value + most], axis=1))
        away = beyond[:, 1] - beyond[:, 0]
        weight = _STIFF * goal.weight
        return weight * away, weight * np.where((away != 0.0)[:, :, None], by_x, 0.0)


def _above(bound: float) -> float:
    return bound + float(_margin(bound))


def _margin(bound: Any) -> Any:
    return _MARGIN * np.maximum(1.0, np.abs(bound))


def goal_of(model: Model, goal: Goal, table: Array, there: BoolArray, scale: float) -> Misses:
    """The misses of a goal.

    Parameters
    ----------
    table : (R,)
        The leading inputs of the motion [rad or length].
    there : (R,)
        Where the mechanism as it is has a position.
    scale : float
        The unit of inputs in files.

    Raises
    ------
    UnknownNameError, InputError
        For a quantity that is not known, or whose derivatives are not known.
    """
    calls = [call for call in dict.fromkeys(_CALL.findall(goal.of)) if not _OF_ROWS.match(call)]
    inner = _OF_FORMULA.search(goal.of)
    if inner:
        raise InputError(
            f'"{inner[1]}" of one formula: of the whole motion it takes a name, {inner[1]}(d), in '
            f"each row two formulas, {inner[1]}(d, 0); give the formula a name in [outputs]"
        )
    if goal.of.strip() in LIMITS:
        raise InputError(
            f'"{goal.of}" cannot be a goal: ask for a wider table of inputs, which has to be '
            "reached as a whole"
        )
    if not calls:
        at = np.array(goal.at) * scale if goal.at else table[there]
        if goal.is_bound and not goal.at and _is_transmission(model, goal.of):
            return _TransmissionMisses(model, goal, at)
        return _RowMisses(model, goal, at)
    if goal.at:
        raise InputError(f'"{goal.of}" is a number of the whole motion: leave out at and values')
    return NumberMisses(model, goal, table, there, calls)


class _RowMisses(Misses):
    """A quantity of rows, or a formula of such quantities."""

    def __init__(self, model: Model, goal: Goal, at: Array) -> None:
        self.node = None if _is_name(model, goal.of) else parse(goal.of)
        names = [goal.of] if self.node is None else _names(self.node)
        self.asked = {name: model.quantities.find(name) for name in names}
        if not names:
            raise InputError(f'"{goal.of}" has no quantity of the mechanism')
        for quantity in self.asked.values():
            _check(quantity, goal.of)
            quantity.check_rate(model.speed)
        super().__init__(goal, at, max(quantity.needs for quantity in self.asked.values()))
        self.angle = model.description.angle
        measured = self.asked.get(goal.of)
        if measured is not None and measured.own.kind is Kind.ANGLE and measured.rate is None:
            self.turn = FULL_TURN / model.units.scale(Kind.ANGLE)

    def values(self, positions: LanePositions) -> tuple[Array, Array]:
        """See :meth:`Misses.values`."""
        rows = positions.rated(self.order)
        known = {name: quantity.values(rows, rows.speed) for name, quantity in self.asked.items()}
        if self.node is None:
            total = known[self.goal.of]
        else:
            jets = {name: Jet(value, _ZERO, _ZERO) for name, value in known.items()}
            total = evaluate(self.node, jets, self.angle).v
        return positions.totals(rows, total)


class _TransmissionMisses(_RowMisses):
    """Transmission angles where they are least or greatest half-way to the rows next to each."""

    def __init__(self, model: Model, goal: Goal, at: Array) -> None:
        super().__init__(model, goal, at)
        self.between = BetweenRows(at)

    def values(self, positions: LanePositions) -> tuple[Array, Array]:
        """See :meth:`Misses.values`."""
        value, by_x = super().values(positions)
        if not self.between.is_regular:
            return value, by_x
        # of two bounds that one which is nearer
        least = -np.inf if self.goal.least is None else self.goal.least
        most = np.inf if self.goal.most is None else self.goal.most
        return self.between.extremes(value, by_x, value - least > most - value)


class NumberMisses(Misses):
    """A number of the motion, or a formula of such numbers."""

    def __init__(
        self, model: Model, goal: Goal, table: Array, there: BoolArray, calls: Sequence[str]
    ) -> None:
        text, self.there = goal.of, there
        self.calls = {_NUMBER.format(k): call for k, call in enumerate(calls)}
        self.asked = {n: model.quantities.find_of_motion(call) for n, call in self.calls.items()}
        for name, request in self.asked.items():
            text = text.replace(self.calls[name], f"({name})")
            _check(request.of, goal.of)
            request.of.check_rate(model.speed)
        self.node: Node = parse(text)
        others = set(_names(self.node)) - set(self.asked)
        if others:
            raise InputError(
                f'"{goal.of}" mixes numbers of the motion with "{min(others)}", which has a value '
                f"in each row: write min({min(others)}), max or mean"
            )
        if len(table) > 2 and there.all():
            table = _divided(table, parts_of(table, Kind(model.equations.inputs[0].kind)))
            self.there = np.ones(len(table), dtype=bool)
        super().__init__(goal, table, max(request.needs for request in self.asked.values()))
        self.angle = model.description.angle

    @property
    def count(self) -> int:
        """One."""
        return 1

    def exact(self, motion: Motion) -> float:
        """The number of a motion, located between its rows."""
        jets = {n: Jet(np.array(motion.value(c)), _ZERO, _ZERO) for n, c in self.calls.items()}
        return float(evaluate(self.node, jets, self.angle).v)

    def values(self, positions: LanePositions) -> tuple[Array, Array]:
        """See :meth:`Misses.values`."""
        rows = positions.rated(self.order)
        known = {name: self._number(number, positions, rows) for name, number in self.asked.items()}
        count = positions.shape[0]
        by_x = np.zeros((count, positions.slopes.shape[2] - 1))
        total = np.zeros(count)
        for name in known:
            # the formula's derivative by this number
            jets = {
                other: Jet(value, np.full(count, float(other == name)), np.zeros(count))
                for other, (value, _) in known.items()
            }
            jet = evaluate(self.node, jets, self.angle)
            total = np.broadcast_to(jet.v, count)
            by_x = by_x + np.broadcast_to(jet.d1, count)[:, None] * known[name][1]
        return total[:, None], by_x[:, None, :]

    def _number(
        self, number: AskedOfMotion, lanes: LanePositions, rows: Any
    ) -> tuple[Array, Array]:
        """A number (D,), whose derivatives (D, P) weigh those of rows."""
        columns = number.columns(rows, rows.speed)[: 1 + number.quantity.needs]
        plain = [lanes.plain(column) for column in columns]
        weights: list[AnyArray] = [np.zeros(part.shape, dtype=part.dtype) for part in plain]
        lost = [np.full(lanes.shape, np.nan)] * (3 - len(plain))
        located = bool(number.quantity.sides) and lanes.shape[1] > 2
        if located:
            step = step_of(self.at, number.names.inputs[number.names.lead])
            arguments = self.at, plain[0], number.quantity.sides, step
            numbers, weights[0] = interpolated_extremes(*arguments)
        else:
            numbers = number.evaluate(self.at, *plain, *lost)
        # a design that loses positions has no number to compare
        numbers[(~lanes.solved.reshape(lanes.shape) & self.there).any(axis=1)] = np.nan
        for k in () if located else np.flatnonzero(np.isfinite(numbers)):
            series = [part[k] for part in (*plain, *lost)]
            slopes = _one_sided_slopes(number, self.at, *series)
            for weight, part in zip(
                weights, (slopes.value, slopes.first, slopes.second), strict=False
            ):
                weight[k] = part
        total: Any = 0.0
        for weight, column in zip(weights, columns, strict=True):
            total = total + np.real(np.conj(weight.ravel()) * column)
        _, by_x = lanes.totals(rows, total)
        # rows of no weight may have no derivative
        used = np.any([weight != 0.0 for weight in weights], axis=0)
        return numbers, np.where(used[:, :, None], by_x, 0.0).sum(axis=1)


def _divided(table: Array, parts: int) -> Array:
    """A table whose steps are divided into parts."""
    row = np.arange(parts * (len(table) - 1) + 1) / parts
    return np.interp(row, np.arange(len(table)), table)


def _one_sided_slopes(
    request: AskedOfMotion, at: Array, value: AnyArray, *rates: AnyArray
) -> RowSlopes:
    """The derivatives of a number by its rows; where equal extremes have none, those of the last.

    A fit needs a direction: symmetric motions have equal extremes at both ends.
    """
    slopes = request.quantity.slopes(request.rows(at, value, *rates), request.numbers)
    parts = (slopes.value, slopes.first, slopes.second)
    if all(np.isfinite(part).all() for part in parts):
        return slopes
    # just more than the difference that counts as equal from row to row
    tilt = _TILT * np.nanmax(np.abs(value)) * np.arange(len(value))
    return request.quantity.slopes(request.rows(at, value + tilt, *rates), request.numbers)


def _is_transmission(model: Model, text: str) -> bool:
    if not _is_name(model, text):
        return False
    quantity = model.quantities.find(text)
    return quantity.row is TRANSMISSION_ANGLE and quantity.rate is None


def _is_name(model: Model, text: str) -> bool:
    try:
        model.quantities.find(text)
    except UnknownNameError:
        return False
    return True


def _names(node: Node) -> list[str]:
    return sorted({name.name for name in names_in(node)} - set(CONSTANTS))


def _check(quantity: Asked, of: str) -> None:
    if quantity.group is Group.EVIDENCE:
        raise InputError(f'"{of}" cannot be a goal: it measures how a position was found')
    if quantity.row in quantity.names.further:
        raise InputError(
            f'"{of}" cannot be a goal: the forces of designs are not known yet; ask for positions, '
            "velocities or accelerations"
        )
    if quantity.needs > 2:
        raise InputError(f'"{of}" cannot be a goal: positions have two derivatives')
