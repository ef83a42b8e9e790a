"""The loop table's arrays against the same equations in cosines and sines."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.table.loop_table import TableSplitter
from tests.core.record.random_tables import Example, random_example

# A complex step has no truncation error at this size, and nothing cancels.
STEP = 1e-30
# Rounding of a sum of a dozen terms is near 1e-15 of the largest; five digits of reserve.
CLOSE = 1e-10

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def examples() -> list[Example]:
    return [random_example(seed) for seed in range(1000)]


def agree(found: Array, wanted: Array, scale: float) -> bool:
    return found.shape == wanted.shape and bool(np.all(np.abs(found - wanted) <= CLOSE * scale))


def size(example: Example) -> float:
    """What one term can contribute: variables stay below 2.5, weights below 2."""
    return 10.0 * max(1.0, *(abs(term.coefficient) for term in example.terms))


def test_the_random_tables_have_every_feature(examples: list[Example]) -> None:
    terms = [(example, term) for example in examples for term in example.terms]
    assert any(term.length is not None and not term.phase for _, term in terms)
    assert any(term.length is not None and term.phase for _, term in terms)
    assert any(len({k for k, _ in term.phase}) == 2 for _, term in terms)
    assert any(len(term.phase) == 2 and len({k for k, _ in term.phase}) == 1 for _, term in terms)
    assert {w for _, term in terms for _, w in term.phase} == {1.0, -1.0, 2.0, 0.5}
    assert any(example.lines and example.formulas for example in examples)
    kinds = [
        bool(example.table.is_angle[k])
        for example in examples
        for k in range(example.table.unknowns, example.table.variables)
    ]
    assert set(kinds) == {True, False}


def test_residual_equals_the_sums_of_cosines_and_sines(examples: list[Example]) -> None:
    for seed, example in enumerate(examples):
        wanted = example.residual(example.v).real
        assert agree(example.table.residual(example.v), wanted, size(example)), seed
        assert agree(example.table.residual_and_jacobian(example.v)[0], wanted, size(example)), seed


def test_jacobian_and_input_derivative_equal_complex_steps(examples: list[Example]) -> None:
    for seed, example in enumerate(examples[:400]):
        v = example.v
        wanted = np.empty((len(v), example.table.equations, example.table.variables))
        for k in range(example.table.variables):
            moved = v.astype(complex)
            moved[:, k] += 1j * STEP
            wanted[:, :, k] = example.residual(moved).imag / STEP
        assert agree(example.table.jacobian(v), wanted, size(example)), seed
        assert agree(example.table.residual_and_jacobian(v)[1], wanted, size(example)), seed


def test_second_derivative_equals_a_complex_step_of_the_first(examples: list[Example]) -> None:
    for seed, example in enumerate(examples):
        v, d = example.v, example.d
        wanted = example.slope(v + 1j * STEP * d, d).imag / STEP
        scale = size(example) * float(np.abs(d).max()) ** 2
        assert agree(example.table.second_directional_derivative(v, d), wanted, scale), seed


def test_hessians_of_sums_equal_second_derivatives_along_directions(
    examples: list[Example],
) -> None:
    rng = np.random.default_rng(2)
    for seed, example in enumerate(examples):
        table, d = example.table, example.d
        weights = rng.normal(size=(3, table.equations))
        scale = size(example) * float(np.abs(d).max()) ** 2 * float(np.abs(weights).sum())
        bends = table.second_directional_derivative(example.v, d)
        for v, direction, bend in zip(example.v, d, bends, strict=True):
            hessians = table.hessians(v, weights)
            assert agree(hessians @ direction @ direction, weights @ bend, scale), seed
            assert agree(hessians, hessians.transpose(0, 2, 1), scale), seed


def test_jet_of_a_curved_path_adds_the_slope_along_its_bend(examples: list[Example]) -> None:
    rng = np.random.default_rng(1)
    for seed, example in enumerate(examples[:200]):
        v, d, bend = example.v, example.d, rng.normal(size=example.v.shape)
        rows, loops = example.table.loops, example.table.loops.rows
        value, first, second = rows.jet(v, d, bend)

        def stacked(z: npt.NDArray[np.complex128]) -> Array:
            return np.concatenate([z.real, z.imag], axis=1)

        straight = example.slope(v + 1j * STEP * d, d).imag / STEP
        curved = straight + example.slope(v, bend).real
        scale = size(example) * float(np.abs(d).max() ** 2 + np.abs(bend).max())
        only = slice(2 * loops)
        assert agree(stacked(value), example.residual(v).real[:, only], scale), seed
        assert agree(stacked(first), example.slope(v, d).real[:, only], scale), seed
        assert agree(stacked(second), curved[:, only], scale), seed


def test_pattern_names_exactly_the_variables_of_each_equation(examples: list[Example]) -> None:
    for seed, example in enumerate(examples):
        table, loops = example.table, example.table.loops.rows
        wanted: list[set[int]] = [set() for _ in range(loops)]
        for term in example.terms:
            wanted[term.row] |= {k for k, _ in term.phase}
            wanted[term.row] |= set() if term.length is None else {term.length}
        wanted += [{k for k, _ in weights} for _, weights in example.lines]
        wanted += [set(used) for _, used in example.formulas]
        assert [set(used) for used in table.pattern()] == wanted, seed


def test_parts_of_a_table_are_the_rows_and_columns_of_the_whole(examples: list[Example]) -> None:
    rng = np.random.default_rng(2)
    for seed, example in enumerate(examples):
        table, loops = example.table, example.table.loops.rows
        equations = np.sort(rng.permutation(len(table.pattern()))[: rng.integers(1, 5)])
        used = sorted({k for e in equations for k in table.pattern()[e]})
        unknowns = [int(k) for k in rng.permutation(used)[: rng.integers(0, 1 + len(used))]]
        part, known = TableSplitter(table).part([int(e) for e in equations], unknowns)
        assert sorted([*unknowns, *known]) == used, seed
        assert part.unknowns == len(unknowns), seed
        inside = [e for e in equations if e < loops]
        rows = inside + [loops + e for e in inside] + [loops + e for e in equations if e >= loops]
        columns = [*unknowns, *known]
        f, jacobian = table.residual_and_jacobian(example.v)
        here = example.v[:, columns]
        own_f, own_jacobian = part.residual_and_jacobian(here)
        assert agree(own_f, f[:, rows], size(example)), seed
        assert agree(own_jacobian, jacobian[:, rows][:, :, columns], size(example)), seed
        bend = np.zeros_like(example.d)
        bend[:, columns] = example.d[:, columns]
        scale = size(example) * float(np.abs(example.d).max()) ** 2
        own_second = part.second_directional_derivative(here, bend[:, columns])
        assert agree(
            own_second, table.second_directional_derivative(example.v, bend)[:, rows], scale
        ), seed
        np.testing.assert_array_equal(part.equation_scale, table.equation_scale[rows])
        np.testing.assert_array_equal(part.variable_scale, table.variable_scale[columns])
        np.testing.assert_array_equal(part.is_angle, table.is_angle[columns])


def test_rows_of_a_batch_equal_the_same_rows_alone(examples: list[Example]) -> None:
    for seed, example in enumerate(examples[:200]):
        f, jacobian = example.table.residual_and_jacobian(example.v)
        for lane in range(len(example.v)):
            alone = example.table.residual_and_jacobian(example.v[lane : lane + 1])
            assert agree(alone[0][0], f[lane], size(example)), seed
            assert agree(alone[1][0], jacobian[lane], size(example)), seed


def test_equations_repeat_after_whole_turns_where_their_values_do(examples: list[Example]) -> None:
    rng = np.random.default_rng(5)
    repeating = 0
    for seed, example in enumerate(examples):
        table = example.table
        turns = np.where(table.is_angle, rng.integers(-2, 3, table.variables), 0.0)
        if not turns.any() or example.formulas:
            continue
        moved = table.residual(example.v + 2.0 * np.pi * turns)
        same = agree(moved, table.residual(example.v), size(example))
        assert table.repeats_after(turns) == same, seed
        repeating += same
    assert 20 < repeating < 900


def test_functions_of_angles_are_not_known_to_repeat(examples: list[Example]) -> None:
    seen = 0
    for example in examples:
        used = {k for row in example.table.functions for k in row.variables}
        turning = [k for k in used if example.table.is_angle[k]]
        if turning:
            assert not example.table.repeats_after(np.eye(example.table.variables)[turning[0]])
            seen += 1
    assert seen > 10
