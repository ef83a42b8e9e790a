"""Following a mechanism's branch over a range of input values."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
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
)


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
