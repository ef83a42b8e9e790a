"""Designs of the atlas, improved ones and the one that a task improves, on the page of a task."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask, task_requests as do
from linkwork.app.live.messages import Hurry
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.server import LiveServer
from linkwork.app.live.session import Bench
from linkwork.app.live.task_events import DesignFound, DesignsSuggested, TaskSolved, TaskUnsolved
from linkwork.synthesis import suggesting
from linkwork.synthesis.solvers.result import Synthesis
from linkwork.synthesis.solvers.solving import solve_task
from linkwork.synthesis.tasks.task import Task
from tests.app.accessibility import assert_accessible

#: A four-bar's path with twelve points, searched from a few starts.
CURVE = (
    'format = 1\ntask = "path"\nname = "A curve"\nmechanism = "four-bar"\n[improve]\nstarts = 4\n'
    + "".join(
        f"[[positions]]\npoint = [{60 * np.cos(a):.3f}, {25 * np.sin(a) + 10 * np.cos(a):.3f}]\n"
        for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)
    )
)
IMPROVE = """\
format = 1
task = "improve"
name = "Longer stroke"
mechanism = "slider-crank"

[improve]
vary = ["O2 A"]
starts = 2

[[improve.goals]]
of = "stroke(d)"
target = 70
"""


def unsolved(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
    """A search that has no time."""
    raise lw.InputError(f"no designs are found for {task.name}")


def opened(folder: Path, text: str, solve: Any = unsolved) -> Bench:
    """A bench on a task in a file of a folder."""
    path = folder / "task.toml"
    path.write_text(text, encoding="utf-8")
    return Bench(MechanismFile(path), lw.loads, solve, lambda: suggesting)


def suggested(events: list[tell.Event]) -> DesignsSuggested:
    """The designs that were suggested."""
    return next(event for event in events if isinstance(event, DesignsSuggested))


def looked(events: list[tell.Event]) -> DesignFound:
    """The design that was shown last."""
    return [event for event in events if isinstance(event, DesignFound)][-1]


@dataclass
class Signs:
    """Signs of work, kept."""

    fractions: list[float] = field(default_factory=list)
    shown: list[tell.Event] = field(default_factory=list)

    def __call__(self, fraction: float) -> None:
        self.fractions.append(fraction)

    def show(self, events: list[tell.Event]) -> None:
        self.shown += events


def test_the_nearest_paths_are_designs_that_move_and_open(tmp_path: Path) -> None:
    bench = opened(tmp_path, CURVE)
    signs = Signs()
    bench.listen(lambda: Hurry.NONE, signs)
    bench.opened()
    events = bench.handle(do.FindNearest(count=3))
    listed = suggested(events).designs
    assert [(d.index, d.origin, d.number) for d in listed] == [
        (-2 - k, "atlas", k + 1) for k in range(3)
    ]
    assert signs.fractions == sorted(signs.fractions)
    found = looked(events)
    assert found.skeleton is not None
    rows = np.array(found.rows)
    lengths = [
        np.hypot(*(rows[:, [2 * i, 2 * i + 1]] - rows[:, [2 * j, 2 * j + 1]]).T)
        for i, j, *_ in found.skeleton.bars
    ]
    assert max(np.ptp(length) / length.mean() for length in lengths) < 1e-9
    own = {pair for piece in found.curve for pair in zip(piece[::2], piece[1::2], strict=True)}
    assert len(own) > 60
    # the visitor's choice stays while the task changes, and is judged anew
    bench.handle(do.ShowDesign(design=-3))
    events = bench.handle(do.MoveTaskPoint(of="position", index=0, x=75, y=10))
    assert looked(events).design.index == -3
    assert suggested(events).designs[1].error != listed[1].error
    bench.handle(do.OpenDesign(design=-3))
    assert bench.current.name == "task-atlas-2.toml"
    assert lw.loads(bench.text).sweep().certified.all()
    events = bench.handle(do.ReturnToTask())
    assert len(suggested(events).designs) == 3


def test_an_improvement_is_stopped_and_the_best_is_kept(tmp_path: Path) -> None:
    bench = opened(tmp_path, CURVE)
    bench.opened()
    (begin,) = suggested(bench.handle(do.FindNearest(count=1))).designs
    left = iter([Hurry.NONE] * 20)
    bench.listen(lambda: next(left, Hurry.STOP), Signs())
    events = bench.handle(do.ImproveDesign(design=begin.index))
    shown = looked(events).design
    assert (shown.origin, shown.number) == ("improved", 1)
    assert shown.error is not None
    assert begin.error is not None
    assert shown.error < begin.error
    assert len(looked(events).marks) == 12
    assert bench.handle(ask.Cancel()) == []
    assert not bench.current.unsaved


def test_a_task_that_improves_shows_its_mechanism_before_the_search_ends(tmp_path: Path) -> None:
    bench = opened(tmp_path, IMPROVE, solve_task)
    signs = Signs()
    bench.listen(lambda: Hurry.NONE, signs)
    events = bench.opened()
    given = looked(signs.shown)
    assert given.design.origin == "as given"
    assert given.design.mechanism == "slider-crank"
    solved = next(event for event in events if isinstance(event, TaskSolved))
    assert solved.chosen is not None
    assert solved.chosen.design.index == 0
    assert solved.chosen.skeleton is not None
    bench.handle(do.OpenDesign(design=0))
    motion = lw.loads(bench.text).sweep()
    assert np.ptp(motion["d"]) == pytest.approx(70, abs=0.01)  # of the rows; turning points between


def test_a_point_that_the_mechanism_does_not_have_is_told_and_can_be_corrected(
    tmp_path: Path,
) -> None:
    goals = IMPROVE.index("[[improve.goals]]")
    bench = opened(tmp_path, IMPROVE[:goals] + 'point = "Q"\n\n' + IMPROVE[goals:], solve_task)
    unsolved = next(event for event in bench.opened() if isinstance(event, TaskUnsolved))
    assert [problem.key for problem in unsolved.problems] == ["improve.point"]
    events = bench.handle(do.SetTaskEntry(key="improve.point", value="B"))
    assert suggested(events).designs[0].origin == "as given"


def test_work_that_waits_for_a_search_is_not_told_as_the_search(
    tmp_path: Path, serve: Callable[[Bench], LiveServer], watched: Callable[..., Any]
) -> None:
    done = threading.Event()

    def solve(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
        assert progress is not None
        while not done.wait(0.05):
            progress(0.5)
        return unsolved(task)

    server = serve(opened(tmp_path, CURVE, solve))
    page = watched((f"http://127.0.0.1:{server.port}/",))
    page.goto(server.address)
    told = page.locator(".lw-t-waiting")
    told.get_by_text("Searching for designs: 50 %").wait_for()
    page.get_by_role("button", name="Nearest in the atlas").click()
    assert told.get_by_text("Searching for designs: 50 %").is_visible()
    done.set()
    page.locator(".lw-t-designs tbody tr").first.wait_for()


def test_wrong_questions_are_refused_and_change_nothing(tmp_path: Path) -> None:
    bench = opened(tmp_path, CURVE)
    bench.opened()
    before = bench.text
    wrong: dict[ask.Request, str] = {
        do.FindNearest(count=0): "1 to 100 designs",
        do.ImproveDesign(design=-2): "no such design",
        do.ImproveDesign(design=0): "not solved",
        do.ShowDesign(design=-9): "no such design",
        do.OpenDesign(design=-2): "no such design",
    }
    for request, why in wrong.items():
        (refused,) = bench.handle(request)
        assert isinstance(refused, tell.Refused)
        assert why in refused.message
    bench.handle(do.DrawCurve(points=(0, 0, 1, 1, 2, 0)))
    (refused,) = bench.handle(do.FindNearest())
    assert isinstance(refused, tell.Refused)
    assert "5 positions or more, got 3" in refused.message
    bench.handle(ask.Undo())
    assert bench.text == before
    # the atlas cannot be loaded
    lost = Bench(MechanismFile(tmp_path / "task.toml"), lw.loads, unsolved, lambda: _Lost())  # type: ignore[arg-type, return-value]
    (refused,) = lost.handle(do.FindNearest())
    assert isinstance(refused, tell.Refused)
    assert "check the connection" in refused.message


class _Lost:
    def nearest(self, *_: object) -> None:
        raise OSError(29, "I/O error")


@pytest.mark.parametrize("width", [390, 1280])
def test_a_curve_finds_paths_and_improves_one_on_the_page(
    tmp_path: Path, serve: Callable[[Bench], LiveServer], watched: Callable[..., Any], width: int
) -> None:
    bench = opened(tmp_path, CURVE)
    server = serve(bench)
    options = {"viewport": {"width": width, "height": 844}}
    page = watched((f"http://127.0.0.1:{server.port}/",), **options)
    page.set_default_timeout(20_000)
    page.goto(server.address)
    page.locator(".lw-task[data-solved]").wait_for()
    page.get_by_role("button", name="Nearest in the atlas").click()
    rows = page.locator(".lw-t-designs tbody tr")
    rows.nth(9).wait_for()
    page.locator(".lw-t-curve").first.wait_for(state="attached")  # its path over the drawn one
    rows.nth(3).click()
    page.locator("p", has_text="Atlas 4: ").wait_for()
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    if width == 390:
        assert_accessible(page)
        return
    page.get_by_role("button", name="Improve", exact=True).click()
    # at once: it may end by itself before the page is at rest
    page.get_by_role("button", name="Stop and keep the best").dispatch_event("click")
    page.locator(".lw-t-waiting").wait_for(state="hidden")
    told = page.locator("p", has_text="Improved 1: ").or_(page.locator(".lw-message span"))
    told.first.wait_for()
