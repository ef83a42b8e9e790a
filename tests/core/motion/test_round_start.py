"""Pictures start at round input values near those of the guess."""

from __future__ import annotations

import math

import pytest

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion import solve_round_start


@pytest.mark.parametrize(
    ("name", "caption"),
    [
        ("slider-crank", "crank = 60°"),  # the points are at 59.9706°
        ("andrews-squeezer", "β = −0.1 rad"),
        ("excavator", "boom_ram = 264 cm, stick_ram = 316 cm, bucket_ram = 209 cm"),
        ("four-bar-crossed", "crank = 30°"),
    ],
)
def test_a_picture_states_round_input_values_and_shows_them(name: str, caption: str) -> None:
    mechanism = lw.example(name)
    scene = mechanism.scene()
    assert scene.caption == caption
    cycle = mechanism.sweep(certify=False)
    start, near = mechanism.solve(), solve_round_start(mechanism.model, cycle)
    assert near.status.ok
    moved = [math.dist(near.points[name], start.points[name]) for name in near.points]
    assert max(moved) < 0.05 * scene.measures.size


def test_a_zero_has_no_sign() -> None:
    """The crank of the points is at -0.29°."""
    mechanism = lw.example("four-bar")
    described = mechanism.description
    assert isinstance(described, Linkage)
    points = {**described.points, "A": (40.0, -0.2)}
    assert mechanism.changed(points=points).scene().caption == "crank = 0°"


def test_a_value_that_was_asked_for_is_drawn_as_it_is() -> None:
    assert lw.example("slider-crank").scene(at=59.9706).caption == "crank = 59.9706°"


def test_a_start_without_a_round_neighbour_stays() -> None:
    """The motion ends at 149.617°: 150° cannot be reached."""
    mechanism = lw.example("rapier-drive-limited")
    start = mechanism.solve(at=149.6)
    assert solve_round_start(mechanism.model, mechanism.sweep(certify=False), start) is start
