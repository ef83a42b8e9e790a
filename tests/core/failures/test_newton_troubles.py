"""Why Newton-Raphson misses: the four sketches, and the same told apart in other systems."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from linkwork import NewtonTrouble, Status

SKETCHES = {
    "newton-inflection": (
        Status.DIVERGED,
        NewtonTrouble.INFLECTION,
        "the iteration diverged to infinity: the equations have an inflection near the root, so "
        "that every step overshoots further than the one before: start nearer to the root; a "
        "damped iteration finds x = 0; 1 root exists there (perhaps not all): x = 0",
    ),
    "newton-another-root": (
        Status.CONVERGED,
        NewtonTrouble.ANOTHER_ROOT,
        "position found, but the iteration passed the root nearest to the guess and found "
        "another root: start nearer to the intended root; the root nearest to the guess is x = "
        "2; 3 roots exist there (perhaps not all): x = 1 or x = 2 or x = 3",
    ),
    "newton-extremum": (
        Status.SINGULAR_JACOBIAN,
        NewtonTrouble.LOCAL_EXTREMUM,
        "the Jacobian became singular during the iteration: the guess is near a local extremum "
        "of the equations, which do not reach zero there: start from the other side of the "
        "extremum; 1 root exists there (perhaps not all): x = -2.103803403",
    ),
}


def plain(text: str, **guess: float) -> lw.Position:
    return lw.plain_equations(name="plain", equations={"f": text}, guess=guess).solve()


def trouble(position: lw.Position) -> NewtonTrouble | None:
    return None if position.failure is None else position.failure.trouble


@pytest.mark.parametrize("name", SKETCHES)
def test_a_sketch_is_told_apart_with_its_whole_message(name: str) -> None:
    position = lw.example(name).solve()
    status, reason, message = SKETCHES[name]
    assert (position.status, trouble(position), position.message) == (status, reason, message)


def test_the_sketch_that_converges_has_nothing_to_explain() -> None:
    position = lw.example("newton-convergence").solve()
    assert (position.message, position.failure) == ("position found", None)


def test_a_flat_point_that_is_no_extremum_is_a_singular_derivative() -> None:
    # x³ is flat at 0 and crosses -8 on the other side of nothing: F'' = 0 as well
    position = plain("x^3 - 8 = 0", x=0)
    assert trouble(position) is NewtonTrouble.SINGULAR_DERIVATIVE
    assert position.message == (
        "the Jacobian became singular during the iteration: the derivative is singular at an "
        "iterate, where Newton-Raphson has no next step: start from a guess near it; "
        "1 root exists there (perhaps not all): x = 2"
    )


def test_every_reason_is_told_by_one_scalar_function() -> None:
    reasons = {
        trouble(plain("x^3 - 8 = 0", x=0)),
        trouble(plain("atan(x) = 0", x=1.5)),
        trouble(plain("x^3 - 6*x^2 + 11*x - 6 = 0", x=1.55)),
        trouble(plain("x^3 - 3*x + 3 = 0", x=1)),
    }
    assert reasons == set(NewtonTrouble)


def test_circling_around_a_minimum_is_an_extremum_and_not_an_inflection() -> None:
    assert trouble(plain("x^3 - 2*x + 2 = 0", x=0)) is NewtonTrouble.LOCAL_EXTREMUM
    assert trouble(plain("x^3 - 2*x + 2 = 0", x=1e-6)) is NewtonTrouble.LOCAL_EXTREMUM


def test_without_a_root_there_is_no_reason_to_miss_it_and_the_least_value_is_told() -> None:
    position = plain("x^2 + 1 = 0", x=0.7)
    assert (position.status, trouble(position)) == (Status.STEP_LIMIT, None)
    assert position.message == (
        "no position after the largest allowed number of iterations: start from a nearer guess "
        'or allow more iterations; "f" has at least the residual 1 nearby; '
        "other guesses also lead to no position there"
    )


def test_too_few_steps_are_no_reason_of_the_equations() -> None:
    mechanism = lw.example("newton-convergence")
    position = mechanism.solve(options=lw.NewtonOptions(max_steps=2))
    assert (position.status, trouble(position)) == (Status.STEP_LIMIT, None)
    assert position.message == (
        "no position after the largest allowed number of iterations: start from a nearer guess "
        "or allow more iterations; a damped iteration finds x = 2.094551482; "
        "1 root exists there (perhaps not all): x = 2.094551482"
    )


def test_an_inflection_towards_which_the_steps_shrink_is_no_reason() -> None:
    mechanism = lw.plain_equations(name="odd", equations={"f": "atan(x) = 0"}, guess={"x": 1.3})
    position = mechanism.solve(options=lw.NewtonOptions(max_steps=3))
    assert (position.status, trouble(position)) == (Status.STEP_LIMIT, None)


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
def test_an_inflection_is_recognised_whatever_the_coordinates(turn: float) -> None:
    # atan along one direction, linear across it, turned in the plane
    c, s = math.cos(turn), math.sin(turn)
    x, y = 1.5 * c - 0.2 * s, 1.5 * s + 0.2 * c
    along, across = f"({c!r}*x + {s!r}*y)", f"({c!r}*y - {s!r}*x)"
    mechanism = lw.plain_equations(
        name="turned",
        equations={"f": f"atan({along}) = 0", "g": f"{across} + 0.1*{along} = 0"},
        guess={"x": x, "y": y},
    )
    position = mechanism.solve()
    assert (position.status, trouble(position)) == (Status.DIVERGED, NewtonTrouble.INFLECTION)


def test_divergence_without_an_inflection_is_left_unexplained() -> None:
    # (1 - e^-x) bends one way only: from far right the step leaves to the far left
    position = plain("1 - exp(-x) = 0", x=9)
    assert position.status is not Status.CONVERGED
    assert trouble(position) is not NewtonTrouble.INFLECTION


def test_a_nearer_root_of_the_same_orientation_is_only_claimed_where_there_is_one() -> None:
    # guesses all around: what is claimed is true, and both ways happen
    lengths = (2.0, 5.0, 3.5, 4.0)
    rng = np.random.default_rng(1)
    claimed = 0
    for _ in range(150):
        theta3, theta4 = rng.uniform(-180, 180, 2)
        mechanism = lw.loops(
            name="four-bar",
            loops={"L": "2*e^(i*θ2) + 5*e^(i*θ3) = 4 + 3.5*e^(i*θ4)"},
            guess={"θ2": 60, "θ3": float(theta3), "θ4": float(theta4)},
            inputs=lw.Input(variable="θ2"),
        )
        position = mechanism.solve(certify=False)
        if trouble(position) is not NewtonTrouble.ANOTHER_ROOT:
            continue
        claimed += 1
        assert position.failure is not None
        meant = position.failure.meant
        at_guess = _det(lengths, theta3, theta4)
        assert at_guess * _det(lengths, meant["θ3"], meant["θ4"]) > 0
        assert at_guess * _det(lengths, position["θ3"], position["θ4"]) < 0
        near = _away((theta3, theta4), (meant["θ3"], meant["θ4"]))
        assert near < _away((theta3, theta4), (position["θ3"], position["θ4"]))
    assert 0 < claimed < 20


def _det(lengths: tuple[float, ...], theta3: float, theta4: float) -> float:
    """det J of a four-bar is proportional to sin(θ3 - θ4)."""
    return lengths[1] * lengths[2] * math.sin(math.radians(theta3 - theta4))


def _away(a: tuple[float, float], b: tuple[float, float]) -> float:
    return max(abs(math.remainder(p - q, 360)) for p, q in zip(a, b, strict=True))
