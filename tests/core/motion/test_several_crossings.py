"""Trains of parallelograms: several loops cross at one input, or next to each other."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.motion import limits
from tests.oracles.trains import Loop, apart, parallelogram, straight_motion, train, turned
from tests.thinned import thinned


def unit_train(count: int, rows: tuple[float, float, float]) -> lw.Mechanism:
    """Unit parallelograms; those whose cranks point downwards at first are closed the other way."""
    side = -1.0 if math.sin(math.radians(rows[0])) > 0.0 else 1.0
    return train([Loop(1.0, 1.0, 1.0, 1.0, side=side)] * count, rows)


def two_loops(offset: float, rows: tuple[float, float, float]) -> lw.Mechanism:
    """Two parallelograms; the second one crosses where the crank is ``offset`` short of a line."""
    return train([parallelogram(4.0, 2.0), parallelogram(3.0, 1.0, offset)], rows)


ROWS = [(90, 450, 10), (90, -270, -10), (45, 765, 7.2), (77, 437, 60), (-170, 190, 36)]


@pytest.mark.parametrize("rows", thinned(ROWS, 3), ids=str)
@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_rows_beyond_a_shared_crossing_stay_parallel(
    count: int, rows: tuple[float, float, float]
) -> None:
    certify = count % 2 == 0
    motion = unit_train(count, rows).sweep(change_points="straight", certify=certify)
    assert motion.found.all()
    for k in range(1, count + 1):
        np.testing.assert_allclose(motion[f"t{k}"], motion["t0"], rtol=0, atol=1e-11)
    crossings = [limit for limit in motion.limits if limit.passed]
    assert crossings
    for limit in motion.limits:
        assert limit.loops == tuple(f"loop {k}" for k in range(1, count + 1))
        assert abs(math.remainder(limit.input, math.pi)) < 1e-14
    if certify:  # nothing beyond the first crossing is called proved
        beyond = np.abs(motion["t0"] - motion["t0"][0]) > abs(
            min((limit.input - motion["t0"][0] for limit in crossings), key=abs)
        )
        assert not motion.certified[beyond].any()


@pytest.mark.parametrize("offset", [1e-2, -1e-4, 1e-6, -1e-9, 1e-10])
@pytest.mark.parametrize("rows", ROWS[:2], ids=str)
def test_crossings_close_to_each_other_are_told_apart(
    offset: float, rows: tuple[float, float, float]
) -> None:
    motion = two_loops(offset, rows).sweep(change_points="straight")
    assert motion.found.all()
    for name, ahead in (("t1", 0.0), ("t2", offset)):
        np.testing.assert_allclose(motion[name], motion["t0"] + ahead, rtol=0, atol=1e-11)
    passed = [limit for limit in motion.limits if limit.passed]
    assert {limit.loops for limit in passed} == {("loop 1",), ("loop 2",)}
    for limit in passed:
        own = offset if limit.loops == ("loop 2",) else 0.0
        # the second loop is driven by one that crosses itself: its place is known a little less
        assert abs(math.remainder(limit.input + own, math.pi)) < 1e-12


@pytest.mark.parametrize("count", [1, 2, 3])
def test_every_loop_turns_off_at_a_shared_crossing(count: int) -> None:
    grounds, cranks = [4.0, 3.0, 5.0][:count], [2.0, 1.0, 1.5][:count]
    motion = train(list(map(parallelogram, grounds, cranks)), (90, 450, 10)).sweep(
        change_points="turn"
    )
    assert motion.found.all()
    assert [limit.passed for limit in motion.limits] == ["", "turn", "turn"]
    assert all(len(limit.loops) == count for limit in motion.limits)
    theta = motion["t0"]
    between = (theta > math.pi + 1e-9) & (theta < 2.0 * math.pi - 1e-9)
    driven = theta
    for k, (ground, crank) in enumerate(zip(grounds, cranks, strict=True), start=1):
        own = motion[f"t{k}"]
        assert apart(own[between], turned(ground, crank, driven[between])) < 1e-11
        assert apart(own[~between], theta[~between]) < 1e-11
        driven = own


def test_a_loop_that_cannot_be_told_to_be_on_its_side_stops_the_sweep() -> None:
    # the first loop turns off, and a billionth of a radian later the second one would
    motion = two_loops(1e-9, (90, 450, 10)).sweep(change_points="turn")
    beyond = (motion["t0"] > math.pi) & (motion["t0"] < 2.0 * math.pi)
    found = motion.found & beyond
    driven = motion["t1"][found]
    assert apart(driven, turned(4.0, 2.0, motion["t0"][found])) < 1e-11 if found.any() else True
    assert {motion.status[k] for k in np.flatnonzero(beyond & ~motion.found)} <= {
        lw.Status.CHANGE_POINT
    }


@pytest.mark.parametrize("gap", [1e-13, 1e-10, 1e-7, 1e-4, -1e-12, -1e-9, -1e-5])
def test_rows_next_to_a_crossing_are_found(gap: float) -> None:
    mechanism = two_loops(0.0, (90, 180 + math.degrees(gap), 18))
    motion = mechanism.sweep(change_points="straight")
    assert motion.found.all()
    for name in ("t1", "t2"):
        np.testing.assert_allclose(motion[name], motion["t0"], rtol=0, atol=1e-11)


SLOW = [  # links of nearly equal length: the last loops turn a hundredth of the input's way at 180°
    Loop(3.098114815273539, 3.1195610030108463, 3.1105847561466504, 3.1070910621377354, 0.0, 1.0),
    Loop(
        2.9323094000834407, 2.5997449443054172, 2.8811049775970012, 2.650949366791856, -1e-10, 1.0
    ),
    Loop(
        3.322226682430337, 1.1218475939235018, 3.322226682430337, 1.1218475939235018, -1.4e-8, 1.0
    ),
    Loop(
        2.763681799369027, 2.7260435495059703, 2.763681799369027, 2.7260435495059703, -2.6e-8, 1.0
    ),
]
NEXT = [  # the last loop crosses 1e-6 beyond the others
    Loop(1.4108076226674036, 2.664370641825652, 1.4108076226674036, 2.664370641825652, -1e-6),
    Loop(
        1.8015677981589873, 2.479673384836006, 2.1472236383319214, 2.1340175446630716,
        3.0817482876699387e-07,
    ),
    Loop(3.1799492789717894, 3.46996419626586, 3.1799492789717894, 3.46996419626586),
    Loop(1.8599696432184027, 3.409026030890698, 1.8599696432184027, 3.409026030890698),
    Loop(
        1.487090169410922, 1.4796773845104254, 1.487090169410922, 1.4796773845104254,
        -1.0210734243388799e-06,
    ),
]  # fmt: skip
FAST = [  # the last loop crosses where the one before it turns quickly
    Loop(2.9589913431629205, 1.3985459087275207, 2.9589913431629205, 1.3985459087275207, 0.0, 1.0),
    Loop(3.8004784453320886, 3.8902531541434584, 3.810506231543254, 3.880225367932293, 1e-9, 1.0),
    Loop(
        1.792725439802501, 3.953629413427379, 1.792725439802501, 3.953629413427379,
        -5.05836261766035e-10, 1.0,
    ),
]  # fmt: skip
BENT = [  # the last loop does not cross at 360°, where it turns quickly
    Loop(3.0890929992615432, 1.8767545389408042, 3.0890929992615432, 1.8767545389408042, 0.0, -1.0),
    Loop(2.74446926267386, 2.202114115354251, 2.74446926267386, 2.202114115354251, 0.0, -1.0),
    Loop(
        3.509504727484351, 1.770997512334259, 3.509504727484351, 1.770997512334259,
        -1.0149011611938476e-06, -1.0,
    ),
    Loop(
        1.0397547125985966, 2.4707548980034724, 1.0397547125985966, 2.4707548980034724,
        0.0009996706521940837, -1.0,
    ),
    Loop(
        3.817082262842745, 3.741904547458737, 3.8049392500031027, 3.754047560298379,
        -0.0010000000996690434, -1.0,
    ),
]  # fmt: skip


TRAINS = {
    "driven slowly": (SLOW, (-45.0, 315.0, 60.0)),
    "next to each other": ([replace(loop, side=-1.0) for loop in NEXT], (30.0, 390.0, 6.0)),
    "driven quickly": (FAST, (-45.0, -405.0, -1.0)),
    "bent at a crossing": (BENT, (90.0, 450.0, 10.0)),
}


@pytest.mark.parametrize(
    ("name", "certify"),
    [
        *((name, False) for name in TRAINS),
        # the proof beyond a slowly driven crossing takes half a minute before it is given up
        pytest.param("driven slowly", True, marks=pytest.mark.extended),
        ("next to each other", True),
        ("driven quickly", True),
    ],
)
def test_trains_whose_crossings_nearly_coincide_go_straight_on(name: str, certify: bool) -> None:
    loops, rows = TRAINS[name]
    motion = train(loops, rows).sweep(change_points="straight", certify=certify)
    assert motion.found.all()
    for k, exact in enumerate(straight_motion(loops, motion["t0"]), start=1):
        assert apart(motion[f"t{k}"][motion.asked], exact[motion.asked]) < 1e-8
    crossed = {name for limit in motion.limits if limit.passed for name in limit.loops}
    assert crossed == {f"loop {k}" for k in range(1, len(loops) + 1)}


@pytest.mark.parametrize("certify", [True, False])
def test_rows_beyond_a_crossing_that_cannot_be_passed_have_no_position(
    certify: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the crank turns freely, so the rows could be reached the other way around, on another side
    monkeypatch.setattr(limits, "pass_change_points", lambda *_, **__: None)
    loop = [Loop(3.0, 1.0, 2.5, 1.5, side=-1.0)]
    stopped = train(loop, (90, 450, 10)).sweep(change_points="stop", certify=certify)
    assert stopped.found.all()
    motion = train(loop, (90, 450, 10)).sweep(change_points="straight", certify=certify)
    beyond = motion["t0"] > math.pi + 1e-6
    assert not motion.found[beyond].any()
    assert motion.found[motion["t0"] < math.pi - 1e-6].all()
    assert {motion.status[k] for k in np.flatnonzero(beyond)} == {lw.Status.LOST}
    assert not motion.certified[beyond].any()
    assert np.isnan(motion["t1"][beyond]).all()
