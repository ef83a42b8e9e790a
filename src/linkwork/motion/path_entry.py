"""Entering the path of a table: from the inputs of the guess to those of a row."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.motion.drive import Drive
from linkwork.motion.proving import way_is_proved
from linkwork.motion.start import Start
from linkwork.numerics.continuation.branch_tracking import InputPath, Node, follow, node_at

__all__ = ["enter_path"]

_ENTRIES = 24  # rows to which a start of several inputs is led, the nearest first, until one serves


def enter_path(drive: Drive, start: Start, t: Array, certify: bool) -> tuple[Node, bool] | None:
    """The start as a node of the table's path, and whether the way to it is proved.

    Several inputs are first led onto the path.
    """
    solver, path = drive.solver, drive.path
    own = drive.model.start_inputs
    here = float(own[drive.lead])
    # one input is always on its path; several may have a guess beside it
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
