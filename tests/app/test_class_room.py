"""The offline page in a class room: read by everyone, presented, printed, all keys listed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from tests.app.accessibility import assert_accessible

Open = Callable[..., Any]

PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "color_scheme": "dark"}


@pytest.fixture(scope="module")
def motion() -> lw.Motion:
    return lw.example("four-bar").sweep(step=10, certify=False)


@pytest.fixture
def page(open_page: Open, motion: lw.Motion) -> Any:
    return open_page({"motion": motion}, equations=lw.example("four-bar").equations().mathml())


@pytest.mark.extended
def test_the_drawing_has_words_that_follow_it(page: Any) -> None:
    page.get_by_text("In words").click()
    words = page.locator(".lw-words")
    words.filter(has_text="crank = 0°, driven at crank; position found").wait_for()
    for _ in range(9):
        page.keyboard.press("ArrowRight")
    page.get_by_text("A at 0, 40").wait_for()
    assert "O₂ at 0, 0, fixed" in words.text_content()
    assert "coupler at 18.3" not in words.text_content()


@pytest.mark.extended
def test_a_key_says_the_position_again(page: Any) -> None:
    status = page.locator(".lw-unseen")
    page.keyboard.press(".")
    status.filter(has_text="crank").wait_for(state="attached")
    status.evaluate("element => (element.textContent = 'read')")
    page.keyboard.press(".")
    status.filter(has_text="crank").wait_for(state="attached")


@pytest.mark.extended
def test_all_keys_are_listed_and_the_focus_returns(page: Any) -> None:
    button = page.get_by_role("button", name="Keys")
    button.focus()
    page.keyboard.press("?")
    dialog = page.locator("dialog.lw-keys")
    listed = dialog.text_content()
    assert all(
        word in listed for word in ("Space", "Play, or stand still", "F9", "Say the position")
    )
    row = page.locator(".lw").get_attribute("data-row")
    page.keyboard.press("ArrowRight")  # the keys of a dialog are its own
    assert page.locator(".lw").get_attribute("data-row") == row
    assert_accessible(page)
    page.keyboard.press("Escape")
    dialog.wait_for(state="detached")
    assert button.evaluate("element => element === document.activeElement")


@pytest.mark.extended
def test_a_presentation_is_large_and_ends_with_escape(page: Any) -> None:
    drawing = page.locator(".lw-drawing")
    before = drawing.bounding_box()
    page.keyboard.press("F9")
    page.locator(".lw-presenting").wait_for()
    after = drawing.bounding_box()
    assert after["height"] > 1.5 * before["height"]
    assert not page.locator(".lw-charts").is_visible()
    equation = page.locator(".lw-equation").first
    assert equation.evaluate("element => parseFloat(getComputedStyle(element).fontSize)") >= 20
    page.keyboard.press("F9" if page.evaluate("document.fullscreenElement !== null") else "Escape")
    page.locator(".lw:not(.lw-presenting)").wait_for()
    assert page.locator(".lw-charts").is_visible()


@pytest.mark.extended
def test_print_has_charts_with_their_titles_and_no_controls(page: Any) -> None:
    page.emulate_media(media="print", color_scheme="dark")
    page.locator(".lw").evaluate("element => (element.dataset.theme = 'dark')")
    style = (
        "element => [getComputedStyle(element).color, getComputedStyle(element).backgroundColor]"
    )
    assert page.locator(".lw").evaluate(style) == ["rgb(0, 0, 0)", "rgb(255, 255, 255)"]
    for kind in ("button", "input", ".lw-toggles"):
        assert not any(one.is_visible() for one in page.locator(kind).all()), kind
    for kind in ("h1", ".lw-drawing", ".lw-equation", ".lw-table", ".lw-chart figcaption"):
        assert page.locator(kind).first.is_visible(), kind
    broken = "element => getComputedStyle(element).breakInside"
    assert page.locator(".lw-chart").first.evaluate(broken) == "avoid"
    ends = "els => els.map(e => e.getBoundingClientRect()).map(({ top, bottom }) => [top, bottom])"
    chart, other = page.locator(".lw-chart").evaluate_all(ends)
    assert chart[1] <= other[0]


@pytest.mark.parametrize(
    "options", [{}, pytest.param(PHONE, marks=pytest.mark.extended)], ids=["desktop", "phone"]
)
def test_axe_finds_nothing_serious_in_an_offline_page(
    options: dict[str, Any], open_page: Open, motion: lw.Motion
) -> None:
    page = open_page(
        {"motion": motion}, equations=lw.example("four-bar").equations().mathml(), **options
    )
    page.get_by_text("In words").click()
    assert_accessible(page)
    page.keyboard.press("F9")
    page.wait_for_timeout(300)
    assert_accessible(page)


@pytest.mark.extended
def test_axe_finds_nothing_serious_in_a_page_with_sliders(browser: Any, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    lw.example("four-bar").animate(target, sliders=["O2 A"])
    for scheme in ("light", "dark"):
        context = browser.new_context(offline=True, reduced_motion="reduce", color_scheme=scheme)
        page = context.new_page()
        page.goto(target.as_uri())
        page.wait_for_selector(".lw-sliders")
        assert_accessible(page)
        context.close()


def test_what_a_question_hides_is_hidden_on_paper_and_in_presentations(open_page: Open) -> None:
    hide = ("numbers", "charts", "limits", "input", "equations")
    ask = lw.Question(text="How far?", answer="stroke(rocker)", tolerance=1, hide=hide)
    bar = lw.example("four-bar").changed(questions=[ask])
    motion = bar.sweep(step=10, certify=False)
    page = open_page({"motion": motion}, equations=bar.equations().mathml())
    shown = (".lw-table", ".lw-chart", ".lw-readout", ".lw-equation", ".lw-motion-numbers")
    visible = "els => els.some(e => e.checkVisibility() && e.innerText.trim() !== '')"

    def seen() -> list[str]:
        return [kind for kind in shown if page.locator(kind).evaluate_all(visible)]

    for media in ("print", "screen"):
        page.emulate_media(media=media)
        assert page.locator(".lw-question").is_visible()
        assert seen() == [], media
    page.keyboard.press("F9")
    page.locator(".lw-presenting").wait_for()
    assert seen() == []
    page.keyboard.press("F9")
    page.locator(".lw:not(.lw-presenting)").wait_for()
    page.get_by_role("button", name="Show the answer").click()
    page.emulate_media(media="print")
    assert {".lw-table", ".lw-chart", ".lw-readout", ".lw-equation"} <= set(seen())
