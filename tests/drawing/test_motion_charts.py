"""Columns of a motion over its input: what the chart says, before anybody draws it."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.units import AngleUnit
from linkwork.writers.charts.chart import Chart, Curve, Pen, Scale, across_step, angle_ends
from linkwork.writers.charts.kinds import motion_chart
from linkwork.writers.charts.plotting import motion_plot

ABOUT: Any = pytest.approx  # where it is a part of a tuple
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


def curves_of(chart: Chart) -> list[Curve]:
    return [curve for panel in chart.panels for curve in panel.curves]


def pieces(curve: Curve) -> list[Array]:
    """The drawn pieces of a curve, each (K, 2)."""
    points = np.stack([curve.x, curve.y], axis=1)
    found = np.isfinite(points).all(axis=1)
    cuts = np.flatnonzero(np.diff(found.astype(int))) + 1
    return [part for part in np.split(points, cuts) if np.isfinite(part).all()]


# ------------------------------------------------------------------ columns


def test_columns_of_one_unit_share_a_panel_with_units_in_its_label() -> None:
    chart = motion_chart(swept("rapier-drive"))
    assert [panel.axis.label for panel in chart.panels] == ["θ₁₃, θ₁₄, θ₁₅ [deg]", "s₁₆ [mm]"]
    assert chart.axis.label == "θ₁₂ [deg]"
    assert (chart.axis.ends, chart.axis.step) == ((0.0, 360.0), 45.0)
    assert [curve.tone for curve in curves_of(chart)] == [1, 2, 3, 4]
    # the name of a curve that is alone stands beside its panel
    assert chart.legend == ("θ₁₃", "θ₁₄", "θ₁₅")


def test_curves_of_very_different_range_have_panels_of_their_own() -> None:
    """The beam rocks by 40° while the sun turns twice; the rod rocks by 23°."""
    chart = motion_chart(swept("sun-and-planet"), ["rod", "sun", "beam"])
    assert [[curve.name for curve in panel.curves] for panel in chart.panels] == [
        ["rod", "beam"],
        ["sun"],
    ]


def test_a_level_line_shares_the_panel_of_its_unit() -> None:
    motion = swept("kempe-translator")
    assert np.ptp(motion["bridge"]) < 1e-9
    (panel,) = motion_chart(motion, ["lower_link", "bridge"]).panels
    assert [curve.name for curve in panel.curves] == ["lower_link", "bridge"]


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
    for name, curve in zip(names, curves_of(chart), strict=True):
        np.testing.assert_array_equal(curve.y, table[name])
        np.testing.assert_array_equal(curve.x, table["crank"])
    assert [panel.axis.label for panel in chart.panels] == [
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
    assert [panel.axis.label for panel in chart.panels] == ["θ₁₃ [deg]", "dθ₁₃/dθ₁₂ [rad/rad]"]


def test_the_velocity_of_a_point_is_the_length_of_the_vector() -> None:
    motion = swept("four-bar")
    [curve] = curves_of(motion_chart(motion, ["A.velocity"]))
    assert motion.speed is not None
    np.testing.assert_allclose(curve.y, 40 * motion.speed, rtol=1e-12)  # crank 40 mm
    assert curve.name == "|velocity of A|"


def test_many_angles_are_spread_over_panels_with_a_colour_for_each() -> None:
    chart = motion_chart(swept("dixon-one"), [*swept("dixon-one").unknowns, "a1b2"])
    sizes = [len(panel.curves) for panel in chart.panels]
    assert max(sizes) <= 6
    assert max(sizes) - min(sizes) <= 1
    assert chart.legend is not None
    assert len({curve.tone for curve in curves_of(chart)}) == sum(sizes) == len(chart.legend)
    jansen = motion_chart(swept("jansen-leg"))
    # more names than its label has room for
    assert [panel.axis.label for panel in jansen.panels] == ["angle [deg]"]


def test_evidence_has_its_own_scale() -> None:
    motion = swept("rapier-drive")
    chart = motion_chart(motion, ["residual", "iterations", "condition"])
    assert [p.axis.scale for p in chart.panels] == [Scale.ROUNDING, Scale.COUNT, Scale.LOG]
    assert [c.pen for c in curves_of(chart)] == [Pen.DOTS, Pen.DOTS, Pen.LINE]
    np.testing.assert_array_equal(curves_of(chart)[1].y, motion.iterations)


# ------------------------------------------------------------------ gaps and limits


def test_nothing_is_drawn_where_there_is_no_position() -> None:
    motion = swept("rapier-drive-limited")
    chart = motion_chart(motion, ["s16", "theta13", "s16.d1"])
    for curve in curves_of(chart):
        left, right = pieces(curve)
        assert left[-1, 0] < 149.618 < 201.320 < right[0, 0]
        assert len(left) + len(right) in (motion.found.sum(), motion.found.sum() - 2)


def test_dead_points_are_marked_on_values_and_ruled_where_there_is_none() -> None:
    motion = swept("rapier-drive-limited")
    values, rates, condition = motion_chart(motion, ["s16", "s16.d1", "condition"]).panels
    at = sorted(limit.input for limit in motion.limits)
    assert len(at) == 2
    assert [mark.x for mark in values.marks] == pytest.approx(at)
    assert {mark.kind for mark in values.marks} == {"dead point"}
    rows = np.flatnonzero([kind == "dead point" for kind in motion.limit])
    assert [mark.y for mark in values.marks] == list(motion["s16"][rows])
    for panel in (rates, condition):
        assert not panel.marks
        assert [rule.at for rule in panel.rules] == pytest.approx(at)
    assert not values.rules


def test_a_rate_that_grows_beyond_bounds_leaves_its_panel() -> None:
    [rate] = motion_chart(swept("rapier-drive-limited", through=True), ["s16.d2"]).panels
    assert rate.axis.ends
    low, high = rate.axis.ends
    [curve] = rate.curves
    assert np.nanmax(curve.y) - np.nanmin(curve.y) > 4 * (high - low)
    inside = np.isfinite(curve.y) & (curve.y > low) & (curve.y < high)
    assert inside.sum() > 0.8 * np.isfinite(curve.y).sum()


def test_no_line_joins_two_branches() -> None:
    motion = swept("rapier-drive-limited", through=True)
    [curve] = curves_of(motion_chart(motion, ["s16"]))
    parts = pieces(curve)
    assert len(parts) == 4  # two branches on both sides of the gap
    assert all(np.abs(np.diff(part[:, 0])).max() <= 1.0 + 1e-9 for part in parts)
    assert sum(map(len, parts)) == motion.found.sum()


def test_branches_that_meet_at_a_dead_point_are_not_joined_beyond_the_table() -> None:
    motion = lw.example("slider-input").sweep(stop=158.5, step=0.5, through=True, certify=False)
    [change] = np.flatnonzero([a != b for a, b in pairwise(motion.branch)])
    assert motion["d"][change + 1] - motion["d"][change] < 0.5  # nearer than rows of the table
    [curve] = curves_of(motion_chart(motion, ["θ2"]))
    first, second, beyond = pieces(curve)
    assert len(first) == change + 1
    assert second[0].tolist() == [motion["d"][change + 1], motion["θ2"][change + 1]]
    assert len(beyond) == 1  # the other dead point lies outside the table


def test_a_condition_at_a_dead_point_is_no_number_along_a_circuit_either() -> None:
    motion = lw.example("rapier-drive-limited").circuits(certify=False)[0].motion
    at = motion.condition[[kind == "dead point" for kind in motion.limit]]
    assert at.min() > 1e12  # infinite, but for rounding
    [panel] = motion_chart(motion, ["condition"]).panels
    assert np.nanmax(panel.curves[0].y) < 1e9
    assert not panel.marks
    assert {rule.kind for rule in panel.rules} == {"dead point"}


def test_extremes_are_marked_on_their_own_curve_only() -> None:
    motion = swept("rapier-drive-limited", through=True, limits_of=("s16",))
    chart = motion_chart(motion, ["s16", "theta13"])
    kinds = [{mark.kind for mark in panel.marks} for panel in chart.panels]
    assert kinds == [{"dead point", "maximum", "minimum"}, {"dead point"}]


# ------------------------------------------------------------------ angles


def turning_output() -> lw.Motion:
    return lw.linkage(
        points=POINTS,
        links=LINKS,
        lengths={"O2 A": 40, "A B": 120, "O4 B": 80},
        outputs={"direction": "atan2(A.y, A.x)"},
        inputs=lw.Input(link="crank", start=0, stop=360, step=1),
    ).sweep(certify=False)


def test_an_output_that_jumps_by_a_turn_is_broken_there() -> None:
    motion = turning_output()
    assert np.abs(np.diff(motion["direction"])).max() > 350
    [curve] = curves_of(motion_chart(motion, ["direction"]))
    first, second = pieces(curve)
    assert first[-1].tolist() == pytest.approx([180, 180]) or second[0, 0] == 180
    for part in (first, second):
        assert np.abs(np.diff(part[:, 1])).max() < 2


def test_a_gear_that_turns_far_between_two_rows_does_not_jump() -> None:
    gear = lw.example("planetary-gear").sweep(step=216, certify=False)
    steps = np.abs(np.diff(gear["planet"]))
    assert steps.min() > 180
    [curve] = curves_of(motion_chart(gear, ["planet"]))
    assert len(pieces(curve)) == 1


@pytest.mark.parametrize("name", ["planetary-gear", "andrews-squeezer", "galloway", "four-bar"])
def test_wrapped_angles_stay_within_one_turn_without_a_line_across(name: str) -> None:
    motion = swept(name)
    angles = [n for n, s in motion.unknowns.items() if s.quantity.kind.value == "angle"]
    turn = motion.units.angle.turn
    chart = motion_chart(motion, angles, wrapped=True)
    for panel in chart.panels:
        assert panel.axis.ends
        low, high = panel.axis.ends
        assert high - low <= turn * (1 + 1e-12)
        for curve in panel.curves:
            for part in pieces(curve):
                assert part[:, 1].min() >= low - 1e-9 * turn
                assert part[:, 1].max() <= high + 1e-9 * turn
                assert len(part) < 2 or np.abs(np.diff(part[:, 1])).max() < turn / 4
    name_of = {curve.name: curve for curve in curves_of(chart)}
    assert len(name_of) == len(angles)


def test_a_wrapped_line_is_cut_as_often_as_it_passes_a_whole_turn() -> None:
    motion = swept("planetary-gear")  # planet: three turns backwards
    planet = curves_of(motion_chart(motion, ["planet"], wrapped=True))[0]
    assert len(pieces(planet)) - 1 == round(np.ptp(motion["planet"]) / 360)
    places = [part[[0, -1], 1] for part in pieces(planet)]
    for before, after in pairwise(places):
        assert abs(before[-1] - after[0]) == pytest.approx(360)


@pytest.mark.parametrize(
    ("span", "unit", "step"),
    [
        (360.0, AngleUnit.DEGREE, 45.0),
        (720.0, AngleUnit.DEGREE, 90.0),
        (180.0, AngleUnit.DEGREE, 30.0),
        (90.0, AngleUnit.DEGREE, 10.0),
        (3600.0, AngleUnit.DEGREE, 720.0),
        (math.tau, AngleUnit.RADIAN, math.pi / 4),
        (math.pi, AngleUnit.RADIAN, math.pi / 6),
    ],
)
def test_ticks_of_angles_stand_at_parts_of_a_turn(
    span: float, unit: AngleUnit, step: float
) -> None:
    assert across_step(span, unit) == pytest.approx(step)


@pytest.mark.parametrize(
    ("values", "ends", "step"),
    [
        ((43.5, 135.3), (30, 150), 30),
        ((0.0, 360.0), (0, 360), 90),
        ((164.4, 189.1), (160, 190), 10),
        ((-1080.0, 360.0), (-1080, 360), 360),
        ((90.0, 90.0 + 1e-12), (89, 91), 1),
    ],
)
def test_axes_of_angles_end_at_ticks(
    values: tuple[float, float], ends: tuple[float, float], step: float
) -> None:
    line = np.linspace(*values, 200)
    found, tick = angle_ends(line, AngleUnit.DEGREE)
    assert (found, tick) == (ABOUT(ends), ABOUT(step))


def test_a_curve_along_an_edge_moves_into_the_panel() -> None:
    flat = np.concatenate([np.zeros(100), np.linspace(0, 90, 100)])
    (low, _), step = angle_ends(flat, AngleUnit.DEGREE)
    assert low == -step


# ------------------------------------------------------------------ axes


def test_rounding_is_not_magnified() -> None:
    motion = swept("rapier-drive")
    spread = np.ptp(motion["E.y"])
    assert spread < 1e-9  # the rapier runs along a line, but for rounding
    chart = motion_chart(motion, ["E.y", "E.y.d1", "E.x"])
    low, high = chart.panels[0].axis.ends or (0.0, 0.0)
    assert len(chart.panels[0].curves) == 2  # E.x shares the panel: it is not constant
    assert (low, high) == (0.0, 0.0)
    [alone, slope] = motion_chart(motion, ["E.y", "E.y.d1"]).panels
    assert alone.axis.ends == pytest.approx((-572, -468))
    assert slope.axis.ends
    low, high = slope.axis.ends
    assert low == -high
    assert high > 10


def test_time_runs_while_the_input_turns() -> None:
    motion = swept("four-bar")  # 25 rad/s
    chart = motion_chart(motion, ["B.x"], against="time")
    assert chart.axis.label == "time [s]"
    assert chart.axis.ends == (0.0, ABOUT(math.tau / 25))
    [curve] = curves_of(chart)
    slope = np.gradient(curve.y, curve.x)[1:-1]
    np.testing.assert_allclose(slope, motion["B.x.velocity"][1:-1], atol=2.0)


def test_columns_can_stand_over_each_other() -> None:
    motion = swept("trotbot-leg")
    chart = motion_chart(motion, ["J7.y"], against="J7.x")
    [curve] = curves_of(chart)
    np.testing.assert_array_equal(curve.x, motion["J7.x"])
    assert chart.axis.label == "J₇.x [unit]"
    assert chart.axis.ends is None


@pytest.mark.parametrize("against", ["residual", "iterations"])
def test_nothing_joins_rows_over_what_is_scattered(against: str) -> None:
    chart = motion_chart(swept("four-bar"), ["B.x"], against=against)
    assert [curve.pen for curve in curves_of(chart)] == [Pen.DOTS]


def test_the_leading_input_is_the_one_that_moves() -> None:
    motion = swept("three-rpr")
    moving = [name for name, values in motion.inputs.items() if np.ptp(values)]
    chart = motion_chart(motion)
    assert chart.axis.label.startswith(moving[0][:3])


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
            "a plot over time needs the speed of θ12: set it in [input], as in "
            'speed = "60 rpm", or plot against θ12',
        ),
        (
            "slider-input", ["θ2"], {"against": "time"}, InputError,
            "a plot over time needs the speed of d: set it in [input], as in "
            'speed = "50 mm/s", or plot against d',
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
            'angles of kind="polar" are not wrapped: leave out wrapped',
        ),
        (
            "four-bar", ["B"], {"kind": "path", "against": "time"}, InputError,
            'a path is drawn in the plane: leave out against="time"',
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
