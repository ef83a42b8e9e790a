"""The four sketches of the textbook's section on Newton-Raphson, as runnable examples."""

from __future__ import annotations

import itertools

import pytest

import linkwork as lw


def test_sketch_a_converges_quadratically() -> None:
    position = lw.example("newton-convergence").solve(with_steps=True)
    assert position["x"] == pytest.approx(2.0945514815423265, abs=1e-13)
    (trail,) = position.steps
    x = 3.0
    for step in trail.steps[:-1]:
        assert step.unknowns["x"] == pytest.approx(x, rel=1e-14)
        x -= (x**3 - 2 * x - 5) / (3 * x**2 - 2)
    digits = [abs(step.unknowns["x"] - 2.0945514815423265) for step in trail.steps[1:4]]
    assert digits[1] < 0.6 * digits[0] ** 2 < digits[0]  # F''/(2F') is about 0.56 at the root
    assert digits[2] < 0.6 * digits[1] ** 2


def test_sketch_b_diverges_at_an_inflection() -> None:
    position = lw.example("newton-inflection").solve(with_steps=True)
    assert position.status is lw.Status.DIVERGED
    sizes = [abs(step.unknowns["x"]) for step in position.steps[0].steps]
    assert all(later > earlier for earlier, later in itertools.pairwise(sizes))


def test_sketch_c_finds_another_root_than_the_nearest() -> None:
    position = lw.example("newton-another-root").solve()
    assert position.status is lw.Status.CONVERGED
    assert position["x"] == pytest.approx(3.0, abs=1e-14)  # the guess 1.55 is nearest to 2


def test_sketch_d_stops_at_a_local_extremum() -> None:
    position = lw.example("newton-extremum").solve()
    assert position.status is lw.Status.SINGULAR_JACOBIAN
    assert position.iterations == 0
