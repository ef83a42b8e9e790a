"""Charts of circuits: what they say as data, and how it stands on the page."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import linkwork as lw
from linkwork.core.drawing import LIGHT, circuit_chart, render
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.writers.charts import chart as chart_module, circuits as circuit_chart_module
from linkwork.writers.charts.chart import LIGHT_CHART, Chart, Curve
from linkwork.writers.charts.circuits import branch_chart
from linkwork.writers.charts.kinds import motion_chart
from linkwork.writers.charts.matplotlib_plot import chart_figure
from tests.drawing.pages import assert_page_is_clear, printed_texts, size_in_inches, svg_texts
from tests.thinned import thinned

#: One of each kind of input, of circuits that close, turn back, run to infinity, or meet.
SWEPT = (
    "belt-drive", "cam-roller-follower", "coupled-six-link", "crank-slider",
    "double-four-bar", "four-bar", "garage-door", "inverted-slider-crank", "jansen-leg",
    "planetary-gear", "rack-and-pinion", "rapier-drive", "rapier-drive-limited", "rolling-wheel",
    "scotch-yoke", "slider-input", "stephenson-far-crank",
)  # fmt: skip
every_fourth = pytest.mark.parametrize("name", thinned(SWEPT, 4))
QUARTER = math.pi / 2
LINKS = {
    "ground": ("O2", "O4"),
    "crank": ("O2", "A"),
    "coupler": ("A", "B"),
    "rocker": ("O4", "B"),
}


def four_bar(
    ground: float, crank: float, coupler: float, rocker: float, **parts: Any
) -> lw.Mechanism:
    """By its lengths, the crank near 60 degrees."""
    a = crank * (0.5 + 0.75**0.5 * 1j)
    d = abs(ground - a)
    x = (d * d + coupler**2 - rocker**2) / (2 * d)
    b = a + (x + 1j * (coupler**2 - x * x) ** 0.5) * (ground - a) / d
    points = {"O2": 0j, "A": a, "B": b, "O4": complex(ground)}
    return lw.linkage(
        points={name: (z.real, z.imag) for name, z in points.items()},
        links=LINKS,
        lengths={"O2 A": crank, "A B": coupler, "O4 B": rocker},
        inputs=lw.Input(link="crank"),
        **parts,
    )


_FOUND: dict[str, lw.circuits.Circuits] = {}


def circuits_of(name: str) -> lw.circuits.Circuits:
    """Circuits of a library mechanism, found once."""
    if name not in _FOUND:
        _FOUND[name] = lw.example(name).circuits()
    return _FOUND[name]


def ray_and_line() -> lw.circuits.Circuits:
    """A pin on a line runs to infinity where the line and its arm become parallel."""
    return lw.loops(
        name="ray and line",
        loops={"O P": "r*e^(i*θ) = 1 + i*s"},
        guess={"θ": 0.3, "r": 1.05, "s": 0.3},
        angle="rad",
        inputs=lw.Input(variable="θ", start=0, stop=6, step=0.1),
    ).circuits()


def breaks(curve: Curve) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Where a line is interrupted: the points before and behind each gap."""
    gaps = np.flatnonzero(np.isnan(curve.x))
    return [((curve.x[k - 1], curve.y[k - 1]), (curve.x[k + 1], curve.y[k + 1])) for k in gaps]


def page_of(chart: Chart) -> Figure:
    return chart_figure(chart, LIGHT)


# ------------------------------------------------------------------ curves


def test_every_branch_of_every_circuit_is_a_curve_in_every_panel() -> None:
    chart = circuit_chart(circuits_of("rapier-drive"))
    labels = [panel.axis.label for panel in chart.panels]
    assert labels == ["θ₁₃ [deg]", "θ₁₄ [deg]", "θ₁₅ [deg]", "s₁₆ [mm]"]
    for panel in chart.panels:
        told = [(curve.name, curve.tone) for curve in panel.curves]
        assert told == [("circuit 1", 1), ("circuit 2", 2), ("circuit 3", 3), ("circuit 3", 3)]


@every_fourth
def test_curves_pass_through_every_position_of_their_circuit_and_through_no_other(
    name: str,
) -> None:
    circuits = circuits_of(name)
    turn = circuits[0].motion.units.angle.turn
    chart = circuit_chart(circuits)
    for panel, unknown in zip(chart.panels, circuits[0].motion.unknowns, strict=False):
        for circuit in circuits:
            own = [curve for curve in panel.curves if curve.name == circuit.name]
            x = np.concatenate([curve.x for curve in own])
            y = np.concatenate([curve.y for curve in own])
            wanted_x, wanted_y = circuit[circuits.input], circuit[unknown]
            dx, dy = x - wanted_x[::7, None], y - wanted_y[::7, None]
            if chart.axis.turn:
                dx -= turn * np.round(dx / turn)
            if panel.axis.turn:
                dy -= turn * np.round(dy / turn)
            assert np.nanmin(np.hypot(dx, dy), axis=1).max() < 1e-8 * turn, (unknown, circuit.name)
            # A cut adds two points and a gap between them, and a line does not end in one.
            added = sum(3 * len(breaks(curve)) for curve in own)
            assert len(x) <= len(wanted_x) + added


@every_fourth
def test_curves_and_marks_stay_inside_their_axes(name: str) -> None:
    chart = circuit_chart(circuits_of(name))
    for panel in chart.panels:
        for along, axis in (("x", chart.axis), ("y", panel.axis)):
            if axis.ends is None:
                continue
            values = np.concatenate([getattr(curve, along) for curve in panel.curves])
            low, high = axis.ends
            assert low - 1e-9 <= np.nanmin(values) <= np.nanmax(values) <= high + 1e-9
            assert all(low <= getattr(mark, along) <= high for mark in panel.marks)
            assert (high - low) / axis.step == pytest.approx(round((high - low) / axis.step))


def test_a_line_stops_at_a_whole_turn_of_the_input_and_goes_on_at_the_other_side() -> None:
    [panel] = circuit_chart(circuits_of("rapier-drive"), ["s16"]).panels
    for curve in panel.curves[:2]:  # the crank goes from 60 to 420
        [((x0, y0), (x1, y1))] = breaks(curve)
        assert (x0, x1) == (360.0, 0.0)
        assert y0 == y1
    assert [breaks(curve) for curve in panel.curves[2:]] == [[], []]


def test_an_angle_that_turns_fully_is_cut_once_at_the_edges_of_its_panel() -> None:
    [panel] = circuit_chart(circuits_of("slider-input"), ["θ2"]).panels
    assert (panel.axis.ends, panel.axis.step) == ((0, 360), 90)
    cut = [gap for curve in panel.curves for gap in breaks(curve)]
    assert len(cut) == 2  # one for each circuit
    for (x0, y0), (x1, y1) in cut:
        assert {y0, y1} == {0.0, 360.0}
        assert x0 == pytest.approx(x1, abs=1e-12)


def test_angles_are_shown_over_the_turn_that_cuts_them_least() -> None:
    [rod] = circuit_chart(circuits_of("crank-slider"), ["θ3"]).panels
    # one circuit around 170 degrees, one around 10: a turn from 0 would cut the second
    assert (rod.axis.ends, rod.axis.step) == ((-90, 270), 90)
    assert [len(breaks(curve)) for curve in rod.curves] == [1, 1]  # at the input's turn only
    low = min(float(np.nanmin(curve.y)) for curve in rod.curves)
    assert low == pytest.approx(-math.degrees(math.asin((40 - 20) / 120)), abs=0.1)


def test_a_line_along_an_edge_moves_into_the_panel() -> None:
    coupler, rocker = circuit_chart(four_bar(100, 40, 100, 40).circuits()).panels
    assert coupler.axis.ends
    low, high = coupler.axis.ends  # 0 in one circuit, between -90 and 90 in the other
    assert low < -20 < 20 < high
    assert rocker.axis.ends == (0, 360)  # it turns fully: cut in no other way


def test_angles_within_less_than_half_a_turn_fill_their_panel() -> None:
    chart = circuit_chart(circuits_of("rapier-drive-limited"))
    told = [(panel.axis.ends, panel.axis.step) for panel in chart.panels]
    assert told == [((150, 200), 10), ((30, 180), 30), ((60, 210), 30), (None, 0)]
    for panel in chart.panels[:3]:
        assert panel.axis.ends
        (low, high), step = panel.axis.ends, panel.axis.step
        y = np.concatenate([curve.y for curve in panel.curves])
        assert low < np.nanmin(y) < low + 1.1 * step
        assert high - 1.1 * step < np.nanmax(y) < high


def test_an_angle_that_stays_as_it_is_lies_inside_a_panel_of_some_degrees() -> None:
    [block] = circuit_chart(circuits_of("slider-crank"), ["block"]).panels
    assert all(np.nanmax(np.abs(curve.y)) == 0.0 for curve in block.curves)
    assert (block.axis.ends, block.axis.step) == ((-1, 1), 1)


def test_radians_have_axes_of_radians() -> None:
    chart = circuit_chart(circuits_of("andrews-squeezer"))
    axis = chart.axis
    assert (axis.label, axis.ends, axis.step) == ("β [rad]", (0, 4 * QUARTER), QUARTER / 2)
    told = [(panel.axis.ends, panel.axis.step) for panel in chart.panels]
    assert told[:3] == [
        ((0, 4 * QUARTER), QUARTER),
        ((0, 0.5), 0.1),
        ((-QUARTER, 3 * QUARTER), QUARTER),
    ]
    labels = [text for text, _ in printed_texts(page_of(replace(chart, panels=chart.panels[2:3])))]
    assert labels[-5:] == ["−π/2", "0", "π/2", "π", "3π/2"]
    assert labels[-14:-5] == ["0", "π/4", "π/2", "3π/4", "π", "5π/4", "3π/2", "7π/4", "2π"]


def test_an_input_that_is_a_length_is_shown_as_far_as_it_goes() -> None:
    chart = circuit_chart(circuits_of("slider-input"))
    assert (chart.axis.label, chart.axis.turn, chart.axis.ends) == ("d [mm]", 0.0, None)
    x = np.concatenate([curve.x for curve in chart.panels[0].curves])
    reach = math.sqrt(160**2 - 20**2)  # crank and rod in line, offset 20
    assert (np.nanmin(x), np.nanmax(x)) == pytest.approx((-reach, reach), abs=1e-9)


def test_numbers_without_a_unit_are_labelled_with_their_name_alone() -> None:
    circuits = four_bar(
        100, 40, 120, 80, outputs={"ratio": "rocker/coupler", "mu": "rocker"}
    ).circuits()
    labels = [panel.axis.label for panel in circuit_chart(circuits, ["ratio", "mu", "O4.x"]).panels]
    assert labels[0] == "ratio"
    assert labels[2] == "O₄.x [mm]"


def test_an_input_at_rest_is_an_upright_line() -> None:
    kite = four_bar(1, 1, 2, 2)
    circuits = kite.circuits()
    chart = circuit_chart(circuits)
    ends = [branch.end for branch in circuits[0].branches]
    assert ends.count(lw.CircuitEnd.INPUT_CONSTANT) == 2
    for curve, end in zip(chart.panels[0].curves, ends, strict=True):
        resting = end is lw.CircuitEnd.INPUT_CONSTANT
        assert (np.nanmax(curve.x) - np.nanmin(curve.x) < 1e-6) == resting
        assert np.nanmax(curve.y) - np.nanmin(curve.y) > 90
        if resting:
            assert np.nanmax(curve.x) < 1e-6 or np.nanmin(curve.x) > 360 - 1e-6


def test_lengths_that_run_to_infinity_leave_their_panel() -> None:
    chart = circuit_chart(ray_and_line())
    for panel in chart.panels:
        y = np.concatenate([curve.y for curve in panel.curves])
        assert panel.axis.ends
        low, high = panel.axis.ends
        assert np.nanmax(np.abs(y)) > 1000
        assert -20 < low < -2
        assert 2 < high < 20
    page = page_of(chart)
    for ax, panel in zip(page.axes, chart.panels, strict=True):
        assert ax.get_ylim() == panel.axis.ends
        assert all(line.get_clip_on() for line in ax.lines)
    assert_page_is_clear(page)


def test_a_curve_under_others_is_drawn_wider() -> None:
    chart = circuit_chart(circuits_of("double-four-bar"))
    below = {panel.axis.label: [curve.below for curve in panel.curves] for panel in chart.panels}
    # θ2 and θ3 follow from the first loop alone: the second one's two ways lie over each other
    assert below["θ₂ [deg]"] == below["θ₃ [deg]"] == [1, 0, 1, 0]
    assert below["θ₄ [deg]"] == below["θ₅ [deg]"] == [0, 0, 0, 0]
    widths = [
        [line.get_linewidth() for line in ax.lines if str(line.get_gid()).startswith("curve:")]
        for ax in page_of(chart).axes
    ]
    assert widths[0][0] == widths[0][2] > 2 * widths[0][1]
    assert len(set(widths[2])) == 1


# ------------------------------------------------------------------ marks


@every_fourth
def test_dead_points_are_marked_at_their_input_and_at_the_value_there(name: str) -> None:
    circuits = circuits_of(name)
    chart = circuit_chart(circuits)
    turn = chart.axis.turn
    for panel, unknown in zip(chart.panels, circuits[0].motion.unknowns, strict=False):
        for tone, circuit in enumerate(circuits, start=1):
            marks = [mark for mark in panel.marks if mark.tone == tone]
            wanted = sorted(limit.input for limit in circuit.dead_points)
            if turn:
                wanted = sorted(value % turn for value in wanted)
            assert sorted(mark.x for mark in marks) == pytest.approx(wanted, abs=1e-9)
            for mark in marks:
                assert mark.kind == "dead point"
                at = np.abs(mark.x - circuit[circuits.input])
                at = np.minimum(at, np.abs(at - turn)) if turn else at
                away = np.abs(circuit[unknown][at < 1e-9] - mark.y)
                if panel.axis.turn:
                    away = np.abs(away - panel.axis.turn * np.round(away / panel.axis.turn))
                assert away.min() < 1e-9


def test_change_points_are_marked_on_both_sides_of_a_whole_turn() -> None:
    chart = circuit_chart(four_bar(4, 1, 3, 2).circuits())
    for panel in chart.panels:
        assert {mark.kind for mark in panel.marks} == {"change point"}
        assert {mark.x for mark in panel.marks} == {180.0}
    parallelogram = circuit_chart(four_bar(100, 40, 100, 40).circuits())
    coupler, rocker = ({(m.x, m.y) for m in panel.marks} for panel in parallelogram.panels)
    assert coupler == {(0, 0), (180, 0), (360, 0)}
    assert rocker == {(0, 0), (0, 360), (180, 180), (360, 0), (360, 360)}
    assert all(len(panel.marks) == len(set(panel.marks)) for panel in parallelogram.panels)


# ------------------------------------------------------------------ what is asked


def test_quantities_are_drawn_as_asked_in_any_spelling_and_once() -> None:
    chart = circuit_chart(circuits_of("rapier-drive"), ["E.x", "theta13", "s16", "θ13"])
    assert [p.axis.label for p in chart.panels] == ["E.x [mm]", "θ₁₃ [deg]", "s₁₆ [mm]"]


def test_the_first_unknowns_are_drawn_if_nobody_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(circuit_chart_module, "MOST_PANELS", 3)
    chart = circuit_chart(circuits_of("rapier-drive"))
    assert [p.axis.label for p in chart.panels] == ["θ₁₃ [deg]", "θ₁₄ [deg]", "θ₁₅ [deg]"]


def test_an_unknown_quantity_is_refused_with_those_that_exist() -> None:
    with pytest.raises(UnknownNameError) as raised:
        circuit_chart(circuits_of("four-bar"), ["roker"])
    assert str(raised.value) == (
        'there is no "roker" (nearest: rocker, coupler, crank; all: linkwork quantities FILE)'
    )


def test_no_circuit_is_no_chart() -> None:
    circuits = lw.linkage(
        name="Too short",
        points={"O2": (0, 0), "A": (10, 0), "B": (50, 0), "O4": (100, 0)},
        links=LINKS,
        lengths={"O2 A": 10, "A B": 30, "O4 B": 40},
        inputs=lw.Input(link="crank"),
    ).circuits()
    with pytest.raises(InputError) as raised:
        circuit_chart(circuits)
    assert str(raised.value) == f'"Too short" has no circuit to draw: {circuits.message}'


# ------------------------------------------------------------------ the page


@every_fourth
def test_texts_are_on_the_page_and_keep_clear_of_each_other(name: str) -> None:
    circuits = circuits_of(name)
    chart = circuit_chart(circuits)
    page = page_of(chart)
    assert_page_is_clear(page)
    count = len(circuits)
    limits = ["dead point"] if any(circuit.dead_points for circuit in circuits) else []
    assert [text.get_text() for text in page.texts] == [
        circuits.mechanism,
        f"{count} circuit{'' if count == 1 else 's'}",
    ]
    legend = [text.get_text() for entry in page.legends for text in entry.get_texts()]
    assert legend == [*(circuit.name for circuit in circuits), *limits]
    assert [ax.get_ylabel() for ax in page.axes] == [panel.axis.label for panel in chart.panels]
    assert [ax.get_xlabel() for ax in page.axes] == [
        *("" for _ in chart.panels[1:]),
        chart.axis.label,
    ]


def crowded(chart: Chart) -> Chart:
    """The same with thirteen circuits, change points, long and wide names."""
    panel = chart.panels[0]
    curve = panel.curves[0]
    curves = [replace(curve, tone=k, name=f"circuit {k}") for k in range(1, 14)]
    marks = [
        chart_module.Mark(x=90.0, y=150.0, tone=k, kind=kind)
        for k, kind in ((1, "change point"), (2, "dead point"))
    ]
    wide = replace(
        panel,
        axis=replace(panel.axis, label="the_angle_between_boom_and_stick [deg]"),
        curves=tuple(curves),
        marks=tuple(marks),
    )
    title = "A mechanism WHOSE NAME is long, " * 4 + "W" * 90
    return replace(chart, title=title, caption="13 circuits", panels=(wide, *chart.panels[1:]))


def test_long_names_and_many_circuits_have_room() -> None:
    page = page_of(crowded(circuit_chart(circuits_of("rapier-drive"))))
    assert_page_is_clear(page)
    title = [text.get_text() for text in page.texts]
    assert len(title) > 4
    assert title[-1] == "13 circuits"
    legend = [text.get_text() for entry in page.legends for text in entry.get_texts()]
    for ax in page.axes:
        label, inside = ax.yaxis.label.get_window_extent(), ax.get_window_extent()
        assert inside.y0 <= label.y0 < label.y1 <= inside.y1
    # the last panels have circuits 1 to 3 only, which are in the legend already
    assert legend == [*(f"circuit {k}" for k in range(1, 14)), "change point", "dead point"]


def dashes_of(line: Line2D) -> object:
    """As drawn; Matplotlib tells no one else."""
    return getattr(line, "_dash_pattern")  # noqa: B009 - unknown to its types


def test_circuits_of_one_colour_differ_in_their_dashes() -> None:
    page = page_of(crowded(circuit_chart(circuits_of("rapier-drive"))))
    keys = [entry.get_lines()[0] for entry in page.legends][:13]
    looks = {(to_rgba(key.get_color()), str(dashes_of(key))) for key in keys}
    assert len(looks) == 13
    lines = [line for line in page.axes[0].lines if str(line.get_gid()).startswith("curve:")]
    for key, line in zip(keys, lines, strict=True):
        assert line.get_gid() == f"curve:{key.get_label()}"
        assert line.get_color() == key.get_color()
        assert line.get_linestyle() == key.get_linestyle()


def test_the_page_draws_the_curves_and_marks_of_the_chart() -> None:
    chart = circuit_chart(circuits_of("rapier-drive"))
    for ax, panel in zip(page_of(chart).axes, chart.panels, strict=True):
        lines = [line for line in ax.lines if str(line.get_gid()).startswith("curve:")]
        for line, curve in zip(lines, panel.curves, strict=True):
            own = np.stack([curve.x, curve.y], axis=1)
            own = own[np.isfinite(own).all(axis=1)]
            drawn = np.asarray(line.get_xydata())
            off = np.abs(drawn[None] - own[:, None]).max(axis=2)
            assert np.nanmin(off, axis=1).max() < 1e-12 * np.abs(own).max()
            assert line.get_color() == LIGHT_CHART.tones[curve.tone - 1]
        marks = [line for line in ax.lines if line.get_gid() == "dead-point"]
        for line, mark in zip(marks, panel.marks, strict=True):
            assert np.asarray(line.get_xydata()).tolist() == [[mark.x, mark.y]]
            assert line.get_marker() == "o"
            assert line.get_markeredgecolor() == LIGHT_CHART.tones[mark.tone - 1]


def test_a_png_is_as_wide_as_a_page_and_grows_by_a_panel() -> None:
    circuits = circuits_of("rapier-drive")
    names = ["s16", "θ13", "θ14", "θ15", "E.x"]
    sizes = [
        size_in_inches(render(circuit_chart(circuits, names[:count]), "png", dpi=100), 100)
        for count in (1, 2, 3, 4, 5)
    ]
    assert {width for width, _ in sizes} == {6.95}
    one, two, three, four, five = (height for _, height in sizes)
    # a single panel is higher than one of several
    assert 4.5 < one < two < three
    assert one - (three - 2 * 2.12) > 1.0
    assert four - three == pytest.approx(five - four, abs=0.011)  # whole pixels
    assert five - four == pytest.approx(2.12, abs=0.011)


def test_an_svg_names_its_texts_curves_and_marks() -> None:
    svg = render(circuit_chart(circuits_of("rapier-drive"), ["s16"]), "svg")
    texts = svg_texts(svg)
    for text in (
        "Rapier drive of a loom", "3 circuits", "circuit 1", "circuit 2", "circuit 3",
        "dead point", "s₁₆ [mm]", "θ₁₂ [deg]", "0", "360",
    ):  # fmt: skip
        assert text in texts
    ids = svg.decode()
    assert ids.count('id="curve:circuit 3"') == 2
    assert ids.count('id="dead-point"') == 2
    assert ids.count('id="panel:') == 1


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_same_chart_gives_the_same_bytes(kind: str) -> None:
    chart = circuit_chart(circuits_of("four-bar"))
    assert render(chart, kind) == render(circuit_chart(circuits_of("four-bar")), kind)


@pytest.mark.parametrize("name", ["balanced-lamp", "pendulum"])
def test_charts_of_a_mechanism_without_unknowns_show_its_traced_points(name: str) -> None:
    mechanism = lw.example(name)
    motion, circuits = mechanism.sweep(), mechanism.circuits()
    coordinates = [f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy"]
    assert len(coordinates) == 2
    drawn = [curve.name for panel in motion_chart(motion).panels for curve in panel.curves]
    assert drawn == coordinates
    assert len(circuit_chart(circuits).panels) == 2
    assert len(branch_chart(circuits).panels) == 1
    assert "closest to a dead point" not in str(circuits)
