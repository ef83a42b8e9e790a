"""Tables over many turns of the input: a motion that repeats itself is solved once around."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.statuses import Certification
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.motion.following import Lap
from linkwork.core.results.motion import Motion
from tests.core.failures.test_positions_that_do_not_exist import four_bar
from tests.oracles.exact_turns import TURN

MILLION = 10**6


def turned(mechanism: lw.Mechanism, start: float, stop: float, step: float) -> lw.Mechanism:
    return type(mechanism)(mechanism.description.with_range(from_=start, to=stop, step=step))


def slider_crank(unit: lw.AngleUnit) -> lw.Mechanism:
    full = 360.0 if unit is lw.AngleUnit.DEGREE else 2.0 * math.pi
    return lw.loops(
        name="slider crank",
        angle=unit,
        loops={"L": "2*e^(i*q) + 5*e^(i*t) = s"},
        guess={"q": full / 6, "t": -full / 20, "s": 6},
        inputs=lw.Input(variable="q"),
    )


def half_speed() -> lw.Mechanism:
    """θ turns half as fast as φ, so the motion repeats itself after two turns."""
    return lw.loops(
        name="half speed",
        loops={"L": "4*e^(i*φ) + e^(i*θ) = s*e^(i*2*θ)"},
        guess={"φ": 60, "θ": 30, "s": 5},
        inputs=lw.Input(variable="φ"),
    )


def test_angles_less_whole_turns_are_exact_to_rounding() -> None:
    values = np.array([1e6, -1e7, 12345.678, 1e12, 0.5])
    for unit, turn in ((AngleUnit.DEGREE, Decimal(360)), (AngleUnit.RADIAN, TURN)):
        turns = np.floor(values / unit.turn)
        want = [float(Decimal(x) - int(k) * turn) for x, k in zip(values, turns, strict=True)]
        assert unit.without_turns(values, turns) == pytest.approx(want, rel=1e-15, abs=3e-16)


@pytest.mark.parametrize("unit", lw.AngleUnit)
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_million_turns_of_a_slider_crank_are_the_closed_form(
    unit: lw.AngleUnit, way: float
) -> None:
    turn = unit.turn
    step = way * (turn * MILLION / 10 + turn / 9)
    motion = turned(slider_crank(unit), 0.0, 10 * step, step).sweep()
    assert len(motion) == 11
    assert motion.certified.all()
    size = Decimal(360) if unit is lw.AngleUnit.DEGREE else TURN
    for asked, s, t in zip(motion["q"], motion["s"], motion["t"], strict=True):
        angle = float(Decimal(float(asked)) % size) * (2.0 * math.pi / turn)
        assert s == pytest.approx(2 * math.cos(angle) + math.sqrt(25 - 4 * math.sin(angle) ** 2))
        assert math.sin(t * (2.0 * math.pi / turn)) == pytest.approx(-0.4 * math.sin(angle))


@pytest.mark.parametrize("at", [1e6, -1e7, 1e9])
def test_a_far_value_in_radians_is_within_its_radius(at: float) -> None:
    """2π is no float: a million rounded turns were off by 2e-10 rad, with a radius of 1e-15."""
    position = slider_crank(lw.AngleUnit.RADIAN).solve(at=at)
    angle = float(Decimal(at) % TURN)
    error = abs(position["s"] - 2 * math.cos(angle) - math.sqrt(25 - 4 * math.sin(angle) ** 2))
    assert position.certificate.certified
    assert position.certificate.radius is not None
    assert error < 5.0 * position.certificate.radius
    assert error < 1e-14


def test_a_table_that_begins_far_away_is_the_table_turns_nearer() -> None:
    far = turned(lw.example("four-bar"), 1e6, 1e6 + 360, 10).sweep()
    near = turned(lw.example("four-bar"), 280, 640, 10).sweep()  # 10⁶ = 2777 · 360 + 280
    assert far.certified.all()
    assert far["rocker"] == pytest.approx(near["rocker"], abs=1e-9)
    assert far["crank"][0] == 1e6


def test_a_motion_that_needs_two_turns_to_come_back_does_so_in_tables() -> None:
    mechanism = half_speed()
    motion = turned(mechanism, 60, 60 + 360 * MILLION, 36_000_090).sweep()
    assert motion.certified.all()
    for at, s, angle in zip(motion["φ"], motion["s"], motion["θ"], strict=True):
        near = mechanism.solve(at=at % 720)
        assert s == pytest.approx(near["s"], rel=1e-12)
        assert angle == pytest.approx(near["θ"] + (at - at % 720) / 2, abs=1e-6)


def test_unknown_angles_turn_on_with_the_input() -> None:
    drag = four_bar(3, 3, 3, 1.5)  # both cranks turn all around
    motion = turned(drag, 100, 100 + 3600, 90).sweep()
    assert motion.certified.all()
    assert motion["rocker"][-1] == pytest.approx(motion["rocker"][0] + 3600, abs=1e-9)
    assert (np.diff(motion["rocker"]) > 0).all()


def test_largest_and_smallest_values_stand_next_to_the_rows_only() -> None:
    mechanism = half_speed()
    motion = turned(mechanism, 60, 60 + 360 * MILLION, 36_000_090).sweep(limits_of="s")
    extremes = ~motion.asked
    assert 0 < extremes.sum() <= 4 * motion.asked.sum()
    turns = np.round(motion["φ"][extremes] / 360)
    assert motion["φ"][extremes] == pytest.approx(360 * turns, abs=1e-6)
    # s = 5 after an even number of turns and 3 after an odd one
    assert motion["s"][extremes] == pytest.approx(np.where(turns % 2 == 0, 5.0, 3.0))


def test_limits_of_many_turns_stand_next_to_the_rows_only() -> None:
    rocker = four_bar(2, 5, 2, 4)  # the input swings between dead points
    few = turned(rocker, 0, 720, 36).sweep()
    many = turned(rocker, 0, 360 * MILLION, 36_000_036).sweep()
    assert (~few.asked).sum() >= 3
    assert (~many.asked).sum() <= 4 * many.asked.sum()
    ends = {round(limit.input % 360, 6) for limit in few.limits}
    assert {round(x % 360, 6) for x in many["crank"][~many.asked]} <= ends


def test_a_lap_that_is_not_proved_to_lead_back_certifies_its_own_rows_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Lap, "leads_back", lambda *_: False)
    motion = turned(lw.example("four-bar"), 0, 3600, 300).sweep()
    first = motion["crank"] < 360 + 40  # the guess stands at 40 degrees
    assert not motion.certified[motion["crank"] > 400].any()
    graded = zip(motion.certification, first, strict=True)
    assert {grade for grade, own in graded if not own} == {Certification.MOTION_NOT_PROVED}
    assert motion.certified[(motion["crank"] >= 40) & first].all()
    far = lw.example("four-bar").solve(at=10**6)
    assert far.certificate.certification is Certification.MOTION_NOT_PROVED


def test_rows_behind_more_change_points_than_are_passed_are_lost() -> None:
    """They lay on the branch before the first of them, as if that led there."""
    motion: Motion = turned(lw.example("parallelogram"), 0, 360 * 100, 3590).sweep(
        change_points="straight"
    )
    found = motion.found & motion.asked
    last = max(limit.input for limit in motion.limits if limit.passed)
    assert len([limit for limit in motion.limits if limit.passed]) >= 60
    assert motion["crank"][found].max() < last + 360
    assert not found[motion.asked & (motion["crank"] > last + 360)].any()
