"""Positions between the rows of a motion, on its branch."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.status import Status
from linkwork.motion.drive import Drive
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import RowValues
from linkwork.numerics.continuation.branch_tracking import Track, node_at, rows_on_track
from linkwork.results.motion import Motion

__all__ = ["between_rows"]

_NODES = 720  # of longer tables not all rows are needed


def between_rows(model: Model, motion: Motion) -> Callable[[Array], RowValues]:
    """A function of the leading input (B,), in radians or lengths, between two rows of a motion.

    All rows must have positions. A place that its neighbours do not lead to has none.
    """
    values = [np.asarray(motion.inputs[v.name]) for v in model.equations.inputs]
    inputs = np.column_stack(values) * model.input_scale
    lead, rate = leading_input(model.rows)
    drive = Drive.through(model, inputs[0], rate, lead)
    order = np.argsort(inputs[:, lead], kind="stable")
    kept = order[np.unique(np.linspace(0, len(order) - 1, _NODES).astype(np.intp))]
    v, solver, path = np.hstack([motion.q, inputs]), drive.solver, drive.path
    nodes = (node_at(solver, path, float(inputs[k, lead]), v[k]) for k in kept)
    track = Track(nodes=tuple(nodes), start=0)

    def at(t: Array) -> RowValues:
        rows = rows_on_track(solver, path, track, t)
        good = rows.status == Status.CONVERGED.code
        return RowValues(model, rows.v, rows.first, rows.second, good)

    return at
