"""The live page without a mouse and without sight: drawn, presented and read by keys."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile, new_file
from linkwork.app.live.server import LiveServer
from linkwork.app.live.workbench import Workbench
from linkwork.core.textfile.reader import blank_sheet
from tests.app.accessibility import assert_accessible
from tests.app.conftest import browser as browser  # the fixture, for this folder too
from tests.app.live.conftest import FOUR_BAR
from tests.app.live.rest import at_rest

DESKTOP = {"viewport": {"width": 1440, "height": 900}}
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True}


@contextmanager
def shown(browser: Any, file: MechanismFile, **options: Any) -> Iterator[tuple[Any, Workbench]]:
    """The live page of a file; fails on any message of the console."""
    bench = Workbench(file, lw.loads)
    server = LiveServer(bench)
    thread = threading.Thread(target=server.run)
    thread.start()
    context = browser.new_context(reduced_motion="reduce", **(DESKTOP | options))
    said: list[str] = []
    try:
        page = context.new_page()
        page.set_default_timeout(10_000)
        page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.goto(server.address)
        yield page, bench
    finally:
        context.close()
        server.stop()
        thread.join(10)
    assert said == []


def done(page: Any, *keys: str) -> None:
    """Press keys, of which the last changes the file, and wait for it."""
    home = page.locator("#linkwork")
    before = home.get_attribute("data-updates")
    for key in keys:
        page.keyboard.press(key)
    page.locator(f"#linkwork:not([data-updates='{before}'])").wait_for()
    at_rest(page)


def test_a_four_bar_is_drawn_fixed_and_driven_by_keys(browser: Any, tmp_path: Path) -> None:
    file = MechanismFile(tmp_path / "drawn.toml", blank_sheet("drawn"))
    with shown(browser, file) as (page, bench):
        page.locator(".lw-tools [aria-pressed=true]", has_text="Link").wait_for()
        page.locator(".lw-drawing").focus()
        far, up = ["Shift+ArrowRight"] * 6, ["Shift+ArrowUp"] * 2
        done(page, *["Shift+ArrowLeft"] * 6, "Enter", *up, "Enter")  # from A to B
        done(page, "Enter", *far, "Shift+ArrowUp", "Enter")  # from B, which has the focus
        done(page, "Enter", *["Shift+ArrowDown"] * 3, "Shift+ArrowRight", "Enter")
        done(page, "g", "Enter")  # D
        page.locator("[data-named='point A']").focus()
        done(page, "Enter")
        page.keyboard.press("d")
        page.locator("[data-named='link link2']").focus()
        done(page, "Enter")
        motion = lw.loads(bench.text).sweep(certify=False)
        assert motion.found.any()
        assert set(motion.skeleton.fixed) == {"A", "D"}
        # what was begun is forgotten: the mouse draws on
        page.keyboard.press("l")
        page.keyboard.press("Enter")
        page.keyboard.press("Escape")
        box = page.locator(".lw-drawing").bounding_box()
        x, y = box["x"] + 0.6 * box["width"], box["y"] + 0.8 * box["height"]
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 60, y, steps=3)
        page.mouse.up()
        page.locator("[data-sketched]").nth(5).wait_for(state="attached")


@pytest.mark.extended
def test_a_presentation_steps_through_newton(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "four-bar.toml"
    path.write_text(FOUR_BAR, encoding="utf-8")
    with shown(browser, MechanismFile(path)) as (page, _):
        page.wait_for_selector(".lw[data-row]")
        page.get_by_role("button", name="Close the first steps").click()
        page.keyboard.press("F9")
        page.locator(".lw-presenting .lw-steps tbody tr").nth(2).wait_for()
        chosen = page.locator(".lw-steps tr.lw-chosen")
        assert "guess" in chosen.text_content()
        page.keyboard.press("ArrowRight")
        assert chosen.locator("th").text_content() == "1"
        page.keyboard.press("ArrowLeft")
        assert "guess" in chosen.text_content()
        row = page.locator(".lw").get_attribute("data-row")
        page.keyboard.press("ArrowUp")  # the motion, not the iteration
        assert page.locator(".lw").get_attribute("data-row") != row
        page.keyboard.press("F9")
        assert page.get_by_role("tab", name="Dimensions").get_attribute("aria-selected") == "true"
        page.reload()
        page.wait_for_selector(".lw[data-row]")
        assert page.locator(".lw-first").count() == 0  # closed hints stay closed


@pytest.mark.extended
def test_a_presentation_of_a_draft_asks_for_no_steps(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "draft.toml"
    path.write_text(FOUR_BAR.partition("[input]")[0], encoding="utf-8")
    with shown(browser, MechanismFile(path)) as (page, _):
        page.locator(".lw-readiness li").first.wait_for()
        page.keyboard.press("F9")
        outcome = page.locator(".lw-presenting .lw-outcome")
        outcome.wait_for()
        assert outcome.text_content() == "Newton’s steps begin once the sketch is a mechanism."
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(300)  # a request would be refused within this time
        assert not page.locator(".lw-newton button").first.is_visible()
        assert page.locator(".lw-message:visible").count() == 0


@pytest.mark.extended
def test_the_start_page_takes_the_focus_and_gives_it_back(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "four-bar.toml"
    path.write_text(FOUR_BAR, encoding="utf-8")
    with shown(browser, MechanismFile(path)) as (page, _):
        page.wait_for_selector(".lw[data-row]")
        page.get_by_role("button", name="New: another mechanism").press("Enter")
        inside = "element => document.querySelector('.lw-start').contains(document.activeElement)"
        for _ in range(5):
            page.keyboard.press("Tab")
            assert page.locator(".lw-start").evaluate(inside)
        page.get_by_role("button", name="Back", exact=True).press("Enter")
        focus = page.evaluate("document.activeElement.getAttribute('aria-label')")
        assert focus.startswith("New")


def every_state(page: Any) -> Iterator[str]:
    """The page of a mechanism with each of its tabs and dialogs."""
    yield "moving"
    page.get_by_text("In words").click()
    for tab in ("Configurations", "Circuits", "Newton", "Build"):
        page.get_by_role("tab", name=tab).click()
        page.wait_for_timeout(600)
        yield tab
    page.get_by_role("tab", name="Dimensions").click()
    page.locator(".lw-tools [aria-keyshortcuts=V]").click()
    page.locator("[data-sketched]").first.focus()
    page.wait_for_timeout(300)
    yield "editing"
    page.locator(".lw-tools [aria-keyshortcuts=M]").click()
    page.get_by_role("button", name="Share by link").click()
    page.wait_for_timeout(400)
    yield "share"
    page.keyboard.press("Escape")
    page.locator(".lw-menu summary").click()
    yield "export"
    page.keyboard.press("Escape")
    page.keyboard.press("?")
    yield "keys"
    page.keyboard.press("Escape")
    page.locator(".lw-present").click()
    page.wait_for_timeout(600)
    yield "presentation"
    page.locator(".lw-present").click()
    page.get_by_role("button", name="New: another mechanism").click()
    page.wait_for_timeout(300)
    yield "start"


@pytest.mark.extended
@pytest.mark.parametrize(
    ("options", "scheme"), [(DESKTOP, "light"), (PHONE, "dark")], ids=["desktop", "phone"]
)
def test_axe_finds_nothing_serious_in_the_live_page(
    options: dict[str, Any], scheme: str, browser: Any, tmp_path: Path
) -> None:
    files: dict[str, Callable[[], MechanismFile]] = {
        "start": new_file,
        "draft": lambda: MechanismFile(tmp_path / "drawn.toml", blank_sheet("drawn")),
        "open": lambda: MechanismFile(tmp_path / "open.toml", FOUR_BAR.replace("120", "500")),
    }
    for opened in files.values():
        with shown(browser, opened(), color_scheme=scheme, **options) as (page, _):
            page.wait_for_selector(".lw, .lw-start")
            page.wait_for_timeout(800)
            assert_accessible(page)
    file = MechanismFile(tmp_path / "four-bar.toml", FOUR_BAR)
    with shown(browser, file, color_scheme=scheme, **options) as (page, _):
        page.wait_for_selector(".lw[data-row]")
        for _state in every_state(page):
            assert_accessible(page)
