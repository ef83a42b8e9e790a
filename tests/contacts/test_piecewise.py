"""Functions given piece by piece, against the same numbers in ball arithmetic."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb, ctx

from linkwork.contacts.profiles import Outline, program
from linkwork.core.mechanism.inputs import LAWS
from linkwork.core.table.rows import Piecewise
from tests.oracles.ball_laws import ball_jet, piece_jet

Array = npt.NDArray[np.float64]
UNIT = 2.0**-53


def random_program(seed: int) -> Piecewise:
    """The motion of a cam's follower with rises, returns and dwells."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 6))
    over = rng.uniform(0.05, 1.0, count)
    over *= 2.0 * math.pi / over.sum()
    laws = [str(rng.choice(LAWS[1:])) for _ in range(count)]
    lifts = rng.uniform(-20, 20, count)
    lifts[-1] = -lifts[:-1].sum()
    if count > 3:
        laws[1], lifts[0], lifts[1] = "dwell", lifts[0] + lifts[1], 0.0
    return program(list(zip(laws, over.tolist(), lifts.tolist(), strict=True)))


def random_spline(seed: int) -> Piecewise:
    """One coordinate of a curve through points."""
    rng = np.random.default_rng(seed)
    closed = bool(seed % 2)
    count = int(rng.integers(4, 12))
    around = np.exp(2j * np.pi * np.arange(count) / count) * rng.uniform(20, 60, count)
    outline = Outline.through([complex(z) for z in around], closed=closed)
    return outline.x if seed % 3 else outline.y


FUNCTIONS = {
    **{f"program {k}": random_program(k) for k in range(12)},
    **{f"spline {k}": random_spline(k) for k in range(12)},
    **{f"slope of spline {k}": random_spline(k).slope() for k in range(4)},
}
every = pytest.mark.parametrize("name", FUNCTIONS)


def places(law: Piecewise, seed: int, count: int = 40) -> Array:
    """Inside, many periods away or far beyond the ends, at joints and next to them."""
    rng = np.random.default_rng(seed)
    low, high = law.breaks[0], law.breaks[-1]
    inside = rng.uniform(low, high, count)
    away = rng.uniform(-300, 300, count) * (high - low)
    near = np.concatenate([np.nextafter(law.breaks, -np.inf), np.nextafter(law.breaks, np.inf)])
    return np.concatenate([inside, away, law.breaks, near, [0.0, -1e-20]])


def test_the_sample_has_both_kinds_of_ends() -> None:
    assert {law.periodic for law in FUNCTIONS.values()} == {True, False}


@every
def test_value_and_slope_are_as_near_the_truth_as_their_rounding_claims(name: str) -> None:
    ctx.prec = 200
    law = FUNCTIONS[name]
    x = places(law, 1)
    value, first, _ = law.jet(x)
    error, slope_error = law.rounding(x)
    size = float(np.abs(value).max())
    for k, at in enumerate(x):
        true = ball_jet(law, arb(float(at)))
        assert abs(true[0] - arb(float(value[k]))) <= arb(float(error[k])), at
        assert abs(true[1] - arb(float(first[k]))) <= arb(float(slope_error[k])), at
    # and the claim is of the size of rounding
    near = (x >= law.breaks[0]) & (x <= law.breaks[-1])
    assert error[near].max() < 1e-12 * (size + law.bend * law.period)


@every
def test_second_derivative_is_that_of_the_numbers(name: str) -> None:
    ctx.prec = 200
    law = FUNCTIONS[name]
    rng = np.random.default_rng(2)
    x = rng.uniform(law.breaks[0], law.breaks[-1], 60)
    second = law.jet(x)[2]
    for k, at in enumerate(x):
        true = float(ball_jet(law, arb(float(at)))[2].mid())
        assert second[k] == pytest.approx(true, rel=0, abs=1e-12 * law.bend)


@every
def test_pieces_meet_as_nearly_as_the_function_claims(name: str) -> None:
    # certificates take the function for smooth; what it is not is part of its rounding
    ctx.prec = 200
    law = FUNCTIONS[name]
    count = len(law.breaks) - 1
    jumps, bends = arb(0), arb(0)
    for k in range(count if law.periodic else count - 1):
        end = arb(float(law.breaks[k + 1])) - arb(float(law.breaks[k]))
        left, right = piece_jet(law, k, end), piece_jet(law, (k + 1) % count, arb(0))
        jumps += abs(left[0] - right[0])
        bends += abs(left[1] - right[1])
    apart, steeper = law.gaps
    assert jumps + arb(law.period) * bends <= arb(apart)
    assert 2 * bends + jumps / arb(law.period) <= arb(steeper)
    assert (law.rounding(law.breaks)[0] >= apart).all()
    assert (law.rounding(law.breaks)[1] >= steeper).all()
    size = float(np.abs(law(law.breaks)).max() + law.bend * law.period)
    assert apart < 1e-13 * size


@every
def test_bend_is_an_upper_bound_and_a_close_one(name: str) -> None:
    law = FUNCTIONS[name]
    x = np.linspace(law.breaks[0], law.breaks[-1], 200_001)
    x = np.concatenate([x, np.nextafter(law.breaks, -np.inf)])
    largest = float(np.abs(law.jet(x)[2]).max())
    assert largest <= law.bend <= 1.02 * largest


@every
def test_a_function_repeats_itself_or_goes_on_straight(name: str) -> None:
    law = FUNCTIONS[name]
    rng = np.random.default_rng(3)
    size = float(np.abs(law(law.breaks)).max() + np.abs(law.jet(law.breaks)[1]).max())
    if law.periodic:
        x = rng.uniform(law.breaks[0], law.breaks[-1], 50)
        for turns in (1, -1, 7, -40):
            for here, there in zip(
                law.jet(x)[:2], law.jet(x + turns * law.period)[:2], strict=True
            ):
                np.testing.assert_allclose(there, here, rtol=0, atol=1e-11 * (size + law.bend))
        return
    beyond = rng.uniform(0.1, 5.0, 20) * law.period
    for end, side in ((law.breaks[0], -1.0), (law.breaks[-1], 1.0)):
        value, first, second = law.jet(end + side * beyond)
        at, slope, _ = law.jet(np.array([end]))
        np.testing.assert_allclose(value, at + side * beyond * slope, rtol=0, atol=1e-12 * size)
        np.testing.assert_array_equal(first, np.full(20, slope[0]))
        np.testing.assert_array_equal(second, np.zeros(20))


@every
def test_derivatives_agree_with_differences(name: str) -> None:
    law = FUNCTIONS[name]
    middles = law.breaks[:-1] + 0.37 * np.diff(law.breaks)
    h = 1e-4 * float(np.diff(law.breaks).min())
    value, first, second = (
        law.jet(middles - h),
        law.jet(middles),
        law.jet(middles + h),
    )
    size = float(np.abs(value[0]).max())
    slope = (second[0] - value[0]) / (2 * h)
    bend = (second[1] - value[1]) / (2 * h)
    np.testing.assert_allclose(first[1], slope, rtol=0, atol=1e-13 * size / h + 0.01 * law.bend * h)
    np.testing.assert_allclose(
        first[2], bend, rtol=0, atol=1e-13 * float(np.abs(first[1]).max()) / h + 1e-3 * law.bend
    )


@pytest.mark.parametrize("number", range(6))
def test_a_turn_of_the_rounded_two_pi_or_of_the_true_one_differ_by_rounding(number: int) -> None:
    ctx.prec = 200
    law = random_program(number)
    rng = np.random.default_rng(number)
    x = rng.uniform(-3000, 3000, 60)
    value, first, _ = law.jet(x)
    error, slope_error = law.rounding(x)
    turn = 2 * arb.pi()
    for k, at in enumerate(x):
        true = ball_jet(law, arb(float(at)) - turn * math.floor(at / (2 * math.pi)))
        assert abs(true[0] - arb(float(value[k]))) <= arb(float(error[k]))
        assert abs(true[1] - arb(float(first[k]))) <= arb(float(slope_error[k]))


@pytest.mark.parametrize("number", range(4))
def test_the_slope_of_a_program_has_its_slopes_as_values(number: int) -> None:
    law = random_program(number)
    x = places(law, 6)
    first = law.jet(x)[1]
    np.testing.assert_allclose(law.slope()(x), first, rtol=0, atol=1e-11 * law.bend)


@pytest.mark.parametrize("number", range(1, 12, 2))
def test_the_slope_of_a_closed_spline_is_a_function_of_its_own(number: int) -> None:
    law = random_spline(number)
    x = places(law, 4)
    _, first, second = law.jet(x)
    value, own_first, _ = law.slope().jet(x)
    np.testing.assert_allclose(value, first, rtol=1e-12, atol=1e-12 * np.abs(first).max())
    np.testing.assert_allclose(own_first, second, rtol=0, atol=1e-10 * law.bend)


def test_a_function_times_a_number_is_that_everywhere() -> None:
    law = random_program(3)
    x = places(law, 5)
    for own, whole in zip(law.jet(x), law.times(-2.5).jet(x), strict=True):
        np.testing.assert_allclose(whole, -2.5 * own, rtol=0, atol=1e-13 * np.abs(whole).max())
    assert law.times(-2.5).bend == pytest.approx(2.5 * law.bend, rel=1e-12)


def test_any_shape_of_places_is_answered_in_that_shape() -> None:
    law = random_program(1)
    x = np.linspace(0, 7, 12)
    for shape in ((), (12,), (3, 4), (2, 0)):
        at = x[0] if shape == () else x[: math.prod(shape)].reshape(shape)
        for part, flat in zip(law.jet(np.asarray(at)), law.jet(np.ravel(at)), strict=True):
            assert part.shape == shape
            np.testing.assert_array_equal(np.ravel(part), flat)


@every
def test_one_number_gives_what_arrays_give(name: str) -> None:
    law = FUNCTIONS[name]
    x = np.append(places(law, 7), [np.nan, np.inf, -np.inf])
    with np.errstate(invalid="ignore"):
        many = np.stack(law.jet(x), axis=1)
    one = np.array([law.jet_at(at) for at in x.tolist()])
    for own, all_own in zip(one.T, many.T, strict=True):
        size = np.abs(all_own[np.isfinite(all_own)]).max()
        np.testing.assert_allclose(own, all_own, rtol=1e-12, atol=1e-12 * size)
