"""Copies, names, units and zoom on the canvas of the live page, in a real browser."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

from tests.viewer.conftest import browser as browser  # the fixture, for this folder too
from tests.viewer.live.test_drawing import Sheet, open_sheet as open_sheet


def test_a_link_is_copied_renamed_and_measured_in_inches(open_sheet: Callable[..., Sheet]) -> None:
    sheet = open_sheet()
    sheet.drag((-60, -20), (20, 20))
    sheet.key("v")
    sheet.page.mouse.click(*sheet._on_screen((-20, 0)))
    panel = sheet.page.locator(".lw-inspector")
    name = panel.get_by_role("textbox", name="Name of the link")
    assert name.input_value() == "link2"
    sheet._done(lambda: sheet.page.keyboard.press("Control+d"))
    assert name.input_value() == "link3"
    name.fill("rod")
    sheet._done(lambda: name.press("Enter"))
    length = panel.get_by_role("textbox", name="C D", exact=True)
    length.fill("3 in")
    sheet._done(lambda: length.press("Enter"))
    data = tomllib.loads(sheet.bench.text)
    assert data["links"] == {"link2": ["A", "B"], "rod": ["C", "D"]}
    assert data["lengths"]["C D"] == 76.2
    length.fill("30 deg")
    length.press("Enter")
    sheet.page.get_by_text('"C D" is a length, but "30 deg" is an angle').wait_for()
    width = "svg => svg.viewBox.baseVal.width"
    drawing = sheet.page.locator(".lw-drawing")
    before = drawing.evaluate(width)
    sheet.page.get_by_role("button", name="Zoom in").click()
    assert drawing.evaluate(width) < before
