"""Equations of precision positions: derivatives, cognates, start sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.circuits.homotopy.path_tracking import ParameterPath
from linkwork.synthesis.precision import solving as start_sets
from linkwork.synthesis.precision.problem import PrecisionProblem, cognates, exchange_legs
from linkwork.synthesis.precision.solving import SHIPPED_PROBLEMS, start_member

#: Solutions of a random member: Brake, Hauenstein, Murray, Myszka, Wampler 2016 for all positions,
#: Morgan and Wampler 1990 for given pivots; confirmed by ``scripts/start_linkages``.
COUNTS = {
    "1-8-0": 1442, "2-6-0": 1112, "3-4-0": 201, "4-2-0": 30,
    "1-6-1": 243, "2-4-1": 94, "3-2-1": 12, "1-4-2": 36, "2-2-2": 6,
}  # fmt: skip


_LENGTHS = (("A", "P"), ("A0", "A"), ("A0", "B0"), ("B", "P"))
_WITH_LENGTHS = (
    PrecisionProblem(poses=0, points=2, pivots=1, lengths=_LENGTHS),
    PrecisionProblem(poses=1, points=2, pivots=0, lengths=_LENGTHS),
)


@pytest.mark.parametrize(
    "problem", [*SHIPPED_PROBLEMS, *_WITH_LENGTHS], ids=lambda problem: problem.name
)
def test_derivatives_are_those_of_the_equations(problem: PrecisionProblem) -> None:
    rng = np.random.default_rng(1)
    start, goal = problem.random_parameters(rng), problem.random_parameters(rng)
    path = ParameterPath(system=problem, start=start, goal=goal)
    w = normal_numbers(rng, 2, problem.unknowns)
    sigma, step = np.array([0.3, 0.6]), 1e-6
    _, jacobian, change = path.evaluate(w, sigma)
    for k in range(problem.unknowns):
        aside = np.zeros(problem.unknowns)
        aside[k] = step
        ahead, behind = (path.evaluate(w + s * aside, sigma)[0] for s in (1.0, -1.0))
        slope = (ahead - behind) / (2.0 * step)
        assert slope == pytest.approx(jacobian[:, :, k], rel=1e-6, abs=1e-6)
    ahead, behind = (path.evaluate(w, sigma + s * step)[0] for s in (1.0, -1.0))
    assert (ahead - behind) / (2.0 * step) == pytest.approx(change, rel=1e-6, abs=1e-6)


def test_cognates_go_through_the_same_points() -> None:
    problem = PrecisionProblem(poses=0, points=8)
    c, linkage = problem.random_member(np.random.default_rng(2))
    path = ParameterPath(system=problem, start=c, goal=c)
    images = [linkage[None], *cognates(linkage[None])]
    images += [exchange_legs(image) for image in images]
    prints = np.concatenate([problem.fingerprint(image, c) for image in images])
    assert prints == pytest.approx(np.repeat(prints[:1], 6, axis=0), rel=1e-9)
    for image in images:
        f, jacobian = path.residual_and_jacobian(image)
        assert np.abs(np.linalg.solve(jacobian[0], f[0])).max() < 1e-9
    assert len({tuple(np.round(image[0], 6)) for image in images}) == 6


@pytest.mark.parametrize("problem", SHIPPED_PROBLEMS, ids=lambda problem: problem.name)
def test_start_sets_have_the_known_numbers_of_solutions(problem: PrecisionProblem) -> None:
    member = start_member(problem)
    assert len(member.x) == COUNTS[problem.name]
    path = ParameterPath(system=problem, start=member.parameters, goal=member.parameters)
    f, jacobian = path.residual_and_jacobian(member.x)
    change = np.linalg.solve(jacobian, f[:, :, None])[:, :, 0]
    assert (np.abs(change) / (0.1 + np.abs(member.x))).max() < 1e-7
    assert problem.proper(member.x, member.parameters).all()


def test_degenerate_solutions_are_no_linkages() -> None:
    problem = PrecisionProblem(poses=0, points=8)
    c, linkage = problem.random_member(np.random.default_rng(2))
    both_at_the_point, both_equal = linkage.copy(), linkage.copy()
    both_at_the_point[[0, 4]] = 0.0
    both_equal[4:] = linkage[:4]
    x = np.stack([linkage, both_at_the_point, both_equal])
    assert problem.proper(x, c).tolist() == [True, False, False]
    f, _ = ParameterPath(system=problem, start=c, goal=c).residual_and_jacobian(x)
    assert np.abs(f).max() < 1e-9  # though they solve all equations


def test_a_damaged_start_set_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = PrecisionProblem(poses=1, points=2, pivots=2)
    with np.load(start_sets.SHIPPED) as stored:
        arrays = dict(stored)
    x = arrays[f"{problem.name}.x"].copy()
    x[3] = x[2]
    path = tmp_path / "start_linkages.npz"
    monkeypatch.setattr(start_sets, "SHIPPED", path)
    read = start_member.__wrapped__
    for changed in ({**arrays, f"{problem.name}.x": x}, {"1-8-0.x": x}):
        np.savez(path, **changed)
        with pytest.raises(lw.InputError, match=r"start_linkages.npz is damaged: install Linkwork"):
            read(problem)
