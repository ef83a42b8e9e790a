"""Positions and lengths that determine a finite number of four-bars: all of them are found."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork import Completeness
from linkwork.circuits.homotopy.monodromy import (
    Member,
    solve_and_confirm,
    solve_by_few,
    trace_defect,
)
from linkwork.circuits.homotopy.parameter_roots import roots_at
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.synthesis.precision import given_lengths as own_start_sets
from linkwork.synthesis.precision.given_lengths import solved_member
from linkwork.synthesis.precision.positions import GivenLength, PrecisionPositions
from linkwork.synthesis.precision.problem import PrecisionProblem
from linkwork.synthesis.precision.solving import (
    PrecisionFourBars,
    SparingTracker,
    four_bars_through,
)
from tests.synthesis.precision.four_bar_tasks import GROUND, four_bar_points, passes

_NAMES = ("A0", "B0", "A", "B", "P")


def _task(
    crank: Array, pivots: int, names: list[str], posed: tuple[int, ...] = ()
) -> tuple[PrecisionPositions, ComplexArray]:
    """Positions of a real four-bar with some of its lengths, and its places at the first one."""
    a, b, p = four_bar_points(crank)
    places = np.array([0.0, GROUND, a[0], b[0], p[0]])
    angles = np.where(np.isin(np.arange(len(p)), posed), np.angle(b - a), np.nan)
    fixed = np.array([0.0, GROUND], dtype=complex)[:pivots]
    return PrecisionPositions.of(p, angles, fixed, _lengths(places, names)), places


def _lengths(places: ComplexArray, names: list[str]) -> list[GivenLength]:
    where = dict(zip(_NAMES, places.tolist(), strict=True))
    ends = [name.split() for name in names]
    return [GivenLength(one, other, abs(where[one] - where[other])) for one, other in ends]


def _solve(task: PrecisionPositions) -> PrecisionFourBars:
    return four_bars_through(task, member=solved_member(task.problem).member)


def _holds(found: PrecisionFourBars, places: ComplexArray) -> bool:
    """Whether a four-bar is among those found, with either name of its legs."""
    own = np.stack([found.fixed_a, found.fixed_b, found.moving_a[:, 0], found.moving_b[:, 0]])
    gaps = [
        np.abs(own - places[order][:, None]).max(axis=0) for order in ([0, 1, 2, 3], [1, 0, 3, 2])
    ]
    near = np.minimum(*gaps) < 1e-8
    return bool((near & found.proved).any())


@pytest.mark.parametrize(
    ("count", "pivots", "names", "posed", "solutions"),
    [
        (4, 2, ["A0 A"], (), 28),
        (3, 2, ["A0 A", "B P"], (), 24),
        (2, 2, ["A B", "A P", "B P"], (), 8),
        (3, 1, ["A0 A", "A P", "B P", "A0 B0"], (), 48),
        # the legs may exchange their names
        (5, 0, ["A B"], (0, 1, 2, 4), 24),
    ],
)
def test_the_four_bar_of_the_positions_is_among_all_that_have_its_lengths(
    count: int, pivots: int, names: list[str], posed: tuple[int, ...], solutions: int
) -> None:
    task, places = _task(np.radians(np.linspace(20.0, 200.0, count)), pivots, names, posed)
    found = _solve(task)
    assert (found.roots.paths, len(found.roots.x), found.roots.closed) == (solutions,) * 2 + (True,)
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    assert found.proved.all()
    assert len(found) == found.real
    assert _holds(found, places)
    points = four_bar_points(np.radians(np.linspace(20.0, 200.0, count)))[2]
    assert passes(found, points) < 1e-10
    where = {"A0": found.fixed_a, "B0": found.fixed_b, "A": found.moving_a[:, 0]}
    where |= {"B": found.moving_b[:, 0], "P": found.guided[:, 0]}
    for entry in task.lengths:
        length = np.abs(where[entry.one] - where[entry.other])
        assert length == pytest.approx(np.full(len(found), entry.length), rel=1e-12)


@pytest.mark.parametrize(
    ("problem", "solutions"),
    [
        (PrecisionProblem(poses=0, points=2, pivots=2, lengths=(("A", "B"), ("A0", "A"))), 32),
        (PrecisionProblem(poses=1, points=2, pivots=1, lengths=(("A", "B"), ("A0", "A"))), 32),
    ],
)
def test_random_targets_of_a_kind_have_one_number_of_solutions(
    problem: PrecisionProblem, solutions: int
) -> None:
    member = solved_member(problem).member
    assert member is not None
    rng = np.random.default_rng(5)
    counts = []
    for _ in range(2):
        goal = problem.random_parameters(rng)
        roots = roots_at(problem, member, goal, SparingTracker(len(member.x)), rng)
        counts.append((len(roots.x), roots.lost, roots.at_infinity))
    assert counts == [(solutions, 0, 0)] * 2


def test_the_trace_test_alone_does_not_see_that_mirror_images_of_the_coupler_are_missing() -> None:
    problem = PrecisionProblem(
        poses=0, points=1, pivots=2, lengths=(("A", "B"), ("A", "P"), ("B", "P"))
    )
    whole = solved_member(problem).member
    assert whole is not None
    x, x_bar, _, _, y, y_bar, _, _ = problem.linkages(whole.x, whole.parameters).T
    side = x * y_bar - x_bar * y
    half = Member(parameters=whole.parameters, x=whole.x[np.abs(side - side[0]) < 1e-6])
    assert len(half.x) == 4
    rng, tracker = np.random.default_rng(1), SparingTracker(1000)
    trace = trace_defect(problem, half, rng, tracker)
    assert (trace.lost, trace.relative < 1e-10, trace.less > 1e-3) == (0, True, True)
    assert len(solve_by_few(problem, half, rng, tracker).x) > 4
    assert solve_by_few(problem, whole, rng, tracker) is whole


def test_lengths_that_contradict_a_pose_in_general_are_no_kind_of_task() -> None:
    """The leg at the given pivot has three conditions for two unknowns."""
    problem = PrecisionProblem(poses=1, points=2, pivots=1, lengths=(("A", "P"), ("A0", "A")))
    own = solved_member(problem)
    assert own.member is None
    assert own.reason.startswith("in general some of the conditions contradict each other")


def test_a_start_set_is_kept_and_solved_anew_if_its_file_is_damaged(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem = PrecisionProblem(poses=1, points=1, pivots=2, lengths=(("A", "B"),))
    solved = solved_member(problem).member
    solve, calls = own_start_sets._solved, list[Any]()

    def counted(*given: Any) -> Any:
        calls.append(given)
        return solve(*given)

    monkeypatch.setattr(own_start_sets, "_solved", counted)
    for content, expected in ((None, 0), (b"none", 1), (None, 1)):
        monkeypatch.setattr(own_start_sets, "_KNOWN", {})
        if content is not None:
            own_start_sets._path(problem).write_bytes(content)
        again = solved_member(problem).member
        assert solved is not None
        assert again is not None
        assert again.x == pytest.approx(solved.x, rel=1e-9)
        assert len(calls) == expected


_FOUR = [(20.0, 80.0), (60.0, 100.0), (90.0, 90.0), (100.0, 60.0)]
_GIVEN = {"fixed_pivots": [(0.0, 0.0), (100.0, 0.0)], "lengths": {"B P": 60}}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {"_MOST_PATHS": 300, "_MOST_IN_NUMPY": 300},
            r"from those of 8 tasks; not all solutions .* known: after 300 paths with",
        ),
        ({"_ROUNDS": 1, "_SEED": 12}, r"tasks; not all solutions .*: the trace test denies "),
    ],
)
def test_a_task_without_a_start_set_is_sampled_and_says_why(
    changes: dict[str, int], told: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("LINKWORK_CACHE", str(tmp_path))
    monkeypatch.setattr(own_start_sets, "_KNOWN", {})
    for name, value in changes.items():
        monkeypatch.setattr(own_start_sets, name, value)
    if "_ROUNDS" in changes:
        monkeypatch.setattr(
            own_start_sets,
            "solve_and_confirm",
            lambda *given, **more: replace(solve_and_confirm(*given, **more), denied=True),
        )
    found = lw.Task.path(_FOUR, given=_GIVEN).solve()
    assert found.completeness is Completeness.SAMPLED
    assert re.search(told, found.message)
    assert found.proved > 2


def test_a_spent_budget_is_kept_until_more_may_be_spent(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("LINKWORK_CACHE", str(tmp_path))
    for name in ("_MOST_PATHS", "_MOST_IN_NUMPY"):
        monkeypatch.setattr(own_start_sets, name, 20)
    problem = PrecisionProblem(poses=1, points=1, pivots=2, lengths=(("A", "B"),))
    monkeypatch.setattr(own_start_sets, "_KNOWN", {})
    reason = solved_member(problem).reason
    assert "after 20 paths" in reason
    monkeypatch.setattr(own_start_sets, "_KNOWN", {})
    monkeypatch.setattr(own_start_sets, "_solved", None)  # which would be an error
    assert solved_member(problem).reason == reason
    monkeypatch.undo()
    monkeypatch.setenv("LINKWORK_CACHE", str(tmp_path))
    monkeypatch.setattr(own_start_sets, "_KNOWN", {})
    assert solved_member(problem).member is not None


@pytest.mark.parametrize(
    ("pivots", "lengths", "count"),
    [([[0, 0], [200, -50]], {"A0 A": 80}, 52), ([[100, -100]], {"A0 A": 120, "A P": 200}, 0)],
)
def test_four_bars_moved_to_their_lengths_stay_real(
    pivots: list[list[float]], lengths: dict[str, float], count: int
) -> None:
    """Some became complex, and their real parts pass no position. A crank of 120 and 200 along the
    coupler do not reach a point 344 away.
    """
    given = {"fixed_pivots": pivots, "lengths": lengths}
    found = lw.Task.path([(250, 0), (300, 60), (380, 100)], given=given).solve()
    assert found.real == found.proved
    assert found.real == pytest.approx(count, abs=3)  # rounding decides which settle
