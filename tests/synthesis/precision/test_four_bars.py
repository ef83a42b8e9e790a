"""All four-bars through positions: counts of the literature, the one the positions come from."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork import Completeness
from linkwork.circuits.homotopy.path_tracking import (
    LOST,
    QUICK,
    ParameterPath,
    Paths,
    track,
)
from linkwork.synthesis.precision.positions import prove_linkages
from linkwork.synthesis.precision.problem import PrecisionProblem, ProductSums
from linkwork.synthesis.precision.solving import (
    CompiledTracker,
    PrecisionFourBars,
    SparingTracker,
    compiled_pays,
    four_bars_through,
    positions_with_samples,
)
from tests.synthesis.precision.four_bar_tasks import (
    GROUND,
    LINE,
    NINE_POINTS,
    PROBLEM_3,
    four_bar_points,
    passes,
    positions,
    viable,
)

CRANK = np.radians([20.0, 50.0, 85.0, 120.0, 160.0, 200.0])
NAN = np.nan


def holds_original(found: PrecisionFourBars, crank: np.ndarray) -> bool:
    """Whether the four-bar that the positions were taken from is among those found."""
    a, b, _ = four_bar_points(crank)
    own = np.concatenate([[0.0, GROUND], a, b])
    for k in range(len(found)):
        one = np.concatenate(
            [[found.fixed_a[k], found.fixed_b[k]], found.moving_a[k], found.moving_b[k]]
        )
        other = np.concatenate(
            [[found.fixed_b[k], found.fixed_a[k]], found.moving_b[k], found.moving_a[k]]
        )
        if min(np.abs(one - own).max(), np.abs(other - own).max()) < 1e-9:
            return bool(found.proved[k])
    return False


def mixed(poses: list[int], points: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Crank angles, points and coupler angles of positions of the real four-bar."""
    a, b, p = four_bar_points(CRANK)
    angles = np.where(np.isin(np.arange(6), poses), np.angle(b - a), NAN)
    which = np.array(sorted([*poses, *points]))
    return CRANK[which], p[which], angles[which]


def test_four_poses_and_two_points() -> None:
    """The first position may be a point."""
    crank, points, angles = mixed([1, 2, 4, 5], [0, 3])
    found = four_bars_through(positions(points, angles), track)
    assert (len(found.roots.x), found.roots.paths, found.roots.lost) == (30, 30, 0)
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    assert found.proved.all()
    assert holds_original(found, crank)
    assert passes(found, points) < 1e-11
    assert found.error.max() < 1e-10


def test_two_poses_with_both_pivots_given() -> None:
    crank, points, angles = mixed([0, 3], [1, 5])
    found = four_bars_through(positions(points, angles, 0.0, GROUND), track)
    assert (found.roots.paths, found.completeness.complete) == (6, True)
    assert found.fixed_a == pytest.approx(np.zeros(len(found)))
    assert holds_original(found, crank)
    assert passes(found, points) < 1e-12


def test_five_points_on_a_line_with_both_pivots_given() -> None:
    """33 of 36 solutions are finite, 15 of them real."""
    found = four_bars_through(positions(LINE, None, 0.0, 1.0), track)
    roots = found.roots
    assert (roots.paths, len(roots.x), roots.at_infinity, roots.lost) == (36, 33, 3, 0)
    assert (roots.lost_paths, replace(roots, lost=2, at_infinity=1).lost_paths) == (
        "0 lost",
        "2 lost",
    )
    again = replace(roots, lost=2).lost_paths
    assert again == "2 lost but ends found as mirror images or by detours"
    assert (found.real, len(found), int(found.proved.sum())) == (15, 15, 15)
    assert passes(found, LINE) < 1e-12
    assert np.abs(found.fixed_b - found.fixed_a) == pytest.approx(np.ones(15))
    assert repr(found).splitlines()[:2] == [
        "Four-bars through 5 positions",
        "  solutions    33   of 36 paths; 3 to infinity, 0 singular, 0 lost",
    ]


def test_nothing_is_proved_of_a_linkage_that_misses_a_point() -> None:
    task = positions(LINE, None, 0.0, 1.0)
    found = four_bars_through(task, track)
    x = found.moving_a[:, 0] - LINE[0]
    y = found.moving_b[:, 0] - LINE[0]
    legs = [x, 0.0 - LINE[0] + 0 * x, y, 1.0 - LINE[0] + 0 * x]
    linkage = np.stack([z for leg in legs for z in (leg, np.conj(leg))], axis=1)
    assert prove_linkages(task, linkage).holds.all()
    # refinement cannot move pivots that are given elsewhere onto another task's solution
    far = replace(task, points=task.points + np.array([0.0, 0.0, 0.0, 40.0]))
    assert not prove_linkages(far, linkage).holds.any()


def test_a_task_without_real_solutions_has_an_empty_list(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("linkwork.synthesis.precision.solving.ALMOST_REAL", 0.0)
    found = four_bars_through(positions(LINE, None, 0.0, 1.0), track)
    assert (len(found), found.real, found.roots.complete) == (0, 0, True)
    assert found.moving_a.shape == found.guided.shape == (0, 5)


def test_one_exact_residual_proves_an_accurate_four_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    exact, seen = ProductSums.exact_residual, list[int]()

    def counted(sums: ProductSums, v: Any) -> list[int]:
        seen.append(1)
        return exact(sums, v)

    monkeypatch.setattr(ProductSums, "exact_residual", counted)
    found = four_bars_through(positions(*mixed([0, 1, 2, 3], [4, 5])[1:]))
    assert 0 < len(found) <= len(seen) < 1.5 * len(found)
    assert found.proved.all()
    assert holds_original(found, CRANK)
    assert (found.error < 1e-14 * np.abs(found.guided).max()).all()


def test_freedoms_that_positions_leave_are_drawn() -> None:
    _, _, points = four_bar_points(CRANK[:4])
    rng = np.random.default_rng(1)
    drawn = list(positions_with_samples(points, np.full(4, NAN), np.zeros(0, complex), 3, rng))
    assert [(len(p.pivots), len(p.points), p.listed) for p in drawn] == [(2, 4, 4)] * 3
    total = 0
    for task in drawn:
        found = four_bars_through(task, track)
        total += len(found)
        assert found.guided.shape == (len(found), 4)
        assert passes(found, points) < 1e-10
    assert total > 0
    corners = np.array([10.0, 12.0 + 3.0j])
    (inside,) = positions_with_samples(
        points, np.full(4, NAN), np.zeros(0, complex), 1, rng, corners
    )
    assert ((inside.pivots.real >= 10.0) & (inside.pivots.real <= 12.0)).all()
    assert ((inside.pivots.imag >= 0.0) & (inside.pivots.imag <= 3.0)).all()


@pytest.mark.parametrize(
    ("points", "angles", "pivots", "message"),
    [
        ([1, 1], [NAN, NAN], [], "a four-bar needs at least two positions, and points that differ"),
        ([1], [NAN], [], "a four-bar needs at least two positions, and points that differ"),
        ([1, 2j], [0.0, 1.0], [], "positions that all have an angle are met by dyads"),
        (range(10), [NAN] * 10, [], "a four-bar meets at most 8 conditions, these are 9: a pose"),
        (range(6), [0.0, 1.0, 2.0, NAN, NAN, NAN], [1j], "these are 9"),
    ],
)
def test_wrong_tasks_are_refused(
    points: list[complex], angles: list[float], pivots: list[complex], message: str
) -> None:
    given = np.array(points, dtype=complex), np.array(angles), np.array(pivots, dtype=complex)
    with pytest.raises(lw.InputError, match=message):
        list(positions_with_samples(*given, 1, np.random.default_rng(1)))


_MODULE = "linkwork.synthesis.precision.solving"


def test_few_paths_need_no_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{_MODULE}._FOLLOWED", [0.0])
    assert not compiled_pays(30)
    assert compiled_pays(100_000)
    monkeypatch.setattr(f"{_MODULE}.find_spec", lambda name: None)
    assert not compiled_pays(100_000)


def test_paths_that_creep_in_numpy_make_compiled_code_pay(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rounds count: a batch of one path may take thousands of them."""
    followed = []

    def creeping(path: Any, start: Any, options: Any, progress: Any = None) -> Paths:
        followed.append("NumPy")
        return Paths(w=start, near=start, state=np.full(len(start), LOST), steps=5000)

    monkeypatch.setattr(f"{_MODULE}._FOLLOWED", [0.0])
    monkeypatch.setattr(f"{_MODULE}.is_loaded", lambda loop: False)
    monkeypatch.setattr(f"{_MODULE}.is_compiled", lambda loop: True)
    monkeypatch.setattr(f"{_MODULE}.track", creeping)
    monkeypatch.setattr(CompiledTracker, "__call__", lambda *given: followed.append("compiled"))
    tracker = SparingTracker(243)
    ends, start = np.ones(14, dtype=complex), np.ones((4, 6), dtype=complex)
    problem = PrecisionProblem(poses=0, points=6, pivots=1)
    path = ParameterPath(system=problem, start=ends, goal=ends)
    for _ in range(3):
        tracker(path, start, QUICK)
    assert followed == ["NumPy", "compiled", "compiled"]


@pytest.mark.extended
def test_problem_3_of_wampler_morgan_sommese() -> None:
    """64 of 1442 triples are real; one curve is passed in order on one branch, by two drives."""
    found = four_bars_through(positions(PROBLEM_3), CompiledTracker())
    assert (len(found.roots.x), found.roots.closed) == (1442, True)
    assert (found.real, len(found), int(found.proved.sum())) == (64, 192, 192)
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    assert passes(found, PROBLEM_3) < 1e-11
    sound = viable(found)
    pivots: dict[str, list[tuple[complex, ...]]] = {"A0": [], "B0": []}
    for k, drive in sound:
        ends = (found.fixed_a[k], found.moving_a[k, 0], found.moving_b[k, 0], found.fixed_b[k])
        pivots[drive].append(ends)
    assert len({int(found.triple[k]) for k, _ in sound}) == 1
    expected = {
        "crank": (1.216697353 + 0.885850113j, 0.850171852 + 0.39562559j,
                  0.843788734 - 0.441256324j, 1.341128943 + 0.084540412j),
        "rocker": (0.704459402 + 0.413897464j, 0.862976703 - 0.103429464j,
                   0.747340208 + 0.525796736j, 1.341128943 + 0.084540412j),
    }  # fmt: skip
    driven = [
        ends if drive == "A0" else ends[::-1] for drive, all_ in pivots.items() for ends in all_
    ]
    assert len(driven) == 2
    for wanted in expected.values():
        assert min(np.abs(np.array(ends) - np.array(wanted)).max() for ends in driven) < 2e-9


@pytest.mark.extended
def test_another_set_of_nine_points() -> None:
    found = four_bars_through(positions(NINE_POINTS), CompiledTracker())
    assert (len(found.roots.x), found.roots.closed) == (1442, True)
    assert (found.real, int(found.proved.sum())) == (21, 63)


@pytest.mark.extended
@pytest.mark.parametrize(
    ("poses", "points", "count"),
    [([0, 2, 5], [1, 3, 4, 6], 201), ([1, 4], [0, 2, 3, 5, 6, 7], 1112)],
)
def test_mixed_positions(poses: list[int], points: list[int], count: int) -> None:
    crank = np.radians(np.linspace(15.0, 230.0, 8))
    a, b, p = four_bar_points(crank)
    angles = np.where(np.isin(np.arange(8), poses), np.angle(b - a), NAN)
    which = np.array(sorted([*poses, *points]))
    found = four_bars_through(positions(p[which], angles[which]), CompiledTracker())
    assert len(found.roots.x) == count
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    assert holds_original(found, crank[which])
