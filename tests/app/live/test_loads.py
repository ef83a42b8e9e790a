"""Masses and loads are edited by hand: forms and drawing, and go with what carries them."""

from __future__ import annotations

from pathlib import Path

import pytest

import linkwork as lw
from linkwork import example_text
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.requests import Rename
from linkwork.app.live.workbench import Workbench
from linkwork.core.mechanism.linkage import Linkage
from tests.described import described_as


@pytest.fixture
def bench(tmp_path: Path) -> Workbench:
    """The press of the library."""
    path = tmp_path / "press.toml"
    path.write_text(example_text("crank-press"), encoding="utf-8")
    return Workbench(MechanismFile(path), lw.loads)


def change(bench: Workbench, edit: ask.Request) -> FileState:
    events = bench.handle(edit)
    assert isinstance(events[0], FileState), events
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


def test_stops_go_with_what_they_bound(bench: Workbench) -> None:
    change(bench, _entry("stops", "", of="C.y", to="250"))
    change(bench, _entry("stops", "", of="rod", to="250"))
    change(bench, ask.RemoveLink(name="rod"))
    assert 'of = "C.y"' in bench.text
    assert 'of = "rod"' not in bench.text


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


def _entry(table: str, of: str, /, *, remove: bool = False, **typed: str) -> ask.SetEntry:
    return ask.SetEntry(table=table, of=of, typed=dict(typed), remove=remove)


@pytest.mark.parametrize(
    ("edit", "line", "undo"),
    [
        (
            _entry("friction", "A", mu="0.1", radius="0.5 in"),
            "A = { mu = 0.1, radius = 12.7 }",
            "friction of A",
        ),
        (_entry("gravity", "", size="1.62 m/s^2"), 'size = "1.62 m/s^2"', "gravity"),
        (
            _entry("motor", "crank", stall="9e5", free_speed="25 m/s"),
            'motor = { stall = 900000, free_speed = "25000 mm/s" }',
            "",
        ),
        (
            _entry("motor", "crank", stall="2*a", free_speed="-1500 rpm"),
            'motor = { stall = "2*a", free_speed = "-1500 rpm" }',
            "",
        ),
        (
            ask.SetEntry(
                table="motor", of="crank", typed={"speeds": ("0, 9 rpm",), "torques": ("5, 0",)}
            ),
            'motor = { speeds = [0, "9 rpm"], torques = [5, 0] }',
            "motor of crank",
        ),
        (_entry("motor", "crank", inertia="40"), "inertia = 40", "motor of crank"),
        (
            _entry("stops", "", of="height", to="250", restitution="0.3"),
            "to = 250",
            "stops of height",
        ),
    ],
)
def test_an_entry_is_written_in_place_and_undone_by_name(
    bench: Workbench, edit: ask.SetEntry, line: str, undo: str
) -> None:
    before = bench.text.replace("[trace]", "# paths\n[trace]")
    bench.handle(ask.SetText(text=before))
    events = bench.handle(edit)
    if not undo:  # refused: a speed of a length, a formula of what there is not
        assert isinstance(events[0], tell.ProblemsFound)
        assert bench.text == before
        return
    assert isinstance(events[0], FileState)
    assert events[0].undo == undo
    assert line in bench.text.splitlines()
    old, new = before.splitlines(), bench.text.splitlines()
    lost = [own for own in old if own not in new]
    assert lost == ([] if edit.table != "gravity" else ['size = "9.81 m/s^2"'])  # comments stay
    shown = next(
        own
        for own in events[0].force_entries
        if own.table == edit.table and own.there and own.of in (edit.of, "0")
    )
    assert shown.takes
    change(bench, _entry(edit.table, shown.of, remove=True))
    gone = [own for own in old if own not in bench.text.splitlines()]
    assert gone == ([] if edit.table != "gravity" else ["[gravity]", 'size = "9.81 m/s^2"'])


def test_forms_show_what_is_in_the_file_and_what_could_be(bench: Workbench) -> None:
    change(bench, _entry("friction", "height", mu="0.2"))
    state = change(bench, _entry("stops", "", of="height", to="250"))
    entries = {(own.table, own.of): own for own in state.force_entries}
    assert {of for table, of in entries if table == "friction"} == {"O", "A", "C", "height"}
    assert entries["friction", "O"].takes == ("mu", "radius")
    assert entries["friction", "height"].takes == ("mu", "length")
    assert entries["friction", "height"].typed == {"mu": "0.2"}
    assert entries["stops", "0"].typed == {"of": "height", "to": "250"}
    assert not entries["stops", ""].there
    assert not entries["motor", "crank"].there
    change(bench, _entry("stops", "0", of="height", to="251"))
    assert "250" not in bench.text.partition("[[stops]]")[2]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (_entry("friction", "A", mu="0.1"), "is missing: the friction of a pin needs it"),
        (_entry("friction", "A", mu="-1", radius="3"), "must not be negative"),
        (_entry("friction", "Q", mu="1"), "is no joint with friction (joints: O, A, C, height)"),
        (_entry("friction", "A", my="1"), '"my" is not a key of [friction]'),
        (_entry("frictoin", "A", mu="1"), 'there is no form "frictoin"'),
        (_entry("motor", "rod", stall="1"), '"rod" is no input (inputs: crank)'),
        (_entry("motor", "crank", free_speed="9 rpm"), "either a stall torque or a table"),
        (_entry("stops", "3", of="height"), 'there is no stop number "3"'),
        (_entry("stops", "", of="height"), "a stop needs from, to, or both"),
        (_entry("gravity", "", size="9.81 furlongs"), "9.81 m/s^2"),
        (_entry("gravity", "", angle="3 mm"), "is an angle"),
    ],
)
def test_a_wrong_entry_is_refused_and_nothing_changes(
    bench: Workbench, edit: ask.SetEntry, message: str
) -> None:
    before = bench.text
    (event,) = bench.handle(edit)
    assert bench.text == before
    assert message in (event.message if isinstance(event, tell.Refused) else str(event))


def test_stops_follow_the_names_of_what_they_bound(bench: Workbench) -> None:
    for of in ("C.y", "rod", "height"):
        change(bench, _entry("stops", "", of=of, to="990"))
    for of, name, new in (("point", "C", "Q"), ("link", "rod", "bar"), ("part", "height", "h")):
        change(bench, Rename(of=of, name=name, new=new))
    assert [stop.of for stop in now(bench).stops] == ["Q.y", "bar", "h"]
