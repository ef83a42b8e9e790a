"""The smallest singular value along a circuit, against closed forms and dense samples."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb, ctx

import linkwork as lw
from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.motion.model import leading_input
from linkwork.core.numerics.branch_tracking import InputPath
from tests.oracles.four_bar import FourBar, random_crank_rockers
from tests.thinned import thinned

Array = npt.NDArray[np.float64]
LOOP = {"1": "b*e^(i*t) + c*e^(i*p) = a + d*e^(i*q)"}


def four_bar(bar: FourBar, theta: float, side: int) -> lw.Mechanism:
    coupler, rocker = bar.phasors(np.array(theta), side)
    return lw.loops(
        angle="rad",
        loops=LOOP,
        dimensions={"a": bar.r1, "b": bar.r2, "c": bar.r3, "d": bar.r4},
        guess={"t": theta, "p": float(np.angle(coupler)), "q": float(np.angle(rocker))},
        inputs=lw.Input(variable="t", from_=0, to=6, step=1),
    )


def exact(bar: FourBar, scale: float) -> list[tuple[float, float]]:
    """σ at crank angles 0 and π, in balls.

    With the columns c and d long and the angle γ between coupler and rocker the squares of both
    singular values have the sum c² + d² and the product (c d sin γ)²; sin γ is smallest where
    crank and ground are in line.
    """
    ctx.prec = 200
    a, b, c, d = (arb(x) for x in (bar.r1, bar.r2, bar.r3, bar.r4))
    found = []
    for theta, base in ((0.0, a - b), (math.pi, a + b)):
        cosine = (c**2 + d**2 - base**2) / (2 * c * d)
        total, product = c**2 + d**2, (c * d) ** 2 * (1 - cosine**2)
        square = 2 * product / (total + (total**2 - 4 * product).sqrt())
        found.append((float((square.sqrt() / scale).mid()), theta))
    return found


def scale_of(mechanism: lw.Mechanism) -> float:
    (scale,) = set(mechanism.model.compiled.table.equation_scale.tolist())
    return float(scale)


def singular_values(mechanism: lw.Mechanism, q: Array, inputs: Array) -> Array:
    """Of the scaled Jacobian by the unknowns at positions (B, n), smallest ones (B,)."""
    table = mechanism.model.compiled.table
    v = np.concatenate([q, inputs[:, None]], axis=1)
    scaled = table.jacobian(v) * table.variable_scale / table.equation_scale[:, None]
    return np.asarray(np.linalg.svd(scaled[:, :, :-1], compute_uv=False)[:, -1])


def test_crank_rockers_are_weakest_where_crank_and_ground_line_up() -> None:
    for number, bar in enumerate(random_crank_rockers(12, seed=8)):
        mechanism = four_bar(bar, 1.0, 1 if number % 2 else -1)
        value, at = min(exact(bar, scale_of(mechanism)))
        circuits = mechanism.circuits()
        assert len(circuits) == 2
        for circuit in circuits:
            assert circuit.smallest_singular_value == pytest.approx(value, rel=1e-12)
            assert abs(math.remainder(circuit.weakest - at, 2 * math.pi)) < 1e-12


@pytest.mark.parametrize("exponent", range(1, 12))
def test_near_a_change_point_the_smallest_value_is_the_root_of_what_is_missing(
    exponent: int,
) -> None:
    gap = 10.0**-exponent
    mechanism = four_bar(FourBar(4.5 - gap, 1.0, 2.5, 3.0), 1.0, 1)
    bar = FourBar(4.5 - gap, 1.0, 2.5, 3.0)
    value, _ = min(exact(bar, scale_of(mechanism)))
    assert value == pytest.approx(0.51687 * math.sqrt(gap), rel=0.2 * gap + 1e-4)
    for circuit in mechanism.circuits():
        # the gap is known to the rounding of the lengths only
        found = circuit.smallest_singular_value
        assert found == pytest.approx(value, rel=1e-13 + 1e-15 / gap)
        assert abs(math.remainder(circuit.weakest - math.pi, 2 * math.pi)) < 1e-12


@pytest.mark.parametrize("name", thinned(["rapier-drive", "stephenson-far-crank", "jansen-leg"], 3))
def test_no_sample_of_a_fine_table_is_weaker(name: str) -> None:
    mechanism = lw.example(name)
    motion = mechanism.sweep(from_=0, to=360, step=0.02, certify=False)
    assert motion.found.all()
    (column,) = motion.inputs.values()
    values = singular_values(mechanism, motion.q, np.radians(column))
    circuit = mechanism.circuits()[0]
    best = int(np.argmin(values))
    assert circuit.turns == 1
    assert circuit.smallest_singular_value <= values[best] * (1 + 1e-13)
    assert circuit.smallest_singular_value == pytest.approx(values[best], rel=1e-6)
    assert abs(math.remainder(circuit.weakest - column[best], 360.0)) <= 0.02
    exact_place = mechanism.solve(at=circuit.weakest)
    there = singular_values(mechanism, exact_place.q[None, :], np.radians([circuit.weakest]))
    assert there[0] == pytest.approx(circuit.smallest_singular_value, rel=1e-11)


def test_at_dead_points_and_change_points_the_value_vanishes() -> None:
    for bar in (FourBar(4.0, 2.0, 5.0, 2.0), FourBar(4.0, 1.0, 3.0, 2.0)):
        mechanism = four_bar(bar, 2.0, 1)
        for circuit in mechanism.circuits():
            rows = np.flatnonzero(np.array(circuit.motion.limit) != "")
            assert len(rows)
            assert circuit.smallest_singular_value == 0.0
            values = singular_values(mechanism, circuit.motion.q[rows], circuit["t"][rows])
            assert values.max() < 1e-13
            places = {limit.input for limit in (*circuit.dead_points, *circuit.change_points)}
            assert min(abs(circuit.weakest - place) for place in places) < 1e-12


def test_the_rate_of_the_smallest_value_is_its_slope() -> None:
    mechanism = lw.example("rapier-drive")
    model = mechanism.model
    lead, rate = leading_input(model.rows)
    leads = ParametrizedTable(model.compiled.table, InputPath(origin=np.zeros(1), rate=rate), lead)
    led = leads.with_parameter(leads.parameter)
    assert led is not None
    step = 1e-5
    for at in (20.0, 110.0, 250.0):
        around = [mechanism.solve(at=at + math.degrees(h)) for h in (-step, 0.0, step)]
        v = np.array(
            [[*p.q, math.radians(at) + h] for p, h in zip(around, (-step, 0.0, step), strict=True)]
        )
        values = np.linalg.svd(leads.jacobian(v), compute_uv=False)[:, -1]
        node = led.node(v[1])
        slope = leads.weakening(led.whole(node.v), led.whole(node.first))
        assert slope == pytest.approx((values[2] - values[0]) / (2 * step), abs=1e-9)
