"""Jets against complex steps and differences of the same function, written with NumPy."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.expression.derivatives import Jet, derivative, evaluate
from linkwork.core.expression.grammar import FUNCTIONS, parse
from linkwork.core.expression.tree import text
from linkwork.core.expression.values import value
from linkwork.core.foundation.units import AngleUnit

Array = npt.NDArray[np.float64]
Function = Callable[[Any, Any], Any]

X, Y = np.array([0.31, -0.62, 0.85]), np.array([1.7, 0.9, 2.3])
#: Formula → the function on numbers. These accept complex numbers.
ANALYTIC: dict[str, Function] = {
    "x + y": lambda x, y: x + y,
    "x - 2*y": lambda x, y: x - 2 * y,
    "-x*y": lambda x, y: -x * y,
    "x/y": lambda x, y: x / y,
    "3/(x + y^2)": lambda x, y: 3 / (x + y * y),
    "x^3": lambda x, y: x * x * x,
    "x^0": lambda x, y: 1 + 0 * x,
    "x^1": lambda x, y: x,
    "x^(-2)": lambda x, y: 1 / (x * x),
    "y^1.5": lambda x, y: y * np.sqrt(y),
    "y^x": lambda x, y: np.exp(x * np.log(y)),
    "2^(x*y)": lambda x, y: np.exp(x * y * math.log(2)),
    "e^(x*y)": lambda x, y: np.exp(x * y),
    "pi*x^2": lambda x, y: np.pi * x * x,
    "sin(x*y)": lambda x, y: np.sin(x * y),
    "cos(x + y)": lambda x, y: np.cos(x + y),
    "tan(x*y)": lambda x, y: np.tan(x * y),
    "asin(x)": lambda x, y: np.arcsin(x),
    "asin(x/y)*y": lambda x, y: np.arcsin(x / y) * y,
    "acos(x^2)": lambda x, y: np.arccos(x * x),
    "atan(x*y)": lambda x, y: np.arctan(x * y),
    "sqrt(x + y)": lambda x, y: np.sqrt(x + y),
    "exp(-x/y)": lambda x, y: np.exp(-x / y),
    "ln(x + y)": lambda x, y: np.log(x + y),
    "log10(x^2 + y)": lambda x, y: np.log(x * x + y) / math.log(10),
    "hypot(x, y)": lambda x, y: np.sqrt(x * x + y * y),
}
#: These do not; where they have a corner or a cut, the places above keep away from it.
REAL: dict[str, Function] = {
    "abs(x)": lambda x, y: np.abs(x),
    "abs(x - y)*x": lambda x, y: np.abs(x - y) * x,
    "atan2(x, y)": lambda x, y: np.arctan2(x, y),
    "atan2(y, x*y)": lambda x, y: np.arctan2(y, x * y),
    "min(x, y, 0.5)": lambda x, y: np.minimum(np.minimum(x, y), 0.5),
    "max(x^2, y - 1)": lambda x, y: np.maximum(x * x, y - 1),
}
ALL = ANALYTIC | REAL
# Five-point differences with this step: truncation h⁴f⁽⁵⁾/30 and rounding u/h are below 1e-11.
STEP = 2e-4
SLOPE: Any = {"rtol": 1e-10, "atol": 1e-10}
# The exact functions differ by rounding only.
EXACT: Any = {"rtol": 1e-13, "atol": 1e-13}
CURVE = ((0.7, 0.3), (-0.4, 0.6))  # x' x'', y' y''


def on_curve(t: Any) -> tuple[Any, Any]:
    """A curved path through the places, so that both derivatives of both variables matter."""
    (x1, x2), (y1, y2) = CURVE
    return X + t * x1 + t * t * x2 / 2, Y + t * y1 + t * t * y2 / 2


def jet_of(text: str, unit: AngleUnit = AngleUnit.RADIAN) -> Jet:
    names = {
        name: Jet(at, np.full(3, first), np.full(3, second))
        for name, at, (first, second) in zip("xy", (X, Y), CURVE, strict=True)
    }
    return evaluate(parse(text), names, unit)


def five_point(f: Callable[[float], Array]) -> Array:
    h = STEP
    return (f(-2 * h) - 8 * f(-h) + 8 * f(h) - f(2 * h)) / (12 * h)


def test_every_function_is_compared() -> None:
    called = {name for text in ALL for name in re.findall(r"([a-z][a-z0-9]*)\(", text)}
    assert called == set(FUNCTIONS) - {"cis"}  # cis is complex: loop equations only


@pytest.mark.parametrize("text", ALL)
def test_value_of_a_jet_is_the_value_of_the_function(text: str) -> None:
    wanted = ALL[text](X, Y)
    np.testing.assert_allclose(jet_of(text).v, wanted, **EXACT)
    plain = [
        value(parse(text), {"x": x, "y": y}, AngleUnit.RADIAN)
        for x, y in zip(X.tolist(), Y.tolist(), strict=True)
    ]
    np.testing.assert_allclose(plain, wanted, **EXACT)


@pytest.mark.parametrize("text", ANALYTIC)
def test_first_derivative_equals_a_complex_step(text: str) -> None:
    step = 1e-30j
    (x1, _), (y1, _) = CURVE
    wanted = ANALYTIC[text](X + step * x1, Y + step * y1)
    np.testing.assert_allclose(jet_of(text).d1, np.imag(wanted) / 1e-30, **EXACT)


@pytest.mark.parametrize("text", ANALYTIC)
def test_second_derivative_equals_differences_of_complex_steps(text: str) -> None:
    def slope(t: float) -> Array:
        return np.asarray(np.imag(ANALYTIC[text](*on_curve(t + 1e-30j))) / 1e-30)

    np.testing.assert_allclose(jet_of(text).d2, five_point(slope), **SLOPE)


@pytest.mark.parametrize("text", REAL)
def test_derivatives_of_functions_with_corners_equal_differences(text: str) -> None:
    f = REAL[text]
    np.testing.assert_allclose(jet_of(text).d1, five_point(lambda t: f(*on_curve(t))), **SLOPE)

    def slope(t: float) -> Array:
        return five_point(lambda s: f(*on_curve(t + s)))

    # differences of differences: rounding grows once more by 1/h
    np.testing.assert_allclose(jet_of(text).d2, five_point(slope), rtol=1e-8, atol=1e-7)


def test_degrees_scale_arguments_and_results() -> None:
    jet = jet_of("sin(90*x) + atan2(x, y)", AngleUnit.DEGREE)
    radians = jet_of("sin(90*x*pi/180) + atan2(x, y)*180/pi")
    for found, wanted in ((jet.v, radians.v), (jet.d1, radians.d1), (jet.d2, radians.d2)):
        np.testing.assert_allclose(found, wanted, **EXACT)
    assert value(parse("sin(30)"), {}, AngleUnit.DEGREE) == pytest.approx(0.5, abs=1e-15)
    assert value(parse("atan2(1, -1)"), {}, AngleUnit.DEGREE) == pytest.approx(135, abs=1e-13)


def test_outside_a_domain_a_jet_is_not_a_number() -> None:
    place = {"x": Jet(np.array([-1.0, 2.0]), np.ones(2), np.zeros(2))}
    with np.errstate(invalid="ignore"):
        for text in ("sqrt(-1 - x^2)", "ln(-x^2)", "asin(1 + x^2)"):
            jet = evaluate(parse(text), place, AngleUnit.RADIAN)
            assert np.isnan(jet.v).all()


@pytest.mark.parametrize("text", [t for t in ALL if not t.startswith(("min", "max"))])
@pytest.mark.parametrize("name", ["x", "y"])
def test_derivative_tree_has_the_value_of_the_jet(text: str, name: str) -> None:
    names = {
        n: Jet(at, np.full(3, float(n == name)), np.zeros(3))
        for n, at in zip("xy", (X, Y), strict=True)
    }
    jet = evaluate(parse(text), names, AngleUnit.RADIAN)
    tree = evaluate(derivative(parse(text), name), names, AngleUnit.RADIAN)
    np.testing.assert_allclose(np.broadcast_to(tree.v, 3), jet.d1, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("function", ["min", "max"])
def test_derivative_tree_refuses_min_and_max(function: str) -> None:
    with pytest.raises(
        ValueError, match=f"^{function} has a derivative that is not a single formula$"
    ):
        derivative(parse(f"{function}(x, 1)"), "x")


def test_derivative_tree_by_an_absent_name_is_zero() -> None:
    assert derivative(parse("min(x, 1) + sin(y)"), "z") == parse("0")


@pytest.mark.parametrize("levels", [10, 50])
def test_a_tower_of_powers_has_a_derivative_of_bounded_length(levels: int) -> None:
    """It doubled with every level: twenty of them took 36 seconds."""
    tree = derivative(parse("^".join(["x"] * levels)), "x")
    assert len(text(tree)) < 20 * levels**2
    jet = evaluate(tree, {"x": Jet(np.ones(1), np.ones(1), np.zeros(1))}, AngleUnit.RADIAN)
    assert jet.v == pytest.approx([1.0])
