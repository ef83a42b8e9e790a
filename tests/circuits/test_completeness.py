"""Lists of circuits are complete, and say so: narrow circuits, counts, grades, messages."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork import Completeness
from linkwork.circuits.arcs import is_regular
from linkwork.circuits.dead_inputs import intervals_between
from tests.campaigns.circuits import dead_inputs_of, judge_circuits
from tests.campaigns.motion import FAMILIES, random_mechanism
from tests.core.laws.mechanisms import NAMES, mechanism_of
from tests.oracles.cranked import cranked_truss
from tests.thinned import thinned


def two_dyads(n: float) -> lw.Mechanism:
    """A crank-rocker with a dyad on its coupler, too short but for a few degrees if crossed."""
    return lw.loops(
        name="Two dyads",
        loops={
            "four-bar": "b*e^(i*t) + c*e^(i*p) = a + d*e^(i*q)",
            "dyad": "b*e^(i*t) + (u + i*v)*e^(i*p) + m*e^(i*x) = g + i*h + n*e^(i*y)",
        },
        dimensions={
            "a": 4,
            "b": 1.5,
            "c": 3.5,
            "d": 3,
            "u": 1.5,
            "v": 1,
            "m": 2,
            "n": n,
            "g": 1.5,
            "h": 4.5,
        },
        guess={"t": 60, "p": 35, "q": 70, "x": 100, "y": 250},
        inputs=lw.Input(variable="t", from_=0, to=360, step=10),
    )


@pytest.mark.parametrize(("n", "width"), [(1.81, 6.06), (1.80804, 0.311)])
def test_a_circuit_of_a_few_degrees_away_from_the_guess_is_found(n: float, width: float) -> None:
    """Steps of 15 degrees from the guess pass it by: at 105 and 120 degrees nothing shows."""
    mechanism = two_dyads(n)
    first, narrow = mechanism.circuits()
    assert first.closed
    assert narrow.closed
    assert narrow.certified
    low, high = narrow.input_range
    assert 105 < low < high < 120
    assert high - low == pytest.approx(width, abs=0.02)
    for k in range(24):
        at = 60 + 15 * k
        inside = first.input_range[0] < at < first.input_range[1]
        inside |= first.input_range[0] < at - 360 < first.input_range[1]
        assert len(mechanism.configurations(at=at)) == (2 if inside else 0)
    assert mechanism.circuits().completeness is Completeness.WITH_PROBABILITY_ONE


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("seed", thinned(range(3)))
def test_dead_points_of_circuits_and_of_the_list_are_the_same(seed: int, family: str) -> None:
    rng = np.random.default_rng([5, seed])
    assert judge_circuits(random_mechanism(family, rng), rng) == []


@pytest.mark.parametrize("seed", range(4))
def test_six_bars_pass_every_configuration(seed: int) -> None:
    rng = np.random.default_rng(seed)
    assert judge_circuits(cranked_truss("Ds[", rng), rng) == []


@pytest.mark.parametrize("name", ["rapier-drive", "rapier-drive-limited", "stephenson-far-crank"])
def test_library_mechanisms_pass_every_configuration(name: str) -> None:
    assert judge_circuits(lw.example(name), np.random.default_rng(0), looks=6) == []


def test_a_driven_slider_passes_every_configuration() -> None:
    assert judge_circuits(lw.example("slider-input"), np.random.default_rng(0), looks=6) == []


def test_what_makes_the_list_complete_is_told() -> None:
    no_limits = lw.example("rapier-drive-limited").circuits(certify=False)
    assert no_limits.completeness is Completeness.WITH_PROBABILITY_ONE
    assert no_limits.message == (
        "the list of circuits is complete with probability one: all dead points were found, and "
        "all configurations at 2 input values, at least one between any two of them"
    )
    assert no_limits.seeded == 2
    free = lw.example("four-bar").circuits(certify=False)
    assert (free.completeness, free.seeded) == (Completeness.WITH_PROBABILITY_ONE, 1)
    assert free.message == (
        "the list of circuits is complete with probability one: all dead points were found, and "
        "all configurations at the guess's input (there is no dead point)"
    )


def test_where_dead_points_may_be_missing_the_reason_is_told() -> None:
    kite = lw.loops(
        loops={"1": "e^(i*t) + 2*e^(i*p) = 1 + 2*e^(i*q)"},
        guess={"t": 60, "p": 30, "q": 80},
        inputs=lw.Input(variable="t", from_=0, to=360, step=10),
    ).circuits(certify=False)
    assert kite.completeness is Completeness.NOT_PROVED
    assert kite.message.endswith(
        f"{kite.seeded} input values; a circuit that lies between two of them would be missing "
        "(p, q can move while the input is constant, as at t = 0 deg)"
    )


def test_lists_that_fail_in_an_interval_are_tried_elsewhere_then_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "linkwork.circuits.circuit_list.is_regular",
        lambda leads, v, most=0.0: is_regular(leads, v, most),
    )
    found = lw.example("rapier-drive-limited").circuits(certify=False)
    assert found.completeness is Completeness.NOT_PROVED
    assert found.message == (
        "the circuits found at 6 input values; a circuit that lies between two of them would be "
        "missing"
    )


def test_a_guess_at_a_dead_point_does_not_stand_for_its_interval() -> None:
    circuits = lw.example("rapier-drive-limited").circuits(certify=False)
    motion = circuits[0].motion
    at = next(k for k, limit in enumerate(motion.limit) if limit == "dead point")
    guess = {name: float(motion[name][at]) for name in (*motion.unknowns, "θ12")}
    moved = lw.example("rapier-drive-limited").changed(guess=guess).circuits(certify=False)
    assert moved.completeness is Completeness.WITH_PROBABILITY_ONE
    assert [len(circuit.dead_points) for circuit in moved] == [2]


#: Their circuits take seconds: coupled loops, or many circuits.
COSTLY = frozenset({
    "beam-engine", "dixon-one", "dixon-two", "double-butterfly", "excavator", "hart-inversor",
    "jansen-leg", "kempe-translator", "pantograph", "peaucellier", "scissor-lift",
    "stephenson-valve-gear", "three-rpr-platform", "trotbot-leg",
})  # fmt: skip


@pytest.mark.parametrize("name", thinned((name for name in NAMES if name not in COSTLY), 12))
def test_a_complete_list_says_how_its_dead_points_were_found(name: str) -> None:
    mechanism = mechanism_of(name)
    circuits = mechanism.circuits(certify=False)
    assert circuits.completeness.complete == dead_inputs_of(mechanism).cover_all


def test_every_interval_but_the_guess_s_own_is_looked_into() -> None:
    cuts = np.array([-1.0, 0.5, 2.0])
    ends = [(-1.0, 0.5), (0.5, 2.0), (2.0, 2.0 * np.pi - 1.0)]
    whole = intervals_between(cuts, None, 1.0, turns=True)
    for (low, high), values in zip(ends, whole, strict=True):
        assert values[0] == pytest.approx(0.5 * (low + high))
        assert all(low < value < high for value in values)
    assert intervals_between(cuts, 1.2, 1.0, turns=True) == [whole[0], whole[2]]
    assert intervals_between(cuts, 1.2 - 4.0 * np.pi, 1.0, turns=True) == [whole[0], whole[2]]
    assert intervals_between(cuts, 0.6, 1.0, turns=True) == whole  # too near a cut
    assert intervals_between(cuts[:0], 1.2, 1.0, turns=True) == []
    alone = intervals_between(cuts[:1], None, 1.0, turns=True)
    assert alone[0][0] == pytest.approx(np.pi - 1.0)


def test_a_length_has_intervals_beyond_its_dead_points_too() -> None:
    cuts = np.array([2.0, 3.0])
    below, middle, above = intervals_between(cuts, None, 4.0, turns=False)
    assert all(value < 2.0 for value in below)
    assert all(2.0 < value < 3.0 for value in middle)
    assert all(value > 3.0 for value in above)
    assert intervals_between(cuts, 2.5, 4.0, turns=False) == [below, above]
    assert intervals_between(cuts, 0.5, 4.0, turns=False) == [middle, above]
    assert intervals_between(cuts, 5.0, 4.0, turns=False) == [below, middle]
