"""Changing a text in place: one entry changes, and every other letter stays."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings, strategies as st

import linkwork as lw
from linkwork.core.mechanism.varied_numbers import VariedNumber, varied_numbers
from linkwork.core.textfile.writer import TextEdits

TEXT = """\
# head
format = 1   # the version

[dimensions]
a   = 40     # crank
"θ0" = 10

[points]
O = [0, 0]   # pivot
A = [ 35, 20 ]

[lengths]
"O A" = "a"
[input]
link = "crank"  # driven

[[sliders]]
name = "s" # first
offset = 2

[[sliders]]
name = "t"
# the end
"""


def changed(old: str, new: str) -> str:
    assert TEXT.count(old) == 1
    return TEXT.replace(old, new)


@pytest.mark.parametrize(
    ("path", "entry", "old", "new"),
    [
        (("dimensions", "a"), 42.5, "a   = 40  ", "a   = 42.5  "),
        (("dimensions", "a"), 42.0, "a   = 40  ", "a   = 42  "),
        (("dimensions", "theta0"), 1.5, '"θ0" = 10', '"θ0" = 1.5'),
        (("points", "A", 1), 21.5, "[ 35, 20 ]", "[ 35, 21.5 ]"),
        (("lengths", "A O"), 41.5, '"O A" = "a"', '"O A" = 41.5'),
        (("input", 0, "link"), "rod", '"crank"  # driven', '"rod"  # driven'),
        (("sliders", 0, "offset"), 2.5, "offset = 2", "offset = 2.5"),
        (("sliders", 1, "offset"), 3.5, "# the end\n", "# the end\noffset = 3.5\n"),
        (("points", "B"), [1.5, 2.5], "[ 35, 20 ]\n", "[ 35, 20 ]\nB = [1.5, 2.5]\n"),
        (("configuration",), "open", "# the version\n", '# the version\nconfiguration = "open"\n'),
    ],
)
def test_one_entry_changes_and_nothing_else(
    path: tuple[str | int, ...], entry: object, old: str, new: str
) -> None:
    text = TextEdits(TEXT)
    assert text.text == TEXT
    text.put(path, entry)
    assert text.text == changed(old, new)
    assert text.get(path) == entry


def test_a_table_that_is_missing_is_made_at_the_end() -> None:
    text = TextEdits("format = 1\n[points]\nO = [0, 0]\n")
    text.put(("angles", "B A C"), 30.5)
    assert text.text == 'format = 1\n[points]\nO = [0, 0]\n\n[angles]\n"B A C" = 30.5\n'


def test_entries_are_added_and_removed() -> None:
    text = TextEdits(TEXT)
    text.append("sliders", {"name": "u", "points": ["A", "B"]})
    assert text.text == TEXT + '\n[[sliders]]\nname = "u"\npoints = ["A", "B"]\n'
    text.remove(("sliders", 0))
    text.remove(("lengths", "O A"))
    assert [row["name"] for _, row in text.entries("sliders")] == ["t", "u"]
    assert not text.has(("lengths",))
    assert "# driven" in text.text
    text.append("gears", {"name": "g"})
    text.remove(("gears", 0))
    assert not text.has(("gears",))


def test_what_is_not_there_is_said_with_its_key() -> None:
    text = TextEdits(TEXT)
    for wrong in (text.get, text.remove):
        with pytest.raises(lw.UnknownNameError) as caught:
            wrong(("points", "Z Z"))
        assert str(caught.value) == 'points."Z Z" is not in the file'
    with pytest.raises(lw.InputError, match="no value can be written there"):
        text.put(("sliders", 5, "offset"), 1)
    assert text.text == TEXT
    line = TextEdits('input = { link = "a" }')
    with pytest.raises(lw.InputError, match=r"in one line: write it as \[\[input\]\]"):
        line.append("input", {"link": "rod"})


def test_a_single_table_becomes_the_first_of_a_list_with_its_comments() -> None:
    text = TextEdits('[input] # one\nlink = "a"  # driven\n# full turn\n\n[trace]\npoints = []\n')
    text.append("input", {"link": "b"})
    assert text.text == (
        '[[input]] # one\nlink = "a"  # driven\n# full turn\n\n[[input]]\nlink = "b"\n\n'
        "[trace]\npoints = []\n"
    )


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("bom", ["", "\ufeff"])
def test_line_ends_and_bom_stay(end: str, bom: str) -> None:
    whole = bom + TEXT.replace("\n", end)
    text = TextEdits(whole)
    text.put(("dimensions", "a"), 42)
    text.put(("dimensions", "b"), 1.5)
    wanted = changed("a   = 40", "a   = 42").replace('"θ0" = 10\n', '"θ0" = 10\nb = 1.5\n')
    assert text.text == bom + wanted.replace("\n", end)


def place(quantity: VariedNumber) -> tuple[str | int, ...]:
    if quantity.table == "points":
        return ("points", quantity.key, quantity.axis)
    return (quantity.table, quantity.key)


@settings(max_examples=60)
@given(st.sampled_from(lw.examples()), st.data())
def test_a_number_of_the_library_reads_back_changed_and_all_others_as_they_were(
    name: str, data: st.DataObject
) -> None:
    whole = lw.example_text(name)
    before = lw.example(name).description
    numbers = [
        q
        for q in varied_numbers(before)
        if q.table != "sliders" and not isinstance(q.written(before), str)
    ]
    if not numbers:
        return
    chosen = data.draw(st.sampled_from(numbers))
    value = chosen.of(before) * data.draw(st.floats(0.999, 1.001)) + 1e-7
    text = TextEdits(whole)
    text.put(place(chosen), value)
    assert text.get(place(chosen)) == value
    try:
        after = lw.loads(text.text).description
    except lw.MechanismFileError:  # ground that disagrees with its lengths, and the like
        return
    for quantity in varied_numbers(after):
        wanted = value if quantity == chosen else quantity.of(before)
        if not isinstance(quantity.written(after), str):
            assert math.isclose(quantity.of(after), wanted, rel_tol=0, abs_tol=0)
    rows = zip(whole.splitlines(), text.text.splitlines(), strict=True)
    assert sum(old != new for old, new in rows) <= 1
