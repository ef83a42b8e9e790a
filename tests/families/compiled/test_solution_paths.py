"""Compiled solution paths end where NumPy's do, and say how."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from linkwork.circuits.homotopy.path_tracking import (
    ARRIVED,
    LOST,
    QUICK,
    SINGULAR,
    Equations,
    ParameterPath,
    PathOptions,
    StraightHomotopy,
    track,
)
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.record.recorder import (
    LANES,
    ComplexRecorder,
    Recorder,
    Registers,
    lower_program,
    reserve,
)
from linkwork.families.compiled.interpreter import run
from linkwork.families.paths import PathKernel
from linkwork.synthesis.precision.problem import PrecisionProblem
from linkwork.synthesis.precision.solving import start_member

ROOTS = np.exp(2j * np.pi * np.arange(3) / 3.0)[:, None]


class Cubic:
    """z³ = c: all three roots end at 0 with c."""

    unknowns = parameters = 1

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        square = z[0] * z[0]
        return [square * z[0] - c[0]], [[3.0 * square]], [-rate[0]]


def follow(goal: complex, options: PathOptions) -> tuple[ComplexArray, np.ndarray]:
    ends = np.array([1.0 + 0j, goal])
    kernel = PathKernel(StraightHomotopy(Cubic()))
    w, _, state, _ = kernel.follow(ends, ROOTS.astype(complex), options)
    return w, state


def test_paths_arrive_at_the_roots() -> None:
    w, state = follow(-8.0j, PathOptions())
    assert (state == ARRIVED).all()
    assert w**3 == pytest.approx(np.full((3, 1), -8.0j), rel=1e-12)
    assert len(np.unique(np.round(w, 6))) == 3


def test_paths_that_meet_end_as_singular() -> None:
    w, state = follow(0.0, PathOptions())
    assert (state == SINGULAR).all()
    assert np.abs(w).max() < 1e-3  # σ^(1/3) at the end


def test_paths_without_attempts_are_lost() -> None:
    _, state = follow(-8.0j, PathOptions(attempts=3))
    assert (state == LOST).all()


def test_lost_paths_are_followed_again_with_more_care() -> None:
    hasty, careful = PathOptions(attempts=3), PathOptions(error=1e-3)
    ends, starts = np.array([1.0 + 0j, -8.0j]), ROOTS.astype(complex)
    kernel = PathKernel(StraightHomotopy(Cubic()))
    w, _, state, _ = kernel.follow(ends, starts, hasty, more=careful)
    assert (state == ARRIVED).all()
    assert np.array_equal(w, kernel.follow(ends, starts, careful)[0])
    # with no more care the same would be lost again
    assert (kernel.follow(ends, starts, hasty, more=hasty)[2] == LOST).all()


@pytest.mark.parametrize("threads", [1, 2])
def test_lanes_and_batches_follow_the_same_paths(threads: int) -> None:
    """More paths than lanes, so that lanes take a second one."""
    problem = PrecisionProblem(poses=2, points=4)
    member = start_member(problem)
    goal = problem.random_parameters(np.random.default_rng(3))
    path = ParameterPath(system=problem, start=member.parameters, goal=goal)
    count = 70
    assert count > LANES
    kernel = PathKernel(StraightHomotopy(problem))
    w, _, state, attempts = kernel.follow(path.ends, member.x[:count], QUICK, threads)
    batch = track(path, member.x[:count], QUICK)
    assert np.array_equal(state, batch.state)
    good = state == ARRIVED
    assert good.sum() >= count - 1
    away = np.abs(w - batch.w) / (QUICK.floor + np.abs(batch.w))
    assert away[good].max() < 1e-5  # ends are corrected to 1e-6
    assert attempts.max() <= batch.steps + 1  # one more finds the slope at the start


def test_complex_arithmetic_is_recorded_as_that_of_its_parts() -> None:
    rec, registers = Recorder(), Registers()
    numbers = ComplexRecorder(rec)
    a, b = numbers.input("a"), numbers.input("b")
    numbers.write("f", 2.0 / (a * b - 1j * a + b / a) - (-b))
    names = [f"{name}.{part}" for name in "abf" for part in ("re", "im")]
    rows = [registers.of(name) for name in names]
    reserve(rec, registers)
    program = lower_program(rec, registers, registers.count)
    w = registers.filled(program.height, LANES)
    x, y = np.random.default_rng(1).normal(size=(2, 2, LANES))
    for row, values in zip(rows, (x[0], x[1], y[0], y[1]), strict=False):
        w[row] = values
    run(program.code, w)
    u, v = x[0] + 1j * x[1], y[0] + 1j * y[1]
    expected = 2.0 / (u * v - 1j * u + v / u) + v
    assert w[rows[4]] + 1j * w[rows[5]] == pytest.approx(expected, rel=1e-12)
