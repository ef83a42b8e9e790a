"""Pressure angles of cams against the textbook's formula and the pitch curve; of sliders."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw


def test_of_a_translating_follower_it_is_the_textbooks() -> None:
    """tan α = (y' - e) / y for an axis offset by e  (Norton, Cam Design, eq. 7.1d)."""
    motion = lw.example("cam-roller-follower").sweep()
    y, rate = motion["R.y"], motion["R.y.d1"]
    expected = np.degrees(np.abs(np.arctan((rate - 8.0) / y)))
    np.testing.assert_allclose(motion["rise.pressure_angle"], expected, atol=1e-10)


def test_of_a_swinging_follower_it_is_that_of_the_pitch_curve() -> None:
    mechanism, h = lw.example("cam-swinging-follower"), 1e-3
    for at in (40.0, 80.0, 220.0):
        here, ahead, behind = (mechanism.solve(at + k * h) for k in (0, 1, -1))
        on_cam = [
            (complex(*p.points["R"]) - complex(*p.points["O"])) * np.exp(-1j * np.radians(p["cam"]))
            for p in (behind, ahead)
        ]
        tangent = (on_cam[1] - on_cam[0]) * np.exp(1j * np.radians(here["cam"]))
        arm = complex(*here.points["R"]) - complex(*here.points["P"])
        between = np.angle(1j * tangent / (1j * arm))
        expected = np.degrees(min(abs(between), np.pi - abs(between)))
        assert here["swing.pressure_angle"] == pytest.approx(expected, abs=1e-6)


def test_its_rate_is_that_of_its_values() -> None:
    mechanism, h = lw.example("cam-swinging-follower"), 1e-3
    ahead, behind = (mechanism.solve(40 + k * h)["swing.pressure_angle"] for k in (1, -1))
    rate = mechanism.solve(40)["swing.pressure_angle.d1"]
    assert rate == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


def test_of_a_slider_it_is_the_lean_of_the_rod() -> None:
    motion = lw.example("slider-crank").sweep()
    lean = np.degrees(np.arcsin((40 * np.sin(np.radians(motion["crank"])) + 20) / 120))
    np.testing.assert_allclose(motion["d.pressure_angle"], np.abs(lean), atol=1e-11)


def test_a_flat_face_has_none() -> None:
    derived = lw.example("eccentric-cam").model.quantities.derived
    assert not any(name.endswith("pressure_angle") for name in derived)
