"""Where there is no position, the reason is told: which loop, which gap, which limit."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.results.failure import LimitKind


def four_bar(
    crank: float, coupler: float, rocker: float, ground: float, at: float = 90, side: int = 1
) -> lw.Mechanism:
    angle = math.radians(at)
    return lw.linkage(
        name="four-bar",
        points={
            "O2": (0, 0),
            "A": (crank * math.cos(angle), crank * math.sin(angle)),
            "B": (ground + 0.3 * rocker, side * 0.95 * rocker),
            "O4": (ground, 0),
        },
        links={
            "ground": ["O2", "O4"],
            "crank": ["O2", "A"],
            "coupler": ["A", "B"],
            "rocker": ["O4", "B"],
        },
        lengths={"O2 A": crank, "A B": coupler, "O4 B": rocker, "O2 O4": ground},
        inputs=lw.Input(link="crank"),
    )


def test_links_too_short_name_the_loop_and_the_exact_gap() -> None:
    # A is sqrt(40² + 100²) from O4; coupler and rocker reach 30 + 20
    gap = math.hypot(40, 100) - 50
    position = four_bar(40, 30, 20, 100).solve()
    assert position.status is lw.Status.CANNOT_CLOSE
    assert position.message == (
        f'loop "O2 A B O4" cannot be closed at crank = 90°: near the guess a gap of at '
        f"least {gap:.6g} mm remains; "
        f'the loops just close with "A B" = {30 + gap:.6g} mm ({gap:.6g} longer) '
        f'or "O4 B" = {20 + gap:.6g} mm ({gap:.6g} longer) or "O2 O4" = 30 mm (70 shorter); '
        "no input value was found at which the mechanism can be assembled; "
        "no configuration exists there"
    )
    assert math.isnan(position["coupler"])


def test_a_sweep_without_a_start_keeps_all_its_rows() -> None:
    motion = four_bar(40, 30, 20, 100).sweep()
    assert len(motion) == 361
    assert set(motion.status) == {lw.Status.NO_START}
    assert motion.message.startswith('loop "O2 A B O4" cannot be closed at crank = 90°')


def test_non_grashof_rows_out_of_reach_are_exactly_those_between_the_dead_points() -> None:
    motion = four_bar(2, 5, 2, 4).sweep()  # ground 4, crank 2, coupler 5, rocker 2
    lost = motion["crank"][~motion.found]
    assert len(lost) == 94
    np.testing.assert_array_equal(lost, [*range(47), *range(314, 361)])
    assert {s for s in motion.status if not s.ok} == {lw.Status.OUT_OF_REACH}
    limits = sorted(limit.input for limit in motion.limits)
    exact = math.degrees(math.acos(11 / 16))
    assert limits == pytest.approx([exact, 360 - exact], rel=1e-14)
    for limit in motion.limits:
        assert limit.kind is LimitKind.DEAD_POINT
        assert limit.located
        assert limit.bracket[0] <= limit.input <= limit.bracket[1]
        assert limit.bracket[1] - limit.bracket[0] < 1e-11
        assert (limit.loops, limit.in_line) == (("O2 A B O4",), ("coupler", "rocker"))


def test_toggle_has_its_dead_points_where_the_closed_form_has_them() -> None:
    motion = four_bar(2, 1, 2.2, 3, at=40).sweep()
    found = sorted(limit.input for limit in motion.limits)
    assert found == pytest.approx([15.563575187105, 76.70292825279], abs=1e-11)


def test_asking_beyond_a_dead_point_names_both_limits() -> None:
    position = four_bar(2, 5, 2, 4).solve(at=0)
    assert position.status is lw.Status.OUT_OF_REACH
    assert position.message == (
        f"{lw.Status.OUT_OF_REACH.value} (met at crank = 46.56746344° and -46.56746344°); "
        "nearest reachable input: crank = 46.56746344° (dead point); no configuration exists there"
    )


@pytest.mark.parametrize(("ground", "crank"), [(2.0, 1.0), (3.0, 1.0)])
@pytest.mark.parametrize("step", [0.1, 1, 10, 60])
def test_parallelogram_never_flips_at_its_change_points(
    ground: float, crank: float, step: float
) -> None:
    motion = four_bar(crank, ground, crank, ground, at=60).sweep(step=step)
    inside = motion.found
    assert inside.sum() >= 179 / step - 1
    # on the parallelogram's branch the rocker stays parallel to the crank
    gap = np.remainder(motion["rocker"][inside] - motion["crank"][inside] + 180, 360) - 180
    np.testing.assert_allclose(gap, 0, atol=1e-6)
    if step < 60:
        assert {s for s in motion.status if not s.ok} == {lw.Status.CHANGE_POINT}
    assert [limit.input for limit in motion.limits] == [0.0, 180.0]
    first, second = motion.limits
    assert {first.kind, second.kind} == {LimitKind.CHANGE_POINT}
    assert first.in_line == ("coupler", "rocker")


def test_both_tangents_at_the_change_points_of_a_parallelogram() -> None:
    low, high = four_bar(2, 4, 2, 4, at=60).sweep().limits
    # rocker rates 1 and -3 at 0 deg, 1 and -1/3 at 180 deg
    assert low.onward["rocker"] == pytest.approx(1, abs=1e-12)
    assert low.other["rocker"] == pytest.approx(-3, abs=1e-12)
    assert high.onward["rocker"] == pytest.approx(1, abs=1e-12)
    assert high.other["rocker"] == pytest.approx(-1 / 3, abs=1e-12)


def test_a_folding_linkage_has_one_change_point_and_it_is_at_180_degrees() -> None:
    motion = four_bar(1, 3, 2, 4, at=60).sweep()
    assert {limit.kind for limit in motion.limits} == {LimitKind.CHANGE_POINT}
    assert [limit.input for limit in motion.limits] == [180.0, 180.0]
    assert motion.found.all()
    assert not motion.added.any()
    np.testing.assert_array_equal(motion["crank"][np.array(motion.limit) != ""], [180.0])
    assert motion.limit[180] == "change point"


def test_throw_turns_the_status_into_an_error() -> None:
    with pytest.raises(lw.NotConvergedError, match=r'^loop "O2 A B O4" cannot be closed'):
        four_bar(40, 30, 20, 100).solve(throw=True)


def test_a_steep_path_keeps_its_branch_at_sixty_degree_steps() -> None:
    mechanism = four_bar(0.5, 1.2, 0.8, 1.0, at=30)
    coarse, fine = mechanism.sweep(step=60), mechanism.sweep(step=1)
    assert coarse.found.all()
    np.testing.assert_allclose(coarse["rocker"], fine["rocker"][::60], rtol=0, atol=1e-9)


def test_three_collinear_points_on_one_link_are_solvable() -> None:
    mechanism = lw.linkage(
        points={"O": (0, 0), "A": (20, 20), "C": (60, 45), "B": (100, 60), "Q": (110, 0)},
        links={
            "ground": ["O", "Q"],
            "crank": ["O", "A"],
            "coupler": ["A", "C", "B"],
            "rocker": ["Q", "B"],
        },
        lengths={"O A": 28, "A C": 40, "C B": 45, "A B": 85, "Q B": 70},
        inputs=lw.Input(link="crank"),
    )
    motion = mechanism.sweep()
    assert motion.found.all()
    a, b, c = (motion.trace(p) for p in ("A", "B", "C"))
    np.testing.assert_allclose(c, a + (b - a) * 40 / 85, rtol=0, atol=1e-11)


def test_inputs_that_do_not_fit_are_errors() -> None:
    mechanism = four_bar(2, 5, 2, 4)
    with pytest.raises(lw.UnknownNameError) as unknown:
        mechanism.solve(at={"rocker": 3})
    assert str(unknown.value) == '"rocker" is not an input of four-bar (inputs: crank)'
    with pytest.raises(lw.UnknownNameError) as dimension:
        mechanism.with_dimensions(a=3)
    assert str(dimension.value).startswith('"a" is not a number of four-bar that can vary (')
    with pytest.raises(lw.InputError) as nothing:
        lw.example("newton-convergence").sweep()
    assert str(nothing.value) == (
        'mechanism "Newton-Raphson, the usual case: quadratic convergence" has no input, '
        "so it does not move: solve and configurations give its positions"
    )


FIVE_BAR = {
    "points": {"O": (77, 62), "A": (-90, 52), "B": (1, 15), "C": (67, 89), "D": (57, 66)},
    "links": {
        "ground": ["O", "D"],
        "l": ["O", "A"],
        "p": ["A", "B"],
        "q": ["C", "B"],
        "r": ["D", "C"],
    },
}


def test_a_table_of_two_inputs_whose_nearest_row_is_out_of_reach_is_entered_elsewhere() -> None:
    driven = [
        lw.Input(link="l", from_=0, to=360, step=1),
        lw.Input(link="r", from_=90, to=-630, step=-2),
    ]
    mechanism = lw.linkage(**FIVE_BAR, inputs=driven)
    motion = mechanism.sweep()
    assert motion.found.sum() > 300
    for row in np.flatnonzero(motion.found)[::40]:
        b = motion.trace("B")[row]
        a, c = motion.trace("A")[row], motion.trace("C")[row]
        assert abs(b - a) == pytest.approx(abs(-90 + 52j - (1 + 15j)), rel=1e-12)
        assert abs(b - c) == pytest.approx(abs(67 + 89j - (1 + 15j)), rel=1e-12)


def test_an_input_of_one_value_is_held_there_while_the_other_moves() -> None:
    driven = [
        lw.Input(link="l", from_=170, to=200, step=1),
        lw.Input(link="r", from_=66, to=66),
    ]
    motion = lw.linkage(**FIVE_BAR, inputs=driven).sweep()
    assert len(motion) == 31
    np.testing.assert_array_equal(motion["r"], 66.0)
    assert motion.found.all()


def test_a_length_that_is_held_needs_no_step() -> None:
    held = lw.Input(cylinder="leg2", from_=15.38, to=15.38)
    moving = lw.Input(cylinder="leg1", from_=14.98, to=14.9, step=-0.02)
    third = lw.Input(cylinder="leg3", from_=12, to=12)
    motion = lw.example("three-rpr").changed(inputs=[moving, held, third]).sweep()
    np.testing.assert_array_equal(motion["leg2"], np.full(5, 15.38))
    with pytest.raises(lw.MechanismError, match=r"input\[1\]\.step.*no natural range"):
        lw.example("three-rpr").changed(
            inputs=[lw.Input(cylinder="leg1", from_=14.98, to=14.9), held, third]
        )


def test_a_dead_point_of_two_coupled_loops_is_out_of_reach_and_not_lost() -> None:
    mechanism = lw.linkage(
        points={
            "O2": (-74.06217244077864, -41.61142182588933),
            "A": (58.77238489683296, -45.76510121714952),
            "B": (-30.7291438666293, -16.61886082530208),
            "O4": (-16.045763241749626, -18.095576710188027),
            "P": (84.12247659752612, -68.80042821232817),
            "D": (-99.06764108337087, 88.65356718382176),
            "O6": (75.9956503252096, 97.38273100575913),
        },
        links={
            "ground": ["O2", "O4", "O6"],
            "l2": ["O2", "A"],
            "l3": ["A", "B", "P"],
            "l4": ["O4", "B"],
            "l5": ["P", "D"],
            "l6": ["O6", "D"],
        },
        inputs=lw.Input(link="l5"),
    )
    motion = mechanism.sweep()
    assert {limit.kind for limit in motion.limits} == {LimitKind.DEAD_POINT}
    assert {s for s in motion.status if not s.ok} == {lw.Status.OUT_OF_REACH}
    low, high = motion.limits
    inside = mechanism.sweep(from_=high.input - 1e-6, to=high.input - 5e-7, step=1e-7)
    assert inside.certified.all()
    # rate**-2 falls to zero at a dead point, linearly but for the square root of the distance
    rates = inside.unknowns["l2"].first ** -2.0
    zero = np.polynomial.Polynomial.fit(inside["l5"], rates, 1).roots()[0]
    assert zero == pytest.approx(high.input, abs=1e-8)
    assert low.input < high.input


def test_a_start_on_a_dead_point_says_so() -> None:
    mechanism = lw.linkage(
        points={"O2": (0, 0), "A": (40, 0), "B": (160, 0), "T": (300, 0)},
        links={"ground": ["O2", "T"], "crank": ["O2", "A"], "rod": ["A", "B"], "block": ["B"]},
        sliders=[
            lw.Slider(name="s", link="block", points=("B",), angle=0, on="ground", line=("O2", "T"))
        ],
        inputs=lw.Input(slider="s", from_=160, to=80, step=-5),
    )
    assert mechanism.solve().message.startswith("position found at a dead point or change point")
    motion = mechanism.sweep()
    assert set(motion.status[1:]) == {lw.Status.START_SINGULAR}


def test_names_that_do_not_exist_are_told_with_those_that_do() -> None:
    position, motion = four_bar(2, 5, 2, 4).solve(), four_bar(2, 5, 2, 4).sweep()
    message = (
        'there is no "rokker" (nearest: rocker, coupler, crank; all: linkwork quantities FILE)'
    )
    for results in (position, motion):
        with pytest.raises(lw.UnknownNameError) as caught:
            results["rokker"]
        assert str(caught.value) == message
    with pytest.raises(lw.UnknownNameError) as point:
        motion.trace("Z")
    assert str(point.value) == 'there is no point "Z" (points: O2, A, B, O4)'
