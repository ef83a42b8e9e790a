"""The offline page in a browser: script time per frame while Jansen's crank is dragged; its size;
and the time to redraw a moving scene with another dimension.
"""

from __future__ import annotations

import math
import shutil
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any

import linkwork as lw
from linkwork.app import motion_page, offline_page
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.core.mechanism.linkage import Linkage

__all__ = ["measure"]

_MOVES = 240
_FRAME_BAR = 8.0  # ms of script, median
_ONE_BAR, _ALL_BAR = 400_000, 1_000_000  # bytes


def measure(repeats: int = 9) -> bool:
    """Limits: 8 ms of script per frame; 400 kB with one circuit, 1 MB with all six."""
    print("the offline page of Jansen's leg, 361 rows")
    mechanism = lw.example("jansen-leg")
    motion = mechanism.cycle()
    equations = mechanism.equations().mathml()
    text = offline_page(motion_page({"motion": motion}, equations=equations))
    everything = offline_page(motion_page(mechanism.cycles(), equations=equations))
    one, every = len(text.encode()), len(everything.encode())
    print(f"  size: {one / 1000:.0f} kB with one circuit, {every / 1000:.0f} kB with all")
    before = moving_scene(motion)
    assert isinstance(mechanism.description, Linkage)
    lengths = {**mechanism.description.lengths, "O A": 15.5}
    changed = mechanism.changed(lengths=lengths).cycle()
    took = []
    for _ in range(repeats):
        began = time.perf_counter()
        moving_scene(changed, like=before)
        took.append(1000 * (time.perf_counter() - began))
    print(f"  redrawn with another length: median {median(took):.1f} ms")
    held = one <= _ONE_BAR and every <= _ALL_BAR
    program = shutil.which("chromium")
    if program is None:
        print("  script per frame: not measured, chromium is not on the PATH")
        return held
    script, whole = _dragged(program, text)
    print(
        f"  script per frame while the crank is dragged: median {median(script):.2f} ms, "
        f"largest {max(script):.2f} ms; with style, layout and drawing {median(whole):.2f} ms"
    )
    return held and median(script) <= _FRAME_BAR


def _dragged(program: str, text: str) -> tuple[list[float], list[float]]:
    """Script and all main-thread time of every frame [ms]."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        target = Path(folder) / "page.html"
        target.write_text(text, encoding="utf-8")
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(reduced_motion="reduce", viewport={"width": 1280, "height": 800})
        page.goto(target.as_uri())
        page.wait_for_selector(".lw[data-row]")
        metrics = page.context.new_cdp_session(page)
        metrics.send("Performance.enable")
        centre = _middle(page, 'circle[data-of="O"][data-role="pin"]')
        pin = _middle(page, 'circle[data-of="A"][data-role="pin"]')
        arm = pin - centre
        page.mouse.move(pin.real, pin.imag)
        page.mouse.down()
        script, whole = [], []
        for k in range(1, _MOVES + 1):
            place = centre + arm * complex(math.cos(-k * 0.05), math.sin(-k * 0.05))
            before = _durations(metrics)
            page.mouse.move(place.real, place.imag)
            page.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done)))")
            after = _durations(metrics)
            script.append(1000 * (after["ScriptDuration"] - before["ScriptDuration"]))
            whole.append(1000 * (after["TaskDuration"] - before["TaskDuration"]))
        browser.close()
    return script, whole


def _middle(page: Any, selector: str) -> complex:
    box = page.locator(selector).first.bounding_box()
    return complex(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)


def _durations(metrics: Any) -> dict[str, float]:
    found = metrics.send("Performance.getMetrics")["metrics"]
    return {one["name"]: one["value"] for one in found}
