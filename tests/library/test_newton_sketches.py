"""The four sketches of Newton-Raphson, against the iteration done by hand."""

from __future__ import annotations

import math

import pytest

import linkwork as lw
from tests.library.laws import law


@law("newton-convergence")
def test_newton_converges_to_cardanos_root() -> None:
    """Cardano's root 2.0945514815… of x³ - 2x - 5."""
    half = 5 / 2
    inside = math.sqrt(half**2 - (2 / 3) ** 3)
    cardano = math.cbrt(half + inside) + math.cbrt(half - inside)
    assert lw.example("newton-convergence").solve()["x"] == pytest.approx(cardano, abs=1e-12)


@law("newton-another-root")
def test_newton_finds_another_root_than_the_nearest() -> None:
    """From 1.55 the iteration misses 2, the nearest of the roots 1, 2, 3."""
    x = 1.55
    for _ in range(20):
        x -= (x**3 - 6 * x**2 + 11 * x - 6) / (3 * x**2 - 12 * x + 11)
    assert round(x) != 2
    position = lw.example("newton-another-root").solve()
    assert position["x"] == pytest.approx(round(x), abs=1e-12)


@law("newton-inflection")
def test_newton_diverges_from_the_inflection() -> None:
    """|x| > 1.3917 grows by x - (1 + x²) atan x at every step."""
    position = lw.example("newton-inflection").solve(with_steps=True)
    assert position.status is lw.Status.DIVERGED
    x = 1.5
    for step in position.steps[0].steps[:6]:
        assert step.unknowns["x"] == pytest.approx(x, rel=1e-12)
        x -= (1 + x * x) * math.atan(x)


@law("newton-extremum")
def test_newton_stops_where_the_derivative_is_zero() -> None:
    """F = x³ - 3x + 3 has its minimum 1 at the guess x = 1, and its only root at -2.1038."""
    mechanism = lw.example("newton-extremum")
    assert mechanism.solve().status is lw.Status.SINGULAR_JACOBIAN
    root = mechanism.changed(guess={"x": -2}).solve()["x"]
    inside = math.sqrt(1.5**2 - 1)
    assert root == pytest.approx(-math.cbrt(1.5 + inside) - math.cbrt(1.5 - inside), abs=1e-14)
