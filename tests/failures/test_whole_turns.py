"""Far values of an input that turns freely: laps are left out, the result keeps what was asked."""

from __future__ import annotations

import math
import time

import pytest

import linkwork as lw
from tests.failures.test_positions_that_do_not_exist import four_bar


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
