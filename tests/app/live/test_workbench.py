"""A file being edited: what changes, what stays, what is refused, and that nothing is lost."""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import ChangeableNumber, FileState
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.requests import Mirror
from linkwork.app.live.workbench import Workbench
from linkwork.app.pages.offline_page import embed_snippet, qr_svg
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.textfile.link import fragment_of
from linkwork.core.textfile.reader import blank_sheet
from tests.app.live.conftest import FOUR_BAR
from tests.app.unpacking import unpacked
from tests.described import described_as
from tests.thinned import thinned

NO_LOOP = ("balanced-lamp", "door-closer", "double-pendulum", "pendulum")
TITLES = [
    "Pin in slot", "Slider", "Cylinder", "Weld", "Gear pair", "Non-circular gears", "Belt or chain",
    "Rack and pinion", "Rolling wheel", "Cam", "Curve", "Linear coupling", "Spring", "Load",
]  # fmt: skip


def only(events: list[tell.Event], kind: type) -> Any:
    """The one event of a kind."""
    found = [event for event in events if isinstance(event, kind)]
    assert len(found) == 1, [type(event).__name__ for event in events]
    return found[0]


def kinds(events: list[tell.Event]) -> list[str]:
    return [type(event).__name__ for event in events]


def line(text: str, start: str) -> int:
    """The line, from 1, that starts with these letters."""
    return next(k for k, row in enumerate(text.splitlines(), 1) if row.startswith(start))


def number(state: FileState, name: str) -> ChangeableNumber:
    return next(each for each in state.numbers if each.name == name)


def told(motion: tell.MotionFound, name: str) -> np.ndarray:
    """A quantity, or a coordinate such as P.x, over all rows; NaN where there is no position."""
    assert motion.page is not None
    (data,) = motion.page.motions
    columns = {column.name: column.values for column in data.columns}
    for point in data.points:
        columns |= {f"{point.name}.x": point.x, f"{point.name}.y": point.y}
    every = np.ones(motion.rows, dtype=bool)
    return unpacked(columns[name], unpacked(data.evidence.found, every) == 1)


def test_a_page_begins_with_the_file_and_its_cycle(bench: Workbench) -> None:
    palette, state, motion = bench.opened()
    assert isinstance(palette, tell.PaletteShown)
    assert [part.title for part in palette.parts] == TITLES
    assert isinstance(state, FileState)
    assert isinstance(motion, tell.MotionFound)
    assert (state.title, state.form, state.unsaved) == ("Four-bar", "points-and-links", False)
    assert state.text == FOUR_BAR
    assert [(u.name, u.unit) for u in state.unknowns] == [("coupler", "deg"), ("rocker", "deg")]
    assert (state.inputs[0].name, state.inputs[0].rows) == ("crank", 361)
    assert number(state, "O2 A").formula == "a"
    assert number(state, "A P").table == "measured"
    assert (motion.live, motion.rows, motion.certified) == (False, 361, 361)
    swept = lw.loads(FOUR_BAR).sweep()
    assert told(motion, "P.x") == pytest.approx(swept["P.x"], abs=0)
    assert told(motion, "rocker") == pytest.approx(swept["rocker"], abs=0)


def test_a_dimension_changes_in_its_line_and_the_comment_stays(bench: Workbench) -> None:
    events = bench.handle(ask.SetNumber(name="a", value=42))
    state = only(events, FileState)
    assert state.text == FOUR_BAR.replace("a = 40  # the crank", "a = 42  # the crank")
    assert state.unsaved
    longer = lw.loads(FOUR_BAR).with_dimensions(a=42).sweep()
    found = only(events, tell.MotionFound)
    assert told(found, "rocker") == pytest.approx(longer["rocker"], rel=1e-12)


def test_a_measured_length_becomes_a_given_one(bench: Workbench) -> None:
    state = only(bench.handle(ask.SetNumber(name="P A", value=90)), FileState)
    assert '"A P" = 90' in state.text
    assert number(state, "A P").table == "lengths"


def test_a_number_that_is_a_formula_is_not_written_over(bench: Workbench) -> None:
    refused = only(bench.handle(ask.SetNumber(name="O2 A", value=50)), tell.Refused)
    assert refused.message == (
        '"O2 A" is the formula a: change a dimension in it, or send another formula'
    )
    state = only(bench.handle(ask.SetNumber(name="O2 A", value="a + 1")), FileState)
    assert '"O2 A" = "a + 1"' in state.text


def test_a_distance_on_ground_moves_its_pivot(bench: Workbench) -> None:
    state = only(bench.handle(ask.SetNumber(name="O2 O4", value=110)), FileState)
    assert "O4 = [110, 0]" in state.text
    assert '"O2 O4" = 110' in state.text


def test_an_edit_that_cannot_be_read_changes_nothing(bench: Workbench) -> None:
    before = bench.opened()
    found = only(bench.handle(ask.SetNumber(name="A B", value=-1)), tell.ProblemsFound)
    (problem,) = found.problems
    assert (problem.line, problem.key) == (line(FOUR_BAR, '"A B"'), 'lengths."A B"')
    assert problem.message == "must be a positive length, got -1"
    assert bench.opened() == before
    assert not bench.unsaved


def test_what_cannot_be_added_is_told_without_a_line_that_the_file_lacks(bench: Workbench) -> None:
    sliding: dict[str, str | tuple[str, ...]] = {"name": "s", "link": "rocker", "points": ("B",)}
    edit = ask.AddPart(table="sliders", typed={**sliding, "on": "bar", "line": ("O2", "O4")})
    found = only(bench.handle(edit), tell.ProblemsFound)
    assert {(problem.line, problem.key) for problem in found.problems} == {(None, "sliders[1].on")}
    assert not bench.unsaved


def test_the_text_typed_by_hand_is_judged_by_the_reader(bench: Workbench) -> None:
    found = only(bench.handle(ask.SetText(text=FOUR_BAR + "[lenghts]\n")), FileState)
    assert [lack.line for lack in found.lacks] == [len(FOUR_BAR.splitlines()) + 1]
    assert only(bench.handle(ask.Undo()), FileState).lacks == ()
    broken = only(bench.handle(ask.SetText(text="format = ")), tell.ProblemsFound)
    assert "is not TOML" in broken.problems[0].message
    whole = FOUR_BAR.replace('"A B" = 120', '"A B" = 125')
    assert only(bench.handle(ask.SetText(text=whole)), FileState).text == whole


def test_dragging_gives_cycles_and_one_step_of_history(bench: Workbench) -> None:
    bench.opened()
    for k in range(1, 6):
        events = bench.handle(ask.SetNumber(name="A B", value=120 + k, live=True))
        assert kinds(events) == ["MotionFound"]
        assert only(events, tell.MotionFound).live
    exact = lw.loads(bench.text).sweep()
    assert '"A B" = 125' in bench.text
    np.testing.assert_allclose(
        told(only(events, tell.MotionFound), "rocker"),
        exact["rocker"],
        rtol=1e-7,  # told to seven digits
    )
    state = only(bench.handle(ask.SetNumber(name="A B", value=126)), FileState)
    assert state.undo == "A B = 126"
    back = only(bench.handle(ask.Undo()), FileState)
    assert (back.text, back.undo, back.redo) == (FOUR_BAR, "", "A B = 126")
    assert '"A B" = 126' in only(bench.handle(ask.Redo()), FileState).text


def test_rates_of_points_are_left_out_during_a_drag_that_does_not_show_them(
    bench: Workbench,
) -> None:
    bench.opened()
    pages = []
    for live, rates in ((True, True), (True, False), (False, False)):
        edit = ask.SetNumber(name="A B", value=121, live=live, rates=rates)
        page = only(bench.handle(edit), tell.MotionFound).page
        assert page is not None
        pages.append(page)
    (with_rates,), (without,), (final,) = (page.motions for page in pages)
    for one, bare, last in zip(with_rates.points, without.points, final.points, strict=True):
        assert len(bare.x.content) == len(one.x.content)
        for name in ("dx", "dy", "ddx", "ddy"):
            assert getattr(bare, name).content == ""
            assert getattr(one, name).content != ""
            assert getattr(last, name).content != ""


def test_a_drag_that_is_never_let_go_is_kept(bench: Workbench) -> None:
    bench.handle(ask.SetNumber(name="A B", value=121, live=True))
    bench.handle(ask.SetNumber(name="O4 B", value=82, live=True))
    state = only(bench.handle(ask.SetNumber(name="a", value=41)), FileState)
    assert '"A B" = 121' in state.text
    assert '"O4 B" = 82' in state.text
    for text in ("a = 40", '"O4 B" = 80', '"A B" = 120'):
        assert text in only(bench.handle(ask.Undo()), FileState).text


def test_a_drag_that_is_refused_stays_where_it_was_good(bench: Workbench) -> None:
    bench.handle(ask.SetNumber(name="A B", value=122, live=True))
    assert kinds(bench.handle(ask.SetNumber(name="A B", value=0, live=True))) == ["ProblemsFound"]
    assert '"A B" = 122' in bench.text
    assert kinds(bench.handle(ask.SetNumber(name="A B", value=123, live=True))) == ["MotionFound"]
    events = bench.handle(ask.SetNumber(name="A B", value=0))
    assert kinds(events) == ["ProblemsFound", "FileState", "MotionFound"]
    assert '"A B" = 123' in only(events, FileState).text


def test_a_cycle_that_was_given_up_is_made_good(bench: Workbench) -> None:
    bench.opened()
    bench.cycle.hurried = lambda: True
    assert kinds(bench.handle(ask.SetNumber(name="A B", value=121))) == ["FileState"]
    bench.cycle.hurried = lambda: False
    # the newer change, for which it was given up, turns out to be none
    assert kinds(bench.handle(ask.SetNumber(name="A B", value=0))) == [
        "ProblemsFound",
        "MotionFound",
    ]
    assert kinds(bench.handle(ask.SetNumber(name="A B", value=0))) == ["ProblemsFound"]


def test_questions_do_not_end_a_drag(bench: Workbench) -> None:
    bench.handle(ask.SetNumber(name="A B", value=122, live=True))
    bench.handle(ask.SolveAt(at={}))
    bench.handle(ask.SetNumber(name="A B", value=123, live=True))
    bench.handle(ask.SetNumber(name="A B", value=124))
    assert only(bench.handle(ask.Undo()), FileState).text == FOUR_BAR


def test_dead_points_appear_while_a_length_is_dragged(bench: Workbench) -> None:
    bench.opened()
    for length in (50.0, 60.0, 70.0):
        events = bench.handle(ask.SetNumber(name="a", value=length, live=True))
    motion = only(events, tell.MotionFound)
    assert motion.missing > 0
    swept = lw.loads(FOUR_BAR).with_dimensions(a=70).sweep()
    assert [limit.input for limit in motion.limits] == pytest.approx(
        [limit.input for limit in swept.limits],
        abs=1e-6,  # located, not proved
    )
    assert {limit.what for limit in motion.limits} == {"dead point"}
    assert np.isnan(told(motion, "rocker")).sum() == motion.missing


def test_a_mechanism_that_cannot_close_shows_its_gap(bench: Workbench) -> None:
    events = bench.handle(ask.SetNumber(name="O4 B", value=10))
    assert kinds(events) == ["FileState", "MotionFound", "CannotClose"]
    motion, shown = only(events, tell.MotionFound), only(events, tell.CannotClose)
    assert (motion.missing, motion.rows, motion.page) == (361, 361, None)
    # crank and ground leave a distance that rod and rocker in line do not bridge, or overshoot
    crank = math.radians(shown.input["crank"])
    distance = abs(100 - 40 * complex(math.cos(crank), math.sin(crank)))
    wanted = max(distance - (120 + 10), abs(120 - 10) - distance)
    assert shown.gap == pytest.approx(wanted, rel=1e-6)
    assert wanted > 1
    # every link keeps its length; only one end is open, by the gap
    (end,) = shown.open_ends
    assert math.dist(end.joint, end.end) == pytest.approx(shown.gap, rel=1e-9)
    assert shown.remedies["O4 B"] == pytest.approx(10 + shown.gap, rel=1e-6)
    assert "cannot be closed" in shown.message


def test_the_gap_is_shown_while_dragging_too(bench: Workbench) -> None:
    events = bench.handle(ask.SetNumber(name="O4 B", value=10, live=True))
    assert kinds(events) == ["MotionFound", "CannotClose"]
    back = bench.handle(ask.SetNumber(name="O4 B", value=80, live=True))
    assert only(back, tell.MotionFound).missing == 0


def test_a_position_beyond_reach_shows_what_is_missing(bench: Workbench) -> None:
    bench.handle(ask.SetNumber(name="a", value=70))
    events = bench.handle(ask.SolveAt(at={"crank": 0}))
    assert only(events, tell.PositionFound).status == "OUT_OF_REACH"
    assert only(events, tell.CannotClose).gap > 0.1
    found = only(bench.handle(ask.SolveAt(at={"crank": 60})), tell.PositionFound)
    assert (found.status, found.certified) == ("CONVERGED", True)


def test_a_moved_point_takes_measured_lengths_along(bench: Workbench) -> None:
    events = bench.handle(ask.MovePoint(point="P", x=95, y=100))
    moved, state = only(events, tell.PointMoved), only(events, FileState)
    assert set(moved.followed) == {"A P", "B P"}
    assert moved.stayed == ()
    assert "P = [95, 100]" in state.text
    start: Any = described_as(Linkage, lw.loads(FOUR_BAR)).points["A"]  # no formula
    assert number(state, "A P").value == pytest.approx(math.dist((95, 100), start))


def test_given_lengths_stay_when_a_point_is_moved_and_it_is_said_which(bench: Workbench) -> None:
    events = bench.handle(ask.MovePoint(point="B", x=150, y=70))
    moved = only(events, tell.PointMoved)
    assert moved.stayed == ("A B", "O4 B")
    assert moved.followed == ("B P",)
    assert '"A B" = 120' in only(events, FileState).text


def test_given_lengths_follow_a_point_on_request_but_for_formulas(bench: Workbench) -> None:
    start = lw.loads(FOUR_BAR).solve()
    moved = only(
        bench.handle(ask.MovePoint(point="A", x=30, y=30, lengths_follow=True)), tell.PointMoved
    )
    assert moved.stayed == ("O2 A",)
    assert "A B" in moved.followed
    # measured to where the neighbour really is, not to where it was sketched
    wanted = math.dist((30, 30), start.points["B"])
    state = only(bench.opened(), FileState)
    assert number(state, "A B").value == pytest.approx(wanted, rel=1e-9)
    assert wanted != pytest.approx(120, rel=1e-3)


def test_a_ground_point_that_contradicts_its_length_is_refused_by_the_reader(
    bench: Workbench,
) -> None:
    found = only(bench.handle(ask.MovePoint(point="O4", x=105, y=0)), tell.ProblemsFound)
    assert "ground coordinates are exact" in found.problems[0].message
    follows = bench.handle(ask.MovePoint(point="O4", x=105, y=0, lengths_follow=True))
    assert '"O2 O4" = 105' in only(follows, FileState).text


def test_links_are_added_together_with_their_points(bench: Workbench) -> None:
    alone = bench.handle(ask.AddLink(name="bar", points=("P", "Q")))
    assert only(alone, tell.Refused).message.startswith('there is no point "Q"')
    dyad = ask.Together(
        edits=(
            ask.AddPoint(name="Q", x=60, y=150),
            ask.AddPoint(name="O6", x=20, y=180, links=("ground",)),
            ask.AddLink(name="bar", points=("P", "Q")),
            ask.AddLink(name="swing", points=("Q", "O6")),
        )
    )
    events = bench.handle(dyad)
    state = only(events, FileState)
    assert {"bar", "swing"} < {link.name for link in state.links}
    assert 'ground = ["O2", "O4", "O6"]' in state.text
    assert only(events, tell.MotionFound).rows >= 361
    removed = ask.Together(
        edits=(
            ask.RemovePoint(name="Q"),
            ask.RemoveLink(name="swing"),
            ask.RemoveLink(name="bar"),
            ask.RemovePoint(name="O6"),
        )
    )
    back = only(bench.handle(removed), FileState)
    assert {link.name for link in back.links} == {"ground", "crank", "coupler", "rocker"}


def test_lengths_go_with_the_link_that_had_them(bench: Workbench) -> None:
    edits = (ask.RemoveLink(name="rocker"), ask.AddLink(name="lever", points=("O4", "B")))
    state = only(bench.handle(ask.Together(edits=edits)), FileState)
    assert '"O4 B" = 80' not in state.text
    assert '"A B" = 120' in state.text


def test_joints_sliders_and_gears_come_and_go(bench: Workbench) -> None:
    loose = only(bench.handle(ask.RemoveJoint(link="coupler", point="A")), FileState)
    assert loose.lacks
    bench.handle(ask.Undo())
    wheels: dict[str, str | tuple[str, ...]] = {
        "name": "g",
        "centers": ("O2", "O4"),
        "radii": ("60 40",),
    }
    edits = (
        ask.AddLink(name="wheel", points=("O2",)),
        ask.AddLink(name="pinion", points=("O4",)),
        ask.AddPart(table="gears", typed={**wheels, "wheels": ("wheel", "pinion")}),
    )
    events = bench.handle(ask.Together(edits=edits))
    assert kinds(events) == ["FileState", "SketchShown"]  # nothing turns the wheels
    bench.handle(ask.Undo())
    crank = ask.Together(
        edits=(
            ask.AddLink(name="pinion", points=("O4",)),
            ask.AddPart(table="gears", typed={**wheels, "wheels": ("crank", "pinion")}),
        )
    )
    state = only(bench.handle(crank), FileState)
    assert 'wheels = ["crank", "pinion"]' in state.text
    assert state.parts == ("g",)
    gone = ask.Together(edits=(ask.RemovePart(name="g"), ask.RemoveLink(name="pinion")))
    left = only(bench.handle(gone), FileState)
    assert "[[gears]]" not in left.text
    assert left.parts == ()


def test_a_slider_is_added(tmp_path: Path) -> None:
    file = tmp_path / "dyad.toml"
    text = FOUR_BAR.replace('rocker = ["O4", "B"]', 'piston = ["B"]').replace('"O4 B" = 80\n', "")
    text = text.replace('["O2", "O4"]\ncrank', '["O2", "O4", "X"]\ncrank')
    text = text.replace("O4 = [100, 0]", "O4 = [100, 0]\nX = [200, 0]")
    slider = (
        '\n[[sliders]]\nname = "s"\nlink = "piston"\npoints = ["B"]\non = "ground"\n'
        'line = ["O2", "O4"]\nangle = 0\n'
    )
    file.write_text(text + slider)
    bench = Workbench(MechanismFile(file), lw.loads)
    swap = ask.Together(
        edits=(
            ask.RemovePart(name="s"),
            ask.AddPart(
                table="sliders",
                typed={
                    "name": "t", "link": "piston", "points": ("B",), "on": "ground",
                    "line": ("O2", "X"), "offset": "5", "angle": "0",
                },
            ),
        )
    )  # fmt: skip
    state = only(bench.handle(swap), FileState)
    assert number(state, "t.offset").value == 5.0
    changed = only(bench.handle(ask.SetNumber(name="t.offset", value=7)), FileState)
    assert "offset = 7" in changed.text


def test_a_sketch_begins_where_the_mechanism_closes(bench: Workbench) -> None:
    shown = only(bench.handle(ask.SetNumber(name="O4 B", value=25)), tell.CannotClose)
    # rod and rocker bridge 95 to 145 from O4: the crank has to stand so far away
    assert shown.elsewhere
    crank = math.radians(shown.elsewhere["crank"])
    assert 95 <= abs(100 - 40 * complex(math.cos(crank), math.sin(crank))) <= 145
    events = bench.handle(ask.AssembleAt(at=shown.elsewhere))
    assert only(events, tell.MotionFound).missing < 361
    assert [limit.what for limit in only(events, tell.MotionFound).limits] == ["dead point"] * 2
    assert '"O4 B" = 25' in bench.text
    assert kinds(bench.handle(ask.Undo()))[0] == "FileState"  # one step of the history
    assert only(bench.opened(), tell.CannotClose).gap == shown.gap


def test_nothing_is_put_elsewhere_where_points_follow_from_equations(tmp_path: Path) -> None:
    file = tmp_path / "rapier.toml"
    file.write_text(lw.example_text("rapier-drive"), encoding="utf-8")
    bench = Workbench(MechanismFile(file), lw.loads)
    refused = only(bench.handle(ask.AssembleAt(at={"θ12": 90.0})), tell.Refused)
    assert "only the points of a sketch" in refused.message


def test_a_point_with_locked_lengths_moves_on_their_circles(bench: Workbench) -> None:
    edit = ask.MovePoints(places={"P": (100.0, 150.0)}, keep=("B P", "P gone", "P"))
    b, p = (complex(*bench._before().places[name]) for name in ("B", "P"))
    state = only(bench.handle(edit), FileState)
    moved = complex(*state.points["P"])
    assert abs(moved - b) == pytest.approx(abs(p - b), rel=1e-9)
    assert abs(moved - p) > 1
    here = complex(*bench._before().places["P"])
    both = ask.MovePoints(places={"P": (0.0, 0.0)}, keep=("B P", "A P"))
    there = complex(*only(bench.handle(both), FileState).points["P"])
    assert there == pytest.approx(here, rel=1e-9)  # there is no other place on both circles


@pytest.mark.parametrize("width", [-1.0, 1e300])
def test_a_view_has_a_width(width: float, bench: Workbench) -> None:
    told = only(bench.handle(ask.SetSheet(width=width, edited=True)), tell.Refused)
    assert told.message == "the width of the view must be from 0 to 1e+100"


def test_links_are_reversed_and_points_moved_together(bench: Workbench) -> None:
    state = only(bench.handle(ask.ReverseLink(name="rocker")), FileState)
    assert 'rocker = ["B", "O4"]' in state.text
    places = {"O2": (10.0, 0.0), "O4": (110.0, 0.0)}
    state = only(bench.handle(ask.MovePoints(places=places)), FileState)
    assert state.points["O2"] == (10.0, 0.0)
    assert '"O2 O4" = 100' in state.text


def test_the_path_of_a_point_is_asked_for(bench: Workbench) -> None:
    on = only(bench.handle(ask.TracePoint(point="B", on=True)), FileState)
    assert (on.traced, on.traceable) == (("P", "B"), ("O2", "A", "B", "O4", "P"))
    for point in ("P", "B"):
        off = only(bench.handle(ask.TracePoint(point=point, on=False)), FileState)
    assert off.traced == ()
    assert "[trace]" not in off.text
    wrong = only(bench.handle(ask.TracePoint(point="Z", on=True)), tell.Refused)
    assert wrong.message.startswith('there is no point "Z"')


def test_a_number_takes_the_place_of_a_formula_if_that_is_meant(bench: Workbench) -> None:
    refused = only(bench.handle(ask.SetNumber(name="O2 A", value=45)), tell.Refused)
    assert "is the formula a" in refused.message
    edit = ask.SetNumber(name="O2 A", value=45, any_formula=True)
    assert '"O2 A" = 45' in only(bench.handle(edit), FileState).text


def test_something_else_is_driven(bench: Workbench) -> None:
    state = only(bench.opened(), FileState)
    drives = [(drive.kind, drive.name) for drive in state.drives]
    assert drives == [("link", "crank"), ("link", "coupler"), ("link", "rocker")]
    state = only(bench.handle(ask.SetInput(drive="link", name="rocker")), FileState)
    assert [(one.drive, one.name) for one in state.inputs] == [("link", "rocker")]


def test_the_guess_is_dragged_by_a_point(bench: Workbench) -> None:
    asked = ask.NewtonSteps(guess={}, at={"crank": 60.0}, pull="B", x=100.0, y=200.0)
    shown = only(bench.handle(asked), tell.NewtonShown)
    assert shown.guess["rocker"] == pytest.approx(90.0)  # straight up from O4 = (100, 0)
    first = shown.iterates[0]
    assert first.unknowns == pytest.approx(shown.guess)
    assert first.points["B"] == pytest.approx((100.0, 80.0), rel=1e-6)
    wrong = only(bench.handle(ask.NewtonSteps(guess={}, at={}, pull="Z")), tell.Refused)
    assert wrong.message == 'there is no point "Z" (points: O2, O4, A, B, P)'


def test_the_input_is_set(bench: Workbench) -> None:
    events = bench.handle(ask.SetInput(start=30, stop=90, step=2, speed="300 rpm"))
    state, motion = only(events, FileState), only(events, tell.MotionFound)
    assert (state.inputs[0].start, state.inputs[0].stop, motion.rows) == (30, 90, 31)
    assert state.inputs[0].speed == "300 rpm"
    other = only(bench.handle(ask.SetInput(drive="link", name="rocker")), FileState)
    assert other.inputs[0].name == "rocker"
    refused = only(bench.handle(ask.SetInput(drive="wheel", name="rocker")), tell.Refused)
    assert refused.message.startswith('"wheel" cannot be driven (kinds: link, joint, slider,')
    second = only(bench.handle(ask.SetInput(number=1, start=2)), tell.Refused)
    assert second.message == "there is no input 2: the mechanism has 1"


def test_a_table_of_very_many_rows_is_shown_with_fewer(bench: Workbench) -> None:
    motion = only(bench.handle(ask.SetInput(start=0, stop=360, step=0.01)), tell.MotionFound)
    assert motion.rows == 721
    assert motion.message == "shown at 721 of the 36001 rows of the file"


def test_a_configuration_is_listed_and_chosen(bench: Workbench) -> None:
    found = only(bench.handle(ask.ListConfigurations(at={})), tell.ConfigurationsFound)
    assert [way.name for way in found.ways] == ["open", "crossed"]
    open_, crossed = (way.points["B"] for way in found.ways)
    assert math.dist(open_, crossed) > 10
    state = only(bench.handle(ask.ChooseConfiguration(name="crossed")), FileState)
    assert state.configuration == "crossed"
    position = only(bench.handle(ask.SolveAt(at={})), tell.PositionFound)
    assert position.points["B"] == pytest.approx(crossed)
    assert (
        "configuration" not in only(bench.handle(ask.ChooseConfiguration(name="")), FileState).text
    )


def test_newton_steps_are_shown_from_a_guess(bench: Workbench) -> None:
    guess = {"coupler": 50.0, "rocker": 100.0}
    shown = only(bench.handle(ask.NewtonSteps(guess=guess, at={"crank": 60})), tell.NewtonShown)
    first, last = shown.iterates[0], shown.iterates[-1]
    assert dict(first.unknowns) == pytest.approx(guess)
    assert shown.status == "CONVERGED"
    assert last.step is None
    assert dict(last.unknowns) == pytest.approx(dict(shown.unknowns))
    norms = [each.norm for each in shown.iterates]
    assert norms[-1] < 1e-9 < norms[0]
    for each in shown.iterates[:-1]:  # the linear system that gives the step, J Δ = -F
        step = np.linalg.solve(np.array(each.jacobian), -np.array(each.residuals))
        assert np.linalg.norm(each.residuals) == pytest.approx(each.norm)
        assert each.step <= np.abs(step).max() + 1e-12  # long steps are shortened
    assert last.points["P"] == pytest.approx(shown.points["P"])
    assert first.points["B"] != pytest.approx(last.points["B"])


def test_newton_says_which_trouble_it_met(tmp_path: Path) -> None:
    for name in ("newton-another-root", "newton-extremum", "newton-inflection"):
        file = tmp_path / f"{name}.toml"
        file.write_text(lw.example_text(name))
        bench = Workbench(MechanismFile(file), lw.loads)
        shown = only(
            bench.handle(ask.NewtonSteps(guess={}, at={}, full_steps=True)), tell.NewtonShown
        )
        wanted = lw.example(name).solve(options=lw.NewtonOptions(largest_turn=math.inf)).failure
        assert wanted is not None
        assert wanted.trouble is not None
        assert shown.trouble == wanted.trouble.name


def test_wrong_names_and_numbers_are_refused_with_what_exists(bench: Workbench) -> None:
    requests: list[tuple[ask.Request, str]] = [
        (ask.SetNumber(name="zz", value=1), '"zz" is not a number of Four-bar that can vary'),
        (ask.MovePoint(point="Z", x=0, y=0), 'there is no point "Z" (points: O2, A, B, O4, P)'),
        (ask.AddPoint(name="A", x=0, y=0), '"A" is already in [points]: choose another name'),
        (ask.AddLink(name="crank", points=("A",)), '"crank" is already in [links]'),
        (ask.RemoveLink(name="rod"), 'there is no link "rod" (links: '),
        (ask.RemovePoint(name="Z"), 'there is no point "Z" (points: '),
        (ask.RemovePart(name="s"), 'there is no "s" (there are no parts)'),
        (ask.AddJoint(link="crank", point="A"), '"crank" carries "A" already'),
        (ask.RemoveJoint(link="crank", point="P"), '"crank" does not carry "P" (points: O2, A)'),
        (ask.SolveAt(at={"zz": 1}), '"zz" is not an input of Four-bar (inputs: crank)'),
        (ask.NewtonSteps(guess={"x": 1}, at={}), '"x" is not an unknown of Four-bar'),
        (ask.NewtonSteps(guess={}, at={}, max_steps=0), "max_steps must be from 1 to 200"),
        (ask.Undo(), "there is nothing to undo"),
        (ask.Redo(), "there is nothing to redo"),
    ]
    for request, message in requests:
        assert only(bench.handle(request), tell.Refused).message.startswith(message)
    assert bench.text == FOUR_BAR


def test_points_of_equations_cannot_be_dragged(tmp_path: Path) -> None:
    file = tmp_path / "rapier.toml"
    file.write_text(lw.example_text("rapier-drive"), encoding="utf-8")
    bench = Workbench(MechanismFile(file), lw.loads)
    refused = only(bench.handle(ask.MovePoint(point="A", x=0, y=0)), tell.Refused)
    assert refused.message.startswith("the points of this file follow from its equations")
    state = only(bench.handle(ask.SetNumber(name="theta13", value=190)), FileState)
    assert '"θ13" = 190' in state.text


@pytest.mark.parametrize("name", thinned(lw.examples()))
def test_every_mechanism_of_the_library_opens_and_is_edited(name: str, tmp_path: Path) -> None:
    file = tmp_path / f"{name}.toml"
    file.write_text(lw.example_text(name), encoding="utf-8")
    bench = Workbench(MechanismFile(file), lw.loads)
    state = bench.opened()[1]
    assert isinstance(state, FileState)
    assert state.equations or name in NO_LOOP
    plain = [n for n in state.numbers if not n.formula and n.table not in ("points", "guess")]
    for each in plain[:1]:
        events = bench.handle(ask.SetNumber(name=each.name, value=each.value * 1.0001 + 1e-4))
        assert events
        assert not isinstance(events[0], tell.Refused), events[0]


def test_a_sketch_is_drawn_whatever_the_size_of_its_wheels(tmp_path: Path) -> None:
    """The ground symbol of a wheel of 30 mm is no length next to coordinates of 1e23 mm."""
    text = lw.example_text("crossed-belt").replace("O = [-60, 0]", "O = [-1e23, 0]")
    bench = Workbench(MechanismFile(tmp_path / "far.toml", text), lw.loads)
    assert "CannotClose" in kinds(bench.opened())


# The file on disk


def test_saving_writes_the_text_and_nothing_else(bench: Workbench, path: Path) -> None:
    bench.handle(ask.SetNumber(name="a", value=42))
    assert path.read_text(encoding="utf-8") == FOUR_BAR
    events = bench.handle(ask.Save())
    assert kinds(events) == ["Saved", "FileState"]
    assert not only(events, FileState).unsaved
    assert path.read_text(encoding="utf-8") == bench.text
    assert [p.name for p in path.parent.iterdir()] == ["four-bar.toml"]
    assert bench.poll() == []  # what was written here is no news


def touch_later(path: Path, text: str) -> None:
    """Write as another program would, with another date whatever the clock's grain."""
    path.write_text(text, encoding="utf-8")
    stat = path.stat()
    os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns + 10_000_000))


OTHER = FOUR_BAR.replace('"A B" = 120', '"A B" = 130')


def test_a_change_on_disk_is_picked_up(bench: Workbench, path: Path) -> None:
    assert bench.poll() == []
    touch_later(path, OTHER)
    events = bench.poll()
    assert kinds(events) == ["FileChanged", "FileState", "MotionFound"]
    assert only(events, tell.FileChanged).reloaded
    assert only(events, FileState).text == OTHER
    assert not bench.unsaved
    assert bench.poll() == []
    assert only(bench.handle(ask.Undo()), FileState).text == FOUR_BAR  # nothing is lost


def test_a_new_date_alone_is_no_change(bench: Workbench, path: Path) -> None:
    touch_later(path, FOUR_BAR)
    assert bench.poll() == []


def test_a_change_on_disk_does_not_take_unsaved_work(bench: Workbench, path: Path) -> None:
    bench.handle(ask.SetNumber(name="a", value=42))
    touch_later(path, OTHER)
    changed = only(bench.poll(), tell.FileChanged)
    assert (changed.reloaded, changed.unsaved) == (False, True)
    assert bench.poll() == []  # said once
    assert only(bench.opened(), tell.FileChanged) == changed  # and to every new page
    refused = only(bench.handle(ask.Save()), tell.Refused)
    assert refused.message.endswith(
        "has been changed by another program since it was read here: reload it, or save again "
        "and overwrite it"
    )
    assert path.read_text(encoding="utf-8") == OTHER
    bench.handle(ask.Save(overwrite=True))
    assert "a = 42" in path.read_text(encoding="utf-8")


def test_a_conflict_can_be_ended_by_reloading(bench: Workbench, path: Path) -> None:
    bench.handle(ask.SetNumber(name="a", value=42))
    touch_later(path, OTHER)
    bench.poll()
    state = only(bench.handle(ask.Reload()), FileState)
    assert (state.text, state.unsaved) == (OTHER, False)
    assert "a = 42" in only(bench.handle(ask.Undo()), FileState).text


def test_saving_sees_a_change_that_nobody_polled(bench: Workbench, path: Path) -> None:
    bench.handle(ask.SetNumber(name="a", value=42))
    stat = path.stat()
    path.write_text(OTHER, encoding="utf-8")
    os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))  # the same date and size
    assert len(OTHER) == len(FOUR_BAR)
    assert kinds(bench.handle(ask.Save())) == ["Refused"]
    assert path.read_text(encoding="utf-8") == OTHER


def test_a_broken_file_on_disk_leaves_the_picture_and_is_explained(
    bench: Workbench, path: Path
) -> None:
    touch_later(path, FOUR_BAR.replace("= 120", "= -120"))
    found = only(bench.poll(), tell.ProblemsFound)
    assert [problem.line for problem in found.problems] == [line(FOUR_BAR, '"A B"')]
    assert bench.poll() == []
    assert bench.text == FOUR_BAR
    assert only(bench.handle(ask.Save()), tell.Refused)  # it would undo what is being written
    os.utime(path, ns=(1, 1))
    touch_later(path, OTHER)  # mended
    assert only(bench.poll(), FileState).text == OTHER


def test_a_file_that_is_removed_is_said_and_can_be_written_again(
    bench: Workbench, path: Path
) -> None:
    path.unlink()
    changed = only(bench.poll(), tell.FileChanged)
    assert changed.missing
    assert bench.poll() == []
    assert only(bench.handle(ask.Save()), tell.Refused)
    assert not path.exists()
    assert kinds(bench.handle(ask.Save(overwrite=True))) == ["Saved", "FileState"]
    assert path.read_text(encoding="utf-8") == FOUR_BAR


def test_unsaved_work_is_kept_beside_the_file(bench: Workbench, path: Path) -> None:
    assert bench.keep_unsaved() is None
    bench.handle(ask.SetNumber(name="A B", value=121, live=True))  # not even let go
    kept = bench.keep_unsaved()
    assert kept == path.parent / "four-bar.unsaved.toml"
    assert '"A B" = 121' in kept.read_text(encoding="utf-8")
    assert bench.keep_unsaved() == path.parent / "four-bar.unsaved-2.toml"  # over nothing
    assert path.read_text(encoding="utf-8") == FOUR_BAR


def test_windows_line_ends_and_bom_survive(tmp_path: Path) -> None:
    file = tmp_path / "windows.toml"
    data = b"\xef\xbb\xbf" + FOUR_BAR.replace("\n", "\r\n").encode()
    file.write_bytes(data)
    bench = Workbench(MechanismFile(file), lw.loads)
    bench.handle(ask.SetNumber(name="a", value=42))
    bench.handle(ask.Save())
    assert file.read_bytes() == data.replace(b"a = 40 ", b"a = 42 ")


@pytest.mark.parametrize(
    ("text", "readable"),
    [
        ("format = 1\n[points]\n", True),
        ("format = \n", False),
        ("format = 1\n[equations]\n", False),
    ],
)
def test_a_file_that_is_no_mechanism_is_opened_and_mended(
    text: str, readable: bool, tmp_path: Path
) -> None:
    file = tmp_path / "broken.toml"
    file.write_text(text, encoding="utf-8")
    bench = Workbench(MechanismFile(file), lw.loads)
    state = only(bench.opened(), FileState)
    assert (state.text, state.readable) == (text, readable)
    assert state.lacks
    assert only(bench.handle(ask.SolveAt(at={})), tell.Refused)
    assert only(bench.handle(ask.SetText(text=FOUR_BAR)), FileState).lacks == ()


def test_entries_of_a_text_that_is_not_toml_cannot_be_edited(tmp_path: Path) -> None:
    file = tmp_path / "broken.toml"
    file.write_text("format = 1\n[points]\nA = [0; 0]\n", encoding="utf-8")
    bench = Workbench(MechanismFile(file), lw.loads)
    point = ask.AddPoint(name="B", x=0.0, y=1.0)
    for edit in (point, Mirror(places={}), ask.Together(edits=(point,))):
        message = only(bench.handle(edit), tell.Refused).message
        assert message.startswith("correct the text first: line 3 is not TOML: unclosed array")


def test_a_question_that_is_wrong_is_listed_without_a_thing_to_remove(tmp_path: Path) -> None:
    path = tmp_path / "asks.toml"
    question = '[[questions]]\ntext = "How far?"\nanswer = "stroke(X.x)"\ntolerance = 1\n'
    path.write_text(FOUR_BAR + question, encoding="utf-8")
    bench = Workbench(MechanismFile(path), lw.loads)
    (lack,) = only(bench.opened(), FileState).lacks
    assert (lack.kind, lack.remedies) == ("", ())
    assert lack.key == "questions[1].answer"


@pytest.mark.parametrize("content", [None, "", " \n"])
def test_a_missing_or_empty_file_is_a_blank_sheet(content: str | None, tmp_path: Path) -> None:
    path = tmp_path / "new.toml"
    if content is not None:
        path.write_text(content, "utf-8")
    bench = Workbench(MechanismFile(path, blank_sheet("new")), lw.loads)
    state, shown = bench.opened()[1:]
    assert isinstance(state, FileState)
    assert isinstance(shown, tell.SketchShown)
    assert (state.title, state.points, state.unsaved) == ("new", {}, False)
    assert [lack.message[:20] for lack in state.lacks] == ["Draw the first link:"]
    assert bench.poll() == []
    bench.handle(ask.AddPoint(name="A", x=1, y=2))
    assert only(bench.handle(ask.Save()), FileState).unsaved is False
    assert "A = [1.0, 2.0]" in path.read_text("utf-8")


def test_a_mechanism_is_drawn_step_by_step(tmp_path: Path) -> None:
    bench = Workbench(MechanismFile(tmp_path / "new.toml", blank_sheet("new")), lw.loads)
    places = {"A": (0, 0), "B": (30, 40), "C": (140, 60), "D": (100, 0)}
    for name, (x, y) in places.items():
        bench.handle(ask.AddPoint(name=name, x=x, y=y))
    for name, points in {"crank": ("A", "B"), "coupler": ("B", "C"), "rocker": ("D", "C")}.items():
        state = only(bench.handle(ask.AddLink(name=name, points=points)), FileState)
    (fixed,) = (remedy for lack in state.lacks for remedy in lack.remedies)
    assert fixed.label == "Fix A and D"
    state = only(bench.handle(ask.Together(edits=fixed.edits)), FileState)
    driven, *_ = (remedy for lack in state.lacks for remedy in lack.remedies)
    assert driven.label == "Drive crank"
    events = bench.handle(ask.Together(edits=driven.edits))
    assert only(events, FileState).lacks == ()
    assert only(events, tell.MotionFound).certified == 361
    for _ in range(9):
        assert only(bench.handle(ask.Undo()), FileState).lacks
    assert only(bench.handle(ask.Undo()), tell.Refused)


def test_a_five_bar_is_driven_at_both_cranks(tmp_path: Path) -> None:
    bench = Workbench(MechanismFile(tmp_path / "new.toml", blank_sheet("new")), lw.loads)
    places = {"A": (0, 0), "B": (30, 60), "C": (75, 100), "D": (120, 60), "F": (150, 0)}
    for name, (x, y) in places.items():
        bench.handle(ask.AddPoint(name=name, x=x, y=y))
    for k, points in enumerate(("AB", "BC", "CD", "DF")):
        edit = ask.AddLink(name=f"link{k + 2}", points=tuple(points))
        state = only(bench.handle(edit), FileState)
    for wanted in ("Fix A and F", "Drive link2", "Drive link5"):
        remedies = {r.label: r for lack in state.lacks for r in lack.remedies}
        events = bench.handle(ask.Together(edits=remedies[wanted].edits))
        state = only(events, FileState)
    assert state.lacks == ()
    assert [one.name for one in state.inputs] == ["link2", "link5"]
    assert only(events, tell.MotionFound).certified > 0


def test_a_file_that_does_not_exist_is_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises(lw.MechanismFileError, match="there is no such file"):
        MechanismFile(tmp_path / "none.toml")


def test_the_text_under_edit_is_linked(bench: Workbench, monkeypatch: pytest.MonkeyPatch) -> None:
    app = "https://example.org/"
    bench.handle(ask.SetNumber(name="a", value=41.0))
    (plain,) = bench.handle(ask.MakeLink())
    assert plain == tell.LinkMade(link=fragment_of(bench.text), embed="", qr="", note="")
    made = only(bench.handle(ask.MakeLink(app=app)), tell.LinkMade)
    assert made.link == app + plain.link
    assert made.embed == embed_snippet(made.link, "Four-bar")
    assert (made.qr, made.note) == (qr_svg(made.link), "")
    monkeypatch.setitem(sys.modules, "segno", None)
    without = only(bench.handle(ask.MakeLink(app=app)), tell.LinkMade)
    assert (without.qr, without.note) == ("", 'QR codes need segno: pip install "linkwork[qr]"')
    assert without.link == made.link
    refused = only(bench.handle(ask.MakeLink(app="example.org")), tell.Refused)
    assert refused.message.startswith('"example.org" is not the address of an app')


def test_a_draft_is_linked_too(tmp_path: Path) -> None:
    bench = Workbench(MechanismFile(tmp_path / "new.toml", "[points]\nA = [0, 0]\n"), lw.loads)
    (made,) = bench.handle(ask.MakeLink())
    assert made == tell.LinkMade(link=fragment_of(bench.text), embed="", qr="", note="")


def test_a_point_without_a_value_is_refused_and_one_in_a_file_is_shown(bench: Workbench) -> None:
    (refused,) = bench.handle(ask.AddPoint(name="Q", x=0.0, y="O2", links=()))
    assert isinstance(refused, tell.Refused)
    assert '"O2" is not defined' in refused.message
    state, *_ = bench.handle(ask.SetText(text=bench.text.replace("P = [90, 90]", 'P = [90, "O2"]')))
    assert isinstance(state, FileState)
    assert '"O2" is not defined' in state.lacks[0].message
    assert "P.y" not in {number.name for number in state.numbers}


def test_inputs_with_laws_are_shown_as_one_table_of_times(tmp_path: Path) -> None:
    text = lw.example_text("double-pendulum")
    head = text[: text.index("[[input]]")]
    laws = "".join(
        f'[[input]]\nlink = "{link}"\nlaw = "10*t"\n{times}\n'
        for link, times in (("upper", "to = 1"), ("lower", "step = 0.25"))
    )
    path = tmp_path / "arm.toml"
    path.write_text(head + laws, encoding="utf-8")
    opened = Workbench(MechanismFile(path), lw.loads).opened()
    (shown,) = only(opened, FileState).inputs
    assert (shown.name, shown.start, shown.stop, shown.rows) == ("t", 0.0, 1.0, 5)
