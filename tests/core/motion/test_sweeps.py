"""Sweeps whose tables, dead points or equations are unusual."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.results.failure import LimitKind
from tests.oracles.four_bar import FourBar


@pytest.mark.parametrize(
    ("start", "stop", "reached"),
    [(1090, 1400, 8), (-660, -400, 3), (-1400, -1000, 13), (-1080, 1080, 48), (500, 700, 0)],
)
def test_rows_whole_turns_away_are_reached_however_far(
    start: float, stop: float, reached: int
) -> None:
    bar = FourBar(3.0, 2.6, 1.7, 2.2)  # between dead points at 6.2 and 88.0 degrees
    mechanism = lw.linkage(
        points=bar.points(np.radians(40.0), 1),
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B"),
            "rocker": ("O4", "B"),
        },
        inputs=lw.Input(link="crank"),
    )
    motion = mechanism.sweep(from_=start, to=stop, step=10)
    assert motion.found[motion.asked].sum() == reached
    assert motion.certified[motion.found].all()
    exact = bar.coupler_end(np.radians(motion["crank"]), 1)
    rows = motion.found & motion.asked
    assert np.abs(motion["B.x"] + 1j * motion["B.y"] - exact)[rows].max(initial=0.0) < 1e-9
    assert [limit.kind for limit in motion.limits] == [LimitKind.DEAD_POINT] * 2


#: Both turn back within a degree of each other.
FOUR_BAR_WITH_DYAD = {
    "1": "1.1506868993121604*e^(i*t) + 1.4015301927498651*e^(i*p) "
    "= 1.0168797508205394 + 2.6587007529023197*e^(i*q)",
    "2": "1.1506868993121604*e^(i*t) + (1.5918774708532644 - i*2.2387661530443754)*e^(i*p) "
    "+ 3.266084146225838*e^(i*x) "
    "= -0.4233697291303557 + i*2.8947794769492443 + 1.531444418102215*e^(i*y)",
}


def test_three_dead_points_within_one_degree_are_all_passed() -> None:
    # the four-bar turns back at -70.59178 degrees; the dyad on it does at -70.68424, beyond that
    mechanism = lw.loops(
        loops=FOUR_BAR_WITH_DYAD,
        guess={"t": -80.3, "p": -162.8797, "q": 215.5748, "x": 84.4018, "y": 144.3598},
        inputs=lw.Input(variable="t"),
    )
    (circuit, *others) = mechanism.circuits()
    limits = sorted(limit.input for limit in circuit.dead_points)
    assert limits == pytest.approx([-96.1064795848, -70.6842424005, -70.591779558, -70.591779558])
    assert len(circuit.branches) == 4
    assert all(other.input_range[1] > 0.0 for other in others)
    motion = mechanism.sweep(from_=-90, to=-75, step=1)
    assert motion.certified.all()
    found = sorted(limit.input for limit in mechanism.sweep(through=True).limits)
    assert found == pytest.approx([limit + 360 for limit in limits])  # as in the table


def test_rows_that_only_another_branch_of_the_circuit_reaches_say_so() -> None:
    # the dyad turns back within the range of the four-bar, which goes on without it
    mechanism = lw.loops(
        loops=FOUR_BAR_WITH_DYAD,
        guess={"t": -70.65, "p": -159.7, "q": 211.3, "x": 85.9, "y": 148.2},
        inputs=lw.Input(variable="t", from_=-100, to=-60, step=1),
    )
    motion = mechanism.sweep(through=True)
    asked = motion["t"][motion.asked]
    first = [motion.status[k] for k in np.flatnonzero(motion.asked)]
    elsewhere = set(motion["t"][motion.found & motion.added].round(9))
    reasons = {
        status: [t for t, s in zip(asked, first, strict=True) if s is status]
        for status in set(first)
    }
    assert set(reasons[lw.Status.OUT_OF_REACH]) <= elsewhere
    assert not set(reasons[lw.Status.OUT_OF_CIRCUIT]) & elsewhere
    assert reasons[lw.Status.OUT_OF_REACH]
    assert reasons[lw.Status.OUT_OF_CIRCUIT]


def test_a_single_equation_is_followed_through_its_dead_points() -> None:
    circle = lw.plain_equations(
        equations={"F": "x^2 + y^2 - 1 = 0"},
        guess={"x": 1, "y": 0.1},
        inputs=lw.Input(variable="y", from_=-2, to=2, step=0.125),
    )
    motion = circle.sweep(through=True)
    assert motion.circuit is lw.CircuitEnd.CLOSED
    assert [limit.input for limit in motion.limits] == [-1.0, 1.0]
    x, y = motion["x"][motion.found], motion["y"][motion.found]
    assert np.abs(x * x + y * y - 1.0).max() < 1e-12
    assert ((x > 1e-3).sum(), (x < -1e-3).sum()) == (15, 15)


def test_a_position_that_was_followed_counts_the_iterations_on_the_way() -> None:
    mechanism = lw.example("four-bar")
    near, far, home = mechanism.solve(at=61), mechanism.solve(at=200), mechanism.solve()
    assert home.iterations == mechanism.solve(at=home.input["crank"]).iterations
    assert home.iterations < near.iterations < far.iterations
    beside = mechanism.solve(at=home.input["crank"] + 1.0)
    assert home.iterations < beside.iterations <= home.iterations + 3
    direct = mechanism.solve(at=61, from_guess=True)
    assert direct.iterations < near.iterations  # without the guess's own position
    assert direct["rocker"] == pytest.approx(near["rocker"], abs=1e-11)


@pytest.mark.parametrize(
    ("start", "stop", "crossed"),
    [
        (5, 1075, (360, 720)),
        (1075, 5, (360, 720)),
        (0, 1440, (360, 720, 1080)),
        (360, 720, (360,)),  # the guess lies before the table, at 90 deg
        (-720, 360, (-360, 0)),
    ],
)
def test_straight_through_change_points_every_lap_goes_on_from_the_last(
    start: float, stop: float, crossed: tuple[float, ...]
) -> None:
    """Two turns of the crank are one of the follower: in 5 deg of the crank it moves 5 deg most."""
    step = 5 if stop > start else -5
    motion = lw.example("galloway").sweep(from_=start, to=stop, step=step, change_points="straight")
    assert motion.found.all()
    for name in motion.unknowns:
        assert np.abs(np.diff(motion[name])).max() < 5
    assert [limit.input for limit in motion.limits if limit.passed] == list(crossed)
    at = np.array(motion.limit) == "change point"
    assert set(motion["crank"][at]) >= {x for x in crossed if min(start, stop) <= x}
    # on the crank's line, both long links over each other: half of the crank's turns
    for name in motion.unknowns:
        np.testing.assert_allclose(motion[name][at], motion["crank"][at] / 2, atol=1e-9)


def test_around_through_a_whole_turn_rows_of_change_points_belong_to_those_beside_them() -> None:
    """Without a way across, every turn repeats the one of the guess, up to its end."""
    motion = lw.example("galloway").sweep(from_=5, to=720, step=5)
    at = {float(x): k for k, x in enumerate(motion["crank"])}
    for name in motion.unknowns:
        assert motion[name][at[360.0]] == pytest.approx(180, abs=1e-9)
        assert motion[name][at[365.0]] == pytest.approx(motion[name][at[5.0]], abs=1e-9)
        assert motion[name][at[720.0]] == pytest.approx(180, abs=1e-9)
    assert [motion.limit[at[x]] for x in (360.0, 720.0)] == ["change point"] * 2
