"""Limits have rows of their own, circuits are followed around, change points as was chosen."""

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb, ctx
from scipy.optimize import minimize_scalar

import linkwork as lw
from linkwork.core.foundation.arrays import BoolArray, IndexArray
from linkwork.core.foundation.statuses import Certification, CircuitEnd
from tests.oracles.four_bar import FourBar, random_crank_rockers

Array = npt.NDArray[np.float64]
DEAD = math.degrees(math.acos(11 / 16))  # of 4/2/5/2
FOLDING = FourBar(4.0, 2.0, 5.0, 2.0)
RAPIER = (149.617278637485, -158.679899604109)
TINY = math.degrees(1e-12)


def four_bar(bar: FourBar, at: float, side: int = 1, **table: Any) -> lw.Mechanism:
    return lw.linkage(
        name="four-bar",
        points=bar.points(math.radians(at), side),
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B"),
            "rocker": ("O4", "B"),
        },
        lengths={"O2 A": bar.r2, "A B": bar.r3, "O4 B": bar.r4, "O2 O4": bar.r1},
        inputs=lw.Input(link="crank", **({"from_": 0, "to": 360, "step": 1} | table)),
    )


def limit_rows(motion: lw.Motion, kind: str) -> list[int]:
    return [k for k, limit in enumerate(motion.limit) if limit == kind]


def on_assembly(motion: lw.Motion, bar: FourBar, rows: IndexArray | BoolArray, side: int) -> float:
    """Largest distance of the rows' B from the closed form."""
    b = bar.coupler_end(np.radians(motion["crank"][rows]), side)
    return float(np.abs(motion.trace("B")[rows] - b).max())


def exact_dead_points(bar: FourBar) -> list[arb]:
    """[deg], in balls."""
    ctx.prec = 200
    r1, r2, r3, r4 = (arb(x) for x in (bar.r1, bar.r2, bar.r3, bar.r4))
    cosines = [(r1**2 + r2**2 - reach**2) / (2 * r1 * r2) for reach in (r3 - r4, r3 + r4)]
    angles = [c.acos() * 180 / arb.pi() for c in cosines if abs(c) < 1]
    return [sign * angle + turn for angle in angles for sign in (1, -1) for turn in (0, 360)]


# ------------------------------------------------------------------ rows at dead points


def test_each_dead_point_adds_a_row_with_the_exact_value_and_no_derivatives() -> None:
    motion = four_bar(FOLDING, 90).sweep()
    assert len(motion) == 363
    assert motion.counts == {lw.Status.CONVERGED: 269, lw.Status.OUT_OF_REACH: 94}
    rows = limit_rows(motion, "dead point")
    np.testing.assert_array_equal(np.flatnonzero(motion.added), rows)
    np.testing.assert_array_equal(motion["crank"][motion.asked], np.arange(361.0))
    assert np.all(np.diff(motion["crank"]) > 0)
    for row, limit in zip(rows, motion.limits, strict=True):
        assert motion["crank"][row] == limit.input
        assert motion.status[row] is lw.Status.CONVERGED
        assert motion.certification[row] is Certification.CERTIFIED
        assert motion.branch[row] == "circuit 1 branch 1"
        assert motion.residual[row] < 1e-14
        assert math.isinf(motion.condition[row])
        for name in ("coupler", "rocker"):
            assert np.isnan(motion.series(name).first[row])
            assert np.isnan(motion.series(name).second[row])
        line = abs(math.sin(math.radians(motion["coupler"][row] - motion["rocker"][row])))
        assert line < 1e-13
    assert [limit.input for limit in motion.limits] == pytest.approx([DEAD, 360 - DEAD], abs=TINY)


@pytest.mark.parametrize(
    ("bar", "at"), [(FOLDING, 90.0), (FourBar(3.0, 2.0, 1.0, 2.2), 40.0)], ids=str
)
@pytest.mark.parametrize("certify", [True, False])
def test_brackets_hold_the_exact_dead_points(bar: FourBar, at: float, certify: bool) -> None:
    motion = four_bar(bar, at).sweep(certify=certify)
    assert len(motion.limits) == 2
    for limit in motion.limits:
        assert limit.located
        exact = min(exact_dead_points(bar), key=lambda x: abs(float(x) - limit.input))
        assert limit.bracket[0] < exact
        assert exact < limit.bracket[1]
        assert limit.bracket[0] <= limit.input <= limit.bracket[1]
        assert abs(exact - limit.input) < TINY
        assert limit.bracket[1] - limit.bracket[0] < 1e-10


def test_the_toggle_and_the_limited_rapier_have_their_known_dead_points() -> None:
    toggle = four_bar(FourBar(3.0, 2.0, 1.0, 2.2), 40).sweep()
    known = [15.563575187105, 76.70292825279]
    assert [limit.input for limit in toggle.limits] == pytest.approx(known, abs=TINY)
    rapier = lw.example("rapier-drive-limited").sweep()
    places = [RAPIER[0], RAPIER[1] + 360]  # a turn away, in the table's place
    assert sorted(limit.input for limit in rapier.limits) == pytest.approx(places, abs=TINY)
    rows = limit_rows(rapier, "dead point")
    assert rapier["θ12"][rows] == pytest.approx(places, abs=TINY)
    assert (~rapier.found).sum() == 52
    assert lw.example("rapier-drive").sweep().limits == ()


def test_a_falling_table_has_its_limit_rows_in_falling_order() -> None:
    motion = four_bar(FOLDING, 90, from_=360, to=0, step=-10).sweep()
    assert len(motion) == 39
    assert np.all(np.diff(motion["crank"]) < 0)
    rows = limit_rows(motion, "dead point")
    assert motion["crank"][rows] == pytest.approx([360 - DEAD, DEAD], abs=TINY)
    found = motion["crank"][motion.found]
    assert (found[0], found[-1]) == (motion["crank"][rows[0]], motion["crank"][rows[1]])


def test_a_row_asked_for_at_a_dead_point_is_its_row() -> None:
    motion = four_bar(FOLDING, 90, from_=DEAD, to=DEAD + 90, step=30).sweep()
    assert len(motion) == 4
    assert not motion.added.any()
    assert motion.limit == ("dead point", "", "", "")
    assert motion["crank"][0] == DEAD
    assert motion.found.all()
    assert motion.certified.all()


def test_a_limit_outside_of_the_table_adds_no_row() -> None:
    motion = four_bar(FOLDING, 90, from_=60, to=120, step=10).sweep()
    assert (len(motion), motion.limits) == (7, ())
    beyond = four_bar(FOLDING, 90, from_=0, to=40, step=10).sweep()
    assert not beyond.found.any()
    assert set(beyond.status) == {lw.Status.OUT_OF_REACH}
    assert len(beyond) == 5
    assert beyond.limits[0].input == pytest.approx(DEAD, abs=TINY)


def test_a_limit_a_whole_turn_away_has_a_row_in_the_table() -> None:
    motion = four_bar(FOLDING, 90, from_=380, to=720, step=10).sweep()
    rows = limit_rows(motion, "dead point")
    assert motion["crank"][rows] == pytest.approx([360 + DEAD, 720 - DEAD], abs=TINY)
    # what the table has between them is found, and nothing else
    inside = (motion["crank"] >= motion["crank"][rows[0]]) & (
        motion["crank"] <= motion["crank"][rows[1]]
    )
    np.testing.assert_array_equal(motion.found, inside)
    assert on_assembly(motion, FOLDING, motion.found & motion.asked, 1) < 1e-11


def test_rows_of_a_dead_point_are_numbers_or_empty_in_every_table() -> None:
    table = four_bar(FOLDING, 90).sweep().table()
    row = list(table["limit"]).index("dead point")
    assert np.isnan(table["rocker.d1"][row])
    assert table["certified"][row]
    assert len(table) == 363


# ------------------------------------------------------------------ around the circuit


def test_through_dead_points_the_other_assembly_follows_with_the_input_turning_back() -> None:
    motion = four_bar(FOLDING, 90).sweep(through=True)
    assert len(motion) == 632
    assert motion.circuit is CircuitEnd.CLOSED
    assert len(motion.limits) == 2
    names = np.array(motion.branch)
    second = np.flatnonzero(names == "circuit 1 branch 2")
    assert set(names) == {"", "circuit 1 branch 1", "circuit 1 branch 2"}
    np.testing.assert_array_equal(second, np.arange(363, 632))
    assert np.all(np.diff(motion["crank"][second]) < 0)
    assert motion.added[second].all()
    assert motion.certified[motion.found].all()
    ends = [second[0], second[-1]]
    assert [motion.limit[k] for k in ends] == ["dead point"] * 2
    assert motion["crank"][ends] == pytest.approx([360 - DEAD, DEAD], abs=TINY)
    np.testing.assert_array_equal(motion["crank"][second[1:-1]], np.arange(313.0, 46.0, -1.0))
    first = (names == "circuit 1 branch 1") & motion.asked
    assert on_assembly(motion, FOLDING, first, 1) < 1e-11
    assert on_assembly(motion, FOLDING, second[1:-1], -1) < 1e-11


@pytest.mark.parametrize("at", [DEAD + 1e-3, DEAD + 1e-7, 360 - DEAD - 1e-9])
def test_a_start_next_to_a_dead_point_goes_around_all_the_same(at: float) -> None:
    motion = four_bar(FOLDING, at, step=5).sweep(through=True)
    assert motion.circuit is CircuitEnd.CLOSED
    assert len(motion.limits) == 2
    names = np.array(motion.branch)
    for name, side in (("circuit 1 branch 1", 1), ("circuit 1 branch 2", -1)):
        rows = (names == name) & (np.array(motion.limit) == "")
        assert rows.sum() == 53
        assert on_assembly(motion, FOLDING, rows, side) < 1e-10


def test_the_limited_rapier_goes_around_its_whole_circuit() -> None:
    motion = lw.example("rapier-drive-limited").sweep(step=5, through=True, limits_of=["s16"])
    assert motion.circuit is CircuitEnd.CLOSED
    assert set(motion.branch) == {"", "circuit 1 branch 1", "circuit 1 branch 2"}
    stroke = motion["s16"][motion.found]
    assert stroke.min() == pytest.approx(-812.53480, abs=5e-6)
    assert stroke.max() == pytest.approx(525.10805, abs=5e-6)
    assert motion.certified[motion.found].all()
    row = next(
        k
        for k, (x, name) in enumerate(zip(motion["θ12"], motion.branch, strict=True))
        if x == 60.0 and name == "circuit 1 branch 2"
    )
    assert motion["s16"][row] == pytest.approx(-567.362061, abs=5e-7)


def test_a_full_turn_has_nothing_to_go_through() -> None:
    one, other = (
        lw.example("rapier-drive").sweep(step=5, through=through) for through in (False, True)
    )
    assert (one.circuit, other.circuit) == (None, CircuitEnd.CLOSED)
    np.testing.assert_allclose(one["s16"], other["s16"], rtol=1e-12)  # rounding of two loops
    assert not other.added.any()


def test_two_dead_points_at_one_input_value_are_both_told() -> None:
    # the slider's line through the crank's pivot: to and fro between stretched positions
    mechanism = lw.loops(
        loops={"1": "2*e^(i*t) + 1.9*e^(i*p) = s"},
        guess={"t": 20, "p": -21, "s": 3.6},
        inputs=lw.Input(variable="t", from_=-90, to=90, step=5),
    )
    motion = mechanism.sweep(through=True)
    assert motion.circuit is CircuitEnd.CLOSED
    exact = math.degrees(math.asin(0.95))
    assert [limit.input for limit in motion.limits] == pytest.approx([-exact, exact], abs=TINY)


def test_a_runaway_circuit_is_told() -> None:
    mechanism = lw.loops(
        loops={"1": "s*e^(i*t) = 1 + i*y"},
        guess={"t": 20, "s": 1.06, "y": 0.36},
        inputs=lw.Input(variable="t", from_=0, to=40, step=5),
    )
    motion = mechanism.sweep(through=True)
    assert motion.circuit is CircuitEnd.RUNS_TO_INFINITY
    assert motion.found.all()
    assert len(motion) == 9


# ------------------------------------------------------------------ change points

PARALLELOGRAMS = [FourBar(2.0, 1.0, 2.0, 1.0), FourBar(3.0, 1.0, 3.0, 1.0)]


def turned(bar: FourBar, degrees: Array) -> Array:
    """The antiparallelogram: tan(θ4/2) = -(g + a)/(g - a) tan(θ2/2), for angles from 180 on."""
    half = np.radians(degrees) / 2
    ratio = (bar.r1 + bar.r2) / (bar.r1 - bar.r2)
    return np.asarray(np.degrees(2 * np.arctan2(-ratio * np.sin(half), np.cos(half))))


def gap(a: Array, b: Array) -> float:
    return float(np.abs(np.remainder(a - b + 180, 360) - 180).max())


@pytest.mark.parametrize("bar", PARALLELOGRAMS, ids=str)
@pytest.mark.parametrize("step", [0.1, 1, 10, 60])
def test_stop_straight_and_turn_are_obeyed_and_reported(bar: FourBar, step: float) -> None:
    mechanism = four_bar(bar, 60, step=step)
    stop, straight, turn = (
        mechanism.sweep(change_points=policy) for policy in ("stop", "straight", "turn")
    )
    degrees = stop["crank"]
    upper, lower = degrees <= 180, (degrees > 180) & (degrees < 360)
    np.testing.assert_array_equal(stop.found, upper | (degrees == 360))
    for motion in (straight, turn):
        assert motion.found.all()
        assert len(motion) == len(stop)
        rows = limit_rows(motion, "change point")
        assert motion["crank"][rows] == pytest.approx([0, 180, 360], abs=0)
        assert [limit.input for limit in motion.limits] == [0.0, 180.0, 360.0]
        chosen = np.array([c is Certification.BRANCH_CHOSEN for c in motion.certification])
        np.testing.assert_array_equal(chosen, lower)
        inner = upper & (degrees > 0) & (degrees < 180)
        assert motion.certified[inner].all()
        assert set(np.array(motion.branch)[inner]) == {"circuit 1 branch 1"}
        assert set(np.array(motion.branch)[lower]) == {"circuit 1"}
        assert gap(motion["rocker"][upper], degrees[upper]) < 1e-9
    assert [limit.passed for limit in straight.limits] == ["", "straight", ""]
    assert [limit.passed for limit in turn.limits] == ["", "turn", ""]
    assert [limit.passed for limit in stop.limits] == ["", ""]
    assert gap(straight["rocker"], degrees) < 1e-9
    assert gap(turn["rocker"][lower], turned(bar, degrees[lower])) < 1e-9
    assert gap(turn["rocker"][lower], degrees[lower]) > 10


def test_rows_at_a_change_point_have_the_rates_of_the_branch_that_was_followed() -> None:
    motion = four_bar(FourBar(4.0, 2.0, 4.0, 2.0), 60).sweep(change_points="turn")
    first, second, _ = limit_rows(motion, "change point")
    rates = motion.series("rocker")
    assert rates.first[[first, second]] == pytest.approx([1, 1], abs=1e-12)
    assert np.isnan(rates.second[[first, second]]).all()
    assert motion.certification[first] is Certification.POSITION_NOT_PROVED
    assert motion.limits[0].other["rocker"] == pytest.approx(-3, abs=1e-12)
    assert motion.limits[1].other["rocker"] == pytest.approx(-1 / 3, abs=1e-12)


@pytest.mark.parametrize("step", [0.1, 1, 10, 60])
def test_a_chosen_way_goes_before_the_way_around(step: float) -> None:
    bar = FourBar(4.0, 1.0, 3.0, 2.0)  # 1 + 4 = 3 + 2: one change point, at 180 degrees
    mechanism = four_bar(bar, 60, step=step)
    stop, straight, turn = (
        mechanism.sweep(change_points=policy) for policy in ("stop", "straight", "turn")
    )
    degrees = stop["crank"]
    beyond = degrees > 180
    for motion in (stop, straight, turn):
        assert motion.found.all()
        assert len(motion) == len(degrees)
        assert motion.limit[int(np.flatnonzero(degrees == 180)[0])] == "change point"
    regular = degrees != 180
    assert on_assembly(stop, bar, regular, 1) < 1e-9
    # at 180 the tangent leads to the other side of the line from A to the rocker's pivot
    assert on_assembly(straight, bar, ~beyond & regular, 1) < 1e-9
    assert on_assembly(straight, bar, beyond, -1) < 1e-9
    assert on_assembly(turn, bar, regular, 1) < 1e-9
    for motion in (straight, turn):
        chosen = np.array([c is Certification.BRANCH_CHOSEN for c in motion.certification])
        np.testing.assert_array_equal(chosen, beyond)
    assert stop.certified[regular].all()
    smooth = np.diff(straight["rocker"])
    assert np.abs(np.diff(smooth)).max() < 0.05 * step**2


def test_a_circuit_is_followed_to_its_change_points() -> None:
    motion = four_bar(PARALLELOGRAMS[0], 60, step=10).sweep(through=True)
    assert motion.circuit is CircuitEnd.CHANGE_POINT
    assert motion.found.sum() == 20  # 0 to 180, and 360


def test_policies_and_quantities_that_do_not_exist_are_told() -> None:
    mechanism = four_bar(FOLDING, 90)
    with pytest.raises(lw.InputError) as policy:
        mechanism.sweep(change_points="strait")
    assert str(policy.value) == (
        '"strait" is not a policy at a change point (policies: straight, stop, turn)'
    )
    with pytest.raises(lw.UnknownNameError) as name:
        mechanism.sweep(limits_of=["rocker", "roker"])
    assert str(name.value) == (
        'there is no "roker" (nearest: rocker, coupler, crank; all: linkwork quantities FILE)'
    )


# ------------------------------------------------------------------ limits of outputs


def test_the_rapier_s_stroke_is_located_and_has_rows() -> None:
    motion = lw.example("rapier-drive").sweep(step=10, limits_of=["s16"])
    low, high = sorted(motion.output_limits, key=lambda x: x.value)
    assert (low.kind, high.kind) == ("minimum", "maximum")
    assert low.value == pytest.approx(-54.69985, abs=5e-6)
    assert high.value == pytest.approx(304.25187, abs=5e-6)
    for extreme in (low, high):
        assert extreme.located
        assert extreme.bracket[0] <= extreme.input <= extreme.bracket[1]
        (row,) = limit_rows(motion, f"{extreme.kind} of s16")
        assert motion.added[row]
        assert motion.certified[row]
        assert motion["θ12"][row] == pytest.approx(extreme.input, abs=1e-12)
        assert motion["s16"][row] == pytest.approx(extreme.value, abs=1e-10)
        rates = motion.series("s16")
        assert rates.first[row] == pytest.approx(0, abs=1e-9)
        assert (rates.second[row] < 0) == (extreme.kind == "maximum")
    assert motion.asked.sum() == 37


def exact_extremes(bar: FourBar) -> list[arb]:
    """Crank angles [deg] of a crank-rocker's extremes with B on the left of the ground."""
    ctx.prec = 200
    exact = []
    for sign in (-1, 1):  # the triangle O2 B O4 with crank and coupler in line
        reach = arb(bar.r3) + sign * arb(bar.r2)
        cosine = (arb(bar.r1) ** 2 + reach**2 - arb(bar.r4) ** 2) / (2 * bar.r1 * reach)
        exact.append(cosine.acos() * 180 / arb.pi() + (180 if sign < 0 else 0))
    return exact


def test_limits_of_a_rocker_are_where_crank_and_coupler_line_up() -> None:
    bar = FourBar(4.0, 2.0, 5.0, 3.5)
    motion = four_bar(bar, 90, step=60).sweep(limits_of=["rocker", "B.x"])
    exact = exact_extremes(bar)
    mine = [x for x in motion.output_limits if x.name == "rocker"]
    assert sorted(x.kind for x in mine) == ["maximum", "minimum"]
    for extreme in mine:
        true = min(exact, key=lambda x: abs(float(x) - extreme.input))
        assert extreme.bracket[0] < true < extreme.bracket[1]
        assert abs(true - extreme.input) < 1e-11
        assert extreme.bracket[1] - extreme.bracket[0] < 1e-10
    for extreme in motion.output_limits:
        if extreme.name != "B.x":
            continue
        sign = -1 if extreme.kind == "maximum" else 1
        best = minimize_scalar(
            lambda t, sign=sign: sign * bar.coupler_end(np.array(t), 1).real,
            bounds=np.radians([extreme.input - 20, extreme.input + 20]),
            method="bounded",
            options={"xatol": 1e-10},
        )
        assert extreme.value == pytest.approx(sign * best.fun, abs=1e-12)


def test_brackets_hold_the_exact_extremes_of_rockers() -> None:
    for number, bar in enumerate(random_crank_rockers(20, seed=5)):
        side = 1 if number % 2 else -1
        motion = four_bar(bar, 50, side, step=60).sweep(limits_of=["rocker"])
        assert len(motion.output_limits) == 2
        exact = [
            side * x + turn for x in exact_extremes(bar) for side in (1, -1) for turn in (0, 360)
        ]

        def off(value: float, x: arb) -> float:
            return abs(float(x) - value)

        for extreme in motion.output_limits:
            true = min(exact, key=partial(off, extreme.input))
            assert extreme.bracket[0] < true < extreme.bracket[1], bar
            assert extreme.bracket[1] - extreme.bracket[0] < 1e-10


@pytest.mark.parametrize("side", [1, -1])
def test_extremes_beside_a_dead_point_are_found_on_every_branch(side: int) -> None:
    bar = FourBar(100.0, 70.0, 120.0, 80.0)
    points = bar.points(math.pi / 2, side)
    a, b = complex(*points["A"]), complex(*points["B"])
    tip = (55 + 70j) / (111 + 46j)
    p = a + (b - a) * tip
    motion = lw.linkage(
        points=points | {"P": (p.real, p.imag)},
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B", "P"),
            "rocker": ("O4", "B"),
        },
        inputs=lw.Input(link="crank", from_=0, to=360, step=10),
    ).sweep(through=True, limits_of=["P.x"])
    assert len(motion.output_limits) == 4
    names = {limit: motion.branch[row] for row, limit in enumerate(motion.limit) if limit}
    assert names["maximum of P.x"] != ""
    for extreme in motion.output_limits:
        assert extreme.located
        theta = np.radians(extreme.input + np.array([-1e-3, 0, 1e-3]))
        sign = -1 if extreme.kind == "maximum" else 1

        def height(assembly: int, theta: Array = theta) -> Array:
            ends = bar.crank_end(theta), bar.coupler_end(theta, assembly)
            return np.asarray((ends[0] + (ends[1] - ends[0]) * tip).real)

        def off(h: Array, wanted: float = extreme.value) -> float:
            return float(abs(h[1] - wanted))

        x = min((height(s) for s in (1, -1)), key=off)
        assert x[1] == pytest.approx(extreme.value, abs=1e-9)
        assert sign * x[1] < sign * x[0]
        assert sign * x[1] < sign * x[2]
    # the largest value is an eighth of a degree beside the dead point, on one of the branches
    largest = max(motion.output_limits, key=lambda e: e.value)
    assert 0 < largest.input - 18.1948723388 < 0.125
    assert np.nanmax(motion["P.x"]) == pytest.approx(largest.value, abs=1e-9)


@pytest.mark.parametrize("step", [1, 10, 60])
def test_extremes_between_the_last_row_and_a_dead_point_are_found(step: float) -> None:
    # the height of a point of the coupler on both branches, against a dense table
    mechanism = four_bar(FOLDING, 90, step=step)
    motion = mechanism.sweep(through=True, limits_of=["coupler"])
    dense = np.linspace(DEAD, 360 - DEAD, 20001)[1:-1]
    wanted = []
    for side in (1, -1):
        e3, _ = FOLDING.phasors(np.radians(dense), side)
        angle = np.degrees(np.unwrap(np.angle(e3)))
        slope = np.diff(angle)
        wanted += [dense[k + 1] for k in np.flatnonzero(slope[:-1] * slope[1:] < 0)]
    found = [extreme.input for extreme in motion.output_limits]
    assert len(wanted) == 2
    np.testing.assert_allclose(sorted(found), sorted(wanted), rtol=0, atol=0.03)
    for extreme in motion.output_limits:
        assert len(limit_rows(motion, f"{extreme.kind} of coupler")) == 1
        assert extreme.located


@pytest.mark.parametrize("through", [False, True])
def test_what_turns_back_together_with_the_input_has_its_extreme_at_the_dead_point(
    through: bool,
) -> None:
    motion = four_bar(FOLDING, 90, step=10).sweep(
        through=through, limits_of=["crank", "A.x", "B.x"]
    )
    low, high = (limit.input for limit in motion.limits)
    found = {(e.name, e.kind, e.input): e for e in motion.output_limits}
    assert found["crank", "minimum", low].value == pytest.approx(DEAD, abs=TINY)
    assert found["crank", "maximum", high].value == pytest.approx(360 - DEAD, abs=TINY)
    for end in (low, high):
        extreme = found["A.x", "maximum", end]
        assert extreme.value == pytest.approx(11 / 8, abs=1e-13)  # 2 cos of 11/16
        assert extreme.located
        assert extreme.bracket[0] < end < extreme.bracket[1]
    # each of them once, and nothing that moves on through the dead point
    assert sum(e.name == "crank" for e in motion.output_limits) == 2
    assert sum(e.name == "A.x" and e.kind == "maximum" for e in motion.output_limits) == 2
    assert not [e for e in motion.output_limits if e.name == "B.x" and e.input in (low, high)]


def test_limits_are_named_by_the_inputs_of_their_rows() -> None:
    for start in (0, 360, -720):
        table = {"from_": start, "to": start + 360, "step": 10}
        motion = four_bar(FOLDING, 90, **table).sweep(through=True, limits_of=["coupler"])
        rows: dict[str, set[float]] = {limit: set() for limit in motion.limit}
        for limit, value in zip(motion.limit, motion["crank"], strict=True):
            rows[limit].add(float(value))
        assert {limit.input for limit in motion.limits} <= rows["dead point"]
        assert all(start <= limit.input <= start + 360 for limit in motion.limits)
        for extreme in motion.output_limits:
            assert extreme.input in rows[f"{extreme.kind} of coupler"]
        every: list[Any] = [*motion.limits, *motion.output_limits]
        for told in every:
            assert told.bracket[0] <= told.input <= told.bracket[1]
            assert told.bracket[1] - told.bracket[0] < 1e-10


def test_an_extreme_is_told_once_although_the_track_turns_twice() -> None:
    bar = FourBar(4.0, 2.0, 5.0, 3.5)
    motion = four_bar(bar, 90, from_=400, to=760, step=10).sweep(limits_of=["rocker"])
    assert len(motion.output_limits) == 2
    assert motion.added.sum() == 2
    short = four_bar(bar, 90, from_=100, to=110, step=1).sweep(limits_of=["rocker"])
    assert short.output_limits == ()


def test_extremes_beyond_a_change_point_are_those_of_the_chosen_branch() -> None:
    bar = FourBar(4.0, 1.0, 3.0, 2.0)
    mechanism = four_bar(bar, 60, step=10)
    motion = mechanism.sweep(change_points="straight", limits_of=["rocker", "coupler"])
    # the coupler has an extreme on the way around, which was not chosen
    assert [extreme.name for extreme in motion.output_limits] == ["rocker", "rocker"]
    around = mechanism.sweep(limits_of=["coupler"])
    assert [round(extreme.input, 2) for extreme in around.output_limits] == [311.81]
    for row in np.flatnonzero([limit.endswith("of rocker") for limit in motion.limit]):
        beyond = motion["crank"][row] > 180
        assert (motion.certification[row] is Certification.BRANCH_CHOSEN) == beyond
        side = -1 if beyond else 1
        assert on_assembly(motion, bar, np.array([row]), side) < 1e-9


# ------------------------------------------------------------------ other inputs


def test_several_inputs_have_limit_rows_in_lock_step() -> None:
    mechanism = lw.loops(
        loops={"1": "r*e^(i*a) + l*e^(i*p) = g + r*e^(i*b) + l*e^(i*q)"},
        dimensions={"r": 1.0, "l": 1.2, "g": 2.5},
        guess={"a": 60, "b": 120, "p": 30, "q": 130},
        inputs=(
            lw.Input(variable="a", from_=60, to=260, step=5),
            lw.Input(variable="b", from_=120, to=20, step=-2.5),
        ),
    )
    motion = mechanism.sweep(through=True, limits_of=["p"])
    assert motion.limits
    np.testing.assert_allclose(motion["b"], 120 - 0.5 * (motion["a"] - 60), rtol=0, atol=1e-11)
    for row in limit_rows(motion, "dead point"):
        line = math.sin(math.radians(motion["p"][row] - motion["q"][row]))
        assert abs(line) < 1e-12
        assert motion.certified[row]


def test_plain_equations_have_dead_points_with_proofs() -> None:
    mechanism = lw.plain_equations(
        equations={"1": "x^2 + y^2 = 4", "2": "y = t"},
        guess={"x": 1.9, "y": 0.5, "t": 0.5},
        inputs=lw.Input(variable="t", from_=-3, to=3, step=0.5),
    )
    motion = mechanism.sweep(through=True, limits_of=["x"])
    assert [limit.input for limit in motion.limits] == pytest.approx([-2, 2], abs=1e-12)
    assert motion.certified[motion.found].all()
    assert motion.circuit is CircuitEnd.CLOSED
    names = np.array(motion.branch)
    second = names == "circuit 1 branch 2"
    assert (motion["x"][second] <= 1e-7).all()
    (high, low) = motion.output_limits
    assert (high.kind, low.kind) == ("maximum", "minimum")
    assert (high.value, low.value) == pytest.approx((2, -2), abs=1e-12)


def test_a_slider_as_input_turns_back_at_its_ends() -> None:
    mechanism = lw.loops(
        loops={"1": "e^(i*t) + 3*e^(i*p) = s"},
        guess={"t": 60, "p": -17, "s": 3.3},
        inputs=lw.Input(variable="s", from_=1, to=5, step=0.25),
    )
    motion = mechanism.sweep(through=True)
    assert [limit.input for limit in motion.limits] == [2.0, 4.0]
    assert motion.limit[4] == motion.limit[12] == "dead point"
    assert not motion.added[:17].any()
    assert motion.added.sum() == 9
    for a, b in pairwise(motion["s"][17:]):
        assert b < a
    assert motion.certified[motion.found].all()
