"""Mechanisms drawn on the canvas of the live page, in a real browser."""

from __future__ import annotations

import random
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.server import LiveServer
from linkwork.app.live.workbench import Workbench
from linkwork.core.textfile.reader import blank_sheet
from tests.app.live.rest import at_rest

Place = tuple[float, float]


class Sheet:
    """A blank sheet in a browser; every action counts."""

    def __init__(self, page: Any, bench: Workbench, scale: float) -> None:
        self.page, self.bench, self.scale, self.actions = page, bench, scale, 0
        self.origin: Place = (0.0, 0.0)

    def _on_screen(self, place: Place) -> Place:
        a, d, e, f = self.page.evaluate(
            """() => {
              const { a, d, e, f } = document.querySelector(".lw-drawing").getScreenCTM();
              return [a, d, e, f];
            }"""
        )
        x, y = self.scale * place[0], self.scale * place[1]
        return a * (x + self.origin[0]) + e, -d * (y + self.origin[1]) + f

    def _done(self, act: Callable[[], object]) -> None:
        self.actions += 1
        updates = "document.getElementById('linkwork').dataset.updates"
        before = self.page.evaluate(updates)
        act()
        self.page.wait_for_function(f"before => {updates} !== before", arg=before)
        self.settle()  # after the last of several answers

    def settle(self) -> None:
        """Wait until all requests are answered and drawn."""
        at_rest(self.page)

    def drag(self, start: Place, end: Place) -> None:
        mouse = self.page.mouse

        def act() -> None:
            mouse.move(*self._on_screen(start))
            mouse.down()
            mouse.move(*self._on_screen(end), steps=4)
            mouse.up()

        self._done(act)

    def click(self, place: Place) -> None:
        self._done(lambda: self.page.mouse.click(*self._on_screen(place)))

    def pick(self, place: Place) -> None:
        """A click after which more is to be picked."""
        self.actions += 1
        told = self.page.locator(".lw-part-prompt")
        before = told.inner_text()
        self.page.mouse.click(*self._on_screen(place))
        told.filter(has_not_text=before).wait_for()

    def remedy(self, label: str) -> None:
        self._done(self.page.get_by_role("button", name=label, exact=True).click)

    def key(self, key: str) -> None:
        self.actions += 1
        self.page.keyboard.press(key)
        self.settle()  # a longer or shorter hint leaves the drawing another height

    @property
    def mechanism(self) -> lw.Mechanism:
        return lw.loads(self.bench.text)


@pytest.fixture
def open_sheet(
    serve: Callable[[Workbench], LiveServer], watched: Callable[..., Any], tmp_path: Path
) -> Callable[..., Sheet]:
    """Opens a blank sheet."""

    def opened(scale: float = 1.0, unit: str = "mm") -> Sheet:
        text = blank_sheet("drawn").replace('"mm"', f'"{unit}"')
        bench = Workbench(MechanismFile(tmp_path / "drawn.toml", text), lw.loads)
        server = serve(bench)
        home = f"http://127.0.0.1:{server.port}/"
        page = watched((home,), viewport={"width": 1440, "height": 900})
        page.set_default_timeout(10_000)
        page.goto(server.address)
        page.locator(".lw-tools [aria-pressed=true]", has_text="Link").wait_for()
        at_rest(page)
        width = page.locator(".lw-drawing").evaluate("svg => svg.viewBox.baseVal.width")
        return Sheet(page, bench, scale * width / 240)

    return opened


@pytest.mark.parametrize(
    "unit", ["in", *(pytest.param(u, marks=pytest.mark.extended) for u in ("mm", "m"))]
)
def test_a_crank_rocker_with_a_path_takes_eight_actions(
    unit: str, open_sheet: Callable[..., Sheet]
) -> None:
    sheet = open_sheet(unit=unit)
    sheet.drag((-80, -20), (-60, 20))
    sheet.drag((-60, 20), (30, 50))
    sheet.drag((30, 50), (40, -20))
    sheet.remedy("Fix A and D")
    sheet.remedy("Drive link2")
    complete = sheet.page.locator(".lw-readiness")
    assert "The mechanism is complete." in complete.inner_text()
    sheet.key("t")
    sheet.click((-15, 35))
    complete.get_by_role("button", name="Show the motion").click()
    sheet.actions += 1
    complete.wait_for(state="hidden")
    sheet.page.locator("[data-role=trace]").first.wait_for(state="attached")
    motion = sheet.mechanism.sweep()
    assert (len(motion), int(motion.certified.sum())) == (361, 361)
    assert motion.units.length == unit
    assert len(sheet.mechanism.description.trace) == 1
    assert sheet.actions <= 8


def test_a_first_mechanism_keeps_its_place_its_open_panel_and_its_circuits(
    open_sheet: Callable[..., Sheet],
) -> None:
    """The tutorial's steps: nothing jumps away between two clicks."""
    sheet = open_sheet()
    for start, end in (((-80, -20), (-60, 20)), ((-60, 20), (30, 50)), ((30, 50), (40, -20))):
        sheet.drag(start, end)
    page = sheet.page
    sheet.settle()
    place = sheet._on_screen((0, 0))
    page.set_viewport_size({"width": 1440, "height": 878})  # as by a message of two lines
    sheet.settle()
    assert sheet._on_screen((0, 0)) == pytest.approx(place, abs=0.5)
    sheet.remedy("Fix A and D")
    sheet.remedy("Drive link2")
    page.get_by_role("button", name="Show the motion").click()
    for name in ("A B", "B C", "C D"):  # all of one open group, which gets another heading
        page.get_by_label(f"{name} [mm], value").fill("70")
        sheet._done(lambda: page.keyboard.press("Enter"))
    page.get_by_role("tab", name="Circuits").click()
    listed = page.locator(".lw-circuit-list > *")
    listed.first.wait_for()
    page.get_by_role("button", name="Save").click()
    page.locator(".lw-file", has_not_text="•").wait_for()
    sheet.settle()
    assert listed.count() > 0


def test_a_slider_crank_takes_eight_actions(open_sheet: Callable[..., Sheet]) -> None:
    sheet = open_sheet()
    sheet.drag((-80, -20), (-60, 20))
    sheet.drag((-60, 20), (40, -20))
    sheet.key("s")
    sheet.click((40, -20))
    sheet.remedy("Fix A")
    sheet.remedy("Drive link2")
    sheet.key("m")
    motion = sheet.mechanism.sweep()
    assert int(motion.certified.sum()) == 361
    assert list(motion.sliders) == ["s1"]
    assert sheet.actions <= 8


def test_a_six_bar_takes_twenty_actions_and_is_driven_at_either_crank(
    open_sheet: Callable[..., Sheet],
) -> None:
    sheet = open_sheet()
    sheet.drag((-80, -20), (-70, 0))
    sheet.drag((-70, 0), (0, 40))
    sheet.drag((0, 40), (10, -20))
    sheet.key("l")
    sheet.drag((-35, 20), (40, 50))  # from the middle of the coupler
    sheet.drag((40, 50), (70, -20))
    sheet.remedy("Fix A, D and H")
    sheet.remedy("Drive link2")
    sheet.key("m")
    motion = sheet.mechanism.sweep()
    assert int(motion.found.sum()) > 10
    assert len(motion.unknowns) == 4
    assert sheet.actions <= 20
    sheet.key("d")
    sheet.page.locator(".lw-still").wait_for()  # the sketch has arrived
    sheet.settle()
    sheet.click((55, 15))
    assert sheet.mechanism.description.inputs[0].link == "link6"
    assert sheet.mechanism.sweep().found.any()


def test_a_five_bar_is_driven_at_both_cranks_with_the_same_tool(
    open_sheet: Callable[..., Sheet],
) -> None:
    sheet = open_sheet()
    for start, end in (((-60, -20), (-70, 20)), ((-70, 20), (0, 60)), ((0, 60), (70, 20))):
        sheet.drag(start, end)
    sheet.drag((70, 20), (60, -20))
    sheet.remedy("Fix A and F")
    sheet.key("d")
    sheet.click((-65, 0))
    sheet.click((65, 0))
    assert [which.link for which in sheet.mechanism.description.inputs] == ["link2", "link5"]


def test_gears_on_an_arm_take_nine_actions_and_are_changed_in_their_panel(
    open_sheet: Callable[..., Sheet],
) -> None:
    sheet = open_sheet()
    panel = sheet.page.locator(".lw-inspector")
    sheet.drag((-40, -10), (10, 10))
    sheet.key("g")
    sheet.click((-40, -10))
    sheet.key("e")
    sheet.pick((-40, -10))
    sheet.drag((10, 10), (10, -12))
    sheet.remedy("Drive link2")
    sheet.remedy("Hold gear1")
    sheet.key("m")
    assert int(sheet.mechanism.sweep().certified.sum()) == 361
    assert sheet.actions <= 9
    sheet.key("v")
    sheet.page.locator(".lw-still").wait_for()  # the sketch has arrived
    sheet.settle()
    sheet.page.mouse.click(*sheet._on_screen((22, 10)))  # the second gear's disc
    panel.get_by_text("Gear pair").wait_for()
    assert panel.get_by_label("Name of the part").input_value() == "mesh1"
    teeth = panel.get_by_label("teeth")
    teeth.fill("20, 40")
    sheet._done(lambda: teeth.press("Enter"))
    assert tomllib.loads(sheet.bench.text)["gears"][0]["teeth"] == [20, 40]
    panel.get_by_role("button", name="Close").click()
    sheet.settle()
    sheet.page.mouse.click(*sheet._on_screen((22, 10)))
    panel.get_by_text("Gear pair").wait_for()
    assert panel.get_by_label("Name of the part").input_value() == "mesh1"
    sheet.key("Delete")
    sheet.page.locator("[aria-label='Undo: remove part mesh1']").wait_for()
    assert "gears" not in tomllib.loads(sheet.bench.text)


@pytest.mark.extended
@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_every_tool_of_parts_is_in_sight_and_a_half_done_pick_can_be_dropped(
    size: tuple[int, int], open_sheet: Callable[..., Sheet]
) -> None:
    sheet = open_sheet()
    page = sheet.page
    page.set_viewport_size({"width": size[0], "height": size[1]})
    blank = sheet.bench.text
    page.get_by_role("button", name="Parts").click()
    tools = page.locator(".lw-part-tools button")
    assert tools.count() == 12
    for k in range(12):
        box = tools.nth(k).bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= size[0]
        assert box["y"] + box["height"] <= size[1]
    keys = {tools.nth(k).get_attribute("aria-keyshortcuts") for k in range(12)}
    tools.nth(3).focus()
    page.keyboard.press("Enter")
    told = page.locator(".lw-part-prompt")
    told.filter(has_text="Gear pair 1 of 2").wait_for()
    sheet.pick((-20, 0))
    page.keyboard.press("Escape")
    told.filter(has_text="Gear pair 1 of 2").wait_for()
    assert sheet.bench.text == blank
    bar = page.locator(".lw-tools [aria-keyshortcuts]").evaluate_all(
        "all => all.map(one => one.getAttribute('aria-keyshortcuts'))"
    )
    assert keys.isdisjoint(bar)
    assert len(keys) == 12


@pytest.mark.parametrize("scale", [1e-3, pytest.param(1e3, marks=pytest.mark.extended)])
def test_a_mechanism_is_drawn_at_any_scale(scale: float, open_sheet: Callable[..., Sheet]) -> None:
    sheet = open_sheet()
    sheet.page.mouse.move(*sheet._on_screen((0, 0)))
    for _ in range(46):
        sheet.page.mouse.wheel(0, 100 if scale > 1 else -100)
    sheet.settle()  # symbols have the size of the view
    sheet.scale *= scale
    left, top, width, height = sheet.page.locator(".lw-drawing").evaluate(
        """svg => {
          const { x, y, width, height } = svg.viewBox.baseVal;
          return [x, y, width, height];
        }"""
    )
    sheet.origin = (left + width / 2, -(top + height / 2))
    assert width == pytest.approx(240 * scale, rel=0.1)
    sheet.drag((-80, -20), (-60, 20))
    sheet.drag((-60, 20), (30, 50))
    sheet.drag((30, 50), (40, -20))
    sheet.remedy("Fix A and D")
    sheet.remedy("Drive link2")
    motion = sheet.mechanism.sweep()
    assert int(motion.certified.sum()) == 361
    place = complex(*lw_point(sheet.bench.text, "A")) - complex(*sheet.origin)
    assert abs(place / scale - complex(-80, -20)) < 5


def test_pins_are_dragged_with_locked_lengths_and_steps_are_undone_by_name(
    open_sheet: Callable[..., Sheet],
) -> None:
    sheet = open_sheet()
    sheet.drag((-80, -20), (-60, 20))
    sheet.drag((-60, 20), (30, 50))
    sheet.key("v")
    sheet.page.mouse.click(*sheet._on_screen((-60, 20)))
    sheet.settle()  # the click is answered before the lock is set
    sheet.page.get_by_label("Lock A B").check()
    sheet.settle()
    sheet.drag((-60, 20), (-40, 40))
    a, b = (complex(*lw_point(sheet.bench.text, name)) for name in "AB")
    assert abs(b - a) == pytest.approx(abs(complex(20, 40)), rel=1e-9)
    assert b != complex(-60, 20)
    sheet.page.locator("[aria-label='Undo: move B']").wait_for()
    field = sheet.page.locator(".lw-inspector [data-number='B.x']")
    field.fill("12")
    field.press("Control+z")  # what was typed and not entered yet
    assert field.input_value() != "12"
    sheet.page.locator("[aria-label='Undo: move B']").wait_for()
    field.press("Control+z")
    sheet.page.locator("[aria-label^='Undo: add point C']").wait_for()
    sheet.page.wait_for_function(
        "() => document.querySelector(\".lw-inspector [data-number='B.x']\").value === '\u221260'"
    )


def lw_point(text: str, name: str) -> tuple[float, float]:
    x, y = tomllib.loads(text)["points"][name]
    return x, y


def test_any_actions_leave_a_page_that_agrees_with_its_file(
    open_sheet: Callable[..., Sheet],
) -> None:
    sheet = open_sheet()
    rng, page = random.Random(3), sheet.page
    box = page.locator(".lw-drawing").bounding_box()

    def somewhere() -> Place:
        x, y = rng.random(), rng.random()
        return box["x"] + box["width"] * (0.1 + 0.6 * x), box["y"] + box["height"] * y

    for _ in range(60):
        match rng.randrange(6):
            case 0 | 1:
                page.keyboard.press(rng.choice("vlpsgdtmf"))
            case 2:
                page.mouse.click(*somewhere())
            case 3:
                page.keyboard.press(rng.choice(["Delete", "Escape", "Control+z", "ArrowLeft", " "]))
            case _:
                page.mouse.move(*somewhere())
                page.mouse.down()
                page.mouse.move(*somewhere(), steps=2)
                page.mouse.up()
    sheet.settle()
    page.get_by_role("tab", name="Build").click()
    page.wait_for_function(
        "text => document.querySelector('.lw-build textarea').value === text",
        arg=sheet.bench.text,
    )
