"""Points and links as they are written in a text."""

from __future__ import annotations

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import canonical
from linkwork.textfile.text_edits import TextEdits

__all__ = [
    "add_entry",
    "carry",
    "check_point",
    "drop_loose_dimensions",
    "drop_lost_inputs",
    "points_of",
]


def check_point(text: TextEdits, name: str) -> str:
    """A point as it is spelled in the text; an error if there is none."""
    known = text.keys(("points",))
    for own in known:
        if canonical(own) == canonical(name):
            return own
    raise UnknownNameError(f'there is no point "{name}" {choices("points", known, name)}')


def add_entry(text: TextEdits, table: str, name: str, entry: object) -> None:
    """Add a named entry to a table; an error if the name is in it."""
    if text.has((table, name)):
        raise InputError(f'"{name}" is already in [{table}]: choose another name')
    text.put((table, name), entry)


def points_of(text: TextEdits, link: str) -> list[str]:
    """The points of a link; an error if there is none."""
    if not text.has(("links", link)):
        known = text.keys(("links",))
        raise UnknownNameError(f'there is no link "{link}" {choices("links", known, link)}')
    return text.names(("links", link))


def carry(text: TextEdits, link: str, point: str) -> None:
    """Add a point to a link; an error if the link carries it."""
    points = points_of(text, link)
    if canonical(point) in map(canonical, points):
        raise InputError(f'"{link}" carries "{point}" already')
    text.put(("links", link), [*points, point])


def drop_loose_dimensions(text: TextEdits) -> None:
    """Remove lengths and angles between points that are no longer on one link."""
    links = [{canonical(p) for p in points_of(text, link)} for link in text.keys(("links",))]
    for table in ("lengths", "angles"):
        for key in text.keys((table,)):
            if not any({canonical(p) for p in key.split()} <= points for points in links):
                text.remove((table, key))


def drop_lost_inputs(text: TextEdits, *names: str) -> None:
    """Remove inputs that drive something that was removed."""
    lost = set(map(canonical, names))
    driven = ("link", "slider", "cylinder", "relative_to")
    for k, row in reversed(list(text.entries("input"))):
        if any(canonical(str(row[key])) in lost for key in driven if key in row):
            text.remove(("input", k))
