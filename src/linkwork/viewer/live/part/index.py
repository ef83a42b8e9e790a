"""The index of drawn parts: each has a module of the same name, but for those with other tools."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from linkwork.foundation.errors import InputError, choices
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.part.index import PARTS, part_module
from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.file_state import Pick
from linkwork.viewer.live.moving_points import Before
from linkwork.viewer.live.part_requests import DrawPart
from linkwork.viewer.live.requests import Edit

__all__ = ["edits_of_drawing", "picks_of"]


def picks_of(table: str) -> tuple[Pick, ...]:
    """What the tool of a kind of part lets a person pick; nothing if it has another tool."""
    module = _module(PARTS[table]) if table in PARTS else None
    return () if module is None else module.PICKS


def edits_of_drawing(drawn: DrawPart, before: Before) -> tuple[Edit, ...]:
    """The points, links and parts that a drawn part adds.

    Raises
    ------
    InputError, UnknownNameError
        If what was picked does not make such a part; with the reason.
    """
    wanted, count = picks_of(drawn.table), len(drawn.picks)
    if not wanted:
        tables = [table for table in PARTS if picks_of(table)]
        raise InputError(f"this part cannot be drawn {choices('parts', tables, drawn.table)}")
    if not (count == len(wanted) or (wanted[-1].repeated and count > len(wanted))):
        raise InputError(f"this part needs {len(wanted)} picks, got {count}")
    if not drawn.span > 0:
        raise InputError(f"span: must be positive, got {drawn.span:g}")
    if not isinstance(before.description, Draft):
        raise InputError("the points of this file follow from its equations: edit its text")
    sheet = DrawnSheet(before, drawn)
    module = _module(PARTS[drawn.table])
    assert module is not None
    module.draw(sheet, *drawn.picks)
    return tuple(sheet.edits)


def _module(kind: type) -> ModuleType | None:
    name = f"{__package__}.{part_module(kind)}"
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        return None
