"""Plots, comparison, circuits and exports of the live page in a real browser."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from tests.app.live.conftest import FOUR_BAR, Served
from tests.app.live.test_live_page import open_live as open_live, shown_row, type_number

Open = Callable[..., Any]

WIDE = {"width": 1440, "height": 900}
PHONE = {"width": 390, "height": 844}


def chart(page: Any, k: int = 0) -> Any:
    return page.locator(".lw-chart").nth(k)


def plotted(own: Any, k: int = 0) -> float:
    """The printed value of a curve in the displayed row."""
    text = own.locator(".lw-value").nth(k).text_content().replace("\u2212", "-")
    found = re.match(r"-?[\d.]+", text)
    assert found is not None, text
    return float(found[0])


def in_sight(page: Any, what: Any) -> bool:
    """Whether an element is within the window, as a whole."""
    box, size = what.bounding_box(), page.viewport_size
    return bool(
        box["y"] >= 0
        and box["y"] + box["height"] <= size["height"]
        and box["x"] >= 0
        and box["x"] + box["width"] <= size["width"]
    )


def test_drawing_charts_and_numbers_are_in_sight_together(open_live: Open) -> None:
    page = open_live(viewport=WIDE)
    for seen in (".lw-canvas", ".lw-chart >> nth=0", ".lw-chart >> nth=1", ".lw-transport"):
        assert in_sight(page, page.locator(seen)), seen
    values = page.locator(".lw-facts > .lw-table tr")
    assert all(in_sight(page, values.nth(k)) for k in range(4))
    assert page.evaluate("document.documentElement.scrollHeight") <= WIDE["height"]


def test_nothing_is_wider_than_a_phone(open_live: Open) -> None:
    page = open_live(viewport=PHONE)
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    order = [page.locator(one).first.bounding_box()["y"] for one in (".lw-canvas", ".lw-tabs")]
    order += [page.locator(one).first.bounding_box()["y"] for one in (".lw-charts", ".lw-facts")]
    assert order == sorted(order)


def test_quantities_of_several_units_share_a_chart(open_live: Open) -> None:
    page = open_live()
    own = chart(page)
    own.get_by_label("Quantity to plot").select_option("rocker")
    own.get_by_role("button", name="Plot another quantity").click()
    own.get_by_label("Quantity to plot").nth(1).select_option("P.x")
    motion = lw.loads(FOUR_BAR).sweep()
    row = shown_row(page)
    assert plotted(own, 0) == pytest.approx(motion["rocker"][row], rel=1e-5)
    assert plotted(own, 1) == pytest.approx(motion["P.x"][row], rel=1e-5)
    assert own.locator(".lw-own-axis.tone-1").count() > 1  # an axis for each
    assert own.locator(".lw-own-axis.tone-2").count() > 1
    own.get_by_role("button", name="Remove this curve").first.click()
    assert own.locator(".lw-curve-row").count() == 1
    assert own.locator(".lw-own-axis").count() == 0


def test_a_rate_that_the_page_lacks_is_computed(open_live: Open) -> None:
    page = open_live()
    own = chart(page)
    own.get_by_label("Quantity to plot").select_option("rocker")
    own.get_by_label("Rate").select_option("d2")
    motion = lw.loads(FOUR_BAR).sweep()
    page.wait_for_function("() => document.querySelector('.lw-value').textContent !== '–'")
    assert plotted(own) == pytest.approx(motion["rocker.d2"][shown_row(page)], rel=1e-4)
    type_number(page, "A B", 130)  # it stays on the page
    motion = lw.loads(FOUR_BAR.replace('"A B" = 120', '"A B" = 130')).sweep()
    assert plotted(own) == pytest.approx(motion["rocker.d2"][shown_row(page)], rel=1e-4)


def test_a_quantity_of_the_registry_that_no_page_contains_is_plotted(open_live: Open) -> None:
    page = open_live()
    own = chart(page)
    page.wait_for_function(
        "() => document.querySelector('.lw-chart option[value=\"B.curvature\"]') !== null"
    )
    own.get_by_label("Quantity to plot").select_option("B.curvature")
    page.wait_for_function("() => document.querySelector('.lw-value').textContent !== '–'")
    motion = lw.loads(FOUR_BAR).sweep()
    assert plotted(own) == pytest.approx(motion["B.curvature"][shown_row(page)], rel=1e-4)


def test_a_chart_is_polar_or_a_hodograph_or_over_another_quantity(open_live: Open) -> None:
    page = open_live()
    own = chart(page)
    for over, title in (
        ("(polar)", "around crank"),
        ("coupler", "over coupler"),
        ("(hodograph)", "hodograph of"),
    ):
        own.get_by_label("Abscissa").select_option(over)
        assert title in own.locator(".lw-plot").get_attribute("aria-label")
        assert len(own.locator("path.lw-curve").get_attribute("d")) > 1000
    own.get_by_label("Quantity to plot").select_option("B")
    motion = lw.loads(FOUR_BAR).sweep()
    assert plotted(own) == pytest.approx(motion["B.d1"][shown_row(page)], rel=1e-5)


def test_the_recommended_transmission_angles_are_a_band(open_live: Open) -> None:
    page = open_live()
    own = chart(page)
    own.get_by_label("Quantity to plot").select_option("B.transmission")
    assert own.locator(".lw-band title").text_content() == "recommended: 40 to 140"


def test_a_row_is_chosen_in_any_chart(open_live: Open) -> None:
    page = open_live()
    own = chart(page, 1)
    own.get_by_label("Abscissa").select_option("(hodograph)")
    before = shown_row(page)
    box = own.locator(".lw-plot").bounding_box()
    own.locator(".lw-plot").click(position={"x": box["width"] * 0.3, "y": box["height"] * 0.3})
    assert shown_row(page) != before


def test_a_design_is_compared_with_another(open_live: Open) -> None:
    page = open_live()
    assert page.locator(".lw-past").count() == 0
    page.get_by_role("checkbox", name="Compare").check()
    type_number(page, "A B", 130)
    past, now = (
        page.locator(f"path.lw-curve{kind}").first.get_attribute("d")
        for kind in (".lw-past", ":not(.lw-past)")
    )
    assert past != now
    assert page.locator(".lw-ghost path.r-trace").count() == 1
    page.get_by_role("checkbox", name="Compare").uncheck()
    assert page.locator(".lw-past").count() == 0
    assert page.locator(".lw-ghost path").count() == 0


def test_the_design_before_is_pale_while_a_length_is_dragged(open_live: Open) -> None:
    page = open_live()
    slider = page.locator('[data-number="a"] input[type=range]')
    slider.evaluate("slider => { slider.value = '45'; slider.dispatchEvent(new Event('input')); }")
    page.locator("#linkwork[data-live=true]").wait_for()
    assert page.locator(".lw-ghost path.r-trace").count() == 1
    slider.evaluate("slider => slider.dispatchEvent(new Event('change'))")
    page.locator("#linkwork[data-live=false]").wait_for()
    assert page.locator(".lw-ghost path").count() == 0


def test_the_numbers_of_the_whole_motion_are_those_of_the_library(open_live: Open) -> None:
    page = open_live()
    motion = lw.loads(FOUR_BAR).sweep()
    for name in ("stroke(rocker)", "time_ratio(rocker)", "path_length(P)"):
        text = page.locator(f'dd[data-fact="{name}"]').text_content()
        found = re.match(r"[\d.]+", text)
        assert found is not None
        number = float(found[0])
        assert number == pytest.approx(motion.value(name), rel=1e-5)


def test_circuits_are_listed_shown_and_chosen(open_live: Open, served: Served) -> None:
    page = open_live()
    page.get_by_role("tab", name="Circuits").click()
    other = page.locator('.lw-circuit[data-circuit="circuit 2"]')
    before = page.locator(".lw-facts > .lw-table td").nth(4).text_content()
    other.get_by_role("button", name="Show").click()
    assert page.locator('dd[data-fact="branch"]').text_content() == "circuit 2 branch 1"
    page.get_by_role("button", name="Back to the motion of the file").click()
    assert page.locator(".lw-facts > .lw-table td").nth(4).text_content() == before
    other.get_by_role("button", name="Start here").click()
    page.wait_for_selector(".lw-save.lw-wanted")
    assert 'configuration = "crossed"' in served.workbench.text


@pytest.mark.parametrize("suffix", ["toml", "svg", "png", "csv", "html"])
def test_the_page_downloads_a_file(open_live: Open, tmp_path: Path, suffix: str) -> None:
    page = open_live()
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as begun:
        page.locator(f'[data-format="{suffix}"]').click()
    assert begun.value.suggested_filename == f"four-bar.{suffix}"
    target = tmp_path / "file"
    begun.value.save_as(target)
    content = target.read_bytes()
    starts = {"svg": b"<svg", "png": b"\x89PNG", "html": b"<!doctype html>"}
    assert content.startswith(starts.get(suffix, b""))
    assert len(content) > 400
    if suffix == "toml":
        assert content.decode() == FOUR_BAR


def test_the_export_menu_works_with_keys(open_live: Open) -> None:
    page = open_live()
    page.get_by_role("button", name="Export").press("ArrowDown")
    assert page.evaluate("document.activeElement.dataset.format") == "toml"
    page.keyboard.press("ArrowDown")
    assert page.evaluate("document.activeElement.dataset.format") == "svg"
    page.keyboard.press("Escape")
    assert page.locator(".lw-menu[open]").count() == 0


def test_work_is_announced_until_it_is_answered(
    open_live: Open, served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = open_live()
    page.locator(".lw-busy").wait_for(state="hidden")
    seen = threading.Event()
    monkeypatch.setattr(type(served.workbench), "text", property(lambda bench: waiting(bench)))

    def waiting(bench: Any) -> str:
        seen.wait(10)
        return FOUR_BAR

    page.get_by_role("button", name="Export").click()
    page.locator('[data-format="toml"]').click()
    page.locator(".lw-busy").wait_for(state="visible")
    seen.set()
    page.locator(".lw-busy").wait_for(state="hidden")
