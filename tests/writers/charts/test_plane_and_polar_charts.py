"""Paths, hodographs, polar plots, transmission angles and small multiples."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation

import linkwork as lw
from linkwork.core.drawing.scene import LIGHT
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.mechanism.skeleton import dyads_of
from linkwork.writers.charts.axes import LIGHT_CHART
from linkwork.writers.charts.lines import branch_chart, circuit_chart
from linkwork.writers.charts.plane import motion_plot
from tests.core.drawing.pages import (
    assert_drawn,
    axes_of,
    curves_of,
    left_title,
    legend_of,
    marks_of,
    pieces,
)


@cache
def swept(name: str) -> lw.Motion:
    """The motion of a library mechanism, swept once."""
    return lw.example(name).sweep(certify=False)


@cache
def circuits_of(name: str) -> lw.circuits.Circuits:
    return lw.example(name).circuits(certify=False)


def dots(ax: Axes) -> Array:
    """The stations of a panel, (K, 2)."""
    return np.concatenate([
        np.asarray(line.get_xydata()) for line in ax.lines if line.get_gid() == "station"
    ])  # fmt: skip


def texts(ax: Axes) -> dict[str, tuple[float, float]]:
    """The stations with a text."""
    notes = [text for text in ax.texts if isinstance(text, Annotation)]
    return {note.get_text(): (float(note.xy[0]), float(note.xy[1])) for note in notes}


def name_of(curve: Line2D) -> str:
    return str(curve.get_gid()).removeprefix("curve:")


# ------------------------------------------------------------------ paths


def test_a_path_is_the_trace_of_its_point() -> None:
    motion = swept("klann-leg")
    chart = motion_plot(motion, kind="path")
    [ax] = axes_of(chart)
    [curve] = curves_of(ax)
    path = motion.trace("F")
    assert_drawn(curve, path.real, path.imag)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [stride]", "y [stride]")
    assert chart.caption == "path of F, crank 0° to 360°"


def test_stations_stand_at_round_inputs_once_and_name_them() -> None:
    motion = swept("klann-leg")
    [ax] = axes_of(motion_plot(motion, kind="path"))
    assert len(np.unique(dots(ax).round(9), axis=0)) == 8  # 360 degrees are 0 degrees
    where = texts(ax)
    assert len(where) == 8
    for text, place in where.items():
        row = np.flatnonzero(motion["crank"] == float(text.rstrip("°")))[0]
        assert complex(*place) == pytest.approx(motion.trace("F")[row])


def test_texts_of_stations_keep_apart() -> None:
    for name in ("rolling-wheel", "ross-yoke", "three-rpr", "watt-linkage"):
        page = motion_plot(swept(name), kind="path").figure(LIGHT)
        page.canvas.draw()
        [ax] = page.axes
        boxes = [text.get_window_extent() for text in ax.texts]
        assert len(boxes) >= 3
        for k, one in enumerate(boxes):
            assert not any(one.overlaps(other) for other in boxes[:k]), name


def test_without_traced_points_the_last_moving_one_is_taken() -> None:
    motion = swept("four-bar")
    assert motion.skeleton.traced == ()
    [ax] = axes_of(motion_plot(motion, kind="path"))
    assert [name_of(curve) for curve in curves_of(ax)] == ["B"]


# ------------------------------------------------------------------ hodographs


def test_hodographs_of_a_crank_pin_are_circles() -> None:
    motion = swept("four-bar")  # crank of 40 mm at 25 rad/s
    velocity, acceleration = axes_of(motion_plot(motion, ["A"], kind="hodograph"))
    for ax, radius in ((velocity, 40 * 25), (acceleration, 40 * 25**2)):
        [curve] = curves_of(ax)
        np.testing.assert_allclose(np.hypot(*curve.get_data()), radius, rtol=1e-5)
        assert marks_of(ax, "pole") == [(0, 0)]
    assert velocity.get_xlabel() == "vₓ [mm/s]"
    assert acceleration.get_ylabel() == "aᵧ [mm/s²]"


def test_a_hodograph_without_a_speed_is_by_the_input() -> None:
    motion = swept("jansen-leg")
    panels = axes_of(motion_plot(motion, kind="hodograph"))
    assert [left_title(ax).get_text() for ax in panels] == ["dF/d crank", "d²F/d crank²"]
    for ax, rate in zip(panels, ("d1", "d2"), strict=True):
        [curve] = curves_of(ax)
        path = motion.trace(f"F.{rate}")
        assert_drawn(curve, path.real, path.imag)


def test_a_hodograph_that_runs_to_infinity_leaves_its_panel() -> None:
    motion = lw.example("rapier-drive-limited").sweep(certify=False)
    page = motion_plot(motion, ["E"], kind="hodograph").figure(LIGHT)
    page.canvas.draw()
    for ax, rate, leaves in zip(page.axes, ("d1", "d2"), (False, True), strict=True):
        low, high = ax.get_xlim()
        x = motion.trace(f"E.{rate}").real
        inside, every = ((x > low) & (x < high)).sum(), np.isfinite(x).sum()
        assert 0.75 * every < inside
        assert (inside < every) == leaves
        assert (high - low < 0.1 * np.ptp(x[np.isfinite(x)])) == leaves


# ------------------------------------------------------------------ polar


def rings(ax: Axes) -> list[float]:
    low, high = ax.get_ylim()
    return [float(tick) for tick in ax.get_yticks() if low <= tick <= high]


def test_radii_stand_over_the_angle_of_the_input_and_begin_at_zero() -> None:
    motion = swept("cam-roller-follower")
    [ax] = axes_of(motion_plot(motion, ["s"], kind="polar"))
    [curve] = curves_of(ax)
    np.testing.assert_array_equal(curve.get_ydata(), motion["s"])
    np.testing.assert_allclose(np.asarray(curve.get_xdata()), np.radians(motion["cam"]))
    assert ax.name == "polar"
    assert ax.get_ylim()[0] == 0.0
    assert rings(ax)[-3:] == [20, 40, 60]
    angles = [label.get_text() for label in ax.get_xticklabels()]
    assert angles == [f"{angle}°" for angle in range(0, 360, 30)]
    assert left_title(ax).get_text() == "s [mm]"


def test_negative_radii_have_a_circle_at_zero() -> None:
    motion = swept("rapier-drive")
    [ax] = axes_of(motion_plot(motion, ["s16"], kind="polar"))
    low, high = ax.get_ylim()
    assert low < motion["s16"].min() < 0 < motion["s16"].max() < high
    [zero] = [line for line in ax.lines if line.get_gid() == "zero"]
    assert np.ptp(np.asarray(zero.get_xdata())) == pytest.approx(math.tau)
    assert not np.any(zero.get_ydata())


def test_rings_of_angles_stand_at_parts_of_a_turn_from_zero_on() -> None:
    [ax] = axes_of(motion_plot(swept("rapier-drive"), ["θ13"], kind="polar"))
    assert ax.get_ylim()[0] == 0.0
    assert rings(ax)[-4:] == [45, 90, 135, 180]


def test_a_polar_plot_of_nothing_in_particular_shows_lengths_or_speeds() -> None:
    told = {
        name: [name_of(c) for c in curves_of(axes_of(motion_plot(swept(name), kind="polar"))[0])]
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
        'a polar plot needs an angle, and "d" is not one: name an angle with against= (--against)'
    )
    [ax] = axes_of(motion_plot(motion, ["d"], kind="polar", against="θ2"))
    np.testing.assert_allclose(np.asarray(curves_of(ax)[0].get_xdata()), np.radians(motion["θ2"]))


# ------------------------------------------------------------------ transmission angles


def test_the_transmission_angle_of_a_four_bar_follows_from_the_law_of_cosines() -> None:
    motion = swept("four-bar")
    a, b, c, d = 40, 120, 80, 100
    theta = np.radians(motion["crank"])
    diagonal = a * a + d * d - 2 * a * d * np.cos(theta)
    wanted = np.degrees(np.arccos((b * b + c * c - diagonal) / (2 * b * c)))
    page = motion_plot(motion, kind="transmission").figure(LIGHT)
    [curve] = curves_of(page.axes[0])
    np.testing.assert_allclose(np.asarray(curve.get_ydata()), wanted, atol=1e-10)
    assert legend_of(page) == ["B: coupler, rocker", "recommended: 40° to 140°"]


def test_the_transmission_angle_of_a_slider_crank_is_counted_from_the_normal() -> None:
    motion = swept("slider-crank-engine")
    throw, rod = 40, 130
    side = throw * np.cos(np.radians(motion["crank"]))  # the cylinder stands upright
    wanted = np.degrees(np.arccos(side / rod))
    [ax] = axes_of(motion_plot(motion, kind="transmission"))
    y = np.asarray(curves_of(ax)[0].get_ydata())
    np.testing.assert_allclose(np.sort(y), np.sort(wanted), atol=1e-9)


def test_the_recommended_band_is_40_to_140_degrees_in_the_units_of_the_file() -> None:
    for name, texts, turn in (
        ("four-bar", "recommended: 40° to 140°", 360.0),
        ("andrews-squeezer", "recommended: 2π/9 to 7π/9 rad", math.tau),
    ):
        page = motion_plot(swept(name), kind="transmission").figure(LIGHT)
        [ax] = page.axes
        [band] = [patch for patch in ax.patches if patch.get_gid() == f"band:{texts}"]
        assert isinstance(band, Rectangle)
        low = turn / 9
        assert (band.get_y(), band.get_height()) == pytest.approx((low, turn * 7 / 18 - low))
        assert ax.get_ylim() == pytest.approx((0, turn / 2))
        assert low == pytest.approx(ax.get_yticks()[1])
        assert texts in legend_of(page)


def test_an_angle_of_the_file_is_folded_to_half_a_turn() -> None:
    motion = swept("four-bar")
    [ax] = axes_of(motion_plot(motion, ["mu", "B"], kind="transmission"))
    own, pin = (np.asarray(curve.get_ydata()) for curve in curves_of(ax))
    np.testing.assert_allclose(own, pin, atol=1e-10)  # mu = rocker - coupler
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
    panels = axes_of(branch_chart(circuits, [unknown]))
    branches = [branch for circuit in circuits for branch in circuit.branches]
    titles = [left_title(ax).get_text().partition("\n")[0] for ax in panels]
    assert titles == [branch.name for branch in branches]
    [together] = axes_of(circuit_chart(circuits, [unknown]))
    marked: set[tuple[float, float]] = set()
    for k, ax in enumerate(panels):
        curves = curves_of(ax)
        assert len(curves) == len(branches)
        for n, (curve, same) in enumerate(zip(curves, curves_of(together), strict=True)):
            np.testing.assert_array_equal(curve.get_xydata(), same.get_xydata())
            assert (curve.get_color() == LIGHT_CHART.rule) == (n != k)
            assert n == k or curve.get_zorder() < curves[k].get_zorder()
        assert ax.get_ylim() == pytest.approx(together.get_ylim())
        marks = {m for kind in ("dead point", "change point") for m in marks_of(ax, kind)}
        for mark in marks:
            assert min(np.abs(p - mark).max(axis=1).min() for p in pieces(curves[k])) < 1e-8
        marked |= marks
    assert marked == {
        mark for kind in ("dead point", "change point") for mark in marks_of(together, kind)
    }


def test_several_quantities_stand_below_each_other() -> None:
    chart = branch_chart(circuits_of("rapier-drive"), ["s16", "θ13"])
    panels = axes_of(chart)
    assert (chart.columns, len(panels)) == (4, 8)
    assert [ax.get_ylabel() for ax in panels] == ["s₁₆ [mm]", "", "", "", "θ₁₃ [deg]", "", "", ""]
    assert [bool(left_title(ax).get_text()) for ax in panels] == [True] * 4 + [False] * 4


def test_too_many_branches_for_several_quantities_are_refused() -> None:
    with pytest.raises(InputError) as raised:
        branch_chart(circuits_of("jansen-leg"), ["foot", "coupler"])
    assert str(raised.value) == (
        '"Jansen leg (Strandbeest)" has 8 branches, too many for several quantities: '
        "name one of foot, coupler"
    )
