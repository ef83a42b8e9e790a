"""Copies, names, units and zoom on the canvas of the live page, in a real browser."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

import pytest

from tests.app.conftest import browser as browser  # the fixture, for this folder too
from tests.app.live.test_drawing import Sheet, open_sheet as open_sheet


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


@pytest.mark.extended
def test_a_drawing_is_measured_and_dimensioned(open_sheet: Callable[..., Sheet]) -> None:
    sheet = open_sheet()
    page = sheet.page
    sheet.drag((-60, -20), (20, 20))
    sheet.key("v")
    page.get_by_role("button", name="Dimensions on the drawing").click()
    page.locator('[data-dimension="A B"] text').click()
    field = page.get_by_role("textbox", name="A B [mm]", exact=True)
    field.fill("10 cm")
    sheet._done(lambda: field.press("Enter"))
    assert tomllib.loads(sheet.bench.text)["lengths"] == {"A B": 100}
    sheet.key("q")
    for point in sheet.bench.cycle.subject.description.points.values():  # type: ignore[attr-defined]
        page.mouse.click(*sheet._on_screen(tuple(c / sheet.scale for c in point)))
    page.locator(".lw-measured", has_text="A B: 100 mm (horizontal").wait_for()
    sheet._done(page.get_by_role("button", name="Add as output").click)
    formula = "hypot(B.x - A.x, B.y - A.y)"
    assert tomllib.loads(sheet.bench.text)["outputs"] == {"distance1": formula}
    sheet.key("Escape")
    assert page.locator(".lw-measured").is_hidden()


@pytest.mark.extended
def test_a_photograph_is_scaled_and_stays_in_the_browser(open_sheet: Callable[..., Sheet]) -> None:
    sheet = open_sheet()
    page = sheet.page
    page.get_by_role("button", name="Photograph behind the drawing").click()
    picture = b"<svg xmlns='http://www.w3.org/2000/svg' width='40' height='20'/>"
    chosen = {"name": "a.svg", "mimeType": "image/svg+xml", "buffer": picture}
    page.get_by_label("Choose a picture").set_input_files(chosen)
    image = page.locator("image.lw-photograph")
    image.wait_for(state="attached")
    width = float(image.get_attribute("width"))
    page.get_by_role("button", name="Scale", exact=True).click()
    page.mouse.move(*sheet._on_screen((-40, 0)))
    page.mouse.down()
    page.mouse.move(*sheet._on_screen((40, 0)), steps=3)
    page.mouse.up()
    length = page.get_by_role("textbox", name="Length of the line")
    length.fill("40")
    length.press("Enter")
    assert float(image.get_attribute("width")) == pytest.approx(width / 2, rel=0.01)
    page.reload()
    image.wait_for(state="attached")
    assert "image" not in sheet.bench.text
    page.get_by_role("button", name="Photograph behind the drawing").click()
    page.get_by_role("button", name="Remove", exact=True).click()
    assert image.count() == 0


def test_a_sheet_has_the_proportions_of_its_drawing_before_and_after_a_window_is_resized(
    open_sheet: Callable[..., Sheet],
) -> None:
    sheet = open_sheet()
    for width in (1440, 1100):
        sheet.page.set_viewport_size({"width": width, "height": 900})
        sheet.settle()
        wide, high, drawn_wide, drawn_high = sheet.page.locator(".lw-drawing").evaluate(
            "svg => [svg.viewBox.baseVal.width, svg.viewBox.baseVal.height,"
            " svg.clientWidth, svg.clientHeight]"
        )
        assert high / wide == pytest.approx(drawn_high / drawn_wide, rel=5e-3)


@pytest.mark.extended
def test_a_flat_view_of_a_sketch_does_not_grow(open_sheet: Callable[..., Sheet]) -> None:
    sheet = open_sheet()
    sheet.drag((-60, -20), (20, 20))
    width = "svg => svg.viewBox.baseVal.width"
    drawing = sheet.page.locator(".lw-drawing")
    for name, height in {"height": "20px", "min-height": "0"}.items():
        drawing.evaluate(f"svg => svg.style.setProperty('{name}', '{height}', 'important')")
    widths = []
    for _ in range(4):  # symbols are sized by the view, and the view by the symbols
        sheet.key("f")
        sheet.page.wait_for_timeout(400)
        widths.append(drawing.evaluate(width))
    assert max(widths) < 1e3, widths
