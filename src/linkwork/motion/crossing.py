"""Continue beyond change points by a policy: straight on, or onto the other branch."""

from __future__ import annotations

from linkwork.foundation.policy import ChangePointPolicy
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd, end_at_change_point
from linkwork.numerics.continuation.passage import Passage, pass_change_points

__all__ = ["beyond_change_point", "ends_passed"]


def beyond_change_point(drive: Drive, end: BranchEnd, policy: ChangePointPolicy) -> Passage | None:
    """The way across the change point at the end of a branch, and others right behind it.

    ``None`` if the chosen branch keeps the input, or a loop is not known to be on it.
    """
    if policy is not ChangePointPolicy.TURN or not end.crossings:
        return end.passage
    return pass_change_points(drive.solver, drive.path, end.nodes, end.t, end.side, turn=True)


def ends_passed(drive: Drive, end: BranchEnd, passage: Passage, certify: bool) -> list[BranchEnd]:
    """The change points on a way, the first one of which is the end of a branch."""
    return [
        end,
        *(
            end_at_change_point(drive, group, *passage.position(group[0].t), end.side, certify)
            for group in passage.crossings[1:]
        ),
    ]
