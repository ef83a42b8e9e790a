"""Bilinear systems: all solutions, what is proved of them, and what happens at special ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from linkwork.circuits.homotopy import isolated_roots as roots_module
from linkwork.circuits.homotopy.bilinear_homotopy import (
    ParameterHomotopy,
    StartHomotopy,
    null_space,
    polish_roots,
)
from linkwork.circuits.homotopy.isolated_roots import quadratic_roots, structure_of
from linkwork.circuits.homotopy.path_tracking import PathOptions
from linkwork.core.numerics.bilinear import BilinearSystem, prove_roots
from tests.circuits.homotopy.bilinear_systems import (
    THETA_18,
    TRUSS_18,
    angles_only,
    random_triad,
    real_solution,
    roots_of,
)


def _exact(system: BilinearSystem) -> np.ndarray:
    return np.zeros(system.left.shape)


def test_jacobian_is_the_derivative_of_the_residual() -> None:
    system, _ = random_triad(0)
    mixed = BilinearSystem(  # an angle, a length on a fixed line, one along the angle
        left=system.left, right=system.right, rows=np.array([[0, 1, 2, 3], [0, 4, 0, 3],
                                                             [4, 4, 0, 4], [4, 1, 2, 4]])
    )  # fmt: skip
    rng = np.random.default_rng(1)
    x = rng.normal(size=(2, 8)) + 1j * rng.normal(size=(2, 8))
    for k in range(8):
        step = np.zeros(8, dtype=complex)
        step[k] = 1e-6
        for one in (system, mixed):
            ahead, behind = (one.residual_and_jacobian(x + s * step)[0] for s in (1, -1))
            slope = one.residual_and_jacobian(x)[1][:, :, k]
            np.testing.assert_allclose((ahead - behind) / 2e-6, slope, rtol=0, atol=1e-8)


@pytest.mark.parametrize("kind", ["start", "parameters"])
def test_homotopies_give_their_own_derivatives(kind: str) -> None:
    system, _ = random_triad(3)
    rng = np.random.default_rng(4)
    other = structure_of(system).random(rng)
    homotopy = (
        StartHomotopy.of(system, rng)
        if kind == "start"
        else ParameterHomotopy.between(other, system, rng)
    )
    w = rng.normal(size=(3, 4)) + 1j * rng.normal(size=(3, 4))
    sigma = np.array([0.2, 0.5, 0.9])
    _, jacobian, rate = homotopy.evaluate(w, sigma)
    h = 1e-6
    for k in range(4):
        e = np.eye(4)[k] * h
        change = homotopy.evaluate(w + e, sigma)[0] - homotopy.evaluate(w - e, sigma)[0]
        np.testing.assert_allclose(change / (2 * h), jacobian[:, :, k], rtol=0, atol=1e-6)
    change = homotopy.evaluate(w, sigma + h)[0] - homotopy.evaluate(w, sigma - h)[0]
    np.testing.assert_allclose(change / (2 * h), rate, rtol=0, atol=1e-6)


def test_all_products_of_forms_are_starts() -> None:
    system, _ = random_triad(5)
    start = StartHomotopy.of(system, np.random.default_rng(0))
    w = start.starts()
    assert w.shape == (6, 4)
    assert np.abs(start.evaluate(w, np.ones(6))[0]).max() < 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_triads_have_six_solutions_proved_and_apart_one_of_them_known(seed: int) -> None:
    system, t = random_triad(seed)
    roots = roots_of(system)
    assert (len(roots.x), roots.paths, roots.expected) == (6, 6, 6)
    assert (roots.failed, roots.at_infinity, roots.singular, roots.continuum) == (0, 0, 0, False)
    proofs = prove_roots(system, roots.x, _exact(system))
    assert proofs.holds.all()
    assert proofs.apart
    assert (proofs.real | proofs.unreal).all()
    assert np.abs(roots.x[proofs.real] - real_solution(t)).max(axis=1).min() < 1e-9


def test_eighteen_of_eighteen_are_real() -> None:
    system = angles_only(*TRUSS_18)
    roots = roots_of(system)
    proofs = prove_roots(system, roots.x, _exact(system))
    assert (len(roots.x), roots.expected, int(proofs.real.sum())) == (18, 18, 18)
    theta = np.sort(np.mod(np.angle(roots.x[:, 0]), 2 * np.pi))
    np.testing.assert_allclose(theta, THETA_18, rtol=0, atol=6e-11)  # ten printed decimals


def test_a_root_that_is_wrong_is_not_proved() -> None:
    system, t = random_triad(1)
    x = real_solution(t)[None, :]
    assert prove_roots(system, x, _exact(system)).real.all()
    wrong = np.asarray(x + 0.1, dtype=complex)
    assert not prove_roots(system, wrong, _exact(system)).holds.any()
    # coefficients known to 1e-3 only: the root may be elsewhere
    assert not prove_roots(system, x, _exact(system) + 1e-1).holds.any()


def test_the_same_root_twice_is_not_apart() -> None:
    system, t = random_triad(1)
    x = np.stack([real_solution(t)] * 2)
    x[1] *= 1 + 1e-15
    assert not prove_roots(system, x, _exact(system)).apart


def test_newton_says_how_many_steps_it_took_and_where_it_failed() -> None:
    system, t = random_triad(2)
    x, steps = polish_roots(system, np.stack([real_solution(t) + 1e-6, np.zeros(8)]))
    assert 0 < steps[0] <= 3
    np.testing.assert_allclose(x[0], real_solution(t), rtol=0, atol=1e-13)
    assert steps[1] == -1


def test_sums_within_a_column_are_found_and_kept() -> None:
    c = np.array([[1.3, 2.0, 0.0, 0.5], [0.0, -2.0, 1.0, 0.25], [1.3, 0.7j, 1.0, 0.75]])
    left = np.concatenate([c, c[:, :2], np.ones((3, 1))], axis=1).astype(complex)
    rows = np.tile(np.arange(6), (4, 1))
    structure = structure_of(BilinearSystem(left=left, right=left.conj(), rows=rows))
    assert structure.columns[0] == ((1,), (0,), (1,))
    assert structure.columns[1] == ((1, 0), (-1, 0), (0, 1))
    assert structure.columns[3] == ((1, 0), (0, 1), (1, 1))
    drawn = structure.random(np.random.default_rng(0)).left
    assert abs(drawn[0, 3] + drawn[1, 3] - drawn[2, 3]) < 1e-15
    assert drawn[0, 1] == -drawn[1, 1]
    assert drawn[2, 1] != drawn[0, 1]


def test_results_do_not_depend_on_what_was_solved_before(monkeypatch: pytest.MonkeyPatch) -> None:
    system, _ = random_triad(7)
    first = roots_of(system).x
    roots_of(angles_only(*TRUSS_18))
    assert np.array_equal(roots_of(system).x, first)
    monkeypatch.setattr(roots_module, "_KNOWN", {})
    assert np.array_equal(roots_of(system).x, first)


def test_lost_paths_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    system, _ = random_triad(8)
    roots_of(system)
    for care in ("BOLD", "CAREFUL"):
        monkeypatch.setattr(roots_module, care, PathOptions(attempts=3))
    roots = roots_of(system)
    assert (len(roots.x), roots.failed) == (0, 6)


def test_solutions_missing_at_first_are_looked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    system, _ = random_triad(8)
    followed, calls = roots_module._follow_paths, []

    def careless(*arguments: Any, **options: Any) -> Any:
        ends = followed(*arguments, **options)
        calls.append(options)
        if len(calls) == 1:  # as if a path had run to infinity by mistake
            ends.regular[2], ends.infinite[2] = False, True
        return ends

    roots_of(system)
    monkeypatch.setattr(roots_module, "_follow_paths", careless)
    roots = roots_of(system)
    assert (len(roots.x), roots.at_infinity, len(calls)) == (6, 0, 2)
    assert [options["nearest"] for options in calls] == [True, False]


def test_a_path_that_jumped_is_not_counted_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    system, _ = random_triad(9)
    known = roots_module.random_member(structure_of(system))
    twice = np.concatenate([known.x[:5], known.x[:1]])
    spoiled = roots_module.Solved(system=known.system, x=twice)
    monkeypatch.setitem(roots_module._KNOWN, structure_of(system), spoiled)
    roots = roots_of(system)
    assert (len(roots.x), roots.failed) == (4, 2)


def test_closed_paths_find_solutions_that_were_missing() -> None:
    system, _ = random_triad(10)
    structure = structure_of(system)
    known = roots_module.random_member(structure)
    part = roots_module.Solved(system=known.system, x=known.x[:2])
    whole = roots_module._close_paths(structure, part, np.random.default_rng(0))
    assert len(whole.x) == 6


@pytest.mark.parametrize("legs", [(12.0, 12.0, 12.0), (7.0, 7.0, 7.0)])
def test_a_congruent_platform_on_equal_legs_is_a_continuum(legs: tuple[float, ...]) -> None:
    base = np.array([0, 15.91, 3 + 10j])
    c = np.array([[legs[0], -legs[1], 0, base[1]], [legs[0], 0, -legs[2], base[2]]])
    roots = roots_of(angles_only(c, base[0] - base[1:]))
    assert roots.continuum
    assert roots.failed == 0
    assert len(roots.x) + roots.at_infinity + roots.singular == 6


def test_three_legs_in_one_point_are_multiple_but_no_continuum() -> None:
    """The platform at a dead point: legs that meet in one point (infinitesimally movable)."""
    centre, ends = 0.4 + 0.9j, np.array([0.0, 1.0, 0.2 + 1.7j])
    base = np.array([-1.0 - 0.5j, 2.0 - 0.4j, 0.3 + 3.0j])
    ends = centre + (base - centre) * np.array([0.35, 0.45, 0.3])
    legs = np.abs(base - ends)
    c = np.array(
        [
            [legs[0], -legs[1], 0, ends[1] - ends[0]],
            [legs[0], 0, -legs[2], ends[2] - ends[0]],
        ]
    )
    roots = roots_of(angles_only(c, base[0] - base[1:]))
    assert not roots.continuum
    assert (roots.failed, roots.singular, len(roots.multiple)) == (0, 2, 1)
    assert len(roots.x) == 4
    t = np.append((ends - base) / legs, 1.0)
    assert np.abs(roots.multiple[0] - real_solution(t)).max() < 1e-3


def test_a_regular_solution_is_on_no_curve() -> None:
    system, t = random_triad(4)
    assert not roots_module._on_a_curve(system, real_solution(t))


def _dyads(*closures: tuple[complex, complex, complex]) -> BilinearSystem:
    """Dyads p, q, f with p t + q s + f = 0, as one stack."""
    alone = [angles_only(np.array([[p, q]]), np.array([f])) for p, q, f in closures]
    left = np.stack([system.left for system in alone])
    return BilinearSystem(left=left, right=left.conj(), rows=alone[0].rows)


def _closes(closures: np.ndarray) -> np.ndarray:
    """Which p, q, f (K, 3) are the sides of a triangle."""
    p, q, f = np.abs(closures).T
    return np.asarray((f < p + q) & (f > np.abs(p - q)))


def test_dyads_have_two_solutions_each_in_closed_form() -> None:
    rng = np.random.default_rng(0)
    closures = rng.normal(size=(50, 3)) + 1j * rng.normal(size=(50, 3))
    systems = _dyads(*map(tuple, closures))
    found = quadratic_roots(systems)
    assert {(len(roots.x), roots.paths, roots.at_infinity) for roots in found} == {(2, 2, 0)}
    of = np.repeat(np.arange(50), 2)
    proofs = prove_roots(
        systems.take(of), np.concatenate([roots.x for roots in found]), _exact(systems)[of]
    )
    assert proofs.holds.all()
    assert all(proofs.take(np.flatnonzero(of == k)).apart for k in range(50))
    assert np.array_equal(proofs.real, _closes(closures)[of])
    assert np.array_equal(proofs.unreal, ~_closes(closures)[of])


@pytest.mark.parametrize("far", [3.5, 1.5])
def test_a_dyad_in_line_is_one_double_solution(far: float) -> None:
    (roots,) = quadratic_roots(_dyads((2.5, 1.0, -far * np.exp(0.7j))))
    assert (len(roots.x), len(roots.multiple), roots.singular, roots.continuum) == (0, 1, 2, False)
    assert abs(roots.multiple[0, 0] - np.exp(0.7j)) < 1e-15 * 8


@pytest.mark.parametrize("beside", [1e-5, 1e-9])
def test_a_dyad_beside_its_limit_is_told_apart(beside: float) -> None:
    for sign, real in ((-1, True), (1, False)):
        system = _dyads((2.5, 1.0, -3.5 * (1 + sign * beside)))
        (roots,) = quadratic_roots(system)
        assert (len(roots.x), len(roots.multiple)) == (2, 0)
        mine = system.take(np.zeros(2, dtype=np.intp))
        proofs = prove_roots(mine, roots.x, _exact(mine))
        assert proofs.real.all() == real
        # with coefficients this uncertain it might as well be at its limit, or beyond
        assert not prove_roots(mine, roots.x, _exact(mine) + 10 * beside).holds.any()


def test_a_dyad_that_folds_onto_itself_is_a_continuum() -> None:
    (roots,) = quadratic_roots(_dyads((2.5, -2.5, 0.0)))
    assert roots.continuum
    assert len(roots.x) == 0


def test_dyads_are_solved_together_as_they_are_alone() -> None:
    cases = [
        (2.5, 1.0, -3.5),
        (2.5, -2.5, 0.0),
        (1.0, 1.0, 1.5j),
        (2.5, 1.0, -1.5),
        (1.0, 2.0, 9.0),
    ]
    for case, roots in zip(cases, quadratic_roots(_dyads(*cases)), strict=True):
        (alone,) = quadratic_roots(_dyads(case))
        for name, value in vars(alone).items():
            assert np.array_equal(getattr(roots, name), value), (case, name)


def test_null_spaces_are_orthonormal() -> None:
    system, _ = random_triad(0)
    null, row = null_space(system.left)
    both = np.concatenate([null, row], axis=1)
    np.testing.assert_allclose(both.conj().T @ both, np.eye(5), rtol=0, atol=1e-14)
    assert np.abs(system.left @ null).max() < 1e-14
