"""Closed paths lead from one solution to all, and the trace test sees whether one is missing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.circuits.homotopy.monodromy import (
    Member,
    first_of_each,
    solve_further,
    trace_defect,
)
from linkwork.circuits.homotopy.parameter_roots import roots_at
from linkwork.circuits.homotopy.path_tracking import (
    SINGULAR,
    Equations,
    ParameterPath,
    polish_ends,
    track,
)
from linkwork.core.foundation.arrays import BoolArray, ComplexArray
from linkwork.core.foundation.statuses import Completeness


class Quintic:
    """z⁵ + c1 z² + c0 = 0, a real member's mirror images are the conjugates."""

    unknowns, parameters, last = 1, 2, slice(0, 2)

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        square = z[0] * z[0]
        value = square * square * z[0] + c[1] * square + c[0]
        slope = 5.0 * square * square + 2.0 * c[1] * z[0]
        return [value], [[slope]], [rate[1] * square + rate[0]]

    def random_parameters(self, rng: np.random.Generator) -> ComplexArray:
        return normal_numbers(rng, 2)

    def random_member(self, rng: np.random.Generator) -> tuple[ComplexArray, ComplexArray]:
        z, c1 = normal_numbers(rng, 2)
        return np.array([-(z**5) - c1 * z**2, c1]), np.array([z])

    def proper(self, x: ComplexArray, c: ComplexArray) -> BoolArray:
        return np.ones(len(x), dtype=bool)

    def fingerprint(self, x: ComplexArray, c: ComplexArray) -> ComplexArray:
        return x

    def is_real(self, c: ComplexArray) -> bool:
        return bool((c.imag == 0.0).all())

    def mirrored(self, x: ComplexArray) -> ComplexArray:
        return x.conj()


@pytest.fixture(scope="module")
def solved() -> Member:
    rng = np.random.default_rng(1)
    c, one = Quintic().random_member(rng)
    return solve_further(Quintic(), Member(parameters=c, x=one[None]), rng, track)


def test_closed_paths_find_all_solutions(solved: Member) -> None:
    assert len(solved.x) == 5
    c0, c1 = solved.parameters
    expected = np.sort_complex(np.roots([1, 0, 0, c1, 0, c0]))
    assert np.sort_complex(solved.x[:, 0]) == pytest.approx(expected, rel=1e-9)


def test_the_trace_of_all_solutions_is_straight_and_that_of_fewer_is_not(solved: Member) -> None:
    whole = trace_defect(Quintic(), solved, np.random.default_rng(2), track)
    assert (whole.lost, whole.relative < 1e-10) == (0, True)
    less = Member(parameters=solved.parameters, x=solved.x[1:])
    part = trace_defect(Quintic(), less, np.random.default_rng(2), track)
    assert part.relative > 1e-3


def roots_of(solved: Member, *c: complex) -> Any:
    goal = np.array(c, dtype=complex)
    return roots_at(Quintic(), solved, goal, track, np.random.default_rng(3))


def test_solutions_of_a_real_member_are_closed_under_conjugation(solved: Member) -> None:
    found = roots_of(solved, 1.0, -3.0)
    assert (len(found.x), found.closed, found.complete, found.lost) == (5, True, True, 0)
    real = np.sort(found.x[np.abs(found.x.imag) < 1e-9].real)
    polynomial = np.roots([1, 0, 0, -3, 0, 1])
    assert real == pytest.approx(np.sort(polynomial[np.abs(polynomial.imag) < 1e-9].real))


def test_double_solutions_are_counted_as_singular(solved: Member) -> None:
    """The value and the slope of z⁵ - 5/2 z² + 3/2 vanish at z = 1."""
    found = roots_of(solved, 1.5, -2.5)
    assert (len(found.x), len(found.singular), found.lost) == (3, 2, 0)
    assert found.singular == pytest.approx(np.ones((2, 1)), abs=1e-3)


def test_lost_paths_are_replaced_by_mirror_images_and_detours(solved: Member) -> None:
    expected = roots_of(solved, 1.0, -3.0).x
    calls = []

    def careless(path: ParameterPath, start: ComplexArray, options: Any) -> Any:
        paths = track(path, start, options)
        calls.append(len(start))
        if len(calls) <= 2:  # the straight paths: the first two are lost, twice
            paths.state[:2] = 2
        return paths

    goal = np.array([1.0, -3.0], dtype=complex)
    found = roots_at(Quintic(), solved, goal, careless, np.random.default_rng(3))
    assert (found.lost, found.by_mirror + found.by_detour) == (2, 2)
    assert found.by_detour > 0
    assert np.sort_complex(found.x[:, 0]) == pytest.approx(np.sort_complex(expected[:, 0]))


@pytest.mark.parametrize(("c", "detours"), [((1.0, -3.0), 3), ((1.5, -2.5), 1)])
def test_detours_of_special_tasks_end_when_one_finds_nothing(
    solved: Member, c: tuple[float, float], detours: int
) -> None:
    """A real solution that no path reaches; the second member has a double solution as well."""
    expected = roots_of(solved, *c).x
    lost = float(expected[np.abs(expected.imag) < 1e-9].real.min())
    calls = []

    def blind(path: ParameterPath, start: ComplexArray, options: Any) -> Any:
        paths = track(path, start, options)
        calls.append(len(start))
        paths.state[np.abs(paths.w[:, 0] - lost) < 1e-3] = 2
        return paths

    goal = np.array(c, dtype=complex)
    found = roots_at(Quintic(), solved, goal, blind, np.random.default_rng(3))
    assert calls == [5, 1, *[5, 5] * detours]
    assert (len(found.x), found.lost, found.by_detour, found.complete) == (
        len(expected) - 1, 1, 0, False,
    )  # fmt: skip


def test_of_paths_that_meet_one_is_followed_again(solved: Member) -> None:
    """A tracker that jumps once: both ends are the same."""
    calls = []

    def jumping(path: ParameterPath, start: ComplexArray, options: Any) -> Any:
        paths = track(path, start, options)
        calls.append(len(start))
        if len(calls) == 1:
            paths.w[3] = paths.w[1]
        return paths

    goal = np.array([1.0, -3.0], dtype=complex)
    found = roots_at(Quintic(), solved, goal, jumping, np.random.default_rng(3))
    assert calls == [5, 2]
    assert (len(found.x), found.complete, found.by_mirror) == (5, True, 0)


def test_a_path_that_stalls_beside_its_end_leaves_no_singular_solution_of_complete_ones(
    solved: Member,
) -> None:
    """The mirror image shows where the path leads; with all solutions found there is no other."""

    def stalling(path: ParameterPath, start: ComplexArray, options: Any) -> Any:
        paths = track(path, start, options)
        stalled = paths.w[:, 0].imag > 0.1
        paths.w[stalled] += 0.1
        paths.near[stalled], paths.state[stalled] = paths.w[stalled], SINGULAR
        return paths

    goal = np.array([1.0, -3.0], dtype=complex)
    found = roots_at(Quintic(), solved, goal, stalling, np.random.default_rng(3))
    assert (len(found.x), found.by_mirror, len(found.singular)) == (5, 1, 0)
    assert found.graded(np.ones(5, dtype=bool)) is Completeness.WITH_PROBABILITY_ONE


def test_repeated_rows_are_found_in_any_order() -> None:
    rng = np.random.default_rng(4)
    rows = normal_numbers(rng, 40, 3) * 10.0 ** rng.integers(-2, 6, 40)[:, None]
    twice = np.concatenate([rows, rows[::2] * (1 + 1e-9)])
    order = rng.permutation(len(twice))
    kept = first_of_each(twice[order])
    assert len(kept) == 40
    assert (np.diff(kept) > 0).all()
    first = {min(k for k in range(60) if same(order, k, other)) for other in range(60)}
    assert set(kept.tolist()) == first


def same(order: Any, one: int, other: int) -> bool:
    """Whether two places of the permuted rows hold the same one."""
    a, b = (int(order[k]) for k in (one, other))
    return (a if a < 40 else 2 * (a - 40)) == (b if b < 40 else 2 * (b - 40))


def test_polishing_tells_simple_from_double_solutions_and_from_none() -> None:
    goal = np.array([1.5, -2.5], dtype=complex)
    path = ParameterPath(system=Quintic(), start=goal, goal=goal)
    start = np.array([[1.0 + 1e-4], [-0.7], [np.nan]], dtype=complex)
    with np.errstate(all="ignore"):
        ends = polish_ends(path, start)
    assert ends.regular.tolist() == [False, True, False]
    assert ends.multiple.tolist() == [True, False, False]


class CountedQuintic(Quintic):
    """Counts the points at which it is evaluated."""

    points = 0

    def equations(self, z: Any, c: Any, rate: Any) -> Any:
        self.points += len(z[0])
        return super().equations(z, c, rate)


def test_solutions_that_have_settled_are_polished_no_more() -> None:
    goal = np.array([1.5, -2.5], dtype=complex)
    system = CountedQuintic()
    # one simple solution, and a start from which the double one takes every step
    start = np.array([[-0.7]] * 50 + [[1.0 + 1e-4]], dtype=complex)
    ends = polish_ends(ParameterPath(system=system, start=goal, goal=goal), start)
    assert ends.regular[:50].all()
    assert system.points < 5 * len(start)
