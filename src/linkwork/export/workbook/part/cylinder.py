"""Cylinders push along their axis; those that are not driven transmit no force."""

from __future__ import annotations

from linkwork.export.workbook.acting import Act, Reading, Unknown, minus
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.part.cylinder import Cylinder

__all__ = ["drive"]


def drive(cylinder: Cylinder, reactions: Reactions, effort: str) -> None:
    """The force that pushes the ends apart, and what its pins exert on the cylinder."""
    along = reactions.along[cylinder.name]
    start, end = cylinder.between
    acts = (
        Act(reactions.joined[end][0], end, *along),
        Act(reactions.joined[start][0], start, minus(along[0]), minus(along[1])),
    )
    reactions.unknowns.append(Unknown(effort, reactions.force, acts))
    for point, sign in ((start, ""), (end, "-")):
        names = reactions.carriers[point]
        # the force on the link named later is read: on the other one it is the opposite
        if len(names) == 2 and names[-1] != cylinder.name:
            continue
        stem = reactions.stem(point, "force", cylinder.name)
        for axis, own in zip("xy", along, strict=True):
            reading = Reading(
                f"{stem}.{axis}", reactions.force, f"{sign}a*w", (effort,), {"w": own}
            )
            reactions.readings.append(reading)
