"""All reactions of a linkage: of its pins, of every part, and the efforts of the inputs."""

from __future__ import annotations

from linkwork.export.workbook.part.index import function_of
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.forces.drives import effort_name
from linkwork.foundation.names import GROUND

__all__ = ["join_links"]


def join_links(reactions: Reactions) -> None:
    """Add the reactions of the parts, then the efforts."""
    linkage = reactions.linkage
    for part in linkage.parts:
        function_of(part, "write")(part, reactions)
    for which in linkage.inputs:
        (kind, name), effort = which.drives, effort_name(which.column)
        if kind in ("slider", "cylinder"):
            part = next(own for own in linkage.parts if own.drive and own.label == name)
            function_of(part, "drive")(part, reactions, effort)
            continue
        on, against = name, which.relative_to or GROUND
        if kind == "joint":
            # as the equations drive it: the later link, or the one that is not ground
            against, on = linkage.bodies_at(name)
            if on == GROUND:
                on, against = against, on
        reactions.couple(effort, on, against)
