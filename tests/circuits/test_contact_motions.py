"""Turns, circuits and configurations of mechanisms with gears, belts, racks, wheels and cams."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.motion.following import turns_freely
from linkwork.core.results.failure import LimitKind
from tests.core.laws.contacts import KINDS, contact, xy

FREE = {
    **{kind: True for kind in KINDS if kind.startswith(("weld", "cam", "curve"))},
    "rolling on a line": True,
    "gear internal": False,  # the carrier makes a fraction of the sun's turns
    "gear on a moving arm": False,  # 5/3 turns
    "rack": False,
    "rolling on a circle": False,
    "rolling in a circle": False,
}


@pytest.mark.parametrize("kind", FREE)
def test_only_where_a_turn_changes_nothing_the_input_turns_freely(kind: str) -> None:
    mechanism = contact(kind, 2)
    assert turns_freely(mechanism.model) is FREE[kind]
    if kind == "rack":  # which has a dead point before one turn
        return
    ends = mechanism.sweep(from_=0, to=360, step=360)
    assert ends.found.all()
    first, last = ends.q
    turning = mechanism.model.compiled.table.is_angle[: len(first)]
    back = np.where(turning, np.abs(np.exp(1j * (last - first)) - 1), np.abs(last - first))
    assert bool(back.max() < 1e-9) is FREE[kind]


@pytest.mark.parametrize(
    ("teeth", "turns"), [((40, 20), 1), ((20, 40), 2), ((40, 15), 3), ((17, 17), 1), ((24, 17), 17)]
)
@pytest.mark.parametrize("crossed", [False, True])
def test_a_circuit_of_wheels_closes_when_both_have_turned_whole_times(
    teeth: tuple[int, int], turns: int, crossed: bool
) -> None:
    mechanism = lw.linkage(
        points=xy(O=0j, P=60 + 0j, A=10 + 0j, B=60 + 12j),
        links={"ground": ("O", "P"), "left": ("O", "A"), "right": ("P", "B")},
        belts=(
            lw.Belt(name="b", wheels=("left", "right"), centers=("O", "P"), teeth=teeth,
                    crossed=crossed),
        ),
        inputs=(lw.Input(link="left"),),
    )  # fmt: skip
    (circuit,) = mechanism.circuits()
    assert circuit.end is lw.CircuitEnd.CLOSED
    assert circuit.certified
    other = turns * teeth[0] // teeth[1] * (-1 if crossed else 1)
    assert dict(circuit.turning) == {"left": turns, "right": other}
    assert turns_freely(mechanism.model) is (turns == 1)


def test_far_values_of_geared_wheels_leave_out_the_laps_that_bring_both_back() -> None:
    mechanism = contact("belt open", 1)  # three turns of the one are one of the other
    near = mechanism.solve(at=40 + 360)
    for laps in (1000, -(10**6)):
        far = mechanism.solve(at=40 + 360 + laps * 3 * 360)
        assert far.certificate.certified
        assert far["rod1"] == pytest.approx(near["rod1"], abs=1e-7)
        assert far["right"] == pytest.approx(near["right"] + laps * 360, abs=1e-6)


@pytest.mark.parametrize(
    ("sizes", "weights"),
    [
        ({"teeth": (40, 15)}, (8, 3)),
        ({"teeth": (100_003, 100_019)}, (100_003, 100_019)),  # two primes
        ({"radii": (10, 30)}, (1, 3)),
        ({"radii": (0.7, 0.3)}, (7, 3)),
        ({"radii": (2 / 3, 4 / 9)}, (3, 2)),
        ({"radii": (math.pi, 1)}, (math.pi, 1)),
    ],
)
def test_sizes_in_a_ratio_of_whole_numbers_tie_angles_by_these(
    sizes: dict[str, Any], weights: tuple[float, float]
) -> None:
    mechanism = lw.linkage(
        points=xy(O=0j, P=60 + 0j, A=10 + 0j, B=60 + 12j),
        links={"ground": ("O", "P"), "left": ("O", "A"), "right": ("P", "B")},
        belts=(lw.Belt(name="b", wheels=("left", "right"), centers=("O", "P"), **sizes),),
        inputs=(lw.Input(link="left"),),
    )
    (line,) = mechanism.loop_equations.linear
    found = dict(line.terms)
    assert (-found["left"], found["right"]) == weights


def test_a_turn_that_a_law_does_not_repeat_is_a_change() -> None:
    table = contact("cam by its follower, swinging knife", 1).model.compiled.table
    arm, cam = 0, table.unknowns
    turns = np.zeros(table.variables)
    turns[cam] = 1.0
    assert table.repeats_after(turns)
    turns[cam] = 0.5
    assert not table.repeats_after(turns)
    turns[cam], turns[arm] = 1.0, 1.0
    assert not table.repeats_after(turns)


NOT_LISTED = (
    "not proved: configurations of plain equations cannot be listed; the equations of {} {}"
)


@pytest.mark.parametrize(
    ("kind", "count", "reason"),
    [
        ("weld", 2, ""),
        ("gear external", 2, ""),
        ("gear internal", 2, ""),
        ("gear on a moving arm", 2, ""),
        ("belt open", 2, ""),
        ("rack", 2, ""),
        ("rolling on a line", 2, ""),
        ("rolling in a circle", 2, ""),
        *((kind, 1, "") for kind in KINDS if kind.startswith("cam by its follower")),
        (
            "cam by its outline, sliding knife",
            0,
            NOT_LISTED.format("s, law, law_x, law_y", "contain a law of a cam or curve"),
        ),
        (
            "cam by its outline, sliding flat",
            0,
            NOT_LISTED.format("law, law_dx, law_dy, law_speed", "contain a law of a cam or curve"),
        ),
        (
            "curve open",
            0,
            NOT_LISTED.format("rod, u, u_x, u_y", "contain a law of a cam or curve"),
        ),
    ],
)
def test_configurations_are_listed_or_a_reason_is_given(kind: str, count: int, reason: str) -> None:
    mechanism = contact(kind, 3)
    ways = mechanism.configurations(at=10)
    assert len(ways) == count
    if count:
        assert ways.completeness is lw.Completeness.PROVED
        assert all(way.certificate.certified for way in ways)
        here = mechanism.solve(at=10)
        assert any(
            all(
                math.hypot(p[0] - q[0], p[1] - q[1]) < 1e-8
                for p, q in zip(way.points.values(), here.points.values(), strict=True)
            )
            for way in ways
        )
    else:
        assert ways.message == reason
        assert ways.completeness is lw.Completeness.NOT_LISTED


@pytest.mark.parametrize(
    "kind", ["cam by its follower, sliding roller", "cam by its outline, sliding knife"]
)
def test_the_circuit_of_a_cam_is_one_turn_of_it(kind: str) -> None:
    (circuit,) = contact(kind, 4).circuits()
    assert circuit.end is lw.CircuitEnd.CLOSED
    assert circuit.turning["cam"] == 1


def test_a_cylinder_through_its_own_end_stops_at_a_named_place() -> None:
    mechanism = lw.linkage(
        points=xy(O=0j, A=10 + 0j, S=-50 + 0j, T=50 + 0j),
        links={"ground": ("O", "S", "T"), "block": ("A",)},
        sliders=(lw.Slider(name="s", link="block", points=("A",), on="ground", line=("S", "T")),),
        cylinders=(lw.Cylinder(name="c", between=("O", "A")),),
        inputs=(lw.Input(slider="s", from_=60, to=40, step=-1),),
    )
    motion = mechanism.sweep()
    (limit,) = motion.limits
    assert limit.kind is LimitKind.CHANGE_POINT
    assert limit.located
    assert limit.input == pytest.approx(50, abs=1e-12)
    assert motion.status[-1] is lw.Status.CHANGE_POINT


def test_the_follower_can_drive_the_cam_where_its_law_rises() -> None:
    def mechanism(which: lw.Input) -> lw.Mechanism:
        return lw.linkage(
            points=xy(O=0j, S=-1 + 0j, T=-1 + 100j, R=-1 + 45j),
            links={"ground": ("O", "S", "T"), "cam": ("O",), "stem": ("R",)},
            sliders=(
                lw.Slider(name="s", link="stem", points=("R",), on="ground", line=("S", "T")),
            ),
            cams=(
                lw.Cam(name="law", cam="cam", center="O", slider="s", base=40, start=-60,
                       segments=(
                           lw.Segment(law="cycloidal", over=120, lift=10),
                           lw.Segment(law="cycloidal", over=240, lift=-10),
                       )),
            ),
            inputs=(which,),
        )  # fmt: skip

    back = mechanism(lw.Input(slider="s", from_=40.5, to=49.5, step=0.5)).sweep()
    assert back.certified.all()
    assert np.ptp(back["cam"]) > 50
    forth = mechanism(lw.Input(link="cam"))
    for s, cam in zip(back.inputs["s"], back["cam"], strict=True):
        assert forth.solve(at=float(cam))["s"] == pytest.approx(s, rel=0, abs=1e-10)
    # in a dwell nothing can drive it: at the top of the rise the motion ends
    ended = mechanism(lw.Input(slider="s", from_=45, to=55, step=0.5)).sweep()
    (limit,) = ended.limits
    assert limit.kind is LimitKind.DEAD_POINT
    assert limit.input == pytest.approx(10 + math.sqrt(40**2 - 1), rel=0, abs=1e-6)
