"""Beyond a change point on the branch that was chosen: straight on, or the one that crosses."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from linkwork.foundation.policy import ChangePointPolicy
from linkwork.foundation.status import Status
from linkwork.motion.drive import Drive
from linkwork.numerics.change_point import ChangePoint
from linkwork.numerics.track import Node, node_at

__all__ = ["beyond_change_point"]

_STRIDES = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4)  # natural sizes of the input, tried in this order
_CLOSER = 0.1  # a position belongs to a tangent it is so many times nearer to than to the other
_REGULAR = 1e5  # condition from which on branches are as good as crossing


def beyond_change_point(
    drive: Drive, crossing: ChangePoint, side: float, policy: ChangePointPolicy
) -> Node | None:
    """A position just beyond a change point on the chosen branch.

    Newton-Raphson starts on the tangent; the position found counts only if it lies much nearer to
    that tangent than to the other one. ``None`` if the branch keeps the input, or is not found.
    """
    solver, path = drive.solver, drive.path
    chosen, other = crossing.onward, crossing.other
    if policy is ChangePointPolicy.TURN:
        chosen, other = other, chosen
    taking_part = np.isfinite(crossing.onward[: solver.unknowns])
    if not np.isfinite(chosen[: solver.unknowns][taking_part]).all():
        return None
    mine = np.flatnonzero(taking_part)
    weights = solver.variable_scale[mine]
    apart = float(np.abs((chosen - other)[mine] / weights).max())
    for stride in _STRIDES:
        h = side * stride * path.size
        guess = crossing.v.copy()
        guess[mine] += h * chosen[mine]
        guess[solver.unknowns :] = path.at(crossing.t + h)
        done = solver.solve(guess[None, :], replace(solver.options, largest_turn=math.inf))
        if done.status[0] != Status.CONVERGED.code:
            continue
        off = float(np.abs((done.v[0] - guess)[mine] / weights).max())
        gap = abs(h) * apart if np.isfinite(apart) else abs(h)
        node = node_at(solver, path, crossing.t + h, done.v[0])
        if off <= _CLOSER * gap and node.nearness < _REGULAR:
            return node
    return None
