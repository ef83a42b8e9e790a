"""Welds: a moment, in addition to the force of the pin that their links share."""

from __future__ import annotations

from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.part.weld import Weld

__all__ = ["write"]


def write(weld: Weld, reactions: Reactions) -> None:
    """The moment on the link named later in the file."""
    links = reactions.linkage.links
    earlier, later = sorted(weld.links, key=list(links).index)
    point = next(point for point in links[earlier] if point in links[later])
    stem = point if len(reactions.joined[point]) == 2 else f"{point}.{later}"
    reactions.couple(f"{stem}.moment", later, earlier)
