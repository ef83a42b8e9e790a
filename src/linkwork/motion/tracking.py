"""Following a mechanism's branch over a range of input values."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from linkwork.motion.model import Model
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import (
    InputPath,
    Node,
    Track,
    TrackOptions,
    follow,
)

__all__ = ["leading_scale", "track_to", "turns_freely"]


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
