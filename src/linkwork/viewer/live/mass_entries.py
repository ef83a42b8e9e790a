"""Masses of links as they are typed, and what is removed with links, points and parts."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.foundation.errors import UnknownNameError, choices
from linkwork.foundation.names import GROUND, canonical
from linkwork.mechanism.description import Description
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.textfile.text_edits import TextEdits
from linkwork.viewer.live import requests as ask
from linkwork.viewer.live.file_state import MassShown

__all__ = ["drop_lost_loads", "masses_shown", "put_mass"]


def masses_shown(description: Description) -> Iterator[MassShown]:
    """The masses of all moving links, empty for those without."""
    if not isinstance(description, LoadedBodies):
        return
    for link in description.carried:
        if link == GROUND:
            continue
        own = description.masses.get(link)
        center = () if own is None or own.center is None else own.center
        x, y = map(str, center) if len(center) == 2 else ("", "")
        yield MassShown(
            link=link,
            mass="" if own is None else str(own.mass),
            x=x,
            y=y,
            inertia="" if own is None or own.shape is not None else str(own.inertia),
            rod=own is not None and own.shape is not None,
        )


def put_mass(edit: ask.SetMass, text: TextEdits) -> None:
    """Write or remove the mass of a link.

    Raises
    ------
    UnknownNameError
        If there is no such link.
    """
    links = {canonical(link): link for link in text.keys(("links",))}
    if canonical(edit.link) not in links:
        raise UnknownNameError(
            f'there is no link "{edit.link}" {choices("links", links.values(), edit.link)}'
        )
    link = links[canonical(edit.link)]
    before = next(
        (key for key in text.keys(("masses",)) if canonical(key) == canonical(link)), link
    )
    if edit.mass is None:
        if text.has(("masses", before)):
            text.remove(("masses", before))
        return
    entry: dict[str, object] = {"mass": _plain(edit.mass)}
    if edit.x is not None or edit.y is not None:
        entry["center"] = [_plain(part or 0) for part in (edit.x, edit.y)]
    if edit.inertia is not None:
        entry["inertia"] = _plain(edit.inertia)
    if len(entry) == 1 and len(text.get(("links", link))) > 1:
        entry["shape"] = "rod"
    if not text.has(("masses", before)):
        text.put(("masses", before), entry)
        return
    # key by key: the row keeps its place and form
    for key in text.keys(("masses", before)):
        if key not in entry:
            text.remove(("masses", before, key))
    for key, own in entry.items():
        text.put(("masses", before, key), own)


def _plain(number: float | str) -> float | str:
    """A whole number without decimals."""
    whole = isinstance(number, float) and number.is_integer()
    return int(number) if whole else number


def drop_lost_loads(text: TextEdits, *names: str) -> None:
    """Remove masses, friction, loads and stops of links, points and parts that were removed."""
    lost = set(map(canonical, names))
    for table in ("masses", "friction"):
        for key in text.keys((table,)):
            if canonical(key) in lost:
                text.remove((table, key))
    for k, row in reversed(list(text.entries("loads"))):
        if any(canonical(str(row[key])) in lost for key in ("point", "link", "with") if key in row):
            text.remove(("loads", k))
    for k, row in reversed(list(text.entries("stops"))):
        if canonical(str(row.get("of", "")).split(".")[0]) in lost:
            text.remove(("stops", k))
