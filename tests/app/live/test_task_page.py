"""The page of a task in a browser: from nothing to a task, a design, a mechanism and back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile, new_file, task_template
from linkwork.app.live.server import LiveServer
from linkwork.app.live.session import Bench
from linkwork.synthesis.solvers.solving import solve_task
from tests.app.accessibility import assert_accessible

Serve = Callable[[Bench], LiveServer]
Watched = Callable[..., Any]

#: Where a handle is on the screen.
_CENTRE = "(h) => { const b = h.querySelector('.lw-t-dot').getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }"  # noqa: E501


def opened(server: LiveServer, watched: Watched, **options: Any) -> Any:
    """The page of a server."""
    page = watched((f"http://127.0.0.1:{server.port}/",), **options)
    page.set_default_timeout(10_000)
    page.goto(server.address)
    return page


def task(folder: Path, name: str) -> Bench:
    """A bench on a task to begin with, in a file of a folder."""
    path = folder / f"{name}.toml"
    path.write_text(task_template(name).text, encoding="utf-8")
    return Bench(MechanismFile(path), lw.loads, solve_task)


def points(bench: Bench) -> list[tuple[float, float]]:
    """The points of a task as its text has them."""
    return [position.point for position in lw.Task.loads(bench.text).described.positions]


def test_from_nothing_to_a_task_to_a_mechanism_and_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, serve: Serve, watched: Watched
) -> None:
    monkeypatch.chdir(tmp_path)
    bench = Bench(new_file(), lw.loads, solve_task, start=True)
    page = opened(serve(bench), watched)
    page.locator("[data-task=five-poses]").click()
    page.locator(".lw-task[data-solved]").wait_for()
    assert page.locator(".lw-t-designs tbody tr").count() == 12
    assert page.locator(".lw-t-designs tr.lw-t-refused .lw-t-reason").count() == 9
    # a point is dragged: its number changes, and one step back restores it
    handle = page.locator(".lw-t-position[data-index='4'][data-knob=false]")
    x, y = handle.evaluate(_CENTRE)
    before = points(bench)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 12, y + 6, steps=3)
    page.mouse.up()
    page.locator(".lw-task .lw-bar [aria-label^='Undo: position 5 moved']").wait_for()
    assert points(bench)[:4] == before[:4]
    assert points(bench)[4] != before[4]
    page.keyboard.press("ArrowRight")
    page.locator(".lw-task[data-live=false]").wait_for()
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    page.locator(".lw-task .lw-bar [aria-label='Undo']").wait_for()
    assert points(bench) == before
    # another design moves through its positions
    page.locator(".lw-t-designs tbody tr").nth(2).click()
    page.locator(".lw-t-chosen p", has_text="Design 3").wait_for()
    page.get_by_role("button", name="Position 4", exact=True).click()
    assert page.locator(".lw-t-here[data-knob=false]").get_attribute("data-index") == "3"
    assert_accessible(page)
    page.get_by_role("button", name="Open as mechanism").click()
    page.locator("#linkwork .lw[data-row]").wait_for()
    page.locator(".lw-busy:not([hidden])").wait_for(state="detached")
    assert lw.loads(bench.text).sweep().found.all()
    page.get_by_role("button", name="Back to five-poses.toml").click()
    page.locator(".lw-task").wait_for()
    assert points(bench) == before


@pytest.mark.extended
def test_a_pivot_is_dragged_along_its_curve_and_the_design_follows(
    tmp_path: Path, serve: Serve, watched: Watched
) -> None:
    bench = task(tmp_path, "four-poses")
    page = opened(serve(bench), watched)
    page.locator(".lw-task[data-solved]").wait_for()
    page.get_by_role("button", name="Pivot", exact=True).click()
    box = page.locator(".lw-t-canvas").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3)
    pivot = page.locator(".lw-t-fixed-pivot")
    pivot.wait_for()
    page.locator(".lw-task[data-solved='2']").wait_for()
    x, y = pivot.evaluate(_CENTRE)
    first = lw.Task.loads(bench.text).described.given.fixed_pivots[0]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 30, y + 5, steps=5)
    page.mouse.up()
    page.locator(".lw-task .lw-bar [aria-label^='Undo: fixed pivot 1 moved']").wait_for()
    second = lw.Task.loads(bench.text).described.given.fixed_pivots[0]
    assert second != first
    found = lw.Task.loads(bench.text).solve()  # refuses a pivot off the curve
    assert found.designs


@pytest.mark.extended
def test_a_half_drawn_task_an_unsound_one_and_a_lost_server_say_so(
    tmp_path: Path, serve: Serve, watched: Watched
) -> None:
    server = serve(task(tmp_path, "five-poses"))
    page = opened(server, watched)
    page.locator(".lw-task[data-solved]").wait_for()
    page.get_by_role("tab", name="Task").click()
    page.get_by_label("Transmission angle at least").fill("89")
    page.keyboard.press("Enter")
    page.get_by_role("tab", name="Designs").click()
    requirement = "The requirement that rejects the most designs is the least transmission angle"
    page.get_by_text(requirement).wait_for()
    assert page.locator(".lw-t-designs tbody tr:not(.lw-t-refused)").count() == 0
    assert_accessible(page)  # a refused design is chosen
    page.get_by_role("tab", name="Task").click()
    rows = page.locator(".lw-t-positions tbody tr")
    for left in (4, 3, 2, 1):
        page.get_by_role("button", name="Remove position 2").click()
        rows.nth(left).wait_for(state="detached")
    page.locator(".lw-motion-notice", has_text="is only one").wait_for()
    assert page.locator(".lw-t-position[data-knob=false]").count() == 1
    page.reload()
    page.locator(".lw-motion-notice", has_text="is only one").wait_for()
    x, y = page.locator(".lw-t-position[data-knob=false]").evaluate(_CENTRE)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 9, y, steps=2)
    server.stop()
    page.get_by_text("The connection is lost").wait_for()
    page.mouse.up()  # the end of a drag does not remove the message
    assert page.get_by_text("The connection is lost").is_visible()
    assert page.locator(".lw-task .lw-save").is_disabled()


_PAIRS = """format = 1
task = "function"
mechanism = "four-bar"
[function]
pairs = [[0, 0], [20, 10], [45, 22]]
fit = "minimax"
"""
_TEXT = "(told) => document.querySelector('textarea').value.includes(told)"

_ROWS = "(rows) => document.querySelectorAll('.lw-t-positions tbody tr').length === rows"


def _typed(page: Any, name: str, value: str, told: str) -> None:
    page.get_by_label(name, exact=True).fill(value)
    page.get_by_label(name, exact=True).press("Tab")
    page.wait_for_function(_TEXT, arg=told)


def test_pairs_and_tolerances_are_fields_and_a_phone_has_the_file_in_one_row(
    tmp_path: Path, serve: Serve, watched: Watched
) -> None:
    path = tmp_path / "pairs.toml"
    path.write_text(_PAIRS, encoding="utf-8")
    bench = Bench(MechanismFile(path), lw.loads, solve_task)
    page = opened(serve(bench), watched, viewport={"width": 390, "height": 844})
    page.get_by_role("tab", name="Task").click()
    _typed(page, "input of pair 4", "60", "[60.0, 60.0]]")
    _typed(page, "output of pair 4", "28", "[60.0, 28.0]]")
    _typed(page, "output of pair 2", "9.5", "[20, 9.5]")
    page.get_by_label("Remove pair 1", exact=True).click()
    page.wait_for_function(_TEXT, arg="pairs = [[20, 9.5], ")
    assert page.locator(".lw-t-positions tbody tr").count() == 4
    # without pairs the first one is typed again
    for left in (2, 1, 0):
        page.get_by_label("Remove pair 1", exact=True).click()
        page.wait_for_function(_ROWS, arg=left + 1)
    _typed(page, "input of pair 1", "5", "pairs = [[5.0, 5.0]]")
    _typed(page, "output of pair 1", "7", "pairs = [[5.0, 7.0]]")
    page.get_by_label("Function of x").wait_for(state="hidden")
    buttons = page.locator(".lw-task .lw-bar button:not([hidden])")
    assert buttons.count() == 6
    tops = buttons.evaluate_all("(all) => all.map((b) => b.getBoundingClientRect().top)")
    assert len(set(tops)) == 1
    poses = opened(serve(task(tmp_path, "five-poses")), watched)
    poses.get_by_role("tab", name="Task").click()
    _typed(poses, "tolerance of position 2", "0.5", "\ntolerance = 0.5")
    _typed(poses, "angle tolerance of position 3", "1.5", "\nangle_tolerance = 1.5")
    assert poses.get_by_label("angle tolerance of position 2", exact=True).input_value() == ""
    poses.reload()
    poses.get_by_role("tab", name="Task").click()
    assert poses.get_by_label("angle tolerance of position 3", exact=True).input_value() == "1.5"


@pytest.mark.extended
@pytest.mark.parametrize("name", ["three-poses", "function", "curve"])
@pytest.mark.parametrize("width", [390, 1280])
def test_every_task_fits_into_its_page(
    tmp_path: Path, serve: Serve, watched: Watched, name: str, width: int
) -> None:
    page = opened(serve(task(tmp_path, name)), watched, viewport={"width": width, "height": 844})
    page.locator(".lw-task[data-solved]").wait_for(timeout=60_000)
    for tab in ("Designs", "Trade-off", "Cognates", "Task"):
        page.get_by_role("tab", name=tab).click()
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert_accessible(page)


def test_what_a_page_says_fits_the_kind_of_its_task(
    tmp_path: Path, serve: Serve, watched: Watched
) -> None:
    size = {"width": 1280, "height": 700}
    page = opened(serve(task(tmp_path, "five-poses")), watched, viewport=size)
    page.locator(".lw-task[data-solved]").wait_for()
    page.locator(".lw-t-designs tbody tr").last.click()
    page.locator(".lw-t-chosen.lw-t-refused").wait_for()
    page.get_by_role("tab", name="Cognates").click()
    page.get_by_text("Only four-bars found for a path have cognates").wait_for()
    page.get_by_role("tab", name="Task").click()
    field = page.get_by_label("Transmission angle at least")
    field.fill("95")
    field.press("Enter")
    page.locator(".lw-t-wrong", has_text="must be at least 0 and below 90, got 95").wait_for()
    assert field.get_attribute("aria-invalid") == "true"
    assert page.get_by_label("Links not shorter than").get_attribute("aria-invalid") == "false"
    assert_accessible(page)
    field.fill("89")
    field.press("Enter")
    page.get_by_role("tab", name="Designs").click()
    page.get_by_text("The best least transmission angle is").wait_for()
    assert field.get_attribute("aria-invalid") == "false"
    # the chosen design is in sight in the list, which scrolls by itself
    row = page.locator(".lw-t-designs tbody tr[aria-selected=true]")
    row.wait_for()
    page.wait_for_function(_IN_SIGHT)


_IN_SIGHT = """() => {
  const row = document.querySelector(".lw-t-designs tr[aria-selected=true]");
  const [own, panel] = [row, row.closest(".lw-panel")].map((e) => e.getBoundingClientRect());
  return own.top >= panel.top && own.bottom <= panel.bottom + 1;
}"""


@pytest.mark.extended
def test_one_size_is_no_trade_off_and_an_improvement_moves_through_its_table(
    tmp_path: Path, serve: Serve, watched: Watched
) -> None:
    page = opened(serve(task(tmp_path, "curve")), watched)
    page.locator(".lw-task[data-solved]").wait_for()
    page.get_by_role("tab", name="Trade-off").click()
    page.get_by_text("All sound designs have one size, 220 mm").wait_for()
    assert not page.locator(".lw-t-pareto svg").is_visible()
    page.get_by_role("tab", name="Task").click()
    range_ = page.get_by_label("Driven range").locator("option").first
    assert range_.text_content() == "first to last position"
    page.locator(".lw-t-choice", has_text="Task").locator("select").select_option("improve")
    page.wait_for_function(
        "() => [...document.querySelectorAll('option')].some("
        "(o) => o.textContent === 'table of the mechanism')"
    )
    assert range_.text_content() == "table of the mechanism"
