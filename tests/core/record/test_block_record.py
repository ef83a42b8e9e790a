"""The printed functions of blocks against the array form of the equations."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.statuses import Status
from linkwork.core.motion.following import Drive
from linkwork.core.numerics.block_solver import FEW, BlockSolver
from linkwork.core.numerics.newton import NewtonOptions, newton
from linkwork.core.numerics.position_proof import expansions, prove, recorded_places
from linkwork.core.record.block_record import BlockRecord, Shape, ShapeWriter, numbers_of, record_of
from linkwork.core.record.printing import ARRAYS, FLOATS
from linkwork.core.table.loop_table import LoopTable
from tests.library_mechanisms import read_example
from tests.thinned import thinned

NAMES = thinned(list(lw.examples()), 4)
ROWS = FEW + 40


def blocks_of(name: str) -> list[LoopTable]:
    """The loop tables of the blocks that are recorded."""
    systems = [block.system for block in read_example(name).model.compiled.solver.blocks]
    tables = [system for system in systems if isinstance(system, LoopTable)]
    return [table for table in tables if record_of(table) is not None]


def plain(solver: BlockSolver) -> BlockSolver:
    """The solver without printed functions."""
    return replace(solver, blocks=[replace(block, record=None) for block in solver.blocks])


def positions(name: str) -> tuple[BlockSolver, Array]:
    """Positions (ROWS, N) of a mechanism near its guess, and its solver."""
    model = read_example(name).model
    start = np.tile(model.equations.start, (ROWS, 1))
    start[:, model.compiled.solver.unknowns :] *= 1.0 + 1e-3 * np.linspace(0, 1, ROWS)[:, None]
    done = plain(model.compiled.solver).solve(start)
    return model.compiled.solver, done.v[done.status == Status.CONVERGED.code]


@pytest.mark.parametrize("name", NAMES)
def test_a_correction_is_that_of_the_arrays(name: str) -> None:
    rng = np.random.default_rng(1)
    for table in blocks_of(name):
        v = rng.uniform(0.5, 1.5, (5, table.variables)) * np.where(
            table.is_angle, 1.0, table.variable_scale
        )
        record, n = BlockRecord(table), table.unknowns
        error, size, _, *change = record.of_arrays.correct(*v.T.copy())
        f, jacobian = table.residual_and_jacobian(v)
        np.testing.assert_allclose(error, np.abs(f / table.equation_scale).max(axis=1), rtol=1e-9)
        expected = np.linalg.solve(jacobian[:, :, :n], f[:, :, None])[:, :, 0]
        weights = table.variable_scale[:n]
        condition = np.linalg.cond(jacobian[:, :, :n] * weights).max()
        slack = 1e-14 * condition * np.abs(expected / weights).max()
        np.testing.assert_allclose(np.stack(change, 1) / weights, expected / weights, atol=slack)
        np.testing.assert_allclose(size, np.abs(expected / weights).max(axis=1), atol=slack)


@pytest.mark.parametrize("name", NAMES)
def test_rows_are_solved_as_by_the_array_form(name: str) -> None:
    solver, v = positions(name)
    rate = np.ones(solver.variables - solver.unknowns)
    moved = v.copy()
    moved[:, : solver.unknowns] += 1e-4 * solver.variable_scale[: solver.unknowns]
    expected, found = plain(solver).solve(moved), solver.solve(moved)
    np.testing.assert_array_equal(found.status, expected.status)
    for count in (len(v), 3):  # arrays, then floats
        here = slice(0, count)
        some = solver.solve(moved[here])
        own, other = solver.rates(v[here], rate), plain(solver).rates(v[here], rate)
        fair = other.condition < 1e5
        away = np.abs(some.v - expected.v[here])[fair] / solver.variable_scale
        assert away.max(initial=0.0) < 1e-11
        np.testing.assert_array_equal(own.orientation, other.orientation)
        np.testing.assert_allclose(own.condition[fair], other.condition[fair], rtol=1e-9)
        np.testing.assert_allclose(own.nearness[fair], other.nearness[fair], rtol=1e-9)
        for order in ("first", "second"):
            one, two = getattr(own, order)[fair], getattr(other, order)[fair]
            np.testing.assert_allclose(one, two, atol=1e-9 * max(1.0, np.abs(two).max(initial=0)))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("error", [0.0, 1e-6])
def test_a_proof_is_as_good_as_that_of_the_array_form(name: str, error: float) -> None:
    solver, v = positions(name)
    if not solver.is_provable:
        return
    radius = np.full((len(v), solver.variables - solver.unknowns), error)
    expected = prove(solver, v, radius, expansions(solver, v))
    for here in (slice(None), slice(0, 3)):  # arrays, then floats
        found = prove(solver, v[here], radius[here], recorded_places(solver, v[here]))
        np.testing.assert_array_equal(found.holds, expected.holds[here])
        sure = found.holds
        one, two = found.error_bound[sure], expected.error_bound[here][sure]
        assert (one <= 3.0 * two + 1e-15 * solver.variable_scale).all()
        one, two = found.least_uniqueness_radius[sure], expected.least_uniqueness_radius[here][sure]
        np.testing.assert_allclose(one, two, rtol=0.02)


def test_failures_have_the_statuses_of_the_array_form() -> None:
    (table,) = blocks_of("four-bar")
    record, limits = BlockRecord(table), (50, 1e-14, 1e-9, 0.7)
    for start in ([0.0, 0.0, 0.0], [np.inf, 0.0, 1.0], [0.3, 1.0, np.nan], [1.0, 2.0, 1.0]):
        own = NewtonOptions(largest_turn=limits[-1])
        (expected,) = newton(table, np.array([start]), own).status
        assert record.of_floats.solve(*start, *limits)[0] == expected
    few = record.of_floats.solve(0.3, 1.0, 1.0, 1, *limits[1:])
    assert few[:2] == (Status.STEP_LIMIT.code, 1)


@pytest.mark.parametrize("form", [FLOATS, ARRAYS])
def test_blocks_of_one_shape_have_the_same_functions(form: object) -> None:
    written: dict[Shape, list[str]] = {}
    for name in lw.examples():
        for table in blocks_of(name):
            shape = Shape.of(table, numbers_of(table))
            if len(written.setdefault(shape, [])) < 2 and table.unknowns < 3:
                writer = ShapeWriter(table, shape, form)  # type: ignore[arg-type]
                names = ("correct", "rates", "place", "within")
                written[shape].append("".join(getattr(writer, name)() for name in names))
    several = [sources for sources in written.values() if len(sources) > 1]
    assert len(several) > 10
    assert all(one == other for one, other in several)


def test_blocks_that_know_no_variable_are_solved_as_by_the_array_form() -> None:
    model = read_example("three-rpr").model
    leads, v = Drive.of_circuits(model).leads, model.equations.start
    leaders = [led for k in range(len(v)) if (led := leads.with_parameter(k)) is not None]
    alone = [b for led in leaders for b in led.solver.blocks if len(b.variables) == 1]
    assert alone
    for led in leaders:
        here, rate = v[led.order][None, :], np.ones(1)
        own, other = led.solver.rates(here, rate), plain(led.solver).rates(here, rate)
        np.testing.assert_array_equal(own.orientation, other.orientation)
        np.testing.assert_allclose(own.condition, other.condition, rtol=1e-9)


def test_code_is_kept_for_other_processes(tmp_path: Path) -> None:
    """Sets are printed in another order in each process."""
    code = "import linkwork as lw; print(lw.example('jansen-leg').sweep().certified.all())"
    kept = []
    for seed in ("1", "2"):
        environment = {**os.environ, "LINKWORK_CACHE": str(tmp_path), "PYTHONHASHSEED": seed}
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        assert done.stdout.strip() == "True"
        kept.append({path.name: path.stat().st_mtime_ns for path in tmp_path.rglob("*.bin")})
    assert kept[0]
    assert kept[1] == kept[0]
