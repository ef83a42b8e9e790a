"""Mechanisms that copy, translate, couple, or move as a sine."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

import linkwork as lw
from tests.library.laws import degrees, law, motion_of, same
from tests.oracles.four_bar import FourBar


@law("elliptic-trammel")
def test_elliptic_trammel_draws_an_ellipse() -> None:
    """P = (b cos θ, (b + c) sin θ): (x/50)² + (y/80)² = 1."""
    motion = motion_of("elliptic-trammel")
    rod = degrees(motion, "rod")
    same(motion.trace("P"), 50 * np.cos(rod) + 80j * np.sin(rod), 80)
    same(motion["ellipse"], 1, 1)


@law("scotch-yoke")
def test_scotch_yoke_moves_exactly_as_a_sine() -> None:
    """x = r cos θ, with all its derivatives."""
    motion = motion_of("scotch-yoke")
    crank = degrees(motion, "crank")
    same(motion["x"], 40 * np.cos(crank), 40)
    same(motion.series("x").second, -40 * np.cos(crank), 40)
    same(motion["y"], 40 * np.sin(crank), 40)


@law("oldham-coupling")
def test_oldham_coupling_turns_both_shafts_equally_and_its_cross_twice() -> None:
    """Both discs turn by the same angle; M = (e/2)(1 + e^{2iθ}) turns twice per revolution."""
    motion = motion_of("oldham-coupling")
    same(motion["disc2"] - motion["disc1"], 90, 360)
    same(motion.trace("M"), 6 + 6 * np.exp(2j * degrees(motion, "disc1")), 12)


@law("pantograph")
def test_pantograph_doubles_a_coupler_curve() -> None:
    """OQ = 2·OP, always in line: Q draws P's coupler curve twice as large."""
    motion = motion_of("pantograph")
    crank = degrees(motion, "crank")
    bar = FourBar(70, 20, 70, 50)
    a, b = bar.crank_end(crank), bar.coupler_end(crank, 1)
    p = a + (b - a) * complex(35, 30) / 70
    same(motion.trace("P"), p, 150)
    pole = complex(-75, -10)
    same(motion.trace("Q") - pole, 2 * (p - pole), 150)


@law("kempe-translator")
def test_kempe_translator_keeps_the_direction_of_its_plate() -> None:
    """The plate EF never turns: E = 60 e^{iα} + 70 e^{iβ}, F = E + 40."""
    motion = motion_of("kempe-translator")
    lower, upper = degrees(motion, "lower_bar"), degrees(motion, "upper_bar")
    same(motion["plate"], 0, 180)
    same(motion.trace("E"), 60 * np.exp(1j * lower) + 70 * np.exp(1j * upper), 130)
    same(motion.trace("F") - motion.trace("E"), 40, 130)


@law("cognate-1", "cognate-2", "cognate-3")
@pytest.mark.parametrize(
    ("name", "turning", "ahead"),
    [
        ("cognate-1", "crank", 0),
        ("cognate-2", "coupler", 0),
        ("cognate-3", "crank", cmath.phase(1 - complex(0.6, 0.5))),
    ],
)
def test_cognates_draw_one_curve(name: str, turning: str, ahead: float) -> None:
    """P = A + (0.6 + 0.5i)(B - A) of the first linkage, in all three."""
    motion = motion_of(name)
    crank = degrees(motion, turning) - ahead
    bar = FourBar(70, 30, 80, 60)
    a, b = bar.crank_end(crank), bar.coupler_end(crank, 1)
    same(motion.trace("P"), a + (b - a) * complex(0.6, 0.5), 80)


@law("geneva-drive")
@pytest.mark.parametrize(("slots", "ratio"), [(3, 6.464102), (4, 2.414214), (6, 1), (8, 0.619914)])
def test_geneva_wheel_turns_by_its_law_while_the_pin_is_in_the_slot(
    slots: int, ratio: float
) -> None:
    """tan β = λ sin α/(1 - λ cos α), λ = sin(180°/n); the wheel turns in the opposite direction."""
    drive = lw.example("geneva-drive").with_dimensions(n=slots)
    motion = motion_of("geneva-drive") if slots == 4 else drive.sweep()
    share = math.sin(math.pi / slots)
    alpha = degrees(motion, "driver")
    beta = np.arctan(share * np.sin(alpha) / (1 - share * np.cos(alpha)))
    same(np.exp(1j * degrees(motion, "wheel")), -np.exp(-1j * beta), 1)
    assert motion["wheel"][-1] - motion["wheel"][0] == pytest.approx(-360 / slots, abs=1e-10)
    assert -drive.solve(at=0).first["wheel"] == pytest.approx(ratio, abs=5e-7)
