"""The page shows the numbers of forces and simulations that the command line prints."""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.workbench import Workbench
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.tables import csv_text
from tests.app.live.conftest import serving
from tests.app.live.test_simulation import PENDULUM
from tests.described import described_as
from tests.forces.random_loads import loaded

WATCHED = Callable[..., Any]

_FORCES = re.compile(r"force|normal|moment|effort|energy|power|shaking|load")

#: The numbers of every row of the motion that the page has received, as the page unpacks them.
_NUMBERS = """() => {
  const rows = [...document.querySelectorAll(".lw-facts > .lw-table tr")];
  const text = (row, what) => row.querySelector(what)?.textContent;
  return rows.map((row) => [text(row, "th"), text(row, "td")]);
}"""


@contextmanager
def opened(watched: WATCHED, text: str, tmp_path: Path) -> Iterator[Any]:
    path = tmp_path / "shown.toml"
    path.write_text(text, encoding="utf-8")
    with serving(Workbench(MechanismFile(path), lw.loads)) as server:
        page = watched(
            (f"http://127.0.0.1:{server.port}/",), viewport={"width": 1440, "height": 900}
        )
        page.goto(server.address)
        page.wait_for_selector(".lw[data-row]")
        yield page
        page.close()


def shown(value: float) -> str:
    """A number as it is printed on pages: six digits, at most six decimals."""
    size = abs(value)
    decimals = min(6, max(0, 5 - math.floor(math.log10(size)))) if size else 0
    return f"{value:.{decimals}f}"


def compare(page: Any, motion: lw.Motion, row: int, least: int) -> None:
    """All digits of the displayed forces, efforts and energies that are not rounding."""
    compared = 0
    for name, text in page.evaluate(_NUMBERS):
        asked = motion.quantities.derived.get(name)
        if (
            asked is None
            or not asked.row
            or text is None
            or "force" not in f"{name} {asked.own.kind}"
        ):
            continue
        value = float(np.asarray(motion[name])[row])
        digits = text.replace("\u2212", "-").split()[0]
        if 1e-4 < abs(value) < 1e9:
            assert digits == shown(value), name
            compared += 1
    assert compared >= least


@pytest.mark.extended
@pytest.mark.parametrize(
    "name", ["crank-press", "balanced-lamp", "windscreen-wiper", "cam-swinging-follower"]
)
def test_forces_on_the_page_are_those_of_the_command(
    name: str, watched: WATCHED, tmp_path: Path
) -> None:
    mechanism = lw.example(name)
    if not described_as(Linkage, mechanism).loaded:
        mechanism = loaded(mechanism, seed=3)
    mechanism.save(tmp_path / "loaded.toml")
    text = (tmp_path / "loaded.toml").read_text(encoding="utf-8")
    motion = lw.loads(text).sweep()
    with opened(watched, text, tmp_path) as page:
        for row in (7, 31):
            page.evaluate(
                "row => { const bar = document.querySelector('.lw-track input'); bar.value = row;"
                "bar.dispatchEvent(new Event('input')); }",
                row,
            )
            compare(page, motion, int(page.locator(".lw").get_attribute("data-row")), 2)


@pytest.mark.extended
def test_a_simulation_on_the_page_is_that_of_the_command(watched: WATCHED, tmp_path: Path) -> None:
    own = lw.loads(PENDULUM).simulate(1.5, start_speed="10 deg/s")
    hits = [row for row, word in enumerate(own.limit) if word]
    with opened(watched, PENDULUM, tmp_path) as page:
        page.get_by_role("tab", name="Simulate").click()
        page.get_by_label("Until").fill("1.5")
        page.get_by_label("Start speed").fill("10 deg/s")
        page.get_by_label("Until").press("Enter")
        page.wait_for_selector('.lw-simulate [data-complete="true"]')
        page.locator(".lw-events button").first.click()
        compare(page, own, hits[0], 2)


def test_the_table_of_a_simulation_is_that_of_the_command_to_the_last_digit(tmp_path: Path) -> None:
    path = tmp_path / "shown.toml"
    path.write_text(PENDULUM, encoding="utf-8")
    bench = Workbench(MechanismFile(path), lw.loads)
    bench.handle(ask.Simulate(until=1.5, start_speed="10 deg/s"))
    (file,) = bench.handle(ask.Export(format="csv", simulated=True))
    assert isinstance(file, tell.Exported)
    own = lw.loads(PENDULUM).simulate(1.5, start_speed="10 deg/s")
    assert base64.b64decode(file.content).decode() == csv_text(own.table())
