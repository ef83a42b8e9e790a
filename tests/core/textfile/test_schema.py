"""The JSON Schema accepts what the reader accepts, and refuses what has the wrong structure."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

import jsonschema
import pytest

from linkwork.core.foundation.errors import MechanismFileError
from linkwork.core.textfile import json_schema, read_text, schema_text, write_text
from tests.core.textfile.bad_files import CASES
from tests.core.textfile.samples import SAMPLES

VALIDATOR = jsonschema.Draft202012Validator(json_schema())
STRUCTURAL = [
    "unknown key of an input",
    "unknown table",
    "unknown key and a negative length together",
    "table of another form",
    "key of another form",
    "link without points",
    "boolean for a number",
    "slot with a line of one point",
    "slot without name",
    "slot as a plain table",
    "slider with three points",
    "unit of angles unknown",
    "angle key of two points",
    "length key of one point",
    "loops that are not text",
    "equations with a trace",
    "coordinate missing",
    "points as a list",
    "name that is no text",
    "file of comments",
    "format missing",
    "format of the future",
    "format as text",
]


def test_the_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(json_schema())


def test_the_published_copy_is_this_schema() -> None:
    published = files("linkwork.core.textfile").joinpath("mechanism.schema.json")
    assert published.read_text(encoding="utf-8") == schema_text()


@pytest.mark.parametrize("name", SAMPLES)
def test_samples_are_valid_as_written_and_as_saved(name: str) -> None:
    for text in (SAMPLES[name], write_text(read_text(SAMPLES[name]).description)):
        VALIDATOR.validate(tomllib.loads(text))


@pytest.mark.parametrize("title", STRUCTURAL)
def test_wrong_structure_is_refused_by_schema_and_reader(title: str) -> None:
    text = next(case.text for case in CASES if case.title == title)
    assert not VALIDATOR.is_valid(tomllib.loads(text))
    with pytest.raises(MechanismFileError):
        read_text(text)


def test_every_key_explains_itself() -> None:
    def described(schema: dict[str, Any]) -> list[str]:
        found = []
        for key, entry in schema.get("properties", {}).items():
            found += [key] if not entry.get("description") or not entry.get("title") else []
            inner = [entry, *entry.get("anyOf", []), entry.get("items", {})]
            found += [deep for each in inner for deep in described(each)]
        return found

    definitions = json_schema()["$defs"].values()
    assert [key for definition in definitions for key in described(definition)] == []
