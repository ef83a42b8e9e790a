"""Four-bar linkages and slider-cranks against their closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from tests.library.laws import degrees, law, motion_of, same
from tests.oracles.circles import SliderCrank
from tests.oracles.four_bar import FourBar


@law("four-bar", "four-bar-crossed")
@pytest.mark.parametrize(("name", "side"), [("four-bar", 1), ("four-bar-crossed", -1)])
def test_norton_four_bar_closes_where_two_circles_meet(name: str, side: int) -> None:
    """B is where the circles about A (120) and O4 (80) meet, always on the same side of AO4."""
    motion = motion_of(name)
    bar = FourBar(100, 40, 120, 80)
    crank = degrees(motion, "crank")
    same(motion.trace("B"), bar.coupler_end(crank, side), 120)
    coupler, rocker = bar.phasors(crank, side)
    same(np.exp(1j * degrees(motion, "coupler")), coupler, 1)
    same(np.exp(1j * degrees(motion, "mu")), rocker / coupler, 1, within=2e-12)


@law("parallelogram")
def test_parallelogram_copies_the_crank() -> None:
    """θ4 = θ2, and the coupler never turns."""
    motion = motion_of("parallelogram")
    same(motion["rocker"], motion["crank"], 180)
    same(motion["coupler"], 0, 180)


@law("antiparallelogram")
def test_antiparallelogram_has_its_law_of_half_tangents() -> None:
    """tan(θ4/2) = -((g + a)/(g - a)) tan(θ2/2), g = 40, a = 20."""
    motion = motion_of("antiparallelogram")
    expected = -2 * np.arctan(3 * np.tan(degrees(motion, "crank") / 2))
    same(np.exp(1j * degrees(motion, "rocker")), np.exp(1j * expected), 1)


@law("galloway")
def test_galloway_turns_once_for_two_turns_of_the_crank() -> None:
    """Two turns of the crank are one of the follower: θ4 = 90° + φ/2 - acos(sin(φ/2)/2).

    O4 A = 2 sin(φ/2), its sign included, stands at the angle 90° + φ/2.
    """
    both = lw.example("galloway").sweep(from_=5, to=715, step=10, change_points="straight")
    for motion in (motion_of("galloway"), both):
        half = degrees(motion, "crank") / 2
        expected = math.pi / 2 + half - np.arccos(np.sin(half) / 2)
        same(degrees(motion, "follower"), expected, 2 * math.pi)


@law("slider-crank", "crank-slider")
def test_offset_slider_crank_has_its_closed_form_and_stroke() -> None:
    """Stroke √((l + r)² - e²) - √((l - r)² - e²) with r = 40, l = 120, e = 20."""
    oracle = SliderCrank(40, 120, -20j, 0)
    stroke = math.sqrt(160**2 - 20**2) - math.sqrt(80**2 - 20**2)
    for name, crank in (("slider-crank", "crank"), ("crank-slider", "θ2")):
        motion = motion_of(name)
        same(motion["d"], oracle.slide(degrees(motion, crank), 1), 120)
        limits = lw.example(name).sweep(limits_of=["d"]).output_limits
        ends = [limit.value for limit in limits]
        assert max(ends) - min(ends) == pytest.approx(stroke, abs=1e-10)


@law("slider-input")
def test_crank_of_a_driven_slider_follows_from_the_law_of_cosines() -> None:
    """cos of the angle at O2 = (a² + OB² - b²)/(2a·OB), OB² = d² + c²."""
    motion = motion_of("slider-input")
    pin = motion["d"] - 20j
    reach = np.abs(pin)
    opening = np.arccos((40**2 + reach**2 - 120**2) / (2 * 40 * reach))
    same(np.exp(1j * degrees(motion, "θ2")), np.exp(1j * (np.angle(pin) + opening)), 1)
