"""Ctrl-C while starts are prepared, improved and proved: the best designs so far are kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.synthesis import lane_least_squares as lane_problems
from linkwork.synthesis.improvement import (
    curve_fit as curve_starts,
    fit_problem,
    fit_problem as mechanism_fit,
    fronts as front_designs,
    fronts as front_fit,
    improving,
    proved_design,
)
from linkwork.synthesis.solvers import solving
from tests.synthesis.test_pareto_front import CRANK

_GOALS = [{"of": "stroke(d)", "target": 70}]


def _stops(work: Callable[..., Any], call: int) -> Callable[..., Any]:
    """What raises an interruption instead of its call of this number."""
    calls = 0

    def stopping(*args: Any, **given: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls >= call:
            raise KeyboardInterrupt
        return work(*args, **given)

    return stopping


@pytest.fixture
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lane_problems, "cores", lambda: 1)
    monkeypatch.setattr(lane_problems.LaneProblem, "most_lanes", 8)


@pytest.mark.usefixtures("small_parts")
def test_starts_that_are_reached_are_improved_when_the_next_ones_are_interrupted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: dict[str, Any] = {"vary": ["O2 A"], "starts": 30}
    # the first call is that of the mechanism as it is
    monkeypatch.setattr(fit_problem.FitProblem, "_reach", _stops(fit_problem.FitProblem._reach, 3))
    found = lw.synthesis.improve(lw.loads(CRANK), _GOALS, **given)
    assert found[0].sound
    assert found[0].total == pytest.approx(0.0, abs=1e-18)
    assert found[0].message.startswith("interrupted: the best so far")
    monkeypatch.setattr(fit_problem.FitProblem, "_reach", _stops(lambda: None, 1))
    with pytest.raises(KeyboardInterrupt):
        lw.synthesis.improve(lw.loads(CRANK), _GOALS, **given)


@pytest.mark.usefixtures("small_parts")
def test_the_preparation_of_starts_is_counted_and_prepared_starts_are_designs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[float] = []
    monkeypatch.setattr(lane_problems, "minimise", _stops(lambda: None, 1))
    found = lw.synthesis.improve(
        lw.loads(CRANK), _GOALS, vary=["O2 A"], starts=30, progress=told.append
    )
    assert len(found) == 8
    assert found[0].sound
    assert found[0].message.startswith("interrupted: the best so far")
    assert len(set(told)) == len(told) == fit_problem.APPROACH
    assert told == sorted(told)


@pytest.mark.usefixtures("small_parts")
def test_a_front_is_begun_from_the_starts_that_are_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit_problem.FitProblem, "_reach", _stops(fit_problem.FitProblem._reach, 2))
    goals = [*_GOALS, {"of": "max(d)", "target": 60}]
    front = lw.synthesis.improve(lw.loads(CRANK), goals, vary=["O2 A"], starts=30, front=4)
    assert front
    assert all(design.message.startswith("interrupted: the best so far") for design in front)


@pytest.mark.parametrize("proofs", [1, 3])
def test_an_interruption_of_the_proofs_of_a_front_keeps_the_designs_that_are_proved(
    monkeypatch: pytest.MonkeyPatch, proofs: int
) -> None:
    goals = [*_GOALS, {"of": "max(d)", "target": 60}]
    given: dict[str, Any] = {"vary": ["O2 A"], "starts": 1, "front": 5}
    every = lw.synthesis.improve(lw.loads(CRANK), goals, **given)
    assert len(every) == 5
    stops = _stops(proved_design.fitted_design, proofs + 1)
    monkeypatch.setattr(front_designs, "fitted_design", stops)
    some = lw.synthesis.improve(lw.loads(CRANK), goals, **given)
    assert [design.numbers for design in some] == [design.numbers for design in every[:proofs]]
    assert all(design.sound for design in some)
    assert all(design.message.startswith("interrupted: the best so far") for design in some)
    monkeypatch.setattr(front_designs, "fitted_design", _stops(lambda: None, 1))
    with pytest.raises(KeyboardInterrupt):
        lw.synthesis.improve(lw.loads(CRANK), goals, **given)


def test_refused_designs_of_a_front_are_kept_too(monkeypatch: pytest.MonkeyPatch) -> None:
    goals = [*_GOALS, {"of": "max(d)", "target": 60}]
    task = lw.Task.improve(
        "slider-crank",
        goals=goals,
        vary=["O2 A"],
        starts=1,
        front=5,
        wanted={"clear_of": [[5, 0, 3]]},
    )
    assert len(task.solve().designs) > 2
    stops = _stops(proved_design.fitted_design, 3)
    monkeypatch.setattr(front_designs, "fitted_design", stops)
    found = task.solve()
    assert found.interrupted
    assert len(found.designs) == 2
    assert not found.delivered


def test_the_proofs_of_a_front_are_counted_and_finish_when_their_progress_is_interrupted() -> None:
    goals = [*_GOALS, {"of": "max(d)", "target": 60}]
    given: dict[str, Any] = {"vary": ["O2 A"], "starts": 1, "front": 5}
    told: list[float] = []
    lw.synthesis.improve(lw.loads(CRANK), goals, **given, progress=told.append)
    assert told == sorted(told)
    assert [share for share in told if share >= 0.9] == pytest.approx([0.9, 0.92, 0.94, 0.96, 0.98])

    def stop(fraction: float) -> None:
        if fraction > 0.93:
            raise KeyboardInterrupt

    front = lw.synthesis.improve(lw.loads(CRANK), goals, **given, progress=stop)
    assert len(front) == 5
    assert all(design.message.startswith("interrupted: the best so far") for design in front)


def test_a_front_is_kept_when_the_choice_of_its_next_lanes_is_interrupted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    goals = [*_GOALS, {"of": "max(d)", "target": 60}]
    spans, first = front_fit.objective_spans, iter([True])

    def once(*values: Array) -> Array:
        if next(first, False):
            raise KeyboardInterrupt
        return spans(*values)

    monkeypatch.setattr(front_fit, "objective_spans", once)
    front = lw.synthesis.improve(lw.loads(CRANK), goals, vary=["O2 A"], starts=1, front=5)
    assert front
    assert all(design.message.startswith("interrupted: the best so far") for design in front)


def test_results_do_not_depend_on_the_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = []
    for count in (1, 3):
        monkeypatch.setattr(lane_problems, "cores", lambda count=count: count)
        found = lw.synthesis.improve(lw.loads(CRANK), _GOALS, starts=30, seed=3)
        numbers.append([list(design.numbers.values()) for design in found])
    assert numbers[0] == numbers[1]


def test_proofs_that_are_interrupted_keep_the_designs_that_are_proved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    every = lw.synthesis.improve(lw.loads(CRANK), _GOALS, starts=5)
    assert len(every) > 2
    monkeypatch.setattr(improving, "fitted_design", _stops(proved_design.fitted_design, 3))
    some = lw.synthesis.improve(lw.loads(CRANK), _GOALS, starts=5)
    assert len(some) == 2
    assert all(design.message.startswith("interrupted: the best so far") for design in some)


def test_an_interrupted_search_proves_as_many_sound_designs_as_are_delivered() -> None:
    def stop(fraction: float) -> None:
        if fraction > 0.3:
            raise KeyboardInterrupt

    task = lw.Task.improve("slider-crank", goals=_GOALS, starts=6, rank={"deliver": 2})
    assert len(task.solve().designs) > 3
    found = task.solve(progress=stop)
    assert found.interrupted
    assert len(found.designs) == len(found.delivered) == 2


def test_draws_of_curves_that_are_interrupted_improve_the_best_so_far(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, 13)[:-1]
    points = [(3.0 * np.cos(a), np.sin(a)) for a in turns]
    task = lw.Task.path(points, mechanism="four-bar", improve={"starts": 2000})
    compared = curve_starts._compared
    monkeypatch.setattr(curve_starts, "_compared", _stops(compared, 7))
    found = task.solve()
    assert found.interrupted
    assert found.starts == 2000
    assert 0 < found.linkages <= 12
    assert min(design.error for design in found.designs) < 0.05
    monkeypatch.setattr(curve_starts, "_compared", _stops(compared, 1))
    with pytest.raises(KeyboardInterrupt):
        task.solve()


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_a_fit_of_a_function_that_is_interrupted_keeps_the_best_so_far(share: float) -> None:
    pairs = [(90.0 * x, 60.0 * x**2) for x in np.linspace(0.0, 1.0, 11)]
    task = lw.Task.function(pairs, mechanism="four-bar", fit="minimax")

    def stop(fraction: float) -> None:
        if fraction >= share:
            raise KeyboardInterrupt

    found, finished = task.solve(progress=stop), task.solve()
    assert found.interrupted
    assert not finished.interrupted
    assert found.message.startswith("interrupted: the best so far of")
    least = min(design.error for design in finished.designs)
    best = min(design.error for design in found.designs)
    assert (1.0 - 1e-9) * least <= best < 3.0 * least


def test_the_first_search_is_kept_when_the_second_is_interrupted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The crank that swings its rocker so far comes to a dead point, and is led again."""
    goal = {"of": "stroke(rocker)", "target": 150}
    bar = lw.example("four-bar")
    monkeypatch.setattr(improving, "fit_numbers", _stops(mechanism_fit.fit_numbers, 2))
    found = lw.synthesis.improve(bar, goal, starts=4, spread=0.3)
    assert len(found) == 4
    assert all(design.message.startswith("interrupted") for design in found)


def test_proofs_end_when_more_designs_are_sound_than_are_delivered() -> None:
    """They begin at 0.54 of all work, and are ten."""

    def stop(fraction: float) -> None:
        if fraction > 0.56:
            raise KeyboardInterrupt

    task = lw.Task.improve("slider-crank", goals=_GOALS, starts=10, rank={"deliver": 2})
    assert 2 < len(task.solve(progress=stop).designs) < 6


def test_a_ranking_that_is_interrupted_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    rank, calls = solving._ranked_alone, iter([True])

    def ranked(*given: Any, **further: Any) -> Any:
        if next(calls, False):
            raise KeyboardInterrupt
        return rank(*given, **further)

    monkeypatch.setattr(solving, "_ranked_alone", ranked)
    found = lw.Task.improve("slider-crank", goals=_GOALS, vary=["O2 A"], starts=2).solve()
    assert found.interrupted
    assert found.delivered
