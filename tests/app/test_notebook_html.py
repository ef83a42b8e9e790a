"""What a notebook shows of results: well-formed, with their numbers, nothing of a name run."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.drawing import DARK, LIGHT
from linkwork.core.drawing.mechanism_scene import scene_of
from linkwork.core.drawing.scene import Disc, Role, Theme

_SVG = "{http://www.w3.org/2000/svg}"
_HOSTILE = '<script>alert("1")</script> & <b>'


@pytest.fixture(scope="module")
def bar() -> lw.Mechanism:
    return lw.example("four-bar")


def _parsed(shown: Any) -> ElementTree.Element:
    return ElementTree.fromstring(shown._repr_html_())


def _rows(page: ElementTree.Element) -> dict[str, str]:
    return {"".join(row[0].itertext()): "".join(row[1].itertext()) for row in page.iter("tr")}


def _pictures(page: ElementTree.Element) -> list[ElementTree.Element]:
    return list(page.iter(f"{_SVG}svg"))


def test_a_position_has_its_numbers_with_units(bar: lw.Mechanism) -> None:
    position = bar.solve(60)
    page = _parsed(position)
    rows = _rows(page)
    assert rows["coupler"] == f"{position['coupler']:.10g} deg"
    assert rows["mu"] == f"{position['mu']:.10g} deg"
    assert rows["certified"] == "yes"
    assert len(_pictures(page)) == 1


def test_a_length_has_the_unit_of_the_file() -> None:
    rapier = lw.example("rapier-drive").solve(60)
    assert _rows(_parsed(rapier))["s16"] == f"{rapier['s16']:.10g} mm"


def test_a_motion_has_its_ranges(bar: lw.Mechanism) -> None:
    motion = bar.sweep()
    page = _parsed(motion)
    low, high = motion["rocker"].min(), motion["rocker"].max()
    assert _rows(page)["rocker"] == f"{low:.8g} … {high:.8g} deg"
    assert _rows(page)["certified"] == "361 of 361"
    assert len(_pictures(page)) == 1


def test_configurations_and_circuits_have_a_picture_and_a_row_each(bar: lw.Mechanism) -> None:
    for shown, names in (
        (bar.configurations(60), ["open", "crossed"]),
        (bar.circuits(certify=False), ["circuit 1", "circuit 2"]),
    ):
        page = _parsed(shown)
        assert [caption.text for caption in page.iter("figcaption")] == names
        views = {picture.get("viewBox") for picture in _pictures(page)}
        assert len(_pictures(page)) == 2
        assert len(views) == 1  # of one scale
        assert all(any(row.startswith(name) for row in _rows(page)) for name in names)


def test_a_mechanism_has_its_start_and_its_equations(bar: lw.Mechanism) -> None:
    page = _parsed(bar)
    start = bar.solve()
    assert _rows(page)["crank"] == f"{start['crank']:.10g} deg"
    assert _rows(page)["rocker"] == f"{start['rocker']:.10g} deg"
    assert len(list(page.iter("math"))) == len(bar.equations().mathml())


def test_pins_stand_where_the_position_has_its_points(bar: lw.Mechanism) -> None:
    position = bar.solve(60)
    page = _parsed(position)
    pins = scene_of(position).select(Disc, Role.PIN)
    drawn = [(float(c.get("cx", "")), -float(c.get("cy", ""))) for c in page.iter(f"{_SVG}circle")]
    assert len(pins) == 4
    for pin in pins:
        nearest = min(np.hypot(x - pin.centre[0], y - pin.centre[1]) for x, y in drawn)
        assert nearest < 1e-2  # [mm] of 140: coordinates are written to five digits


def test_a_failed_position_tells_why_and_draws_nothing() -> None:
    limited = lw.example("rapier-drive-limited").solve(180)
    page = _parsed(limited)
    assert _rows(page) == {limited.status.name: limited.message}
    assert not _pictures(page)


def test_mechanisms_without_points_have_their_table() -> None:
    pair = lw.plain_equations(
        name="circle and line", equations={"circle": "x^2 + y^2 = 25", "line": "y = x + 1"},
        guess={"x": 2, "y": 5},
    )  # fmt: skip
    page = _parsed(pair)
    assert float(_rows(page)["x"]) == pytest.approx(3)
    assert not _pictures(page)
    assert not _pictures(_parsed(pair.configurations()))


def test_names_are_text_wherever_they_are_shown() -> None:
    hostile = lw.linkage(
        name=_HOSTILE,
        points={"O": (0, 0), "A": (40, 0), "B": (120, 60), "Q": (100, 0)},
        links={"ground": ["O", "Q"], "crank": ["O", "A"], "b": ["A", "B"], "c": ["Q", "B"]},
        inputs=lw.Input(link="crank"),
    )
    found = (hostile, hostile.solve(), hostile.sweep(to=9), hostile.configurations())
    for shown in (*found, hostile.circuits(certify=False)):
        text = shown._repr_html_()
        assert "<script" not in text
        assert "<b>" not in text
        assert _HOSTILE in "".join(ElementTree.fromstring(text).itertext())


def test_colours_follow_the_page_by_rules_alone(bar: lw.Mechanism) -> None:
    text = bar.solve(60)._repr_html_()
    page = ElementTree.fromstring(text)
    [style] = page.iter("style")
    used = set(re.findall(r"var\((--lw-[\w-]+)", text))
    pair = f"{LIGHT.tones[0]}-{DARK.tones[0]}".replace("#", "")
    assert f"--lw-{pair}" in used
    for name in used:
        light, dark = name.split("-")[-2:]
        assert (style.text or "").count(f"{name}:#{light};") == 2  # by itself, told by a notebook
        assert (style.text or "").count(f"{name}:#{dark};") == 2  # the system's, told likewise
    assert "url(" not in text
    assert not re.search(r"\bid=", text)  # several on a page do not meet


@pytest.mark.extended
@pytest.mark.parametrize("name", lw.examples())
def test_every_library_mechanism_shows_itself(name: str) -> None:
    mechanism = lw.example(name)
    drawn = bool(mechanism.solve().points)
    moving = [mechanism.cycle(certify=False)] if mechanism.description.inputs else []
    for shown in (mechanism, mechanism.solve(), *moving):
        page = _parsed(shown)
        assert len(_pictures(page)) == drawn
        assert all(len(list(row)) == 2 for row in page.iter("tr"))


def test_showing_loads_no_matplotlib() -> None:
    code = (
        "import sys, linkwork as lw; bar = lw.example('four-bar')\n"
        "bar._repr_html_(); bar.sweep()._repr_html_(); bar.configurations()._repr_html_()\n"
        "print('matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("False\n", "")


@pytest.mark.parametrize(
    ("body", "system", "theme"),
    [
        ("", "light", LIGHT),
        ("", "dark", DARK),
        ('data-jp-theme-light="true"', "dark", LIGHT),
        ('data-jp-theme-light="false"', "light", DARK),
        ('class="vscode-light"', "dark", LIGHT),
        ('class="vscode-dark"', "light", DARK),
    ],
)
def test_it_is_light_or_dark_as_the_notebook_is_else_as_the_system(
    browser: Any, bar: lw.Mechanism, body: str, system: str, theme: Theme
) -> None:
    page = browser.new_page(color_scheme=system)
    page.set_content(f"<html><body {body}>{bar.solve(60)._repr_html_()}</body></html>")
    told = "(of, what) => getComputedStyle(document.querySelector(of))[what]"
    colours = [
        page.evaluate(f"({told})('.linkwork-shown', 'backgroundColor')"),
        page.evaluate(f"({told})('.linkwork-shown', 'color')"),
        page.evaluate(f"({told})('.linkwork-shown circle', 'fill')"),
    ]
    page.close()
    assert colours == [_rgb(theme.background), _rgb(theme.ink), _rgb(theme.background)]


def _rgb(colour: str) -> str:
    return f"rgb({', '.join(str(int(colour[k : k + 2], 16)) for k in (1, 3, 5))})"
