"""Circuit and branch defects of mechanisms of any kind, against all of their circuits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.branches import TracedCurve, trace_with_proof
from linkwork.circuits.circuit_sweep import FollowedCircuit, explorer_of, straight_way
from linkwork.circuits.results import Circuits
from linkwork.core.motion.following import Drive
from tests.campaigns import library_defects
from tests.campaigns.library_defects import branches_at, judged_change, library_cases

_FEW = ("chebyshev", "inverted-slider-crank", "slider-input", "stephenson-far-crank", "pumpjack")
_MORE = ("klann-leg", "galloway", "geneva-drive", "rapier-drive", "roberts", "toggle-press")


@pytest.mark.parametrize("name", _FEW)
def test_defects_are_those_of_all_circuits(name: str) -> None:
    mechanism = lw.example(name)
    cases = list(library_cases(mechanism, 8, 3))
    assert {case.change is None for case in cases} == {True, False}
    assert [judged_change(mechanism, case) for case in cases] == [c.change for c in cases]


@pytest.mark.extended
@pytest.mark.parametrize("name", _MORE)
def test_defects_are_those_of_all_circuits_often(name: str) -> None:
    _, false = library_defects.library_defect_campaign(library_defects.MECHANISMS.index(name))
    assert not false


def test_a_verdict_that_differs_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The comparison with circuits is able to find a wrong verdict."""
    monkeypatch.setattr(library_defects, "judged_change", lambda *_: None)
    _, false = library_defects.library_defect_campaign(
        library_defects.MECHANISMS.index("slider-input")
    )
    assert false


def test_a_place_that_all_configurations_share_is_no_change_of_circuits() -> None:
    """The crank pin is at one place in both configurations, so it can tell no circuits apart."""
    engine = lw.example("slider-crank")
    inputs = (10.0, 130.0, 250.0)
    pins = [engine.solve(at=angle).points["A"] for angle in inputs]
    away = [(x + 1e-3, y) for x, y in pins]
    assert lw.Task.path(away).defects_of(engine, inputs, point="A") == ()


def test_positions_on_another_circuit_than_the_guess_have_no_defect() -> None:
    bar = lw.example("four-bar")
    crossed = [bar.solve(at=a, configuration="crossed").points["B"] for a in (20, 200, 300)]
    assert lw.Task.path(crossed).defects_of(bar, (20, 200, 300), point="B") == ()


def _at(mechanism: lw.Mechanism, point: str, *inputs: float) -> list[tuple[float, float]]:
    return [mechanism.solve(at=value).points[point] for value in inputs]


def test_a_position_beyond_a_dead_point_by_rounding_is_not_decided() -> None:
    rocker = lw.example("chebyshev")
    motion = rocker.circuits()[0].motion
    row = max((k for k, limit in enumerate(motion.limit) if limit), key=lambda k: motion["left"][k])
    locked, at = complex(motion.trace("P")[row]), float(motion["left"][row])
    task = lw.Task.path([rocker.solve(at=60).points["P"], (locked.real, locked.imag)])
    (defect,) = task.defects_of(rocker, (60, at + 1e-7), point="P")
    assert (defect.kind, defect.between) == (lw.synthesis.DefectKind.NOT_PROVED, None)
    assert defect.message == "not proved: position 2 is at a dead point"


def test_an_input_that_no_position_has_is_out_of_range() -> None:
    rocker = lw.example("chebyshev")
    places = [*_at(rocker, "P", 60, 70), (0.0, 0.0)]
    (defect,) = lw.Task.path(places).defects_of(rocker, (60, 70, 150), point="P")
    assert defect.kind is lw.synthesis.DefectKind.RANGE
    assert defect.message == "no position of the mechanism has the input of position 3"


def test_a_position_off_the_only_known_circuit_is_not_decided() -> None:
    slot = lw.example("curved-slot")
    places = [*_at(slot, "B", 40, 90)]
    assert lw.Task.path(places).defects_of(slot, (40, 90), point="B") == ()
    places[1] = places[1][0] + 1e-3, places[1][1]
    (defect,) = lw.Task.path(places).defects_of(slot, (40, 90), point="B")
    assert defect.kind is lw.synthesis.DefectKind.NOT_PROVED
    assert defect.message == (
        "not proved: position 2 is not on the circuit of the guess, and the configurations of "
        "these equations cannot be listed"
    )


def test_the_straight_way_ends_at_a_dead_point() -> None:
    model = lw.example("chebyshev").model
    drive, start = Drive.of_circuits(model), model.equations.start
    short, long = (straight_way(drive, start, [0.7, to]) for to in (1.7, 1.8))
    assert short is not None
    assert long is not None
    assert np.isfinite(short.v).all()
    assert (short.low, short.high) == (-np.inf, np.inf)
    assert np.isnan(long.v).all(axis=1).tolist() == [False, True]
    (_, dead) = lw.example("chebyshev").circuits()[0].branches[0].input_range
    assert long.low == -np.inf
    assert long.high == pytest.approx(np.radians(dead), abs=1e-9)


@pytest.mark.parametrize("name", ["slider-input", "three-rpr"])
def test_straight_tracks_decide_inputs_that_do_not_turn_as_circuits_do(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    mechanism = lw.example(name)
    exact = list(library_cases(mechanism, 12, 5))
    cases = [
        replace(case, places=tuple(place * by for place in case.places))
        for case in exact
        for by in (1.0, 1.0 + 1e-7, 1.01)
    ]
    traced = _traced(monkeypatch)
    straight = [judged_change(mechanism, case) for case in cases]
    few = len(traced)
    assert straight[::3] == [case.change for case in exact]
    assert len({change and change[0] for change in straight}) > 1
    undecided = "linkwork.synthesis.defects.by_circuits._Search._straight_starts"
    monkeypatch.setattr(undecided, lambda _: [])
    assert [judged_change(mechanism, case) for case in cases] == straight
    assert 0 < few < len(traced) - few


def _rows_near(
    circuits: Circuits, name: str, point: str, *values: float
) -> tuple[list[float], list[complex]]:
    """The rows of all circuits at which an input is nearest to values: its values and places."""
    inputs = np.concatenate([circuit.motion[name] for circuit in circuits])
    traced = np.concatenate([circuit.motion.trace(point) for circuit in circuits])
    rows = [int(np.abs(inputs - value).argmin()) for value in values]
    return inputs[rows].tolist(), traced[rows].tolist()


def test_branches_that_pass_fewer_positions_do_not_decide(monkeypatch: pytest.MonkeyPatch) -> None:
    # the places of C depend on the input alone: two branches pass two positions, two only one
    mechanism = lw.example("kempe-translator")
    circuits = mechanism.circuits(certify=False)
    inputs, places = _rows_near(circuits, "lower_bar", "C", 264.7614, 359.597, 1.43)
    found = [
        branches_at(circuits, value, {"C": place}, 1e-5)
        for value, place in zip(inputs, places, strict=True)
    ]
    assert 0 < len(found[0] & found[1]) < len(found[0])
    assert not found[0] & found[1] & found[2]
    task = lw.Task.path([(place.real, place.imag) for place in places])
    (defect,) = task.defects_of(mechanism, inputs, point="C")
    assert (defect.kind, defect.between) == (lw.synthesis.DefectKind.BRANCH, (2, 3))
    # even if all of them end at positions that they may not pass
    ends = "linkwork.synthesis.defects.by_circuits._Search._end_at"
    monkeypatch.setattr(ends, lambda _, branch, k: "change point" if k == 1 else "")
    assert task.defects_of(mechanism, inputs, point="C") == (defect,)
    with monkeypatch.context() as patched:
        changes = replace(defect, kind=lw.synthesis.DefectKind.CIRCUIT)
        patched.setattr(
            "linkwork.synthesis.defects.by_circuits._Search._change", lambda *_: changes
        )
        (undecided,) = task.defects_of(mechanism, inputs, point="C")
        assert undecided.message == "not proved: position 2 is at a change point"
    monkeypatch.setattr(ends, lambda _, branch, k: "change point" if k == 2 else "")
    (defect,) = task.defects_of(mechanism, inputs, point="C")
    assert defect.message == "not proved: position 3 is at a change point"


def test_a_position_at_a_change_point_is_not_decided_by_the_last_bit() -> None:
    # two branches pass all positions, and end at the second one, to rounding
    mechanism = lw.example("kempe-translator")
    circuits = mechanism.circuits(certify=False)
    inputs, places = _rows_near(circuits, "lower_bar", "E", 1.578, 1.4298474194765434, 36.34)
    task = lw.Task.path([(place.real, place.imag) for place in places])
    for more, decided in ((1e-10, True), (1e-6, True), (-1e-10, False), (-1e-6, False)):
        values = [inputs[0], inputs[1] + more, inputs[2]]
        found = [defect.message for defect in task.defects_of(mechanism, values, point="E")]
        assert found == [] if decided else ["not proved: position 2 is at a change point"]


def test_configurations_are_compared_where_one_unknown_is_exactly_zero() -> None:
    # the proof around the first one reaches no farther than 1e-25 in that unknown
    places = [(37.72045528047715, 19.869667231025673), (59.98628593851241, 0.04471367377968823)]
    inputs = (96.54463711240005, 0.107931768194817)
    task = lw.Task.path(places)
    assert task.defects_of(lw.example("parallelogram"), inputs, point="B") == ()


def test_an_unknown_point_is_named_with_its_neighbours() -> None:
    task = lw.Task.path([(0.0, 0.0), (1.0, 0.0)])
    with pytest.raises(lw.UnknownNameError, match=r'^there is no "C.x" \(nearest: '):
        task.defects_of(lw.example("four-bar"), (0, 10), point="C")


def test_nothing_is_said_of_a_way_to_a_change_point() -> None:
    model = lw.example("parallelogram").model
    drive, start = Drive.of_circuits(model), model.equations.start
    assert straight_way(drive, start, [np.pi / 3.0, 3.1]) is not None
    assert straight_way(drive, start, [np.pi / 3.0, 3.2]) is None


def test_inputs_are_finite_numbers() -> None:
    task = lw.Task.path([(0.0, 0.0), (1.0, 0.0)])
    with pytest.raises(lw.InputError, match=r"^the input of position 2 must be a finite number"):
        task.defects_of(lw.example("jansen-leg"), (0, float("nan")))


def test_branches_behind_change_points_are_followed_when_they_are_asked_for() -> None:
    model = lw.example("galloway").model
    explorer = explorer_of(Drive.of_circuits(model))
    circuit = FollowedCircuit(explorer, model.equations.start)
    first = next(circuit.branches())
    assert len(circuit.arcs) == 1
    assert len(list(circuit.branches())) == 4
    assert next(circuit.branches()) is first


def test_defects_are_found_without_all_circuits(monkeypatch: pytest.MonkeyPatch) -> None:
    leg = lw.example("klann-leg")
    (case, *_) = (case for case in library_cases(leg, 8, 3) if case.change is not None)
    traced = _traced(monkeypatch)
    assert judged_change(leg, case) == case.change
    # one of three circuits
    assert len(traced) == 1


def _traced(monkeypatch: pytest.MonkeyPatch) -> list[TracedCurve]:
    """A list that every curve is added to which is traced from now on."""
    traced: list[TracedCurve] = []

    def counted(*given: Any, **options: Any) -> TracedCurve:
        traced.append(trace_with_proof(*given, **options))
        return traced[-1]

    monkeypatch.setattr("linkwork.circuits.arcs.trace_with_proof", counted)
    return traced


def test_equal_inputs_of_different_places_need_different_configurations() -> None:
    bar = lw.example("four-bar")
    ways = bar.configurations(at=60)
    here, there = (ways[name].points["B"] for name in ("open", "crossed"))
    near = (here[0] + 1e-9, here[1])
    assert lw.Task.path([here, near]).defects_of(bar, (60, 60), point="B") == ()
    (defect,) = lw.Task.path([here, there]).defects_of(bar, (60, 60), point="B")
    assert defect.kind is lw.synthesis.DefectKind.CIRCUIT
    told = "^positions 1 and 3 differ, but have one input and one nearest configuration: correct"
    far = (here[0] + 5.0, here[1])
    with pytest.raises(lw.InputError, match=told):
        lw.Task.path([here, (0, 0), far]).defects_of(bar, (60, 70, 60), point="B")
