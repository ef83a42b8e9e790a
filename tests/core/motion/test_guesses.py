"""Mechanisms that cannot close, and Newton step by step."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, strategies as st

import linkwork as lw
from linkwork.circuits.failure.remedies import nearest_assembly
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion.iterating import guessed_points, pulled_guess
from tests.described import described_as


def four_bar(**lengths: float) -> lw.Mechanism:
    """A crank-rocker of crank a, rod b, rocker c and ground 100."""
    sizes = {"a": 40.0, "b": 120.0, "c": 80.0} | lengths
    return lw.linkage(
        name="four-bar",
        points={"O2": (0, 0), "A": (35, 20), "B": (146, 66), "O4": (100, 0)},
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "rod": ("A", "B"),
            "rocker": ("O4", "B"),
        },
        lengths={"O2 A": sizes["a"], "A B": sizes["b"], "O4 B": sizes["c"]},
        inputs=lw.Input(link="crank"),
    )


# As near to closing as it gets


@given(st.floats(1.0, 9.0))
def test_the_gap_of_a_dyad_is_what_its_two_bars_leave_between_circles(rocker: float) -> None:
    open_ = nearest_assembly(four_bar(c=rocker).model, 60)
    crank = 40 * complex(math.cos(math.pi / 3), math.sin(math.pi / 3))
    wanted = (120 - rocker) - abs(100 - crank)
    assert wanted > 0
    assert open_.gap == pytest.approx(wanted, rel=1e-6)
    (vector,) = open_.gaps.values()
    assert math.hypot(*vector) == pytest.approx(open_.gap, rel=1e-12)
    assert open_.points["A"] == pytest.approx((crank.real, crank.imag))
    (end,) = open_.apart
    assert math.dist(end.end, end.joint) == pytest.approx(open_.gap, rel=1e-9)
    inside = {"rod": ("A", 120.0), "rocker": ("O4", rocker)}
    start, length = inside[end.link]
    assert math.dist(open_.points[start], end.end) == pytest.approx(length, rel=1e-9)


@pytest.mark.parametrize("name", ["four-bar", "rapier-drive", "jansen-leg", "whitworth"])
def test_what_closes_has_no_gap(name: str) -> None:
    design = lw.example(name)
    nearest, position = nearest_assembly(design.model), design.solve()
    assert nearest.gap < 1e-9
    assert nearest.apart == ()
    for point, place in position.points.items():
        assert nearest.points[point] == pytest.approx(place, abs=1e-6)


def test_later_loops_are_closed_though_an_earlier_one_is_open() -> None:
    leg = lw.example("jansen-leg")
    broken = leg.changed(lengths={**described_as(Linkage, leg).lengths, "A C": 5.0})
    nearest = nearest_assembly(broken.model)
    gaps = {loop: math.hypot(*vector) for loop, vector in nearest.gaps.items()}
    assert gaps["O A B P"] < 1e-9
    assert gaps["O A C P"] > 1.0
    assert nearest.gap == pytest.approx(math.hypot(*gaps.values()))


# Step by step


def test_the_iterates_are_those_of_solve_with_its_steps() -> None:
    design = lw.example("rapier-drive")
    shown = design.iterates()
    trails = design.solve(from_guess=True, with_steps=True).steps
    steps = [step for trail in trails for step in trail.steps]
    assert [each.k for each in shown.iterates] == [step.k for step in steps]
    for each, step in zip(shown.iterates, steps, strict=True):
        assert each.unknowns == step.unknowns
        assert each.norm == pytest.approx(step.residual, rel=1e-12)
        assert each.step == step.step


def test_jacobians_are_slopes_of_the_residuals() -> None:
    design = four_bar()
    guess = {"rod": 20.0, "rocker": 100.0}
    at = 60.0
    first = design.iterates(guess, at).iterates[0]
    h = 1e-6
    for column, name in enumerate(guess):
        for row in range(2):
            ends = [
                design.iterates(guess | {name: guess[name] + math.degrees(s * h)}, at)
                .iterates[0]
                .residuals[row]
                for s in (1.0, -1.0)
            ]
            slope = (ends[0] - ends[1]) / (2 * h)
            assert first.jacobian[row][column] == pytest.approx(slope, abs=1e-6)


def test_points_of_an_iterate_follow_its_unknowns() -> None:
    each = four_bar().iterates({"rod": 90.0, "rocker": 45.0}, 0.0).iterates[0]
    assert each.points["A"] == pytest.approx((40, 0))
    ends = ((40, 120), (100 + 80 / math.sqrt(2), 80 / math.sqrt(2)))  # by the rod, by the rocker
    assert any(each.points["B"] == pytest.approx(end) for end in ends)


def test_a_guess_needs_names_and_numbers() -> None:
    with pytest.raises(lw.UnknownNameError) as caught:
        four_bar().iterates({"coupler": 1.0})
    assert str(caught.value) == '"coupler" is not an unknown of four-bar (unknowns: rod, rocker)'
    with pytest.raises(lw.InputError, match="the guess of rod must be a finite number, got nan"):
        four_bar().iterates({"rod": math.nan})


# The guess, dragged


@pytest.mark.parametrize("name", ["four-bar", "jansen-leg", "rapier-drive", "excavator"])
def test_one_unknown_follows_a_dragged_point(name: str) -> None:
    design = lw.example(name)
    position = design.solve()
    still = dict(position.unknowns)
    moved = []
    for point, (x, y) in position.points.items():
        before = pulled_guess(design.model, point, (x, y), still)
        assert before == pytest.approx(still, abs=1e-9)
        guess = pulled_guess(design.model, point, (x + 3.0, y - 2.0), still)
        changed = [unknown for unknown in guess if abs(guess[unknown] - still[unknown]) > 1e-9]
        assert len(changed) <= 1
        moved += changed and [point]
        for unknown in changed:  # no other value brings the point nearer
            far = [
                math.dist(at.points[point], (x + 3.0, y - 2.0))
                for by in (0.0, -0.01, 0.01)
                for at in design.iterates(still | {unknown: guess[unknown] + by}).iterates[:1]
            ]
            assert far[0] == min(far)
    assert set(moved) == set(guessed_points(design.model))


def test_a_sliding_point_is_dragged_along_its_line() -> None:
    design = lw.example("crank-slider")
    (x, y) = design.solve().points["B"]
    still = dict(design.solve().unknowns)
    guess = pulled_guess(design.model, "B", (x + 7.0, y + 50.0), still)
    assert guess == pytest.approx({**still, "d": still["d"] + 7.0})


def test_what_cannot_be_dragged_is_said() -> None:
    design = lw.example("four-bar")
    still = dict(design.solve().unknowns)
    assert pulled_guess(design.model, "O2", (5.0, 5.0), still) == pytest.approx(still)
    with pytest.raises(lw.UnknownNameError, match='there is no point "Z"'):
        pulled_guess(design.model, "Z", (0.0, 0.0))
    with pytest.raises(lw.InputError, match="the coordinates of B must be two finite numbers"):
        pulled_guess(design.model, "B", (math.nan, 0.0))
