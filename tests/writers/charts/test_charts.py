"""Charts of circuits: what they show, and how it stands on the page."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D

import linkwork as lw
from linkwork.core.drawing import LIGHT, render
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.writers.charts import lines as circuit_chart_module
from linkwork.writers.charts.axes import LIGHT_CHART, ChartAxes
from linkwork.writers.charts.chart import Chart, Panel
from linkwork.writers.charts.kinds import motion_chart
from linkwork.writers.charts.lines import branch_chart, circuit_chart
from tests.core.drawing.pages import (
    assert_page_is_clear,
    axes_of,
    curves_of,
    legend_of,
    marks_of,
    pieces,
    printed_texts,
    size_in_inches,
    svg_texts,
)
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
        inputs=lw.Input(variable="θ", from_=0, to=6, step=0.1),
    ).circuits()


def ends(ax: Axes) -> tuple[float, float]:
    """The range of the curves of a panel that is inside its axes."""
    low, high = ax.get_ylim()
    y = np.concatenate([part[:, 1] for curve in curves_of(ax) for part in pieces(curve)])
    inside = y[(y >= low) & (y <= high)]
    return float(inside.min()), float(inside.max())


def ticks(ax: Axes, side: str = "y") -> list[float]:
    """The ticks that are seen."""
    low, high = getattr(ax, f"get_{side}lim")()
    return [float(t) for t in getattr(ax, f"get_{side}ticks")() if low <= t <= high]


def distances(points: Array, line: Array) -> Array:
    """The distances of points (K, 2) from a drawn line (M, 2)."""
    start, side = line[:-1], np.diff(line, axis=0)
    share = ((points[:, None] - start) * side).sum(axis=2) / np.maximum(
        (side**2).sum(axis=1), 1e-30
    )
    near = start + np.clip(share, 0.0, 1.0)[..., None] * side
    found: Array = np.linalg.norm(points[:, None] - near, axis=2).min(axis=1)
    return found


# ------------------------------------------------------------------ curves


def test_every_branch_of_every_circuit_is_a_curve_in_every_panel() -> None:
    panels = axes_of(circuit_chart(circuits_of("rapier-drive")))
    labels = [ax.get_ylabel() for ax in panels]
    assert labels == ["θ₁₃ [deg]", "θ₁₄ [deg]", "θ₁₅ [deg]", "s₁₆ [mm]"]
    tones = LIGHT_CHART.tones
    for ax in panels:
        told = [(curve.get_label(), curve.get_color()) for curve in curves_of(ax)]
        assert told == [
            ("circuit 1", tones[0]),
            ("circuit 2", tones[1]),
            ("circuit 3", tones[2]),
            ("circuit 3", tones[2]),
        ]


@every_fourth
def test_curves_pass_through_every_position_of_their_circuit(name: str) -> None:
    circuits = circuits_of(name)
    panels = axes_of(circuit_chart(circuits))
    units = circuits[0].motion.units
    kinds = circuits[0].motion.unknowns
    turning = circuits.input_unit == units.angle.value
    for ax, (unknown, series) in zip(panels, kinds.items(), strict=False):
        turn = units.angle.turn if series.quantity.kind.value == "angle" else 0.0
        y_low, y_high = ax.get_ylim()
        for circuit in circuits:
            drawn = [
                part for c in curves_of(ax) if c.get_label() == circuit.name for part in pieces(c)
            ]
            every = max(7, len(circuit[unknown]) // 40)
            x, y = circuit[circuits.input][::every], circuit[unknown][::every]
            if turn:
                y = y_low + np.mod(y - y_low, turn)
                assert y_high - y_low > 0.99 * turn or (y <= y_high).all()
            # at a whole turn, on one side or the other
            shifts = np.floor(x / units.angle.turn) * units.angle.turn if turning else 0.0 * x
            places = [
                np.stack([x - shifts + dx, y + dy], axis=1)
                for dx in ((0.0, units.angle.turn) if turning else (0.0,))
                for dy in ((0.0, turn) if turn else (0.0,))
            ]
            away = np.full(len(x), np.inf)
            for points in places:
                for part in drawn:
                    away = np.minimum(away, distances(points, np.vstack([part, part[-1:]])))
            assert away.max() < 1e-8 * units.angle.turn, (unknown, circuit.name)


def test_a_line_stops_at_a_whole_turn_of_the_input_and_goes_on_at_the_other_side() -> None:
    [ax] = axes_of(circuit_chart(circuits_of("rapier-drive"), ["s16"]))
    assert ax.get_xlim() == pytest.approx((-3.6, 363.6))
    for curve in curves_of(ax)[:2]:  # the crank goes from 60 to 420
        before, after = pieces(curve)
        np.testing.assert_allclose(before - after, np.broadcast_to([360.0, 0.0], before.shape))
    for curve in curves_of(ax)[2:]:
        assert len(pieces(curve)) == 1


def test_an_angle_that_turns_fully_is_shown_over_one_turn() -> None:
    [ax] = axes_of(circuit_chart(circuits_of("slider-input"), ["θ2"]))
    low, high = ax.get_ylim()
    assert (low, high) == pytest.approx((-7.2, 367.2))
    assert ticks(ax) == [0, 90, 180, 270, 360]


def test_angles_are_shown_over_the_turn_that_cuts_them_least() -> None:
    [rod] = axes_of(circuit_chart(circuits_of("crank-slider"), ["θ3"]))
    # one circuit around 170 degrees, one around 10: a turn from 0 would cut the second
    swing = math.degrees(math.asin((40 - 20) / 120))
    assert ends(rod)[0] == pytest.approx(-swing, abs=0.1)
    assert ends(rod)[1] == pytest.approx(180 + swing, abs=0.1)
    assert [len(pieces(curve)) for curve in curves_of(rod)] == [2, 2]  # at the input's turn only


def test_angles_that_meet_at_zero_are_not_torn_apart() -> None:
    coupler, rocker = axes_of(circuit_chart(four_bar(100, 40, 100, 40).circuits()))
    low, high = ends(coupler)  # 0 in one circuit, between -90 and 90 in the other
    assert -90 < low < -20 < 20 < high < 90
    assert rocker.get_ylim() == pytest.approx((-18, 378))  # it turns fully: 0 to 360


def test_an_angle_that_stays_as_it_is_lies_inside_its_panel() -> None:
    [block] = axes_of(circuit_chart(circuits_of("slider-crank"), ["block"]))
    assert all(np.abs(part[:, 1]).max() == 0.0 for c in curves_of(block) for part in pieces(c))
    low, high = block.get_ylim()
    assert low == -high < -1


def test_radians_have_ticks_at_parts_of_pi() -> None:
    page = circuit_chart(circuits_of("andrews-squeezer")).figure(LIGHT)
    assert page.axes[-1].get_xlabel() == "β [rad]"
    assert ticks(page.axes[-1], "x") == pytest.approx([k * QUARTER / 2 for k in range(9)])
    assert ticks(page.axes[1]) == pytest.approx([0.1, 0.2, 0.3, 0.4])  # too small a range
    chart = circuit_chart(circuits_of("andrews-squeezer"))
    labels = [t for t, _ in printed_texts(replace(chart, panels=chart.panels[:1]).figure(LIGHT))]
    for text in ("0", "π/4", "π/2", "3π/4", "π", "5π/4", "3π/2", "7π/4", "2π"):
        assert text in labels


def test_an_input_that_is_a_length_is_shown_as_far_as_it_goes() -> None:
    panels = axes_of(circuit_chart(circuits_of("slider-input")))
    assert panels[-1].get_xlabel() == "d [mm]"
    x = np.concatenate([part[:, 0] for c in curves_of(panels[0]) for part in pieces(c)])
    reach = math.sqrt(160**2 - 20**2)  # crank and rod in line, offset 20
    assert (x.min(), x.max()) == pytest.approx((-reach, reach), abs=1e-9)
    low, high = panels[0].get_xlim()
    assert low < -reach < reach < high


def test_numbers_without_a_unit_are_labelled_with_their_name_alone() -> None:
    circuits = four_bar(
        100, 40, 120, 80, outputs={"ratio": "rocker/coupler", "mu": "rocker"}
    ).circuits()
    panels = axes_of(circuit_chart(circuits, ["ratio", "mu", "O4.x"]))
    assert panels[0].get_ylabel() == "ratio"
    assert panels[2].get_ylabel() == "O₄.x [mm]"


def test_an_input_at_rest_is_an_upright_line() -> None:
    kite = four_bar(1, 1, 2, 2)
    circuits = kite.circuits()
    ends = [branch.end for branch in circuits[0].branches]
    assert ends.count(lw.CircuitEnd.INPUT_CONSTANT) == 2
    first = axes_of(circuit_chart(circuits))[0]
    for curve, end in zip(curves_of(first), ends, strict=True):
        resting = end is lw.CircuitEnd.INPUT_CONSTANT
        for part in pieces(curve):
            assert (np.ptp(part[:, 0]) < 1e-6) == resting
            assert np.ptp(part[:, 1]) > 90
            if resting:
                assert np.abs(part[:, 0] - 360 * np.round(part[:, 0] / 360)).max() < 1e-6


def test_lengths_that_run_to_infinity_leave_their_panel() -> None:
    page = circuit_chart(ray_and_line()).figure(LIGHT)
    for ax in page.axes:
        y = np.concatenate([part[:, 1] for curve in curves_of(ax) for part in pieces(curve)])
        low, high = ax.get_ylim()
        assert np.abs(y).max() > 1000
        assert -20 < low < -2
        assert 2 < high < 20
        assert all(line.get_clip_on() for line in ax.lines)
    assert_page_is_clear(page)


def test_a_curve_under_others_is_drawn_wider() -> None:
    panels = axes_of(circuit_chart(circuits_of("double-four-bar")))
    widths = {ax.get_ylabel(): [curve.get_linewidth() for curve in curves_of(ax)] for ax in panels}
    # θ2 and θ3 follow from the first loop alone: the second one's two ways lie over each other
    for label in ("θ₂ [deg]", "θ₃ [deg]"):
        wide, thin, other, narrow = widths[label]
        assert wide == other > 2 * thin
        assert thin == narrow
    for label in ("θ₄ [deg]", "θ₅ [deg]"):
        assert set(widths[label]) == {widths["θ₂ [deg]"][1]}


# ------------------------------------------------------------------ marks


@every_fourth
def test_dead_points_are_marked_at_their_input_and_at_the_value_there(name: str) -> None:
    circuits = circuits_of(name)
    units = circuits[0].motion.units.angle
    turn = units.turn if circuits.input_unit == units.value else 0.0
    limits = [limit.input for circuit in circuits for limit in circuit.dead_points]

    def away(one: float, other: float) -> float:
        """The distance of two inputs, less whole turns."""
        distance = abs(one - other)
        return abs(distance - turn * round(distance / turn)) if turn else distance

    for ax in axes_of(circuit_chart(circuits)):
        marks = marks_of(ax, "dead point")
        assert all(min(away(x, limit) for x, _ in marks) < 1e-8 for limit in limits)
        assert all(min(away(x, limit) for limit in limits) < 1e-8 for x, _ in marks)
        drawn = [part for curve in curves_of(ax) for part in pieces(curve)]
        for mark in marks:
            assert min(np.abs(part - mark).max(axis=1).min() for part in drawn) < 1e-8


def test_change_points_are_marked_on_both_sides_of_a_whole_turn() -> None:
    for ax in axes_of(circuit_chart(four_bar(4, 1, 3, 2).circuits())):
        assert {x for x, _ in marks_of(ax, "change point")} == {180.0}
        assert not marks_of(ax, "dead point")
    coupler, rocker = axes_of(circuit_chart(four_bar(100, 40, 100, 40).circuits()))
    assert set(marks_of(coupler, "change point")) == {(0, 0), (180, 0), (360, 0)}
    every = {(0, 0), (0, 360), (180, 180), (360, 0), (360, 360)}
    assert set(marks_of(rocker, "change point")) == every


# ------------------------------------------------------------------ what is asked


def test_quantities_are_drawn_as_asked_in_any_spelling_and_once() -> None:
    chart = circuit_chart(circuits_of("rapier-drive"), ["E.x", "theta13", "s16", "θ13"])
    assert [ax.get_ylabel() for ax in axes_of(chart)] == ["E.x [mm]", "θ₁₃ [deg]", "s₁₆ [mm]"]


def test_the_first_unknowns_are_drawn_if_nobody_says_which(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(circuit_chart_module, "MOST_PANELS", 3)
    chart = circuit_chart(circuits_of("rapier-drive"))
    labels = [ax.get_ylabel() for ax in axes_of(chart)]
    assert labels == ["θ₁₃ [deg]", "θ₁₄ [deg]", "θ₁₅ [deg]"]


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
    page = chart.figure(LIGHT)
    assert_page_is_clear(page)
    count = len(circuits)
    limits = ["dead point"] if any(circuit.dead_points for circuit in circuits) else []
    assert [text.get_text() for text in page.texts] == [
        circuits.mechanism,
        f"{count} circuit{'' if count == 1 else 's'}",
    ]
    assert legend_of(page) == [*(circuit.name for circuit in circuits), *limits]
    assert [ax.get_ylabel() for ax in page.axes] == [panel.label for panel in chart.panels]
    above = [ax.get_xlabel() for ax in page.axes[:-1]]
    assert above == [""] * len(above)
    assert page.axes[-1].get_xlabel().startswith(circuits.input[0])


def crowded(chart: Chart) -> Chart:
    """The same with thirteen circuits, change points, long and wide names."""

    def draw(axes: ChartAxes) -> None:
        x = np.linspace(0.0, 360.0, 50)
        for k in range(1, 14):
            axes.curve(x, 10.0 * k + 0.1 * x, f"circuit {k}", k)
        for tone, kind in ((1, "change point"), (2, "dead point")):
            axes.marks(np.array([90.0]), np.array([150.0]), kind, tone)
        axes.labels("θ", "the_angle_between_boom_and_stick [deg]")

    title = "A mechanism WHOSE NAME is long, " * 4 + "W" * 90
    panels = (Panel(label="", draw=draw), *chart.panels[1:])
    return replace(chart, title=title, caption="13 circuits", panels=panels)


def test_long_names_and_many_circuits_have_room() -> None:
    page = crowded(circuit_chart(circuits_of("rapier-drive"))).figure(LIGHT)
    assert_page_is_clear(page)
    title, caption = (text.get_text() for text in page.texts)
    assert title.count("\n") > 2
    assert caption == "13 circuits"
    for ax in page.axes:
        label, inside = ax.yaxis.label.get_window_extent(), ax.get_window_extent()
        assert inside.y0 <= label.y0 < label.y1 <= inside.y1
    # the last panels have circuits 1 to 3 only, which are in the legend already
    names = [f"circuit {k}" for k in range(1, 14)]
    assert legend_of(page) == [*names, "change point", "dead point"]


def dashes_of(line: Line2D) -> object:
    """As drawn; Matplotlib tells no one else."""
    return getattr(line, "_dash_pattern")  # noqa: B009 - unknown to its types


def test_circuits_of_one_colour_differ_in_their_dashes() -> None:
    page = crowded(circuit_chart(circuits_of("rapier-drive"))).figure(LIGHT)
    [legend] = page.legends
    keys = legend.get_lines()[:13]
    looks = {(to_rgba(key.get_color()), str(dashes_of(key))) for key in keys}
    assert len(looks) == 13
    for key, line in zip(keys, curves_of(page.axes[0]), strict=True):
        assert key.get_color() == line.get_color()
        assert key.get_linestyle() == line.get_linestyle()


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
    assert 4.0 < one < two < three
    assert one > 1.5 * (four - three)
    assert four - three == pytest.approx(five - four, abs=0.011)  # whole pixels
    assert 1.8 < five - four < 2.5


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
    assert ids.count('id="dead-point"') >= 2
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
    drawn = [c.get_gid() for ax in axes_of(motion_chart(motion)) for c in curves_of(ax)]
    assert drawn == [f"curve:{name}" for name in coordinates]
    assert len(circuit_chart(circuits).panels) == 2
    assert len(branch_chart(circuits).panels) == 1
    assert "closest to a dead point" not in str(circuits)
