"""Following a mechanism's branch over a range of input values."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from linkwork.motion.model import Model
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.track import InputPath, Node, Track, TrackOptions, follow

__all__ = ["leading_scale", "track_to", "turns_freely"]


def leading_scale(model: Model, lead: int) -> float:
    """The natural size of a step of the leading input: a radian, the longest link, or for a plain
    number a tenth of its table.
    """
    solver = model.compiled.solver
    if model.equations.inputs[lead].kind == "number":
        span = float(np.ptp(model.rows[:, lead]))
        return span / 10.0 or float(solver.variable_scale[solver.unknowns + lead])
    return float(solver.variable_scale[solver.unknowns + lead])


def turns_freely(model: Model) -> bool:
    """Whether adding a whole turn to the input changes nothing in the equations."""
    inputs = model.equations.inputs
    if len(inputs) != 1 or inputs[0].kind != "angle":
        return False
    if model.equations.linear and any(
        name == inputs[0].symbol and weight != round(weight)
        for equation in model.equations.linear
        for name, weight in equation.terms
    ):
        return False
    loops = model.compiled.table.loops
    mine = loops.phase_variable == len(model.equations.unknowns)
    weights = loops.phase_weight[mine]
    return bool(np.all(weights == np.round(weights)))


def track_to(
    solver: BlockSolver,
    path: InputPath,
    start: Node,
    goals: Iterable[float],
    options: TrackOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> Track:
    """The branch from ``start`` as far towards the smallest and largest goal as it goes.

    ``progress`` is told every value of t that was reached.
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
