"""Parts as they are typed on the page: every part of the library comes out as its file has it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import pytest

import linkwork as lw
from linkwork.app.live.file_state import PaletteField
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.palette import PALETTE, part_of
from linkwork.app.live.requests import Typed
from linkwork.core.mechanism.part.index import PARTS

MM = TypedUnits("mm", "deg")
FIELDS = {part.table: {field.name: field for field in part.fields} for part in PALETTE}
FILES = [file for file in (files("linkwork") / "library").iterdir() if file.name.endswith(".toml")]
ROWS = [
    pytest.param(table, row, id=f"{file.name} {table} {k}")
    for file in sorted(FILES, key=lambda file: file.name)
    for table in PARTS
    for k, row in enumerate(tomllib.loads(file.read_text("utf-8")).get(table, ()))
]


def typed(field: PaletteField, entry: Any) -> Typed:
    """An entry of a file as somebody would type it."""
    match field.entry:
        case "flag":
            return "true" if entry else "false"
        case "points" | "links" | "lengths":
            return tuple(entry)
        case "numbers":
            return (", ".join(map(str, entry)),)
        case "lines":
            return tuple(", ".join(map(str, _words(field, row))) for row in entry)
        case _:
            return str(entry)


def _words(field: PaletteField, row: Any) -> list[Any]:
    """A row of numbers, or of a table whose words have an order."""
    return [row[name] for name in field.named if name in row] if isinstance(row, Mapping) else row


def test_every_kind_of_part_has_its_fields() -> None:
    assert [part.table for part in PALETTE] == list(PARTS)
    assert {row.values[0] for row in ROWS} == set(PARTS)
    cam = FIELDS["cams"]
    assert cam["slider"].entry == "slider"
    assert cam["contact"].words == ("knife", "roller", "flat")
    assert cam["segments"].named == ("law", "over", "lift")
    assert cam["center"].entry == "point"
    assert not cam["base"].required


@pytest.mark.parametrize(("table", "row"), ROWS)
def test_a_part_of_the_library_is_typed_as_its_file_has_it(table: str, row: Any) -> None:
    entered = {name: typed(FIELDS[table][name], entry) for name, entry in row.items()}
    assert part_of(table, entered, MM) == row


def test_numbers_may_be_formulas_and_what_is_empty_is_left_out() -> None:
    entered: dict[str, Typed] = {
        "name": "c", "base": "r + 2", "radius": "", "start": "\u221230", "segments": (),
        "profile": ("1, 2", "", "3 4.5"), "slider": "s",
    }  # fmt: skip
    assert part_of("cams", entered, MM) == {
        "name": "c", "base": "r + 2", "start": -30, "profile": [[1, 2], [3, 4.5]], "slider": "s",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("table", "entered", "message"),
    [
        ("wheels", {}, 'there are no parts "wheels" (parts: '),
        ("gears", {"tooth": "3"}, '"tooth" is not a key of [[gears]] (keys: teeth, name, wheels'),
        ("gears", {"internal": "perhaps"}, 'internal: must be true or false, got "perhaps"'),
        ("gears", {"wheels": "a b"}, 'wheels: must be a list, got "a b"'),
        ("gears", {"name": ("a", "b")}, "name: is one entry, got a list"),
        ("cams", {"segments": ("dwell 90 0 5",)}, 'a line has law over lift, got "dwell 90 0 5"'),
    ],
)  # fmt: skip
def test_what_is_no_part_is_refused(table: str, entered: dict[str, Any], message: str) -> None:
    with pytest.raises(lw.InputError) as caught:
        part_of(table, entered, MM)
    assert message in str(caught.value)
