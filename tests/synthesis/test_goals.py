"""Goals of an improvement: numbers of motions, formulas, bounds, the largest miss, free timing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.varied_numbers import number_named
from linkwork.synthesis.improvement.goals import goal_of
from linkwork.synthesis.improvement.lanes import DesignWriter, SolvedLanes
from linkwork.synthesis.improvement.settings import Goal


def _values(
    mechanism: lw.Mechanism, of: str, by: tuple[str, ...], at: tuple[float, ...] = ()
) -> tuple[Array, Array]:
    """A goal's quantity and its derivatives, of the second of two lanes."""
    model = mechanism.model
    motion = mechanism.sweep(certify=False)
    numbers = [number_named(mechanism.description, name) for name in by]
    x = np.array([q.of(mechanism.description) for q in numbers])
    scale = float(model.input_scale[0])
    table = motion.inputs[next(iter(motion.inputs))] * scale
    goal = goal_of(model, Goal(of=of, target=0.0, at=at), table, motion.found, scale)
    q = np.stack([mechanism.solve(at=value).q for value in at]) if at else motion.q
    writer = DesignWriter(model, numbers)
    lanes = SolvedLanes(writer, x, q, goal.at, 2)
    found = lanes.at(writer.written(np.array([x, x])), np.arange(2))
    value, by_x = goal.values(found)
    return value[1], by_x[1]


@pytest.mark.parametrize(
    ("example", "of", "by"),
    [
        ("slider-crank", "time_ratio(d)", ("O2 A", "B A", "d.offset")),
        ("slider-crank", "dwell(d, 2)", ("O2 A", "B A", "d.offset")),
        ("slider-crank", "max(d.d1)", ("O2 A", "B A")),
        ("four-bar", "path_length(B)", ("O2 A", "A B")),
        ("four-bar", "min(B.transmission)", ("O2 A", "A B")),
    ],
)
def test_a_number_of_the_motion_has_its_sensitivity_in_every_lane(
    example: str, of: str, by: tuple[str, ...]
) -> None:
    mechanism = lw.example(example)
    value, by_x = _values(mechanism, of, by)
    # lanes take polynomials between the rows, a motion further rows; B turns back
    rel = {"path_length(B)": 1e-6, "time_ratio(d)": 1e-9, "dwell(d, 2)": 1e-8}.get(of, 1e-11)
    assert value[0] == pytest.approx(mechanism.sweep(certify=False).value(of), rel=rel)
    known = lw.design.gradient(mechanism, of, by=by)
    assert by_x[0] == pytest.approx([known[name] for name in by], rel=max(1000 * rel, 1e-7))


@pytest.mark.parametrize("of", ["rocker.d2", "B.velocity", "B.x.acceleration"])
def test_a_rate_of_rows_has_its_sensitivity_in_every_lane(of: str) -> None:
    bar, at, by = lw.example("four-bar"), (30.0, 77.0), ("O2 A", "A B")
    value, by_x = _values(bar, of, by, at)
    assert value == pytest.approx([bar.solve(at=a)[of] for a in at], rel=1e-12)
    known = [lw.design.gradient(bar, of, by=by, at=a) for a in at]
    assert by_x == pytest.approx(np.array([[rates[n] for n in by] for rates in known]), rel=1e-9)


def test_a_formula_of_numbers_follows_the_quotient_rule() -> None:
    crank, by = lw.example("slider-crank"), ("O2 A", "B A")
    value, by_x = _values(crank, "2 * stroke(d) / max(A.x)", by)
    parts = [_values(crank, of, by) for of in ("stroke(d)", "max(A.x)")]
    (s, ds), (m, dm) = ((v[0], d[0]) for v, d in parts)
    assert value[0] == pytest.approx(2.0 * s / m, rel=1e-14)
    assert by_x[0] == pytest.approx(2.0 * (ds * m - s * dm) / m**2, rel=1e-12)


def test_the_sensitivity_of_the_extreme_of_a_rate_is_that_of_the_rate() -> None:
    crank = lw.example("slider-crank")
    longer = crank.with_dimensions({"O2 A": 40.0 + 1e-5})
    rise = longer.sweep().value("max(d.d1)") - crank.sweep().value("max(d.d1)")
    # a difference of 1e-5 is known to its square, relative
    assert lw.design.gradient(crank, "max(d.d1)", by=["O2 A"])["O2 A"] == pytest.approx(
        rise / 1e-5, rel=1e-3
    )


def test_a_dwell_and_a_time_ratio_are_met() -> None:
    crank = lw.example("slider-crank")
    goals = [{"of": "time_ratio(d)", "target": 1.2}, {"of": "stroke(d)", "target": 70.0}]
    best = lw.synthesis.improve(crank, goals, vary=["O2 A", "d.offset"], starts=1)[0]
    motion = lw.Mechanism(best.description).sweep()
    assert best.sound
    assert motion.value("time_ratio(d)") == pytest.approx(1.2, abs=1e-9)
    assert motion.value("stroke(d)") == pytest.approx(70.0, abs=1e-9)


def test_a_bound_holds_against_a_goal_that_pulls_across_it() -> None:
    crank = lw.example("slider-crank")
    pull = {"of": "stroke(d)", "target": 120.0}
    bound = {"of": "max(d)", "most": 150.0}
    best = lw.synthesis.improve(crank, [pull, bound], vary=["O2 A"], starts=1)[0]
    motion = lw.Mechanism(best.description).sweep()
    assert motion.value("max(d)") <= 150.0
    free = lw.synthesis.improve(crank, pull, vary=["O2 A"], starts=1)[0]
    assert lw.Mechanism(free.description).sweep().value("max(d)") > 150.0


def test_the_largest_miss_is_smaller_than_that_of_least_squares() -> None:
    bar = lw.example("four-bar")
    at, values = [0, 40, 80, 120, 160], [60, 57, 68, 80, 92]
    goal = {"of": "rocker", "at": at, "values": values}
    by = ["A B", "O4 B"]
    squares = lw.synthesis.improve(bar, goal, vary=by, starts=1)[0]
    level = lw.synthesis.improve(bar, goal, vary=by, starts=1, fit="minimax")[0]
    assert level.largest < 0.99 * squares.largest
    assert level.total > squares.total
    # two numbers level three misses, of alternating sign (Chebyshev)
    motion = lw.Mechanism(level.description)
    misses = [motion.solve(at=a)["rocker"] - v for a, v in zip(at, values, strict=True)]
    ranked = np.sort(np.abs(misses))[::-1]
    assert ranked[2] == pytest.approx(ranked[0], rel=0.01)


@pytest.mark.parametrize("order", ["as given", "any"])
def test_points_without_inputs_are_met_on_one_branch(order: str) -> None:
    bar = lw.example("four-bar")
    wanted = bar.with_dimensions({"O2 A": 38.0, "A B": 124.0})
    points = [wanted.solve(at=a).points["B"] for a in (20.0, 75.0, 130.0, 200.0, 290.0)]
    goal = {"point": "B", "points": points, "order": order}
    best = lw.synthesis.improve(
        bar, goal, vary=["O2 A", "A B"], starts=1 if order == "as given" else 6
    )[0]
    assert best.sound
    assert best.rms < 1e-8
    assert max(best.misses) < 1e-8
    if order == "as given":
        steps = np.diff(best.inputs)
        assert (steps > 0).all() or (steps < 0).all()


def _cam(of: str, **goal: float) -> lw.Task:
    wanted = {"input": "turns fully"}
    return lw.Task.improve("eccentric-cam", starts=1, goals=[{"of": of, **goal}], wanted=wanted)


def test_goals_of_a_cam_without_a_value_or_without_effect() -> None:
    """The force ratio is infinite at both ends of the stroke; the quotient is -1 of any disc."""
    assert not _cam("max(s.mechanical_advantage)", target=3.0).solve().designs
    quotient = "max(disc_dx.d2)/min(disc_dx.d2)"
    with pytest.raises(lw.MechanismError, match=r"improve.goals\[1\].of .* no number that varies"):
        _cam(quotient, target=3.0).solve()
    assert len(_cam(quotient, most=3.0).solve().designs) == 1


def test_goals_of_a_front_that_no_number_changes_are_refused() -> None:
    goals = [{"of": "max(crank)", "target": 3.0}, {"of": "stroke(d)", "target": 70.0}]
    with pytest.raises(lw.MechanismError, match=r'goals\[1\].of  "max\(crank\)" changes with no'):
        lw.Task.improve("slider-crank", goals=goals, vary=["O2 A"], starts=2, front=3).solve()


def test_the_larger_of_two_is_no_number_of_the_motion() -> None:
    """The slider is never farther than 1000."""
    goal: dict[str, Any] = {"of": "max(d - 1000, min(d, 0))", "target": 5.0, "at": [0.0]}
    with pytest.raises(lw.MechanismError, match="no number that varies"):
        lw.Task.improve("slider-crank", goals=[goal], starts=1).solve()
    # a penalty that is met everywhere has no derivative either
    goals = [{**goal, "target": 0.0}, {"of": "stroke(d)", "target": 70.0}]
    (best,) = lw.Task.improve("slider-crank", goals=goals, vary=["O2 A"], starts=1).solve().designs
    assert best.error < 1e-9
    goal = {"of": "max(d, 3)", "target": 160.0, "at": [0.0]}
    (best,) = lw.Task.improve("slider-crank", goals=[goal], vary=["O2 A"], starts=1).solve().designs
    assert lw.Mechanism(best.linkage).solve(at=0.0)["d"] == pytest.approx(160.0)
    with pytest.raises(InputError, match=r'^"max" of one formula: .* takes a name, max\(d\), in'):
        lw.synthesis.improve(lw.example("slider-crank"), {"of": "max(abs(d))", "target": 3.0})


def test_what_cannot_be_a_goal_says_why() -> None:
    bar = lw.example("four-bar")
    for of, message in (
        ("stroke(rocker) - rocker", "mixes numbers of the motion"),
        ("limit.upper", "ask for a wider table"),
        ("residual", "measures how a position was found"),
        ("2 * 3", "has no quantity"),
        ("B.x.jerk", "two derivatives"),
        ("rokcer", "rocker"),
        ("max(rocker - 20)", '^"max" of one formula'),
        ("1 + min(-rocker)", '^"min" of one formula'),
    ):
        with pytest.raises(InputError, match=message):
            lw.synthesis.improve(bar, {"of": of, "target": 1.0}, starts=1)


def test_numbers_on_which_a_goal_hardly_depends_do_not_hold_the_others_back() -> None:
    """A stroke of 70 needs a shorter crank; rod and offset change it little, or not at all."""
    goal = {"of": "stroke(d)", "target": 70.0}
    found = lw.synthesis.improve(lw.example("slider-crank"), goal, starts=6)
    assert [design.total for design in found] == pytest.approx([0.0] * 6, abs=1e-12)


@pytest.mark.parametrize("further", [{}, {"front": 4}])
def test_a_goal_that_numbers_do_not_change_at_the_start_alone_is_none_without_effect(
    further: dict[str, Any],
) -> None:
    """The stroke of a centric crank has no derivative by the offset."""
    text = lw.example_text("slider-crank").replace("S  = [0, -20]\n", "").replace("-20]", "0]")
    text = text.replace('"O2", "S", "T"', '"O2", "T"').replace('["S", "T"]', '["O2", "T"]')
    goals = [{"of": "stroke(d)", "target": 84.0}, {"of": "max(d)", "target": 150.0}]
    assert lw.synthesis.improve(
        lw.loads(text), goals, vary=["B A", "d.offset"], starts=1, **further
    )


def test_rows_whole_turns_apart_differ_in_geared_mechanisms() -> None:
    goal = {"of": "max(B.x)", "target": 100.0}
    assert lw.synthesis.improve(lw.example("belt-drive"), goal, vary=["A B", "O4 B"], starts=2)


@pytest.mark.parametrize(
    "goal",
    [
        {"of": "stroke(rocker)", "target": 170.0},  # nearly a change point: extremes are sharp
        {"of": "path_length(B)", "target": 300.0},
        {"of": "stroke(rocker) / max(coupler)", "target": 1.6},
    ],
)
def test_what_a_design_says_of_a_number_is_what_its_motion_has(goal: dict[str, Any]) -> None:
    bar = lw.example("four-bar")
    of = str(goal["of"])
    for design in lw.synthesis.improve(bar, goal, starts=2):
        motion = lw.Mechanism(design.description).sweep()
        parts = [motion.value(name) for name in of.split(" / ")]
        miss = abs(parts[0] / parts[1] if len(parts) == 2 else parts[0]) - goal["target"]
        # certified positions are rounded once more
        assert design.goals[of] == pytest.approx(abs(miss), abs=1e-11 * goal["target"])
        assert abs(miss) <= 1e-10 * goal["target"] or not design.sound


def test_a_goal_that_is_missed_says_by_how_much_though_rows_are_far_apart() -> None:
    crank = lw.example("slider-crank").changed(
        inputs=lw.Input(link="crank", from_=0, to=360, step=30)
    )
    goals = [{"of": "stroke(d)", "target": 90.0}, {"of": "max(d)", "target": 130.0}]
    for design in lw.synthesis.improve(crank, goals, vary=["O2 A"], starts=2):
        motion = lw.Mechanism(design.description).sweep(from_=0, to=360, step=1)
        misses = {name: abs(motion.value(name) - w) for name, w in
                  (("stroke(d)", 90.0), ("max(d)", 130.0))}  # fmt: skip
        assert max(misses.values()) > 1.0
        assert dict(design.goals) == pytest.approx(misses, abs=1e-9)
