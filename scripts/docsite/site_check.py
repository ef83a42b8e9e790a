"""Checks of the built site in Chromium: ``python -m scripts.docsite.site_check SITE``.

Every page at the widths of a desktop and of a phone, opened once and then made narrower: images
that are not drawn, requests that fail or go elsewhere, errors of scripts, pages wider than the
window; at the first width also what axe-core calls serious or critical. Of the offline pages of
mechanisms every twentieth is opened, for their own tests cover them; with ``--all`` every one.
"""

from __future__ import annotations

import argparse
import functools
import shutil
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from playwright.sync_api import ViewportSize, sync_playwright

__all__ = ["BEYOND", "WIDTHS", "Site", "check_site", "chromium", "html_files", "served", "watched"]

WIDTHS = (1280, 390)
_AXE = Path(__file__).parents[2] / "frontend/node_modules/axe-core/axe.min.js"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_AT_ONCE = 2  # browsers: two cores in CI
_BROKEN = """() => [...document.images].filter((i) => i.complete && i.naturalWidth === 0)
  .map((i) => i.getAttribute("src"))"""
#: Elements that end beyond the window; parts of boxes that scroll are allowed there.
BEYOND = """() => document.documentElement.scrollWidth - document.documentElement.clientWidth"""
_RUN_AXE = """() => axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) =>
  violations.filter(({ impact }) => impact === "serious" || impact === "critical").flatMap(
    ({ id, nodes }) => nodes.map(({ html, any }) =>
      `${id}: ${html.slice(0, 120)} ${any[0]?.message ?? ""}`)))"""


@dataclass(frozen=True, kw_only=True)
class Site:
    """A built site: its folder, the text of axe-core, and whether no page is left out."""

    folder: Path
    axe: str = ""
    every: bool = False

    def pages(self) -> list[str]:
        """The pages to open."""
        found = sorted(path.relative_to(self.folder).as_posix() for path in html_files(self.folder))
        live = [page for page in found if page.startswith("_live/")]
        return [page for page in found if page not in live] + live[:: 1 if self.every else 20]


def html_files(folder: Path) -> Iterator[Path]:
    """The pages of a site, without those of its app."""
    for path in folder.rglob("*.html"):
        # the app has its own tests; templates of the theme are no pages
        if path.relative_to(folder).parts[0] not in ("app", "_static"):
            yield path


def check_site(site: Site) -> list[str]:
    """What is wrong, a line for each fault, with page and width."""
    pages = site.pages()
    shares = [pages[start::_AT_ONCE] for start in range(_AT_ONCE)]
    with ProcessPoolExecutor(_AT_ONCE) as workers:
        found = workers.map(_check_share, [site] * _AT_ONCE, shares)
        return [fault for share in found for fault in share]


def _check_share(site: Site, pages: list[str]) -> list[str]:
    faults: list[str] = []
    with served(site.folder) as own, sync_playwright() as playwright:
        browser = chromium(playwright)
        context = browser.new_context(reduced_motion="reduce")
        for page in pages:
            faults += [
                f"{page}{fault}" for fault in _faults(context.new_page(), own, page, site.axe)
            ]
        context.close()
        browser.close()
    return faults


def chromium(playwright: Any) -> Any:
    """The system's Chromium, without a window."""
    program = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if program is None:
        raise FileNotFoundError(f"none of {', '.join(_BROWSERS)} is on the PATH")
    return playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of the site on this machine: axe-core reads styles, which files refuse."""
    handler = functools.partial(_Quiet, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Without a line for every file."""


def watched(tab: Any, own: str) -> list[str]:
    """The list to which the tab adds requests that fail or go elsewhere, and errors of scripts."""
    faults: list[str] = []
    tab.route(lambda address: not _is_own(address, own), lambda route: route.abort())
    tab.on("requestfailed", lambda request: faults.append(f": failed: {request.url}"))
    tab.on(
        "request", lambda r: None if _is_own(r.url, own) else faults.append(f": foreign: {r.url}")
    )
    tab.on("response", lambda r: None if r.ok else faults.append(f": {r.status}: {r.url}"))
    tab.on("pageerror", lambda error: faults.append(f": error: {error}"))
    return faults


def _faults(tab: Any, own: str, page: str, axe: str) -> list[str]:
    """The faults of one page at all widths."""
    faults = watched(tab, own)
    for width in WIDTHS:
        window: ViewportSize = {"width": width, "height": 900}
        tab.set_viewport_size(window)
        if width == WIDTHS[0]:
            tab.goto(f"{own}/{page}", wait_until="load")
            # images below the window are loaded when they come near: ask for all of them
            tab.evaluate("() => { for (const i of document.images) i.loading = 'eager'; }")
        tab.wait_for_function("() => [...document.images].every((i) => i.complete)")
        found = [f"broken image: {source}" for source in tab.evaluate(_BROKEN)]
        beyond = tab.evaluate(BEYOND)
        if beyond > 0:
            found.append(f"{beyond} px wider than the window")
        if axe and width == WIDTHS[0]:
            tab.evaluate(axe)
            found += tab.evaluate(_RUN_AXE)
        faults += [f" at {width}: {fault}" for fault in found]
    tab.close()
    return faults


def _is_own(address: str, own: str) -> bool:
    return address.startswith((own, "data:", "blob:", "about:"))


def main() -> int:
    """Check the site; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("site", type=Path)
    parser.add_argument("axe", nargs="?", type=Path, default=_AXE)
    parser.add_argument("--all", action="store_true", help="every offline page, too")
    asked = parser.parse_args()
    if not asked.axe.is_file():
        sys.stderr.write(f"axe-core is not at {asked.axe}: scripts/frontend check installs it\n")
        return 2
    axe = asked.axe.read_text(encoding="utf-8")
    site = Site(folder=asked.site.resolve(), axe=axe, every=asked.all)
    faults = check_site(site)
    sys.stdout.writelines(f"{fault}\n" for fault in faults)
    sys.stdout.write(f"{len(site.pages())} pages at {len(WIDTHS)} widths: {len(faults)} faults\n")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
