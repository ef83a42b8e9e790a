"""The cycle of a design beside one whose cycle is known: while a dimension is being changed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.motion.positions import input_rate
from linkwork.motion.rows import SolvedRows
from linkwork.numerics.block_solver import BlockSolution, Rates
from linkwork.results.motion import Motion

__all__ = ["renewed"]

_STEPS = 8  # of Newton-Raphson; a neighbour needs three or four
_NEAR = 0.2  # rad, or of the longest link: what a row may move by from one design to the next


def renewed(model: Model, before: Motion) -> Motion | None:
    """The positions of a design from those of a neighbour, all rows at once.

    Newton-Raphson starts every row from the neighbour's. Nothing is proved, no limit is located.

    Parameters
    ----------
    before : Motion
        The cycle of a design whose numbers differ a little.

    Returns
    -------
    Motion or None
        ``None`` where only following the branch anew will do: the neighbour's cycle is not whole,
        a row does not converge or moves far, or det J has not one sign over all rows.
    """
    solver, rows = model.compiled.solver, model.rows
    if before.q.shape != (len(rows), solver.unknowns) or not before.found.all():
        return None
    start = np.concatenate([before.q, rows], axis=1)
    careful = replace(solver.options, max_steps=_STEPS, largest_turn=math.inf)
    found = solver.solve(start, careful)
    if (found.status != Status.CONVERGED.code).any():
        return None
    if (np.abs((found.v - start) / solver.variable_scale) > _NEAR).any():
        return None
    rates = solver.rates(found.v, input_rate(model))
    if (rates.orientation != rates.orientation[0]).any() or not rates.orientation.all():
        return None
    solved = _rows(model, before, found, rates)
    return motion_of_rows(model, solved, Status.CONVERGED.value, np.zeros(len(rows), dtype=bool))


def _rows(model: Model, before: Motion, found: BlockSolution, rates: Rates) -> SolvedRows:
    count = len(found.v)
    nothing: Array = np.full(count, np.nan)
    return SolvedRows(
        inputs=model.everyday_rows,
        v=found.v,
        first=rates.first,
        second=rates.second,
        status=found.status,
        iterations=found.iterations,
        residual=found.residual,
        condition=rates.condition,
        certification=np.full(count, Certification.NOT_ASKED.code, dtype=np.int8),
        radius=nothing,
        unique=nothing.copy(),
        branch=np.array(before.branch, dtype=object),
        limit=np.full(count, "", dtype=object),
    )
