"""Rename a point, link or part of a mechanism file with all its references."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.expression.grammar import RESERVED, parse, parse_equation
from linkwork.expression.tree import Name, names_in
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.file_keys import Formula, Number
from linkwork.foundation.names import GROUND, canonical, is_name
from linkwork.mechanism.part.cylinder import Cylinder
from linkwork.mechanism.part.index import PARTS
from linkwork.textfile.entries import Entry, entries
from linkwork.textfile.keys import LOOPS, form_of
from linkwork.textfile.text_edits import TextEdits
from linkwork.textfile.toml_text import data_of

__all__ = ["names_in_file", "rename"]

#: Tables whose keys consist of names of points.
_OF_POINTS = ("points", "lengths", "angles", "clearances", "tolerances")


def names_in_file(edits: TextEdits) -> dict[str, str]:
    """Every name that a file gives, in its canonical form, with what has it."""
    found: dict[str, str] = {}
    for table, noun in (
        ("points", "point"), ("links", "link"), ("dimensions", "dimension"), ("outputs", "output"),
        ("guess", "unknown"),
    ):  # fmt: skip
        found |= {canonical(name): noun for name in edits.keys((table,))}
    for table, kind in PARTS.items():
        for _, row in edits.entries(table):
            if "name" in row:
                found[canonical(str(row["name"]))] = kind.title.lower()
    return found


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
        load = isinstance(entry.kind, Number) and entry.path[0] == "loads"
        if (isinstance(entry.kind, Formula) or load) and isinstance(entry.given, str):
            whole = of != "point" or (form is LOOPS and entry.path[0] == "points")
            text = _renamed(entry.given, pairs, whole=whole, load=load)
            if text != entry.given:
                edits.put(entry.path, text)
        elif entry.path[0] == "stops" and entry.path[-1] == "of":
            own, dot, rest = str(entry.given).partition(".")
            # a coordinate is of a point, all else of a link or part
            if canonical(own) == folded and bool(dot) == (of == "point"):
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
        own = [word for word, noun in known.items() if nouns is None or noun in nouns]
        raise UnknownNameError(f'there is no {of} "{name}" {choices(f"{of}s", own, name)}')
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
            if folded in (canonical(own) for own, _, _ in words):
                renamed = (
                    f"{new if canonical(own) == folded else own}{dot}{rest}"
                    for own, dot, rest in words
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
    found: list[Name] = [node for tree in trees for node in names_in(tree)]
    text = formula
    for node in sorted(found, key=lambda node: -node.column):
        head, dot, _ = node.spelling.partition(".")
        new = pairs.get(canonical(head))
        if new is not None and (dot or whole):
            start = node.column - 1
            text = f"{text[:start]}{new}{text[start + len(head) :]}"
    return text
