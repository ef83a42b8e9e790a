"""Curves beyond dead points: they close, every step is proved, they turn where they should."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb, ctx

import linkwork as lw
from linkwork.circuits.branches import TracedCurve, branches_of, trace_with_proof
from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.core.motion.model import leading_input
from linkwork.core.motion.solving import first_position
from linkwork.core.numerics.branch_tracking import InputPath, same_position
from linkwork.core.numerics.curve_tracing import Curve, CurveOptions, Leg, trace
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.numerics.path_proof import prove_curve
from linkwork.core.numerics.turning_point import TurningPoint
from tests.core.numerics.systems import four_bar_table
from tests.oracles.four_bar import FourBar
from tests.thinned import thinned

Array = npt.NDArray[np.float64]
PATH = InputPath(origin=np.zeros(1), rate=np.ones(1))
FOLDING = FourBar(4.0, 2.0, 5.0, 2.0)


def around(
    bar: FourBar, theta: float, side: int, way: float = 1.0
) -> tuple[ParametrizedTable, TracedCurve]:
    """The curve of a four-bar through a crank angle on one of its assemblies."""
    leads = ParametrizedTable(four_bar_table(bar), PATH, 0)
    e3, e4 = bar.phasors(np.array(theta), side)
    start = np.array([np.angle(e3), np.angle(e4), theta])
    return leads, trace_with_proof(leads, start, way, certify=True)


def circuit_of(mechanism: lw.Mechanism, way: float = 1.0) -> tuple[ParametrizedTable, TracedCurve]:
    """The curve of a mechanism through its start, which lies on its table."""
    model = mechanism.model
    lead, rate = leading_input(model.rows)
    path = InputPath(origin=model.rows[0] - rate * model.rows[0, lead], rate=rate)
    start = first_position(model, model.start_inputs, NewtonOptions())
    assert start.status.ok
    leads = ParametrizedTable(model.compiled.table, path, lead)
    return leads, trace_with_proof(leads, start.v, way, certify=True)


def exact_turns(bar: FourBar) -> list[arb]:
    """Dead points in (0, π): cos φ = (r1² + r2² - (r3 ± r4)²) / (2 r1 r2), in balls."""
    ctx.prec = 200
    r1, r2, r3, r4 = (arb(x) for x in (bar.r1, bar.r2, bar.r3, bar.r4))
    cosines = [(r1**2 + r2**2 - reach**2) / (2 * r1 * r2) for reach in (r3 - r4, r3 + r4)]
    return [c.acos() for c in cosines if abs(c) < 1]


def off_exact(turn: TurningPoint, bar: FourBar) -> arb:
    """How far a turning point is from the nearest exact one, whole turns aside."""
    gaps = [
        abs(arb(turn.t) - sign * exact - 2 * k * arb.pi())
        for exact in exact_turns(bar)
        for sign in (1, -1)
        for k in range(-3, 4)
    ]
    return min(gaps, key=lambda gap: float(gap.mid()))


def step_count(curve: Curve) -> int:
    return sum(len(leg.nodes) - 1 for leg in curve.legs)


def residual(leads: ParametrizedTable, curve: Curve) -> float:
    v = np.concatenate([leg.v for leg in curve.legs])
    table = leads.table
    return float(np.abs(table.residual(v) / table.equation_scale).max())


def random_four_bars(count: int, seed: int) -> list[tuple[FourBar, float, int]]:
    """Four-bars with dead points, at a crank angle that they reach."""
    rng = np.random.default_rng(seed)
    found: list[tuple[FourBar, float, int]] = []
    while len(found) < count:
        bar = FourBar(*(float(r) for r in rng.uniform(0.3, 4.0, 4)))
        theta, side = float(rng.uniform(-math.pi, math.pi)), int(rng.choice([-1, 1]))
        if bar.dead_points() and np.isfinite(bar.coupler_end(np.array(theta), side)):
            found.append((bar, theta, side))
    return found


# ------------------------------------------------------------------ closing, turning


def test_curves_of_random_four_bars_close_with_proof_and_turn_where_the_closed_form_says() -> None:
    for number, (bar, theta, side) in enumerate(random_four_bars(24, seed=3)):
        leads, found = around(bar, theta, side, way=1.0 if number % 2 else -1.0)
        assert found.curve.end is CircuitEnd.CLOSED, bar
        assert found.proof is not None
        assert found.proof.legs.all(), bar
        assert found.proof.junctions.all(), bar
        assert found.proof.closed, bar
        assert step_count(found.curve) < 80
        assert residual(leads, found.curve) < 1e-12
        assert len(found.turns) == 2, bar
        for turn in found.turns:
            off = off_exact(turn, bar)
            assert turn.located
            assert off < 1e-12, bar
            assert off < (turn.bracket[1] - turn.bracket[0]) / 2, bar
            assert turn.bracket[0] <= turn.t <= turn.bracket[1]
            # coupler and rocker in line there, the input at rest
            assert abs(math.sin(turn.v[0] - turn.v[1])) < 1e-12
            assert abs(turn.direction[2]) < 1e-12
            assert np.abs(turn.direction).max() == 1.0


def test_the_branches_of_a_curve_are_the_two_assemblies() -> None:
    leads, found = around(FOLDING, 2.0, 1)
    branches = branches_of(leads, found)
    assert [branch.side for branch in branches] == [1.0, -1.0]
    assert all(branch.is_joined(leads) for branch in branches)
    (dead,) = (float(x.mid()) for x in exact_turns(FOLDING))
    for branch, side in zip(branches, (1, -1), strict=True):
        low, high = branch.range(leads.parameter)
        assert low == pytest.approx(dead, abs=1e-12)
        assert high == pytest.approx(2 * math.pi - dead, abs=1e-12)
        inner = branch.v[1:-1]
        e3, _ = FOLDING.phasors(inner[:, 2], side)
        np.testing.assert_allclose(np.exp(1j * inner[:, 0]), e3, rtol=0, atol=1e-6)


def slider_crank(crank: float, rod: float, offset: float) -> lw.Mechanism:
    angle = 0.3
    reach = math.sqrt(rod**2 - (offset - crank * math.sin(angle)) ** 2)
    return lw.loops(
        angle="rad",
        loops={"1": "r*e^(i*t) + l*e^(i*p) = s + i*h"},
        dimensions={"r": crank, "l": rod, "h": offset},
        guess={
            "t": angle,
            "p": math.asin((offset - crank * math.sin(angle)) / rod),
            "s": crank * math.cos(angle) + reach,
        },
        inputs=lw.Input(variable="t", from_=0.0, to=0.6, step=0.1),
    )


@pytest.mark.parametrize("offset", [0.0, 0.7, -0.4])
def test_a_crank_longer_than_its_rod_turns_back_where_the_rod_stands_upright(offset: float) -> None:
    leads, found = circuit_of(slider_crank(2.0, 1.9, offset))  # starts at 0.3 rad
    assert found.certified
    assert found.curve.end is CircuitEnd.CLOSED
    exact = [x / 2.0 for x in (offset + 1.9, offset - 1.9) if abs(x) < 2.0]  # r sin φ = h ± l
    assert len(found.turns) == 2
    for turn in found.turns:
        assert min(abs(math.sin(turn.t) - x) for x in exact) < 1e-14
        assert turn.located
    assert residual(leads, found.curve) < 1e-12


@pytest.mark.parametrize("stroke", [1.0, -1.0])
def test_a_slider_in_the_lead_goes_to_and_fro_between_stretched_and_folded(stroke: float) -> None:
    mechanism = lw.loops(
        loops={"1": "e^(i*t) + 3*e^(i*p) = s"},
        guess={"t": 60, "p": -17, "s": 3.3},
        inputs=lw.Input(variable="s", from_=2.5, to=3.5, step=0.1),
    )
    _, found = circuit_of(mechanism, stroke)
    assert found.certified
    assert found.curve.end is CircuitEnd.CLOSED
    np.testing.assert_allclose(
        sorted(turn.t for turn in found.turns), [2.0, 4.0], rtol=0, atol=1e-14
    )


@pytest.mark.parametrize(
    ("name", "turns"),
    [("rapier-drive", []), ("rapier-drive-limited", [149.617278637485, -158.679899604109])],
)
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_both_readings_of_the_rapier_drive_close(name: str, turns: list[float], way: float) -> None:
    _, found = circuit_of(lw.example(name), way)
    assert found.certified
    assert found.curve.end is CircuitEnd.CLOSED
    at = [math.degrees(math.remainder(turn.t, 2 * math.pi)) for turn in found.turns]
    assert at == pytest.approx(turns[:: int(way)], abs=math.degrees(1e-12))


def test_six_bars_that_are_one_system_close_with_proof() -> None:
    closed = 0
    for seed in range(6):
        rng = np.random.default_rng([31, seed])
        z = rng.normal(size=(3, 2)) @ np.array([1, 1j])
        names = ("p", "x", "q", "y")
        angle = dict(zip(names, rng.uniform(-3, 3, 4).tolist(), strict=True))
        e = {name: complex(np.exp(1j * a)) for name, a in angle.items()}
        crank, theta = 0.8, float(rng.uniform(0, 6))
        pin = crank * np.exp(1j * theta) + 1.5 * e["p"]
        g = pin + z[0] * e["x"] - 2 * e["q"]
        h = pin + z[1] * e["x"] - 2 * e["y"]
        start = "r*e^(i*t) + 1.5*e^(i*p)"
        numbers = {"r": crank}
        for name, value in (("j", z[0]), ("k", z[1]), ("g", g), ("h", h)):
            numbers |= {f"{name}1": float(value.real), f"{name}2": float(value.imag)}
        mechanism = lw.loops(
            angle="rad",
            loops={
                "1": f"{start} + (j1 + i*j2)*e^(i*x) = g1 + i*g2 + 2*e^(i*q)",
                "2": f"{start} + (k1 + i*k2)*e^(i*x) = h1 + i*h2 + 2*e^(i*y)",
            },
            dimensions=numbers,
            guess={"t": theta, **angle},
            inputs=lw.Input(variable="t", from_=theta - 1, to=theta + 1, step=0.5),
        )
        leads, found = circuit_of(mechanism)
        assert len(mechanism.model.compiled.solver.blocks) == 1
        assert found.certified, seed
        assert found.curve.end is CircuitEnd.CLOSED, seed
        assert residual(leads, found.curve) < 1e-12
        assert len(found.turns) % 2 == 0
        closed += bool(found.turns)
    assert closed > 2


# ------------------------------------------------------------------ near a change point


@pytest.mark.parametrize("exponent", range(2, 13))
@pytest.mark.parametrize("side", [1, -1])
def test_a_crank_rocker_near_its_change_point_is_crossed_in_few_proved_steps(
    exponent: int, side: int
) -> None:
    bar = FourBar(4.5 - 10.0**-exponent, 1.0, 2.5, 3.0)
    _, found = around(bar, 1.0, side)
    assert found.certified
    assert found.curve.end is CircuitEnd.CLOSED
    assert found.turns == ()
    assert found.proof is not None
    assert step_count(found.curve) <= 60
    assert found.proof.steps <= 250  # after halving: what a proof takes


@pytest.mark.parametrize("exponent", range(2, 13))
def test_just_beyond_the_change_point_there_are_two_dead_points(exponent: int) -> None:
    bar = FourBar(4.5 + 10.0**-exponent, 1.0, 2.5, 3.0)
    _, found = around(bar, 1.0, 1)
    assert found.certified
    assert found.curve.end is CircuitEnd.CLOSED
    assert len(found.turns) == 2
    for turn in found.turns:
        assert turn.located
        off = off_exact(turn, bar)
        assert off < (turn.bracket[1] - turn.bracket[0]) / 2
        # an angle is known to the rounding of the lengths over sqrt(ε)
        assert off < 1e-15 * 10 ** (exponent / 2) * 100


@pytest.mark.parametrize("away", [1e-3, 1e-6, 1e-9, 1e-11, 1e-12, 1e-13])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_curve_from_just_before_a_dead_point_closes(away: float, way: float) -> None:
    (dead,) = (float(x.mid()) for x in exact_turns(FOLDING))
    leads, found = around(FOLDING, dead + away, 1, way)
    assert found.curve.end is CircuitEnd.CLOSED
    assert len(found.turns) == 2
    last = found.curve.legs[-1].v[-1]
    assert same_position(leads, last, found.curve.legs[0].v[0])
    assert found.certified or away < 1e-8  # nearer, the start itself is known too badly


@pytest.mark.parametrize("apart", [1e-6, 3e-7, 1e-7])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("certify", [True, False])
def test_a_curve_that_passes_itself_closely_is_followed_on(
    apart: float, side: int, certify: bool
) -> None:
    # so near to a dead point that the other assembly is only that far away
    (dead,) = (float(x.mid()) for x in exact_turns(FOLDING))
    for away in np.geomspace(1e-16, 1e-10, 61):
        ends = np.concatenate([FOLDING.phasors(np.array(dead + away), s) for s in (1, -1)])
        gap = np.abs(ends[:2] - ends[2:]).max()
        if gap > apart:
            break
    assert gap < 3 * apart
    angle = np.angle(ends[:2] if side > 0 else ends[2:])
    leads = ParametrizedTable(four_bar_table(FOLDING), PATH, 0)
    start = np.array([*angle, dead + away])
    for way in (1.0, -1.0):
        found = trace_with_proof(leads, start, way, certify)
        assert found.curve.end is CircuitEnd.CLOSED
        assert len(found.turns) == 2
        first, last = found.curve.legs[0].v[0], found.curve.legs[-1].v[-1]
        assert np.abs(np.exp(1j * first) - np.exp(1j * last)).max() < 0.3 * apart


@pytest.mark.parametrize("more", [1e-6, 2e-8, 1e-9, 1e-12])
@pytest.mark.parametrize("certify", [True, False])
def test_a_gear_of_nearly_one_to_one_does_not_close_after_one_turn(
    more: float, certify: bool
) -> None:
    mechanism = lw.loops(
        angle="rad",
        loops={"1": f"e^(i*t) + 3*e^(i*p) = s + 0.5*e^(i*{1.0 + more!r}*t)"},
        guess={"t": 1.0, "p": -0.1, "s": 3.0},
        inputs=lw.Input(variable="t", from_=0, to=6, step=0.5),
    )
    model = mechanism.model
    start = first_position(model, model.start_inputs, NewtonOptions())
    leads = ParametrizedTable(model.compiled.table, PATH, 0)
    curve = trace(leads, start.v, 1.0, CurveOptions(most_turns=3))
    first, after = curve.legs[0].v[0], curve.passes[0][1]
    assert after[2] - first[2] == pytest.approx(2 * math.pi, abs=1e-12)
    assert np.abs(after - first)[:2].max() < 10 * more
    assert not same_position(leads, after, first)
    assert curve.end is CircuitEnd.NEVER_CLOSES
    closed = replace(curve, end=CircuitEnd.CLOSED, legs=curve.legs[: curve.passes[0][0] + 1])
    assert not (certify and prove_curve(leads, closed).closed)


def test_a_gear_with_a_ratio_closes_after_as_many_turns() -> None:
    for ratio, turns in (("3/2", 2), ("1/3", 3), ("2", 1)):
        mechanism = lw.loops(
            angle="rad",
            loops={"1": f"e^(i*t) + 3*e^(i*p) = s + 0.5*e^(i*{ratio}*t)"},
            guess={"t": 1.0, "p": -0.1, "s": 3.0},
            inputs=lw.Input(variable="t", from_=0, to=6, step=0.5),
        )
        _, found = circuit_of(mechanism)
        assert found.certified
        assert found.curve.end is CircuitEnd.CLOSED
        gain = found.curve.legs[-1].v[-1, 2] - found.curve.legs[0].v[0, 2]
        assert gain == pytest.approx(2 * math.pi * turns, abs=1e-12)


@pytest.mark.parametrize("apart", [1e-1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("start", thinned([0.35, 0.52, 0.68, 0.86], 4))
def test_two_dead_points_that_nearly_meet_are_both_seen(apart: float, start: float) -> None:
    # t = x³ - d x on the circle x² + y² = 1 turns back at x = ±1 and, twice, at x = ±√(d/3)
    d = 3.0 * (apart / 2.0) ** 2
    value = start**3 - d * start
    mechanism = lw.plain_equations(
        equations={"1": f"x^3 - ({d!r})*x = t", "2": "x^2 + y^2 = 1"},
        guess={"x": start, "y": math.sqrt(1.0 - start**2), "t": value},
        inputs=lw.Input(variable="t", from_=value, to=value + 1, step=0.5),
    )
    _, found = circuit_of(mechanism)
    assert found.curve.end is CircuitEnd.CLOSED
    places = sorted(float(turn.v[0]) for turn in found.turns)
    half = apart / 2.0
    assert places == pytest.approx([-1, -half, -half, half, half, 1], abs=1e-4 * apart)
    # proved to rounding: derivatives of formulas are enclosed over boxes
    assert all(turn.located for turn in found.turns)


# ------------------------------------------------------------------ other curves


def test_inputs_in_lock_step_are_followed_together() -> None:
    mechanism = lw.loops(
        angle="rad",
        loops={"1": "r*e^(i*a) + l*e^(i*p) = g + r*e^(i*b) + l*e^(i*q)"},
        dimensions={"r": 1.0, "l": 1.2, "g": 2.5},
        guess={"a": 1.0, "b": 2.0, "p": 0.5, "q": 2.3},
        inputs=(
            lw.Input(variable="a", from_=1.0, to=2.0, step=0.1),
            lw.Input(variable="b", from_=2.0, to=1.5, step=-0.05),
        ),
    )
    leads, found = circuit_of(mechanism)
    v = np.concatenate([leg.v for leg in found.curve.legs])
    np.testing.assert_allclose(v[:, 3], 2.0 - 0.5 * (v[:, 2] - 1.0), rtol=0, atol=1e-12)
    assert found.certified
    assert residual(leads, found.curve) < 1e-12
    assert found.turns
    for turn in found.turns:  # the two rods in line
        assert abs(math.sin(turn.v[0] - turn.v[1])) < 1e-12


def test_a_slider_that_runs_away_is_told() -> None:
    # a slotted lever through a fixed pin: s = 1 / cos t grows without bound at 90 degrees
    mechanism = lw.loops(
        loops={"1": "s*e^(i*t) = 1 + i*y"},
        guess={"t": 20, "s": 1.06, "y": 0.36},
        inputs=lw.Input(variable="t", from_=0, to=40, step=5),
    )
    for way in (1.0, -1.0):
        _, found = circuit_of(mechanism, way)
        assert found.curve.end is CircuitEnd.RUNS_TO_INFINITY
        assert found.turns == ()
        (last,) = found.curve.legs[-1].v[-1:, -1]
        assert abs(last) == pytest.approx(math.pi / 2, abs=1e-3)
        assert found.proof is not None
        assert not found.proof.closed


def test_a_parallelogram_is_followed_to_its_change_point_only() -> None:
    leads, found = around(FourBar(2.0, 1.0, 2.0, 1.0), 1.0, 1)
    assert found.curve.end is CircuitEnd.CHANGE_POINT
    last = found.curve.legs[-1].v[-1]
    assert last[leads.parameter] == pytest.approx(math.pi, abs=1e-4)
    assert last[leads.parameter] < math.pi


# ------------------------------------------------------------------ the proof refuses


def tampered(curve: Curve, number: int, leg: Leg) -> Curve:
    return replace(curve, legs=(*curve.legs[:number], leg, *curve.legs[number + 1 :]))


def test_a_node_moved_to_another_branch_breaks_its_leg() -> None:
    leads, found = around(FOLDING, 2.0, 1)
    number = max(range(len(found.curve.legs)), key=lambda k: len(found.curve.legs[k].nodes))
    leg = found.curve.legs[number]
    assert len(leg.nodes) > 2
    for k in range(1, len(leg.nodes) - 1):
        node = leg.nodes[k]
        # mirrored on the line from A to the rocker's pivot
        v = leg.led.whole(node.v)
        line = np.angle(FOLDING.r1 - FOLDING.r2 * np.exp(1j * v[2]))
        v[:2] = 2 * line - v[:2]
        nodes = (*leg.nodes[:k], leg.led.node(v), *leg.nodes[k + 1 :])
        proof = prove_curve(leads, tampered(found.curve, number, replace(leg, nodes=nodes)))
        np.testing.assert_array_equal(np.flatnonzero(~proof.legs), [number])
        assert not proof.whole


def test_a_leg_of_another_branch_is_not_joined() -> None:
    leads, found = around(FOLDING, 2.0, 1)
    _, other = around(FOLDING, 2.0, -1)
    legs = found.curve.legs
    assert len(legs) > 2
    changes = [k for k in range(1, len(legs)) if legs[k].led.lead != legs[k - 1].led.lead]
    refused = 0
    for k in changes:
        for leg in other.curve.legs:
            gap = leg.v[0] - legs[k].v[0]
            if leg.led.lead == legs[k].led.lead and np.abs(np.exp(1j * gap) - 1).max() > 1e-3:
                proof = prove_curve(leads, tampered(found.curve, k, leg))
                assert not proof.whole
                refused += 1
    assert refused > 0


def test_a_curve_that_comes_to_another_position_is_not_closed() -> None:
    leads, found = around(FOLDING, 2.0, 1)
    assert found.curve.passes
    halfway = found.curve.passes[0][0]
    short = Curve(
        legs=found.curve.legs[: halfway + 1], end=CircuitEnd.CLOSED, passes=found.curve.passes
    )
    proof = prove_curve(leads, short)
    assert proof.whole
    assert not proof.closed


def test_a_leg_that_was_left_out_is_missed() -> None:
    leads, found = around(FOLDING, 2.0, 1)
    for k in range(1, len(found.curve.legs) - 1):
        legs = (*found.curve.legs[:k], *found.curve.legs[k + 1 :])
        proof = prove_curve(leads, replace(found.curve, legs=legs))
        assert not proof.whole


def test_a_parameter_that_determines_nothing_cannot_start_a_curve() -> None:
    leads = ParametrizedTable(four_bar_table(FOLDING), PATH, 0)
    leads._leads[leads.parameter] = None
    with pytest.raises(ValueError, match=r"^the parameter of a curve must determine the position$"):
        trace(leads, np.zeros(3), 1.0)


def test_solvers_of_leaders_serve_all_paths_of_one_input_and_are_not_copied() -> None:
    compiled = lw.example("four-bar").model.compiled
    paths = [InputPath(origin=np.zeros(1), rate=np.full(1, rate), size=1.0) for rate in (1.0, 2.0)]
    first, second = (
        ParametrizedTable(compiled.table, path, 0, compiled.leaders).with_parameter(0)
        for path in paths
    )
    assert first is not None
    assert second is not None
    assert first is not second
    assert first.solver is second.solver
    own = ParametrizedTable(compiled.table, paths[0], 0, compiled.leaders).with_parameter(2)
    assert own is not None
    assert own.solver is compiled.solver
    copy = pickle.loads(pickle.dumps(compiled.leaders))
    assert copy._found.keys() == {2}
    assert copy.led_by(0)[0] is not first.solver
    robot = lw.example("five-bar-robot").model.compiled
    shared = robot.leaders
    path = InputPath(origin=np.zeros(2), rate=np.array([1.0, -1.0]), size=1.0)
    locked = ParametrizedTable(robot.table, path, 0, shared).with_parameter(0)
    assert locked is not None
    assert not shared._found
