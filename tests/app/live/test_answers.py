"""Questions about a mechanism: its quantities, its circuits, files of it."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.workbench import Workbench
from tests.app.live.conftest import FOUR_BAR
from tests.app.unpacking import unpacked

TRUSS = """\
format = 1
name = "Truss"
[points]
A = [0, 0]
B = [100, 0]
C = [40, 60]
[links]
ground = ["A", "B"]
one = ["A", "C"]
other = ["B", "C"]
"""


@pytest.fixture
def open_bench(bench: Workbench) -> Workbench:
    """The workbench after a page has opened."""
    bench.opened()
    return bench


def handled(bench: Workbench, request: ask.Request) -> list[Any]:
    return list(bench.handle(request))


def one(bench: Workbench, request: ask.Request) -> Any:
    (event,) = bench.handle(request)
    return event


def test_all_quantities_are_listed_with_their_derivatives(open_bench: Workbench) -> None:
    told = one(open_bench, ask.ListQuantities())
    listed = {line.name: line for line in told.quantities}
    assert listed["rocker"].derivatives == 2
    assert listed["B.transmission"].derivatives == 2
    assert listed["rocker.mechanical_advantage"].derivatives == 1
    assert listed["P.curvature"].derivatives == 0
    assert listed["residual"].derivatives == 0
    assert listed["B.x"].unit == "mm"


def test_a_quantity_asked_for_stays_on_the_page_while_dimensions_change(
    open_bench: Workbench,
) -> None:
    names = ("rocker.d2", "B.centre.x", "min(B.transmission)")
    for event in (
        one(open_bench, ask.ShowQuantities(names=names)),
        handled(open_bench, ask.SetNumber(name="a", value=41, live=True))[-1],
        handled(open_bench, ask.SetNumber(name="a", value=41))[-1],
    ):
        (motion,) = event.page.motions
        asked = {column.name: column for column in motion.columns if column.group == "asked"}
        assert list(asked) == ["rocker.d2", "B.centre.x"]
    swept = lw.loads(FOUR_BAR.replace("a = 40", "a = 41")).sweep()
    shown = unpacked(asked["rocker.d2"].values, swept.found)
    assert shown == pytest.approx(swept["rocker.d2"], abs=1e-12)
    numbers = {number.name: number.value for number in motion.numbers}
    assert numbers["min(B.transmission)"] == swept.value("min(B.transmission)")
    assert numbers["stroke(rocker)"] == swept.value("stroke(rocker)")
    assert numbers["path_length(P)"] == swept.value("path_length(P)")


def test_an_unknown_quantity_is_refused_and_those_shown_stay(open_bench: Workbench) -> None:
    one(open_bench, ask.ShowQuantities(names=("rocker.d2",)))
    told = one(open_bench, ask.ShowQuantities(names=("rokker.d2",)))
    assert told.message.startswith('there is no "rokker" (nearest: rocker')
    for name in ("stroke(rokker)", "dwell(rocker)", "rocker.velocity"):
        assert isinstance(one(open_bench, ask.ShowQuantities(names=(name,))), tell.Refused)
    many = ask.ShowQuantities(names=("rocker.d2",) * 41)
    assert one(open_bench, many).message == "at most 40 quantities are shown, got 41"
    page = handled(open_bench, ask.SetNumber(name="a", value=42))[-1].page
    assert "rocker.d2" in [column.name for column in page.motions[0].columns]


def test_a_quantity_that_a_change_removes_leaves_the_page(open_bench: Workbench) -> None:
    one(open_bench, ask.ShowQuantities(names=("P.curvature",)))
    page = handled(open_bench, ask.RemovePoint(name="P"))[-1].page
    assert "P.curvature" not in [column.name for column in page.motions[0].columns]


def test_questions_leave_a_drag_alone(open_bench: Workbench) -> None:
    handled(open_bench, ask.SetNumber(name="a", value=41, live=True))
    one(open_bench, ask.ListQuantities())
    handled(open_bench, ask.SetNumber(name="a", value=42))
    events = handled(open_bench, ask.Undo())
    assert "a = 40" in events[0].text


def test_all_circuits_are_found_with_their_motions(open_bench: Workbench) -> None:
    told = one(open_bench, ask.ListCircuits())
    found = lw.loads(FOUR_BAR).circuits()
    assert [circuit.name for circuit in told.circuits] == [circuit.name for circuit in found]
    assert [circuit.current for circuit in told.circuits] == [True, False]
    assert told.circuits[0].turns == 1
    assert [circuit.branches[0].start for circuit in told.circuits] == ["open", "crossed"]
    assert [motion.name for motion in told.page.motions] == ["circuit 1", "circuit 2"]
    assert "complete" in told.message


def test_a_circuit_between_dead_points_tells_them(open_bench: Workbench) -> None:
    handled(open_bench, ask.SetNumber(name="a", value=76))
    (circuit,) = one(open_bench, ask.ListCircuits()).circuits
    assert circuit.turns == 0
    assert [limit.what for limit in circuit.limits] == ["dead point"] * 2
    assert circuit.input_range == pytest.approx(
        tuple(sorted(limit.input for limit in circuit.limits)), abs=1e-6
    )


def test_a_search_for_circuits_ends_with_a_change(open_bench: Workbench) -> None:
    handled(open_bench, ask.SetNumber(name="a", value=76))  # dead points are looked between
    open_bench.cycle.hurried = lambda: True
    told = one(open_bench, ask.ListCircuits())
    assert told == tell.Refused(
        message="the search for circuits was ended by a change: list them again"
    )


@pytest.mark.parametrize("suffix", ["toml", "csv", "html", "svg"])
def test_files_contain_the_motion_of_the_page(open_bench: Workbench, suffix: str) -> None:
    handled(open_bench, ask.SetNumber(name="a", value=41))
    told = one(open_bench, ask.Export(format=suffix, row=90))
    assert told.name == f"four-bar.{suffix}"
    text = base64.b64decode(told.content).decode()
    if suffix == "toml":
        assert text == open_bench.text
    elif suffix == "csv":
        motion = lw.loads(open_bench.text).sweep()
        head, *rows = text.splitlines()
        assert len(rows) == len(motion)
        where = head.split(",").index("rocker")
        assert float(rows[90].split(",")[where]) == motion["rocker"][90]
    elif suffix == "svg":
        circles = [e for e in ElementTree.fromstring(text).iter() if e.tag.endswith("circle")]
        pin = lw.loads(open_bench.text).sweep().points["A"]
        places = [complex(float(c.get("cx", 0)), -float(c.get("cy", 0))) for c in circles]
        place = complex(pin[0].value[90], pin[1].value[90])
        assert np.abs(np.array(places) - place).min() < 0.01
        assert "var(" not in text  # other programs do not know colours of a page
    else:
        assert text.startswith("<!doctype html>")


def test_a_workbook_is_written_with_its_notices(open_bench: Workbench) -> None:
    pytest.importorskip("xlsxwriter")
    told = one(open_bench, ask.Export(format="xlsx"))
    assert base64.b64decode(told.content)[:2] == b"PK"


def test_a_picture_for_a_dark_page_has_its_colours(open_bench: Workbench) -> None:
    light, dark = (
        base64.b64decode(one(open_bench, ask.Export(format="svg", dark=on)).content)
        for on in (False, True)
    )
    assert light != dark


def test_a_format_that_cannot_be_written_is_refused(
    open_bench: Workbench, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = one(open_bench, ask.Export(format="dxf"))
    assert told.message.startswith('cannot write the format "dxf" (formats: toml, svg')
    monkeypatch.setenv("PATH", "")
    assert "ffmpeg" in one(open_bench, ask.Export(format="mp4")).message
    told = one(open_bench, ask.Export(format="svg", row=9999))
    assert told.message == "there is no row 9999: the motion has 361"


def test_a_mechanism_without_input_has_a_picture_and_no_table(tmp_path: Path) -> None:
    file = tmp_path / "still.toml"
    file.write_text(TRUSS, encoding="utf-8")
    bench = Workbench(MechanismFile(file), lw.loads)
    bench.opened()
    assert one(bench, ask.Export(format="svg")).name == "still.svg"
    told = one(bench, ask.Export(format="csv"))
    assert told.message == "a .csv file needs a motion: the mechanism has none"
    assert one(bench, ask.ListQuantities()).quantities == ()


def test_an_export_during_a_drag_ends_it(open_bench: Workbench) -> None:
    handled(open_bench, ask.SetNumber(name="a", value=41, live=True))
    told = one(open_bench, ask.Export(format="toml"))
    assert b"a = 41" in base64.b64decode(told.content)
    assert "a = 40" in handled(open_bench, ask.Undo())[0].text


def test_long_answers_tell_their_progress(open_bench: Workbench) -> None:
    handled(open_bench, ask.SetNumber(name="a", value=76))
    fractions: list[float] = []
    open_bench.cycle.working = fractions.append
    one(open_bench, ask.ListCircuits())
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
