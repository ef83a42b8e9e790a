"""The runner tells right answers from wrong ones."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.peers.loop_system import newton
from benchmarks.peers.reference import reference_of
from benchmarks.peers.verdict import TOLERANCE, Verdict, judged
from benchmarks.peers.work import Work, four_bar, four_bar_family, jansen_leg, rapier_drive
from tests.benchmarks.solvers import crossed, right


def counts(verdict: Verdict) -> tuple[int, int, int, int]:
    return verdict.found, verdict.other_branch, verdict.wrong, verdict.missing


def test_each_row_is_found_on_another_branch_nowhere_or_missing() -> None:
    work = four_bar(37)
    reference = reference_of(work)
    answer = reference.traced.copy()
    answer[0, 3:5] = crossed(work)[0, 3:5]
    answer[0, 10] += 1.0
    answer[0, 20:23] = np.nan
    verdict = judged(answer, reference)
    assert counts(verdict) == (31, 2, 1, 3)
    assert verdict.rows == 37


def test_the_error_is_that_of_the_worst_row_relative_to_the_longest_link() -> None:
    work = four_bar(37)
    reference = reference_of(work)
    answer = reference.traced.copy()
    answer[0, 5] += 120.0 * 0.5 * TOLERANCE
    verdict = judged(answer, reference)
    assert verdict.found == 37
    assert verdict.error == pytest.approx(0.5 * TOLERANCE, rel=1e-6)


def test_an_answer_without_any_right_row_has_no_error() -> None:
    work = four_bar(5)
    verdict = judged(np.full((1, 5), np.nan, complex), reference_of(work))
    assert counts(verdict) == (0, 0, 0, 5)
    assert np.isnan(verdict.error)


def test_rows_that_were_dropped_are_not_judged() -> None:
    work = four_bar(37)
    with pytest.raises(ValueError, match=r"shape \(1, 36\), asked were \(1, 37\)"):
        judged(right(work)[:, 1:], reference_of(work))


@pytest.mark.parametrize("work", [four_bar(61), jansen_leg(61)], ids=lambda work: work.name)
def test_closed_forms_agree_with_newton_on_the_loop_equations(work: Work) -> None:
    loops = work.members[0].loops
    solved = loops.trace(newton(loops, work.inputs), work.inputs)
    assert np.abs(solved - reference_of(work).traced[0]).max() <= 1e-12 * loops.scale


def test_the_rapier_drive_is_among_all_its_configurations() -> None:
    work = rapier_drive(61)
    reference = reference_of(work)
    near = np.abs(reference.configurations - reference.traced)
    assert np.nanmin(near, axis=0).max() <= 1e-9
    exist = np.isfinite(reference.configurations[:, 0]).sum(axis=0)
    assert set(exist.tolist()) <= {2, 4, 6}  # they appear and vanish in pairs


def test_the_jacobian_is_the_slope_of_the_residual() -> None:
    loops = rapier_drive(3).members[0].loops
    q, driven, h = loops.start, loops.driven(0.3), 1e-6
    steps = h * np.eye(loops.unknowns)
    slopes = [loops.residual(q + s, driven) - loops.residual(q - s, driven) for s in steps]
    np.testing.assert_allclose(loops.jacobian(q), np.array(slopes).T / (2 * h), atol=1e-5)


def test_a_member_of_a_family_is_the_linkage_alone() -> None:
    family = four_bar_family(members=5, rows=12)
    whole = reference_of(family)
    alone = reference_of(family.sample(3)).traced
    np.testing.assert_array_equal(alone, whole.sample(3).traced)
    np.testing.assert_allclose(right(family), whole.traced, atol=1e-14)
    assert np.isfinite(whole.traced).all()
