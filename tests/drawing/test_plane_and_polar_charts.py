"""Paths, hodographs, polar plots, transmission angles and small multiples, as data."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.mechanism.skeleton import dyads_of
from linkwork.writers.charts.chart import Chart, Mark, Shape
from linkwork.writers.charts.circuits import branch_chart, circuit_chart
from linkwork.writers.charts.plotting import motion_plot


@cache
def swept(name: str) -> lw.Motion:
    """The motion of a library mechanism, swept once."""
    return lw.example(name).sweep(certify=False)


@cache
def circuits_of(name: str) -> lw.circuits.Circuits:
    return lw.example(name).circuits(certify=False)


def stations(chart: Chart, panel: int = 0) -> list[Mark]:
    return [mark for mark in chart.panels[panel].marks if mark.kind == "station"]


# ------------------------------------------------------------------ paths


def test_a_path_is_the_trace_of_its_point_to_one_scale() -> None:
    motion = swept("klann-leg")
    chart = motion_plot(motion, kind="path")
    [panel] = chart.panels
    [curve] = panel.curves
    np.testing.assert_array_equal(curve.x + 1j * curve.y, motion.trace("F"))
    assert panel.shape is Shape.PLANE
    assert panel.across is not None
    assert (panel.across.label, panel.axis.label) == ("x [stride]", "y [stride]")
    assert chart.caption == "path of F, crank 0° to 360°"


def test_stations_stand_at_round_inputs_once_and_name_them() -> None:
    motion = swept("klann-leg")
    marks = stations(motion_plot(motion, kind="path"))
    assert len(marks) == 8  # 360 degrees are 0 degrees
    where = {mark.text: complex(mark.x, mark.y) for mark in marks}
    for text, place in where.items():
        row = np.flatnonzero(motion["crank"] == float(text.rstrip("°")))[0]
        assert place == motion.trace("F")[row]
    assert all(abs(math.hypot(*mark.away) - 1) < 1e-9 for mark in marks)


def test_texts_of_stations_keep_apart() -> None:
    for name in ("rolling-wheel", "ross-yoke", "three-rpr", "watt-linkage"):
        chart = motion_plot(swept(name), kind="path")
        [panel] = chart.panels
        every = np.concatenate([[c.x, c.y] for c in panel.curves], axis=1)
        size = np.nanmax(np.nanmax(every, axis=1) - np.nanmin(every, axis=1))
        marks = [mark for mark in stations(chart) if mark.text]
        places = np.array([(m.x + 1j * m.y) + 0.045 * size * complex(*m.away) for m in marks])
        away = np.abs(places[:, None] - places) + 10 * size * np.eye(len(places))
        assert len(marks) >= 3
        assert away.min() > 0.09 * size


def test_without_traced_points_the_last_moving_one_is_taken() -> None:
    motion = swept("four-bar")
    assert motion.skeleton.traced == ()
    assert [c.name for c in motion_plot(motion, kind="path").panels[0].curves] == ["B"]


# ------------------------------------------------------------------ hodographs


def test_hodographs_of_a_crank_pin_are_circles() -> None:
    motion = swept("four-bar")  # crank of 40 mm at 25 rad/s
    velocity, acceleration = motion_plot(motion, ["A"], kind="hodograph").panels
    for panel, radius in ((velocity, 40 * 25), (acceleration, 40 * 25**2)):
        [curve] = panel.curves
        np.testing.assert_allclose(np.hypot(curve.x, curve.y), radius, rtol=1e-12)
        assert [(m.x, m.y) for m in panel.marks if m.kind == "pole"] == [(0, 0)]
    assert velocity.across is not None
    assert velocity.across.label == "vₓ [mm/s]"
    assert acceleration.axis.label == "aᵧ [mm/s²]"


def test_a_hodograph_without_a_speed_is_by_the_input() -> None:
    motion = swept("jansen-leg")
    chart = motion_plot(motion, kind="hodograph")
    assert [panel.title for panel in chart.panels] == ["dF/d crank", "d²F/d crank²"]
    for panel, rate in zip(chart.panels, ("d1", "d2"), strict=True):
        [curve] = panel.curves
        np.testing.assert_array_equal(curve.x + 1j * curve.y, motion.trace(f"F.{rate}"))


def test_a_hodograph_that_runs_to_infinity_leaves_its_panel() -> None:
    motion = lw.example("rapier-drive-limited").sweep(certify=False)
    velocity, acceleration = motion_plot(motion, ["E"], kind="hodograph").panels
    assert velocity.across is not None
    assert acceleration.across is not None
    assert velocity.across.ends is None
    assert acceleration.across.ends
    low, high = acceleration.across.ends
    [curve] = acceleration.curves
    inside = (curve.x > low) & (curve.x < high)
    assert 0.75 * np.isfinite(curve.x).sum() < inside.sum() < np.isfinite(curve.x).sum()
    assert all(low <= mark.x <= high for mark in acceleration.marks)


# ------------------------------------------------------------------ polar


def test_radii_stand_over_the_angle_of_the_input_and_begin_at_zero() -> None:
    motion = swept("cam-roller-follower")
    chart = motion_plot(motion, ["s"], kind="polar")
    [panel] = chart.panels
    [curve] = panel.curves
    np.testing.assert_array_equal(curve.y, motion["s"])
    np.testing.assert_array_equal(curve.x, motion["cam"])
    assert panel.shape is Shape.POLAR
    assert (panel.axis.ends, panel.axis.step) == ((0, 80), 20)
    assert (chart.axis.turn, chart.axis.step) == (360, 30)
    assert panel.title == "s [mm]"


def test_negative_radii_have_a_circle_at_zero() -> None:
    [panel] = motion_plot(swept("rapier-drive"), ["s16"], kind="polar").panels
    assert panel.axis.ends
    low, high = panel.axis.ends
    assert low < np.nanmin(panel.curves[0].y) < 0 < np.nanmax(panel.curves[0].y) < high
    assert [(rule.along, rule.at) for rule in panel.rules] == [("y", 0.0)]


def test_rings_of_angles_stand_at_parts_of_a_turn_from_zero_on() -> None:
    [panel] = motion_plot(swept("rapier-drive"), ["θ13"], kind="polar").panels
    assert (panel.axis.ends, panel.axis.step) == ((0, 225), 45)


def test_a_polar_plot_of_nothing_in_particular_shows_lengths_or_speeds() -> None:
    told = {
        name: [curve.name for curve in motion_plot(swept(name), kind="polar").panels[0].curves]
        for name in ("slider-crank", "jansen-leg", "windscreen-wiper", "four-bar")
    }
    assert told == {
        "slider-crank": ["d"],
        "jansen-leg": ["|dF/d crank|"],
        "windscreen-wiper": ["|velocity of W₁|", "|velocity of W₂|"],
        "four-bar": ["coupler", "rocker"],
    }


def test_a_polar_plot_needs_an_angle() -> None:
    motion = swept("slider-input")
    with pytest.raises(InputError) as raised:
        motion_plot(motion, kind="polar")
    assert str(raised.value) == (
        'a polar plot needs an angle, and "d" is not one: name an angle with against= '
        '(--against), as in "θ2"'
    )
    [panel] = motion_plot(motion, ["d"], kind="polar", against="θ2").panels
    np.testing.assert_array_equal(panel.curves[0].x, motion["θ2"])


# ------------------------------------------------------------------ transmission angles


def test_the_transmission_angle_of_a_four_bar_follows_from_the_law_of_cosines() -> None:
    motion = swept("four-bar")
    a, b, c, d = 40, 120, 80, 100
    theta = np.radians(motion["crank"])
    diagonal = a * a + d * d - 2 * a * d * np.cos(theta)
    wanted = np.degrees(np.arccos((b * b + c * c - diagonal) / (2 * b * c)))
    [curve] = motion_plot(motion, kind="transmission").panels[0].curves
    np.testing.assert_allclose(curve.y, wanted, atol=1e-10)
    assert curve.name == "B: coupler, rocker"


def test_the_transmission_angle_of_a_slider_crank_is_counted_from_the_normal() -> None:
    motion = swept("slider-crank-engine")
    throw, rod = 40, 130
    side = throw * np.cos(np.radians(motion["crank"]))  # the cylinder stands upright
    wanted = np.degrees(np.arccos(side / rod))
    [curve] = motion_plot(motion, kind="transmission").panels[0].curves
    np.testing.assert_allclose(np.sort(curve.y), np.sort(wanted), atol=1e-9)


def test_the_recommended_band_is_40_to_140_degrees_in_the_units_of_the_file() -> None:
    for name, texts, turn in (
        ("four-bar", "recommended: 40° to 140°", 360.0),
        ("andrews-squeezer", "recommended: 2π/9 to 7π/9 rad", math.tau),
    ):
        chart = motion_plot(swept(name), kind="transmission")
        [panel] = chart.panels
        [band] = panel.bands
        assert (band.low, band.high) == pytest.approx((turn / 9, turn * 7 / 18))
        assert band.name == texts
        assert panel.axis.ends == pytest.approx((0, turn / 2))
        assert band.low in panel.axis.ticks
        assert chart.legend is not None
        assert texts in chart.legend


def test_an_angle_of_the_file_is_folded_to_half_a_turn() -> None:
    motion = swept("four-bar")
    chart = motion_plot(motion, ["mu", "B"], kind="transmission")
    own, pin = chart.panels[0].curves
    np.testing.assert_allclose(own.y, pin.y, atol=1e-10)  # mu = rocker - coupler
    assert (np.abs(motion["mu"]) <= 180).all()


def test_dyads_are_found_from_the_crank_on() -> None:
    found = {
        name: [(dyad.pin, *dyad.links) for dyad in dyads_of(swept(name).skeleton)]
        for name in ("jansen-leg", "toggle-press", "double-butterfly", "geared-five-bar")
    }
    assert found == {
        "jansen-leg": [
            ("B", "upper_rod", "upper_triangle"),
            ("C", "lower_rod", "lower_rocker"),
            ("E", "coupler", "foot"),
        ],
        "toggle-press": [("B", "rod", "upper_toggle"), ("C", "lower_toggle", "ram")],
        "double-butterfly": [],  # three coupled loops
        "geared-five-bar": [],  # the second crank hangs on gears
    }


def test_transmission_angles_are_missing_where_there_is_no_position() -> None:
    gap = lw.linkage(
        points={"O2": (0, 0), "A": (60, 60), "B": (120, 90), "O4": (100, 0)},
        links={"ground": ("O2", "O4"), "crank": ("O2", "A"), "coupler": ("A", "B"),
               "rocker": ("O4", "B")},
        lengths={"O2 A": 90, "A B": 60, "O4 B": 90},
        inputs=lw.Input(link="crank"),
    ).sweep(certify=False)  # fmt: skip
    assert not gap.found.all()
    angle = np.radians(gap["B.transmission"])
    np.testing.assert_array_equal(np.isfinite(angle), gap.found)
    assert 0 <= np.nanmin(angle) < np.nanmax(angle) <= math.pi
    dead = [kind == "dead point" for kind in gap.limit]
    away = np.minimum(angle[dead], math.pi - angle[dead])
    assert len(away) == 2
    assert away.max() < 1e-6  # coupler and rocker in line


@pytest.mark.parametrize(
    ("name", "of", "error", "message"),
    [
        (
            "geared-five-bar", [], InputError,
            '"Geared five-bar" has no pair of links with a known transmission angle: add it '
            'to [outputs], as in mu = "rocker - coupler", and name it',
        ),
        (
            "jansen-leg", ["A"], UnknownNameError,
            'the transmission angle at "A" is not known (pins with a known transmission '
            "angle: B, C, E)",
        ),
        (
            "slider-crank", ["d"], UnknownNameError,
            '"d" is not an angle (pins: B); name a pin between two links, or an angle',
        ),
    ],
)  # fmt: skip
def test_an_unknown_transmission_angle_is_refused(
    name: str, of: list[str], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as raised:
        motion_plot(swept(name), of, kind="transmission")
    assert str(raised.value) == message


@pytest.mark.parametrize("kind", ["path", "hodograph"])
def test_an_unknown_point_is_refused(kind: str) -> None:
    with pytest.raises(UnknownNameError) as raised:
        motion_plot(swept("four-bar"), ["C"], kind=kind)
    assert str(raised.value) == 'there is no point "C" (points: O2, A, B, O4)'


# ------------------------------------------------------------------ small multiples


@pytest.mark.parametrize("name", ["jansen-leg", "rapier-drive", "slider-input", "parallelogram"])
def test_every_branch_stands_in_front_of_the_others_once(name: str) -> None:
    circuits = circuits_of(name)
    unknown = next(iter(circuits[0].motion.unknowns))
    chart = branch_chart(circuits, [unknown])
    branches = [branch for circuit in circuits for branch in circuit.branches]
    assert [panel.title.partition("\n")[0] for panel in chart.panels] == [b.name for b in branches]
    [together] = circuit_chart(circuits, [unknown]).panels
    for k, panel in enumerate(chart.panels):
        *others, own = panel.curves
        assert not own.quiet
        assert all(curve.quiet for curve in others)
        np.testing.assert_array_equal(own.y, together.curves[k].y)
        assert len(others) == len(branches) - 1
        assert panel.axis == together.axis
        line = np.stack([own.x, own.y], axis=1)
        size = np.nanmax(np.abs(line), axis=0)
        for mark in panel.marks:
            assert (np.abs(line - (mark.x, mark.y)) <= 1e-8 * size).all(axis=1).any()
    marked = {(m.x, m.y) for panel in chart.panels for m in panel.marks}
    assert marked == {(m.x, m.y) for m in together.marks}


def test_several_quantities_stand_below_each_other() -> None:
    chart = branch_chart(circuits_of("rapier-drive"), ["s16", "θ13"])
    assert (chart.columns, len(chart.panels)) == (4, 8)
    assert [panel.axis.label for panel in chart.panels] == ["s₁₆ [mm]"] * 4 + ["θ₁₃ [deg]"] * 4
    assert [bool(panel.title) for panel in chart.panels] == [True] * 4 + [False] * 4


def test_too_many_branches_for_several_quantities_are_refused() -> None:
    with pytest.raises(InputError) as raised:
        branch_chart(circuits_of("jansen-leg"), ["foot", "coupler"])
    assert str(raised.value) == (
        '"Jansen leg (Strandbeest)" has 8 branches, too many for several quantities: '
        "name one of foot, coupler"
    )
