"""Columns of a motion over its input: what a chart shows."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from matplotlib.lines import Line2D

import linkwork as lw
from linkwork.core.drawing.scene import LIGHT
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.units import AngleUnit
from linkwork.writers.charts.axes import LIGHT_CHART, tick_step
from linkwork.writers.charts.chart import Chart
from linkwork.writers.charts.kinds import motion_chart
from linkwork.writers.charts.plane import motion_plot
from tests.core.drawing.pages import (
    assert_drawn,
    axes_of,
    curves_of,
    legend_of,
    marks_of,
    pieces,
    rules_of,
)

POINTS = {"O2": (0, 0), "A": (40, 0.01), "B": (120, 60), "O4": (100, 0)}
LINKS = {
    "ground": ("O2", "O4"),
    "crank": ("O2", "A"),
    "coupler": ("A", "B"),
    "rocker": ("O4", "B"),
}


@cache
def swept(name: str, **options: Any) -> lw.Motion:
    """The motion of a library mechanism, swept once."""
    return lw.example(name).sweep(certify=False, **options)


def drawn(chart: Chart) -> list[Line2D]:
    """The curves of all panels."""
    return [curve for ax in axes_of(chart) for curve in curves_of(ax)]


def labels(chart: Chart) -> list[str]:
    return [ax.get_ylabel() for ax in axes_of(chart)]


def name_of(curve: Line2D) -> str:
    return str(curve.get_gid()).removeprefix("curve:")


# ------------------------------------------------------------------ columns


def test_columns_of_one_unit_share_a_panel_with_units_in_its_label() -> None:
    page = motion_chart(swept("rapier-drive")).figure(LIGHT)
    length = page.axes[-1]
    assert [ax.get_ylabel() for ax in page.axes] == ["θ₁₃, θ₁₄, θ₁₅ [deg]", "s₁₆ [mm]"]
    assert length.get_xlabel() == "θ₁₂ [deg]"
    assert length.get_xlim() == pytest.approx((-3.6, 363.6))
    assert [t for t in length.get_xticks() if 0 <= t <= 360] == list(range(0, 361, 45))
    colours = [curve.get_color() for ax in page.axes for curve in curves_of(ax)]
    assert colours == list(LIGHT_CHART.tones[:4])
    # the name of a curve that is alone stands beside its panel
    assert legend_of(page) == ["θ₁₃", "θ₁₄", "θ₁₅"]


def test_curves_of_very_different_range_have_panels_of_their_own() -> None:
    """The beam rocks by 40° while the sun turns twice; the rod rocks by 23°."""
    chart = motion_chart(swept("sun-and-planet"), ["rod", "sun", "beam"])
    assert [[name_of(curve) for curve in curves_of(ax)] for ax in axes_of(chart)] == [
        ["rod", "beam"],
        ["sun"],
    ]


def test_a_level_line_shares_the_panel_of_its_unit() -> None:
    motion = swept("kempe-translator")
    assert np.ptp(motion["bridge"]) < 1e-9
    (ax,) = axes_of(motion_chart(motion, ["lower_link", "bridge"]))
    assert [name_of(curve) for curve in curves_of(ax)] == ["lower_link", "bridge"]


def test_curves_are_the_columns_of_the_table() -> None:
    motion = swept("four-bar")
    table = motion.table()
    names = [
        "coupler",
        "B.x",
        "B.x.d1",
        "mu.d2",
        "rocker.velocity",
        "B.y.acceleration",
        "condition",
    ]
    chart = motion_chart(motion, names)
    for name, curve in zip(names, drawn(chart), strict=True):
        assert_drawn(curve, np.array(table["crank"]), np.array(table[name]))
    assert labels(chart) == [
        "coupler [deg]",
        "B.x [mm]",
        "dB.x/d crank [mm/rad]",
        "d²μ/d crank² [rad/rad²]",
        "velocity of rocker [rad/s]",
        "acceleration of B.y [mm/s²]",
        "condition",
    ]


def test_any_spelling_is_found_and_drawn_once() -> None:
    chart = motion_chart(swept("rapier-drive"), ["theta13", "θ13", "θ₁₃", "theta13.d1"])
    assert labels(chart) == ["θ₁₃ [deg]", "dθ₁₃/dθ₁₂ [rad/rad]"]


def test_the_velocity_of_a_point_is_the_length_of_the_vector() -> None:
    motion = swept("four-bar")
    [curve] = drawn(motion_chart(motion, ["A.velocity"]))
    assert motion.speed is not None
    y = np.asarray(curve.get_ydata())
    np.testing.assert_allclose(y, 40 * motion.speed, rtol=1e-12)  # crank 40 mm
    assert name_of(curve) == "|velocity of A|"


def test_many_angles_are_spread_over_panels_with_a_colour_for_each() -> None:
    page = motion_chart(swept("dixon-one"), [*swept("dixon-one").unknowns, "a1b2"]).figure(LIGHT)
    curves = [curve for ax in page.axes for curve in curves_of(ax)]
    sizes = [len(curves_of(ax)) for ax in page.axes]
    assert max(sizes) <= 6
    assert max(sizes) - min(sizes) <= 1
    looks = {(curve.get_color(), curve.get_linestyle()) for curve in curves}
    assert len(looks) == sum(sizes) == len(legend_of(page))
    jansen = motion_chart(swept("jansen-leg"))
    # more names than its label has room for
    assert labels(jansen) == ["angle [deg]"]


def test_evidence_has_its_own_scale() -> None:
    motion = swept("rapier-drive")
    chart = motion_chart(motion, ["residual", "iterations", "condition"])
    panels = axes_of(chart)
    assert [ax.get_yscale() for ax in panels] == ["symlog", "linear", "log"]
    assert all(tick == round(tick) for tick in panels[1].get_yticks())
    curves = drawn(chart)
    assert [c.get_linestyle() for c in curves] == ["None", "None", "-"]
    np.testing.assert_array_equal(curves[1].get_ydata(), motion.iterations)


# ------------------------------------------------------------------ gaps and limits


def test_nothing_is_drawn_where_there_is_no_position() -> None:
    motion = swept("rapier-drive-limited")
    chart = motion_chart(motion, ["s16", "theta13", "s16.d1"])
    for name, curve in zip(("s16", "theta13", "s16.d1"), drawn(chart), strict=True):
        left, right = pieces(curve)
        assert left[-1, 0] < 149.618 < 201.320 < right[0, 0]
        assert_drawn(curve, motion["theta12"], motion[name])


def test_dead_points_are_marked_on_values_and_ruled_where_there_is_none() -> None:
    motion = swept("rapier-drive-limited")
    values, rates, condition = axes_of(motion_chart(motion, ["s16", "s16.d1", "condition"]))
    at = sorted(limit.input for limit in motion.limits)
    assert len(at) == 2
    rows = np.flatnonzero([kind == "dead point" for kind in motion.limit])
    marks = marks_of(values, "dead point")
    assert [x for x, _ in marks] == pytest.approx(at)
    assert [y for _, y in marks] == pytest.approx(motion["s16"][rows].tolist())
    assert not marks_of(values, "change point")
    for ax in (rates, condition):
        assert not marks_of(ax, "dead point")
        assert rules_of(ax, "dead point") == pytest.approx(at)
    assert not rules_of(values, "dead point")


def test_a_rate_that_grows_beyond_bounds_leaves_its_panel() -> None:
    motion = swept("rapier-drive-limited", through=True)
    [ax] = axes_of(motion_chart(motion, ["s16.d2"]))
    low, high = ax.get_ylim()
    y = motion["s16.d2"]
    assert np.nanmax(y) - np.nanmin(y) > 4 * (high - low)
    inside = np.isfinite(y) & (y > low) & (y < high)
    assert inside.sum() > 0.8 * np.isfinite(y).sum()


def test_no_line_joins_two_branches() -> None:
    motion = swept("rapier-drive-limited", through=True)
    [curve] = drawn(motion_chart(motion, ["s16"]))
    parts = pieces(curve)
    assert len(parts) == 4  # two branches on both sides of the gap
    assert all(np.abs(np.diff(part[:, 0])).max() <= 1.0 + 1e-9 for part in parts)


def test_branches_that_meet_at_a_dead_point_are_not_joined_beyond_the_table() -> None:
    motion = lw.example("slider-input").sweep(to=158.5, step=0.5, through=True, certify=False)
    [change] = np.flatnonzero([a != b for a, b in pairwise(motion.branch)])
    assert motion["d"][change + 1] - motion["d"][change] < 0.5  # nearer than rows of the table
    [curve] = drawn(motion_chart(motion, ["θ2"]))
    first, second, beyond = pieces(curve)
    assert first[-1].tolist() == [motion["d"][change], motion["θ2"][change]]
    assert second[0].tolist() == [motion["d"][change + 1], motion["θ2"][change + 1]]
    assert len(beyond) == 1  # the other dead point lies outside the table


def test_a_condition_at_a_dead_point_is_no_number_along_a_circuit_either() -> None:
    motion = lw.example("rapier-drive-limited").circuits(certify=False)[0].motion
    at = motion.condition[[kind == "dead point" for kind in motion.limit]]
    assert at.min() > 1e12  # infinite, but for rounding
    [ax] = axes_of(motion_chart(motion, ["condition"]))
    [curve] = curves_of(ax)
    assert max(part[:, 1].max() for part in pieces(curve)) < 1e9
    assert not marks_of(ax, "dead point")
    assert rules_of(ax, "dead point")


def test_extremes_are_marked_on_their_own_curve_only() -> None:
    motion = swept("rapier-drive-limited", through=True, limits_of=("s16",))
    chart = motion_chart(motion, ["s16", "theta13"])
    travel, angle = axes_of(chart)
    for kind in ("dead point", "maximum", "minimum"):
        assert marks_of(travel, kind)
        assert bool(marks_of(angle, kind)) == (kind == "dead point")


# ------------------------------------------------------------------ angles


def turning_output() -> lw.Motion:
    return lw.linkage(
        points=POINTS,
        links=LINKS,
        lengths={"O2 A": 40, "A B": 120, "O4 B": 80},
        outputs={"direction": "atan2(A.y, A.x)"},
        inputs=lw.Input(link="crank", from_=0, to=360, step=1),
    ).sweep(certify=False)


def test_an_output_that_jumps_by_a_turn_is_broken_there() -> None:
    motion = turning_output()
    assert np.abs(np.diff(motion["direction"])).max() > 350
    [curve] = drawn(motion_chart(motion, ["direction"]))
    first, second = pieces(curve)
    assert first[-1].tolist() == pytest.approx([180, 180]) or second[0, 0] == 180
    for part in (first, second):
        assert np.abs(np.diff(part[:, 1])).max() < 2


def test_a_gear_that_turns_far_between_two_rows_does_not_jump() -> None:
    gear = lw.example("planetary-gear").sweep(step=216, certify=False)
    steps = np.abs(np.diff(gear["planet"]))
    assert steps.min() > 180
    [curve] = drawn(motion_chart(gear, ["planet"]))
    assert len(pieces(curve)) == 1


@pytest.mark.parametrize("name", ["planetary-gear", "andrews-squeezer", "galloway", "four-bar"])
def test_wrapped_angles_stay_within_one_turn_without_a_line_across(name: str) -> None:
    motion = swept(name)
    angles = [n for n, s in motion.unknowns.items() if s.quantity.kind.value == "angle"]
    turn = motion.units.angle.turn
    panels = axes_of(motion_chart(motion, angles, wrapped=True))
    for ax in panels:
        low, high = ax.get_ylim()
        assert high - low <= 1.1 * turn
        for curve in curves_of(ax):
            seen = np.zeros(len(motion), dtype=bool)
            for part in pieces(curve):
                assert len(part) < 2 or np.abs(np.diff(part[:, 1])).max() < turn / 4
                inside = (part[:, 1] >= low) & (part[:, 1] <= high)
                seen |= np.isin(next(iter(motion.inputs.values())), part[inside, 0])
            assert seen[motion.found].all()
    assert sum(len(curves_of(ax)) for ax in panels) == len(angles)


def test_a_wrapped_line_goes_on_at_the_other_side_as_often_as_it_passes_a_whole_turn() -> None:
    motion = swept("planetary-gear")  # planet: three turns backwards
    [ax] = axes_of(motion_chart(motion, ["planet"], wrapped=True))
    [planet] = curves_of(ax)
    assert len(pieces(planet)) == round(np.ptp(motion["planet"]) / 360)
    for before, after in pairwise(pieces(planet)):
        np.testing.assert_allclose(np.abs(before - after)[:, 1], 360)


@pytest.mark.parametrize(
    ("span", "most", "unit", "step"),
    [
        (360.0, 9, AngleUnit.DEGREE, 45.0),
        (720.0, 9, AngleUnit.DEGREE, 90.0),
        (180.0, 9, AngleUnit.DEGREE, 30.0),
        (90.0, 9, AngleUnit.DEGREE, 10.0),
        (3600.0, 9, AngleUnit.DEGREE, 720.0),
        (1440.0, 6, AngleUnit.DEGREE, 360.0),
        (0.4, 5, AngleUnit.DEGREE, 0.1),
        (math.tau, 9, AngleUnit.RADIAN, math.pi / 4),
        (math.pi, 9, AngleUnit.RADIAN, math.pi / 6),
        (0.4, 5, AngleUnit.RADIAN, 0.1),
        (400.0, 9, None, 50.0),
    ],
)
def test_ticks_of_angles_stand_at_parts_of_a_turn(
    span: float, most: int, unit: AngleUnit | None, step: float
) -> None:
    assert tick_step(span, most, unit) == pytest.approx(step)


def test_curves_keep_clear_of_the_sides_of_their_panel() -> None:
    panels = axes_of(motion_chart(swept("planetary-gear"), ["carrier", "planet", "carrier.d1"]))
    for ax in panels:
        low, high = ax.get_ylim()
        for curve in curves_of(ax):
            y = np.asarray(curve.get_ydata())
            assert low < np.nanmin(y) <= np.nanmax(y) < high


# ------------------------------------------------------------------ axes


def test_rounding_is_not_magnified() -> None:
    motion = swept("rapier-drive")
    spread = np.ptp(motion["E.y"])
    assert spread < 1e-9  # the rapier runs along a line, but for rounding
    shared, *_ = axes_of(motion_chart(motion, ["E.y", "E.y.d1", "E.x"]))
    assert len(curves_of(shared)) == 2  # E.x shares the panel: it is not constant
    alone, slope = axes_of(motion_chart(motion, ["E.y", "E.y.d1"]))
    assert alone.get_ylim() == pytest.approx((-572, -468))
    low, high = slope.get_ylim()
    assert low == -high
    assert high > 10


def test_time_runs_while_the_input_turns() -> None:
    motion = swept("four-bar")  # 25 rad/s
    [ax] = axes_of(motion_chart(motion, ["B.x"], against="time"))
    [curve] = curves_of(ax)
    assert ax.get_xlabel() == "time [s]"
    x, y = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
    assert (x[0], x[-1]) == pytest.approx((0.0, math.tau / 25))
    low, high = ax.get_xlim()
    assert -0.01 < low < 0.0 < x[-1] < high < x[-1] + 0.01
    slope = np.gradient(y, x)
    np.testing.assert_allclose(
        np.interp(x[::20], x, slope)[1:-1],
        np.interp(x[::20], np.linspace(0.0, x[-1], len(motion)), motion["B.x.velocity"])[1:-1],
        atol=12.0,
    )


def test_columns_can_stand_over_each_other() -> None:
    motion = swept("trotbot-leg")
    [ax] = axes_of(motion_chart(motion, ["J7.y"], against="J7.x"))
    [curve] = curves_of(ax)
    assert_drawn(curve, motion["J7.x"], motion["J7.y"])
    assert ax.get_xlabel() == "J₇.x [unit]"
    low, high = ax.get_xlim()
    assert low < motion["J7.x"].min() < motion["J7.x"].max() < high


@pytest.mark.parametrize("against", ["residual", "iterations"])
def test_nothing_joins_rows_over_what_is_scattered(against: str) -> None:
    [curve] = drawn(motion_chart(swept("four-bar"), ["B.x"], against=against))
    assert (curve.get_linestyle(), curve.get_marker()) == ("None", "o")


def test_the_leading_input_is_the_one_that_moves() -> None:
    motion = swept("three-rpr")
    moving = [name for name, values in motion.inputs.items() if np.ptp(values)]
    chart = motion_chart(motion)
    assert axes_of(chart)[-1].get_xlabel().startswith(moving[0][:3])


# ------------------------------------------------------------------ refusals


@pytest.mark.parametrize(
    ("mechanism", "names", "options", "error", "message"),
    [
        (
            "rapier-drive", ["s17"], {}, UnknownNameError,
            'there is no "s17" (nearest: s16, radius, θ15; all: linkwork quantities FILE)',
        ),
        (
            "four-bar", ["status"], {}, InputError,
            '"status" is text and cannot be plotted',
        ),
        (
            "four-bar", ["B"], {}, InputError,
            '"B" is a point: plot a coordinate, "B.x" or "B.y", or its path, kind="path" '
            "(--kind path)",
        ),
        (
            "rapier-drive", ["s16.velocity"], {}, UnknownNameError,
            '"s16.velocity" needs the speed of the input: set speed in [input], or use '
            '"s16.d1", the derivative with respect to the input',
        ),
        (
            "rapier-drive", ["E.velocity"], {}, UnknownNameError,
            '"E.velocity" needs the speed of the input: set speed in [input], or use '
            '"E.d1", the derivative with respect to the input',
        ),
        (
            "rapier-drive", ["s16"], {"against": "time"}, InputError,
            "a plot over time needs the speed of θ12: set it in [input], or plot against θ12",
        ),
        (
            "four-bar", [], {"kind": "pie"}, UnknownNameError,
            'there is no plot of a motion of kind "pie" (kinds: curves, polar, path, hodograph, '
            "transmission)",
        ),
        (
            "four-bar", [], {"kind": "branches"}, InputError,
            'there is no plot of a motion of kind "branches": use circuits().plot',
        ),
        (
            "four-bar", [], {"kind": "polar", "wrapped": True}, InputError,
            'a plot of kind "polar" has no option wrapped: leave it out',
        ),
        (
            "four-bar", ["B"], {"kind": "path", "against": "time"}, InputError,
            'a plot of kind "path" has no option against: leave it out',
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_plotted_is_refused_with_what_to_do(
    mechanism: str, names: list[str], options: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as raised:
        motion_plot(swept(mechanism), names, **options)
    assert str(raised.value) == message


def test_there_is_no_time_along_several_branches() -> None:
    fast = lw.example("rapier-drive-limited")
    [driven] = fast.description.inputs
    fast = fast.changed(inputs=(lw.Input(**{**vars(driven), "speed": "60 rpm"}),))
    motion = fast.sweep(through=True, certify=False)
    with pytest.raises(InputError) as raised:
        motion_chart(motion, ["s16"], against="time")
    assert str(raised.value) == (
        "several branches have no common time: θ12 reverses between them, so its speed is not "
        "constant; plot against θ12, or sweep one branch"
    )


def test_a_motion_without_positions_is_no_chart() -> None:
    motion = lw.linkage(
        name="Too short",
        points={"O2": (0, 0), "A": (10, 0), "B": (50, 0), "O4": (100, 0)},
        links=LINKS,
        lengths={"O2 A": 10, "A B": 30, "O4 B": 40},
        inputs=lw.Input(link="crank"),
    ).sweep()
    for kind in ("curves", "polar", "path", "hodograph", "transmission"):
        with pytest.raises(InputError) as raised:
            motion_plot(motion, kind=kind)
        assert str(raised.value) == f'"Too short" has no position to plot: {motion.message}'
