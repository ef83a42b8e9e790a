"""Function tasks with Watt-II six-bars: placed, judged, refused with reasons, written."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.homotopy.monodromy import Member
from linkwork.circuits.homotopy.parameter_roots import ParameterRoots
from linkwork.synthesis import six_bars as watt_six_bars
from linkwork.synthesis.loops.driven_loop import Range
from linkwork.synthesis.loops.limits import Drive
from linkwork.synthesis.six_bars import WattSixBars
from linkwork.synthesis.solvers.solving import wishes_of
from linkwork.synthesis.solvers.watt import (
    WattGroup,
    _completeness,
    _nine_pairs,
    driven_range,
    solved_group,
    watt_design,
)
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.function_goal import FunctionGoal
from tests.synthesis.six_bars.six_bars import ARMS, chebyshev, member_of, turned

INPUTS = 90.0 * chebyshev()


@pytest.fixture
def one_path(monkeypatch: pytest.MonkeyPatch) -> Member:
    """A start set of one path, which leads to a sound six-bar for the logarithm."""
    member = member_of(ARMS, np.radians(INPUTS))
    monkeypatch.setattr(watt_six_bars, "watt_member", lambda: member)
    return member


def group_of(task: lw.Task) -> WattGroup:
    return solved_group(task.described, None)[0]


def logarithm(**tables: Any) -> lw.Task:
    return lw.Task.function(
        "log10(x)", x=(1, 10), input=(0, 90), output=(0, 90), mechanism="watt-ii", **tables
    )


@pytest.mark.usefixtures("one_path")
def test_a_design_follows_the_function_at_nine_inputs_and_nearly_between_them(
    tmp_path: Path,
) -> None:
    found = logarithm().solve()
    assert (found.real, found.proved, found.sound) == (1, 1, 1)
    (design,) = found.delivered
    assert design.mechanism == "watt-ii"
    mechanism = found.defect_free[0]
    motion = mechanism.sweep()
    assert motion.certified.all()
    assert list(motion.inputs["crank"][[0, -1]]) == [0.0, 90.0]
    for value in INPUTS:
        at = mechanism.solve(at=value)
        assert at["rocker"] == pytest.approx(90.0 * np.log10(1.0 + value / 10.0), abs=1e-9)
    # no four-bar comes near to this; the claim of the design is that of its own file
    assert 0.01 < design.error < 0.07
    (file,) = found.save(tmp_path / "designs")
    assert np.abs(lw.load(file).sweep()["structural_error"]).max() == pytest.approx(design.error)
    assert found.table()["D.x"][0] == pytest.approx(design.points["D"].real)


@pytest.mark.usefixtures("one_path")
def test_wishes_hold_over_the_whole_driven_range() -> None:
    def kinds(**wanted: Any) -> list[str]:
        design = logarithm(wanted=wanted).solve().designs[0]
        return [kind.name for kind in design.kinds]

    found = logarithm(wanted={"transmission": {"least": 6}}).solve()
    assert found.message.endswith("; transmission proved on the whole motion")
    assert found.to_dict()["designs"][0]["proved_in_motion"] == ["transmission"]
    assert kinds() == []
    assert kinds(transmission={"least": 6}) == []
    assert kinds(transmission={"least": 7}) == ["TRANSMISSION"]
    assert kinds(lengths={"ratio": 20}) == ["LENGTHS"]
    assert kinds(fixed_pivots={"inside": [[-1, -1], [1.1, -1], [1.1, 1], [-1, 1]]}) == ["PIVOTS"]
    assert kinds(clear_of=[[0.5, 0.0, 0.1]]) == ["OBSTACLE"]
    with pytest.raises(lw.MechanismError, match="leaves out inputs of the function, which"):
        kinds(input={"from": 10, "to": 80})
    assert "RANGE" in kinds(input="turns fully")


@pytest.mark.usefixtures("one_path")
def test_pairs_without_start_angles_have_level_pivots_or_those_given() -> None:
    outputs = 90.0 * np.log10(1.0 + INPUTS / 10.0)
    pairs = np.stack([INPUTS, outputs], axis=1).tolist()
    level = lw.Task.function(pairs, mechanism="watt-ii").solve().designs[0]
    assert level.points["A0"] == 0
    assert level.points["B0"] == pytest.approx(1.0)
    assert level.points["C0"].imag == pytest.approx(0.0, abs=1e-12)
    # a whole turn goes the way of the pairs
    group = group_of(lw.Task.function(pairs, mechanism="watt-ii"))
    for sense in (1.0, -1.0):
        turned_group = replace(group, inputs=sense * group.inputs)
        first, last = driven_range(turned_group, 0, Wishes(range=Range(turn=True)))
        assert last - first == pytest.approx(sense * 2.0 * np.pi)
    pivots = [[10.0, 5.0], [70.0, -20.0], [90.0, 60.0]]
    task = lw.Task.function(pairs, mechanism="watt-ii", given={"fixed_pivots": pivots})
    (design,) = task.solve().delivered
    assert [design.points[name] for name in ("A0", "B0", "C0")] == pytest.approx(
        [complex(*pivot) for pivot in pivots]
    )
    mechanism = task.solve().defect_free[0]
    first = mechanism.solve(at=design.first_input)["rocker"]
    last = mechanism.solve(at=design.first_input + INPUTS[-1] - INPUTS[0])["rocker"]
    assert last - first == pytest.approx(outputs[-1] - outputs[0], abs=1e-9)


def test_a_change_of_branch_is_found_loop_by_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rocker's loop is on its other side at the last pair only."""
    inputs = np.radians(INPUTS)
    member = member_of(ARMS, inputs)
    _, _, d, c = ARMS
    outputs = turned(ARMS, inputs - inputs[0])
    # the rocker mirrored in the line from C0 to C
    turns = watt_six_bars.watt_six_bars(inputs, outputs, member=member).turns[0]
    toward = 1.0 + c * turns[-1]
    rocker = d * np.exp(1j * outputs[-1])
    mirrored = rocker.conjugate() * toward / toward.conjugate()
    outputs[-1] = np.angle(mirrored / d)
    goal = np.exp(1j * np.stack([inputs - inputs[0], outputs], axis=1)[1:]).ravel()
    other = Member(parameters=goal, x=member.x)
    monkeypatch.setattr(watt_six_bars, "watt_member", lambda: other)
    pairs = np.degrees(np.stack([inputs, outputs], axis=1)).tolist()
    found = lw.Task.function(pairs, mechanism="watt-ii").solve()
    (design,) = found.designs
    assert [defect.message for defect in design.defects] == [
        "branch of the loop B0 C D C0 changes between positions 8 and 9"
    ]
    assert np.isnan(design.transmission)
    assert not found.delivered
    assert "refused" in design.linkage.name


@pytest.mark.usefixtures("one_path")
def test_inputs_out_of_order_are_refused_unless_any_order_will_do() -> None:
    outputs = 90.0 * np.log10(1.0 + INPUTS / 10.0)
    pairs = np.stack([INPUTS, outputs], axis=1)[[0, 2, 1, *range(3, 9)]].tolist()
    with pytest.raises(lw.MechanismError, match=r"pairs\[3\]  is out of order: let inputs rise or"):
        lw.Task.function(pairs, mechanism="watt-ii")
    lw.Task.function(pairs, mechanism="watt-ii", wanted={"order": "any"})
    lw.Task.function(pairs[::-1][:6], mechanism="watt-ii")
    lw.Task.function(pairs[:5], mechanism="four-bar")


@pytest.mark.usefixtures("one_path")
@pytest.mark.parametrize("free", [True, False])
def test_the_crank_is_in_the_turn_of_the_wanted_range(free: bool) -> None:
    outputs = 90.0 * np.log10(1.0 + INPUTS / 10.0)
    pairs = np.stack([INPUTS, outputs], axis=1).tolist()
    task = lw.Task.function(pairs, mechanism="watt-ii") if free else logarithm()
    (design,) = task.solve().designs
    group, usual = group_of(task), wishes_of(task.described, Drive.A0)
    begin = np.radians(design.first_input)
    span = group.inputs[-1]
    for whole in (-2, -1, 0, 1, 2):
        turned = begin + whole * 2.0 * np.pi
        margins = ((0.0, 0.0), (-5e-10, 0.0), (1e-3, 0.1), (2.0 * np.pi - span - 0.1, 0.0))
        for below, above in margins:
            low, high = turned - below, turned + span + above
            for ends in ((low, high), (high, low)):
                wishes = replace(usual, range=Range(start=ends[0], stop=ends[1]))
                moved = watt_design(group, 0, wishes)
                assert np.radians(moved.first_input) == pytest.approx(turned)
                if below < 1.0:  # the six-bar does not move a whole turn
                    assert moved.defects == ()
        # no turn has all inputs in it
        for low, high in ((turned + 1e-3, turned + 2.0), (turned - 1e-3, turned + span - 1e-3)):
            wishes = replace(usual, range=Range(start=low, stop=high))
            told = [defect.message for defect in watt_design(group, 0, wishes).defects]
            assert re.search("position . is passed at .*, outside the driven range from", told[0])


@pytest.mark.usefixtures("one_path")
def test_a_range_in_another_turn_of_the_crank_changes_no_design() -> None:
    def error(begin: float) -> float:
        wanted = {"input": {"from": begin - 1.0, "to": begin + 91.0}}
        (design,) = logarithm(wanted=wanted).solve().delivered
        assert design.first_input == pytest.approx(begin + INPUTS[0])
        return design.error

    assert [error(360.0), error(-720.0)] == pytest.approx([error(0.0)] * 2)


@pytest.mark.usefixtures("one_path")
@pytest.mark.parametrize(
    ("begin", "wanted"), [(9.1, {}), (0.0, {"input": {"from": -361.0, "to": -269.0}})]
)
def test_the_error_is_that_of_the_range_in_which_the_function_is_defined(
    begin: float, wanted: dict[str, Any]
) -> None:
    (plain,) = logarithm().solve().delivered
    # no numbers below 0, the end of the range, which the first row of a file is to rounding
    task = lw.Task.function(
        "log10(1 + 9*x) + 0*sqrt(x)", x=(0, 1), input=(begin, begin + 90.0), output=(0, 90),
        mechanism="watt-ii", wanted=wanted,
    )  # fmt: skip
    (design,) = task.solve().delivered
    assert design.error == pytest.approx(plain.error)
    assert design.score > 0.75


def test_structural_errors_are_those_at_angles_in_the_range_in_whatever_turn() -> None:
    goal = FunctionGoal(of="sqrt(0.7 - x)", x=(0.1, 0.7), input=(10.0, 70.0), output=(0.0, 90.0))
    inputs = np.array([9.0, 10.0 - 1e-12, 40.0, 70.0 + 1e-12, 71.0])
    half = 90.0 * (1.0 - np.sqrt(0.5))
    outputs = np.array([5.0, 1.0, half - 358.0, 93.0, 5.0])
    for whole in (-720.0, 0.0, 360.0):
        wrong = goal.errors(inputs + whole, outputs, 360.0)
        assert wrong == pytest.approx([1.0, 2.0, 3.0])
    # of a whole turn or more every angle belongs to the turn of the most
    goal = FunctionGoal(of="x", x=(0, 1), input=(0, 360), output=(0, 90))
    inputs = np.linspace(0.0, 360.0, 5)
    assert goal.errors(inputs + 360.0, inputs / 4.0, 360.0) == pytest.approx([0.0] * 5)


def _solved(regular: int, singular: int, proved: list[bool]) -> WattSixBars:
    """What is found by four paths, of which no end is shown."""
    none = np.zeros((0, 8), dtype=complex)
    roots = ParameterRoots(
        x=np.zeros((regular, 8), dtype=complex), singular=np.zeros((singular, 8), dtype=complex),
        paths=4, at_infinity=0, lost=0, by_mirror=0, by_detour=0, closed=True,
    )  # fmt: skip
    return WattSixBars(
        arms=none, turns=none, inputs=INPUTS, outputs=INPUTS, proved=np.array(proved),
        error=np.zeros(len(proved)), roots=roots,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("found", "told"),
    [
        ((4, 0, [True]), "complete with probability one: .* [(]4 of 4 solutions found[)]$"),
        ((4, 0, [True, False]), "not proved: 4 of 4 solutions found, 1 of the real ones without"),
        ((3, 0, [True]), "not proved: 3 of 4 solutions found, other paths met or were lost$"),
        ((3, 1, [True]), "not proved: 3 of 4 solutions found, other paths met or were lost$"),
    ],
)
def test_the_count_of_solutions_says_what_is_missing(found: Any, told: str) -> None:
    grade, message = _completeness(_solved(*found), 9)
    assert re.search(told, message)
    assert grade.complete == ("complete" in message)


def test_missing_pairs_lie_between_those_given() -> None:
    given = np.array([[0.0, 10.0, 20.0, 30.0, 50.0, 60.0], [0.0, 1.0, 4.0, 9.0, 25.0, 36.0]])
    every, wanted = _nine_pairs(given)
    assert every.shape == (2, 9)
    assert every[:, wanted] == pytest.approx(given)
    assert (np.diff(every[0]) > 0).all()
    nine = np.stack([np.arange(9.0), np.arange(9.0) ** 2])
    assert (_nine_pairs(nine)[0] == nine).all()


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"positions": 5}, "5 given: give 6 or more"),
        ({"fit": "minimax"}, "has no effect on watt-ii"),
        ({"mechanism": ["watt-ii", "four-bar"]}, "watt-ii meets more pairs; write a task for each"),
        ({"given": {"fixed_pivots": [[0, 0], [1, 0]]}}, "must be three pivots, A0, B0 and C0"),
        ({"given": {"fixed_pivots": [[0, 0], [0, 0], [1, 0]]}}, "of which neighbours differ"),
        ({"given": {"fixed_pivots": [[0, 0], [1, 0], [2, 0]]}}, "leave the start angles no choice"),
        ({"given": {"moving_pivots": [[0, 0]]}}, "belongs to poses without timing"),
        ({"given": {"lengths": {"A B": 2}}}, "belongs to points"),
    ],
)  # fmt: skip
def test_tasks_that_a_six_bar_cannot_do_are_refused(tables: dict[str, Any], message: str) -> None:
    with pytest.raises(lw.MechanismError, match=message):
        lw.Task.function(
            "log10(x)", x=(1, 10), input=(0, 90), output=(0, 90),
            **{"mechanism": "watt-ii", **tables},
        )  # fmt: skip


def test_pairs_are_counted_and_must_differ() -> None:
    pairs = [[10.0 * k, float(k * k)] for k in range(10)]
    with pytest.raises(
        lw.MechanismError, match="10 pairs leave no watt-ii with free start angles: keep 9"
    ):
        lw.Task.function(pairs, mechanism="watt-ii")
    with pytest.raises(lw.MechanismError, match="5 given: give 6 or more"):
        lw.Task.function(pairs[:5], mechanism="watt-ii")
    pairs[8] = [360.0, 0.0]
    with pytest.raises(lw.MechanismError, match="is pair 1 after whole turns"):
        lw.Task.function(pairs[:9], mechanism="watt-ii").solve()
    pairs = [[10.0 * k, 5.0] for k in range(9)]
    with pytest.raises(lw.MechanismError, match=r"pairs  all have the output 5, so that the out"):
        lw.Task.function(pairs, mechanism="watt-ii")
    with pytest.raises(lw.MechanismError, match=r'for task = "path", got .watt-ii.'):
        lw.Task.path([(0, 0), (1, 1)], mechanism="watt-ii")


@pytest.mark.usefixtures("one_path")
def test_the_score_counts_an_angle_in_radians_like_that_of_a_four_bar() -> None:
    task = logarithm(rank={"by": {"error": 1}})
    (design,) = task.solve().delivered
    size = 1.0  # of a function
    assert design.score == pytest.approx(1.0 / (1.0 + np.radians(design.error) / size))
    assert design.error > 0.01
