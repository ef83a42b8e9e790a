"""Whole messages for what people write and call by mistake."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw

FOUR_BAR = """\
format = 1
[points]
O2 = [0, 0]
A = [1, 1]
B = [3, 2]
O4 = [4, 0]
[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B"]
rocker = ["O4", "B"]
"""
DRIVEN = '[input]\nlink = "crank"\n'
BAR: dict[str, Any] = {
    "points": {"O": (0, 0), "A": (1, 1)},
    "links": {"ground": ["O"], "bar": ["O", "A"]},
    "inputs": lw.Input(link="bar"),
}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "[lengths]\nO2 A = 40\n",
            "line 13  is not TOML: expected '=' after a key in a key/value pair (column 4): "
            'write a name with spaces in quotes: "O2 A"',
        ),
        (
            '[lengths]\n"O2 A" = "40mm"\n',
            'line 13  lengths."O2 A"  column 3: numbers carry no unit here: write 40 and set '
            'length = "mm" for the whole file; a product is written "40*mm"\n'
            "        40mm\n          ^",
        ),
        (
            '[lengths]\n"O2 A" = 40 mm\n',
            "line 13  is not TOML: expected newline or end of document after a statement "
            '(column 13): write numbers without a unit; length = "mm" sets the unit',
        ),
        (
            '[angles]\n"O2 A B" = 40 deg\n',
            "line 13  is not TOML: expected newline or end of document after a statement "
            '(column 15): write numbers without a unit; angle = "deg" sets the unit',
        ),
        (
            '[lengths]\n"O2 A" = "2k"\n',
            'line 13  lengths."O2 A"  column 2: write the multiplication sign: "2*k"\n'
            "        2k\n         ^",
        ),
        (
            '[length]\n"O2 A" = 40\n',
            "line 12  length  is the unit, a text in quotes: name the table [lengths]",
        ),
        (
            '[angle]\n"O2 A B" = 40\n',
            "line 12  angle  is the unit, a text in quotes: name the table [angles]",
        ),
    ],
)
def test_a_mistake_in_a_file_is_told_once_and_with_its_remedy(text: str, told: str) -> None:
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(FOUR_BAR + text + DRIVEN)
    assert str(caught.value) == f"1 problem in text\n  {told}"


def test_a_misspelt_point_is_told_where_it_is_and_nowhere_else() -> None:
    text = FOUR_BAR.replace('["A", "B"]', '["A", "BB"]')
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(text + '[lengths]\n"A B" = 3\n' + DRIVEN)
    assert str(caught.value) == (
        '1 problem in text\n  line 10  links.coupler  point "BB" is not defined '
        "(points: B, O2, A, O4)"
    )


def test_a_length_to_a_point_on_no_link_is_told() -> None:
    text = FOUR_BAR.replace("O4 = [4, 0]", "O4 = [4, 0]\nX = [5, 5]")
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(text + '[lengths]\n"A X" = 3\n' + DRIVEN)
    assert str(caught.value) == (
        "2 problems in text\n"
        "  line 7   points.X       is on no link: add it to a link or remove it\n"
        '  line 14  lengths."A X"  no link carries A and X: a distance between links varies'
    )


def test_a_mechanism_without_input_says_how_to_drive_it() -> None:
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(FOUR_BAR).sweep()
    assert str(caught.value) == (
        "1 problem in text\n  line 1  input  one degree of freedom has no input: add an input, "
        'for example link = "crank" (free to move: crank, rocker, coupler)'
    )


@pytest.mark.parametrize("far", ["1e23", "1e160", "1e308", "-1e200"])
def test_a_point_far_from_the_others_of_a_curve_is_refused(far: str) -> None:
    text = lw.example_text("curved-slot").replace('["80*cos(30)", "80*sin(30)"]', f"[{far}, 3]")
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(text)
    told = (
        "is more than 1,000,000 times as far from the point before as the nearest two points are "
        "from each other"
    )
    lines = str(caught.value).split("\n")
    assert lines[0] == "2 problems in text"  # there and back
    assert all(line.endswith(told) for line in lines[1:])


def changed(**fields: Any) -> Callable[[], object]:
    return lambda: lw.linkage(**(BAR | fields))


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (changed(points=3), "points must be a dictionary of names and coordinates, got 3"),
        (changed(points={"A": 3}), 'points["A"] must be a list of coordinates, got 3'),
        (changed(points={"A": "ab"}), "points[\"A\"] must be a list of coordinates, got 'ab'"),
        (changed(points={3: (0, 0)}), "the names in points must be texts, got 3"),
        (changed(links=[3]), "links must be a dictionary of names and points, got [3]"),
        (changed(links={"c": "OA"}), "links[\"c\"] must be a list of points, got 'OA'"),
        (changed(links={"c": [1, 2]}), "a name must be a text, got 1"),
        (changed(sliders=3), "sliders must be a list, got 3"),
        (changed(sliders=[3]), "sliders[0] must be a lw.Slider(…), got 3"),
        (changed(inputs=3), "inputs must be a list, got 3"),
        (changed(trace="A"), "trace must be a list, got 'A'"),
        (changed(name=3), "name must be a text, got 3"),
        (changed(length=None), "length must be a text, got None"),
        (changed(sketch=3), "sketch must be True or False, got 3"),
        (changed(outputs={"a": 3}), 'outputs["a"] must be a text, got 3'),
        (
            changed(angle=3),
            '1 problem in mechanism "mechanism"\n  angle  must be "deg" or "rad", got 3',
        ),
        (
            lambda: lw.loops(loop={}),
            'there is no field "loop" (fields: loops, name, length, angle, dimensions, inputs, '
            "trace, outputs, … 15 more)",
        ),
        (
            lambda: lw.loops(loops={"l": 3}, guess={}),
            'loops["l"] must be a text, got 3',
        ),
        (
            lambda: lw.plain_equations(equations={"f": 3}, guess={"x": 1}),
            'equations["f"] must be a text, got 3',
        ),
        (
            lambda: lw.plain_equations(equations={"f": "x = 1"}, guess=[1]),
            "guess must be a dictionary of names and values, got [1]",
        ),
        (
            lambda: lw.loads(None),  # type: ignore[arg-type]
            "a mechanism file must be given as text, got None",
        ),
        (
            lambda: lw.load(3),  # type: ignore[arg-type]
            "a path must be a text or a Path, got 3",
        ),
        (
            lambda: lw.example("four-bar").save(None),  # type: ignore[arg-type]
            "a path must be a text or a Path, got None",
        ),
        (
            lambda: lw.example("four-bar").draw(3),  # type: ignore[arg-type]
            "a path must be a text or a Path, got 3",
        ),
    ],
)
def test_a_wrong_type_is_named_with_the_right_one(call: Callable[[], object], told: str) -> None:
    with pytest.raises(lw.LinkworkError) as caught:
        call()
    assert str(caught.value) == told


@pytest.mark.parametrize(
    "table",
    [
        'F = "x^3 - 1e308*x - 5 = 0"\n[guess]\nx = 1\n',
        'F = "x/x = 1"\nG = "y = x + 1"\n[guess]\nx = 1e-300\ny = 3\n',
    ],
)
def test_numbers_near_the_largest_float_warn_nobody(
    table: str, tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    text = f"format = 1\n[equations]\n{table}"
    (tmp_path / "large.toml").write_text(text, encoding="utf-8")
    mechanism = lw.load(tmp_path / "large.toml")
    mechanism.solve()
    mechanism.configurations()
    assert not recwarn.list


@pytest.mark.parametrize(
    ("name", "given", "extreme"),
    [
        ("cam-roller-follower", "base    = 40", "base = 1e120"),
        ("cam-roller-follower", "base    = 40", "base = 1e200"),
        ("cam-swinging-follower", "base    = 35", "base = 1e200"),
        ("belt-drive", "radii   = [25, 50]", "radii = [25, 1e-200]"),
        ("four-bar", 'speed = "25 rad/s"', "speed = 1e160"),
    ],
)
def test_parts_of_extreme_size_are_solved_or_refused(
    name: str, given: str, extreme: str, recwarn: pytest.WarningsRecorder
) -> None:
    text = lw.example_text(name)
    assert given in text
    with suppress(lw.LinkworkError):  # nothing else is raised
        lw.loads(text.replace(given, extreme)).solve()
    assert not recwarn.list
