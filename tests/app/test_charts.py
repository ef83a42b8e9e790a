"""Charts, circuits and numbers of offline pages in a real browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import linkwork as lw

Open = Callable[..., Any]


@pytest.fixture(scope="module")
def circuits() -> dict[str, lw.Motion]:
    """Both circuits of a four-bar, which differ in extent."""
    return lw.example("four-bar").cycles()


def test_every_circuit_has_its_own_extent(open_page: Open, circuits: dict[str, lw.Motion]) -> None:
    page = open_page(circuits)
    boxes = []
    for k in range(2):
        page.get_by_label("Circuit").select_option(index=k)
        boxes.append(page.locator(".lw-drawing").get_attribute("viewBox"))
    assert boxes[0] != boxes[1]


def test_a_circuit_is_compared_with_another(
    open_page: Open, circuits: dict[str, lw.Motion]
) -> None:
    page = open_page(circuits)
    page.get_by_label("Compare").check()
    page.get_by_label("Circuit").select_option(index=1)
    past, now = (page.locator(f"path.lw-curve{k}").first for k in (".lw-past", ":not(.lw-past)"))
    assert past.get_attribute("d") != now.get_attribute("d")


def test_an_offline_page_offers_the_rates_in_its_data(open_page: Open) -> None:
    motion = lw.example("four-bar").sweep()
    page = open_page({"motion": motion})
    chart = page.locator(".lw-chart").first
    chart.get_by_label("Quantity to plot").select_option("rocker")
    rates = chart.get_by_label("Rate").locator("option")
    assert rates.evaluate_all("all => all.map(one => one.value)") == ["", "d1", "velocity"]
    chart.get_by_label("Rate").select_option("velocity")
    value = float(chart.locator(".lw-value").text_content().replace("\u2212", "-").split()[0])
    row = int(page.locator(".lw").get_attribute("data-row"))
    assert value == pytest.approx(motion["rocker.velocity"][row], rel=1e-5)
    chart.get_by_label("Abscissa").select_option("time")
    assert "over time [s]" in chart.locator(".lw-plot").get_attribute("aria-label")


def test_charts_are_added_and_removed(open_page: Open) -> None:
    page = open_page({"motion": lw.example("four-bar").sweep(step=5)})
    page.get_by_role("button", name="+ chart").click()
    assert page.locator(".lw-chart").count() == 3
    for _ in range(2):
        page.get_by_role("button", name="Remove this chart").first.click()
    assert page.locator(".lw-chart").count() == 1
    assert page.get_by_role("button", name="Remove this chart").is_hidden()


def test_numbers_of_the_motion_are_on_the_page(open_page: Open) -> None:
    motion = lw.example("four-bar").sweep()
    page = open_page({"motion": motion})
    text = page.locator('dd[data-fact="stroke(rocker)"]').text_content()
    assert float(text.removesuffix("°")) == pytest.approx(motion.value("stroke(rocker)"), rel=1e-5)
