"""Circuit and branch defects of mechanisms of any kind, against all of their circuits."""

from __future__ import annotations

from typing import Any

import pytest

import linkwork as lw
from linkwork.motion.circuit.followed_circuit import FollowedCircuit, explorer_of, straight_way
from linkwork.motion.curve_branches import TracedCurve, trace_boldly
from linkwork.motion.drive import Drive
from tests.campaigns import library_defects
from tests.campaigns.library_defects import judged_change, library_cases

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
    assert (defect.kind, defect.between) == (lw.DefectKind.NOT_PROVED, None)
    assert defect.message == "not proved: position 2 is at a dead point"


def test_an_input_that_no_position_has_is_out_of_range() -> None:
    rocker = lw.example("chebyshev")
    places = [*_at(rocker, "P", 60, 70), (0.0, 0.0)]
    (defect,) = lw.Task.path(places).defects_of(rocker, (60, 70, 150), point="P")
    assert defect.kind is lw.DefectKind.RANGE
    assert defect.message == "no position of the mechanism has the input of position 3"


def test_a_position_off_the_only_known_circuit_is_not_decided() -> None:
    slot = lw.example("curved-slot")
    places = [*_at(slot, "B", 40, 90)]
    assert lw.Task.path(places).defects_of(slot, (40, 90), point="B") == ()
    places[1] = places[1][0] + 1e-3, places[1][1]
    (defect,) = lw.Task.path(places).defects_of(slot, (40, 90), point="B")
    assert defect.kind is lw.DefectKind.NOT_PROVED
    assert defect.message == (
        "not proved: position 2 is not on the circuit of the guess, and the configurations of "
        "these equations cannot be listed"
    )


def test_the_straight_way_ends_at_a_dead_point() -> None:
    model = lw.example("chebyshev").model
    drive, start = Drive.of_circuits(model), model.equations.start
    assert straight_way(drive, start, [0.7, 1.7]) is not None
    assert straight_way(drive, start, [0.7, 1.8]) is None


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
    traced: list[TracedCurve] = []

    def counted(*given: Any, **options: Any) -> TracedCurve:
        traced.append(trace_boldly(*given, **options))
        return traced[-1]

    monkeypatch.setattr("linkwork.motion.circuit.walks.trace_boldly", counted)
    assert judged_change(leg, case) == case.change
    # one of three circuits
    assert len(traced) == 1
