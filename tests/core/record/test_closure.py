"""Closure equations and small linear solvers over lanes against the scalar ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.foundation.arrays import BoolArray
from linkwork.core.record.closure import BlockPart, Closure, solve_linear
from linkwork.core.record.recorder import Recorder, Value
from linkwork.core.table.loop_table import LoopTable
from tests.campaigns.positions import random_position
from tests.core.record.random_tables import random_example
from tests.core.record.running import ran

Array = npt.NDArray[np.float64]


def coefficients(table: LoopTable, count: int) -> dict[str, Array]:
    """What the programs of a table read, the same in all lanes."""
    given = {}
    for term, c in enumerate(table.loops.coefficient.tolist()):
        given[f"c{term}.re"], given[f"c{term}.im"] = np.full(count, c.real), np.full(count, c.imag)
    for row, constant in enumerate(table.linear.constant.tolist()):
        given[f"k{row}"] = np.full(count, constant)
    return given


def zeros_of(table: LoopTable) -> set[str]:
    """Coefficients that are zero."""
    return {name for name, values in coefficients(table, 1).items() if not values.any()}


# ------------------------------------------------------------------ equations


@pytest.mark.parametrize("seed", range(60))
def test_residual_and_jacobian_are_those_of_the_table(seed: int) -> None:
    rng = np.random.default_rng(seed)
    example = random_example(seed)
    table = replace(
        example.table,
        functions=(),
        equation_scale=example.table.equation_scale[: 2 * example.table.loops.rows],
    )
    left_out = rng.random(len(table.loops.coefficient)) < 0.2
    parts = table.loops.coefficient.copy()
    parts[left_out] = rng.choice([0.0, 1.5, 2.0j], left_out.sum())
    table = replace(table, loops=replace(table.loops, coefficient=parts))
    rows = table.loops.rows + len(table.linear.constant)
    order = rng.permutation(rows).tolist()  # of the equations that a block has
    chosen = tuple(order[: int(rng.integers(1, rows + 1))])
    v = rng.uniform(-30, 30, (5, table.variables))
    rec = Recorder()
    variables = [rec.input(f"v{k}") for k in range(table.variables)]
    part = BlockPart(equations=chosen, unknowns=tuple(range(table.unknowns)))
    closure = Closure(table, part, rec, variables, zeros_of(table))
    columns = list(range(table.variables))
    for i, (f, row) in enumerate(zip(closure.residual(), closure.jacobian(columns), strict=True)):
        rec.write(f"f{i}", f)
        for k, x in enumerate(row):
            rec.write(f"j{i},{k}", x)
    found = ran(rec, coefficients(table, 5) | {f"v{k}": v[:, k] for k in columns})
    residual, jacobian = table.residual_and_jacobian(v)
    loops = [k for k in chosen if k < table.loops.rows]
    lines = [table.loops.rows + k for k in chosen if k >= table.loops.rows]  # behind both parts
    mine = [*loops, *[table.loops.rows + k for k in loops], *lines]
    size = 1e-13 * (1 + np.abs(jacobian).max())
    for i, k in enumerate(mine):
        np.testing.assert_allclose(found[f"f{i}"], residual[:, k], rtol=0, atol=100 * size)
        for column in columns:
            np.testing.assert_allclose(
                found[f"j{i},{column}"], jacobian[:, k, column], rtol=0, atol=size
            )
    used = {k for row in mine for k in np.flatnonzero(np.abs(jacobian[:, row]).max(axis=0))}
    assert used - set(part.unknowns) <= set(closure.known())


def test_weights_of_one_variable_are_added_only_where_that_rounds_nothing() -> None:
    placed = random_position(4)
    rows = replace(
        placed.table.loops,
        phase_term=np.array([0, 0, 1, 1, 2, 2]),
        phase_variable=np.array([0, 0, 0, 0, 0, 0]),
        phase_weight=np.array([1.0, 2.0, 1 / 3, 2 / 3, 1.0, -1.0]),
    )
    table = replace(placed.table, loops=rows)
    rec = Recorder()
    part = BlockPart(equations=(0,), unknowns=tuple(range(table.unknowns)))
    closure = Closure(table, part, rec, [rec.input(f"v{k}") for k in range(table.variables)])
    assert closure.phases[0] == ((0, 3.0),)
    assert closure.phases[1] == ((0, 1 / 3), (0, 2 / 3))  # together not quite 1
    assert closure.phases[2] == ()


# ------------------------------------------------------------------ linear systems


def solutions(matrices: Array, sides: Array, structural: BoolArray) -> tuple[Array, Array]:
    """X (M, n, s) and det (M,) by the recorded solver; ``structural`` (n, n): known zeros."""
    n = matrices.shape[1]
    rec = Recorder()
    given = {f"a{i},{k}": matrices[:, i, k] for i in range(n) for k in range(n)}
    given |= {f"b{s},{i}": sides[:, i, s] for s in range(sides.shape[2]) for i in range(n)}

    def entry(i: int, k: int) -> Value | float:
        return 0.0 if structural[i, k] else rec.input(f"a{i},{k}")

    answer = solve_linear(
        rec,
        [[entry(i, k) for k in range(n)] for i in range(n)],
        [[rec.input(f"b{s},{i}") for i in range(n)] for s in range(sides.shape[2])],
    )
    for s, column in enumerate(answer.columns):
        for i, value in enumerate(column):
            rec.write(f"x{s},{i}", value)
    rec.write("det", answer.determinant)
    found = ran(rec, given)
    x = np.stack(
        [np.stack([found[f"x{s},{i}"] for i in range(n)], 1) for s in range(sides.shape[2])], 2
    )
    return x, found["det"]


def assert_solved(
    matrices: Array, sides: Array, structural: BoolArray, growth: float = 30.0
) -> None:
    """As good as NumPy's, in proportion to the condition."""
    x, det = solutions(matrices, sides, structural)
    true, true_det = np.linalg.solve(matrices, sides), np.linalg.det(matrices)
    condition = np.linalg.cond(matrices)
    off = np.abs(x - true).max(axis=(1, 2)) / np.abs(true).max(axis=(1, 2))
    assert (off <= growth * len(matrices[0]) * 2.0**-52 * condition).all()
    large = condition < 1e12
    np.testing.assert_array_equal(np.sign(det[large]), np.sign(true_det[large]))
    np.testing.assert_allclose(det, true_det, rtol=1e-3 if condition.max() > 1e9 else 1e-9)


@pytest.mark.parametrize("n", range(1, 8))
def test_systems_are_solved_as_numpy_solves_them(n: int) -> None:
    rng = np.random.default_rng(n)
    matrices, sides = rng.normal(size=(200, n, n)), rng.normal(size=(200, n, 3))
    none = np.zeros((n, n), dtype=bool)
    assert_solved(matrices, sides, none, growth=300.0 if n == 2 else 30.0)


@pytest.mark.parametrize("n", range(2, 8))
@pytest.mark.parametrize("seed", range(4))
def test_known_zeros_and_pivots_that_vanish_in_some_lanes(n: int, seed: int) -> None:
    rng = np.random.default_rng([n, seed])
    structural = rng.random((n, n)) < 0.5
    order = rng.permutation(n)
    structural[order, np.arange(n)] = False  # so that the matrix is not singular as such
    matrices = np.where(structural, 0.0, rng.normal(size=(300, n, n)))
    matrices[:100, 0, 0] = 0.0  # the first pivot of some lanes
    if n > 2:
        matrices[100:200, :2, :2] = np.array([[1.0, 2.0], [2.0, 4.0]])  # the second one
        matrices = np.where(structural, 0.0, matrices)
    regular = np.linalg.cond(matrices) < 1e6
    assert regular.any()
    sides = rng.normal(size=(300, n, 2))
    assert_solved(matrices[regular], sides[regular], structural, growth=1000.0)


@pytest.mark.parametrize("n", range(1, 8))
def test_nearly_singular_systems(n: int) -> None:
    rng = np.random.default_rng([n, 5])
    u = np.linalg.qr(rng.normal(size=(100, n, n)))[0]
    w = np.linalg.qr(rng.normal(size=(100, n, n)))[0]
    values = np.ones((100, n))
    values[:, -1] = 10.0 ** rng.uniform(-10, -5, 100)
    matrices = u * values[:, None, :] @ w
    sides = rng.normal(size=(100, n, 1))
    none = np.zeros((n, n), dtype=bool)
    assert_solved(matrices, sides, none, growth=100.0)


@pytest.mark.parametrize("n", range(1, 8))
def test_a_singular_system_has_no_finite_solution(n: int) -> None:
    none = np.zeros((n, n), dtype=bool)
    matrices = np.ones((2, n, n)) if n > 1 else np.zeros((2, 1, 1))
    x, det = solutions(matrices, np.eye(n)[None].repeat(2, axis=0), none)
    assert not (np.abs(det) > 0.0).any()  # zero, or not a number
    assert not np.isfinite(x).all(axis=(1, 2)).any()
    known = none.copy()
    known[:, 0] = True  # a column that is known to be zero
    x, det = solutions(matrices, np.eye(n)[None].repeat(2, axis=0), known)
    assert not np.isfinite(x).all(axis=(1, 2)).any()
