"""Fronts between goals: known in closed form, not convex, of one design, with bounds and wishes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import MechanismError
from linkwork.synthesis.improvement import fronts as front_designs
from linkwork.synthesis.improvement.fronts import spread, undominated

#: The slider-crank of the library with rows 30° apart; its slider runs 20 below the crank.
CRANK = lw.example_text("slider-crank").replace("step = 1\n", "step = 30\n")


def _values(front: tuple[lw.synthesis.ImprovedDesign, ...]) -> Array:
    return np.array([list(design.goals.values()) for design in front])


def _ends(a: Array, rod: Array | float) -> tuple[Array, Array]:
    """The least and the largest d, where crank and rod are in line."""
    return np.sqrt((rod - a) ** 2 - 20.0**2), np.sqrt((rod + a) ** 2 - 20.0**2)


def _dominated(values: Array) -> list[int]:
    return [
        k
        for k, own in enumerate(values)
        if any((other <= own).all() and (other < own).any() for other in values)
    ]


def test_a_front_of_two_lengths_is_that_of_the_closed_form() -> None:
    """Of all rods the shortest one brings the slider nearest to 60, whatever the stroke."""
    crank = lw.loads(CRANK)
    goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    bounds = {"O2 A": (10, 50), "B A": (80, 200)}
    front = lw.synthesis.improve(
        crank, goals, vary=["O2 A", "B A"], bounds=bounds, front=5, starts=1
    )
    values = _values(front)
    assert len(front) == 5
    assert not _dominated(values)
    assert (np.diff(values[:, 0]) > 0).all()
    a = np.array([design.numbers["O2 A"] for design in front])
    # fits of several rounds end within a millionth of the spans of the goals
    assert [design.numbers["B A"] for design in front] == pytest.approx([80.0] * 5, abs=1e-4)
    least, most = _ends(a, 80.0)
    expected = np.stack([70 - (most - least), most - 60], axis=1)
    assert values == pytest.approx(expected, abs=1e-4)
    assert values[0, 0] == pytest.approx(0.0, abs=1e-5)
    assert a[-1] == pytest.approx(10.0, abs=1e-6)
    # no part of the front is much longer than the others
    steps = np.linalg.norm(np.diff(values / np.ptp(values, axis=0), axis=0), axis=1)
    assert steps.max() < 2.0 * steps.min()
    for design in front:
        assert lw.Mechanism(design.description).sweep().certified.all()
        assert design.sound


def test_parts_of_a_front_that_no_weighted_sum_reaches_are_found() -> None:
    """u = sqrt(sin s), v = sqrt(cos s): u⁴ + v⁴ = 1 bulges outwards, also as squares."""
    crank = lw.loads(CRANK)
    goals = [{"of": f"sqrt({f}(stroke(d)))", "target": 0} for f in ("sin", "cos")]
    front = lw.synthesis.improve(
        crank, goals, vary=["O2 A"], bounds={"O2 A": (2.5, 42.5)}, front=6, starts=1
    )
    values = _values(front)
    assert len(front) == 6
    assert (values**4).sum(axis=1) == pytest.approx(np.ones(6), abs=1e-9)
    assert not _dominated(values)
    # the least of u² + w v² is at an end for every w: the inner designs are no weighted sums
    for weight in (0.2, 0.5, 1.0, 2.0, 5.0):
        assert (values**2 @ [1.0, weight]).argmin() in (0, 5)


@pytest.mark.parametrize(
    ("ends", "bound", "largest"),
    [
        ((21.604, 23.522), {}, 23.522),
        # the same end by a bound that is a goal
        ((21.604, 26.0), {"of": "max(A.y)", "most": 23.522}, 23.522),
    ],
)
def test_a_front_that_lies_on_a_bound_and_is_ended_by_one_is_found_whole(
    ends: tuple[float, float], bound: dict[str, Any], largest: float
) -> None:
    """Rods are at their shortest; the second goal is ten times as large as its span.

    A dense grid of designs has the front; its parts between the ends were lost where the squares
    of the second goal outweighed the limit of the first one.
    """
    crank = lw.loads(CRANK)
    goals = [{"of": "max(d)", "target": 115.113}, {"of": "min(d)", "target": 51.527}]
    bounds = {"O2 A": ends, "B A": (95.57, 178.636)}
    front = lw.synthesis.improve(
        crank,
        [*goals, *([bound] if bound else [])],
        vary=["O2 A", "B A"],
        bounds=bounds,
        front=8,
        starts=1,
    )
    values = _values(front)
    a, rod = (x.ravel() for x in np.meshgrid(np.linspace(ends[0], largest, 200),
                                             np.linspace(*bounds["B A"], 200)))  # fmt: skip
    least, most = _ends(a, rod)
    dense = np.abs(np.stack([most - 115.113, least - 51.527], axis=1))
    order = np.lexsort(dense.T[::-1])
    lowest = np.minimum.accumulate(np.append(np.inf, dense[order, 1]))[:-1]
    dense = dense[order][dense[order, 1] < lowest]
    spans = np.ptp(dense, axis=0)
    # eight designs are an eighth of the front apart, some two of these parts by their choice
    apart = np.linalg.norm((dense[:, None] - values) / spans, axis=2)
    assert apart.min(axis=1).max() < 1.5 * np.sqrt(2.0) / 7.0
    assert len(front) == 8
    assert not any((dense + 1e-3 < own).all(axis=1).any() for own in values)
    assert front[-1].numbers["O2 A"] == pytest.approx(largest, abs=1e-4)


def test_equal_goals_and_goals_met_together_have_one_design() -> None:
    crank = lw.loads(CRANK)
    stroke = {"of": "stroke(d)", "target": 70}
    (twice,) = lw.synthesis.improve(crank, [stroke, stroke], vary=["O2 A"], front=4, starts=1)
    assert list(twice.goals) == ["stroke(d)", "stroke(d) (2)"]
    assert max(twice.goals.values()) < 1e-9
    wanted = crank.with_dimensions({"O2 A": 35.0, "B A": 110.0}).sweep(certify=False)
    goals = [{"of": of, "target": wanted.value(of)} for of in ("stroke(d)", "max(d)")]
    (both,) = lw.synthesis.improve(crank, goals, vary=["O2 A", "B A"], front=4, starts=1)
    assert both.numbers == pytest.approx({"O2 A": 35.0, "B A": 110.0}, abs=1e-6)


def test_a_bound_ends_a_front_and_one_that_nothing_keeps_is_told() -> None:
    crank = lw.loads(CRANK)
    goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    given: dict[str, Any] = {"vary": ["O2 A"], "starts": 1, "front": 3}
    front = lw.synthesis.improve(crank, [*goals, {"of": "stroke(d)", "least": 50}], **given)
    strokes = [70 - design.goals["stroke(d)"] for design in front]
    assert min(strokes) == pytest.approx(50.0, abs=1e-4)
    assert min(strokes) >= 50.0
    (broken,) = lw.synthesis.improve(crank, [*goals, {"of": "max(d)", "most": 10}], **given)
    assert not broken.sound
    (told,) = broken.broken
    assert told.startswith("goal max(d) comes up to ")
    assert told.endswith(", wanted at most 10")
    assert told in broken.message


@pytest.mark.parametrize("until", [0.1, 0.35])
def test_an_interrupted_front_keeps_the_designs_so_far(until: float) -> None:
    """While each goal is minimised alone, and between the ends."""

    def stop(fraction: float) -> None:
        if fraction > until:
            raise KeyboardInterrupt

    crank = lw.loads(CRANK)
    goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    front = lw.synthesis.improve(crank, goals, vary=["O2 A"], front=5, starts=1, progress=stop)
    assert front
    assert not _dominated(_values(front))
    for design in front:
        assert design.sound
        assert design.message.startswith("interrupted: the best so far")


@pytest.mark.extended
def test_three_goals_have_a_front_that_spreads() -> None:
    crank = lw.loads(CRANK)
    goals = [
        {"of": "stroke(d)", "target": 70},
        {"of": "max(d)", "target": 60},
        {"of": "max(A.y)", "target": 15},
    ]
    bounds = {"O2 A": (10, 50), "B A": (80, 200)}
    front = lw.synthesis.improve(
        crank, goals, vary=["O2 A", "B A"], bounds=bounds, front=6, starts=1
    )
    values = _values(front)
    assert len(front) == 6
    assert not _dominated(values)
    # each goal alone; the slider is nearest with the shortest crank and rod, which are in line
    nearest = math.sqrt((10.0 + 80.0) ** 2 - 20.0**2) - 60.0
    assert values.min(axis=0) == pytest.approx([0.0, nearest, 0.0], abs=1e-4)


@pytest.mark.extended
def test_points_and_a_goal_have_a_front() -> None:
    bar = lw.loads(lw.example_text("four-bar").replace("step = 1\n", "step = 30\n"))
    wanted = bar.with_dimensions({"O2 A": 38.0, "A B": 124.0})
    inputs = [0.0, 60.0, 120.0, 200.0, 290.0]
    points = {"point": "B", "points": [wanted.solve(at=a).points["B"] for a in inputs]}
    stroke = {"of": "stroke(rocker)", "target": 30}
    front = lw.synthesis.improve(
        bar,
        [{**points, "inputs": inputs}, stroke],
        vary=["O2 A", "A B"],
        bounds={"O2 A": (20, 45)},
        front=4,
        starts=1,
    )
    assert len(front) == 4
    assert front[0].goals["B"] < 1e-4 < front[-1].goals["B"]
    assert not _dominated(_values(front))
    assert front[-1].rms == pytest.approx(front[-1].goals["B"], rel=1e-6)


def test_dominated_designs_are_left_out_and_extremes_are_kept() -> None:
    rng = np.random.default_rng(3)
    values = rng.uniform(size=(300, 3))
    values[7], values[8] = values[6], np.inf
    front = undominated(values)
    assert not _dominated(values[front])
    for k in set(range(300)) - set(front.tolist()) - {8}:
        # a millionth of a span counts as equal
        assert (values[front] <= values[k] + 1e-6).all(axis=1).any()
    assert len({6, 7} & set(front.tolist())) < 2
    few = front[spread(values[front], 5)]
    assert len(few) == 5
    assert values[few].min(axis=0) == pytest.approx(values[front].min(axis=0), abs=0.0)
    assert len(undominated(np.full((2, 2), np.inf))) == 0


def test_fronts_without_a_meaning_are_refused() -> None:
    bar = lw.example("four-bar")
    rocker = {"of": "stroke(rocker)", "target": 60}
    for goals, given, message in (
        ([rocker], {"front": 4}, "between two goals or more, and 1 is given"),
        ([rocker, {"of": "rocker", "least": 3}], {"front": 4}, "bounds only limit it"),
        ([rocker, {**rocker, "weight": 2.0}], {"front": 4}, "has no effect on a front"),
        ([rocker, rocker], {"front": 1}, "a whole number of 2 to 1000, got 1"),
        ([rocker, rocker], {"front": 1.5}, "a whole number of 2 to 1000, got 1.5"),
        ([rocker, rocker], {"front": 10**6}, "a whole number of 2 to 1000, got 1000000"),
        ([rocker], {"starts": "2"}, "a whole number of 1 to 1000000, got '2'"),
        ([rocker], {"starts": 0}, "a whole number of 1 to 1000000, got 0"),
        ([rocker], {"seed": -1}, "a whole number of 0 to 2147483648, got -1"),
        ([rocker], {"spread": "a"}, "at least 0 and below 1, got 'a'"),
        ([rocker], {"bounds": {"O2 A": 3}}, "must be two numbers, got 3"),
        ([rocker, rocker], {"front": 4, "fit": "minimax"}, "does not add up its goals"),
    ):
        own: dict[str, Any] = given
        with pytest.raises(MechanismError, match=message):
            lw.synthesis.improve(bar, goals, **own)


def test_sound_designs_that_equal_later_ones_are_not_among_the_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(front_designs, "alike", lambda values, *_: np.arange(len(values)))
    goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    front = lw.synthesis.improve(lw.loads(CRANK), goals, vary=["O2 A"], starts=1, front=5)
    assert [design.sound for design in front] == [True]


def test_a_front_that_no_start_leads_to_is_empty() -> None:
    goals = [{"of": "stroke(d)", "target": 90}, {"of": "max(d)", "target": 60}]
    given: dict[str, Any] = {"vary": ["O2 A", "B A"], "starts": 2, "front": 4}
    never = {"O2 A": (100, 120), "B A": (10, 20)}
    assert lw.synthesis.improve(lw.loads(CRANK), goals, bounds=never, **given) == ()
    found = lw.Task.improve("slider-crank", goals=goals, bounds=never, **given).solve()
    assert not found.designs


@pytest.mark.parametrize("target", [math.inf, -math.inf, math.nan, 1e200])
@pytest.mark.parametrize("front", [0, 4])
def test_targets_beyond_floating_point_are_refused(target: float, front: int) -> None:
    goals = [{"of": "stroke(d)", "target": target}, {"of": "max(d)", "target": 60}]
    with pytest.raises(MechanismError, match=r"goals\[1\].target  must be within ±1e\+12"):
        lw.synthesis.improve(lw.loads(CRANK), goals, vary=["O2 A"], starts=1, front=front)
