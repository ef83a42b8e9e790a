"""The tables and laws that the page on mechanism files shows are those that are read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from linkwork.core.mechanism.inputs import LAWS
from linkwork.core.textfile import json_schema

PAGE = (Path(__file__).parents[2] / "docs" / "file-format.md").read_text(encoding="utf-8")
TABLES = (
    "slots", "sliders", "cylinders", "welds", "gears", "noncircular_gears", "belts", "racks",
    "rolling", "cams", "curves", "springs", "loads", "questions",
)  # fmt: skip


def properties(table: str) -> dict[str, Any]:
    """The keys of an array of tables."""
    for definition in json_schema()["$defs"].values():
        if table in definition.get("properties", {}):
            found: dict[str, Any] = definition["properties"][table]["items"]["properties"]
            return found
    raise KeyError(table)


@pytest.mark.parametrize("table", TABLES)
def test_examples_show_all_keys_of_a_table_and_no_others(table: str) -> None:
    blocks = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    shown = [row for block in blocks for row in tomllib.loads(block).get(table, [])]
    assert shown
    known = set(properties(table))
    assert {key for row in shown for key in row} <= known
    # keys that only the text beside the example names
    beside = {"sliders": {"angle"}, "gears": {"radii"}, "belts": {"arm", "teeth", "phase"}}
    missing = known - {key for row in shown for key in row} - beside.get(table, set())
    assert not missing


def test_the_page_lists_the_laws() -> None:
    (line,) = [line for line in PAGE.split("\n") if line.startswith("Laws: ")]
    assert tuple(re.findall(r"`([^`]+)`", line)) == LAWS
