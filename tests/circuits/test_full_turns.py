"""Circuits along which the input turns fully: what traced curves give."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits import arcs as module, arcs as walks
from linkwork.circuits.branches import TracedCurve
from linkwork.core.numerics.system import SolvedRows
from tests.circuits.test_circuits import four_bar
from tests.library_mechanisms import read_example
from tests.oracles.four_bar import FourBar

FEW = ["four-bar", "slider-crank", "stephenson-far-crank"]
MORE = ["beam-engine", "cardan-circles", "cognate-1", "rapier-drive"]
NEAR = 1e-12


@pytest.fixture
def turned(monkeypatch: pytest.MonkeyPatch) -> list[TracedCurve | None]:
    """The whole turns that were looked for."""
    own, found = module.full_turn, []

    def seen(*arguments: Any) -> TracedCurve | None:
        found.append(own(*arguments))
        return found[-1]

    monkeypatch.setattr(walks, "full_turn", seen)
    return found


def described(found: lw.circuits.Circuits) -> list[object]:
    """All words, flags and counts of a list."""
    circuits = [
        (
            circuit.name,
            circuit.end,
            circuit.certified,
            circuit.turns,
            circuit.turning,
            [(b.name, b.configuration, b.certified, b.end) for b in circuit.branches],
            [(limit.kind, limit.located, limit.status) for limit in circuit.dead_points],
            [(limit.kind, limit.located, limit.status) for limit in circuit.change_points],
        )
        for circuit in found
    ]
    return [found.completeness, found.message, found.seeded, circuits]


def assert_same(one: lw.circuits.Circuits, other: lw.circuits.Circuits) -> None:
    assert described(one) == described(other)
    for a, b in zip(one, other, strict=True):
        slack = max(
            [abs(np.subtract(*limit.bracket)) for limit in (*a.dead_points, *a.change_points)],
            default=0.0,
        )
        ranges = [[own.input_range, *(x.input_range for x in own.branches)] for own in (a, b)]
        for here, there in zip(*ranges, strict=True):
            np.testing.assert_allclose(here, there, rtol=NEAR, atol=NEAR * 360.0 + slack)


@pytest.mark.parametrize(
    "name", FEW + [pytest.param(name, marks=pytest.mark.extended) for name in MORE]
)
def test_circuits_by_whole_turns_are_those_of_traced_curves(
    name: str, turned: list[TracedCurve | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    mechanism = read_example(name)
    with monkeypatch.context() as without:
        without.setattr(walks, "full_turn", lambda drive, start: None)
        plain = mechanism.circuits()
    assert not turned
    found = mechanism.circuits()
    assert turned
    assert_same(plain, found)
    # the positions shown do not depend on the way
    for one, other in zip(plain, found, strict=True):
        assert one.motion.branch == other.motion.branch
        for column in one.motion.unknowns:
            np.testing.assert_array_equal(one.motion[column], other.motion[column])


def test_a_crank_that_turns_is_proved_at_once_and_a_rocker_is_not(
    turned: list[TracedCurve | None],
) -> None:
    found = read_example("four-bar").circuits()
    assert all(circuit.certified for circuit in found)
    assert [turn is not None for turn in turned] == [True, True]
    turned.clear()
    rocker = four_bar(FourBar(3.0, 2.5, 2.0, 2.2), 1.0).circuits()  # no link turns
    assert rocker[0].dead_points
    assert rocker[0].certified
    assert turned
    assert not any(turned)


def test_a_curve_is_closed_only_if_its_last_position_is_proved_to_be_the_first(
    turned: list[TracedCurve | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = module._proved_rows

    def elsewhere(*arguments: Any) -> SolvedRows | None:
        rows = own(*arguments)
        assert rows is not None
        v = rows.v.copy()
        v[-1, 0] += rows.uniqueness_radius[0]
        return rows.with_columns(v=v)

    monkeypatch.setattr(module, "_proved_rows", elsewhere)
    found = read_example("four-bar").circuits()
    assert turned == [None, None]
    assert all(circuit.certified and circuit.closed for circuit in found)
