"""Opens every link of a built site to its app: ``python -m scripts.docsite.app_check SITE``.

In Chromium, at the widths of a desktop and of a phone: each mechanism has to move and to have
numbers that can be changed; requests that fail or go elsewhere, errors of scripts and pages wider
than the window are faults.
"""

from __future__ import annotations

import re
import sys
from html import unescape
from pathlib import Path
from typing import Any

from playwright.sync_api import Error, sync_playwright

from scripts.docsite.site_check import BEYOND, WIDTHS, chromium, html_files, served, watched

__all__ = ["app_links", "check_app"]

_LINK = re.compile(r'href="(?:\.\./)*(app/index\.html#[^"]+)"')
_PATIENCE = 120_000  # [ms]: the first visit starts Python
_MOVED = """(first) => document.querySelector(".lw[data-row]").dataset.row !== first"""
_NUMBERS = "[data-number] input"


def app_links(folder: Path) -> list[str]:
    """The distinct links of all pages to the app."""
    texts = (path.read_text(encoding="utf-8") for path in html_files(folder))
    return sorted({unescape(link) for text in texts for link in _LINK.findall(text)})


def _faults(tab: Any, own: str, link: str) -> list[str]:
    """The faults of one link."""
    faults = watched(tab, own)
    try:
        tab.set_viewport_size({"width": WIDTHS[0], "height": 900})
        tab.goto(f"{own}/{link}")
        shown = tab.wait_for_selector(".lw[data-row]")
        tab.wait_for_function(_MOVED, arg=shown.get_attribute("data-row"))
        if not tab.locator(_NUMBERS).count():
            faults.append(": no number can be changed")
        for width in WIDTHS:
            tab.set_viewport_size({"width": width, "height": 900})
            beyond = tab.evaluate(BEYOND)
            if beyond > 0:
                faults.append(f" at {width}: {beyond} px wider than the window")
    except Error as error:
        faults.append(f": {error.message.splitlines()[0]}")
    tab.close()
    return faults


def check_app(folder: Path, patience: float = _PATIENCE) -> list[str]:
    """What is wrong, a line for each fault, with its link; ``patience`` in ms for each step."""
    faults: list[str] = []
    with served(folder) as own, sync_playwright() as playwright:
        browser = chromium(playwright)
        context = browser.new_context()
        context.set_default_timeout(patience)
        for link in app_links(folder):
            faults += [f"{link[:80]}{fault}" for fault in _faults(context.new_page(), own, link)]
        browser.close()
    return faults


def main() -> int:
    """Check the links; returns the exit status."""
    folder = Path(sys.argv[1]).resolve()
    links, faults = app_links(folder), check_app(folder)
    sys.stdout.writelines(f"{fault}\n" for fault in faults)
    sys.stdout.write(f"{len(links)} links to the app: {len(faults)} faults\n")
    return int(bool(faults) or not links)


if __name__ == "__main__":
    sys.exit(main())
