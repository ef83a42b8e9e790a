"""Masses and loads are edited by hand: forms and drawing, and go with what carries them."""

from __future__ import annotations

from pathlib import Path

import pytest

import linkwork as lw
from linkwork.api import example_text
from linkwork.mechanism.linkage import Linkage
from linkwork.viewer.live import events as tell, requests as ask
from linkwork.viewer.live.mechanism_file import MechanismFile
from linkwork.viewer.live.workbench import Workbench
from tests.described import described_as


@pytest.fixture
def bench(tmp_path: Path) -> Workbench:
    """The press of the library."""
    path = tmp_path / "press.toml"
    path.write_text(example_text("crank-press"), encoding="utf-8")
    return Workbench(MechanismFile(path), lw.loads)


def change(bench: Workbench, edit: ask.Request) -> tell.FileState:
    events = bench.handle(edit)
    assert isinstance(events[0], tell.FileState), events
    return events[0]


def now(bench: Workbench) -> Linkage:
    return described_as(Linkage, lw.loads(bench.text))


def test_a_mass_is_shown_set_and_removed(bench: Workbench) -> None:
    state = change(bench, ask.SetMass(link="rod", mass=7.5))
    assert now(bench).masses["rod"] == lw.Mass(mass=7.5, shape="rod")
    shown = {own.link: own for own in state.masses}
    assert (shown["rod"].mass, shown["rod"].rod) == ("7.5", True)
    assert (shown["crank"].x, shown["crank"].inertia) == ("8", "18000")
    assert state.mass_unit == "kg"
    change(bench, ask.SetMass(link="rod", mass="2*3", x=100, y=5, inertia=90))
    own = lw.Mass(mass="2*3", center=(100, 5), inertia=90)
    assert now(bench).masses["rod"] == own
    # the row keeps its place and its form
    (row,) = (line for line in bench.text.splitlines() if line.startswith("rod   = {"))
    assert row.count("mass") == 1
    assert "shape" not in row
    change(bench, ask.SetMass(link="ram"))
    assert set(now(bench).masses) == {"crank", "rod"}


def test_a_force_is_drawn_changed_and_removed(bench: Workbench) -> None:
    picks = (ask.Picked(x=0.0, y=660.0, point="A"), ask.Picked(x=30.0, y=640.0))
    state = change(bench, ask.DrawPart(table="loads", picks=picks, span=20.0))
    assert "load on A" in state.parts
    assert now(bench).loads[-1] == lw.Load(point="A", force=(30, -20))
    change(bench, ask.SetPart(name="load on A", key="force", typed=("5, 6",)))
    assert now(bench).loads[-1].force == (5, 6)
    change(bench, ask.RemovePart(name="load on A"))
    assert [load.point for load in now(bench).loads] == ["C"]


def test_loads_go_with_what_carries_them(bench: Workbench) -> None:
    friction = "[friction]\nC = { mu = 0.1, radius = 5 }\nheight = { mu = 0.2 }\n[trace]"
    change(bench, ask.SetText(text=bench.text.replace("[trace]", friction)))
    state = change(bench, ask.RemoveLink(name="ram"))
    # what is left to mend are the slider without its link and the pin of one link, not the loads
    assert "load on C" not in state.parts
    assert {lack.key.partition(".")[0] for lack in state.lacks} == {"sliders[1]", "friction"}
    assert [own.link for own in state.masses] == ["crank", "rod"]
    change(bench, ask.Undo())
    change(bench, ask.RemovePart(name="height"))
    assert "height" not in bench.text.partition("[friction]")[2].partition("[")[0]


def test_a_negative_mass_is_a_problem_of_the_draft(bench: Workbench) -> None:
    state = change(bench, ask.SetMass(link="rod", mass=-1, x=1))
    (lack,) = state.lacks
    assert lack.message == "must not be negative, got -1"


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (ask.SetMass(link="rot", mass=1), 'there is no link "rot"'),
        (
            ask.DrawPart(table="loads", picks=(ask.Picked(x=0, y=0), ask.Picked(x=1, y=1)), span=2),
            "a force acts on a point",
        ),
    ],
)
def test_a_wrong_mass_or_load_is_refused(bench: Workbench, edit: ask.Edit, message: str) -> None:
    before = bench.text
    (event,) = bench.handle(edit)
    assert bench.text == before
    said = event.message if isinstance(event, tell.Refused) else str(event)
    assert message in said
