"""Certificates in front of a referee that computes in balls: nothing claimed is false.

The referee itself lives in ``tests/campaigns``; ``scripts/campaign`` runs it on more positions.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb

import linkwork as lw
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.motion.positions import prove_rows
from linkwork.core.numerics import path_proof, path_proof as step_halving
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Track, follow, node_at, rows_on_track
from linkwork.core.numerics.kantorovich import Bounds, weighted_radii
from linkwork.core.numerics.path_proof import ProvenPath, prove_path, prove_paths
from linkwork.core.numerics.position_proof import (
    Proof,
    prove,
    reach,
    rounding_of_inputs,
    steps_connected,
)
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LinearRows, PhasorRows
from tests.campaigns.certificates import judge
from tests.campaigns.positions import library_positions, random_position
from tests.campaigns.steps import beads_of, judge_steps
from tests.core.numerics.proof_bounds import bounds
from tests.core.numerics.systems import blocks_of, four_bar_table
from tests.oracles.balls import BallTable, certainly_above, exactly, newton
from tests.oracles.four_bar import FourBar
from tests.thinned import thinned

Array = npt.NDArray[np.float64]
PATH = InputPath(origin=np.zeros(1), rate=np.ones(1))
ROCKER = FourBar(4.0, 2.0, 5.0, 3.5)
FOLDING = FourBar(4.0, 2.0, 5.0, 2.0)


# ------------------------------------------------------------------ single positions


@pytest.mark.parametrize("part", thinned(range(10), 5))
def test_no_constant_and_no_radius_of_a_random_position_is_too_small(part: int) -> None:
    verdict = judge([random_position(k) for k in range(part * 50, part * 50 + 50)], part)
    assert verdict.false == []
    assert verdict.counts["proved"] > 25  # of 50; a third of them lies near a singular position
    assert verdict.counts["not proved"] > 0
    assert verdict.counts["uncertain inputs"] > 15
    assert verdict.counts["boxes without a second root"] > 25
    assert verdict.counts["other roots found"] > 100


def test_no_constant_and_no_radius_in_the_library_is_too_small() -> None:
    verdict = judge(library_positions(100, seed=1), seed=1)
    assert verdict.false == []
    assert verdict.counts["proved"] > 90


def table(
    rows: int,
    terms: list[tuple[int, complex, int, list[tuple[int, float]]]],
    turns: list[bool],
    unknowns: int,
    lines: LinearRows | None = None,
) -> LoopTable:
    """Terms are (loop, coefficient, length or -1, phase)."""
    phases = [(t, k, w) for t, (_, _, _, phase) in enumerate(terms) for k, w in phase]
    linear = lines or LinearRows.none()
    return LoopTable(
        unknowns=unknowns,
        loops=PhasorRows(
            rows=rows,
            variables=len(turns),
            row=np.array([t[0] for t in terms], dtype=np.intp),
            coefficient=np.array([t[1] for t in terms], dtype=complex),
            length=np.array([t[2] for t in terms], dtype=np.intp),
            phase_term=np.array([t for t, _, _ in phases], dtype=np.intp),
            phase_variable=np.array([k for _, k, _ in phases], dtype=np.intp),
            phase_weight=np.array([w for _, _, w in phases], dtype=float),
        ),
        linear=linear,
        functions=(),
        equation_scale=np.ones(2 * rows + len(linear.constant)),
        variable_scale=np.ones(len(turns)),
        is_angle=np.array(turns),
    )


@pytest.mark.parametrize("weight", [3.0, 1 / 3, 0.7])
def test_a_geared_link_after_many_turns_is_known_as_badly_as_its_angle(weight: float) -> None:
    # 3 · 1000.1 is not a float: the phase is known to 2e-13 only
    gears = table(
        1,
        [(0, 2.0, -1, [(0, weight)]), (0, -3.0, -1, [(1, 1.0)]), (0, -1.5, -1, [(2, weight)])],
        [True, True, True],
        2,
    )
    found = 0
    for number in range(40):
        start = np.array([1000.1 + number, 0.3, 5000.3])
        root, proved = newton(BallTable(gears), exactly(start))
        if not proved:
            continue
        v = np.array([float(x.mid()) for x in root])[None, :]
        j = gears.jacobian(v)
        inverse = np.asarray(np.linalg.inv(j[:, :, :2]), dtype=float)
        b = bounds(gears, v, j, inverse, np.zeros((1, 1)))
        balls = BallTable(gears)
        true_y = balls.reduced_residual(exactly(v[0]), inverse[0])
        true_z = balls.defect(exactly(v[0]), inverse[0])
        for i in range(2):
            assert not certainly_above(abs(true_y[i]), b.y[0, i])
            assert not certainly_above(true_z[i], b.z[0, i])
        found += 1
    assert found > 12


def test_curvature_that_cancels_is_known_to_rounding_only() -> None:
    # coefficients of one phase that add up to rounding, behind rows of A that differ by 1e6
    rng = np.random.default_rng(12)
    for _ in range(100):
        c = complex(*rng.normal(size=2))
        parts = rng.normal(size=3)
        many = table(
            1,
            [(0, p * c, -1, [(0, 1.0)]) for p in (*parts, -parts.sum() * (1 - 1e-15))]
            + [(0, 1.0, -1, [(1, 1.0)]), (0, 1.0, -1, [(2, 1.0)])],
            [True, True, True],
            2,
        )
        v = rng.uniform(-3, 3, (1, 3))
        matrix = rng.normal(size=(1, 2, 2))
        bend = many.curvature(v, matrix)
        alpha = matrix[0, :, 0] - 1j * matrix[0, :, 1]
        exact = arb(0)
        sums = [arb(0), arb(0)]
        for z in many.loops.coefficient[:4]:
            sums = [sums[0] + arb(float(z.real)), sums[1] + arb(float(z.imag))]
        exact = (sums[0] ** 2 + sums[1] ** 2).sqrt()
        for i in range(2):
            a = (arb(float(alpha[i].real)) ** 2 + arb(float(alpha[i].imag)) ** 2).sqrt()
            assert not certainly_above(a * exact, bend.phase[0, i, 0])


def test_a_gear_of_linear_rows_alone_is_the_only_solution() -> None:
    # θ = -2 φ + 1 and x = 3 φ: no curvature, so no limit of uniqueness
    lines = LinearRows(
        constant=np.array([-1.0, 0.0]),
        row=np.array([0, 0, 1, 1], dtype=np.intp),
        variable=np.array([0, 2, 1, 2], dtype=np.intp),
        weight=np.array([1.0, 2.0, 1.0, -3.0]),
    )
    gear = table(0, [], [True, False, True], 2, lines)
    v = np.array([[1 - 2 * 0.3, 3 * 0.3, 0.3]])
    proof = prove(blocks_of(gear), v, np.array([[1e-3]]))
    assert proof.holds[0]
    assert math.isinf(proof.least_uniqueness_radius[0])
    assert proof.error_bound[0, :2] == pytest.approx([2e-3, 3e-3], rel=1e-9)
    motion = lw.loops(
        loops={"yoke": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", from_=0, to=360, step=10),
    ).sweep()
    assert motion.certified.all()


def test_radii_are_the_roots_of_their_quadratic() -> None:
    rng = np.random.default_rng(13)
    held = 0
    for number in range(2000):
        n = int(rng.integers(1, 4))
        omega = 10 ** rng.uniform(-3, 6, (1, n)) * (rng.random() < 0.9)
        slope = 10 ** rng.uniform(-3, 6, (1, n)) * (rng.random() < 0.6)
        z = rng.uniform(0, 1.2 if number % 3 else 1e-10, (1, n))
        y = 10 ** rng.uniform(-17, 1, (1, n)) / (1 + omega)
        if number % 5 == 0 and omega.max() > 0 and slope.max() == 0:  # just so, or just not
            y[:] = (1 - z.max()) ** 2 / (2 * omega.max()) * (1 + rng.choice([-1, 1]) * 1e-9)
        weights = 10 ** rng.uniform(-1, 2, n)
        claimed = weighted_radii(Bounds(y=y, z=z, omega=omega, omega_slope=slope), weights)
        big_y, big_z, o, s = (arb(float(part.max())) for part in (y, z, omega, slope))
        room = 1 - big_z
        if not room > 0:
            assert not claimed.holds[0]
            continue
        if s > 0:
            rho = 4 * room / (o + (o**2 + 8 * s * room).sqrt())
            whole = o + rho * s
        else:
            rho, whole = None, o
        square = room**2 - 2 * whole * big_y
        clear = abs(square) > arb(1e-10) * room**2
        if clear:
            assert bool(square > 0) == claimed.holds[0]
        if not claimed.holds[0]:
            continue
        held += 1
        assert square > 0
        lower = 2 * big_y / (room + square.sqrt())
        e, u = arb(float(claimed.existence_radius[0])), float(claimed.uniqueness_radius[0])
        assert e >= lower
        assert not clear or e <= lower * (1 + arb(1e-5))
        if rho is not None:
            assert e <= rho
            assert arb(u) <= rho
        if whole > 0:
            upper = (room + square.sqrt()) / whole
            assert arb(u) <= upper
            assert not clear or arb(u) >= upper * (1 - arb(1e-5))
        else:
            assert math.isinf(u)
        for i in range(n):
            bent = arb(float(omega[0, i])) + (rho or arb(0)) * arb(float(slope[0, i]))
            own = arb(float(y[0, i])) + arb(float(z[0, i])) * e + bent * e**2 / 2
            w = arb(float(weights[i]))
            assert arb(float(claimed.error_bound[0, i])) >= min(own, e) * w * (1 - arb(1e-15))
            assert arb(float(claimed.error_bound[0, i])) <= e * w * (1 + arb(1e-15))
    assert held > 800


# ------------------------------------------------------------------ blocks and inputs


@pytest.mark.parametrize("name", ["andrews-squeezer", "double-four-bar", "jansen-leg"])
def test_errors_of_blocks_before_are_carried_to_those_behind(name: str) -> None:
    mechanism = lw.example(name)
    compiled = mechanism.model.compiled
    solver, n = compiled.solver, compiled.solver.unknowns
    assert len(solver.blocks) > 1
    motion = mechanism.sweep()
    rng = np.random.default_rng(14)
    rows = rng.choice(np.flatnonzero(motion.certified[motion.asked]), 8)
    v = np.concatenate([motion.q[motion.asked], mechanism.model.rows], axis=1)[rows]
    balls = BallTable(compiled.table)
    for size in (0.0, 1e-9, 1e-4):
        # blocks that start from where the blocks before have only nearly arrived
        spread = np.full((len(v), 1), size) + rounding_of_inputs(v, n)
        proof = prove(solver, v, spread)
        assert proof.holds.any()
        for k in np.flatnonzero(proof.holds):
            for shift in (-1.0, 1.0, float(rng.uniform(-1, 1))):
                at = exactly(v[k])
                at[n] += arb(shift) * arb(float(spread[k, 0]))
                root, proved = newton(balls, at)
                assert proved
                for i in range(n):
                    off = abs(root[i] - arb(float(v[k, i])))
                    assert off <= arb(float(proof.error_bound[k, i])), (name, i)
                for number, block in enumerate(solver.blocks):
                    for i in block.unknowns:
                        off = abs(root[i] - arb(float(v[k, i]))) / balls.weights[i]
                        assert off <= arb(float(proof.existence_radius[k, number])), (name, i)


def test_rows_of_two_inputs_are_proved_at_the_inputs_asked_for() -> None:
    # one step of b is known to 1e-14 only; a thousand of them must not add up
    motion = lw.loops(
        angle="rad",
        loops={"1": "r*e^(i*a) + l*e^(i*p) = g + r*e^(i*b) + l*e^(i*q)"},
        dimensions={"r": 1.0, "l": 2.0, "g": 1.5},
        guess={"a": 1.0, "b": 100.0, "p": 0.7, "q": 2.0},
        inputs=(
            lw.Input(variable="a", from_=1.0, to=1.1, step=0.0001),
            lw.Input(variable="b", from_=100.0, to=100.1, step=0.0001),
        ),
    ).sweep()
    assert motion.certified.all()
    bars = table(
        1,
        [
            (0, 2.0, -1, [(0, 1.0)]),
            (0, -2.0, -1, [(1, 1.0)]),
            (0, 1.0, -1, [(2, 1.0)]),
            (0, -1.0, -1, [(3, 1.0)]),
            (0, -1.5, -1, []),
        ],
        [True] * 4,
        2,
    )
    for k in range(0, 1001, 100):
        v = [motion[name][k] for name in ("p", "q", "a", "b")]
        root, proved = newton(BallTable(bars), exactly(v))
        assert proved
        off = max(abs(x - arb(float(y))) for x, y in zip(root[:2], v[:2], strict=True))
        assert off <= arb(float(motion.radius[k]))


def test_rows_a_whole_turn_away_count_the_rounding_of_two_pi() -> None:
    bar = FOLDING
    solver, path = blocks_of(four_bar_table(bar)), PATH
    e3, e4 = bar.phasors(np.array(math.pi), 1)
    start = node_at(solver, path, math.pi, np.array([np.angle(e3), np.angle(e4), math.pi]))
    nodes, _ = follow(solver, path, start, 4.0)
    track = Track(nodes=(start, *nodes), start=0)
    t = np.array([3.5])
    rows = rows_on_track(solver, path, track, t)
    same, _ = prove_rows(solver, path, track, rows, t[:, None])
    turned, _ = prove_rows(solver, path, track, rows, t[:, None] - 2 * math.pi)
    apart, _ = prove_rows(solver, path, track, rows, t[:, None] + 1e-12)
    assert {int(p.certification[0]) for p in (same, turned, apart)} == {
        Certification.CERTIFIED.code
    }
    assert same.radius[0] < turned.radius[0] < 3 * same.radius[0]
    # what the inputs differ by is part of the radius, 1e-12 times a rate of order one
    assert 2e-13 < apart.radius[0] - same.radius[0] < 1e-11


# ------------------------------------------------------------------ steps


@pytest.mark.parametrize("part", thinned(range(8), 8))
def test_proved_steps_follow_the_branch_and_steps_to_another_root_are_refused(part: int) -> None:
    verdict = judge_steps(16, part)
    assert verdict.false == []
    assert verdict.counts["steps proved at once"] > 20
    assert verdict.counts["steps to another root"] > 40
    assert verdict.counts["steps to a turned link"] > 40
    # branches that are followed without doubt are regular enough to be proved
    assert verdict.counts["right steps proved"] == verdict.counts["right steps"]


def four_bar_at(bar: FourBar, theta: Array, side: int) -> tuple[BlockSolver, Array]:
    e3, e4 = bar.phasors(theta, side)
    angles = [np.unwrap(np.angle(e)) for e in (e3, e4)]
    return blocks_of(four_bar_table(bar)), np.stack([*angles, theta], axis=1)


@pytest.mark.parametrize("step", [60, 90])
@pytest.mark.parametrize("side", [1, -1])
def test_a_coarse_table_is_proved_by_halving_its_steps(step: int, side: int) -> None:
    theta = np.radians(np.arange(0, 361, step))
    fine = np.radians(np.arange(0, 361))
    solver, v = four_bar_at(ROCKER, fine, side)
    v = v[::step]
    spread = np.full((len(v), 1), math.radians(step))
    arrival = prove(solver, v, rounding_of_inputs(v, 2))
    at_once = steps_connected(
        v[:-1], v[1:], reach(solver, v[:-1], spread[:-1]), arrival.error_bound[1:]
    )
    assert not at_once.any()
    found = prove_path(solver, PATH, beads_of(solver, v))
    assert found.connected.all()
    assert found.pieces.max() > 1
    assert found.connected_to(2).all()
    wrong = v.copy()
    _, other = four_bar_at(ROCKER, fine, -side)
    wrong[2] = other[::step][2]
    found = prove_path(solver, PATH, beads_of(solver, wrong))
    expected = np.ones(len(theta) - 1, dtype=bool)
    expected[1:3] = False
    np.testing.assert_array_equal(found.connected, expected)


def test_a_position_is_connected_through_proved_steps_only() -> None:
    holds = np.array([True, True, True, True, False, True, True])
    nothing = np.zeros((7, 1))
    position = Proof(
        holds=holds, existence_radius=nothing, uniqueness_radius=nothing, error_bound=nothing
    )
    connected = np.array([True, False, True, True, True, True])
    path = ProvenPath(
        position=position,
        connected=connected,
        pieces=np.ones(6, dtype=np.int64),
        given_up=~connected,
    )
    for anchor, expected in (
        (0, [1, 1, 0, 0, 0, 0, 0]),
        (1, [1, 1, 0, 0, 0, 0, 0]),
        (3, [0, 0, 1, 1, 0, 1, 1]),
        (6, [0, 0, 1, 1, 0, 1, 1]),
    ):
        np.testing.assert_array_equal(path.connected_to(anchor), np.array(expected, dtype=bool))


def test_the_first_step_without_a_proof_tells_why_there_is_none_beyond() -> None:
    position = Proof(
        holds=np.ones(8, dtype=bool),
        existence_radius=np.zeros((8, 1)),
        uniqueness_radius=np.zeros((8, 1)),
        error_bound=np.zeros((8, 1)),
    )
    #        0-1    1-2   2-3   3-4    4-5   5-6    6-7
    connected = [False, True, True, False, True, False, True]
    given_up = [True, False, False, False, False, True, False]
    path = ProvenPath(
        position=position,
        connected=np.array(connected),
        pieces=np.ones(7, dtype=np.int64),
        given_up=np.array(given_up),
    )
    for anchor, expected in (
        (2, [1, 0, 0, 0, 0, 0, 0, 0]),  # to the right the first one was refused, not given up
        (4, [0, 0, 0, 0, 0, 0, 1, 1]),
        (7, [1, 1, 1, 1, 1, 1, 0, 0]),
        (0, [0, 1, 1, 1, 1, 1, 1, 1]),
    ):
        np.testing.assert_array_equal(path.given_up_before(anchor), np.array(expected, dtype=bool))


@pytest.mark.parametrize("lanes", [1, 1024])
def test_a_proof_stops_at_its_allowance_and_begins_at_the_anchor(
    lanes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(step_halving, "_LANES", lanes)
    theta = np.radians(np.arange(0.0, 361.0, 60.0))
    solver, v = four_bar_at(ROCKER, theta, 1)
    points = beads_of(solver, v)
    whole = prove_path(solver, PATH, points, anchor=3)
    assert whole.connected.all()
    assert not whole.given_up.any()
    spent = int((whole.pieces - 1).sum())
    assert spent > 12
    exact = prove_path(solver, PATH, points, anchor=3, most=spent)
    assert exact.connected.all()
    for most in range(spent):
        found = prove_path(solver, PATH, points, anchor=3, most=most)
        assert int((found.pieces - 1).sum()) == most
        assert found.given_up.any()
        np.testing.assert_array_equal(found.connected, ~found.given_up)
        if lanes == 1:  # one after the other, outwards
            away = np.abs(np.arange(6) + 0.5 - 3)
            assert away[found.connected].max(initial=0.0) <= away[~found.connected].min()
    assert not prove_path(solver, PATH, points, anchor=3, most=0).connected.all()


def test_steps_beyond_one_that_is_refused_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(step_halving, "_LANES", 1)  # one after the other
    theta = np.radians(np.arange(0.0, 361.0, 60.0))
    solver, v = four_bar_at(ROCKER, theta, 1)
    v[2] = four_bar_at(ROCKER, theta, -1)[1][2]
    points = beads_of(solver, v)
    for anchor, beyond in ((4, slice(0, 1)), (0, slice(3, None))):
        found = prove_path(solver, PATH, points, anchor=anchor)
        every = prove_path(solver, PATH, points)
        assert every.connected[beyond].all()
        np.testing.assert_array_equal(found.connected_to(anchor), every.connected_to(anchor))
        assert every.pieces[beyond].min() > 1
        assert (found.pieces[beyond] == 1).all()


def test_paths_proved_together_have_the_proofs_of_each() -> None:
    """Also where one of them jumps to the other branch, and where one begins as another ends."""
    theta = np.radians(np.arange(0.0, 361.0, 30.0))
    solver, v = four_bar_at(ROCKER, theta, 1)
    other = four_bar_at(ROCKER, theta, -1)[1]
    jumping = np.concatenate([v[:7], other[7:]])
    paths = [beads_of(solver, rows) for rows in (v[:5], v[4:], jumping, other, v[:1])]
    anchors = [0, len(theta) - 5, 0, 3, 0]
    found = prove_paths(solver, PATH, paths, anchors=anchors, most=10_000)
    for points, anchor, proof in zip(paths, anchors, found, strict=True):
        alone = prove_path(solver, PATH, points, anchor=anchor)
        np.testing.assert_array_equal(proof.connected, alone.connected)
        np.testing.assert_array_equal(proof.position.holds, alone.position.holds)
        np.testing.assert_array_equal(proof.connected_to(anchor), alone.connected_to(anchor))
    assert [bool(proof.connected.all()) for proof in found] == [True, True, False, True, True]
    assert found[2].connected_to(0).sum() == 7


def test_the_proofs_of_a_long_path_are_those_of_its_positions() -> None:
    theta = np.linspace(0, 40, 2500)
    solver, v = four_bar_at(ROCKER, theta, 1)
    v[1700] = four_bar_at(ROCKER, theta, -1)[1][1700]
    points = beads_of(solver, v)
    found = prove_path(solver, PATH, points)
    assert len(found.connected) == 2499
    np.testing.assert_array_equal(np.flatnonzero(~found.connected), [1699, 1700])
    whole = prove(solver, v, points.input_radius)
    np.testing.assert_array_equal(found.position.holds, whole.holds)
    np.testing.assert_allclose(
        found.position.existence_radius, whole.existence_radius, rtol=1e-6, atol=1e-15
    )


# ------------------------------------------------------------------ reasons


def too_long_to_prove(monkeypatch: pytest.MonkeyPatch) -> Certification:
    """Of a row three proved halvings away from the start, where none is allowed."""
    monkeypatch.setattr(path_proof, "_MOST", 0)
    monkeypatch.setattr(path_proof, "_MOST_EACH", 0)
    solver, v = four_bar_at(ROCKER, np.radians([0.0, 80.0]), 1)
    start, last = (node_at(solver, PATH, x[2], x) for x in v)
    track = Track(nodes=(start, last), start=0)
    rows = rows_on_track(solver, PATH, track, v[1:, 2])
    (code,) = prove_rows(solver, PATH, track, rows, v[1:, 2:])[0].certification
    return Certification.of_code(int(code))


def test_every_reason_for_a_missing_certificate_is_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    (dead,) = FOLDING.dead_points()
    solver, v = four_bar_at(FOLDING, np.array([2.0]), 1)
    start = node_at(solver, PATH, 2.0, v[0])
    nodes, end = follow(solver, PATH, start, 0.0)
    assert end is not None
    track = Track(nodes=(*reversed(nodes), start), start=len(nodes))
    t = np.array([1.8, 1.3, 1.0, dead])
    rows = rows_on_track(solver, PATH, track, t[:3])
    folded = np.angle(4.0 - 2.0 * np.exp(1j * dead))
    places = np.concatenate([rows.v, [[folded, folded, dead]]])
    places[1] = four_bar_at(FOLDING, t[1:2], -1)[1][0]
    status = np.array([Status.CONVERGED.code] * 4, dtype=np.int8)
    status[2] = Status.LOST.code
    doctored = solver.rates(places, PATH.rate).with_columns(t=t, status=status)
    proofs, _ = prove_rows(solver, PATH, track, doctored, t[:, None])
    reasons = [Certification.of_code(int(code)) for code in proofs.certification]
    proved = np.isfinite(proofs.radius) & np.isfinite(proofs.uniqueness_radius)
    np.testing.assert_array_equal(proved, [True, True, False, False])

    parallelogram = lw.loops(
        loops={"1": "e^(i*t) + 2*e^(i*p) = 2 + e^(i*q)"},
        guess={"t": 60, "p": 0, "q": 60},
        inputs=lw.Input(variable="t", from_=60, to=210, step=30),
    ).sweep(change_points="straight")
    reasons += [
        lw.example("four-bar").sweep(certify=False).certification[0],
        parallelogram.certification[-1],
        lw.example("parallel-cranks").solve().certificate.certification,
        lw.example("four-bar").configurations()[0].certificate.certification,
        too_long_to_prove(monkeypatch),
    ]
    assert [(reason.name, reason.value) for reason in reasons] == [
        (
            "CERTIFIED",
            "proved: a true position lies within the radius, no other near it, and the motion "
            "from the start stays on one branch",
        ),
        (
            "MOTION_NOT_PROVED",
            "the position is proved, but not that the motion from the start stays on one branch",
        ),
        ("NO_POSITION", "there is no position to certify"),
        (
            "POSITION_NOT_PROVED",
            "too close to a singular position: rounding errors exceed the margin of the proof",
        ),
        ("NOT_ASKED", "certificates were switched off"),
        (
            "BRANCH_CHOSEN",
            "the position is proved; at a change point before it, the chosen policy decides the "
            "branch",
        ),
        (
            "SUBSET_CERTIFIED",
            "proved for the mechanism without its redundant links; these fit to rounding, "
            "without proof",
        ),
        (
            "CONFIGURATION_CERTIFIED",
            "proved: a true position lies within the radius, and no other near it",
        ),
        (
            "PROOF_TOO_LONG",
            "the position is proved; the proof that the motion from the start stays on one "
            "branch would take too many steps",
        ),
    ]
    # every equation of a file has known bounds
    assert set(reasons) == set(Certification) - {
        Certification.NO_BOUND,
        Certification.ENERGY_DRIFTS,  # of simulations
    }


def test_a_step_to_another_branch_is_soon_refused() -> None:
    theta = np.radians(np.arange(0.0, 361.0, 60.0))
    solver, v = four_bar_at(ROCKER, theta, 1)
    v[3] = four_bar_at(ROCKER, theta, -1)[1][3]
    found = prove_path(solver, PATH, beads_of(solver, v))
    np.testing.assert_array_equal(found.connected, [True, True, False, False, True, True])
    # a step that shrinks to nothing before it is refused takes 45 halvings
    assert found.pieces.max() < 40
