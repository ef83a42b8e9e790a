"""Every key of a TOML text is found at its line."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest
import tomlkit
from hypothesis import given, strategies as st

from linkwork.core.textfile.toml_text import KeyPath, Lines
from tests.core.textfile.samples import SAMPLES

HARD = '''\
# a comment with = and [x]
format = 1 # 2
"quoted \\u03b8" = "# no comment"
a.b . "c d" = { x = 1, y.z = [1, { w = 2 }] }
text = """
[not.a.table]
x = 1 \\""" still "" inside """"
literal = \'\'\'
key = 2\'\'\'\'
when = 1979-05-27 07:32:00
list = [ # comment ]
  [0, 1],

  "]", # three
]
[table . "one two"]
x = 1
[[input]]
link = "a"
[[input]]
  from = 1
[[input.sub]]
k = 1
[[input.sub]]
k = 2
[input.table]
deep = 1
quotes = ["""a"""", \'\'\'b\'\'\'\', 3]
'''
WHERE: dict[KeyPath, int] = {
    ("format",): 2,
    ("quoted θ",): 3,
    ("a",): 4,
    ("a", "b", "c d", "y", "z", 1, "w"): 4,
    ("text",): 5,
    ("literal",): 8,
    ("when",): 10,
    ("list",): 11,
    ("list", 0): 12,
    ("list", 0, 1): 12,
    ("list", 1): 14,
    ("table",): 16,
    ("table", "one two", "x"): 17,
    ("input",): 18,
    ("input", 0): 18,
    ("input", 0, "link"): 19,
    ("input", 1): 20,
    ("input", 1, "from"): 21,
    ("input", 1, "sub", 0, "k"): 23,
    ("input", 1, "sub", 1): 24,
    ("input", 1, "sub", 1, "k"): 25,
    ("input", 1, "table", "deep"): 27,
    ("input", 1, "table", "quotes", 2): 28,
}


@pytest.mark.parametrize("text", [HARD, HARD.replace("\n", "\r\n"), "\ufeff" + HARD])
def test_keys_are_found_behind_everything_toml_allows(text: str) -> None:
    lines = Lines.of(text)
    assert {path: lines.at.get(path) for path in WHERE} == WHERE


def test_a_key_that_is_not_there_gets_the_line_of_the_nearest_around_it() -> None:
    lines = Lines.of(HARD)
    assert lines.line(("input", 1, "step")) == 20
    assert lines.line(("input", 5, "step")) == 18
    assert lines.line(("table", "x")) == 16
    assert lines.line(("nothing", "x")) == 1
    assert lines.line(()) == 1


def test_a_single_table_of_a_list_is_found_without_its_place() -> None:
    lines = Lines.of('\n[[input]]\nlink = "a"\nfrom = 1\n')
    assert lines.line(("input", "from")) == 4
    assert lines.line(("input", "step")) == 2


def test_a_name_is_found_in_any_spelling() -> None:
    lines = Lines.of('\n[guess]\n"θ₁₂" = 1\n[lengths]\n"A   θ1" = 2\n')
    assert lines.line(("guess", "theta12")) == 3
    assert lines.line(("lengths", "A theta1")) == 5


def paths_in(entry: Any, path: KeyPath = ()) -> list[KeyPath]:
    """Every path of TOML data, as an independent walk finds them."""
    found = [path] if path else []
    pairs = entry.items() if isinstance(entry, dict) else enumerate(entry)
    for key, each in pairs:
        inner = (*path, key)
        found += paths_in(each, inner) if isinstance(each, dict | list) else [inner]
    return found


names = st.one_of(st.sampled_from("abc"), st.text(st.characters(codec="utf-8"), max_size=4))
values = st.recursive(
    st.one_of(st.integers(-99, 99), st.booleans(), st.text(st.characters(codec="utf-8"))),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(names, inner, max_size=3),
        st.lists(st.dictionaries(names, inner, max_size=2), max_size=3),
    ),
    max_leaves=12,
)


@given(st.dictionaries(names, values, max_size=5))
def test_every_path_of_random_data_is_found(data: dict[str, Any]) -> None:
    text = tomlkit.dumps(data)
    read = tomllib.loads(text)
    at = Lines.of(text).at
    deep_enough = [path for path in paths_in(read) if len(path) <= 6]
    assert [path for path in deep_enough if path not in at] == []
    last = text.count("\n") + 1
    assert all(1 <= line <= last for line in at.values())


@given(st.data())
def test_a_value_that_is_changed_shows_at_its_line(data: st.DataObject) -> None:
    """Cutting the line of a plain ``key = value`` removes exactly that key."""
    text = SAMPLES[data.draw(st.sampled_from(sorted(SAMPLES)))]
    lines = Lines.of(text)
    plain = [p for p in lines.at if isinstance(p[-1], str) and whole(row(text, lines.at[p]))]
    path = data.draw(st.sampled_from(plain))
    rows = text.split("\n")
    rows[lines.at[path] - 1] = ""
    left = paths_in(tomllib.loads("\n".join(rows)))
    assert path not in left
    assert all(other in left for other in plain if lines.at[other] != lines.at[path])


def row(text: str, line: int) -> str:
    return text.split("\n")[line - 1]


def whole(line: str) -> bool:
    """Whether a line is a plain ``key = value``, and no part of a value of several lines."""
    try:
        return bool(tomllib.loads(line)) and "=" in line
    except tomllib.TOMLDecodeError:
        return False
