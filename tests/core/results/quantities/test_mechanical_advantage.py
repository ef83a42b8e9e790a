"""Mechanical advantage against closed forms, and where rates vanish."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw


def test_of_a_four_bar_it_is_a_ratio_of_sines() -> None:
    """ω2/ω4 = c sin(θ3 - θ4) / (a sin(θ3 - θ2))  (Norton, Design of Machinery, eq. 6.18b)."""
    motion = lw.example("four-bar").sweep()
    places = {p: motion.trace(p) for p in ("O2", "A", "B", "O4")}
    crank, coupler, rocker = (
        places[q] - places[p] for p, q in (("O2", "A"), ("A", "B"), ("O4", "B"))
    )

    def cross(one: np.ndarray, two: np.ndarray) -> np.ndarray:
        return np.asarray((one.conj() * two).imag)

    expected = cross(rocker, coupler) / cross(crank, coupler)
    rows = abs(expected) < 1e3
    np.testing.assert_allclose(
        motion["rocker.mechanical_advantage"][rows], expected[rows], rtol=1e-9
    )
    assert motion.quantity("rocker.mechanical_advantage").unit == ""


def test_it_carries_the_unit_of_force_for_a_moment() -> None:
    motion = lw.example("slider-crank").sweep()
    np.testing.assert_allclose(motion["d.mechanical_advantage"], 1.0 / motion["d.d1"], rtol=1e-15)
    assert motion.quantity("d.mechanical_advantage").unit == "1/mm"
    driven = lw.example("slider-input").model.quantities
    units = {name: asked.unit for name, asked in driven.derived.items() if "advantage" in name}
    assert set(units.values()) <= {"", "mm"}
    assert "mm" in units.values()


def test_its_rate_is_that_of_its_values() -> None:
    mechanism, h = lw.example("slider-crank"), 1e-3
    ahead, behind = (mechanism.solve(50 + k * h)["d.mechanical_advantage"] for k in (1, -1))
    rate = mechanism.solve(50)["d.mechanical_advantage.d1"]
    assert rate == pytest.approx((ahead - behind) / (2 * np.radians(h)), rel=1e-7)
    with pytest.raises(lw.UnknownNameError, match="positions have two derivatives"):
        mechanism.sweep()["d.mechanical_advantage.d2"]


def test_it_is_infinite_where_the_part_stands_still() -> None:
    circle = lw.loops(
        loops={"1": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", from_=0, to=30, step=30),
    )
    motion = circle.sweep()
    assert motion["x.mechanical_advantage"][0] == np.inf
    assert motion["y.mechanical_advantage"][0] == pytest.approx(0.5, rel=1e-15)


def test_it_is_infinite_at_the_dead_centres_of_a_press() -> None:
    """The ram's rate is rounding there, 1e-14 mm/rad, in a motion, a position and a family."""
    press, name = lw.example("crank-press"), "height.mechanical_advantage"
    motion = press.sweep()
    at = motion.inputs["crank"][np.isinf(motion[name])]
    np.testing.assert_allclose(at, [90.0, 270.0, 450.0], rtol=1e-15)
    assert press.solve(at=270)[name] == np.inf
    bend = 60.0 + 60.0**2 / 400.0  # second derivative of the height there
    near = press.solve(at=270 + 1e-6)[name]
    assert near == pytest.approx(1.0 / (bend * np.radians(1e-6)), rel=1e-6)
    designs = press.family({"O A": [60.0, 50.0]}).sweep()
    assert (np.isinf(designs[name]).sum(axis=1) == 3).all()


def test_it_is_missing_at_dead_points_of_the_input() -> None:
    motion = lw.example("rapier-drive-limited").sweep()
    dead = np.array(motion.limit) == "dead point"
    assert dead.any()
    assert np.isnan(motion["θ14.mechanical_advantage"][dead]).all()
