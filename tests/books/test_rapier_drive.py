"""The textbook section's rapier drive, in both reconstructed readings, loops and links."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.results.failure import LimitKind

FULL = {"θ13": 188.572556, "θ15": 175.143712, "θ14": 67.394934, "s16": 216.940343}
FULL_SLOPE = {"θ13": -0.031126, "θ15": -0.113395, "θ14": 0.705483, "s16": -168.581}
LIMITED = {"θ13": 191.349010, "θ15": 180.211259, "θ14": 65.174661, "s16": 275.864911}
LINK = {"θ13": "rod", "θ15": "rocker", "θ14": "lever", "s16": "s16"}


def test_the_textbook_guess_converges_to_the_full_turn_reading() -> None:
    position = lw.example("rapier-drive").solve(at=60, from_guess=True)
    for name, printed in FULL.items():
        assert position[name] == pytest.approx(printed, abs=5e-7)


def test_newton_residuals_fall_as_computed_independently() -> None:
    position = lw.example("rapier-drive").solve(at=60, from_guess=True, with_steps=True)
    (trail,) = position.steps
    norms = [step.residual for step in trail.steps]
    printed = [346.96, 30.047, 2.1258, 7.776e-3, 1.41e-7]
    assert len(norms) == 6
    for norm, value in zip(norms, printed, strict=False):
        digits = len(f"{value:e}".split("e")[0].rstrip("0").replace(".", ""))
        assert float(f"{norm:.{digits - 1}e}") == value
    assert norms[5] < 1e-12


def test_velocity_coefficients_at_60_degrees() -> None:
    position = lw.example("rapier-drive").solve(at=60)
    for name, printed in FULL_SLOPE.items():
        assert position.first[name] == pytest.approx(printed, abs=5e-7 if name != "s16" else 5e-4)


def test_full_turn_reading_closes_with_the_printed_stroke() -> None:
    mechanism = lw.example("rapier-drive")
    fine = mechanism.sweep(step=0.01)
    assert fine.found.all()
    # the stroke is sampled each 0.01°, which misses an extremum by less than 2e-6 mm
    assert fine["s16"].min() == pytest.approx(-54.69985, abs=7e-6)
    assert fine["s16"].max() == pytest.approx(304.25187, abs=7e-6)
    np.testing.assert_allclose(fine.q[-1], fine.q[0], rtol=0, atol=1e-9)


def test_limited_reading_at_60_degrees() -> None:
    position = lw.example("rapier-drive-limited").solve(at=60, from_guess=True)
    for name, printed in LIMITED.items():
        assert position[name] == pytest.approx(printed, abs=5e-7)


def test_limited_reading_says_which_rows_are_out_of_reach() -> None:
    motion = lw.example("rapier-drive-limited").sweep()
    lost = [int(x) for x, ok in zip(motion["θ12"], motion.found, strict=True) if not ok]
    assert lost == list(range(150, 202))
    assert {s for s in motion.status if not s.ok} == {lw.Status.OUT_OF_REACH}
    low, high = sorted(limit.input for limit in motion.limits)
    # printed to 12 decimals: 1e-12 rad are 6e-11 deg
    assert low == pytest.approx(149.617278637485, abs=1e-12)
    assert high == pytest.approx(360 - 158.679899604109, abs=1e-12)
    assert all(limit.located and limit.kind is LimitKind.DEAD_POINT for limit in motion.limits)


@pytest.mark.parametrize(
    ("loops", "links"),
    [
        ("rapier-drive", "rapier-drive-links"),
        ("rapier-drive-limited", "rapier-drive-limited-links"),
    ],
)
def test_loops_and_points_give_the_same_cycle(loops: str, links: str) -> None:
    a, b = lw.example(loops).sweep(), lw.example(links).sweep()
    assert a.status == b.status
    for in_loops, in_links in LINK.items():
        p, q = a[in_loops], b[in_links]
        turn = 0 if in_loops == "s16" else 360 * np.round(np.nanmean((p - q) / 360))
        np.testing.assert_allclose(p - turn, q, rtol=0, atol=1e-8)
        series_a, series_b = a.series(in_loops), b.series(in_links)
        scale = np.nanmax(np.abs(series_a.second))
        np.testing.assert_allclose(series_a.first, series_b.first, rtol=0, atol=1e-8 * scale)
        np.testing.assert_allclose(series_a.second, series_b.second, rtol=0, atol=1e-6 * scale)


def test_the_written_loops_are_the_textbook_s() -> None:
    sheet = lw.example("rapier-drive-links").equations()
    assert [loop.label for loop in sheet.equations.loops] == ["A0 A B C C0", "C0 C D E"]
