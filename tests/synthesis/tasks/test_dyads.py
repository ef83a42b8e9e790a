"""Dyads through five poses: published and planted ones, and none besides."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.synthesis.poses.burmester import DyadSet, PoseSet
from linkwork.synthesis.poses.dyads import Refusal, solve_five_poses
from tests.campaigns.poses import pose_campaign, random_poses
from tests.oracles.burmester import crank_turns

_PRINTED = 1e-9  # half a unit of the last digit of the numbers below, and a little


def _dyads(points: ComplexArray, angles: Array) -> DyadSet:
    poses = PoseSet(points=points[None], turns=np.exp(1j * angles)[None])
    return DyadSet.of_solutions(solve_five_poses(points[None], angles[None]), poses)


def _coupler_poses(degrees: list[float]) -> tuple[ComplexArray, Array]:
    """Ground 4, crank 1.5, coupler 3.5, rocker 3, open branch; the point 1 + 0.7i from A."""
    crank = 1.5 * np.exp(1j * np.radians(degrees))
    base = 4.0 - crank
    cosine = (3.5**2 + np.abs(base) ** 2 - 9.0) / (2.0 * 3.5 * np.abs(base))
    angles = np.angle(base) + np.arccos(cosine)
    return crank + (1.0 + 0.7j) * np.exp(1j * angles), angles


def test_the_dyads_of_a_four_bar_are_its_own_two_and_two_others() -> None:
    found = _dyads(*_coupler_poses([20, 50, 85, 120, 160]))
    expected = {
        0j: -1 - 0.7j,
        4 + 0j: 2.5 - 0.7j,
        9.2898832857 + 5.2483433365j: 9.8607435767 - 2.7209159885j,
        24.5152896506 - 31.6057489731j: 3.9980807933 + 11.4700428748j,
    }
    assert len(found) == 4
    assert set(found.kind) == {0}
    for fixed, moving in expected.items():
        k = np.abs(found.fixed - fixed).argmin()
        assert found.fixed[k] == pytest.approx(fixed, abs=1e-8)  # 1e-10 printed, times its size
        assert found.moving[k] == pytest.approx(moving, abs=_PRINTED)
        assert found.error[k] < 1e-7


def test_a_slider_crank_has_one_dyad_with_a_slider() -> None:
    """Crank 1, rod 3, offset 0.2; the body's point 1.2 + 0.5i from the crank's pin."""
    crank = np.exp(1j * np.radians([10, 60, 110, 170, 250]))
    angles = np.arcsin((0.2 - crank.imag) / 3.0)
    found = _dyads(crank + (1.2 + 0.5j) * np.exp(1j * angles), angles)
    slider = found.take(found.kind == 1)
    assert len(slider) == 1
    assert slider.moving[0] == pytest.approx(1.8 - 0.5j, abs=_PRINTED)
    assert abs(slider.normal[0].imag) == pytest.approx(1.0, abs=_PRINTED)
    assert slider.fixed[0].imag == pytest.approx(0.2, abs=_PRINTED)
    pinned = found.take(found.kind == 0)
    expected = [0j, 3.032207 + 22.861331j, 5.334154 + 1.161678j]
    for fixed in expected:
        assert np.abs(pinned.fixed - fixed).min() < 1e-6  # six decimals printed


def test_random_tasks_have_all_dyads_of_loop_closure_and_no_others() -> None:
    counts, false = pose_campaign(0, 150)
    assert not false
    assert counts["tasks proved complete"] == counts["tasks"] == 150
    assert counts["tasks that the oracle leaves open"] <= 3


def test_loop_closure_misses_a_dyad_that_is_taken_away(monkeypatch: pytest.MonkeyPatch) -> None:
    """The referee of the campaign is able to find a missing dyad."""
    whole = DyadSet.of_solutions

    def without_first(solved: object, poses: PoseSet) -> DyadSet:
        found = whole(solved, poses)  # type: ignore[arg-type]  # as it is called
        return found.take(np.arange(len(found)) > 0)

    monkeypatch.setattr(DyadSet, "of_solutions", without_first)
    _, false = pose_campaign(0, 3)
    assert len(false) == 1


def test_errors_bound_how_far_rounding_moves_pivots() -> None:
    """Far away the same poses are rounded anew; both bounds together cover the change."""
    points, angles, _ = random_poses(60, 3)
    # multiples of 2⁻³⁰ are exact in both places
    points = np.round(points * 2.0**30) / 2.0**30
    shift = 512 - 256j
    for here, turned in zip(points, angles, strict=True):
        one, other = _dyads(here, turned), _dyads(here + shift, turned)
        assert len(one) == len(other)
        for fixed, error in zip(one.fixed, one.error, strict=True):
            k = np.abs(other.fixed - shift - fixed).argmin()
            # the sum with the shift is rounded once more
            allowed = error + other.error[k] + 2.0**-52 * abs(other.fixed[k])
            assert abs(other.fixed[k] - shift - fixed) <= allowed


def test_equal_turns_and_translations_commute_with_the_solution() -> None:
    points, angles = _coupler_poses([10, 70, 100, 200, 300])
    turn = np.exp(0.7j)
    one, other = _dyads(points, angles), _dyads(3.0 * turn * points + 5 - 2j, angles + 0.7)
    assert len(one) == len(other)
    for moving, fixed in zip(one.moving, one.fixed, strict=True):
        k = np.abs(other.moving - 3.0 * moving).argmin()
        assert other.moving[k] == pytest.approx(3.0 * moving, rel=1e-7, abs=1e-7)
        assert other.fixed[k] == pytest.approx(3.0 * turn * fixed + 5 - 2j, rel=1e-7, abs=1e-7)


def test_poses_with_a_common_pole_leave_a_family() -> None:
    angles = np.radians([0.0, 20.0, 50.0, 70.0, 110.0])
    points: ComplexArray = np.asarray(2.0 * np.exp(1j * angles) + 1)
    solved = solve_five_poses(points[None], angles[None])
    assert not solved.is_real.any()
    assert not solved.complete[0]
    assert {Refusal.of_code(int(code)) for code in solved.refusal[0]} <= {
        Refusal.FAMILY,
        Refusal.COINCIDENT,
        Refusal.NO_JOINT,
    }


def test_close_poses_are_proved_up_to_a_condition_of_1e8() -> None:
    degrees = np.random.default_rng(2).uniform(0.0, 15.0, (40, 5)) + 30.0
    poses = [_coupler_poses(list(row)) for row in degrees]
    points: ComplexArray = np.array([pose[0] for pose in poses])
    angles = np.array([pose[1] for pose in poses])
    solved = solve_five_poses(points, angles)
    hard = (solved.condition > 1e6) & (solved.condition < 1e8)
    assert hard.sum() > 20
    if np.finfo(np.longdouble).eps < np.finfo(float).eps:
        assert np.isfinite(solved.error[hard]).all()


def test_the_oracle_finds_the_crank_of_a_four_bar() -> None:
    points, angles = _coupler_poses([20, 50, 85, 120, 160])
    turns = crank_turns(points, angles)
    assert np.abs(turns - np.exp(1j * np.radians(30))).min() < 1e-9
