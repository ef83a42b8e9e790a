"""A few rows in plain numbers: the same results as with arrays."""

from __future__ import annotations

import pickle
import platform
from collections.abc import Sequence

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.statuses import Status
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.numerics.position_proof import expansions, prove, reach
from linkwork.core.numerics.single_rows import (
    SingleBlock,
    SingleRows,
    inverse_and_sign,
    solve_linear,
)
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.table.packed_blocks import pack
from linkwork.families.compiled import code_cache as kernel_cache
from linkwork.families.single import quick_rows

#: Dyads, coupled loops, sliding lengths, gears and belts.
_LOOPS_AND_LINES = [
    "four-bar", "crank-shaper", "whitworth", "rapier-drive", "double-butterfly", "geared-five-bar",
    "belt-drive", "oldham-coupling", "jansen-leg",
]  # fmt: skip
_LAWS = ["garage-door", "curved-slot", "cam-swinging-follower", "oval-gears"]
MECHANISMS = [*_LOOPS_AND_LINES, *_LAWS]


class _Arrays(BlockSolver):
    def goes_singly(self, count: int) -> bool:
        return False

    def is_proved_singly(self, count: int) -> bool:
        return False


class _Numbers(BlockSolver):
    def goes_singly(self, count: int) -> bool:
        return True

    def is_proved_singly(self, count: int) -> bool:
        return True


def _both(name: str) -> tuple[BlockSolver, BlockSolver, Array]:
    """Solvers and rows that are near the guess, far from it, and nowhere."""
    model = lw.example(name).model
    one = model.compiled.solver
    arrays, numbers = (
        kind(one.blocks, one.unknowns, one.variables, one.variable_scale)
        for kind in (_Arrays, _Numbers)
    )
    rng = np.random.default_rng(4)
    start = np.repeat(model.equations.start[None, :], 24, axis=0)
    start += np.linspace(0.0, 2.0, 24)[:, None] * rng.normal(size=start.shape) * one.variable_scale
    start[-2], start[-1] = np.nan, np.inf
    return arrays, numbers, start


@pytest.mark.parametrize("name", MECHANISMS)
def test_rows_are_solved_as_with_arrays(name: str) -> None:
    arrays, numbers, start = _both(name)
    for options in (NewtonOptions(), NewtonOptions(max_steps=3, largest_turn=0.2)):
        a, b = arrays.solve(start, options), numbers.solve(start, options)
        good = a.status == Status.CONVERGED.code
        for column in ("status", "failed_block", "iterations"):
            np.testing.assert_array_equal(getattr(a, column), getattr(b, column))
        # solutions to rounding; the last correction squares the error before it
        scale = 1e-8 * (np.abs(a.v[good]) + arrays.variable_scale)
        assert (np.abs(a.v[good] - b.v[good]) <= scale).all()
        np.testing.assert_allclose(a.first_step[good], b.first_step[good], rtol=1e-8)
        assert good.any() or options.max_steps == 3


@pytest.mark.parametrize("name", MECHANISMS)
def test_rates_are_those_of_arrays(name: str) -> None:
    arrays, numbers, start = _both(name)
    v = np.concatenate([arrays.solve(start[:12]).v, start[-2:]])
    rate = np.linspace(1.0, 2.0, arrays.variables - arrays.unknowns)
    with np.errstate(all="ignore"):  # there are rows that are nowhere
        # one by one: columns are balanced for all rows of a batch or for none
        a = SolvedRows.concatenate([arrays.rates(row[None, :], rate) for row in v])
        b = numbers.rates(v, rate)
    np.testing.assert_array_equal(a.orientation, b.orientation)
    # each rate loses as many digits as the condition has
    within = 1e-13 * np.maximum(np.where(np.isfinite(a.condition), a.condition, 1.0), 1.0) ** 2
    for column in ("first", "second", "condition", "nearness"):
        x, y = (getattr(rows, column).reshape(len(v), -1) for rows in (a, b))
        known = np.isfinite(x)
        np.testing.assert_array_equal(known, np.isfinite(y))
        size = np.where(known, np.abs(x), 0.0).max(axis=1, keepdims=True)
        off = np.where(known, np.abs(np.where(known, x, 0.0) - np.where(known, y, 0.0)), 0.0)
        assert (off <= within[:, None] * size).all(), column


@pytest.mark.parametrize("name", MECHANISMS)
def test_proofs_are_those_of_arrays(name: str) -> None:
    arrays, numbers, start = _both(name)
    solved = arrays.solve(start)
    v = solved.v[solved.status == Status.CONVERGED.code]
    radius = np.geomspace(1e-15, 3.0, len(v))[:, None] * np.ones(v.shape[1] - arrays.unknowns)
    held = 0
    for way in (prove, reach):
        a, b = (
            # with residuals that are rounded once: others are noise, to which weights are fitted
            way(solver, v, radius, expansions(solver, v, exact=True))
            for solver in (arrays, numbers)
        )
        np.testing.assert_array_equal(a.holds, b.holds)
        held += int(a.holds.sum())
        for column, x in vars(a).items():
            x, y = x[a.holds], vars(b)[column][a.holds]
            assert np.allclose(x, y, rtol=1e-9, atol=1e-15), column
    assert held > 4


@pytest.mark.parametrize("name", MECHANISMS)
def test_bounds_of_bending_and_rounding_are_those_of_arrays(name: str) -> None:
    arrays, numbers, start = _both(name)
    rng = np.random.default_rng(5)
    for block, single in zip(arrays.blocks, numbers.singles, strict=True):
        for row in start[:12, block.variables]:
            matrix = rng.normal(size=(single.n, len(block.system.equation_scale)))
            many = block.system.curvature(row[None, :], matrix[None])
            one = single.one.curvature(row.tolist(), matrix.tolist())
            for column in ("phase", "slide", "rounding", "jacobian_rounding"):
                x, y = getattr(many, column)[0], np.array(getattr(one, column)).reshape(-1)
                # bounds of rounding are as small as 1e-17
                np.testing.assert_allclose(y, x.ravel(), rtol=1e-9, atol=1e-25)


def test_inputs_may_move_at_rates_of_their_own() -> None:
    arrays, numbers, start = _both("geared-five-bar")
    v = arrays.solve(start[:5]).v
    inputs = v.shape[1] - arrays.unknowns
    rate = np.linspace(1.0, 2.0, 5 * inputs).reshape(5, inputs)
    a, b = (solver.rates(v, rate, input_bend=-3.0 * rate) for solver in (arrays, numbers))
    np.testing.assert_allclose(b.first, a.first, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(b.second, a.second, rtol=1e-9, atol=1e-9)
    assert (b.second[:, arrays.unknowns :] == -3.0 * rate).all()


def test_no_rows_are_no_rows() -> None:
    solver = lw.example("four-bar").model.compiled.solver
    nothing = solver.solve(np.empty((0, 3)))
    assert nothing.v.shape == solver.rates(nothing.v, np.ones(1)).first.shape == (0, 3)
    for way in (prove, reach):
        for kind in (_Arrays, _Numbers):
            own = kind(solver.blocks, solver.unknowns, solver.variables, solver.variable_scale)
            found = way(own, nothing.v, np.empty((0, 1)), expansions(own, nothing.v))
            assert found.holds.shape == (0,)
            assert found.error_bound.shape == (0, 3 if way is prove else 2)


def test_a_position_with_a_singular_block_has_no_rates() -> None:
    solver = lw.example("four-bar").model.compiled.solver
    rows = _Numbers(solver.blocks, solver.unknowns, solver.variables, solver.variable_scale)
    stretched = rows.rates(np.array([[0.0, 0.0, 0.5]]), np.ones(1))  # coupler and rocker in line
    assert stretched.orientation[0, 0] == 0
    assert np.isnan(stretched.first[0, :2]).all()
    assert stretched.condition[0] == stretched.nearness[0] == np.inf


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_small_systems_are_solved_as_by_lapack(n: int) -> None:
    rng = np.random.default_rng(n)
    for _ in range(50):
        a, b = rng.normal(size=(n, n + 1)), rng.normal(size=n)
        square = a[:, :n]
        loss = 1e-14 * np.linalg.cond(square)
        found = solve_linear(a.tolist(), b.tolist())
        inverse, sign = inverse_and_sign(a.tolist())
        assert found is not None
        np.testing.assert_allclose(found, np.linalg.solve(square, b), rtol=loss, atol=loss)
        np.testing.assert_allclose(
            inverse, np.linalg.inv(square), rtol=loss, atol=loss * np.abs(inverse).max()
        )
        assert sign == np.sign(np.linalg.det(square))
    nothing = np.zeros((n, n)).tolist()
    assert solve_linear(nothing, [1.0] * n) is None
    assert inverse_and_sign(nothing)[1] == 0
    assert np.isnan(inverse_and_sign(nothing)[0]).all()


def _compiled(blocks: Sequence[SingleBlock], _rows: int) -> quick_rows.QuickRows:
    packed = pack(blocks)
    assert packed is not None
    return quick_rows.QuickRows(*packed)


#: Processors for which C compilers do not fuse products and sums.
_EXACT = platform.machine().lower() in {"x86_64", "amd64"}


@pytest.mark.parametrize("name", [*_LOOPS_AND_LINES, "dixon-two", "three-rpr"])
def test_compiled_rows_are_those_of_plain_numbers(name: str) -> None:
    arrays, numbers, start = _both(name)
    plain = SingleRows(numbers.singles, None)
    quick = SingleRows(numbers.singles, _compiled)
    for _ in range(20):  # the first ones are solved in plain numbers
        quick.solve_row(start[0].copy(), NewtonOptions())
    within = 0.0 if _EXACT else 1e-6
    rate = np.linspace(1.0, 2.0, arrays.variables - arrays.unknowns)
    endings = set()
    for options in (NewtonOptions(), NewtonOptions(max_steps=3, largest_turn=0.2)):
        a, b = plain.solve(start, options), quick.solve(start, options)
        for column in ("status", "failed_block", "iterations"):
            np.testing.assert_array_equal(getattr(a, column), getattr(b, column))
        for column in ("v", "residual", "first_step", "contraction"):
            np.testing.assert_allclose(getattr(a, column), getattr(b, column), rtol=within)
        endings |= set(a.status.tolist())
        a, b = plain.rates(a.v, rate, 0.5 * rate), quick.rates(a.v, rate, 0.5 * rate)
        np.testing.assert_array_equal(a.orientation, b.orientation)
        for column in ("first", "second", "condition", "nearness"):
            np.testing.assert_allclose(getattr(a, column), getattr(b, column), rtol=within)
    assert len(endings) > 1


def test_compiled_code_is_not_copied() -> None:
    asked: list[int] = []

    def make(blocks: object, rows: int) -> None:
        asked.append(rows)

    rows = SingleRows([], make)
    for _ in range(40):
        rows.solve_row(np.zeros(2), NewtonOptions())
    assert asked == [4] * 10
    solver = lw.example("four-bar").model.compiled.solver
    for _ in range(20):
        solver.one_by_one.solve_row(np.array([0.4, 1.2, 0.5]), NewtonOptions())
    solver.one_by_one._quick = _compiled(solver.singles, 0)
    copy = pickle.loads(pickle.dumps(solver))
    assert copy.one_by_one._quick is None
    a, b = (
        one.one_by_one.solve(np.array([[0.4, 1.2, 0.5]]), NewtonOptions()) for one in (solver, copy)
    )
    np.testing.assert_array_equal(a.v, b.v)


def test_rows_are_compiled_when_that_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = lw.example("four-bar").model.compiled.solver.singles
    monkeypatch.setattr(kernel_cache, "_was_compiled", lambda loop: True)
    monkeypatch.setattr(kernel_cache, "is_loaded", lambda loop: False)
    monkeypatch.setattr(quick_rows, "is_loaded", lambda loop: False)
    monkeypatch.setitem(quick_rows._WORK, "blocks", 0)
    assert quick_rows.quick_rows(blocks, 20_000) is None
    assert quick_rows.quick_rows(blocks, 20_000) is not None
    monkeypatch.setattr(kernel_cache, "_was_compiled", lambda loop: False)
    assert quick_rows.quick_rows(blocks, 20_000) is None
    assert quick_rows.quick_rows(blocks, 300_000) is not None
    monkeypatch.setattr(quick_rows, "find_spec", lambda name: None)
    assert quick_rows.quick_rows(blocks, 300_000) is None


def test_rows_with_laws_are_not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quick_rows, "is_loaded", lambda loop: True)
    served = [
        name
        for name in MECHANISMS
        if quick_rows.quick_rows(lw.example(name).model.compiled.solver.singles, 16) is not None
    ]
    assert served == _LOOPS_AND_LINES


def test_plain_numbers_serve_where_code_cannot_be_compiled(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    blocks = lw.example("four-bar").model.compiled.solver.singles
    tried = []

    def refuse(*packed: object) -> None:
        tried.append(packed)
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr(quick_rows, "is_loaded", lambda loop: True)
    monkeypatch.setattr(quick_rows, "_FAILED", [])
    monkeypatch.setattr(quick_rows, "QuickRows", refuse)
    assert quick_rows.quick_rows(blocks, 1) is None
    assert quick_rows.quick_rows(blocks, 1) is None
    assert len(tried) == 1
    assert caplog.messages == [
        "compiled code cannot be used here, plain numbers take longer: "
        "cannot cache function: no locator available"
    ]
