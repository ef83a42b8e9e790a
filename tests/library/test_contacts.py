"""Gears, belts, racks, rolling wheels, cams and curves against their closed forms."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.contacts.curves import PitchCurve
from tests.library.laws import degrees, law, motion_of, same
from tests.oracles.four_bar import FourBar

Values = npt.NDArray[np.float64]


@law("planetary-gear")
def test_planetary_gear_turns_its_carrier_once_for_three_turns_of_the_sun() -> None:
    """sun : carrier = 1 + z_ring/z_sun = 3; the planet turns by 1 - 80/20 of the carrier."""
    motion = motion_of("planetary-gear")
    same(motion["carrier"], motion["sun"] / (1 + 80 / 40), 360)
    same(motion["planet"], (1 - 80 / 20) * motion["carrier"], 360)


@law("planetary-differential")
def test_differential_turns_its_carrier_by_the_weighted_mean() -> None:
    """carrier = (40 sun + 80 ring)/120, measured from the start."""
    motion = motion_of("planetary-differential")
    same(motion["carrier"], (40 * motion["sun"] + 80 * (motion["ring"] - 90)) / 120, 360)


@law("cardan-circles")
def test_cardan_circles_draw_a_line_and_an_ellipse() -> None:
    """P = 60 cos θ on a straight line; Q = 45 cos θ + 15 i sin θ on an ellipse."""
    motion = motion_of("cardan-circles")
    crank = degrees(motion, "crank")
    same(motion.trace("P"), 60 * np.cos(crank), 60)
    same(motion.trace("Q"), 45 * np.cos(crank) + 15j * np.sin(crank), 60)


@law("rolling-inside")
def test_a_wheel_of_a_quarter_size_draws_the_astroid() -> None:
    """x = R cos³t, y = R sin³t; the wheel turns by -3t."""
    motion = motion_of("rolling-inside")
    t = degrees(motion, "centers")
    same(motion.trace("P"), 60 * (np.cos(t) ** 3 + 1j * np.sin(t) ** 3), 60)
    same(motion["wheel"], -3 * motion["centers"], 360)


@law("rolling-wheel")
def test_a_rim_point_of_a_rolling_wheel_draws_the_cycloid() -> None:
    """x = r (t - sin t), y = r (1 - cos t)."""
    motion = motion_of("rolling-wheel")
    t = -math.pi / 2 - degrees(motion, "wheel")
    same(motion.trace("P"), 40 * (t - np.sin(t) + 1j * (1 - np.cos(t))), 250)
    same(motion["x"], 40 * t, 250)


@law("elliptical-gears")
def test_elliptical_gears_roll_on_each_other_about_their_foci() -> None:
    """tan(ψ/2) = -(1 + e)/(1 - e) tan(φ/2); the pitch curves are ellipses of semi-axis 50."""
    motion, e = motion_of("elliptical-gears"), 0.4
    first, second = degrees(motion, "first"), degrees(motion, "second")
    share = (1 + e) / (1 - e)
    same(
        np.exp(1j * second),
        np.exp(-2j * np.arctan2(share * np.sin(first / 2), np.cos(first / 2))),
        1,
        1e-13,  # rounding of the law
    )
    for curve in motion.skeleton.of(PitchCurve):
        points = np.array(curve.points)
        focus = 100 * e if curve.link == "first" else 100 * e * -1
        sums = [np.abs(points) + np.abs(points - f) for f in (focus, -focus)]
        same(min(sums, key=lambda s: float(np.ptp(s))), 100, 100, 1e-11)


@pytest.mark.parametrize("e", [0.1, 0.7, 0.9, 0.95])
def test_what_is_proved_of_elliptical_gears_is_true_of_their_formula(e: float) -> None:
    motion = lw.example("elliptical-gears").with_dimensions(ecc=e).sweep(step=0.37)
    assert motion.certified.all()
    phi = degrees(motion, "first")
    psi = -phi - 2 * np.arctan2(e * np.sin(phi), 1 - e * np.cos(phi))
    off = np.abs(degrees(motion, "second") - psi)
    assert np.all(off <= motion.radius + 4e-15)  # and the rounding of both angles


@law("oval-gears")
def test_oval_gears_turn_by_the_law_of_their_pitch_curves() -> None:
    """tan(ψ - 90°) = -(1 + e)/(1 - e) tan φ; both are r = p/(1 - e cos 2α), to 1e-4."""
    motion, e = motion_of("oval-gears"), 0.25
    first, second = degrees(motion, "first"), degrees(motion, "second")
    share = (1 + e) / (1 - e)
    law = np.arctan2(share * np.sin(first), np.cos(first))
    same(np.exp(1j * second), 1j * np.exp(-1j * law), 1, 1e-4)
    for curve in motion.skeleton.of(PitchCurve):
        points = np.array(curve.points)
        expected = 30 * (1 - e**2) / (1 - e * np.cos(2 * np.angle(points)))
        same(np.abs(points), expected, 30, 2e-4)


@law("geared-five-bar")
def test_geared_five_bar_closes_over_cranks_of_ratio_two() -> None:
    """right = 30° - 2·left; C is the left of the two points 130 from A and 120 from B."""
    motion = motion_of("geared-five-bar")
    left = degrees(motion, "left")
    same(motion["right"], 30 - 2 * motion["left"], 720)
    a = 40 * np.exp(1j * left)
    b = 110 + 30 * np.exp(1j * (math.pi / 6 - 2 * left))
    span = np.abs(b - a)
    along = (130**2 - 120**2 + span**2) / (2 * span)
    c = a + (along + 1j * np.sqrt(130**2 - along**2)) * (b - a) / span
    same(motion.trace("C"), c, 130)


@law("belt-drive")
def test_belt_drive_halves_the_angle_and_drives_a_crank_rocker() -> None:
    """pulley = motor/2 in the same direction; B as in a crank-rocker."""
    motion = motion_of("belt-drive")
    same(motion["pulley"], motion["motor"] / 2, 360)
    same(motion["crank"], motion["pulley"], 360)
    bar = FourBar(100, 40, 120, 107.11)
    same(motion.trace("B"), bar.coupler_end(degrees(motion, "crank"), 1), 120)


@law("crossed-belt")
def test_crossed_belt_leads_the_middle_along_a_straight_line() -> None:
    """right = 180° - left; C = i (a sin θ + √(l² - (d - a cos θ)²))."""
    motion = motion_of("crossed-belt")
    left = degrees(motion, "left")
    same(motion["right"], 180 - motion["left"], 360)
    height = 40 * np.sin(left) + np.sqrt(130**2 - (60 - 40 * np.cos(left)) ** 2)
    same(motion.trace("C"), 1j * height, 130)


@law("rack-and-pinion")
def test_pinion_turns_by_the_stroke_over_its_radius() -> None:
    """pinion = 90° + (s - s₀)/r with s = r₂ cos θ + √(l² - r₂² sin²θ)."""
    motion = motion_of("rack-and-pinion")
    crank = degrees(motion, "crank")
    s = 30 * np.cos(crank) + np.sqrt(100**2 - (30 * np.sin(crank)) ** 2)
    same(motion["s"], s, 130)
    same(degrees(motion, "pinion"), math.pi / 2 + (s - 95.39) / 20, 2 * math.pi)


@law("rack-steering")
def test_rack_steering_is_as_symmetric_as_a_car() -> None:
    """The rack moves by r times the pinion's angle; left(θ) + right(-θ) = -180°."""
    motion = motion_of("rack-steering")
    same(motion["s"], -371 + 8 * degrees(motion, "pinion"), 371)
    same(motion["left_arm"] + motion["right_arm"][::-1], -180, 180)
    outer = motion.trace("A") - motion.trace("C")
    same(np.abs(outer), 290, 290)


def risen(x: Values, rise: Callable[[Values], Values]) -> Values:
    """A rise over 0…1, level before and behind."""
    return rise(np.clip(x, 0.0, 1.0))


def cycloidal(x: Values) -> Values:
    return x - np.sin(2 * math.pi * x) / (2 * math.pi)


def modified_sine(x: Values) -> Values:
    """Norton, Cam Design and Manufacturing Handbook, equations 3.19."""
    y = math.pi * x - np.sin(4 * math.pi * x) / 4
    middle = 2 + math.pi * x - 9 * np.sin(4 * math.pi * x / 3 + math.pi / 3) / 4
    last = 4 + math.pi * x - np.sin(4 * math.pi * x) / 4
    return np.where(x < 1 / 8, y, np.where(x <= 7 / 8, middle, last)) / (4 + math.pi)


def polynomial(*coefficients: float) -> Callable[[Values], Values]:
    return np.polynomial.Polynomial(coefficients)


@law("cam-roller-follower")
def test_roller_follower_rises_cycloidally_and_falls_by_the_modified_sine() -> None:
    """s = √(50² - 8²) + 25 y(φ); dwells of 60° and 80°."""
    motion = motion_of("cam-roller-follower")
    phi = motion["cam"]
    lift = risen(phi / 100, cycloidal) - risen((phi - 160) / 120, modified_sine)
    same(motion["s"], math.sqrt(50**2 - 8**2) + 25 * lift, 75)
    slope = motion.series("s").first
    middle = np.flatnonzero(phi == 50)[0]
    same(slope[middle], 25 * 2 / math.radians(100), 25)  # twice the mean velocity


@law("cam-swinging-follower")
def test_swinging_follower_follows_its_polynomials() -> None:
    """The arm turns back by 18° y(φ): 3-4-5 up, 4-5-6-7 down."""
    motion = motion_of("cam-swinging-follower")
    phi = motion["cam"]
    up = polynomial(0, 0, 0, 10, -15, 6)
    down = polynomial(0, 0, 0, 0, 35, -84, 70, -20)
    lift = risen(phi / 110, up) - risen((phi - 160) / 130, down)
    ground = complex(-90, -10)  # from the pivot to the centre of the cam
    d = abs(ground)
    low = math.acos((75**2 + d**2 - 45**2) / (2 * 75 * d))
    begin = math.degrees(cmath.phase(ground) - low) + 360
    same(motion["arm"], begin - 18 * lift, 360)


@law("eccentric-cam")
def test_eccentric_disc_lifts_a_flat_face_harmonically() -> None:
    """s = r + e sin θ, to the error of a spline through 24 points of the circle."""
    motion = motion_of("eccentric-cam")
    same(motion["s"], 30 + 12 * np.sin(degrees(motion, "cam")), 30, within=2e-5)


@law("curved-slot")
def test_a_pin_in_a_circular_slot_moves_as_if_a_rocker_led_it() -> None:
    """|B - O4| = 80 and B as in Norton's four-bar, to the error of the slot's spline."""
    motion = motion_of("curved-slot")
    bar = FourBar(100, 40, 120, 80)
    same(motion.trace("B"), bar.coupler_end(degrees(motion, "crank"), 1), 120, within=1e-4)
    same(np.abs(motion.trace("B") - 100), 80, 80, within=1e-4)


@law("garage-door")
def test_garage_door_runs_from_upright_to_overhead() -> None:
    """The upper roller rises along the wall and ends level at 2600, to 3 mm of the track."""
    motion = motion_of("garage-door")
    top, low = motion.trace("H"), motion.trace("L")
    same(np.abs(top - low), 1900, 1900)
    same(np.abs(low - (500 + 900j)), math.hypot(500, 800), 1000)
    assert abs(top[0].real) < 3
    level = top.real > 600
    assert level.sum() > 10
    assert np.abs(top[level].imag - 2600).max() < 3


@law("dixon-one")
def test_dixons_points_stay_on_two_perpendicular_lines() -> None:
    """x_i → ±√(x_i² + t), y_j → ±√(y_j² - t) with one t at every position."""
    motion = motion_of("dixon-one")
    x = {"A1": 30.0, "A2": 50.0, "A3": -40.0}
    y = {"B1": 60.0, "B2": 80.0, "B3": -70.0}
    at = {name: motion.trace(name) for name in (*x, *y)}
    across = at["A2"] - at["A1"]
    same((across * (at["B2"] - at["B1"]).conj()).real, 0, 80**2)
    unit = across / np.abs(across)
    center = at["A1"] + ((at["B1"] - at["A1"]) * unit.conj()).real * unit
    t = [np.abs(at[name] - center) ** 2 - x[name] ** 2 for name in x]
    t += [y[name] ** 2 - np.abs(at[name] - center) ** 2 for name in y]
    same(np.ptp(t, axis=0), 0, 80**2)


@law("dixon-two")
def test_dixons_rectangles_keep_their_common_axes() -> None:
    """x1 x2, y1 y2 and x1² + y1² + x2² + y2² stay constant; all sixteen bars keep their lengths."""
    motion = motion_of("dixon-two")
    assert motion.found.all()
    corners = (1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j)
    p = np.array([motion.trace(f"P{k}") for k in range(1, 5)])
    q = np.array([motion.trace(f"Q{k}") for k in range(1, 5)])
    center = p.mean(axis=0)
    same(q.mean(axis=0), center, 80)
    unit = (p[0] - p[1]) / np.abs(p[0] - p[1])  # the axis along the first sides of both
    first, second = (p[0] - center) / unit, (q[0] - center) / unit
    for k, corner in enumerate(corners):
        same((p[k] - center) / unit, corner.real * first.real + 1j * corner.imag * first.imag, 80)
        same((q[k] - center) / unit, corner.real * second.real + 1j * corner.imag * second.imag, 80)
    same(first.real * second.real, 50 * 25, 80**2)
    same(first.imag * second.imag, 20 * 60, 80**2)
    same(np.abs(first) ** 2 + np.abs(second) ** 2, 50**2 + 20**2 + 25**2 + 60**2, 80**2)
    for i, a in enumerate(corners):
        for j, b in enumerate(corners):
            across = complex(a.real * 50 - b.real * 25, a.imag * 20 - b.imag * 60)
            same(np.abs(p[i] - q[j]), abs(across), 80)
    assert np.ptp(first.real) > 5  # they change their shapes


@law("parallel-cranks")
def test_coupled_wheels_turn_together() -> None:
    """All wheels turn by the same angle; the rod only translates."""
    motion = motion_of("parallel-cranks")
    same(motion["second"], motion["first"], 360)
    same(motion["third"], motion["first"], 360)
    same(motion["rod"], 0, 360)


@law("scissor-three-bars")
def test_three_parallel_bars_stay_parallel() -> None:
    """All bars turn by the same angle; F = 120 e^{iθ}."""
    motion = motion_of("scissor-three-bars")
    same(motion["bar2"], motion["bar1"], 360)
    same(motion["bar3"], motion["bar1"], 360)
    same(motion.trace("F"), 120 * np.exp(1j * degrees(motion, "bar1")), 120)
