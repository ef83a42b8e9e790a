"""The mechanisms on which other programs fail silently, at four steps: every row is right.

Each fixture is compared row by row with a closed form; rows that have no position say why.
"""

from __future__ import annotations

import cmath
import math

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.core.results.failure import LimitKind
from tests.core.failures.test_positions_that_do_not_exist import four_bar
from tests.oracles.circles import Jansen, SliderCrank
from tests.oracles.four_bar import FourBar

Angles = npt.NDArray[np.float64]
STEPS = (0.1, 1, 10, 60)
CLOSE = 1e-9  # of lengths near one; near a dead point errors grow to the root of rounding
NEAR_SINGULAR = 1e-6


def count(step: float) -> int:
    return round(360 / step) + 1


def table(step: float) -> Angles:
    return np.asarray(np.arange(count(step)) * step, dtype=float)


def strictly_inside(angles: Angles, low: float, high: float) -> npt.NDArray[np.bool_]:
    """Rows between two limits, whole turns aside, and not on them."""
    turned = np.remainder(angles - low, 360.0)
    return (turned > 1e-9) & (turned < high - low - 1e-9)


def phasors_of(motion: lw.Motion, name: str) -> npt.NDArray[np.complex128]:
    return np.exp(1j * np.radians(motion[name]))


def assert_four_bar(motion: lw.Motion, bar: FourBar, side: int) -> None:
    """Every found row is on one side, by the closed form."""
    found = motion.found
    e3, e4 = bar.phasors(np.radians(motion["crank"][found]), side)
    known = ~np.isnan(e4)  # on a dead point rounding may leave the closed form without a root
    assert known.sum() >= found.sum() - 2
    for name, exact in (("coupler", e3), ("rocker", e4)):
        off = np.abs(phasors_of(motion, name)[found] - exact)[known]
        near = motion.condition[found][known] > 1e5
        assert (off[~near] < CLOSE).all()
        assert (off[near] < NEAR_SINGULAR).all()


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("ground", [2.0, 3.0])
def test_parallelograms_stop_at_their_change_points_and_never_flip(
    ground: float, step: float
) -> None:
    motion = four_bar(1, ground, 1, ground, at=45).sweep(step=step)
    crank = motion["crank"]
    assert len(motion) == count(step)
    inside, outside = strictly_inside(crank, 0, 180), strictly_inside(crank, 180, 360)
    assert inside.sum() + outside.sum() == count(step) - 3  # 0, 180, 360 themselves
    assert motion.found[inside].all()
    assert motion.certified[inside].all()
    assert {motion.status[k] for k in np.flatnonzero(outside)} == {lw.Status.CHANGE_POINT}
    found = motion.found
    np.testing.assert_allclose(phasors_of(motion, "coupler")[found], 1, rtol=0, atol=NEAR_SINGULAR)
    apart = phasors_of(motion, "rocker") / phasors_of(motion, "crank")
    np.testing.assert_allclose(apart[found], 1, rtol=0, atol=NEAR_SINGULAR)
    assert [limit.input for limit in motion.limits] == [0.0, 180.0]
    assert {limit.kind for limit in motion.limits} == {LimitKind.CHANGE_POINT}


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("side", [1, -1])
def test_a_folding_four_bar_has_one_change_point_at_180_degrees(side: int, step: float) -> None:
    bar = FourBar(4, 1, 3, 2)
    motion = four_bar(1, 3, 2, 4, at=60, side=side).sweep(step=step)
    assert len(motion) == count(step)
    inside = strictly_inside(motion["crank"], -180, 180)
    assert inside.sum() == count(step) - 1
    assert motion.found[inside].all()
    assert motion.certified[inside].all()
    assert_four_bar(motion, bar, side)
    assert [limit.input for limit in motion.limits] == [180.0, 180.0]
    assert {limit.kind for limit in motion.limits} == {LimitKind.CHANGE_POINT}


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("side", [1, -1])
def test_a_non_grashof_four_bar_is_found_between_its_dead_points_and_nowhere_else(
    side: int, step: float
) -> None:
    motion = four_bar(2, 5, 2, 4, side=side).sweep(step=step)
    dead = math.degrees(math.acos(11 / 16))
    crank = motion["crank"]
    asked = motion.asked
    inside = (crank > dead) & (crank < 360 - dead)
    np.testing.assert_array_equal(motion.found[asked], inside[asked])
    lost = {0.1: 932, 1: 94, 10: 10, 60: 2}
    assert (int(asked.sum()), int((~motion.found).sum())) == (count(step), lost[step])
    np.testing.assert_allclose(np.sort(crank[~asked]), [dead, 360 - dead], rtol=1e-14)
    assert {s for s in motion.status if not s.ok} == {lw.Status.OUT_OF_REACH}
    assert motion.certified[motion.found & asked].all()
    assert_four_bar(motion, FourBar(4, 2, 5, 2), side)
    limits = sorted(limit.input for limit in motion.limits)
    assert limits == pytest.approx([dead, 360 - dead], rel=1e-14)


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("side", [1, -1])
def test_a_crank_rocker_keeps_its_branch_at_every_step(side: int, step: float) -> None:
    motion = four_bar(0.5, 1.2, 0.8, 1, at=60, side=side).sweep(step=step)
    assert (len(motion), int(motion.found.sum())) == (count(step), count(step))
    assert motion.certified.all()
    assert_four_bar(motion, FourBar(1, 0.5, 1.2, 0.8), side)


def slider_crank(form: SliderCrank, at: float, side: int) -> lw.Mechanism:
    points = {"O": (0.0, 0.0), **form.points(math.radians(at), side, 5.0)}
    through_pivot = form.base == 0
    start = "O" if through_pivot else "S"
    if through_pivot:
        del points["S"]
    return lw.linkage(
        name="slider-crank",
        points=points,
        links={
            "ground": ["O", *([] if through_pivot else ["S"]), "T"],
            "crank": ["O", "A"],
            "rod": ["A", "B"],
            "block": ["B"],
        },
        lengths={"O A": form.crank, "A B": form.rod},
        sliders=[lw.Slider(name="s", link="block", points=("B",), on="ground", line=(start, "T"))],
        inputs=lw.Input(link="crank"),
    )


SLIDES = {
    "vertical": SliderCrank(1.0, 3.0, 1.5 + 0j, math.pi / 2),
    "steep": SliderCrank(1.0, 3.0, 1.5 + 0j, math.radians(89.99)),
    "through the pivot": SliderCrank(1.0, 2.5, 0j, 0.0),
    "vertical through the pivot": SliderCrank(1.0, 2.5, 0j, math.pi / 2),
}


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("name", SLIDES)
def test_slides_of_any_direction_are_followed_all_around(name: str, side: int, step: float) -> None:
    form = SLIDES[name]
    motion = slider_crank(form, 40, side).sweep(step=step)
    assert (len(motion), int(motion.found.sum())) == (count(step), count(step))
    assert motion.certified.all()
    exact = form.slide(np.radians(motion["crank"]), side)
    np.testing.assert_allclose(motion["s"], exact, rtol=0, atol=CLOSE)


@pytest.mark.parametrize("step", STEPS)
def test_a_rod_as_long_as_the_crank_ends_at_change_points_where_the_block_is_in_the_pivot(
    step: float,
) -> None:
    form = SliderCrank(2.0, 2.0, 0j, 0.0)
    motion = slider_crank(form, 40, 1).sweep(step=step)
    crank = motion["crank"]
    inside, outside = strictly_inside(crank, -90, 90), strictly_inside(crank, 90, 270)
    assert {0.1: 1800, 1: 180, 10: 18, 60: 4}[step] == inside.sum()
    assert motion.found[inside].all()
    assert {motion.status[k] for k in np.flatnonzero(outside)} == {lw.Status.CHANGE_POINT}
    found = motion.found
    exact = 4 * np.cos(np.radians(crank[found]))
    np.testing.assert_allclose(motion["s"][found], exact, rtol=0, atol=NEAR_SINGULAR)
    assert [limit.input for limit in motion.limits] == [270.0, 90.0]
    assert {limit.kind for limit in motion.limits} == {LimitKind.CHANGE_POINT}


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("ground", [2.0, 0.5])
def test_a_slot_through_a_pivot_is_followed_all_around(ground: float, step: float) -> None:
    a = cmath.exp(1j)
    end = ground + 2 * (a - ground)
    mechanism = lw.linkage(
        points={"O": (0, 0), "A": (a.real, a.imag), "Q": (ground, 0), "P": (end.real, end.imag)},
        links={"ground": ["O", "Q"], "crank": ["O", "A"], "rocker": ["Q", "P"]},
        lengths={"O A": 1},
        slots=[lw.Slot(name="s", point="A", on="rocker", line=("Q", "P"))],
        inputs=lw.Input(link="crank"),
    )
    motion = mechanism.sweep(step=step)
    assert (len(motion), int(motion.found.sum())) == (count(step), count(step))
    assert motion.certified.all()
    exact = np.exp(1j * np.radians(motion["crank"])) - ground
    np.testing.assert_allclose(motion["s"], np.abs(exact), rtol=0, atol=CLOSE)
    off = phasors_of(motion, "rocker") - exact / np.abs(exact)
    np.testing.assert_allclose(off, 0, rtol=0, atol=CLOSE)


@pytest.mark.parametrize("step", STEPS)
def test_three_collinear_joints_on_one_link_are_solved(step: float) -> None:
    # a second rocker hangs on the coupler's middle joint
    bar = FourBar(100, 28, 85, 70)
    crank = math.radians(45)
    places = bar.points(crank, 1)
    a, b = (complex(*places[name]) for name in "AB")
    c = a + (b - a) * 40 / 85
    mechanism = lw.linkage(
        points={
            **places,
            "C": (c.real, c.imag),
            "D": (c.real + 60, c.imag + 50),
            "E": (c.real, c.imag + 100),
        },
        links={
            "ground": ["O2", "O4", "E"],
            "crank": ["O2", "A"],
            "coupler": ["A", "B", "C"],
            "rocker": ["O4", "B"],
            "hanger": ["C", "D"],
            "arm": ["E", "D"],
        },
        lengths={"O2 A": 28, "A B": 85, "O4 B": 70, "A C": 40, "C B": 45},
        inputs=lw.Input(link="crank"),
    )
    motion = mechanism.sweep(step=step)
    assert (len(motion), int(motion.found.sum())) == (count(step), count(step))
    assert motion.certified.all()
    assert_four_bar(motion, bar, 1)
    on_line = motion.trace("A") + phasors_of(motion, "coupler") * 40
    np.testing.assert_allclose(motion.trace("C"), on_line, rtol=0, atol=1e-9)


@pytest.mark.parametrize("step", STEPS)
def test_the_jansen_leg_has_mobility_one_and_walks_its_path(step: float) -> None:
    leg = lw.example("jansen-leg")
    report = leg.check()
    assert (report.mobility_count, report.mobility_rank) == (1, 1)
    motion = leg.sweep(step=step)
    assert (len(motion), int(motion.found.sum())) == (count(step), count(step))
    assert motion.certified.all()
    exact = Jansen().foot(np.radians(motion["crank"]))
    np.testing.assert_allclose(motion.trace("F"), exact, rtol=0, atol=1e-9)


@pytest.mark.parametrize("step", STEPS)
def test_a_link_too_short_leaves_every_row_without_a_position_and_says_why(step: float) -> None:
    motion = four_bar(2, 1, 0.5, 4).sweep(step=step)
    assert (len(motion), int(motion.found.sum())) == (count(step), 0)
    assert set(motion.status) == {lw.Status.NO_START}
    failure = motion.failure
    assert failure is not None
    assert failure.loops == ("O2 A B O4",)
    # the crank's end is √(2² + 4²) from O4 at its own 90°, and nowhere nearer than 2
    assert failure.gap == pytest.approx(math.hypot(2, 4) - 1.5, rel=1e-12)
    assert failure.unreachable
