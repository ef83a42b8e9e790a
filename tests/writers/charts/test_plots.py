"""``motion.plot`` and ``circuits.plot``, and how charts stand on a page."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes

import linkwork as lw
from linkwork.core.drawing import LIGHT, render
from linkwork.core.drawing.scene import DARK, THEMES, Theme
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.writers.charts.axes import DARK_CHART, LIGHT_CHART, ChartTheme, chart_theme
from linkwork.writers.charts.plane import circuits_plot, motion_plot
from tests.core.drawing.pages import assert_page_is_clear, left_title, svg_texts
from tests.thinned import thinned


@pytest.fixture(autouse=True)
def _no_window() -> Iterator[None]:
    """Figures without a window, all closed afterwards."""
    from matplotlib import pyplot

    before = matplotlib.get_backend()
    pyplot.switch_backend("agg")
    yield
    pyplot.close("all")
    pyplot.switch_backend(before)


@cache
def swept(name: str, **options: Any) -> lw.Motion:
    """The motion of a library mechanism, swept once."""
    return lw.example(name).sweep(certify=False, **options)


@cache
def circuits_of(name: str) -> lw.circuits.Circuits:
    return lw.example(name).circuits(certify=False)


PLOTS = [
    ("rapier-drive", {}),
    ("jansen-leg", {}),
    ("jansen-leg", {"names": ("condition", "residual", "iterations")}),
    ("rapier-drive-limited", {"names": ("s16", "s16.d1", "condition"), "through": True}),
    ("slider-crank-engine", {"names": ("s", "s.velocity", "s.acceleration"), "against": "time"}),
    ("planetary-gear", {"wrapped": True}),
    ("andrews-squeezer", {}),
    ("geneva-drive", {"names": ("wheel.d1", "wheel.d2")}),
    ("klann-leg", {"kind": "path"}),
    ("ross-yoke", {"kind": "path"}),
    ("slider-crank-engine", {"kind": "hodograph"}),
    ("four-bar", {"kind": "hodograph", "names": ("A", "B")}),
    ("trotbot-leg", {"kind": "transmission"}),
    ("andrews-squeezer", {"kind": "transmission"}),
]


@pytest.mark.parametrize(("name", "options"), PLOTS)
@pytest.mark.parametrize("theme", thinned(THEMES.values()), ids=THEMES)
def test_texts_are_on_the_page_and_keep_clear_of_each_other(
    name: str, options: dict[str, Any], theme: Theme
) -> None:
    options = dict(options)
    motion = swept(name, **{k: options.pop(k) for k in ("through",) if k in options})
    chart = motion_plot(motion, options.pop("names", ()), **options)
    assert_page_is_clear(chart.figure(theme))


@pytest.mark.parametrize(
    ("name", "of"),
    [("jansen-leg", ["foot"]), ("rapier-drive", ["s16", "θ13"]), ("slider-input", [])],
)
def test_small_multiples_keep_clear_of_each_other(name: str, of: list[str]) -> None:
    assert_page_is_clear(circuits_plot(circuits_of(name), of, kind="branches").figure(LIGHT))


@pytest.mark.parametrize("name", ["cam-roller-follower", "rapier-drive", "windscreen-wiper"])
def test_angles_stand_around_a_polar_plot_clear_of_its_name(name: str) -> None:
    page = motion_plot(swept(name), kind="polar").figure(LIGHT)
    page.canvas.draw()
    for ax in page.axes:
        texts = [*ax.get_xticklabels(), left_title(ax), *page.texts]
        boxes = [text.get_window_extent() for text in texts if text.get_text()]
        assert len(boxes) >= 15
        for one, other in combinations(boxes, 2):
            assert not one.overlaps(other)
        assert all(page.bbox.contains(*box.min) and page.bbox.contains(*box.max) for box in boxes)


def test_stations_stand_inside_their_panel() -> None:
    for name, kind in (("klann-leg", "path"), ("slider-crank-engine", "hodograph")):
        page = motion_plot(swept(name), kind=kind).figure(LIGHT)
        page.canvas.draw()
        for ax in page.axes:
            inside = ax.get_window_extent()
            boxes = [text.get_window_extent() for text in ax.texts]
            assert len(boxes) >= 7
            for box in boxes:
                assert inside.x0 <= box.x0 < box.x1 <= inside.x1
                assert inside.y0 <= box.y0 < box.y1 <= inside.y1


def test_planes_are_drawn_to_one_scale() -> None:
    page = motion_plot(swept("four-bar"), ["A"], kind="hodograph").figure(LIGHT)
    page.canvas.draw()
    for ax in page.axes:
        (x0, y0), (x1, y1) = ax.transData.transform([(0.0, 0.0), (1.0, 1.0)])
        assert x1 - x0 == pytest.approx(y1 - y0, rel=1e-6)


def test_large_numbers_are_written_with_powers_of_ten_along_the_whole_axis() -> None:
    motion = swept("slider-crank-engine")
    texts = svg_texts(render(motion_plot(motion, ["s.acceleration"]), "svg"))
    assert {"−10⁶", "−5·10⁵", "0", "5·10⁵"} <= set(texts)
    assert not any("e+" in text for text in texts)
    assert "acceleration of s [mm/s²]" in texts
    hodograph = motion_plot(swept("four-bar"), ["B"], kind="hodograph")
    page = hodograph.figure(LIGHT)
    page.canvas.draw()
    across = [label.get_text() for label in page.axes[1].get_xticklabels()]
    assert {"−10⁵", "−5·10⁴", "0", "5·10⁴"} <= set(across)


def test_a_lone_position_is_a_dot() -> None:
    motion = swept("four-bar")
    alone = lw.example("four-bar").sweep(from_=60, to=60, step=1, certify=False)
    assert (len(alone), len(motion)) == (1, 361)
    page = motion_plot(alone, ["B.x"]).figure(LIGHT)
    [ax] = page.axes
    [dot] = [line for line in ax.lines if str(line.get_gid()).startswith("curve:")]
    assert np.asarray(dot.get_xydata()).tolist() == [[60.0, alone["B.x"][0]]]
    assert (dot.get_marker(), dot.get_markevery()) == ("o", [0])
    [line] = motion_plot(motion, ["B.x"]).figure(LIGHT).axes[0].lines
    assert line.get_markevery() == []


@pytest.mark.parametrize("kind", ["curves", "polar", "path", "hodograph", "transmission"])
def test_the_same_plot_gives_the_same_bytes(kind: str) -> None:
    motion = swept("four-bar")
    names = ["A"] if kind in ("path", "hodograph") else []
    first, second = (render(motion_plot(motion, names, kind=kind), "svg") for _ in range(2))
    assert first == second


# ------------------------------------------------------------------ colours


def contrast(one: str, other: str) -> float:
    """WCAG's contrast ratio of two colours #RRGGBB."""

    def luminance(colour: str) -> float:
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", [LIGHT_CHART, DARK_CHART])
def test_texts_and_curves_stand_out_from_the_page(theme: ChartTheme) -> None:
    assert contrast(theme.ink, theme.background) > 7
    assert contrast(theme.faint, theme.background) >= 4.5
    assert min(contrast(tone, theme.background) for tone in theme.tones) > 2
    assert len(set(theme.tones)) == 6


def test_a_chart_takes_the_colours_that_go_with_those_of_a_drawing() -> None:
    assert chart_theme(LIGHT) is LIGHT_CHART
    page = motion_plot(swept("four-bar")).figure(DARK)
    assert matplotlib.colors.to_hex(page.get_facecolor()).upper() == DARK_CHART.background


# ------------------------------------------------------------------ plot


def test_plot_returns_the_axes_of_a_figure_that_pyplot_knows() -> None:
    from matplotlib import pyplot

    motion = swept("rapier-drive")
    ax = motion.plot("s16")
    assert isinstance(ax, Axes)
    assert ax.figure is pyplot.gcf()
    [line] = [line for line in ax.lines if line.get_gid() == "curve:s₁₆"]
    np.testing.assert_array_equal(line.get_ydata(), motion["s16"])


def test_plot_returns_axes_for_every_panel() -> None:
    first, second = swept("rapier-drive").plot("θ13", "s16", theme="dark")
    assert (first.get_ylabel(), second.get_ylabel()) == ("θ₁₃ [deg]", "s₁₆ [mm]")
    assert matplotlib.colors.to_hex(first.get_facecolor()).upper() == DARK_CHART.background
    panels = circuits_of("rapier-drive").plot("s16", kind="branches")
    assert [ax.get_title(loc="left").partition("\n")[0] for ax in panels] == [
        "circuit 1 branch 1", "circuit 2 branch 1", "circuit 3 branch 1", "circuit 3 branch 2",
    ]  # fmt: skip


def test_circuits_are_plotted_in_axes_of_their_own_too() -> None:
    ax = circuits_of("rapier-drive").plot("s16")
    assert {line.get_gid() for line in ax.lines if len(line.get_xydata())} == {
        "curve:circuit 1", "curve:circuit 2", "curve:circuit 3", "dead-point",
    }  # fmt: skip


def test_plot_draws_into_given_axes_with_the_legend_above_them() -> None:
    from matplotlib import pyplot

    _, ax = pyplot.subplots()
    found = swept("four-bar").plot("A.velocity", "B.velocity", against="time", ax=ax)
    assert found is ax
    ax.figure.canvas.draw()
    inside, legend = ax.get_window_extent(), ax.get_legend().get_window_extent()
    assert legend.y0 >= inside.y1 - 1
    title = left_title(ax).get_window_extent()
    assert title.y0 >= legend.y1 - 1
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "|velocity of A|", "|velocity of B|",
    ]  # fmt: skip
    assert ax.get_xlabel() == "time [s]"


def test_plot_keeps_the_settings_of_the_caller() -> None:
    with matplotlib.rc_context({"axes.titlesize": 31.0}):
        swept("four-bar").plot("B.x")
        assert matplotlib.rcParams["axes.titlesize"] == 31.0


def test_a_title_is_replaced_or_left_out() -> None:
    own = swept("four-bar").plot("B.x", title="Pin B").figure
    assert [text.get_text() for text in own.texts] == ["Pin B", "0° to 360°"]
    none = swept("four-bar").plot("B.x", title="").figure
    assert [text.get_text() for text in none.texts] == []


def test_too_few_axes_are_refused() -> None:
    from matplotlib import pyplot

    _, ax = pyplot.subplots()
    with pytest.raises(InputError) as raised:
        swept("rapier-drive").plot("θ13", "s16", ax=ax)
    assert str(raised.value) == (
        "the plot has 2 panels (θ₁₃ [deg], s₁₆ [mm]), but there are 1 axes: give one for each, "
        "or fewer columns"
    )
    _, pair = pyplot.subplots(2)
    assert swept("rapier-drive").plot("θ13", "s16", ax=pair) == tuple(pair)


def test_a_polar_plot_wants_polar_axes_and_others_do_not() -> None:
    from matplotlib import pyplot

    motion = swept("cam-roller-follower")
    round_ax = pyplot.subplot(1, 2, 1, projection="polar")
    ax = pyplot.subplot(1, 2, 2)
    with pytest.raises(InputError) as raised:
        motion.plot("s", kind="polar", ax=ax)
    assert str(raised.value) == ('this plot needs polar axes: plt.subplot(projection="polar")')
    with pytest.raises(InputError) as raised:
        motion.plot("s", ax=round_ax)
    assert str(raised.value) == "this plot needs axes that are not polar: plt.subplot()"
    assert motion.plot("s", kind="polar", ax=round_ax) is round_ax


def test_an_unknown_theme_is_refused_with_those_that_exist() -> None:
    with pytest.raises(UnknownNameError) as raised:
        swept("four-bar").plot(theme="black")
    assert str(raised.value) == 'there is no theme "black" (themes: light, dark)'


def test_a_motion_read_back_in_a_new_process_is_plotted(tmp_path: Path) -> None:
    stored = tmp_path / "motion.pickle"
    stored.write_bytes(pickle.dumps(lw.example("four-bar").sweep(step=90, certify=False)))
    code = f"import pickle; pickle.load(open({str(stored)!r}, 'rb')).plot('B.x')"
    subprocess.run([sys.executable, "-Wignore", "-c", code], check=True, env={"MPLBACKEND": "agg"})


def test_matplotlib_is_loaded_by_the_first_plot_only() -> None:
    code = (
        "import sys, linkwork as lw; m = lw.example('four-bar').sweep(step=90, certify=False);"
        "assert 'matplotlib' not in sys.modules; m.plot('B.x'); assert 'matplotlib' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"MPLBACKEND": "agg"}, timeout=60)
