"""Forces as arrows at their points of application.

All arrows have the same scale, a round number of length units per unit of force; the longest is at
most :data:`~linkwork.drawing.point_arrows.LONGEST` of the drawn size. Several forces at one point
are drawn separately.
"""

from __future__ import annotations

from collections.abc import Sequence

from linkwork.drawing.annotation import Annotation, round_up
from linkwork.drawing.captions import printed_name
from linkwork.drawing.measures import Measures
from linkwork.drawing.point_arrows import LONGEST, ArrowLook, point_arrows, scale_caption
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Role
from linkwork.results.force import Force, check_forces, force_unit

__all__ = ["force_arrows"]

_LOOK = ArrowLook(role=Role.FORCE, name_role=Role.FORCE_NAME, letter="F")


def force_arrows(
    forces: Sequence[Force], pose: Pose, length_unit: str, measures: Measures
) -> Annotation:
    """Arrows of forces, their tails at the points.

    Raises
    ------
    UnknownNameError
        If a point does not exist.
    InputError
        If forces have different units.
    """
    check_forces(forces, pose.points)
    most = max(abs(complex(force.x, force.y)) for force in forces)
    if not most:
        return Annotation(caption="force: all are zero")
    scale = 1.0 / round_up(most / (LONGEST * measures.size))
    parts = []
    for force in forces:
        vector = {force.at: complex(force.x, force.y)}
        parts.append(point_arrows(vector, pose.points, scale, _LOOK, measures)[0])
    caption = scale_caption("force", scale, length_unit, force_unit(forces), measures.size)
    drawn = {primitive.of for part in parts for primitive in part.drawn}
    hidden_at = [force.at for force in forces if force.at not in drawn]
    if hidden_at:
        listed = ", ".join(map(printed_name, dict.fromkeys(hidden_at)))
        caption += f" (too short to draw: {listed})"
    return Annotation.joined([*parts, Annotation(caption=caption)])
