"""Numbers typed with units, other units and names, copies and outputs on the live page."""

from __future__ import annotations

from typing import Any

import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.palette import part_of
from linkwork.app.live.requests import AddOutput, ChangeUnits, Duplicate, Mirror, Rename
from linkwork.app.live.workbench import Workbench
from tests.app.live.test_workbench import number, only

MM = TypedUnits("mm", "deg")


@pytest.mark.parametrize(
    ("typed", "kind", "value"),
    [
        ("3 in", "length", 76.2), ("1/2 in", "length", 12.7), ("2 1/2 in", "length", 63.5),
        ("3,5cm", "length", 35.0), ("20 mm", "length", 20.0), ("-2 m", "", -2000.0),
        ("0.5 rad", "angle", 28.64788975654116), ("30 deg", "angle", 30.0), ("30°", "angle", 30.0),
        ("1/4 turn", "angle", 90.0), ("2*a", "length", "2*a"), ("main", "length", "main"),
        ("60", "number", "60"), ("π/2 rad", "", 90.0), (4.5, "length", 4.5),
    ],
)  # fmt: skip
def test_a_unit_is_converted_to_that_of_the_file(
    typed: str | float, kind: str, value: float | str
) -> None:
    assert MM.number(typed, kind, "x") == value


@pytest.mark.parametrize(
    ("typed", "kind", "units", "message"),
    [
        ("30 deg", "length", MM, 'x is a length, but "30 deg" is an angle (unit here: mm)'),
        ("3 in", "angle", MM, 'x is an angle, but "3 in" is a length (unit here: deg)'),
        ("3 in", "number", MM, 'x is a plain number, but "3 in" is a length (unit here: none)'),
        ("2*a in", "length", MM, "is not a number with a unit"),
        ("3 in", "length", TypedUnits("stride", "deg"), '"stride", has no known size'),
    ],
)
def test_a_wrong_unit_is_refused(typed: str, kind: str, units: TypedUnits, message: str) -> None:
    with pytest.raises(lw.InputError) as caught:
        units.number(typed, kind, "x")
    assert message in str(caught.value)


def test_fields_take_units(bench: Workbench) -> None:
    state = only(bench.handle(ask.SetNumber(name="A B", value="4.8 in")), FileState)
    assert number(state, "A B").value == 121.92
    assert state.undo == "A B = 4.8 in"
    # a dimension is a length because lengths are made of it
    assert number(state, "a").table == "dimensions"
    told = bench.handle(ask.SetNumber(name="a", value="30 deg", any_formula=True))
    refused = only(told, tell.Refused)
    assert '"a" is a length, but "30 deg" is an angle' in refused.message
    state = only(bench.handle(ask.SetInput(start="0.25 turn", stop="2 rad")), FileState)
    assert "from = 90" in state.text
    assert "to = 114.591559" in state.text
    point = ask.AddPoint(name="Q", x="1 in", y="2 cm", links=("coupler",))
    state = only(bench.handle(point), FileState)
    assert "Q = [25.4, 20.0]" in state.text
    typed: dict[str, str | tuple[str, ...]] = {
        "name": "g", "wheels": ("crank", "rocker"), "centers": ("O2", "O4"),
        "radii": ("1 in 3 cm",),
    }  # fmt: skip
    told = bench.handle(ask.AddPart(table="gears", typed=typed))
    assert "add up to 55.4" in only(told, tell.ProblemsFound).problems[0].message


def test_an_output_is_added_or_refused_with_its_problem(bench: Workbench) -> None:
    told = bench.handle(AddOutput(name="reach", formula="hypot(P.x - A.x, P.y - A.y)"))
    state = only(told, FileState)
    assert (state.outputs, state.undo) == (("reach",), "add output reach")
    told = bench.handle(AddOutput(name="other", formula="hypot(Z.x, 0)"))
    assert '"Z.x" is not defined' in only(told, tell.ProblemsFound).problems[0].message
    assert bench.text == state.text


def test_selections_are_copied_mirrored_and_renamed_in_one_step(bench: Workbench) -> None:
    before = bench.text
    copy = Duplicate(
        names={"O4": "O4", "B": "C", "rocker": "rocker2"}, places={"B": (160.0, -60.0)}
    )
    state = only(bench.handle(copy), FileState)
    assert state.undo == "duplicate O4, B, rocker"
    assert 'rocker2 = ["O4", "C"]' in state.text
    assert '"O4 C" = 80' in state.text
    told = bench.handle(Duplicate(names={"B": "crank"}, places={"B": (0.0, 0.0)}))
    assert '"crank" is already in the file' in only(told, tell.Refused).message
    state = only(bench.handle(ask.Undo()), FileState)
    assert state.text == before
    state = only(bench.handle(Rename(of="link", name="rocker", new="lever")), FileState)
    assert (state.undo, "lever" in [link.name for link in state.links]) == (
        "rename rocker as lever",
        True,
    )
    places = {name: (-x, y) for name, (x, y) in bench.cycle.subject.places().items()}
    told = bench.handle(Mirror(places=places))
    assert only(told, FileState).undo.startswith("mirror ")
    assert only(told, tell.MotionFound).certified == 361


def test_another_unit_is_one_step(bench: Workbench) -> None:
    before = bench.text
    state = only(bench.handle(ChangeUnits(length="in", convert=True)), FileState)
    assert (state.length_unit, state.undo) == ("in", "convert to in")
    assert number(state, "A B").value == pytest.approx(120 / 25.4, rel=1e-14)
    state = only(bench.handle(ask.Undo()), FileState)
    assert state.text == before
    state = only(bench.handle(ChangeUnits(angle="rad", convert=False)), FileState)
    assert (state.angle_unit, state.undo) == ("rad", "relabel as rad")


def test_the_lift_of_a_swinging_follower_is_an_angle() -> None:
    row = {"link": "arm"}
    typed: dict[str, str | tuple[str, ...]] = {
        "segments": ("dwell, 0.25 turn", "3-4-5, 1, 0.5 rad")
    }
    found: Any = part_of("cams", typed, MM, row)["segments"]
    assert [segment.get("lift") for segment in found] == [None, pytest.approx(28.64788975654116)]
    with pytest.raises(lw.InputError, match=r'lift is a length, but "0\.5 rad" is an angle'):
        part_of("cams", typed, MM)
