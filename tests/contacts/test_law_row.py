"""Rows with laws, and how fast tables with such rows bend, against ball arithmetic."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb, ctx

from linkwork.contacts.profiles import Outline, program
from linkwork.core.numerics.kantorovich import weighted_radii
from linkwork.core.table.loop_table import LoopTable, TableSplitter
from linkwork.core.table.rows import LawRow, LinearRows, PhasorRows
from tests.core.numerics.proof_bounds import bounds
from tests.oracles.ball_laws import ball_jet
from tests.oracles.balls import BallTable, certainly_above, exactly, newton

Array = npt.NDArray[np.float64]
TURN = 2.0 * math.pi


def random_law(rng: np.random.Generator, variables: tuple[int, ...]) -> LawRow:
    over = rng.uniform(0.2, 1.0, 3)
    over *= TURN / over.sum()
    lift = float(rng.uniform(0.5, 2.0))
    laws = rng.choice(["harmonic", "cycloidal", "modified sine", "4-5-6-7"], 2)
    closed = [
        (str(laws[0]), float(over[0]), lift),
        ("dwell", float(over[1]), 0.0),
        (str(laws[1]), float(over[2]), -lift),
    ]
    points = [complex(*z) for z in np.cumsum(rng.uniform(0.3, 1.0, (6, 2)), axis=0)]
    law = program(closed) if rng.random() < 0.6 else Outline.through(points, closed=False).y
    count = len(variables)
    return LawRow(
        variables=variables,
        weights=rng.choice([1.0, 0.0, -1.0, 0.3], count),
        constant=float(rng.normal()),
        law=law,
        inner=rng.choice([1.0, 0.0, -2.0, 1 / 3], count),
        offset=float(rng.normal()),
    )


@pytest.mark.parametrize("seed", range(20))
def test_value_and_gradient_are_as_near_the_truth_as_their_rounding_claims(seed: int) -> None:
    ctx.prec = 200
    rng = np.random.default_rng(seed)
    row = random_law(rng, (3, 0, 2))
    v = rng.uniform(-3, 3, (20, 4)) * 10 ** rng.uniform(0, 3, (20, 1))
    value, gradient = row.value_and_gradient(v)
    error, errors = row.rounding(v)
    for k in range(len(v)):
        x = [arb(float(number)) for number in v[k, [3, 0, 2]]]
        argument = sum((arb(float(w)) * y for w, y in zip(row.inner, x, strict=True)), arb(0))
        true = ball_jet(row.law, argument + arb(row.offset))
        straight = sum((arb(float(a)) * y for a, y in zip(row.weights, x, strict=True)), arb(0))
        exact = straight + arb(row.constant) - true[0]
        assert abs(exact - arb(float(value[k]))) <= arb(float(error[k]))
        for j in range(3):
            slope = arb(float(row.weights[j])) - true[1] * arb(float(row.inner[j]))
            assert abs(slope - arb(float(gradient[k, j]))) <= arb(float(errors[k, j]))
    assert np.median(error) < 1e-10


@pytest.mark.parametrize("seed", range(6))
def test_second_derivative_along_a_direction_is_the_slope_of_the_gradient(seed: int) -> None:
    rng = np.random.default_rng(seed)
    row = random_law(rng, (0, 1))
    d = rng.normal(size=(200, 2))
    v = rng.uniform(-2, 2, (200, 2))
    h = 1e-6
    ahead, behind = (row.value_and_gradient(v + side * h * d)[1] for side in (1, -1))
    slope = ((ahead - behind) * d).sum(axis=1) / (2 * h)
    joints = (
        np.abs(
            row.second_directional_derivative(v + h * d, d)
            - row.second_directional_derivative(v - h * d, d)
        )
        > 1e-2 * row.bend
    )
    assert joints.mean() < 0.1
    # no fourth derivative here exceeds a thousand times the second one
    allowed = 1e-4 * row.bend * np.abs(d).max() ** 2 + 1e-8
    assert np.abs(row.second_directional_derivative(v, d) - slope)[~joints].max() < allowed


def test_a_row_over_renumbered_variables_is_the_same() -> None:
    rng = np.random.default_rng(5)
    row = random_law(rng, (1, 3))
    v = rng.normal(size=(5, 4))
    moved = row.moved({1: 0, 3: 2})
    w = np.stack([v[:, 1], np.zeros(5), v[:, 3]], axis=1)
    for own, other in zip(row.value_and_gradient(v), moved.value_and_gradient(w), strict=True):
        np.testing.assert_array_equal(own, other)


def random_table(rng: np.random.Generator) -> LoopTable:
    """A loop of two unknown angles, lengths X and Y that laws give, and an input angle."""
    # variables: t0, t1 (angles), X, Y (lengths), then the input
    terms = [
        (2.0, -1, [(0, 1.0)]),
        (1.5, -1, [(1, 1.0)]),
        (-1.0, 2, [(4, 1.0)]),
        (-1j, 3, [(4, 1.0), (0, 1.0)]),
    ]
    phases = [(t, k, w) for t, (_, _, phase) in enumerate(terms) for k, w in phase]
    laws = (random_law(rng, (2, 0, 4)), random_law(rng, (3, 1, 0)))
    return LoopTable(
        unknowns=4,
        loops=PhasorRows(
            rows=1,
            variables=5,
            row=np.zeros(len(terms), dtype=np.intp),
            coefficient=np.array([c for c, _, _ in terms], dtype=complex),
            length=np.array([length for _, length, _ in terms], dtype=np.intp),
            phase_term=np.array([t for t, _, _ in phases], dtype=np.intp),
            phase_variable=np.array([k for _, k, _ in phases], dtype=np.intp),
            phase_weight=np.array([w for _, _, w in phases], dtype=float),
        ),
        linear=LinearRows.none(),
        functions=laws,
        equation_scale=np.ones(4),
        variable_scale=rng.uniform(0.5, 3.0, 5),
        is_angle=np.array([True, True, False, False, True]),
    )


@pytest.mark.parametrize("seed", range(6))
def test_a_sum_that_cancels_is_known_as_badly_as_its_parts(seed: int) -> None:
    ctx.prec = 200
    rng = np.random.default_rng(seed)
    law = random_law(rng, (0, 1)).law
    row = LawRow(
        variables=(0, 1),
        weights=np.zeros(2),
        constant=0.0,
        law=law,
        inner=np.array([1 / 3, -1 / 7]),
        offset=0.1,
    )
    x = rng.uniform(1e9, 2e9, 50)
    v = np.stack([3 * x, 7 * x + rng.uniform(0, 6, 50)], axis=1)
    value, gradient = row.value_and_gradient(v)
    error, errors = row.rounding(v)
    for k in range(50):
        argument = arb(float(v[k, 0])) * arb(1 / 3) - arb(float(v[k, 1])) * arb(1 / 7)
        true = ball_jet(law, argument + arb(0.1))
        assert abs(true[0] + arb(float(value[k]))) <= arb(float(error[k]))
        for j in range(2):
            slope = -true[1] * arb(float(row.inner[j]))
            assert abs(slope - arb(float(gradient[k, j]))) <= arb(float(errors[k, j]))


@pytest.mark.parametrize("seed", range(6))
def test_where_a_law_bends_most_the_constant_is_that_bend(seed: int) -> None:
    rng = np.random.default_rng(seed)
    law = random_law(rng, (0,)).law
    x = np.linspace(law.breaks[0], law.breaks[-1], 100_001)
    largest = float(np.abs(law.jet(x)[2]).max())
    w, scale, a = 3.0, 0.7, -2.0
    table = LoopTable(
        unknowns=1,
        loops=PhasorRows(
            rows=0,
            variables=1,
            row=np.zeros(0, dtype=np.intp),
            coefficient=np.zeros(0, dtype=complex),
            length=np.zeros(0, dtype=np.intp),
            phase_term=np.zeros(0, dtype=np.intp),
            phase_variable=np.zeros(0, dtype=np.intp),
            phase_weight=np.zeros(0),
        ),
        linear=LinearRows.none(),
        functions=(
            LawRow(
                variables=(0,), weights=np.ones(1), constant=0.0, law=law, inner=np.array([w]),
                offset=0.0,
            ),
        ),
        equation_scale=np.ones(1),
        variable_scale=np.array([scale]),
        is_angle=np.array([True]),
    )  # fmt: skip
    v = np.array([[0.3]])
    b = bounds(table, v, table.jacobian(v), np.array([[[a]]]), np.zeros((1, 0)))
    exact = abs(a) * largest * w**2 * scale
    assert exact <= b.omega[0, 0] <= 1.02 * exact


@pytest.mark.parametrize("seed", range(25))
def test_no_constant_of_a_proof_with_laws_is_too_small(seed: int) -> None:
    rng = np.random.default_rng(seed)
    table = random_table(rng)
    v = rng.uniform(-2, 2, (1, 5))
    jacobian = table.jacobian(v)
    if abs(np.linalg.det(jacobian[0, :, :4])) < 1e-2:
        v[0, :2] += 0.7
        jacobian = table.jacobian(v)
    matrix = np.asarray(np.linalg.inv(jacobian[:, :, :4]), dtype=float)
    spread = 10 ** (rng.uniform(-12, -1) if seed % 3 else rng.uniform(-0.3, 0.3))
    b = bounds(table, v, jacobian, matrix, np.array([[spread]]))
    balls, w = BallTable(table), table.variable_scale[:4]
    a = matrix[0]

    def reduced(at: Array) -> Array:
        """A J by the unknowns, as the referee computes it."""
        slope = balls.jacobian(exactly(at))
        own = np.array([[float(slope[i, j].mid()) for j in range(4)] for i in range(4)])
        return np.asarray(a @ own)

    size = 10 ** rng.uniform(-4, 0)
    for _ in range(12):
        known = v[0].copy()
        known[4] += rng.choice([-1.0, 1.0, rng.uniform(-1, 1)]) * spread
        true_y = balls.reduced_residual(exactly(known), a)
        for i in range(4):
            assert not certainly_above(abs(true_y[i]) / arb(float(w[i])), b.y[0, i])
        defect = np.abs(np.eye(4) - reduced(known)) @ w / w
        assert (defect <= b.z[0] * (1 + 1e-12) + 1e-12).all()
        x, y = known.copy(), known.copy()
        x[:4] += size * w * rng.uniform(-1, 1, 4)
        y[:4] += size * w * rng.uniform(-1, 1, 4)
        far = max(np.abs((p - known)[:4] / w).max() for p in (x, y))
        change = np.abs(reduced(x) - reduced(y)) @ w / w
        apart = np.abs((x - y)[:4] / w).max()
        # within ρ of v the derivative changes no faster than ω0 + ρ ω1
        allowed = (b.omega[0] + far * b.omega_slope[0]) * apart
        assert (change <= allowed * (1 + 1e-9) + 1e-12).all()


def test_a_radius_with_laws_holds_a_root() -> None:
    proved = 0
    for seed in range(60):
        rng = np.random.default_rng(1000 + seed)
        table = random_table(rng)
        root, sure = newton(BallTable(table), exactly(rng.uniform(-2, 2, 5)))
        if not sure:
            continue
        v = np.array([[float(x.mid()) for x in root]])
        v[0, :4] += rng.normal(size=4) * 10 ** rng.uniform(-14, -5)
        jacobian = table.jacobian(v)
        matrix = np.asarray(np.linalg.inv(jacobian[:, :, :4]), dtype=float)
        shift = arb(float(v[0, 4])) - root[4]
        found = weighted_radii(
            bounds(table, v, jacobian, matrix, np.abs([[float(shift)]])), table.variable_scale[:4]
        )
        if not found.holds[0]:
            continue
        proved += 1
        for i in range(4):
            off = abs(root[i] - arb(float(v[0, i])))
            assert off <= arb(float(found.error_bound[0, i]))
            assert off / arb(float(table.variable_scale[i])) <= arb(
                float(found.existence_radius[0])
            )
    assert proved > 15


def test_a_part_of_a_table_keeps_its_laws() -> None:
    rng = np.random.default_rng(3)
    table = random_table(rng)
    v = rng.normal(size=(3, 5))
    part, known = TableSplitter(table).part([2], [3])
    columns = [3, *known]
    assert known == [0, 1]
    np.testing.assert_array_equal(
        part.residual_and_jacobian(v[:, columns])[0][:, 0], table.residual(v)[:, 3]
    )
    np.testing.assert_array_equal(
        part.jacobian(v[:, columns])[:, 0], table.jacobian(v)[:, 3][:, columns]
    )


def test_a_law_of_what_is_known_is_straight_and_one_of_an_unknown_is_not() -> None:
    rng = np.random.default_rng(4)
    row = random_law(rng, (0, 1))
    straight = LawRow(
        variables=(0, 1),
        weights=np.array([1.0, 0.0]),
        constant=0.0,
        law=row.law,
        inner=np.array([0.0, 1.0]),
        offset=0.0,
    )
    nothing = PhasorRows(
        rows=0,
        variables=2,
        row=np.zeros(0, dtype=np.intp),
        coefficient=np.zeros(0, dtype=complex),
        length=np.zeros(0, dtype=np.intp),
        phase_term=np.zeros(0, dtype=np.intp),
        phase_variable=np.zeros(0, dtype=np.intp),
        phase_weight=np.zeros(0),
    )

    def table(unknowns: int, law: LawRow) -> LoopTable:
        return LoopTable(
            unknowns=unknowns,
            loops=nothing,
            linear=LinearRows.none(),
            functions=(law,),
            equation_scale=np.ones(1),
            variable_scale=np.ones(2),
            is_angle=np.array([False, True]),
        )

    assert table(1, straight).is_straight
    assert not table(2, straight).is_straight
    assert not random_table(rng).is_straight
