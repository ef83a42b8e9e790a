"""Solutions by eigenvalues, compared with those that paths lead to."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from linkwork.circuits.homotopy import isolated_roots as roots_module
from linkwork.circuits.homotopy.dead_point_family import (
    DeadPointFamily,
    dead_points_of_one_loop,
    roots_of_two_loops,
)
from linkwork.circuits.homotopy.isolated_roots import isolated_roots, structure_of
from linkwork.core.numerics.bilinear import BilinearSystem
from tests.circuits.homotopy.bilinear_systems import angles_only, random_triad
from tests.circuits.homotopy.test_dead_point_system import four_bar


def assert_same_solutions(found: np.ndarray, expected: np.ndarray) -> None:
    assert found.shape == expected.shape
    gap = np.abs(found[:, None] - expected[None]).max(axis=2)
    # condition numbers of these systems are below 1e4
    assert gap.min(axis=1).max(initial=0.0) < 1e-11 * (1.0 + np.abs(expected).max(initial=0.0))
    assert sorted(gap.argmin(axis=1)) == list(range(len(found)))


@pytest.mark.parametrize("seed", range(6))
def test_triads_have_the_solutions_that_paths_lead_to(seed: int) -> None:
    system, _ = random_triad(seed)
    assert_same_solutions(
        roots_of_two_loops(system), isolated_roots(system, structure_of(system)).x
    )


def test_a_length_along_a_turning_direction_is_an_unknown_like_others() -> None:
    """A leg whose length is unknown in the place of the third one."""
    rng = np.random.default_rng(3)
    left = rng.normal(size=(2, 5)) + 1j * rng.normal(size=(2, 5))
    rows = np.array([[0, 1, 2, 3], [0, 1, 2, 2], [4, 4, 4, 2], [4, 4, 4, 3]])
    system = BilinearSystem(left=left, right=left.conj(), rows=rows)
    roots = isolated_roots(system, structure_of(system))
    assert_same_solutions(roots_of_two_loops(system), roots.x)


@pytest.mark.parametrize(
    "links", [(4.0, 2.0, 5.0, 3.5), (3.0, 2.0, 2.5, 2.2), (4.0, 1.0, 3.0, 3.3)]
)
def test_dead_points_of_four_bars_have_a_closed_form(links: tuple[float, ...]) -> None:
    """cos φ = (r1² + r2² - (r3 ± r4)²) / (2 r1 r2), complex where it is beyond ±1."""
    r1, r2, r3, r4 = links
    found = dead_points_of_one_loop(four_bar(*links))
    reach = np.array([r3 - r4, r3 + r4])
    cosines = (r1**2 + r2**2 - reach**2) / (2.0 * r1 * r2)
    expected = np.concatenate(
        [c + s * np.emath.sqrt(c * c - 1.0) for c in [cosines] for s in (1, -1)]
    )
    assert len(found) == 4
    gap = np.abs(found[:, 2][:, None] - expected[None]).min(axis=1)
    assert gap.max() < 1e-13
    system = four_bar(*links)
    assert_same_solutions(found, isolated_roots(system, DeadPointFamily.of(system)).x)


def test_solutions_at_infinity_and_double_ones_are_left_to_paths() -> None:
    change_point = four_bar(4.0, 2.0, 3.0, 5.0)  # 4 + 3 = 2 + 5
    assert len(dead_points_of_one_loop(change_point)) < 4
    # rounding makes single solutions of the double ones of a parallelogram
    assert len(dead_points_of_one_loop(four_bar(4.0, 2.0, 4.0, 2.0))) == 0
    base = np.array([0, 15.91, 3 + 10j])
    c = np.array([[12.0, -12.0, 0, base[1]], [12.0, 0, -12.0, base[2]]])
    assert len(roots_of_two_loops(angles_only(c, base[0] - base[1:]))) < 6
    parallel = np.array([[1.0, 2.0, 0.0, 0.0, 1.0], [1.0, 2.0, 0.0, 0.0, 3.0]], dtype=complex)
    k, one = np.arange(4), np.full(4, 4)
    never = BilinearSystem(left=parallel, right=parallel, rows=np.array([k, k, one, one]))
    assert len(roots_of_two_loops(never)) == 0


def test_no_path_is_followed_only_if_no_solution_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    system, _ = random_triad(2)
    family, calls = structure_of(system), []
    followed = roots_module._follow_paths

    def counted(*arguments: Any, **options: Any) -> Any:
        calls.append(options)
        return followed(*arguments, **options)

    roots_module.random_member(family)
    monkeypatch.setattr(roots_module, "_follow_paths", counted)
    known = roots_of_two_loops(system)
    whole = isolated_roots(system, family, known)
    assert (len(calls), len(whole.x), whole.paths) == (0, 6, 6)
    part = isolated_roots(system, family, known[:5])
    assert (len(calls), len(part.x)) == (1, 6)
