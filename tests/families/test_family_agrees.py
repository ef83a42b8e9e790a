"""Families against the ordinary sweep of every design: row by row, name by name."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb

import linkwork as lw
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.varied_numbers import varied_numbers
from linkwork.core.motion import sweep
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.families import Family, building as open_loops, design_sweep, march as loops
from linkwork.families.family_motion import FamilyMotion
from tests.described import described_as
from tests.families.rate_referee import assert_same_evidence, assert_same_limits, assert_same_rates
from tests.library_mechanisms import driven_examples
from tests.oracles.balls import BallTable, exactly, newton
from tests.thinned import thinned

Array = npt.NDArray[np.float64]
DRIVEN = driven_examples()
#: What the compiled march does not lead through all rows, and why.
ALONE = {
    "balanced-lamp": "no unknowns",
    "door-closer": "no unknowns",
    "double-pendulum": "no unknowns",
    "pendulum": "no unknowns",
    "cam-roller-follower": "a law",
    "curved-slot": "a law",
    "elliptical-gears": "a law",
    "garage-door": "a curve",
}
#: Whose guess lies beside the table's path of inputs.
BESIDE = ("excavator", "five-bar-robot", "kempe-translator", "three-rpr")
#: Tables that end right at a dead point: the steps in front of it get too small for the march.
NEARLY_DEAD = ("chebyshev",)


def family_of(name: str, *factors: float) -> Family:
    """A mechanism with its first number times some factors."""
    mechanism = lw.example(name)
    own = mechanism.description
    quantity = next(q for q in varied_numbers(own) if abs(q.of(own)) > 1e-9)
    return mechanism.family({quantity.name: quantity.of(own) * np.array(factors)})


def by_itself(family: Family, k: int, certify: bool = True) -> Motion:
    """A design's own sweep, over the table that all of the family share."""
    model = family.designs.design(k)
    base = family.designs.base
    if not np.array_equal(model.rows_in_file_units, base.rows_in_file_units):
        number = base.description.numbers
        inputs = []
        for which in base.description.inputs:
            start, stop, step = which.from_, which.to, which.step
            assert start is not None
            assert stop is not None
            assert step is not None
            inputs.append(replace(which, from_=number(start), to=number(stop), step=number(step)))
        description = replace(model.description, inputs=tuple(inputs))
        model = Model(description, model.equations, model.compiled, model.skeleton, model.branch)
    return sweep(model, certify=certify)


def assert_agrees(family: Family, motion: FamilyMotion, certify: bool = True) -> None:
    """Statuses, certification, unknowns and everything named, design by design."""
    for k in range(len(family)):
        if family.designs.problem[k]:
            assert (motion.status[k] == Status.NO_START.code).all()
            assert not motion.found[k].any()
            assert np.isnan(motion.rows.v[:, :, k]).all()
            assert motion.message(k)
            continue
        alone = by_itself(family, k, certify)
        asked = alone.asked
        status = np.array([status.code for status in alone.status])[asked]
        np.testing.assert_array_equal(motion.status[k], status)
        told = np.array([c.code for c in alone.certification])[asked]
        np.testing.assert_array_equal(motion.certification[k], told)
        np.testing.assert_array_equal(motion.found[k], alone.found[asked])
        np.testing.assert_array_equal(motion.certified[k], alone.certified[asked])
        proved = motion.certified[k]
        assert (motion.radius[k][proved] < 1e-3).all()
        _assert_same_place(family, motion, k, alone)
        _assert_same_names(family, motion, k, alone)
        assert_same_rates(motion, k, alone)
        assert_same_evidence(motion, k, alone)
        assert_same_limits(motion, k, alone)


def _assert_same_place(family: Family, motion: FamilyMotion, k: int, alone: Motion) -> None:
    n = family.designs.base.compiled.solver.unknowns
    weights = family.designs.design(k).compiled.solver.variable_scale[:n]
    own, other = motion.rows.v[:, :, k].T, alone.q[alone.asked]
    assert np.isnan(own[~motion.found[k]]).all()
    radius = np.where(motion.certified[k], motion.radius[k] + alone.radius[alone.asked], 1e-9)
    off = np.abs((own - other) / weights).max(axis=1, initial=0.0)[motion.found[k]]
    assert (off <= radius[motion.found[k]]).all()


def _assert_same_names(family: Family, motion: FamilyMotion, k: int, alone: Motion) -> None:
    there, scale = motion.found[k], max(float(family.designs.length_scale[k]), 360.0)
    tables = (alone.inputs, alone.unknowns, alone.links, alone.sliders, alone.outputs)
    places = [f"{point}.{axis}" for point in alone.points for axis in "xy"]
    for name in dict.fromkeys([*(name for table in tables for name in table), *places]):
        own, other = motion[name], alone[name][alone.asked]
        assert own.shape == motion.status.shape
        np.testing.assert_allclose(
            own[k][there], other[there], rtol=1e-9, atol=1e-9 * scale, err_msg=name
        )
        if name not in alone.inputs:
            assert np.isnan(own[k][~there]).all(), name
        else:
            np.testing.assert_array_equal(own[k], other)
    for point in family.designs.base.equations.points:
        place = motion.trace(point)[k]
        np.testing.assert_array_equal(place.real, motion[f"{point}.x"][k])
        np.testing.assert_array_equal(place.imag, motion[f"{point}.y"][k])


# ------------------------------------------------------------------ the library


@pytest.mark.parametrize("name", thinned(DRIVEN))
def test_library_mechanisms_move_together_as_each_by_itself(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if DRIVEN.index(name) % 2:  # as designs of a large family: in step
        monkeypatch.setattr("linkwork.families.march.sweep_kernel._FEW", 0)
    family = family_of(name, 0.999, 1.001)
    motion = family.sweep()
    assert motion.status.shape == motion.radius.shape == (2, len(motion.inputs))
    assert_agrees(family, motion)
    fine = family.designs.problem == 0
    if name not in (*ALONE, *NEARLY_DEAD) and motion.found[fine].all():
        assert not motion.rows.alone.any()
        assert motion.certified[fine].all()


def test_nobody_is_named_as_going_alone_who_does_not() -> None:
    for name in ALONE:
        assert family_of(name, 0.999).sweep(certify=False).rows.alone.all(), name


@pytest.mark.parametrize("name", ["four-bar", "jansen-leg", "slider-crank", "chebyshev", "evans"])
def test_without_proofs_the_motions_are_the_same(name: str) -> None:
    family = family_of(name, 0.99, 1.0, 1.01)
    motion = family.sweep(certify=False)
    assert_agrees(family, motion, certify=False)
    assert (motion.certification == Certification.NOT_ASKED.code).all()
    assert np.isnan(motion.radius).all()


@pytest.mark.parametrize(("few", "expected"), [(0, "in_step"), (4, "march")])
@pytest.mark.parametrize("name", ["rapier-drive", "jansen-leg", "slider-input", "rack-steering"])
def test_every_loop_finds_the_same_rows(
    name: str, few: int, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("linkwork.families.march.sweep_kernel._FEW", few)
    ways: list[str] = []

    def noted(way: str, inner: Callable[..., int], *arguments: object) -> int:
        ways.append(way)
        return inner(*arguments)

    for way in ("in_step", "march"):
        monkeypatch.setattr(loops, way, partial(noted, way, getattr(loops, way)))
    family = family_of(name, 0.998, 1.002)
    motion = family.sweep()
    assert ways[0] == expected
    assert motion.certified.all()
    assert_agrees(family, motion)


@pytest.mark.parametrize("name", ["andrews-squeezer", "klann-leg", "slider-input", "rack-steering"])
def test_every_radius_of_the_library_holds_a_true_position(name: str) -> None:
    family = family_of(name, 0.998, 1.002)
    motion = family.sweep()
    rng = np.random.default_rng(5)
    for k in range(len(family)):
        model = family.designs.design(k)
        balls = BallTable(model.compiled.table)
        n = model.compiled.solver.unknowns
        for row in rng.choice(np.flatnonzero(motion.certified[k]), 4, replace=False):
            v = [*motion.rows.v[:, row, k], *model.rows[row]]
            root, proved = newton(balls, exactly(v))
            assert proved
            for i in range(n):
                off = abs(root[i] - arb(float(v[i])))
                assert off <= arb(float(motion.radius[k, row])) * balls.weights[i]


# ------------------------------------------------------------------ trouble


@pytest.mark.parametrize("certify", [False, True])
@pytest.mark.parametrize("step", [1, 5])
@pytest.mark.parametrize("apart", [1e-3, 1e-6, 1e-10])
def test_near_crossings_are_not_passed_straight(apart: float, step: float, certify: bool) -> None:
    """Crank-rockers whose branches come near to each other at 180 deg; no row lies there."""
    frame = 4.5 - apart
    mechanism = lw.linkage(
        points={"A": (0, 0), "B": (0, 1), "C": (3, 2), "D": (frame, 0)},
        links={"a": ["A", "B"], "b": ["B", "C"], "c": ["C", "D"], "ground": ["A", "D"]},
        lengths={"A B": 1, "B C": 2.5, "C D": 3},
        inputs=lw.Input(link="a", from_=step / 2, to=360 + step / 2, step=step),
    )
    motion, alone = mechanism.family({"A B": [1.0]}).sweep(certify=certify), mechanism.sweep()
    assert motion.found.all()
    for name in ("b", "c"):  # the other branch is 0.2 degrees away, or more
        assert np.abs(motion[name][0] - alone[name]).max() < 1e-6


def test_designs_with_limits_change_points_problems_and_without_numbers() -> None:
    four_bar = lw.example("four-bar")  # 40, 120, 80, 100
    family = four_bar.family({"A B": [120.0, 60.0, 100.0, 40.0, math.nan, 1e4, 120.0, -5.0]})
    motion = family.sweep()
    assert_agrees(family, motion)
    assert motion.found[[0, 6]].all()  # good ones among bad ones
    told = {Status.of_code(int(code)) for code in np.unique(motion.status)}
    assert {Status.CONVERGED, Status.OUT_OF_REACH, Status.NO_START} <= told
    assert motion.counts.total() == motion.status.size


def test_rows_right_in_front_of_dead_points_are_found() -> None:
    # |O4 A| = b - c at the dead point, of which the row of 14 deg is so far away
    away = np.array([2e-3, 1e-4, 1e-5])  # deg
    a, c, d = 60.0, 60.0, 100.0
    b = c + np.sqrt(a**2 + d**2 - 2 * a * d * np.cos(np.radians(14.0 - away)))
    family = lw.example("four-bar").family({"O2 A": a, "A B": b, "O4 B": c})
    motion = family.sweep()
    assert not motion.rows.alone.any()
    assert motion.certified[:, 14].all()
    np.testing.assert_allclose(motion.limits.lower, 14.0 - away, rtol=0, atol=1e-9)
    assert_agrees(family, motion)


def test_change_points_stop_designs_as_they_do_by_themselves() -> None:
    mechanism = lw.example("parallelogram").driven_by(link="crank", from_=5, to=355, step=5)
    length = described_as(Linkage, mechanism).lengths["O2 A"]
    family = mechanism.family({"O2 A": length * np.array([1.0, 1.0001, 0.99])})
    motion = family.sweep()
    assert_agrees(family, motion)
    assert Status.CHANGE_POINT.code in motion.status


def test_descending_tables_and_starts_outside_the_table() -> None:
    four_bar = lw.example("four-bar")
    for start, stop, step in ((200.0, 100.0, -5.0), (400.0, 700.0, 7.0), (-700.0, -400.0, 9.0)):
        driven = four_bar.driven_by(link="crank", from_=start, to=stop, step=step)
        family = driven.family({"A B": [119.0, 120.0, 121.0]})
        motion = family.sweep()
        assert_agrees(family, motion)
        assert motion.certified.all()
        assert not motion.rows.alone.any()


def two_inputs(begin: float, there: float, slow: float = 1.0) -> lw.Mechanism:
    """A five-bar whose cranks turn in lock-step, the first so many times slower."""
    return lw.loops(
        angle="rad",
        loops={"1": "r*e^(i*a) + l*e^(i*p) = g + r*e^(i*b) + l*e^(i*q)"},
        dimensions={"r": 1.0, "l": 2.0, "g": 1.5},
        guess={"a": begin, "b": there, "p": 0.7, "q": 2.0},
        inputs=(
            lw.Input(variable="a", from_=begin, to=begin + 0.2 / slow, step=0.01 / slow),
            lw.Input(variable="b", from_=there, to=there + 0.2, step=0.01),
        ),
    )


def test_two_inputs_in_lock_step_are_proved_at_the_inputs_asked_for() -> None:
    # b = 1e4 (a - 1) + 0.1: the rounding of a is that of b times 1e4
    mechanism = two_inputs(1.0, 0.1, slow=1e4)
    family = mechanism.family({"l": [2.0, 2.01]})
    motion = family.sweep()
    assert not motion.rows.alone.any()
    assert motion.certified.all()
    assert_agrees(family, motion)
    for k in range(2):
        model = family.designs.design(k)
        balls = BallTable(model.compiled.table)
        for row in range(0, len(motion.inputs), 4):
            v = [*motion.rows.v[:, row, k], *model.rows[row]]
            root, proved = newton(balls, exactly(v))
            assert proved
            off = max(abs(x - arb(float(y))) for x, y in zip(root[:2], v[:2], strict=True))
            assert off <= arb(float(motion.radius[k, row]))


def test_rows_a_whole_turn_away_count_the_rounding_of_two_pi() -> None:
    # a crank that reaches ±131°: rows from 229° on are found a turn away
    family = lw.example("four-bar").family({"A B": [50.0, 40.0]})
    motion = family.sweep()
    assert_agrees(family, motion)
    for k in range(2):
        rows = np.flatnonzero(motion.certified[k] & (motion.inputs[:, 0] > 300))
        assert len(rows)
        model = family.designs.design(k)
        balls = BallTable(model.compiled.table)
        for row in rows[::5]:
            v = [*motion.rows.v[:, row, k], *model.rows[row]]
            root, proved = newton(balls, exactly(v))
            assert proved
            off = max(abs(x - arb(float(y))) for x, y in zip(root[:2], v[:2], strict=True))
            assert off <= arb(float(motion.radius[k, row]))


def test_all_designs_keep_to_the_table_of_the_family() -> None:
    # the range of the input depends on what varies: 180/n - 90 to 90 - 180/n
    family = lw.example("geneva-drive").family({"n": [4.0, 5.0, 6.0]})
    motion = family.sweep()
    assert_agrees(family, motion)
    mechanism = two_inputs(1.0, 0.5).changed(
        dimensions={"r": 1.0, "l": 2.0, "g": 1.5, "top": 1.2},
        inputs=(
            lw.Input(variable="a", from_=1.0, to="top", step=0.01),
            lw.Input(variable="b", from_=0.6, to=0.6),
        ),
    )  # whose guess lies beside the table
    family = mechanism.family({"top": [1.2, 1.3, 1.1]})
    motion = family.sweep()
    assert not motion.rows.alone.any()
    assert motion.found.all()
    np.testing.assert_allclose(motion["p"][1], motion["p"][0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", BESIDE)
def test_starts_beside_the_path_are_led_to_it_together(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    family = family_of(name, 0.999, 1.0, 1.001)
    for certify in (True, False):
        motion = family.sweep(certify=certify)
        assert not motion.rows.alone.any()
        assert_agrees(family, motion, certify)
    monkeypatch.setattr("linkwork.families.family_march._CHUNK", 1)  # one design after the other
    again = family.sweep(certify=False)
    np.testing.assert_array_equal(again.rows.v, motion.rows.v)


def test_starts_that_cannot_be_led_to_the_path_go_alone() -> None:
    # between the start and the nearest row the cranks lock; other rows may be reached
    mechanism = two_inputs(1.0, 0.5).changed(
        dimensions={"r": 1.0, "l": 1.2, "g": 1.5},
        guess={"a": 1.0, "b": 0.5, "p": 0.7, "q": 2.0},
        inputs=(
            lw.Input(variable="a", from_=3.0, to=3.3, step=0.1),
            lw.Input(variable="b", from_=0.0, to=0.0),
        ),
    )
    family = mechanism.family({"l": [1.2, 2.6, 1.3]})
    motion = family.sweep()
    assert motion.rows.alone.tolist() == [True, False, True]
    assert_agrees(family, motion)
    assert motion.found[1].all()


def test_threads_and_parts_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    family = lw.example("slider-crank").family({"A B": np.linspace(90.0, 110.0, 150)})
    whole = family.sweep(threads=1)
    monkeypatch.setattr("linkwork.families.march.sweep_kernel.MOST_DESIGNS", 64)
    parted = family.sweep(threads=3)
    np.testing.assert_array_equal(parted.rows.v, whole.rows.v)
    np.testing.assert_array_equal(parted.radius, whole.radius)
    np.testing.assert_array_equal(parted.status, whole.status)


def test_starts_at_dead_points_and_change_points() -> None:
    flat = lw.loops(
        loops={"1": "r*e^(i*a) + l*e^(i*p) = l*c + r*e^(i*q)"},
        dimensions={"r": 1.0, "l": 3.0, "c": 1.0},
        guess={"a": 0, "p": 0, "q": 0},
        inputs=lw.Input(variable="a", from_=0, to=90, step=30),
    )
    dead = lw.loops(
        loops={"1": "r*e^(i*t) + l*e^(i*p) = x"},
        dimensions={"r": 1.0, "l": 3.0},
        guess={"t": 0, "p": 0, "x": 4.0},
        inputs=lw.Input(variable="x", from_=4.0, to=3.0, step=-0.25),
    )
    for mechanism in (flat, dead):
        for certify in (True, False):
            family = mechanism.family({"l": [3.0, 3.001]})
            motion = family.sweep(certify=certify)
            assert_agrees(family, motion, certify)
            assert Status.START_SINGULAR.code in motion.status[0]


def test_steps_that_are_lost_in_rounding_end_the_march() -> None:
    # at 1e17 the next float is 16 away; a march that went on with steps of 1 would never end
    far = lw.loops(
        loops={"yoke": "y + i*z = x + i*r"},
        dimensions={"r": 1.0},
        guess={"y": 1e17, "z": 1.0, "x": 1e17},
        inputs=lw.Input(variable="x", from_=1e17, to=1e17 + 1000, step=100),
    )
    motion = far.family({"r": [1.0, 2.0]}).sweep()
    assert motion.rows.alone.all()
    np.testing.assert_array_equal(motion.found.sum(axis=1), [1, 1])


def test_a_family_of_one_link_is_moved_without_a_kernel() -> None:
    lamps = lw.example("balanced-lamp").family({"O P": [300.0, 310.0]})
    height = lamps.sweep()["P.y"]
    angles = np.radians(np.ravel(lamps.sweep().inputs))
    np.testing.assert_allclose(height, np.outer([300.0, 310.0], np.sin(angles)), atol=1e-9)


@pytest.mark.parametrize("certify", [True, False])
def test_designs_that_cannot_close_are_left_out_without_being_built(
    monkeypatch: pytest.MonkeyPatch, certify: bool
) -> None:
    """Their rows are those that a sweep of their own finds."""
    bar = lw.example("four-bar")
    short = np.array([1e-3, 0.2, 1.0, 0.3])
    family = bar.family({"A B": 120.0 * short, "O4 B": 80.0 * short})
    monkeypatch.setattr(design_sweep, "stay_open", lambda designs: np.zeros(4, dtype=bool))
    alone = family.sweep(certify=certify)
    monkeypatch.undo()
    monkeypatch.setattr(design_sweep, "sweep_single", lambda *given: pytest.fail("it was built"))
    together = family.sweep(certify=certify)
    no_start = together.status[:, 0] == Status.NO_START.code
    assert no_start.tolist() == [True, True, False, True]
    for name in ("status", "certification", "v", "radius", "limits", "alone"):
        one, other = (np.asarray(getattr(found.rows, name)) for found in (alone, together))
        assert np.array_equal(one, other, equal_nan=name in ("v", "radius", "limits")), name
    assert np.isnan(together.series("B.x").value[0]).all()
    assert together.message(0) == alone.message(0)


def test_a_loop_of_a_sliding_length_or_nearly_closed_is_tried() -> None:
    slider = lw.example("slider-crank")
    assert not open_loops.stay_open(slider.family({"A B": [1.0, 50.0]}).designs).any()
    bar = lw.example("four-bar")
    position = bar.solve()
    reach = math.dist(position.points["A"], (100.0, 0.0))
    coupler = np.array([1 - 1e-3, 1 - 1e-9, 1.0, 1 + 1e-9]) * abs(reach - 80.0)
    found = open_loops.stay_open(bar.family({"A B": coupler}).designs)
    assert found.tolist() == [True, False, False, False]
