"""Dwells of circles, ramps and cams against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.foundation.errors import InputError


def circle(start: float, stop: float, step: float = 1.0) -> lw.Mechanism:
    return lw.loops(
        loops={"1": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", start=start, stop=stop, step=step),
        outputs={"ramp": "t/9"},
    )


@pytest.mark.parametrize("band", [0.01, 0.3, 1.5])
def test_a_cosine_dwells_about_its_extremes(band: float) -> None:
    motion = circle(-90, 90).sweep()
    expected = 2 * np.degrees(np.arccos(1 - band / 2))
    assert motion.value(f"dwell(x, {band})") == pytest.approx(expected, abs=1e-3)
    assert motion.value(f"dwell_start(x, {band})") == pytest.approx(-expected / 2, abs=1e-3)
    assert motion.quantities.find_of_motion("dwell(x, 1)").unit == "deg"


def test_a_ramp_stays_in_a_band_as_long_as_it_needs() -> None:
    assert circle(0, 90).sweep().value("dwell(ramp, 2)") == pytest.approx(18, rel=1e-9)


def test_a_whole_turn_goes_on_at_its_end() -> None:
    motion = circle(0, 360).sweep()  # its maximum lies where the table begins and ends
    expected = 2 * np.degrees(np.arccos(1 - 0.3 / 2))
    assert motion.value("dwell(x, 0.3)") == pytest.approx(expected, abs=1e-3)
    assert motion.value("dwell(x, 5)") == 360.0
    reverse = circle(360, 0, -1).sweep()
    assert reverse.value("dwell(x, 0.3)") == pytest.approx(expected, abs=1e-3)


def test_a_cam_dwells_as_it_was_designed_to() -> None:
    motion = lw.example("cam-roller-follower").sweep()
    assert 80 < motion.value("dwell(s, 0.001)") < 84  # 80 deg and a little of rise and fall
    assert motion.value("dwell_start(s, 0.001)") == pytest.approx(280, abs=2.5)


def test_dense_sampling_finds_the_same() -> None:
    mechanism, band, step = lw.example("four-bar"), 4.0, 0.02
    dense = mechanism.sweep(step=step)["rocker"]
    twice = np.concatenate([dense, dense[1:]])
    best, begin = 0, 0
    for end in range(len(twice)):
        while np.ptp(twice[begin : end + 1]) > band:
            begin += 1
        best = max(best, end - begin)
        if end - begin == best:
            begin_of_best = begin
    motion = mechanism.sweep()
    assert motion.value(f"dwell(rocker, {band})") == pytest.approx(best * step, abs=3 * step)
    begins = (begin_of_best * step) % 360
    assert motion.value(f"dwell_start(rocker, {band})") % 360 == pytest.approx(begins, abs=3 * step)


def test_designs_have_it_as_they_have_it_alone() -> None:
    mechanism, cranks = lw.example("four-bar"), [38.0, 40.0, 400.0]
    found = mechanism.family({"O2 A": cranks}).reduced(["dwell(rocker, 1)"])["dwell(rocker, 1)"]
    assert found[1] == pytest.approx(mechanism.sweep().value("dwell(rocker, 1)"), rel=1e-9)
    assert np.isnan(found[2])


def test_a_dwell_needs_the_height_of_its_band() -> None:
    motion = circle(0, 90).sweep()
    for text in ("dwell(x)", "dwell(x, wide)", "dwell(x, 1, 2)", "dwell(x, inf)"):
        with pytest.raises(InputError, match=r"must be dwell\(x, BAND\)"):
            motion.value(text)
    for band in (0, -1):
        with pytest.raises(InputError, match=f"band must be positive, got {band}"):
            motion.value(f"dwell(x, {band})")
