"""Proofs over lanes against the scalar ones, and in front of the referee in ball arithmetic.

The referee lives in ``tests/campaigns``; ``scripts/campaign lanes`` runs it on more.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.numerics.kantorovich import weighted_radii
from linkwork.core.table.loop_table import LoopTable
from tests.campaigns.lanes import LaneClaims, claims, judge_lane_steps, judge_lanes
from tests.campaigns.positions import closed, random_position
from tests.core.numerics.proof_bounds import bounds

Array = npt.NDArray[np.float64]
LANES = 24


def example(seed: int) -> tuple[list[LoopTable], Array, Array, LaneClaims]:
    """A random table in lanes of its own coefficients, not quite at positions."""
    rng = np.random.default_rng([31, seed])
    placed = random_position(seed)
    table, n = placed.table, placed.table.unknowns
    tables, places = [], []
    for _ in range(LANES):
        place = placed.v + rng.normal(size=table.variables) * table.variable_scale
        tables.append(closed(table, place))
        off = 10 ** rng.uniform(-6, -2) * rng.normal(size=n)
        places.append(np.concatenate([place[:n] + off * table.variable_scale[:n], place[n:]]))
    v = np.stack(places)
    known = 10 ** rng.uniform(-6, -1, (LANES, table.variables - n)) * table.variable_scale[n:]
    return tables, v, known, claims(tables, v, known)


def has_a_variable_twice(table: LoopTable) -> bool:
    """In one phase: lanes add its weights, which may cancel."""
    rows = table.loops
    pairs = list(zip(rows.phase_term.tolist(), rows.phase_variable.tolist(), strict=True))
    return len(set(pairs)) < len(pairs)


@pytest.mark.parametrize("seed", range(30))
def test_constants_and_radii_are_those_of_the_scalar_proof(seed: int) -> None:
    tables, v, known, lanes = example(seed)
    sharper = has_a_variable_twice(tables[0])
    held = 0
    for k, table in enumerate(tables):
        n = table.unknowns
        jacobian = table.jacobian(v[k : k + 1])
        if not np.linalg.cond(jacobian[0, :, :n]) < 1e6:
            continue
        inverse = lanes.inverse[k : k + 1]
        scalar = bounds(table, v[k : k + 1], jacobian, inverse, known[k : k + 1])
        # rounding is counted coarser: up to so many units of what the inverse makes of the terms
        weights = table.variable_scale
        terms = table.loops.moduli(v[k : k + 1], np.ones((1, len(table.loops.row))))[1][0]
        lines = np.abs(jacobian[0, 2 * len(terms) :])
        size = np.abs(inverse[0]) @ (np.concatenate([terms, terms, lines]) @ weights) / weights[:n]
        angles = 1.0 + np.abs(v[k]) @ table.is_angle
        loose = 2.0**-53 * 100 * n * size * angles
        for name, own, other in (
            ("y", lanes.bounds.y[k], scalar.y[0]),
            ("z", lanes.bounds.z[k], scalar.z[0]),
            ("ω", lanes.bounds.omega[k], scalar.omega[0]),
            ("growth of ω", lanes.bounds.omega_slope[k], scalar.omega_slope[0]),
        ):
            room = loose if name in "yz" else 0.0 * own
            assert (own <= other * (1 + 1e-10) + room).all(), name
            if not sharper:
                assert (own >= other * (1 - 1e-10) - 0.1 * room).all(), name
        one = weighted_radii(scalar, weights[:n])
        assert lanes.radii.holds[k] == one.holds[0] or sharper
        if sharper or not one.holds[0]:
            continue
        held += 1
        for own, other in (
            (lanes.radii.existence_radius[k], one.existence_radius[0]),
            (lanes.radii.uniqueness_radius[k], one.uniqueness_radius[0]),
            (lanes.radii.error_bound[k], one.error_bound[0]),
            (lanes.radii.isolation_radius[k], one.isolation_radius[0]),
        ):
            np.testing.assert_allclose(own, other, rtol=1e-5)
    assert held or sharper or seed % 3 == 0


@pytest.mark.parametrize(
    "part", [0, *[pytest.param(k, marks=pytest.mark.extended) for k in range(1, 4)]]
)
def test_where_lanes_claim_a_position_there_is_one(part: int) -> None:
    verdict = judge_lanes(range(part * 8, part * 8 + 8), part)
    assert verdict.false == []
    assert verdict.counts["positions"] > 500
    assert verdict.counts["proved"] > 250
    assert verdict.counts["not proved"] > 25
    assert verdict.counts["uncertain inputs"] > 250


@pytest.mark.parametrize("part", range(2))
def test_steps_to_another_branch_are_never_proved(part: int) -> None:
    verdict = judge_lane_steps(range(part * 12, part * 12 + 12), part)
    assert verdict.false == []
    assert verdict.counts["wrong steps"] > 1000
    assert verdict.counts["right steps proved"] > 0.7 * verdict.counts["right steps"] > 70


def test_angles_too_large_for_sine_and_cosine_prove_nothing() -> None:
    placed = random_position(4)  # links that turn
    n = placed.table.unknowns
    places = placed.v + np.array([0.0, 1e5, 1e7, 1e9, 1e15])[:, None]
    tables = [closed(placed.table, place) for place in places]
    found = claims(tables, places, np.zeros((5, placed.table.variables - n)))
    assert found.radii.holds.tolist() == [True, True, False, False, False]
