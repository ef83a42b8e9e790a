"""Pictures and charts as TikZ: the same places, colours and numbers as in every other format."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.drawing.matplotlib_writer import write
from linkwork.core.drawing.mechanism_scene import configuration_sheet
from linkwork.core.drawing.scene import Disc, Text
from linkwork.core.drawing.vector_files import picture_scale, tikz_picture
from linkwork.core.foundation.names import as_latex
from linkwork.writers.charts.plane import motion_plot
from tests.library_mechanisms import read_example

_ROUNDED = 0.00051  # mm: coordinates have three digits after the point
_CIRCLE = re.compile(r"\(([-\d.]+),([-\d.]+)\) circle\[radius=([-\d.]+)\]")
_NODE = re.compile(r"at \(([-\d.]+),([-\d.]+)\) \{(.*)\};")


def test_a_picture_has_the_places_of_the_scene_in_the_true_scale() -> None:
    scene = read_example("four-bar").scene(at=60)
    text = tikz_picture(scene)
    assert "scale 1:1:" in text
    discs = np.array([(*disc.centre, disc.radius) for disc in scene.select(Disc)])
    drawn = np.array(_CIRCLE.findall(text), dtype=float)
    assert np.abs(drawn - discs).max() <= _ROUNDED
    names = {name: (float(x), float(y)) for x, y, name in _NODE.findall(text)}
    for label in scene.select(Text):
        assert names[as_latex(label.text)] == pytest.approx(label.start, abs=_ROUNDED)


@pytest.mark.parametrize(
    ("unit", "factor", "said"),
    [
        ("mm", 1.0, "scale 1:1"),
        ("m", 1.0, "scale 1:1000"),
        ("in", 1.0, "scale 1:20"),
        ("mm", 0.1, "scale 10:1"),
        ("", 1.0, "scale 1:1, a unit of length taken as 1 mm"),
    ],
)
def test_the_scale_is_the_nearest_round_one_that_fits(unit: str, factor: float, said: str) -> None:
    bar = lw.linkage(
        length=unit,
        points={"O": (0, 0), "A": (100 * factor, 30 * factor)},
        links={"ground": ["O"], "crank": ["O", "A"]},
        inputs=lw.Input(link="crank"),
    )
    scene = bar.scene()
    scale, shown = picture_scale(scene)
    assert shown == said
    assert 25 <= scale * max(scene.box.width, scene.box.height) <= 150


def test_text_is_escaped() -> None:
    assert as_latex("50 % of θ₂_a & {x} ∠ 3°") == (
        r"50 \% of $\theta$$_2$\_a \& \{x\} $\angle$ 3$^\circ$"
    )


def _lines(text: str) -> list[np.ndarray]:
    """The corners of the lines of a picture [inches]."""
    places = re.compile(r"\\pgfqpoint\{([-\d.]+)in\}\{([-\d.]+)in\}")
    scopes = [scope for scope in text.split("\\begin{pgfscope}") if "pgfpathlineto" in scope]
    return [
        np.array([places.findall(step)[0] for step in scope.split("\n") if "pgfpath" in step
                  and "rectangle" not in step and "close" not in step], dtype=float)
        for scope in scopes
    ]  # fmt: skip


def test_a_chart_contains_its_curve_to_scale(tmp_path: Path) -> None:
    motion = read_example("four-bar").sweep()
    file = write(motion_plot(motion, ["rocker"]), tmp_path / "rocker.tikz")
    text = file.read_text("utf-8")
    longest = max(_lines(text), key=len)
    for drawn, values in zip(longest.T, (motion["crank"], motion["rocker"]), strict=True):
        assert len(drawn) == len(values)
        fitted = np.polyval(np.polyfit(values, drawn, 1), values)
        assert np.abs(drawn - fitted).max() < 2e-6


def test_every_kind_of_chart_is_written_without_latex(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))  # no LaTeX there
    motion = read_example("four-bar").sweep(step=10)
    for kind, names in (("polar", ["rocker"]), ("path", ["B"]), ("transmission", []),
                        ("hodograph", ["B"])):  # fmt: skip
        file = write(motion_plot(motion, names, kind=kind), tmp_path / f"{kind}.tikz")
        text = file.read_text("utf-8")
        assert text.isascii()
        assert text.count("\\begin{") == text.count("\\end{") > 10
        assert "Four-bar linkage" in text
        assert _lines(text)


def test_texts_of_a_chart_are_those_of_latex(tmp_path: Path) -> None:
    motion = read_example("rapier-drive").sweep(step=10)
    file = write(motion_plot(motion, ["theta13"]), tmp_path / "theta.tikz")
    text = file.read_text("utf-8")
    assert as_latex("θ₁₃ [deg]") in text
    assert "\\usepackage{pgf}" in text


def test_a_sheet_of_several_positions_is_refused(tmp_path: Path) -> None:
    sheet = configuration_sheet(read_example("four-bar").configurations(at=60))
    with pytest.raises(lw.InputError, match="a TikZ picture shows one position or a chart"):
        write(sheet, tmp_path / "all.tikz")
