"""Copy or mirror points and links of a mechanism file, with what belongs to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from linkwork.foundation.errors import InputError
from linkwork.foundation.file_keys import ListOf
from linkwork.foundation.names import GROUND, canonical, free_name
from linkwork.mechanism.part.index import PARTS
from linkwork.mechanism.part.load import Load
from linkwork.textfile.entries import entries
from linkwork.textfile.renaming import names_in_file
from linkwork.textfile.text_edits import TextEdits

__all__ = ["copy_selection", "mirror_numbers"]

#: Numbers of parts that change sign in a mirror.
_TURNED = ("offset", "angle", "phase")


def copy_selection(edits: TextEdits, names: Mapping[str, str], *, mirrored: bool) -> None:
    """Copy links, dimensions and parts between points and links that have copies.

    Parameters
    ----------
    edits : TextEdits
        The text, with the new points in it.
    names : Mapping
        The names of the copies by those of points and links; a point that is its own copy is
        shared.
    mirrored : bool
        Whether angles change sign.

    Raises
    ------
    InputError
        If a name is taken, or a part cannot be mirrored.
    """
    new = {canonical(name): copy for name, copy in names.items()}
    for link in edits.keys(("links",)):
        points = edits.names(("links", link))
        if link == GROUND:
            added = [new[p] for p in map(canonical, points) if new.get(p) not in (None, *points)]
            if added:
                edits.put(("links", GROUND), [*points, *added])
        elif canonical(link) in new:
            copied = [new.get(canonical(point), point) for point in points]
            edits.put(("links", new[canonical(link)]), copied)
    for table in ("lengths", "angles"):
        _copy_dimensions(edits, table, new, mirrored)
    _copy_masses(edits, new, mirrored)
    _copy_parts(edits, new, mirrored)
    if traced := edits.names(("trace", "points")):
        copies = [new[p] for p in map(canonical, traced) if new.get(p) not in (None, *traced)]
        edits.put(("trace", "points"), [*traced, *copies])


def mirror_numbers(edits: TextEdits, points: set[str]) -> None:
    """Change the sign of angles and offsets between points that are mirrored together.

    Raises
    ------
    InputError
        If a part between them cannot be mirrored.
    """
    for key in edits.keys(("angles",)):
        if set(map(canonical, key.split())) <= points:
            edits.put(("angles", key), _opposite(edits.get(("angles", key))))
    links = {
        canonical(link)
        for link in edits.keys(("links",))
        if set(map(canonical, edits.names(("links", link)))) <= points
    }
    within = points | links
    for table in PARTS:
        for k, row in edits.entries(table):
            if all(name in within for _, name in _references(table, row)):
                within.add(canonical(str(row.get("name", ""))))
                for key, number in _mirrored(table, row).items():
                    edits.put((table, k, key), number)


def _copy_dimensions(edits: TextEdits, table: str, new: Mapping[str, str], mirrored: bool) -> None:
    links = [set(map(canonical, edits.names(("links", link)))) for link in edits.keys(("links",))]
    for key in edits.keys((table,)):
        words = key.split()
        copied = [new.get(canonical(word), word) for word in words]
        together = any(set(map(canonical, copied)) <= points for points in links)
        if copied != words and together and not edits.has((table, " ".join(copied))):
            number = edits.get((table, key))
            turned = mirrored and table == "angles"
            edits.put((table, " ".join(copied)), _opposite(number) if turned else number)


def _copy_masses(edits: TextEdits, new: Mapping[str, str], mirrored: bool) -> None:
    for link in edits.keys(("masses",)):
        if new.get(canonical(link)) not in (None, link):
            mass = edits.get(("masses", link))
            if mirrored and edits.has(("masses", link, "center", 1)):
                along, across, *_ = mass["center"]
                mass = {**mass, "center": [along, _opposite(across)]}
            edits.put(("masses", new[canonical(link)]), mass)


def _copy_parts(edits: TextEdits, new: Mapping[str, str], mirrored: bool) -> None:
    known = {**new, canonical(GROUND): GROUND}
    taken = set(names_in_file(edits))
    for table in PARTS:
        for _, row in list(edits.entries(table)):
            refers = list(_references(table, row))
            if not all(name in known for _, name in refers):
                continue
            if all(known[name] == name for _, name in refers):
                continue  # between shared points only
            copy = {**row, **(_mirrored(table, row) if mirrored else {})}
            for key in PARTS[table].keys:
                for entry in entries({key.name: row[key.name]}, (key,)) if key.name in row else ():
                    if not entry.of:
                        continue
                    name = known[canonical(str(entry.given))]
                    if isinstance(copy[key.name], list):
                        copy[key.name] = [*copy[key.name]]
                        copy[key.name][int(entry.path[1])] = name
                    else:
                        copy[key.name] = name
            if "name" in row:
                copy["name"] = free_name(str(row["name"]), taken)
                known[canonical(str(row["name"]))] = copy["name"]
            edits.append(table, copy)
    _copy_friction(edits, known)


def _copy_friction(edits: TextEdits, new: Mapping[str, str]) -> None:
    """The friction of copied parts, and of copied points that are pins again."""
    carried = [point for link in edits.keys(("links",)) for point in edits.names(("links", link))]
    for name in edits.keys(("friction",)):
        copy = new.get(canonical(name), name)
        if copy != name and carried.count(copy) != 1:
            edits.put(("friction", copy), edits.get(("friction", name)))


def _references(table: str, row: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What a part refers to: kinds and canonical names."""
    for entry in entries(row, PARTS[table].keys):
        if entry.of:
            yield entry.of, canonical(str(entry.given))


def _mirrored(table: str, row: Mapping[str, Any]) -> dict[str, Any]:
    """The numbers of a part that change sign."""
    keys = PARTS[table].keys
    shaped = any(isinstance(key.kind, ListOf) and isinstance(key.kind.of, ListOf) for key in keys)
    if shaped or PARTS[table] is Load:
        raise InputError(
            f'"{row.get("name", row.get("point", row.get("link")))}" '
            f"({PARTS[table].title.lower()}) cannot be mirrored: its shape has a sense; duplicate "
            "without it, or move its points"
        )
    return {key: _opposite(row[key]) for key in _TURNED if key in row}


def _opposite(entry: Any) -> Any:
    """A number or formula with the other sign; what is neither stays, a problem of the file."""
    if isinstance(entry, str):
        return f"-({entry})"
    return 0 - entry if isinstance(entry, int | float) else entry
