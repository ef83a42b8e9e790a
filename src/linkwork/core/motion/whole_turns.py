"""Motions that repeat themselves after whole turns of the input: laps are left out."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, StatusArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.rounding import EPSILON, UNIT_ROUNDOFF
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import FULL_TURN, AngleUnit
from linkwork.core.foundation.values import check_class
from linkwork.core.motion.following import Drive, turns_freely
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import input_rate
from linkwork.core.motion.rows_between import motion_of_rows
from linkwork.core.motion.solving import first_position
from linkwork.core.numerics.branch_tracking import Node, follow
from linkwork.core.numerics.local_parametrization import same_position, whole_turns
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.results.limit import Limit, LimitKind
from linkwork.core.results.motion import Motion

_FAR = 3.0  # turns up to which the motion is simply followed
_MOST_COUNTED = 1e15  # turns: of more, the rounding of a number is more than a turn
_MOST_FOLLOWED = 10_000  # turns of a motion that does not repeat itself
_MOST_TURNS = 60  # of the input, after which a motion counts as one that never repeats itself


@dataclass(frozen=True, kw_only=True, eq=False)
class Lap:
    """The way of a motion from a position back to it, while the input turns on.

    ``begin``, ``end``: of the input, internal units. ``turns``: of the input in a lap. ``gained``
    (N,): whole turns of every angle in a lap; what every length gains, in units of 2π.
    """

    drive: Drive
    begin: Node
    end: Node
    turns: int
    gained: Array

    @property
    def width(self) -> float:
        """Of a lap, in radians of the input."""
        return self.turns * FULL_TURN

    @property
    def _unit(self) -> AngleUnit:
        return self.drive.model.units.angle

    def number_of(self, values: Array) -> Array:
        """The laps (B,) between the beginning and inputs (B,) in file units."""
        begin = self._unit.from_radians(self.begin.t)
        number: Array = np.floor((values - begin) / (self.turns * self._unit.turn))
        return number

    def nearer(self, values: Array, number: Array) -> Array:
        """Inputs (B,) in file units that many laps (B,) nearer to the beginning."""
        return self._unit.without_turns(values, number * self.turns)

    def intended(self, nearer: Array) -> Array:
        """Inputs (B,) in internal units, apart from ``nearer`` by what that may be off by.

        Proofs hold for all inputs in between.
        """
        t = nearer * self.drive.unit
        return t + 4.0 * UNIT_ROUNDOFF * (1.0 + np.abs(t))

    def leads_back(self, closing: SolvedRows) -> bool:
        """Whether the row at the end of the lap is proved to be the position at its beginning."""
        leads, begin, end = self.drive.leads, self.begin.v, closing.v[0]
        return bool(
            closing.certification[0] == Certification.CERTIFIED.code
            and np.array_equal(_gained(self.drive, begin, end), self.gained)
            and same_position(leads, begin, end, self.gained)
        )

    def after(self, rows: SolvedRows, number: Array, proved: bool) -> SolvedRows:
        """Rows of the first lap that many laps (B,) later.

        Large angles are rounded; radii grow by that. ``proved``: whether a lap leads back.
        """
        v = rows.v + np.multiply.outer(number * FULL_TURN, self.gained)
        weights = self.drive.solver.variable_scale
        roundings = np.where(self.drive.leads.is_angle, 2.0, 4.0) * EPSILON
        off = (roundings * np.abs(v) * (v != rows.v) / weights).max(axis=1)
        radius, room = rows.radius + off, rows.uniqueness_radius - off
        certified = rows.certification == Certification.CERTIFIED.code
        lost = certified & ~(radius < room)
        rows = rows.with_columns(v=v, radius=radius, uniqueness_radius=room)
        rows = rows.set(lost, certification=Certification.POSITION_NOT_PROVED.code)
        if proved:
            return rows
        further = certified & ~lost & (number != 0.0)
        return rows.set(further, certification=Certification.MOTION_NOT_PROVED.code)


def lap_of(drive: Drive, begin: Node, t: Array) -> Lap | None:
    """The lap of a motion, if inputs ``t`` (B,) far from each other or from its beginning are
    asked for.

    Raises
    ------
    InputError
        If so many turns are asked for that a motion which never comes back cannot be followed.

    Returns
    -------
    Lap or None
        ``None`` with several inputs or a length as input, if all inputs are near, or if the
        motion does not come back to its beginning while the input turns on.
    """
    inputs = drive.model.equations.inputs
    if len(inputs) != 1 or inputs[0].kind != "angle":
        return None
    asked = max(np.ptp(t), np.abs(t - begin.t).max()) / FULL_TURN
    if not asked > _FAR:
        return None
    if asked > _MOST_COUNTED:
        raise InputError(
            f"{inputs[0].name} is asked for {asked:.4g} turns from the guess: beyond 1e15 turns a "
            "number says nothing about the angle; leave out whole turns"
        )
    here = begin
    for turns in range(1, int(min(asked, _MOST_TURNS)) + 1):
        nodes, end = follow(drive.solver, drive.path, here, begin.t + turns * FULL_TURN)
        if end is not None:
            return None
        if not nodes:  # a turn is less than the rounding of this angle
            break
        here = nodes[-1]
        gained = _gained(drive, begin.v, here.v)
        if same_position(drive.leads, begin.v, here.v, gained):
            return Lap(drive=drive, begin=begin, end=here, turns=turns, gained=gained)
    if asked > _MOST_FOLLOWED:
        raise InputError(
            f"{inputs[0].name} is asked for {asked:.4g} turns from the guess, and the motion does "
            f"not repeat itself within {_MOST_TURNS} turns: at most {_MOST_FOLLOWED:,} turns are "
            "followed; start from a guess nearer to the values asked for"
        )
    return None


def _gained(drive: Drive, begin: Array, end: Array) -> Array:
    """Whole turns of angles (N,) on the way between two positions, and what lengths gain by them.

    A wheel that rolls on gains the same length with every turn: a straight equation says how much,
    in units of 2π.
    """
    leads = drive.leads
    gained = whole_turns(leads, begin, end)
    known = leads.is_angle.copy()
    straight = leads.table.straight_parts
    for _ in straight:  # a length may follow from another one
        for weights in straight:
            free = np.flatnonzero((weights != 0.0) & ~known)
            if len(free) == 1:
                gained[free] = -(weights @ gained) / weights[free]
                known[free] = True
    return gained


# ----------------------------------------------------------------------
# The cycle of a design, started from the cycle of a neighbouring design.


_STEPS = 8  # of Newton-Raphson; a neighbour needs three or four
_NEAR = 0.2  # rad, or of the longest link: the largest change of a row from one design to the next
_NEAR_FOLD = 0.6  # the same from a parabola, near a dead point
_GROWTH = 12  # rows by which a dead point may recede from one design to the next
_SAME_DIRECTION = 1e-9  # rad: a table over a whole turn ends where it begins


def warm_started(model: Model, before: Motion) -> Motion | None:
    """The positions of a design from those of a neighbour, all rows at once.

    Newton-Raphson starts every row from the neighbour's. Where dead points bound the motion, rows
    are lost or won near them one by one. Nothing is proved, and where a dead point lies is only
    estimated.

    Parameters
    ----------
    before : Motion
        The cycle of a design whose numbers differ a little.

    Returns
    -------
    Motion or None
        ``None`` where the branch has to be followed anew: the neighbour's cycle has another
        table or ends at more than dead points, rows move far, or dead points do.
    """
    check_class("the neighbour", before, Motion)
    asked = before.asked
    q, found = before.q[asked], before.found[asked]
    rows, solver = model.rows, model.compiled.solver
    fits = q.shape == (len(rows), solver.unknowns) and found.any()
    if not fits or any(limit.kind is not LimitKind.DEAD_POINT for limit in before.limits):
        return None
    work = _Renewal(model, np.concatenate([q, rows], axis=1))
    work.correct(found)
    limits: tuple[Limit, ...] = ()
    if not (work.found.all() and work.has_one_sign):
        ends = work.bound()
        if ends is None:
            return None
        limits = tuple(work.limit(*end) for end in ends)
    names = [name for name, ok in zip(before.branch, before.found, strict=True) if ok]
    lost = int((~work.found).sum())
    message = f"{lost} of {len(rows)} positions were not found" if lost else Status.CONVERGED.value
    none_added = np.zeros(len(rows), dtype=bool)
    motion = motion_of_rows(model, work.solve(names[0]), message, none_added)
    return replace(motion, limits=limits)


@dataclass(frozen=True)
class _Fold:
    """Unknowns (n,) near a dead point as a parabola over the one that moves fastest, x.

    From x' = a, x'' = b by the input u follow du/dx = 1/a and d²u/dx² = -b/a³: the input turns
    back where dx = a²/b, du = a/2b.
    """

    first: Array
    second: Array

    @property
    def _fastest(self) -> tuple[float, float]:
        k = int(np.argmax(np.abs(self.first)))
        return float(self.first[k]), float(self.second[k])

    @property
    def distance(self) -> float:
        """How far away the input turns back, negative backwards; infinite where it does not."""
        a, b = self._fastest
        return a / (2.0 * b) if b else math.inf

    def moved(self, step: float) -> Array:
        """By how much the unknowns change with the input; at most as far as to the dead point."""
        a, b = self._fastest
        # without a second derivative there is no parabola: straight on
        if not a or not b:
            return step * self.first
        # the root of u(dx) = step that vanishes with the step, cut off at the dead point
        dx = a * a / b * (1.0 - math.sqrt(max(0.0, 1.0 - 2.0 * b * step / a)))
        bend = (self.second * a - self.first * b) / a**3
        return np.asarray(self.first / a * dx + 0.5 * bend * dx * dx)


@dataclass
class _Renewal:
    """Rows on their way to a new design: v (B, N), and which of them are found (B,)."""

    model: Model
    v: Array

    def __post_init__(self) -> None:
        count, solver = len(self.v), self.model.compiled.solver
        self.rate = input_rate(self.model)
        self.found: BoolArray = np.zeros(count, dtype=bool)
        self.first, self.second = np.full_like(self.v, np.nan), np.full_like(self.v, np.nan)
        self.iterations = np.zeros(count, dtype=np.int64)
        self.residual, self.condition = np.full(count, np.nan), np.full(count, np.inf)
        self.orientation = np.zeros((count, len(solver.blocks)), dtype=np.int8)

    @property
    def has_one_sign(self) -> bool:
        """Whether det J has one sign, and is not zero, over all rows that are found."""
        signs = self.orientation[self.found]
        return bool(signs.all() and (signs == signs[:1]).all())

    def correct(self, rows: BoolArray, near: float = _NEAR) -> None:
        """Newton-Raphson at some rows, from where they are; found are those that stay near."""
        solver = self.model.compiled.solver
        here = np.flatnonzero(rows)
        options = replace(solver.options, max_steps=_STEPS, largest_turn=math.inf)
        done = solver.solve(self.v[here], options)
        moved = np.abs((done.v - self.v[here]) / solver.variable_scale).max(axis=1)
        # a row that moves far has probably found another configuration
        good = (done.status == Status.CONVERGED.code) & (moved <= near)
        here = here[good]
        self.found[here] = True
        self.v[here] = done.v[good]
        self.iterations[here], self.residual[here] = done.iterations[good], done.residual[good]
        rates = solver.rates(self.v[here], self.rate)
        self.first[here], self.second[here] = rates.first, rates.second
        self.condition[here], self.orientation[here] = rates.condition, rates.orientation

    def bound(self) -> list[tuple[int, int]] | None:
        """Keep the rows that are connected with the start, and win those next to them.

        Returns
        -------
        list of (last row found, first row missing) or None
            The dead points; ``None`` if the connected rows cannot be found.
        """
        model = self.model
        start = first_position(model, model.start_inputs, NewtonOptions(), explained=False)
        origin = self._row_of_start()
        if not start.status.ok or origin is None:
            return None
        sign = model.compiled.solver.rates(start.v[None, :], self.rate).orientation[0]
        # rows on the other side of a dead point belong to another branch
        self.found &= (self.orientation == sign).all(axis=1)
        if not self.found[origin]:
            return None
        reached = np.zeros_like(self.found)
        reached[origin] = True
        ends = []
        for way in (-1, 1):
            last, won = origin, 0
            while (ahead := self._next(last, way)) not in (None, origin):
                if not self.found[ahead]:
                    # a dead point that recedes so far is better found by following the branch
                    if won == _GROWTH:
                        return None
                    if not self._win_row(last, ahead, sign):
                        ends.append((last, ahead))
                        break
                    won += 1
                last = ahead
                reached[last] = True
        self.found &= reached
        return ends

    @cached_property
    def _around(self) -> bool:
        """Whether the table leads once around, to where it began."""
        span = abs(float(np.ptp(self.model.rows[:, 0])))
        return abs(span - FULL_TURN) < _SAME_DIRECTION and turns_freely(self.model)

    def _row_of_start(self) -> int | None:
        """The row nearest to the start's own input; ``None`` if the table does not lead by it."""
        if len(self.rate) != 1:
            return None
        away = self.model.rows[:, 0] - self.model.start_inputs[0]
        if self._around:
            away = np.remainder(away + FULL_TURN / 2, FULL_TURN) - FULL_TURN / 2
        elif turns_freely(self.model) or away.min() > 0.0 or away.max() < 0.0:
            return None
        return int(np.argmin(np.abs(away)))

    def _next(self, row: int, way: int) -> int | None:
        ahead = row + way
        if 0 <= ahead < len(self.v):
            return ahead
        return ahead % len(self.v) if self._around else None

    def _win_row(self, last: int, ahead: int, sign: StatusArray) -> bool:
        """Whether a row is found from its neighbour."""
        n = self.model.compiled.solver.unknowns
        step = self.model.rows[ahead, 0] - self.model.rows[last, 0]
        step = 0.0 if abs(ahead - last) > 1 else step  # around: the same place
        self.v[ahead, :n] = self.v[last, :n] + self._fold(last).moved(step)
        alone = np.zeros_like(self.found)
        alone[ahead] = True
        self.correct(alone, _NEAR_FOLD)
        self.found[ahead] &= (self.orientation[ahead] == sign).all()
        return bool(self.found[ahead])

    def _fold(self, row: int) -> _Fold:
        n = self.model.compiled.solver.unknowns
        return _Fold(self.first[row, :n], self.second[row, :n])

    def limit(self, last: int, ahead: int) -> Limit:
        """The dead point between two rows, estimated."""
        t = self.model.rows_in_file_units[:, 0]
        here, step = float(t[last]), float(t[1] - t[0])
        upwards = (ahead > last) == (abs(ahead - last) == 1)  # not so around the table's end
        beyond = here + (step if upwards else -step)
        place = here + self._fold(last).distance / float(self.model.input_scale[0])
        # the parabola is only an estimate: the limit lies between the two rows in any case
        if not min(here, beyond) < place < max(here, beyond):
            place = 0.5 * (here + beyond)
        return Limit(
            kind=LimitKind.DEAD_POINT,
            input=place,
            bracket=(here, beyond),
            located=False,
            status=Status.OUT_OF_REACH,
        )

    def solve(self, branch: str) -> SolvedRows:
        """The rows with their rates and evidence."""
        here = np.flatnonzero(self.found)
        blank = SolvedRows.blank(
            self.model.rows_in_file_units, self.v.shape[1], Status.OUT_OF_REACH
        )
        return blank.set(
            here,
            v=self.v[here],
            first=self.first[here],
            second=self.second[here],
            status=Status.CONVERGED.code,
            iterations=self.iterations[here],
            residual=self.residual[here],
            condition=self.condition[here],
            certification=Certification.NOT_ASKED.code,
            branch=branch,
        )
