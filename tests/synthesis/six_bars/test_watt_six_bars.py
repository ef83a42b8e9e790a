"""Six-bars through nine pairs: the start set, one path, its proof, and what is not proved."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.homotopy.path_tracking import track
from linkwork.core.foundation.arrays import Array
from linkwork.synthesis import six_bars as start_member
from linkwork.synthesis.six_bars import WATT, prove_six_bars, watt_six_bars
from tests.synthesis.six_bars.six_bars import ARMS, chebyshev, member_of, turned

INPUTS: Array = 0.5 * np.pi * chebyshev()
LOGARITHM: Array = 0.5 * np.pi * np.log10(1.0 + 9.0 * chebyshev())


def test_the_start_set_has_as_many_solutions_as_two_members_have() -> None:
    # confirmed by the trace test of scripts/start_linkages
    assert start_member.watt_member().x.shape == (26_370, 8)


def test_a_path_leads_to_a_proved_six_bar_that_follows_the_logarithm_exactly() -> None:
    member = member_of(ARMS, INPUTS)
    found = watt_six_bars(INPUTS, LOGARITHM, track, member=member)
    assert len(found) == 1
    assert found.proved.all()
    assert found.error[0] < 1e-12
    a, b, c, e = found.arms[0]
    t = found.turns[0]
    couplers = (
        1.0 + b * t - a * np.exp(1j * found.inputs),
        1.0 + e * np.exp(1j * found.outputs) - c * t,
    )
    for coupler in couplers:
        assert np.ptp(np.abs(coupler)) < 1e-12
    # the rounded six-bar itself misses by more
    assert np.abs(turned(ARMS, found.inputs) - found.outputs).max() > 1e-4
    exact = (a, b, -e, -c)
    assert turned(exact, found.inputs) == pytest.approx(found.outputs, abs=1e-11)


def test_numbers_that_are_no_solution_are_not_proved() -> None:
    member = member_of(ARMS, INPUTS)
    outputs = turned(ARMS, INPUTS - INPUTS[0])
    away = np.array([INPUTS - INPUTS[0], outputs])[:, 1:]
    good = prove_six_bars(member.x, *away)
    assert good.holds.all()
    # the pairs are those of the rounded six-bar to rounding, times a condition of a few thousand
    assert np.abs(good.arms[0, 0] - ARMS[0]) < 1e-10
    # another function altogether: no solution is near
    bad = prove_six_bars(member.x, away[0], away[1][::-1].copy())
    assert not bad.holds.any()
    assert np.isinf(bad.error).all()


def test_six_bars_of_real_pairs_come_with_their_mirror_images() -> None:
    member = member_of(ARMS, INPUTS)
    assert WATT.is_real(member.parameters)
    assert WATT.mirrored(member.x) == pytest.approx(member.x)
    assert not WATT.is_real(member.parameters * 1.1)
    assert not WATT.proper(np.zeros((1, 8), dtype=complex), member.parameters).any()


def test_a_damaged_start_set_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = start_member.SHIPPED.with_name("no_such_file.npz")
    monkeypatch.setattr(start_member, "SHIPPED", path)
    start_member.watt_member.cache_clear()
    try:
        with pytest.raises(lw.InputError, match=r"no_such_file.npz is damaged: install Linkwork"):
            start_member.watt_member()
    finally:
        start_member.watt_member.cache_clear()
