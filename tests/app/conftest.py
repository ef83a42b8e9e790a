"""Pages in a real browser: the Chromium of the system, steered by Playwright."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork.app import motion_page, offline_page

_NAMES = ("chromium", "chromium-browser", "google-chrome")


@pytest.hookimpl(tryfirst=True)  # before pytest chooses by marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests in a browser are extended: a machine may have none, and they take long."""
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.extended)


@pytest.fixture(scope="session")
def browser(request: pytest.FixtureRequest) -> Any:
    """A headless Chromium. Where there is none the test is skipped, but never in CI."""
    program = next(filter(None, map(shutil.which, _NAMES)), None)
    if program is None:
        if os.environ.get("CI") == "true":
            pytest.fail(f"CI needs a browser: none of {', '.join(_NAMES)} is on the PATH")
        pytest.skip(f"none of {', '.join(_NAMES)} is on the PATH (apt-get install chromium)")
    from playwright.sync_api import sync_playwright

    config: Any = request.config  # a process can start Playwright once only
    if not hasattr(config, "linkwork_browser"):
        playwright = sync_playwright().start()
        found = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        config.linkwork_browser = found
        config.add_cleanup(playwright.stop)
        config.add_cleanup(found.close)
    return config.linkwork_browser


@pytest.fixture
def watched(browser: Any) -> Iterator[Callable[..., Any]]:
    """Makes pages; fails on any message of the console, and on any request that does not begin with
    one of the addresses in ``own``.
    """
    said: list[str] = []
    contexts = []

    def made(own: tuple[str, ...], **options: Any) -> Any:
        settings = {"reduced_motion": "reduce", "viewport": {"width": 1280, "height": 800}}
        context = browser.new_context(**(settings | options))
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda r: None if r.url.startswith(own) else said.append(r.url))
        return page

    yield made
    for context in contexts:
        context.close()
    assert said == []


@pytest.fixture
def open_page(watched: Callable[..., Any], tmp_path: Path) -> Callable[..., Any]:
    """Opens an offline page from a file, without a network."""

    def opened(motions: dict[str, lw.Motion], **options: Any) -> Any:
        target = tmp_path / "page.html"
        own = ("equations", "loops", "forces")
        shown = {key: options.pop(key) for key in own if key in options}
        target.write_text(offline_page(motion_page(motions, **shown)), "utf-8")
        page = watched(("file:",), offline=True, **options)
        page.goto(target.as_uri())
        page.wait_for_selector(".lw[data-row]")
        return page

    return opened
