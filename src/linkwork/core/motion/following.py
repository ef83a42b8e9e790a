"""Following a mechanism's branch over a range of input values."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.arrays import EPSILON, UNIT_ROUNDOFF, Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Certification
from linkwork.core.foundation.units import FULL_TURN, AngleUnit
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.motion.positions import way_is_proved
from linkwork.core.motion.solving import Start
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import (
    InputPath,
    Node,
    Track,
    TrackOptions,
    follow,
    node_at,
    same_position,
    whole_turns,
)
from linkwork.core.numerics.newton import SolvedRows


def leading_scale(model: Model, lead: int) -> float:
    """The natural size of a step of the leading input: a radian, the longest link, or for a plain
    number or time a tenth of the way over its table and its guess.
    """
    solver = model.compiled.solver
    if model.equations.inputs[lead].kind in ("number", "time"):
        # a plain number has no natural size, and a table of one row at the guess no span
        span = float(np.ptp([*model.rows[:, lead], model.start_inputs[lead]]))
        return span / 10.0 or float(solver.variable_scale[solver.unknowns + lead])
    return float(solver.variable_scale[solver.unknowns + lead])


def turns_freely(model: Model) -> bool:
    """Whether adding a whole turn to the input changes nothing but other angles by whole turns."""
    inputs = model.equations.inputs
    if len(inputs) != 1 or inputs[0].kind != "angle":
        return False
    table = model.compiled.table
    turns = np.zeros(table.variables)  # added to every variable by one turn of the input
    lead = len(model.equations.unknowns)
    turns[lead] = 1.0
    given = np.zeros(table.variables, dtype=bool)
    given[lead] = True
    for weights in table.straight_parts:
        left = float(weights @ turns)
        if not left:
            continue
        free = np.flatnonzero((weights != 0.0) & table.is_angle & ~given)
        # an angle that would turn by a fraction does not come back after one turn of the input
        whole = [k for k in free.tolist() if (left / weights[k]).is_integer()]
        if not whole:
            return False
        turns[whole[0]] = -left / weights[whole[0]]
        # later rows must not turn these angles otherwise
        given[weights != 0.0] = True
    return table.repeats_after(turns)


def track_to(
    solver: BlockSolver,
    path: InputPath,
    start: Node,
    goals: Iterable[float],
    options: TrackOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> Track:
    """The branch from ``start`` towards the smallest and the largest goal, or to its ends.

    ``progress`` is called with every value of t that is reached.
    """

    def tell(_: Node, after: Node) -> bool:
        if progress is not None:
            progress(after.t)
        return False

    goals = list(goals)
    low, high = min([*goals, start.t]), max([*goals, start.t])
    above, above_end = follow(solver, path, start, high, options, tell)
    below, below_end = follow(solver, path, start, low, options, tell)
    return Track(
        nodes=(*reversed(below), start, *above),
        start=len(below),
        below=below_end,
        above=above_end,
    )


# ----------------------------------------------------------------------
# The inputs of a mechanism, which move in lock-step along the leading one.


@dataclass(frozen=True, kw_only=True, eq=False)
class Drive:
    """``lead``: the number of the input whose value is the path's parameter t."""

    model: Model
    path: InputPath
    lead: int

    @classmethod
    def through(cls, model: Model, inputs: Array, rate: Array, lead: int) -> Drive:
        """The straight line through input values (p,); ``rate`` (p,) is 1 for the leading input."""
        path = InputPath(
            origin=inputs - rate * inputs[lead], rate=rate, size=leading_scale(model, lead)
        )
        return cls(model=model, path=path, lead=lead)

    @classmethod
    def along_table(cls, model: Model) -> Drive:
        """From the guess in the direction of the table's inputs."""
        lead, rate = leading_input(model.rows)
        return cls.through(model, model.start_inputs, rate, lead)

    @classmethod
    def of_circuits(cls, model: Model) -> Drive:
        """That of the mechanism's own input, whatever law of time drives it.

        Raises
        ------
        InputError
            If the mechanism has no input, or several that time drives.
        """
        if model.untimed is not None and len(model.untimed.equations.inputs) > 1:
            raise InputError("several inputs with laws have no common circuit: leave out the laws")
        return cls.along_table(model.untimed or model)

    @property
    def solver(self) -> BlockSolver:
        """Of the mechanism's equations."""
        return self.model.compiled.solver

    @cached_property
    def leads(self) -> ParametrizedTable:
        """The equations along the path, solvable with any variable in the lead."""
        compiled = self.model.compiled
        return ParametrizedTable(compiled.table, self.path, self.lead, compiled.leaders)

    @cached_property
    def free(self) -> bool:
        """Whether adding a whole turn to the input changes nothing."""
        return turns_freely(self.model)

    @property
    def unit(self) -> float:
        """Internal units per file unit of t."""
        return float(self.model.input_scale[self.lead])


# ----------------------------------------------------------------------
# Entering the path of a table: from the inputs of the guess to those of a row.


_ENTRIES = 24  # rows to which a start of several inputs is led, the nearest first, until one serves


def enter_path(drive: Drive, start: Start, t: Array, certify: bool) -> tuple[Node, bool] | None:
    """The start as a node of the table's path, and whether the way to it is proved.

    Several inputs are first led onto the path.
    """
    solver, path = drive.solver, drive.path
    own = drive.model.start_inputs
    here = float(own[drive.lead])
    # one input is always on its path; the guess of several may lie off it
    if np.allclose(path.at(here), own, rtol=0, atol=1e-12 * path.size):
        return node_at(solver, path, here, start.v), True
    weights = solver.variable_scale[solver.unknowns :]
    distance = np.abs((path.at(t) - own) / weights).max(axis=1)
    nearest = np.argsort(distance, kind="stable")
    # a straight way may be blocked by a limit: other rows are tried, some of them far away
    spread = np.linspace(0, len(t) - 1, min(len(t), _ENTRIES)).astype(np.intp)
    for row in (nearest[0], *nearest[spread[1:]]):
        entry = _lead_to_row(drive, start, float(t[row]), certify)
        if entry is not None:
            return entry
    return None


def _lead_to_row(drive: Drive, start: Start, t: float, certify: bool) -> tuple[Node, bool] | None:
    """The start led to one row of the table along the straight line between their inputs."""
    solver, path, own = drive.solver, drive.path, drive.model.start_inputs
    way = InputPath(origin=own, rate=path.at(t) - own)
    first = node_at(solver, way, 0.0, start.v)
    nodes, end = follow(solver, way, first, 1.0)
    if end is not None:
        return None
    entered = certify and way_is_proved(solver, way, [first, *nodes])
    return node_at(solver, path, t, nodes[-1].v), entered


# ----------------------------------------------------------------------
# Motions that repeat themselves after whole turns of the input: laps are left out.


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
