"""The page of designs in a folder, in a browser."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import linkwork as lw
from linkwork.synthesis.designs_folder import FolderOptions, write_designs


def test_a_table_with_a_column_for_each_goal_fits_into_the_page(
    tmp_path: Path, watched: Callable[..., Any]
) -> None:
    goals = [
        {"of": "stroke(rocker)", "target": 62},
        {"of": "max(coupler)", "target": 40},
        {"of": "min(B.transmission)", "target": 30},
    ]
    task = lw.Task.improve("four-bar", goals=goals, starts=2)
    found = task.solve()
    write_designs(found, tmp_path / "out", FolderOptions(html=True))
    path = tmp_path / "out" / "index.html"
    page = watched((path.as_uri(),), viewport={"width": 1280, "height": 800})
    page.goto(path.as_uri())
    assert page.locator("th").count() == 11
    table = page.locator(".wide")
    assert table.evaluate("(box) => box.scrollWidth") <= table.evaluate("(box) => box.clientWidth")
    # a bound of the transmission angle is rounded down
    for design, caption in zip(found.delivered, page.locator("figcaption").all(), strict=True):
        shown = float(re.findall(r"transmission angle ([\d.]+)°", caption.text_content())[0])
        assert shown <= design.transmission < shown + 0.01
    cells = page.locator("tbody td:nth-child(4)").all_text_contents()
    for design, cell in zip(found.designs, cells, strict=True):
        assert float(cell) <= design.transmission < float(cell) + 0.001
