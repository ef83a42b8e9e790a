"""The page in a browser alone: first paint, first proven cycle, a drag, memory, transferred bytes.

``LINKWORK_PYODIDE=FOLDER python -m benchmarks web``, with a folder as ``scripts/web_files``
collects it; on a quiet machine. Each repeat has a new browser with empty caches.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.processes import private_memory
from linkwork.app.web.web_app import pyodide_files, web_folder

__all__ = ["measure"]

_BARS = {
    "first paint, first visit [s]": 0.5,
    "first proven cycle, first visit [s]": 6.0,
    "first proven cycle, second visit [s]": 3.0,
    "first proven cycle, third visit [s]": 3.0,
    "answer while a length of Jansen's leg is dragged [ms]": 100.0,
    "memory of the page's process, first visit [MB]": 150.0,
    "memory of the page's process, second visit [MB]": 150.0,
    "transferred at the first visit [MB]": 11.0,
}
_PATIENCE = 120_000  # ms
_ANSWERS = 60
_PROVED = """() => document.querySelector('.lw[data-row]') &&
  document.getElementById('linkwork').dataset.live === 'false'"""
_PAINTED = """() => performance.getEntriesByName('first-contentful-paint')[0].startTime"""
_DRAGGED = """async ([name, answers]) => {
  const page = document.getElementById('linkwork');
  const slider = document.querySelector(`[data-number="${name}"] input[type=range]`);
  const middle = Number(slider.value), took = [];
  for (let k = 0; k < answers; k++) {
    const answered = new Promise(done => {
      const watch = new MutationObserver(() => (watch.disconnect(), done()));
      watch.observe(page, { attributeFilter: ['data-updates'] });
    });
    const began = performance.now();
    slider.value = String(middle * (1 + 0.05 * Math.sin(0.2 * k)));
    slider.dispatchEvent(new Event('input'));
    await answered;
    took.push(performance.now() - began);
    await new Promise(requestAnimationFrame);
  }
  slider.dispatchEvent(new Event('change'));
  return took.sort((a, b) => a - b)[answers >> 1];
}"""


class _Host(SimpleHTTPRequestHandler):
    """A host of static files that counts what it sends."""

    sent = 0

    def log_message(self, *_: object) -> None:
        """Say nothing."""

    def copyfile(self, source: Any, outputfile: Any) -> None:
        """Send a file."""
        _Host.sent += os.fstat(source.fileno()).st_size
        super().copyfile(source, outputfile)


@contextmanager
def _hosted(files: dict[str, bytes]) -> Iterator[str]:
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            target = Path(folder) / name
            target.parent.mkdir(exist_ok=True)
            target.write_bytes(content)
        server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Host, directory=folder))
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/"
        finally:
            server.shutdown()
            thread.join(10)
            server.server_close()


def measure(repeats: int = 3) -> bool:
    """Limits: those of the list above."""
    print("the page in a browser alone")
    folder, program = os.environ.get("LINKWORK_PYODIDE", ""), shutil.which("chromium")
    if not folder or program is None:
        print("  not measured: LINKWORK_PYODIDE is not set, or chromium is not on the PATH")
        return True
    found: dict[str, list[float]] = {}
    with _hosted(web_folder(pyodide_files(Path(folder)))) as address:
        for _ in range(repeats):
            for name, value in _visits(program, address):
                found.setdefault(name, []).append(value)
    held = True
    for name, values in found.items():
        bar = _BARS.get(name)
        held &= bar is None or median(values) <= bar
        limit = "" if bar is None else f", at most {bar:g}"
        print(f"  {name:<56}{median(values):7.2f} ({min(values):.2f} to {max(values):.2f}){limit}")
    return held


def _visits(program: str, address: str) -> Iterator[tuple[str, float]]:
    """The figures of one browser: four visits, the last of which drags a length."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        # a motion that plays would take part of the processor
        context = browser.new_context(
            viewport={"width": 1440, "height": 900}, reduced_motion="reduce"
        )
        context.set_default_timeout(_PATIENCE)
        for visit in ("first", "second", "third"):
            page = context.new_page()
            before = _Host.sent
            yield f"first proven cycle, {visit} visit [s]", _opened(page, address, "four-bar")
            if visit == "first":
                yield "first paint, first visit [s]", page.evaluate(_PAINTED) / 1000
            page.wait_for_timeout(3000)  # the snapshot is kept for the next visit
            yield f"memory of the page's process, {visit} visit [MB]", private_memory("renderer")
            yield f"transferred at the {visit} visit [MB]", (_Host.sent - before) / 1e6
            page.close()
        page = context.new_page()
        _opened(page, address, "jansen-leg")
        took = float(page.evaluate(_DRAGGED, ["O A", _ANSWERS]))
        yield "answer while a length of Jansen's leg is dragged [ms]", took
        yield "memory of the page's process, after the drag [MB]", private_memory("renderer")
        browser.close()


def _opened(page: Any, address: str, example: str) -> float:
    """Open an example; the time to its first proven cycle [s]."""
    began = time.perf_counter()
    page.goto(f"{address}#example={example}", wait_until="commit")
    page.wait_for_function(_PROVED)
    return time.perf_counter() - began
