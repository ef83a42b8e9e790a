"""List the entries of a mechanism file with their kinds, by the tables of its form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from linkwork.core.expression.grammar import RESERVED, parse, parse_equation
from linkwork.core.expression.tree import Name, names_in
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, canonical, free_name, is_name
from linkwork.core.foundation.values import (
    Formula,
    Key,
    Kind,
    ListOf,
    Named,
    NumberValue,
    Table,
    Tables,
    TablesOrFormula,
    Text,
)
from linkwork.core.mechanism.part.guides import Cylinder
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.springs import Load
from linkwork.core.textfile.keys import LOOPS, form_of
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import TextEdits

Path = tuple[str | int, ...]


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A number, formula, name or flag at a key path; ``row``: the outermost table that has it.

    ``of``: the kind of thing that a name in it refers to: point, link, slider or name.
    """

    path: Path
    kind: Kind
    given: Any
    row: Mapping[str, Any]
    of: str = ""


def entries(
    data: Mapping[str, Any],
    keys: tuple[Key, ...],
    path: Path = (),
    row: Mapping[str, Any] | None = None,
) -> Iterator[Entry]:
    """All entries of a table with these keys; entries of the wrong kind are left out."""
    for key in keys:
        if key.name in data:
            entry_path = (*path, key.name)
            yield from _inside(data[key.name], key.kind, entry_path, data if row is None else row)


def measured_by(kind: NumberValue, row: Mapping[str, Any]) -> str:
    """What a number in a row of a table measures: length, angle, number, or "" if unknown."""
    match kind.of:
        case "lift":
            return "angle" if "link" in row else "length"
        case "ranged" if "law" in row:
            return "number"
        case "driven" | "ranged":
            turns, slides = {"link", "joint"} & row.keys(), {"slider", "cylinder"} & row.keys()
            return "angle" if turns else "length" if slides else ""
        case "stiffness":
            return "length" if "links" in row else "per length"
        case "free":
            return "angle" if "links" in row else "length"
        case "named" | "varied":
            return ""
        case of:
            return of


def _inside(content: Any, kind: Kind, path: Path, row: Mapping[str, Any]) -> Iterator[Entry]:
    match kind:
        case Table(keys) if isinstance(content, Mapping):
            yield from entries(content, keys, path, content if len(path) == 1 else row)
        case Tables(keys) if isinstance(content, Mapping):
            yield from entries(content, keys, path, content)
        case TablesOrFormula() if isinstance(content, str):
            yield Entry(path=path, kind=Formula(), given=content, row=row)
        case Tables(keys) | TablesOrFormula(keys) if isinstance(content, list):
            for k, each in enumerate(content):
                if isinstance(each, Mapping):
                    yield from entries(each, keys, (*path, k), each if len(path) == 1 else row)
        case Named(of) if isinstance(content, Mapping):
            for name, each in content.items():
                yield from _inside(each, of, (*path, name), row)
        case ListOf(of, noun) if isinstance(content, list):
            for k, each in enumerate(content):
                for entry in _inside(each, of, (*path, k), row):
                    named = isinstance(entry.kind, Text) and not entry.of
                    yield replace(entry, of=noun) if named else entry
        case _:
            means = kind.of if isinstance(kind, Text) else ""
            yield Entry(path=path, kind=kind, given=content, row=row, of=means)


# ----------------------------------------------------------------------
# Rename a point, link or part of a mechanism file with all its references.


#: Tables whose keys consist of names of points.
_OF_POINTS = ("points", "lengths", "angles", "clearances", "tolerances")


def names_in_file(edits: TextEdits) -> dict[str, str]:
    """Every name of a file in its canonical form, with the noun of its thing."""
    names: dict[str, str] = {}
    for table, noun in (
        ("points", "point"), ("links", "link"), ("dimensions", "dimension"), ("outputs", "output"),
        ("guess", "unknown"),
    ):  # fmt: skip
        names |= {canonical(name): noun for name in edits.keys((table,))}
    for table, kind in PARTS.items():
        for _, row in edits.entries(table):
            if "name" in row:
                names[canonical(str(row["name"]))] = kind.title.lower()
    return names


def rename(edits: TextEdits, of: str, name: str, new: str) -> None:
    """Give a point, link or part another name wherever the file refers to it.

    Parameters
    ----------
    edits : TextEdits
        The text of a mechanism file.
    of : str
        point, link or part.
    name, new : str
        The present name and the new one.

    Raises
    ------
    InputError, UnknownNameError
        If there is nothing of this name, or the new one is taken or is not a name.

    Examples
    --------
    >>> edits = TextEdits('[points]\\nA = [0, 0]\\n[outputs]\\nx = "2*A.x"')
    >>> rename(edits, "point", "A", "Q")
    >>> print(edits.text)
    [points]
    Q = [0, 0]
    [outputs]
    x = "2*Q.x"
    """
    _check(edits, of, name, new)
    folded = canonical(name)
    data = data_of(edits.text, "the text")
    form = form_of(data)
    pairs = _names_in_formulas(of, name, new)
    for entry in entries(data, form.keys):
        # formulas of other numbers contain named dimensions only
        load = isinstance(entry.kind, NumberValue) and entry.path[0] == "loads"
        if (isinstance(entry.kind, Formula) or load) and isinstance(entry.given, str):
            whole = of != "point" or (form is LOOPS and entry.path[0] == "points")
            text = _renamed(entry.given, pairs, whole=whole, load=load)
            if text != entry.given:
                edits.put(entry.path, text)
        elif entry.path[0] == "stops" and entry.path[-1] == "of":
            base, dot, rest = str(entry.given).partition(".")
            # a coordinate is of a point, all else of a link or part
            if canonical(base) == folded and bool(dot) == (of == "point"):
                edits.put(entry.path, f"{new}{dot}{rest}")
        elif _refers(entry, of) and canonical(str(entry.given)) == folded:
            edits.put(entry.path, new)
    for path, key in _keys(edits, of, folded, new):
        edits.rename(path, key)


def _check(edits: TextEdits, of: str, name: str, new: str) -> None:
    if of not in ("point", "link", "part"):
        raise InputError(f'"{of}" has no name to change: choose a point, link or part')
    known = names_in_file(edits)
    nouns = {"point": {"point"}, "link": {"link"}}.get(of)
    noun = known.get(canonical(name))
    if noun is None or (nouns is not None and noun not in nouns):
        of_kind = [word for word, noun in known.items() if nouns is None or noun in nouns]
        raise UnknownNameError(f'there is no {of} "{name}" {choices(f"{of}s", of_kind, name)}')
    if canonical(name) == GROUND:
        raise InputError(f'"{GROUND}" is the name of the fixed link in every file')
    folded = canonical(new)
    if not is_name(new) or folded in (*RESERVED, GROUND):
        raise InputError(
            f'"{new}" cannot be a name: a name is a letter, then letters, digits, _ and \', and '
            "no word of formulas such as sin"
        )
    if folded in known and folded != canonical(name):
        raise InputError(f'"{new}" is the name of a {known[folded]} already: choose another')


def _refers(entry: Entry, of: str) -> bool:
    """Whether a text in the file names a point, a link or a part."""
    if of == "part":
        return entry.of == "slider" or (entry.path[0] in PARTS and entry.path[-1] == "name")
    return entry.of == of


def _keys(
    edits: TextEdits, of: str, folded: str, new: str
) -> Iterator[tuple[tuple[str, str], str]]:
    """Keys that contain the name, with the new keys."""
    tables = {
        "point": (*_OF_POINTS, "friction"), "link": ("links", "masses"),
        "part": ("friction", "tolerances"),
    }[of]  # fmt: skip
    for table in tables:
        for key in edits.keys((table,)):
            # "O4.x" and "d.offset" are numbers of a point and of a part
            words = [word.partition(".") for word in key.split()]
            if folded in (canonical(base) for base, _, _ in words):
                renamed = (
                    f"{new if canonical(base) == folded else base}{dot}{rest}"
                    for base, dot, rest in words
                )
                yield (table, key), " ".join(renamed)


def _names_in_formulas(of: str, name: str, new: str) -> dict[str, str]:
    """Names of results in formulas, by their new ones."""
    pairs = {canonical(name): new}
    if of == "part":
        old, other = (Cylinder(name=each, between=("", "")).angle_name for each in (name, new))
        pairs[canonical(old)] = other
    return pairs


def _renamed(formula: str, pairs: dict[str, str], *, whole: bool, load: bool) -> str:
    """A formula with other names; ``whole``: also without a coordinate behind them."""
    equation = "=" in formula and not load
    trees = parse_equation(formula) if equation else (parse(formula, comparing=load),)
    names: list[Name] = [node for tree in trees for node in names_in(tree)]
    text = formula
    for node in sorted(names, key=lambda node: -node.column):
        head, dot, _ = node.spelling.partition(".")
        new = pairs.get(canonical(head))
        if new is not None and (dot or whole):
            start = node.column - 1
            text = f"{text[:start]}{new}{text[start + len(head) :]}"
    return text


# ----------------------------------------------------------------------
# Copy or mirror points and links of a mechanism file, with their parts.


#: Numbers of parts that change sign in a mirror.
_TURNED = ("offset", "angle", "phase")


def copy_selection(edits: TextEdits, names: Mapping[str, str], *, mirrored: bool) -> None:
    """Copy links, dimensions and parts between points and links that have copies.

    Parameters
    ----------
    edits : TextEdits
        The text, with the new points in it.
    names : Mapping
        The names of the copies by those of points and links; a point that maps to itself is
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
            if within.issuperset(_references(table, row)):
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
            refers = _references(table, row)
            # not between shared points only
            if not known.keys() >= {*refers} or all(known[name] == name for name in refers):
                continue
            copy = {**row, **(_mirrored(table, row) if mirrored else {})}
            for entry in entries(row, PARTS[table].keys):
                if entry.of:
                    key, *place = str(entry.path[0]), *entry.path[1:]
                    name = known[canonical(str(entry.given))]
                    if place:
                        copy[key] = [*copy[key]]
                        copy[key][place[0]] = name
                    else:
                        copy[key] = name
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


def _references(table: str, row: Mapping[str, Any]) -> list[str]:
    """The canonical names to which a part refers."""
    listed = entries(row, PARTS[table].keys)
    return [canonical(str(entry.given)) for entry in listed if entry.of]


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
    """A number or formula with the other sign; anything else stays, as a problem of the file."""
    if isinstance(entry, str):
        return f"-({entry})"
    return 0 - entry if isinstance(entry, int | float) else entry
