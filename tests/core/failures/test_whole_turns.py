"""Far values of an input that turns freely: laps are left out, the result keeps what was asked."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

import linkwork as lw
from tests.core.failures.test_positions_that_do_not_exist import four_bar


@pytest.mark.parametrize("at", [1e9, -1e9, 1e6 + 0.5, 30 + 360 * 77])
def test_a_far_value_of_a_crank_is_the_position_whole_turns_nearer(at: float) -> None:
    mechanism = lw.example("four-bar")
    began = time.monotonic()
    far, near = mechanism.solve(at=at), mechanism.solve(at=math.fmod(at, 360))
    assert time.monotonic() - began < 5  # turn by turn this takes hours
    assert far["crank"] == at
    assert far.certificate.certified
    for name in ("coupler", "rocker", "mu"):
        assert far[name] == pytest.approx(near[name], abs=1e-9)


def test_angles_gain_the_turns_that_were_left_out() -> None:
    drag = four_bar(3, 3, 3, 1.5)  # both cranks turn all around
    near, far = drag.solve(at=100), drag.solve(at=100 + 360 * 1000)
    for name in ("coupler", "rocker"):
        assert far[name] == pytest.approx(near[name] + 360 * 1000, abs=1e-8)
    followed = drag.solve(at=100 + 360 * 2)  # near enough to be followed
    assert followed["rocker"] == pytest.approx(near["rocker"] + 720, abs=1e-9)


def test_a_mechanism_that_needs_two_turns_to_come_back_is_not_taken_to_need_one() -> None:
    # θ turns half as fast as φ: after one turn its vector points the other way
    two = lw.loops(
        name="half speed",
        loops={"L": "4*e^(i*φ) + e^(i*θ) = s*e^(i*2*θ)"},
        guess={"φ": 60, "θ": 30, "s": 5},
        inputs=lw.Input(variable="φ"),
    )
    here, next_turn = two.solve(at=100), two.solve(at=460)
    assert abs(here["s"] - next_turn["s"]) > 0.5
    for turns in (100, 101, -100, -101):
        far = two.solve(at=100 + 360 * turns)
        near = here if turns % 2 == 0 else next_turn
        assert far["s"] == pytest.approx(near["s"], rel=1e-12)
        assert far["θ"] == pytest.approx(near["θ"] + 180 * (turns - turns % 2), abs=1e-8)
        assert far.certificate.certified


def test_between_dead_points_whole_turns_lead_to_the_same_place() -> None:
    mechanism = four_bar(2, 5, 2, 4)
    near = mechanism.solve(at=120)
    for at in (120 + 360 * 4, 120 - 360 * 1000):
        far = mechanism.solve(at=at)
        assert far["crank"] == at
        assert far["rocker"] == pytest.approx(near["rocker"], abs=1e-9)
        assert far.certificate.certified
    beyond = mechanism.solve(at=360 * 1000 + 10)
    assert beyond.status is lw.Status.OUT_OF_REACH
    assert beyond["crank"] == 360 * 1000 + 10


def test_a_far_length_is_followed_and_not_wrapped() -> None:
    mechanism = lw.example("slider-input")
    name = mechanism.loop_equations.inputs[0].name
    position = mechanism.solve(at=1e6)
    assert position.status is lw.Status.OUT_OF_REACH
    assert position[name] == 1e6


def test_a_wheel_rolls_on_by_the_same_length_with_every_turn() -> None:
    wheel = lw.example("rolling-wheel")
    begin = wheel.solve(at=-90)["x"]
    motion = wheel.sweep(from_=0, to=360e6, step=72e6 + 30)
    expected = begin - 40 * (np.radians(motion.inputs["wheel"]) + math.pi / 2)
    np.testing.assert_allclose(motion["x"], expected, rtol=1e-14)
    assert motion.certified.all()


def test_turns_beyond_counting_are_refused() -> None:
    with pytest.raises(lw.InputError) as refused:
        lw.example("four-bar").sweep(from_=1e300, to=1e300, step=1)
    assert str(refused.value) == (
        "crank is asked for 2.778e+297 turns from the guess: beyond 1e15 turns a number says "
        "nothing about the angle; leave out whole turns"
    )


def test_a_motion_that_never_repeats_is_followed_over_so_many_turns() -> None:
    never = lw.loops(
        loops={"L": "4*e^(i*2^0.5*φ) + 10*e^(i*φ) = s*e^(i*θ)"},
        guess={"φ": 0, "θ": 0, "s": 14},
        inputs=lw.Input(variable="φ"),
    )
    with pytest.raises(lw.InputError) as refused:
        never.solve(at=360e6)
    assert "does not repeat itself within 60 turns: at most 10,000 turns" in str(refused.value)


def test_a_table_far_from_the_guess_of_a_plain_number_is_reached_in_few_steps() -> None:
    cubic = lw.plain_equations(
        equations={"F": "x^3 - 3*x + t = 0"},
        guess={"x": 2, "t": 1},
        inputs=lw.Input(variable="t", from_=-1e9, to=-1e9 + 10, step=10),
    )
    began = time.monotonic()
    motion = cubic.sweep()
    assert time.monotonic() - began < 5  # in steps of the table alone this takes days
    x, t = motion["x"], motion.inputs["t"]
    np.testing.assert_allclose(x**3 - 3 * x, -t, rtol=1e-12)
