"""A task under edit: what it answers, and what stays after a refusal."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask, task_requests as do
from linkwork.app.live.file_state import FileState
from linkwork.app.live.messages import GivenUpError, Hurry
from linkwork.app.live.opened_file import MechanismFile, NoSign, new_file, task_template
from linkwork.app.live.session import Bench, Desk
from linkwork.app.live.task_events import (
    CognatesFound,
    DesignFound,
    DesignOpened,
    TaskSolved,
    TaskState,
    TaskUnsolved,
)
from linkwork.app.live.workbench import Workbench
from linkwork.app.task import designs
from linkwork.app.task.bench import SolveTask, TaskBench
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.listing import rounded_down
from linkwork.synthesis import six_bars as watt_six_bars
from linkwork.synthesis.loops.limits import GUIDED
from linkwork.synthesis.solvers.result import Synthesis
from linkwork.synthesis.solvers.solving import solve_task
from linkwork.synthesis.tasks.task import MECHANISMS, Task
from linkwork.synthesis.tasks.templates import template_names, template_text
from tests.synthesis.six_bars.six_bars import ARMS, chebyshev, member_of


def opened(folder: Path, name: str, solve: SolveTask = solve_task) -> Bench:
    """A bench on a task to begin with, in a file of a folder."""
    path = folder / f"{name}.toml"
    path.write_text(task_template(name).text, encoding="utf-8")
    return Bench(MechanismFile(path), lw.loads, solve)


def searching(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
    """A solver that takes long."""
    assert progress is not None
    progress(0.5)
    raise InputError(f"no designs are found for {task.name}")


def last(events: list[tell.Event], kind: type) -> tell.Event:
    """The last event of a kind."""
    return [event for event in events if isinstance(event, kind)][-1]


def solved(events: list[tell.Event]) -> TaskSolved:
    """The designs that were told."""
    found = last(events, TaskSolved)
    assert isinstance(found, TaskSolved)
    return found


def positions(bench: Bench) -> list[tuple[float, float]]:
    """The points of a task as its text has them."""
    task = lw.Task.loads(bench.text).described
    return [position.point for position in task.positions]


@pytest.mark.parametrize("name", ["three-poses", "four-poses", "five-poses", "function"])
def test_a_task_to_begin_with_has_sound_designs(tmp_path: Path, name: str) -> None:
    found = solved(opened(tmp_path, name).opened())
    assert found.sound >= 1
    assert found.chosen is not None
    assert found.chosen.design.sound


def test_a_six_bar_is_shown_moving_through_its_positions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    member = member_of(ARMS, np.radians(90.0 * chebyshev()))
    monkeypatch.setattr(watt_six_bars, "watt_member", lambda: member)
    path = tmp_path / "log.toml"
    path.write_text(
        'format = 1\ntask = "function"\nmechanism = "watt-ii"\n'
        '[function]\nof = "log10(x)"\nx = [1, 10]\ninput = [0, 90]\noutput = [0, 90]\n'
    )
    bench = Bench(MechanismFile(path), lw.loads, solve_task)
    found = solved(bench.opened()).chosen
    assert found is not None
    assert found.skeleton is not None
    assert (found.design.mechanism, found.design.sound) == ("watt-ii", True)
    assert len(found.skeleton.fixed) == 3
    assert len(found.rows) > 80
    assert np.allclose(found.marks, np.array(90.0 * chebyshev()) / 90.0 * (len(found.rows) - 1))
    events = bench.handle(do.ShowDesign(design=0))
    assert last(events, DesignFound) == found


def test_every_task_to_begin_with_can_be_read() -> None:
    assert len(template_names()) == 6
    for name in template_names():
        lw.Task.loads(task_template(name).text)


def test_a_dragged_point_changes_its_numbers_and_is_one_step_of_the_history(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    before = bench.text
    bench.opened()
    for x in (-25.0, -24.0, -24.5):
        events = bench.handle(do.MoveTaskPoint(of="position", index=1, x=x, y=52, live=True))
        assert solved(events).live
    bench.handle(do.MoveTaskPoint(of="position", index=1, x=-24.5, y=52))
    assert positions(bench)[1] == (-24.5, 52)
    assert "# A body in five poses" in bench.text  # comments stay
    bench.handle(ask.Undo())
    assert bench.text == before


@pytest.mark.parametrize("mechanism", [*MECHANISMS, *GUIDED])
def test_the_shown_motion_passes_the_positions_in_order(tmp_path: Path, mechanism: str) -> None:
    bench = opened(tmp_path, "three-poses" if mechanism in GUIDED else "four-poses")
    bench.handle(do.SetTaskEntry(key="wanted", value=None))
    events = bench.handle(do.SetTaskEntry(key="mechanism", value=mechanism))
    found = solved(events).chosen
    assert found is not None
    assert found.design.mechanism == mechanism
    rows, marks, at = np.array(found.rows), np.array(found.marks), np.array(found.at)
    assert (np.diff(marks) > 0).all() or (np.diff(marks) < 0).all()
    # a motion in equal steps of the input: between two rows it is nearly straight
    below = np.clip(np.floor(marks).astype(int), 0, len(rows) - 2)
    share = (marks - below)[:, None]
    passed = (1 - share) * rows[below] + share * rows[below + 1]
    assert np.abs(passed - at).max() < 1e-3 * np.ptp(rows)
    assert np.abs(at[:, 4:] - positions(bench)).max() < 1e-9 * np.ptp(rows)
    # each joint keeps its distance from a fixed pivot, slides on a fixed line, or a line through
    # it passes the pivot
    joints = rows[:, 0:4:2] + 1j * rows[:, 1:4:2]
    coupler = (joints[:, 1] - joints[:, 0]) / abs(joints[:, 1] - joints[:, 0])
    for joint, held, line in zip(joints.T, found.fixed, found.lines, strict=True):
        start, *others = (complex(*place) for place in held)
        off = np.abs(joint - start) - abs(joint[0] - start)
        if others:
            off = ((joint - start) * np.conj(others[0] - start)).imag / abs(others[0] - start)
        elif line is not None:
            off = ((start - joint) * (coupler * np.exp(1j * line)).conj()).imag
        assert np.abs(off).max() < 1e-9 * np.ptp(rows)


def test_a_curve_is_smooth_where_the_point_is_fast() -> None:
    """An inverted slider-crank, whose block is near its pivot on the way back."""
    found = lw.Task.loads(template_text("three-poses")).solve()
    for index, design in enumerate(found.designs[:20]):
        pieces = [np.reshape(part, (-1, 2)) for part in designs.design_found(found, index).curve]
        size = np.ptp(np.concatenate(pieces), axis=0).max()
        chords = [np.linalg.norm(np.diff(part, axis=0), axis=1).max() for part in pieces]
        assert max(chords) < 0.02 * size
        assert sum(map(len, pieces)) < 1000
        assert design.delivered


def test_a_refused_design_has_its_reason_and_no_motion(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    refused = [design for design in solved(bench.opened()).designs if not design.sound]
    assert refused
    assert all(design.reason for design in refused)
    (shown,) = bench.handle(do.ShowDesign(design=refused[0].index))
    assert isinstance(shown, DesignFound)
    assert shown.rows == ()
    assert len(shown.at) == 5


def test_doubtful_designs_have_a_remark_and_a_task_without_sound_ones_advice(
    tmp_path: Path,
) -> None:
    head = 'format = 1\ntask = "motion"\nmechanism = "four-bar"\n'
    poses = [(45, 81, 33), (-12, 93, 40.2), (-24, 40, 17.9), (35, 2, -6), (80, 27, 6.8)]
    row = "[[positions]]\npoint = [{}, {}]\nangle = {}\n"
    text = head + "".join(row.format(*pose) for pose in poses)
    bench = opened(tmp_path, "five-poses")
    found = solved(bench.handle(ask.SetText(text=text)))
    assert found.advice == ""
    slight = [design for design in found.designs if "transmission = { least" in design.remark]
    assert slight
    assert all(design.transmission < 30 for design in slight if design.transmission)
    strict = solved(
        bench.handle(ask.SetText(text=text + "[wanted]\ntransmission = { least = 30 }\n"))
    )
    assert not any("transmission" in design.remark for design in strict.designs)
    poses = [(0, 0, 90), (-400, 1100, 50), (-1300, 1500, 5)]
    text = head + "".join(row.format(*pose) for pose in poses)
    text += "[wanted.fixed_pivots]\ninside = [[-1500, 200], [-100, 200], [-100, 1400]]\n"
    without = solved(bench.handle(ask.SetText(text=text)))
    assert without.sound == 0
    assert "enlarge the region of fixed pivots" in without.advice


def test_without_sound_designs_near_misses_come_first_and_the_best_one_is_chosen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(designs, "_MOST_REFUSED", 8)
    bench = opened(tmp_path, "five-poses")
    first = solved(bench.opened())
    assert first.advice == ""
    assert first.chosen is not None
    bound = do.SetTaskEntry(key="wanted.transmission.least", value=89)
    again = solved(bench.handle(bound))
    assert again.sound == 0
    assert again.chosen is not None
    assert again.chosen.fixed == first.chosen.fixed
    assert again.left_out == again.count - 8
    # the design in sight stays in the list
    listed = [design.index for design in again.designs]
    unlisted = next(k for k in range(again.count) if k not in listed)
    bench.handle(do.ShowDesign(design=unlisted))
    kept = solved(bench.handle(do.SetTaskEntry(key="wanted.transmission.least", value=88)))
    assert kept.chosen is not None
    assert kept.chosen.design.index == unlisted
    assert kept.designs[-1] == kept.chosen.design
    anew = solved(Bench(MechanismFile(_written(bench, tmp_path)), lw.loads, solve_task).opened())
    near = [design for design in anew.designs if design.reason.startswith("transmission angle")]
    angles = [design.transmission or 0.0 for design in near]
    assert len(near) > 1
    assert list(anew.designs[: len(near)]) == near
    assert angles == sorted(angles, reverse=True)
    assert anew.chosen is not None
    assert anew.chosen.design == anew.designs[0]
    assert anew.advice == f"The best least transmission angle is {rounded_down(angles[0], 4):g}°."


def _written(bench: Bench, folder: Path) -> Path:
    path = folder / "anew.toml"
    path.write_text(bench.text, encoding="utf-8")
    return path


def test_a_pivot_of_four_poses_stays_on_their_curve(tmp_path: Path) -> None:
    bench = opened(tmp_path, "four-poses")
    bench.opened()
    found = solved(bench.handle(do.AddTaskPoint(of="fixed pivot", x=50, y=50)))
    assert found.chosen is not None
    (pivot,) = lw.Task.loads(bench.text).described.given.fixed_pivots
    ends = [math.dist(pivot, fixed) for (fixed,) in found.chosen.fixed]
    assert min(ends) < 1e-6
    # also when a pose is moved, which moves the curve
    moved = bench.handle(do.MoveTaskPoint(of="position", index=2, x=-112, y=120))
    assert solved(moved).count > 0


def test_two_equal_points_are_told_and_can_be_drawn_apart(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    bench.opened()
    x, y = positions(bench)[0]
    bench.handle(do.TurnPose(index=1, angle=0))
    events = bench.handle(do.MoveTaskPoint(of="position", index=1, x=x, y=y))
    unsolved = last(events, TaskUnsolved)
    assert isinstance(unsolved, TaskUnsolved)
    assert "the same as position 1" in unsolved.problems[0].message
    assert unsolved.problems[0].line is not None
    state = last(events, TaskState)
    assert isinstance(state, TaskState)
    assert len(state.positions) == 5
    assert solved(bench.handle(do.MoveTaskPoint(of="position", index=1, x=-26, y=52))).count


def test_a_half_drawn_task_is_shown_with_what_it_lacks(tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_text('format = 1\ntask = "path"\n', encoding="utf-8")
    bench = Bench(MechanismFile(path), lw.loads, searching)
    unsolved = last(bench.opened(), TaskUnsolved)
    assert isinstance(unsolved, TaskUnsolved)
    assert unsolved.problems[0].key == "positions"
    for k in range(2):
        events = bench.handle(do.AddTaskPoint(of="position", x=10.0 * k, y=0))
    assert positions(bench) == [(0, 0), (10, 0)]
    assert isinstance(events[0], TaskState)


def test_a_text_that_is_not_toml_keeps_the_canvas_and_refuses_drags(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    bench.opened()
    events = bench.handle(ask.SetText(text=bench.text + "\n[["))
    state = last(events, TaskState)
    assert isinstance(state, TaskState)
    assert len(state.positions) == 5
    assert state.problems[0].line is not None
    (refused,) = bench.handle(do.MoveTaskPoint(of="position", index=0, x=1, y=1))
    assert isinstance(refused, tell.Refused)
    assert "correct the text first" in refused.message


def test_wrong_requests_change_nothing(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    bench.opened()
    before = bench.text
    for request in (
        do.MoveTaskPoint(of="position", index=9, x=0, y=0),
        do.MoveTaskPoint(of="wheel", index=0, x=0, y=0),
        do.ShowDesign(design=99),
        do.OpenDesign(design=-1),
        do.SetRegion(corners=(1.0, 2.0, 3.0)),
        do.DrawCurve(points=(1.0, 2.0)),
        do.OpenTask(name="twelve-poses"),
        do.ReturnToTask(),
        ask.SetNumber(name="a", value=1),
    ):
        (refused,) = bench.handle(request)
        assert isinstance(refused, tell.Refused), request
        assert "error in Linkwork" not in refused.message
    assert bench.text == before


def test_a_drawn_curve_replaces_the_positions(tmp_path: Path) -> None:
    bench = opened(tmp_path, "nine-points", searching)
    bench.handle(do.DrawCurve(points=(0.0, 0.0, 10.0, 5.0, 20.0, 0.0)))
    assert positions(bench) == [(0, 0), (10, 5), (20, 0)]
    bench.handle(ask.Undo())
    assert len(positions(bench)) == 9


def test_wishes_are_written_in_one_line_and_removed(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    bench.handle(do.SetTaskEntry(key="wanted.transmission.least", value=89.0))
    found = solved(bench.handle(do.SetTaskEntry(key="wanted.lengths.most", value=5000.0)))
    assert "lengths = { most = 5000" in bench.text
    assert found.sound == 0
    assert (found.most_restrictive, found.costs) == ("the least transmission angle", 3)
    assert solved(bench.handle(do.SetTaskEntry(key="wanted.transmission.least"))).sound > 0


def test_ends_of_ranges_and_coordinates_are_typed_one_by_one(tmp_path: Path) -> None:
    bench = opened(tmp_path, "function")
    for k in (0, 1):
        bench.handle(do.SetTaskEntry(key=f"function.input.{k}", value=None))
    assert "input" not in bench.text
    bench.handle(do.SetTaskEntry(key="function.input.0", value=30))
    bench.handle(do.SetTaskEntry(key="function.input.1", value=90))
    task = lw.Task.loads(bench.text).described
    assert task.function is not None
    assert task.function.input == pytest.approx((30, 90))
    poses = opened(tmp_path, "five-poses")
    before = poses.text
    (refused,) = poses.handle(do.SetTaskEntry(key="positions.1.point.0", value=None))
    assert isinstance(refused, tell.Refused)
    assert "type a number" in refused.message
    assert poses.text == before


def test_a_page_that_connects_during_a_search_shows_the_task_at_once(tmp_path: Path) -> None:
    begun, finish = threading.Event(), threading.Event()
    kinds: list[type] = []

    def solve(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
        begun.set()
        assert finish.wait(60)
        return solve_task(task, progress=progress)

    def told(events: list[tell.Event], number: int | None) -> None:
        kinds.extend(map(type, events))

    desk = Desk(opened(tmp_path, "five-poses", solve), told)
    try:
        desk.prepare()
        assert begun.wait(60)
        desk.open()
        assert kinds.count(TaskState) == 2
        assert TaskSolved not in kinds
    finally:
        finish.set()
        desk.close(60)


def test_a_search_ends_for_a_newer_change_and_is_told(tmp_path: Path) -> None:
    bench = opened(tmp_path, "curve", searching)
    bench.listen(lambda: Hurry.CHANGE, NoSign())
    assert [type(event) for event in bench.opened()] == [TaskState]
    (ended,) = bench.handle(ask.Cancel())
    assert isinstance(ended, TaskUnsolved)
    assert ended.ended


def test_a_search_of_nine_points_tells_its_progress_and_can_be_ended(tmp_path: Path) -> None:
    task = lw.Task.loads(task_template("nine-points").text)
    told: list[float] = []

    def working(fraction: float) -> None:
        told.append(fraction)
        if len(told) == 2:
            raise GivenUpError

    with pytest.raises(GivenUpError):
        task.solve(progress=working)
    assert told == sorted(told)
    assert 0 <= told[-1] <= 1


def test_a_design_is_opened_as_a_mechanism_and_left_again(tmp_path: Path) -> None:
    bench = opened(tmp_path, "five-poses")
    bench.opened()
    bench.handle(do.TurnPose(index=1, angle=28))
    kinds = [type(event) for event in bench.handle(do.OpenDesign(design=0))]
    assert {FileState, tell.MotionFound, DesignOpened} <= set(kinds)
    assert type(bench.current).__name__ == "Workbench"
    bench.handle(ask.SetText(text=f"{bench.text}# mine\n"))
    (refused,) = bench.handle(do.ReturnToTask())
    assert isinstance(refused, tell.Refused)
    assert "not saved" in refused.message
    (refused,) = bench.handle(ask.OpenExample(name="four-bar"))
    assert isinstance(refused, tell.Refused)
    assert "five-poses.toml" in refused.message  # the task behind would be lost
    bench.handle(do.ReturnToTask(discard=True))
    assert type(bench.current).__name__ == "TaskBench"
    assert "angle = 28" in bench.text
    assert [path.name for path in bench.keep_unsaved()] == ["five-poses.unsaved.toml"]


def test_cognates_share_their_curve_and_have_their_verdicts(tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_text(_FIVE_POINTS, encoding="utf-8")
    bench = Bench(MechanismFile(path), lw.loads, solve_task)
    found = solved(bench.opened())
    index = next(design.index for design in found.designs if design.mechanism == "four-bar")
    (shown,) = bench.handle(do.ShowCognates(design=index))
    assert isinstance(shown, CognatesFound)
    assert len(shown.cognates) == 3
    ends = [{name: complex(*place) for name, place in one.points.items()} for one in shown.cognates]
    # three linkages on three fixed pivots, which form a triangle similar to each coupler
    pivots = {(round(z.real, 6), round(z.imag, 6)) for e in ends for z in (e["A0"], e["B0"])}
    assert len(pivots) == 3
    first = ends[0]
    third = next(z for e in ends[1:] for z in (e["A0"], e["B0"])
                 if min(abs(z - first["A0"]), abs(z - first["B0"])) > 1e-6)  # fmt: skip
    coupler = (first["P"] - first["A"]) / (first["B"] - first["A"])
    ground = (third - first["A0"]) / (first["B0"] - first["A0"])
    assert abs(coupler - ground) < 1e-8 * abs(coupler)


def test_a_task_in_a_file_is_opened_as_such(tmp_path: Path) -> None:
    path = tmp_path / "four-bar.toml"
    path.write_text(lw.example_text("four-bar"), encoding="utf-8")
    assert isinstance(Bench(MechanismFile(path), lw.loads, solve_task).current, Workbench)
    path.write_text('format = 1\n[wanted\ntask = "path"', encoding="utf-8")
    assert isinstance(Bench(MechanismFile(path), lw.loads, solve_task).current, Workbench)
    path.write_text('format = 1\ntask = "path"\n[wanted', encoding="utf-8")
    assert isinstance(Bench(MechanismFile(path), lw.loads, solve_task).current, TaskBench)


def test_the_start_page_opens_a_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    bench = Bench(new_file(), lw.loads, solve_task, start=True)
    assert isinstance(bench.opened()[1], tell.StartOffered)
    assert isinstance(bench.handle(do.OpenTask(name="five-poses"))[0], TaskState)
    assert isinstance(bench.handle(ask.OpenExample(name="four-bar"))[1], FileState)


_FIVE_POINTS = """\
format = 1
task = "path"

[given]
fixed_pivots = [[0, 0]]

[[positions]]
point = [45.7, 90.2]
[[positions]]
point = [50.1, 105.0]
[[positions]]
point = [31.6, 109.2]
[[positions]]
point = [6.7, 100.5]
[[positions]]
point = [-13.4, 82.2]
[[positions]]
point = [-23.7, 61.8]
[[positions]]
point = [-22.7, 47.1]
"""
