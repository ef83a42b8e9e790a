"""Pages show the forces of pins and loads as arrows, and the force polygon of a link."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import linkwork as lw

Open = Callable[..., Any]


@pytest.fixture(scope="module")
def press() -> lw.Motion:
    return lw.example("crank-press").sweep(step=5, certify=False)


def _tips(page: Any, name: str) -> list[float]:
    """The vector of a drawn force: the tip of its head from the tail of its shaft, y upwards."""
    group = page.locator(".lw-forces .lw-force", has=page.get_by_text(name, exact=True))
    shaft, head = (group.locator(f".{part}").get_attribute("d") for part in ("shaft", "head"))
    (x0, y0), (x1, y1) = (
        map(float, re.findall(r"-?[0-9.]+(?:e-?[0-9]+)?", path)[:2]) for path in (shaft, head)
    )
    return [x1 - x0, y0 - y1]


def test_pins_have_arrows_that_follow_the_motion(open_page: Open, press: lw.Motion) -> None:
    page = open_page({"motion": press})
    legend = page.locator(".lw-legend").inner_text()
    means, per = (float(n) for n in re.findall(r"[0-9.]+(?:e[0-9]+)?", legend)[:2])
    for row in (30, 31):
        page.evaluate(f"linkwork.goToRow({row})")
        wanted = [float(np.asarray(press[f"A.force.{axis}"])[row]) for axis in "xy"]
        drawn = _tips(page, "F(A)")
        assert [part * per / means for part in drawn] == pytest.approx(
            wanted, abs=2e-3 * math.hypot(*wanted)
        )
        dashes = page.locator(".lw-forces .shaft").evaluate_all(
            "all => all.map((one) => one.getAttribute('stroke-dasharray'))"
        )
        assert dashes == ["none"] * len(dashes)


def test_a_small_force_is_drawn_dashed_and_not_to_scale(open_page: Open, press: lw.Motion) -> None:
    page = open_page({"motion": press})
    page.evaluate("linkwork.goToRow(12)")  # before the work, which is a hundred times as large
    legend = page.locator(".lw-legend").inner_text()
    found = re.search(r"dashed: below ([0-9.]+) N, not to scale", legend)
    assert found is not None
    for name in ("A", "C", "O"):
        small = [float(np.asarray(press[f"{name}.force.{axis}"])[12]) for axis in "xy"]
        assert math.hypot(*small) < float(found[1])
        label = page.get_by_text(f"F({name})", exact=True)
        group = page.locator(".lw-forces .lw-force", has=label)
        assert group.locator(".shaft").get_attribute("stroke-dasharray") != "none"
        tip = _tips(page, f"F({name})")
        assert math.atan2(*tip) == pytest.approx(math.atan2(*small), abs=1e-2)


def test_the_force_polygon_of_a_link_adds_up_to_its_other_forces(
    open_page: Open, press: lw.Motion
) -> None:
    page = open_page({"motion": press})
    page.evaluate("document.querySelector('.lw-polygon').open = true")
    page.locator(".lw-polygon select").select_option("rod")
    page.evaluate("linkwork.goToRow(40)")
    rows = {name: float(np.asarray(press[name])[40]) for name in (
        "A.force.x", "A.force.y", "C.force.x", "C.force.y",
    )}  # fmt: skip
    rest = math.hypot(rows["A.force.x"] - rows["C.force.x"], rows["A.force.y"] - rows["C.force.y"])
    said = page.locator(".lw-polygon-note").inner_text()
    assert said.startswith("F(A) = ")
    found = re.search(r"rest ([0-9.]+)", said)
    assert found is not None
    assert float(found[1]) == pytest.approx(rest, rel=1e-4)
    arrows = page.locator(".lw-polygon g")
    assert arrows.count() == 3


def test_a_page_without_loads_has_no_forces(open_page: Open) -> None:
    page = open_page({"motion": lw.example("four-bar").sweep(step=30, certify=False)})
    assert not page.get_by_label("Forces").is_visible()
    assert not page.locator(".lw-polygon").is_visible()
