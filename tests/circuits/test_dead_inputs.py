"""Inputs of all dead points: closed forms, the rapier drive, special cases, reasons."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import linkwork as lw
from linkwork import Completeness
from linkwork.circuits import dead_inputs
from linkwork.circuits.homotopy import isolated_roots
from tests.campaigns.circuits import CRANKED, dead_inputs_of
from tests.core.laws.mechanisms import NAMES, mechanism_of
from tests.oracles.cranked import cranked_truss
from tests.thinned import thinned


def looped(
    *loops: str, input_rows: tuple[float, float, float] = (0, 360, 10), **guess: float
) -> lw.Mechanism:
    """Loops driven by t, its guess first."""
    start, stop, step = input_rows
    return lw.loops(
        loops={str(k): text for k, text in enumerate(loops)},
        guess=guess,
        inputs=lw.Input(variable="t", from_=start, to=stop, step=step),
    )


def _angles(cosines: list[float]) -> np.ndarray:
    inside = [math.acos(c) for c in cosines if abs(c) < 1.0]
    return np.sort([*inside, *(-a for a in inside)])


@pytest.mark.parametrize("part", range(4))
def test_four_bars_have_the_dead_points_of_the_closed_form(part: int) -> None:
    rng = np.random.default_rng([1, part])
    for _ in range(25):
        a, b, c, d = rng.uniform(0.3, 3.0, 4).tolist()
        found = dead_inputs_of(
            looped(f"{b}*e^(i*t) + {c}*e^(i*p) = {a} + {d}*e^(i*q)", t=60, p=30, q=80)
        )
        theory = _angles([(a * a + b * b - (c + s * d) ** 2) / (2 * a * b) for s in (1, -1)])
        np.testing.assert_allclose(found.values, theory, rtol=0, atol=1e-9)
        assert found.completeness is Completeness.WITH_PROBABILITY_ONE
        assert found.cover_all
        assert not found.multiple.any()
        assert [count.finite for count in found.counts] == [4]


def test_slider_cranks_lock_where_the_rod_is_square_to_the_slide() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        b, c, h = rng.uniform(0.3, 2), rng.uniform(0.3, 2), rng.uniform(-1, 1)
        found = dead_inputs_of(
            looped(f"{b}*e^(i*t) + {c}*e^(i*p) = s + i*({h})", t=60, p=30, s=1.0)
        )
        sines = [math.asin((h + s * c) / b) for s in (1, -1) if abs(h + s * c) < b]
        theory = [math.remainder(x, 2 * math.pi) for a in sines for x in (a, math.pi - a)]
        np.testing.assert_allclose(found.values, np.sort(theory), rtol=0, atol=1e-8)


def test_slotted_levers_lock_where_the_pin_is_square_to_the_slot() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b, k = rng.uniform(0.3, 2), rng.uniform(0.3, 2), rng.uniform(0.1, 1)
        found = dead_inputs_of(
            looped(f"{b}*e^(i*t) = {a} + (s + i*{k})*e^(i*p)", t=60, p=30, s=1.0)
        )
        theory = _angles([(a * a + b * b - k * k) / (2 * a * b)])
        np.testing.assert_allclose(found.values, theory, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("rapier-drive", [0.302876213349, 155.227836297534]),
        ("rapier-drive-limited", [-158.679899604109, 149.617278637485]),
    ],
)
def test_the_rapier_locks_where_the_book_of_figures_says(name: str, values: list[float]) -> None:
    for which in (name, f"{name}-links"):
        found = dead_inputs_of(lw.example(which))
        np.testing.assert_allclose(np.degrees(found.values), values, rtol=0, atol=1e-11)
        (count,) = found.counts
        assert (count.finite, count.real, count.bound) == (24, 2, 40)


def test_a_driven_slider_locks_at_both_ends_of_its_strokes() -> None:
    """Crank 40, rod 120, offset 20: stretched and folded, on both sides."""
    mechanism = lw.example("slider-input")
    found = dead_inputs_of(mechanism)
    limits = {round(x.input, 8) for c in mechanism.circuits(certify=False) for x in c.dead_points}
    assert sorted(round(v, 8) for v in found.values.tolist()) == sorted(limits)
    assert len(limits) == 4


@pytest.mark.parametrize("graph", ["Ds["])
def test_random_mechanisms_have_the_number_of_their_structure(graph: str) -> None:
    for seed in range(8):
        (count,) = dead_inputs_of(cranked_truss(graph, np.random.default_rng(seed))).counts
        assert (count.finite, count.expected, count.multiple) == (CRANKED[graph],) * 2 + (0,)


def test_lengths_in_millimetres_change_nothing() -> None:
    for seed in range(3):
        metres, millimetres = (
            dead_inputs_of(cranked_truss("Ds[", np.random.default_rng(seed), size=size)).values
            for size in (1.0, 1000.0)
        )
        np.testing.assert_allclose(metres, millimetres, rtol=0, atol=1e-9)


#: With bars of one length some dead points lie at infinity.
ISOSCELES = {"evans", "hoeken", "pantograph", "five-bar-robot"}


#: Their dead points take more than five seconds.
COSTLY = {
    "beam-engine", "dixon-one", "dixon-two", "double-butterfly", "scissor-lift",
    "stephenson-valve-gear", "trotbot-leg",
    "jansen-leg",
    "pantograph",  # among the isosceles ones below
}  # fmt: skip


@pytest.mark.parametrize("name", thinned(name for name in NAMES if name not in COSTLY))
def test_every_mechanism_of_the_laws_has_a_complete_list_or_a_reason(name: str) -> None:
    found = dead_inputs_of(mechanism_of(name))
    assert found.cover_all == (found.reason == "")
    for count in found.counts:
        assert count.paths >= count.finite + count.multiple
        if name not in ISOSCELES:
            assert count.paths == count.finite + count.multiple


def test_change_points_are_listed_to_rounding_and_marked() -> None:
    parallelogram = looped("e^(i*t) + 2*e^(i*p) = 2 + e^(i*q)", t=60, p=0, q=60)
    found = dead_inputs_of(parallelogram)
    np.testing.assert_allclose(np.sin(found.values), 0.0, rtol=0, atol=1e-12)
    assert found.multiple.tolist() == [True, True]
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    touching = looped("e^(i*t) + 3*e^(i*p) = 4 + 2*e^(i*q)", t=60, p=30, q=80)
    found = dead_inputs_of(touching)
    assert (found.values.tolist(), found.multiple.tolist()) == ([pytest.approx(math.pi)], [True])


def test_a_kite_can_move_at_a_dead_point_and_says_so() -> None:
    found = dead_inputs_of(looped("e^(i*t) + 2*e^(i*p) = 1 + 2*e^(i*q)", t=60, p=30, q=80))
    assert found.completeness is Completeness.CONTINUUM
    assert not found.cover_all
    assert found.reason == "p, q can move while the input is constant, as at t = 0 deg"


@pytest.mark.parametrize(
    "name",
    [*sorted(ISOSCELES - {"pantograph"}), pytest.param("pantograph", marks=pytest.mark.extended)],
)
def test_bars_of_one_length_that_cannot_fold_onto_each_other_leave_the_list_complete(
    name: str,
) -> None:
    """Two equal bars turn freely where their outer pins meet, and there only.

    Hoeken's crank of 1 never reaches the rocker's pivot at 2; the robot's cranks of 90 about
    pivots 118 apart do not bring both elbows together in lock-step; the pantograph's tracing
    point never comes to the end of the long bar, which its arm's dead point would take.
    """
    found = dead_inputs_of(lw.example(name))
    assert (found.completeness, found.reason) == (Completeness.WITH_PROBABILITY_ONE, "")
    assert all(
        count.multiple == 0 for count in found.counts if count.unknowns != ("tie", "pen_bar")
    )


def test_pivots_that_can_meet_say_which_bars_turn_and_where() -> None:
    """The inversor with both elbows on one side: the far bars lie on each other, and turn."""
    inversor = lw.example("peaucellier")
    reason = dead_inputs_of(inversor).reason
    match = re.fullmatch(
        r"far_B, far_D can move while the input is constant, as at crank = (\S+) deg", reason
    )
    assert match is not None
    ways = inversor.configurations(at=float(match[1]))
    assert ways.completeness is Completeness.CONTINUUM
    # the near elbows' positions by the law of cosines: |OP| = 2 r cos(crank/2), arms 5, near 3
    reach = 3.0 * math.cos(math.radians(float(match[1])) / 2)
    assert 2.0 <= reach <= 8.0


def test_a_continuum_that_is_neither_real_nor_surely_complex_is_called_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(dead_inputs, "real_motion", lambda *_: None)
    found = dead_inputs_of(lw.example("peaucellier"))
    assert found.completeness is Completeness.CONTINUUM
    assert found.reason == (
        "not proved: complex dead points form a continuum, which may contain real ones"
    )


def test_cylinders_in_lock_step_are_the_reason_given() -> None:
    """The excavator has no rack: its cylinders' lengths follow one of them."""
    found = dead_inputs_of(lw.example("excavator"))
    assert not found.cover_all
    assert found.reason.startswith(
        "the equations of stick, stick_ram_angle relate two lengths, as inputs driven together do; "
    )
    assert "racks" not in found.reason
    assert "relate an angle to a length, as racks and rolling wheels do" in (
        dead_inputs_of(lw.example("rack-steering")).reason
    )


def test_lengths_that_run_to_infinity_are_listed_apart() -> None:
    found = dead_inputs_of(looped("r*e^(i*(t + 20)) = 1 + i*s", t=30, r=1.0, s=0.5))
    np.testing.assert_allclose(np.degrees(found.poles), [-110.0, 70.0], rtol=0, atol=1e-9)
    assert found.values.size == 0
    assert found.cover_all
    # the same behind a four-bar: the poles are not known
    behind = looped(
        "e^(i*t) + 3*e^(i*p) = 4 + 3*e^(i*q)", "r*e^(i*q) = 1 + i*s", t=60, p=30, q=80, r=1.0, s=0.5
    )
    found = dead_inputs_of(behind)
    assert not found.cover_all
    assert found.completeness.complete
    assert found.reason == "a length can run to infinity between them"


def test_inputs_in_lock_step_count_as_one() -> None:
    """A five-bar whose cranks turn together is a four-bar with a turning frame."""
    both = (
        lw.Input(variable="t", from_=60, to=420, step=10),
        lw.Input(variable="u", from_=100, to=460, step=10),
    )
    text = "e^(i*t) + 3*e^(i*p) = 4 + 1.5*e^(i*u) + 1.7*e^(i*q)"
    five = lw.loops(loops={"1": text}, guess={"t": 60, "u": 100, "p": 30, "q": 100}, inputs=both)
    found = dead_inputs_of(five)
    # |4 + (1.5 e^(40°) - 1) e^(it)| = 3 + 1.7 or 3 - 1.7
    arm = 1.5 * np.exp(1j * math.radians(40)) - 1
    cosines = [(r * r - 16 - abs(arm) ** 2) / (8 * abs(arm)) for r in (4.7, 1.3)]
    theory = [math.remainder(x - float(np.angle(arm)), 2 * math.pi) for x in _angles(cosines)]
    np.testing.assert_allclose(found.values, np.sort(theory), rtol=0, atol=1e-9)
    assert len(theory) == 2


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            "e^(i*t) + 3*e^(i*p) + 0.5*e^(2*i*t) = 4 + 3*e^(i*q)",
            "the equations of p, q contain more sums of angles than angles, as gears do",
        ),
        (
            "e^(i*t) + 3*e^(i*p) + 0.5*e^(-i*t) = 4 + 3*e^(i*q)",
            "the equations of p, q contain an angle both forwards and backwards",
        ),
    ],
)
def test_gears_have_no_list_and_a_reason(text: str, reason: str) -> None:
    found = dead_inputs_of(looped(text, t=60, p=30, q=80))
    assert (found.completeness, found.reason) == (Completeness.NOT_LISTED, reason)
    assert found.values.size == 0


def test_too_many_loops_are_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("linkwork.circuits.dead_inputs._MOST_PATHS", 6)
    found = dead_inputs_of(lw.example("double-four-bar"))
    assert found.reason == (
        "the equations of θ4, θ5 depend on 2 loops; their dead points would take 20 paths, "
        "more than the 6 that are followed"
    )
    assert [count.bound for count in found.counts] == [6]


def test_loops_that_say_the_same_twice_are_no_complete_list() -> None:
    one = "2*e^(i*a) + 3*e^(i*b) + 4*e^(i*c) + 5*e^(i*d) = e^(i*t)"
    two = "4*e^(i*a) + 6*e^(i*b) + 8*e^(i*c) + 10*e^(i*d) = 2*e^(i*t)"
    found = dead_inputs_of(looped(one, two, t=60, a=0, b=100, c=190, d=280))
    assert found.reason == (
        "the equations of a, b, c, d are not independent: one follows from the others"
    )


def test_lost_paths_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isolated_roots, "_KNOWN", {})
    monkeypatch.setattr(isolated_roots, "read_sets", lambda topology: iter(()))
    monkeypatch.setattr(isolated_roots, "write_set", lambda kept: None)
    monkeypatch.setattr(isolated_roots, "_TRIES", 0)
    found = dead_inputs_of(lw.example("rapier-drive"))
    assert found.completeness is Completeness.NOT_PROVED
    assert found.reason == ("not proved: solution paths were lost, so dead points may be missing")
