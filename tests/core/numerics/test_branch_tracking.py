"""Following a branch: it arrives, it ends at dead and change points, it never changes branch."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from linkwork import Input, Mechanism, Status, linkage
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import (
    InputPath,
    Node,
    Track,
    _Trial,
    follow,
    node_at,
    rows_on_track,
)
from linkwork.core.numerics.marching import Attempt
from tests.core.numerics.systems import blocks_of, four_bar_table
from tests.oracles.four_bar import FourBar, random_crank_rockers
from tests.thinned import thinned

Array = npt.NDArray[np.float64]
PATH = InputPath(origin=np.zeros(1), rate=np.ones(1))
ROCKER = FourBar(4.0, 2.0, 5.0, 3.5)
FOLDING = FourBar(4.0, 2.0, 5.0, 2.0)
# A position of a well-conditioned four-bar is exact to its residual, 1e-14, times its condition.
CLOSE = 1e-11


def start_of(bar: FourBar, theta: float, side: int) -> tuple[BlockSolver, Node]:
    solver = blocks_of(four_bar_table(bar))
    e3, e4 = bar.phasors(np.array(theta), side)
    v = np.array([np.angle(e3), np.angle(e4), theta])
    return solver, node_at(solver, PATH, theta, v)


def off_branch(bar: FourBar, v: Array, side: int) -> float:
    """Largest distance of exp(i θ3), exp(i θ4) from the closed form."""
    e3, e4 = bar.phasors(v[:, 2], side)
    return float(
        max(np.abs(np.exp(1j * v[:, 0]) - e3).max(), np.abs(np.exp(1j * v[:, 1]) - e4).max())
    )


@pytest.mark.parametrize("goal", [7.0, -9.5, 1.0 + 1e-9, 25.0])
@pytest.mark.parametrize("side", [1, -1])
def test_a_track_arrives_exactly_at_its_goal_on_its_branch(goal: float, side: int) -> None:
    solver, start = start_of(ROCKER, 1.0, side)
    seen: list[float] = []

    def see(_: Node, after: Node) -> bool:
        seen.append(after.t)
        return False

    nodes, end = follow(solver, PATH, start, goal, watch=see)
    assert end is None
    assert nodes[-1].t == goal
    assert seen == [node.t for node in nodes]
    assert np.all(np.diff([start.t, *seen]) * math.copysign(1.0, goal - 1.0) > 0)
    assert off_branch(ROCKER, np.stack([node.v for node in nodes]), side) < CLOSE


def test_a_track_to_where_it_stands_has_no_steps() -> None:
    solver, start = start_of(ROCKER, 1.0, 1)
    assert follow(solver, PATH, start, 1.0) == ([], None)


def test_nodes_carry_the_derivatives_of_the_branch() -> None:
    _, start = start_of(ROCKER, 1.0, 1)
    h = 1e-2
    places = 1.0 + h * np.arange(-4, 5)
    angle = np.unwrap([cmath.phase(e) for e in ROCKER.phasors(places, 1)[1]])
    # central differences of eighth and sixth order: truncation below 1e-12 at this step
    slope = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    bend = np.array([0, 1 / 90, -3 / 20, 3 / 2, -49 / 18, 3 / 2, -3 / 20, 1 / 90, 0])
    assert start.first[1] == pytest.approx(slope @ angle / h, abs=1e-11)
    assert start.second[1] == pytest.approx(bend @ angle / h**2, abs=1e-9)
    assert start.first[2] == 1.0
    assert start.second[2] == 0.0


@pytest.mark.parametrize("side", [1, -1])
def test_a_track_ends_at_the_dead_point(side: int) -> None:
    (dead,) = FOLDING.dead_points()
    assert dead == pytest.approx(math.acos(11 / 16), rel=1e-15)
    solver, start = start_of(FOLDING, 2.0, side)
    for goal, limit in ((0.0, dead), (2 * math.pi, 2 * math.pi - dead)):
        nodes, end = follow(solver, PATH, start, goal)
        assert end is not None
        assert end.status is Status.OUT_OF_REACH
        assert end.reached == pytest.approx(limit, abs=1e-10)
        assert end.reached == nodes[-1].t
        assert abs(end.failed - end.reached) < 2e-12
        for node in nodes:  # a small part of the square root of the distance that is left
            close = CLOSE + 0.05 * math.sqrt(abs(node.t - limit))
            assert off_branch(FOLDING, node.v[None, :], side) < close


def test_a_track_from_a_dead_point_says_that_its_start_is_singular() -> None:
    (dead,) = FOLDING.dead_points()
    solver = blocks_of(four_bar_table(FOLDING))
    a = 2.0 * np.exp(1j * dead)
    v = np.array([np.angle(4.0 - a), np.angle(4.0 - a), dead])
    nodes, end = follow(solver, PATH, node_at(solver, PATH, dead, v), 2.0)
    assert nodes == []
    assert end is not None
    assert (end.reached, end.failed, end.status) == (dead, dead, Status.START_SINGULAR)


@pytest.mark.parametrize("away", [0.0, 1e-9, -1e-7])
def test_a_track_from_a_change_point_does_not_choose_a_branch(away: float) -> None:
    solver = blocks_of(four_bar_table(FourBar(2.0, 1.0, 2.0, 1.0)))
    start = node_at(solver, PATH, away, np.array([0.0, away, away]))
    nodes, end = follow(solver, PATH, start, 1.0)
    assert nodes == []
    assert end is not None
    assert end.status is Status.START_SINGULAR


def test_rows_between_nodes_are_the_positions_of_the_branch() -> None:
    solver, start = start_of(ROCKER, 1.0, -1)
    nodes, end = follow(solver, PATH, start, 8.0)
    assert end is None
    t = np.linspace(1.0, 8.0, 701)
    rows = rows_on_track(solver, PATH, Track(nodes=(start, *nodes), start=0), t)
    assert set(rows.status.tolist()) == {Status.CONVERGED.code}
    assert off_branch(ROCKER, rows.v, -1) < CLOSE
    assert rows.residual.max() < 1e-14
    # quintic interpolation starts so near that Newton needs no third step
    assert rows.iterations.max() <= 2
    np.testing.assert_array_equal(rows.v[:, 2], t)
    for k in (0, 123, 700):  # a batch of one differs by rounding only
        alone = rows_on_track(solver, PATH, Track(nodes=(start, *nodes), start=0), t[k : k + 1])
        np.testing.assert_allclose(alone.v[0], rows.v[k], rtol=0, atol=CLOSE)
        np.testing.assert_allclose(alone.first[0], rows.first[k], rtol=0, atol=CLOSE)
        np.testing.assert_allclose(alone.second[0], rows.second[k], rtol=0, atol=1e-10)


def test_a_row_whose_guess_leads_to_the_other_branch_is_followed_from_its_node() -> None:
    solver, start = start_of(ROCKER, 1.0, 1)
    nodes, _ = follow(solver, PATH, start, 4.0)
    left, right = nodes[-2:]
    t = np.array([left.t + 0.4 * (right.t - left.t)])
    here = np.angle(ROCKER.phasors(t, 1)).ravel()
    there = np.angle(ROCKER.phasors(t, -1)).ravel()
    # the quintic gives the right node's value the weight s³(10 - 15 s + 6 s²)
    shift = np.append((there - here) / (0.4**3 * (10 - 6 + 0.96)), 0.0)
    spoiled = replace(right, v=right.v + shift)
    rows = rows_on_track(solver, PATH, Track(nodes=(start, *nodes[:-1], spoiled), start=0), t)
    assert rows.status[0] == Status.CONVERGED.code
    assert off_branch(ROCKER, rows.v, 1) < CLOSE


def test_a_row_that_cannot_be_followed_from_its_node_is_lost() -> None:
    solver, start = start_of(FOLDING, 2.0, 1)
    nodes, _ = follow(solver, PATH, start, 0.0)
    beyond = replace(nodes[-1], t=0.3)  # claims more reach than there is
    track = Track(nodes=(beyond, *reversed(nodes), start), start=len(nodes) + 1)
    rows = rows_on_track(solver, PATH, track, np.array([0.7, 1.5]))
    assert rows.status.tolist() == [Status.LOST.code, Status.CONVERGED.code]
    assert off_branch(FOLDING, rows.v[1:], 1) < CLOSE


# ------------------------------------------------------------------ whole tables


def mechanism(bar: FourBar, theta: float, side: int, step: float = 1.0) -> Mechanism:
    return linkage(
        points=bar.points(theta, side),
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B"),
            "rocker": ("O4", "B"),
        },
        lengths={"O2 A": bar.r2, "A B": bar.r3, "O4 B": bar.r4},
        inputs=(Input(link="crank", from_=0, to=360, step=step),),
    )


CRANK_ROCKERS = [*random_crank_rockers(300, seed=41), FourBar(1.0, 0.5, 1.2, 0.8)]


@pytest.mark.parametrize("step", thinned([10, 1, 60]))
@pytest.mark.parametrize("part", thinned(range(3)))
def test_no_crank_rocker_changes_branch_at_any_step_of_the_table(part: int, step: int) -> None:
    rng = np.random.default_rng(42)
    for k, bar in enumerate(CRANK_ROCKERS[part::3]):
        side = 1 if k % 2 else -1
        motion = mechanism(bar, rng.uniform(0, 2 * math.pi), side, step).sweep()
        assert motion.found.all(), bar
        assert not motion.limits, bar
        b = bar.coupler_end(np.radians(motion["crank"]), side)
        # 1e-14 of residual times condition numbers up to a few thousand near folding
        off = np.abs(motion.trace("B") - b).max() / max(bar.r1, bar.r3, bar.r4)
        assert off < 1e-10, bar
        e4 = (b - bar.r1) / bar.r4
        assert np.abs(np.exp(1j * np.radians(motion["rocker"])) - e4).max() < 1e-9, bar


@pytest.mark.parametrize("side", [1, -1])
def test_a_short_crank_at_sixty_degree_steps_keeps_its_branch(side: int) -> None:
    bar = FourBar(1.0, 0.5, 1.2, 0.8)
    motion = mechanism(bar, 0.4, side, 60).sweep()
    assert len(motion) == 7
    e3, e4 = bar.phasors(np.radians(motion["crank"]), side)
    np.testing.assert_allclose(np.exp(1j * np.radians(motion["coupler"])), e3, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(np.exp(1j * np.radians(motion["rocker"])), e4, rtol=0, atol=CLOSE)


@pytest.mark.parametrize("side", [1, -1])
def test_rows_beyond_a_dead_point_say_so_and_hold_nothing(side: int) -> None:
    dead = math.degrees(math.acos(11 / 16))
    motion = mechanism(FOLDING, math.pi, side).sweep()
    assert (len(motion), motion.added.sum()) == (363, 2)
    at_limit = np.array(motion.limit) == "dead point"
    np.testing.assert_array_equal(motion.added, at_limit)
    inside = (motion["crank"] > dead) & (motion["crank"] < 360 - dead) & motion.asked
    assert inside.sum() == 267
    np.testing.assert_array_equal(motion.found & motion.asked, inside)
    inside |= at_limit
    np.testing.assert_array_equal(motion.found, inside)
    outside = {status for status, ok in zip(motion.status, inside, strict=True) if not ok}
    assert outside == {Status.OUT_OF_REACH}
    assert np.isnan(motion["rocker"][~inside]).all()
    regular = inside & motion.asked
    b = FOLDING.coupler_end(np.radians(motion["crank"][regular]), side)
    np.testing.assert_allclose(motion.trace("B")[regular], b, rtol=0, atol=CLOSE)
    # at the dead points coupler and rocker fold over the line from A to the rocker's pivot
    a = FOLDING.crank_end(np.radians([dead, 360 - dead]))
    folded = FOLDING.r1 + FOLDING.r4 * (FOLDING.r1 - a) / 3.0
    np.testing.assert_allclose(motion.trace("B")[at_limit], folded, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(
        motion["crank"][at_limit], [dead, 360 - dead], rtol=0, atol=math.degrees(1e-12)
    )
    limits = [limit.input for limit in motion.limits]
    np.testing.assert_allclose(limits, [dead, 360 - dead], rtol=0, atol=math.degrees(1e-12))


def test_few_steps_lead_to_a_change_point(monkeypatch: pytest.MonkeyPatch) -> None:
    solver, start = start_of(FourBar(2.0, 1.0, 2.0, 1.0), 1.0, 1)
    tried: list[float] = []
    attempt = _Trial.attempt

    def counted(self: _Trial, here: Node, t: float) -> Attempt[Node]:
        tried.append(t)
        return attempt(self, here, t)

    monkeypatch.setattr(_Trial, "attempt", counted)
    nodes, end = follow(solver, PATH, start, 4.0)
    assert end is not None
    assert 0.0 < math.pi - nodes[-1].t < 1e-5
    assert len(tried) < 40  # halving down to rounding would take more than twice as many


@pytest.mark.parametrize("bar", [FourBar(2.0, 1.0, 2.0, 1.0), FourBar(3.0, 1.0, 3.0, 1.0)], ids=str)
@pytest.mark.parametrize("theta", [1.0, 2.7, 4.0])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("step", [0.5, 1, 7])
def test_a_parallelogram_ends_at_its_change_points_and_never_takes_the_other_branch(
    bar: FourBar, theta: float, side: int, step: float
) -> None:
    motion = mechanism(bar, theta, side, step).sweep()
    degrees = motion["crank"]
    upper = theta < math.pi
    between = (degrees > 0) & (degrees < 180) if upper else (degrees > 180) & (degrees < 360)
    at_limit = np.array(motion.limit) == "change point"
    np.testing.assert_array_equal(motion.found, between | at_limit)
    assert set(motion.counts) == {Status.CONVERGED, Status.CHANGE_POINT}
    # one row at each: the table's own (0 and 360 degrees are both), or one that is added
    assert sorted({x % 360 for x in degrees[at_limit]}) == [0.0, 180.0]
    assert set(degrees[at_limit]) <= {0.0, 180.0, 360.0}
    np.testing.assert_array_equal(motion.added, at_limit & (degrees % step != 0))
    flat = bar.r1 + bar.r4 * np.exp(1j * np.radians(degrees[at_limit]))
    np.testing.assert_allclose(motion.trace("B")[at_limit], flat, rtol=0, atol=1e-10)
    b = bar.coupler_end(np.radians(degrees[between]), side)
    # half a degree from the change point the condition is 600
    np.testing.assert_allclose(motion.trace("B")[between], b, rtol=0, atol=1e-10)
    assert [limit.status for limit in motion.limits] == [Status.CHANGE_POINT, Status.CHANGE_POINT]
    # named as their rows are: beside the branch if the table has them there
    last = 360.0 if 360.0 in degrees else 0.0
    assert [limit.input for limit in motion.limits] == ([0.0, 180.0] if upper else [180.0, last])
