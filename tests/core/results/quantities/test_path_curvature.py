"""Curvature of circles, ellipses, straight lines and cycloids."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw


def test_a_crank_pin_runs_on_a_circle_about_its_pivot() -> None:
    motion = lw.example("slider-crank").sweep()
    np.testing.assert_allclose(motion["A.curvature"], 1 / 40, rtol=1e-13)
    np.testing.assert_allclose(motion["A.centre.x"], 0.0, atol=1e-12)
    np.testing.assert_allclose(motion["A.centre.y"], 0.0, atol=1e-12)
    assert motion.quantity("A.curvature").unit == "1/mm"
    assert motion.quantity("A.centre.x").unit == "mm"


def test_a_trammel_draws_an_ellipse() -> None:
    motion = lw.example("elliptic-trammel").sweep()
    x, y = motion["P.x"], motion["P.y"]
    a, b = 50.0, 80.0
    expected = 1 / (a * a * b * b * (x**2 / a**4 + y**2 / b**4) ** 1.5)
    np.testing.assert_allclose(np.abs(motion["P.curvature"]), expected, rtol=1e-11)
    evolute = (a * a - b * b) * (x / a) ** 3 / a  # of the ellipse
    np.testing.assert_allclose(motion["P.centre.x"], evolute, atol=1e-9)


def test_a_straight_path_has_curvature_0_and_no_centre() -> None:
    motion = lw.example("slider-crank").sweep()
    moving = np.abs(motion["B.x.d1"]) > 1e-6
    assert (motion["B.curvature"][moving] == 0.0).all()
    assert np.isnan(motion["B.centre.x"]).all()
    trammel = lw.example("elliptic-trammel").sweep(from_=1, to=89)
    assert (trammel["A.curvature"] == 0.0).all()
    assert np.isnan(trammel["A.centre.y"]).all()


def test_a_point_that_stands_still_has_no_curvature() -> None:
    wheel = lw.example("rolling-wheel").sweep()
    cusp = [0, -1]
    assert np.isnan(wheel["P.curvature"][cusp]).all()
    assert np.isnan(wheel["P.centre.x"][cusp]).all()
    turned = np.radians(wheel["wheel"][1:-1] + 90)  # of a cycloid: 1 / (4 r sin(t/2))
    np.testing.assert_allclose(
        np.abs(wheel["P.curvature"][1:-1]), 1 / (160 * np.abs(np.sin(turned / 2))), rtol=1e-10
    )


def test_it_does_not_depend_on_the_speed_along_the_path() -> None:
    """By differences of three positions far apart in the input: the circle through them."""
    mechanism, h = lw.example("hoeken"), 0.05
    z = [complex(*mechanism.solve(200 + k * h).points["P"]) for k in (-1, 0, 1)]
    sides = abs(z[1] - z[0]), abs(z[2] - z[1]), abs(z[2] - z[0])
    area = 0.5 * ((z[1] - z[0]).conjugate() * (z[2] - z[0])).imag
    found = mechanism.solve(200)["P.curvature"]
    assert found == pytest.approx(4 * area / np.prod(sides), rel=1e-5)
