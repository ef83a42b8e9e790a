"""The live page of Jansen's leg: time to the first picture, and cycles per second solved and
displayed while a dimension is dragged.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import linkwork as lw
from benchmarks.processes import processor_time
from linkwork.app.live.cycle import MotionPicture
from linkwork.app.live.messages import encoded
from linkwork.app.live.result_events import motion_found
from linkwork.core.motion.sweeping import sweep

__all__ = ["measure"]

_PICTURE_BAR = 0.8  # s from the command to the first picture, in a browser that runs
_RATE_BAR = 60.0  # cycles per second while a dimension is dragged
_DRAG = 4.0  # s
_STAGES = ("read", "solve", "draw", "encode")
_SHOWN = """() => new Promise(done => {
  const look = () =>
    document.querySelector('.lw[data-row]') ? done() : requestAnimationFrame(look);
  look();
})"""
_DRAGGED = """async ([name, seconds]) => {
  const page = document.getElementById('linkwork');
  const slider = document.querySelector(`[data-number="${name}"] input[type=range]`);
  const middle = Number(slider.value);
  const count = () => Number(page.dataset.updates);
  const began = performance.now(), before = count();
  let k = 0;
  while (performance.now() - began < 1000 * seconds) {
    slider.value = String(middle * (1 + 0.05 * Math.sin(0.05 * k++)));
    slider.dispatchEvent(new Event('input'));
    await new Promise(requestAnimationFrame);
  }
  const rate = 1000 * (count() - before) / (performance.now() - began);
  slider.dispatchEvent(new Event('change'));
  return rate;
}"""


def measure(repeats: int = 7) -> bool:
    """Limits on a quiet machine: 0.8 s to the first picture; 60 solved cycles a second."""
    print("the live page of Jansen's leg")
    _stages()
    rates = [_over_socket() for _ in range(3)]
    print(f"  cycles per second during a drag of a length, over the socket: {median(rates):.0f}")
    program = shutil.which("chromium")
    if program is None:
        print("  in a browser: not measured, chromium is not on the PATH")
        return True
    from playwright.sync_api import sync_playwright

    printed, shown, dragged = [], [], []
    spent: Counter[str] = Counter()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        for _ in range(repeats):
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            began = time.perf_counter()
            with _served() as address:
                printed.append(time.perf_counter() - began)
                page.goto(address, wait_until="commit")
                page.evaluate(_SHOWN)
                shown.append(time.perf_counter() - began)
                before = processor_time()
                dragged.append(float(page.evaluate(_DRAGGED, ["O A", _DRAG])))
                spent += processor_time() - before
            page.close()
        browser.close()
    print(
        f"  from the command to its address: median {median(printed):.2f} s, to the first picture "
        f"in a browser that runs: {median(shown):.2f} s ({min(shown):.2f} to {max(shown):.2f})"
    )
    print(
        f"  cycles per second displayed while a length is dragged: median {median(dragged):.0f} "
        f"({min(dragged):.0f} to {max(dragged):.0f})"
    )
    cycles = _DRAG * sum(dragged)
    each = ", ".join(f"{kind} {time / cycles:.1f}" for kind, time in spent.most_common(4))
    print(f"  processor time per displayed cycle [ms]: {each}")
    return median(shown) <= _PICTURE_BAR and median(dragged) >= _RATE_BAR


def _stages(repeats: int = 60) -> None:
    """Processor time of the stages of a drag, median [ms] and as a ratio to the solving."""
    text = lw.example_text("jansen-leg")
    picture = MotionPicture()
    took: dict[str, list[float]] = {}
    for k in range(repeats):
        changed = text.replace('"O A" = 15', f'"O A" = {15 + 0.01 * (k % 50)}')
        times = [time.process_time()]
        mechanism = lw.loads(changed)
        times.append(time.process_time())
        motion = sweep(mechanism.model, certify=False, explained=False)
        times.append(time.process_time())
        page = picture.page(motion, brief=True)
        times.append(time.process_time())
        encoded(motion_found(motion, live=True, page=page))
        times.append(time.process_time())
        for name, (one, other) in zip(_STAGES, pairwise(times), strict=True):
            took.setdefault(name, []).append(1000 * (other - one))
    solving = median(took["solve"])
    for name, times in took.items():
        print(f"  {name:<8} {median(times):5.2f} ms, {median(times) / solving:4.2f} of solving")


@contextmanager
def _served() -> Iterator[str]:
    """Start the command as a separate process; returns its printed address."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "jansen-leg.toml"
        target.write_bytes((files("linkwork") / "library" / "jansen-leg.toml").read_bytes())
        words = [sys.executable, "-m", "linkwork", "view", str(target), "--no-browser"]
        process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=dict(os.environ))
        assert process.stdout is not None
        try:
            yield next(line.strip() for line in process.stdout if "http://" in line)
        finally:
            process.terminate()
            process.communicate()


def _over_socket() -> float:
    """Cycles per second solved and sent, with two pending requests."""
    from websockets.sync.client import connect

    with _served() as address:
        home, token = address.split("/#")
        host = home.removeprefix("http://")
        settings: dict[str, Any] = {"origin": home, "max_size": None}
        protocols: list[Any] = ["linkwork", f"token.{token}"]
        with connect(f"ws://{host}/live", subprotocols=protocols, **settings) as page:
            while json.loads(page.recv())["kind"] != "motion_found":
                pass
            began, told, asked = time.perf_counter(), 0, 0
            while time.perf_counter() - began < _DRAG:
                while asked < told + 2:
                    asked += 1
                    value = 15.0 + 0.01 * (asked % 100)
                    page.send(
                        json.dumps(
                            {"kind": "set_number", "name": "O A", "value": value, "live": True}
                        )
                    )
                told += json.loads(page.recv())["kind"] == "motion_found"
            return told / (time.perf_counter() - began)
