"""Lengths of paths: circles, straight lines, ellipses, cycloids with their cusps."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw


def test_a_crank_pin_runs_around_its_circle() -> None:
    motion = lw.example("slider-crank").sweep()
    assert motion.value("path_length(A)") == pytest.approx(80 * np.pi, rel=1e-9)
    assert motion.quantities.find_of_motion("path_length(A)").unit == "mm"
    assert motion.value("path_length(O2)") == 0.0


def test_a_block_runs_to_and_fro() -> None:
    motion = lw.example("slider-crank").sweep()
    stroke = np.sqrt(160**2 - 20**2) - np.sqrt(80**2 - 20**2)
    # rows lie beside the turning points: the rate is followed to its zero, not its size
    assert motion.value("path_length(B)") == pytest.approx(2 * stroke, rel=1e-5)


def test_an_ellipse_is_as_long_as_its_integral() -> None:
    t = np.linspace(0, 2 * np.pi, 4001)[:-1]
    expected = np.hypot(50 * np.sin(t), 80 * np.cos(t)).mean() * 2 * np.pi
    for step, error in ((1, 1e-9), (8, 1e-5)):
        motion = lw.example("elliptic-trammel").sweep(step=step)
        assert motion.value("path_length(P)") == pytest.approx(expected, rel=error)


def test_a_cycloid_is_eight_radii_long() -> None:
    motion = lw.example("rolling-wheel").sweep()
    assert motion.value("path_length(P)") == pytest.approx(320, rel=1e-7)


def test_designs_have_it_as_they_have_it_alone() -> None:
    mechanism, cranks = lw.example("four-bar"), [38.0, 40.0, 42.0]
    found = mechanism.family({"O2 A": cranks}).sweep().value("path_length(B)")
    # B turns back: the steps in which it does are halved in a motion only
    assert found[1] == pytest.approx(mechanism.sweep().value("path_length(B)"), rel=1e-6)
    assert (np.diff(found) > 0).all()


def test_missing_rows_are_left_out_and_none_is_no_length() -> None:
    family = lw.example("four-bar").family({"O2 A": [40.0, 400.0]})
    found = family.sweep().value("path_length(B)")
    assert np.isfinite(found[0])
    assert np.isnan(found[1])
    with pytest.raises(lw.UnknownNameError, match='there is no point "Z"'):
        family.sweep().value("path_length(Z)")
