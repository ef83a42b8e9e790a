"""What families say of rates, and between which inputs designs can move."""

from __future__ import annotations

import math
import re

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.quantity import Rate
from linkwork.families import FamilyMotion
from tests.described import described_as

Array = npt.NDArray[np.float64]
CRANKS = np.array([40.0, 41.0, 110.0, math.nan])
#: Of the crank of 110: cosine rule with coupler and rocker in line.
DEAD = [math.degrees(math.acos((110**2 + 100**2 - r**2) / 22000)) for r in (40, 200)]


@pytest.fixture(scope="module")
def motion() -> FamilyMotion:
    """Two whole circles, one with limits, one without a number."""
    return lw.example("four-bar").family({"O2 A": CRANKS}).sweep()


# ------------------------------------------------------------------ names


def test_rates_have_the_names_and_units_of_a_motions_table(motion: FamilyMotion) -> None:
    alone = lw.example("four-bar").sweep()
    table = alone.table()
    named = [name for name in table.columns if Rate.split(name)[1] is not None]
    assert len(named) == 4 * len([*alone.unknowns, *alone.outputs, *alone.points, *alone.points])
    for name in named:
        scale = np.nanmax(np.abs(table[name])) or 1.0
        own, other = motion[name][0], alone[name]
        np.testing.assert_array_equal(other, table[name])
        np.testing.assert_allclose(own, other, rtol=0, atol=1e-12 * scale, err_msg=name)
        assert motion.unit(name) == table.units[name]
        assert np.isnan(motion[name][2][~motion.found[2]]).all()
        assert np.isfinite(motion[name][2][motion.found[2]]).all()
        assert np.isnan(motion[name][3]).all()
    assert motion.unit("B.x.acceleration") == f"{alone.units.length}/s^2"
    assert motion.unit("rocker") == "deg"


def test_a_series_holds_value_and_both_derivatives(motion: FamilyMotion) -> None:
    series = motion.series("rocker")
    assert series.quantity.name == "rocker"
    np.testing.assert_array_equal(series.value, motion["rocker"])
    np.testing.assert_array_equal(series.first, motion["rocker.d1"])
    np.testing.assert_array_equal(series.second, motion["rocker.d2"])
    np.testing.assert_array_equal(motion["crank.d1"][0], np.ones(361))
    np.testing.assert_array_equal(motion["O4.x.d1"][:3], np.where(motion.found[:3], 0.0, np.nan))


def test_paths_and_velocities_of_points_are_traced(motion: FamilyMotion) -> None:
    alone = lw.example("four-bar").sweep()
    for name in ("B", "B.d1", "B.velocity", "B.acceleration"):
        one, many = alone.trace(name), motion.trace(name)
        np.testing.assert_allclose(many[0], one, rtol=0, atol=1e-12 * np.abs(one).max())
    np.testing.assert_array_equal(alone.trace("B.d2").imag, alone["B.y.d2"])
    for traced in (motion, alone):
        with pytest.raises(UnknownNameError, match=re.escape('there is no point "Q"')):
            traced.trace("Q.velocity")


def test_rates_that_do_not_exist_are_refused_before_anything_is_computed(
    motion: FamilyMotion, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("computed")

    monkeypatch.setattr("linkwork.families.values.design_rates", refuse)
    slow = lw.example("four-bar").driven_by(link="crank", from_=0, to=90, step=45)
    told = '"rocker.velocity" needs the speed of the input: set speed in [input]'
    fresh = slow.family({"A B": [119.0, 121.0]})
    for mechanism in (slow.sweep(), fresh.sweep()):
        assert mechanism.speed is None
        with pytest.raises(UnknownNameError, match=re.escape(told)):
            mechanism["rocker.velocity"]
    wanted = re.escape('"rocker.d2", the derivative with respect to the input')
    with pytest.raises(UnknownNameError, match=wanted):
        fresh.reduced(["max(rocker.acceleration)"])
    with pytest.raises(UnknownNameError, match=re.escape('there is no "rokcer"')):
        fresh.sweep()["rokcer.d1"]
    with pytest.raises(UnknownNameError, match=re.escape('there is no "rokcer"')):
        fresh.sweep().to_xarray("rokcer.d1")
    with pytest.raises(UnknownNameError, match=re.escape('there is no "rokcer"')):
        fresh.sweep().series("rokcer")


def test_every_design_has_its_own_speed() -> None:
    mechanism = lw.loops(
        loops={"1": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0, "n": 60.0, "top": "2*n"},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", from_=0, to=360, step=30, speed="top/4 + 30 rpm"),
    )
    speeds = np.array([60.0, math.nan, 120.0])
    motion = mechanism.family({"n": speeds}).sweep()
    expected = (speeds / 2 + 30) * 2 * np.pi / 60
    assert motion.speed is not None
    np.testing.assert_allclose(motion.speed, expected, rtol=1e-14)
    turned = np.radians(motion.inputs[:, 0])
    np.testing.assert_allclose(
        motion["x.velocity"], -2.0 * np.sin(turned) * expected[:, None], atol=1e-13
    )
    np.testing.assert_allclose(
        motion["x.acceleration"], -2.0 * np.cos(turned) * expected[:, None] ** 2, atol=1e-12
    )
    speed = mechanism.sweep().speed
    assert speed is not None
    np.testing.assert_allclose(speed, 2 * np.pi, rtol=1e-14)


# ------------------------------------------------------------------ numbers per design


def test_rates_and_limits_are_reduced_in_parts(
    motion: FamilyMotion, monkeypatch: pytest.MonkeyPatch
) -> None:
    family = lw.example("four-bar").family({"O2 A": CRANKS})
    monkeypatch.setattr("linkwork.families.family._PART_BYTES", 3 * 8 * 361 * 7)
    assert family._part() == 3
    found = family.reduced({"rocker.d2": lambda v: v[:, 0]})
    fastest = family.reduced(["min(B.x.velocity)", "max(B.x.velocity)"])
    np.testing.assert_allclose(
        fastest["max(B.x.velocity)"], motion.value("max(B.x.velocity)"), rtol=1e-12
    )
    np.testing.assert_allclose(found["rocker.d2.<lambda>"], motion["rocker.d2"][:, 0], rtol=1e-9)
    worst = family.reduced(["max(condition)", "max(residual)"])
    np.testing.assert_allclose(
        worst["max(condition)"], np.fmax.reduce(motion.condition, axis=1), rtol=1e-12
    )
    assert (worst["max(residual)"][:3] < 1e-9).all()
    np.testing.assert_allclose(found["limit.lower"], motion.limits.lower, rtol=1e-12)
    np.testing.assert_allclose(found["limit.upper"], motion.limits.upper, rtol=1e-12)
    monkeypatch.setattr("linkwork.families.family._PART_BYTES", 1)
    assert family._part() == 1


def test_labelled_arrays_hold_rates_with_units(motion: FamilyMotion) -> None:
    data = motion.to_xarray()
    for name in ("rocker.d1", "B.x.d2", "B.y.velocity", "mu.acceleration"):
        np.testing.assert_array_equal(data[name].values, motion[name])
        assert data[name].attrs["units"] == motion.unit(name)
    assert "crank.d1" not in data
    np.testing.assert_array_equal(data["condition"].values, motion.condition)
    own = lw.example("four-bar").changed(outputs={"condition": "2*rocker"})
    named = own.family({"O2 A": CRANKS}).sweep()
    np.testing.assert_allclose(named["condition"], 2 * named["rocker"], rtol=1e-14)
    few = motion.to_xarray("B.y.velocity")
    assert "B.y.velocity" in few.data_vars
    assert "B.y" not in few.data_vars


def test_what_would_not_fit_into_memory_is_refused(
    motion: FamilyMotion, monkeypatch: pytest.MonkeyPatch
) -> None:
    family = lw.example("four-bar").family({"O2 A": CRANKS})
    fresh = family.sweep()
    monkeypatch.setattr("linkwork.families.values._MOST_BYTES", 2 * 2 * 4 * 361 * 8 - 1)
    with pytest.raises(InputError, match=re.escape("the rates of 4 designs × 361 rows take 0 GiB")):
        fresh["rocker.d1"]
    monkeypatch.setattr("linkwork.families.values._MOST_BYTES", 2 * 2 * 4 * 361 * 8)
    assert np.isfinite(fresh["rocker.d1"][0]).all()
    monkeypatch.setattr("linkwork.families.family_motion._MOST_BYTES", 1000)
    with pytest.raises(InputError, match="quantities and rates of 4 designs take 0 GiB"):
        motion.to_xarray()


# ------------------------------------------------------------------ limits


def test_random_four_bars_move_between_the_dead_points_of_their_triangles() -> None:
    # |O4 A| lies between |b - c| and b + c; cosine rule in the triangle O2 A O4
    rng = np.random.default_rng(11)
    count = 400
    a, b, c = (rng.uniform(low, 120.0, count) for low in (15.0, 60.0, 60.0))
    d = 100.0
    family = lw.example("four-bar").family({"O2 A": a, "A B": b, "O4 B": c})
    motion = family.sweep()
    start = np.degrees(family.designs.start[:, -1])
    far, near = ((a**2 + d**2 - reach**2) / (2 * a * d) for reach in (b + c, b - c))
    with np.errstate(invalid="ignore"):
        outer, inner = np.degrees(np.arccos(far)), np.degrees(np.arccos(near))
    starts = motion.found.any(axis=1)
    cosine = np.cos(np.radians(start))
    np.testing.assert_array_equal(starts, (far < cosine) & (cosine < near))
    lower = np.where(near < 1.0, inner, np.where(far > -1.0, -outer, -np.inf))
    upper = np.where(far > -1.0, outer, np.where(near < 1.0, 360.0 - inner, np.inf))
    limits = motion.limits
    assert {"dead point", ""} == set(limits.lower_kind[starts]) | set(limits.upper_kind[starts])
    np.testing.assert_allclose(limits.lower[starts], lower[starts], rtol=0, atol=1e-9)
    np.testing.assert_allclose(limits.upper[starts], upper[starts], rtol=0, atol=1e-9)
    assert np.isnan(limits.lower[~starts]).all()
    assert not any(limits.lower_kind[~starts])
    for kind in (np.isinf(lower), near < 1.0, far > -1.0):  # all sorts are there
        assert np.count_nonzero(kind & starts) > 10
    assert not motion.rows.alone[starts].any()
    assert "0 change points" in repr(limits)


@pytest.mark.parametrize(
    ("start", "stop", "step", "lower", "upper"),
    [
        (30.0, 60.0, 10.0, -math.inf, math.inf),
        (60.0, 150.0, 10.0, DEAD[0], DEAD[1]),  # looked for a turn below, too
        (140.0, 30.0, -10.0, -math.inf, math.inf),
        (-10.0, 60.0, 10.0, DEAD[0], DEAD[1]),
    ],
)
def test_limits_are_those_met_on_the_way_to_the_rows(
    start: float, stop: float, step: float, lower: float, upper: float
) -> None:
    driven = lw.example("four-bar").driven_by(link="crank", from_=start, to=stop, step=step)
    limits = driven.family({"O2 A": [110.0, 40.0]}).sweep().limits
    assert limits.lower[0] == pytest.approx(lower, abs=1e-9)
    assert limits.upper[0] == pytest.approx(upper, abs=1e-9)
    assert math.isinf(limits.lower[1])
    assert math.isinf(limits.upper[1])


def test_change_points_and_lost_ends_have_their_kind() -> None:
    mechanism = lw.example("parallelogram").driven_by(link="crank", from_=5, to=355, step=5)
    length = described_as(Linkage, mechanism).lengths["O2 A"]
    motion = mechanism.family({"O2 A": length * np.array([1.0, 0.99])}).sweep()
    limits = motion.limits
    assert (limits.lower_kind[0], limits.upper_kind[0]) == ("change point", "change point")
    np.testing.assert_allclose([limits.lower[0], limits.upper[0]], [0.0, 180.0], atol=1e-9)
    singular = lw.loops(
        loops={"1": "r*e^(i*t) + l*e^(i*p) = x"},
        dimensions={"r": 1.0, "l": 3.0},
        guess={"t": 0, "p": 0, "x": 4.0},
        inputs=lw.Input(variable="x", from_=4.0, to=3.0, step=-0.25),
    )
    lost = singular.family({"l": [3.0, 3.001]}).sweep().limits
    assert lost.lower_kind[0] == "limit"
    assert np.isnan(lost.lower[0])
