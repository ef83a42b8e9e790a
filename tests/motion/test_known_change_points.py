"""Circuits that end at change points located before are those of change points located anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.arcs import Explorer, is_regular
from linkwork.circuits.assembling import positions_at
from linkwork.circuits.followed_circuit import explorer_of
from linkwork.core.foundation.arrays import Array
from linkwork.core.motion.following import Drive
from linkwork.core.numerics import curve_tracing as curve_crossing
from linkwork.core.numerics.change_point import Crossing
from tests.oracles.trains import Loop, train

_ONE_CROSSES = ("galloway", "toggle-press", "beam-engine")
_SEVERAL_CROSS = ("scissor-lift", "peaucellier")


def _seeds(drive: Drive) -> list[Array]:
    """The configurations at three inputs, the guess's among them, at which these can lead."""
    value, scale = float(drive.model.start_inputs[drive.lead]), drive.path.size
    inputs = [drive.path.at(value + off * scale) for off in (0.0, 0.37, -1.1)]
    found = [v for at in inputs for v in positions_at(drive.model, at).v]
    return [v for v in found if is_regular(drive.leads, v)]


def _visited(explorer: Explorer, seeds: list[Array]) -> Explorer:
    for v in seeds:
        explorer.visit(v)
    return explorer


def _both(mechanism: lw.Mechanism) -> tuple[Explorer, Explorer]:
    """All arcs, with every change point located anew, and with those that are known."""
    drive = Drive.of_circuits(mechanism.model)
    seeds = _seeds(drive)
    anew, known = Explorer(drive, certify=False), explorer_of(drive)
    return _visited(anew, seeds), _visited(known, seeds)


def _places(explorer: Explorer, arc: Any) -> list[list[float]]:
    """The change points at the ends of an arc, whole turns aside."""
    leads = explorer.leads
    ends = np.array([explorer.crossings[c].v for c in arc.crossings]).reshape(-1, len(leads.scale))
    turned = np.where(leads.is_angle, np.exp(1j * ends), ends / leads.scale)
    both = np.concatenate([turned.real, turned.imag], axis=1)
    return sorted((np.round(both, 5) + 0.0).tolist())


def _arcs(explorer: Explorer) -> list[Any]:
    """Ends and spans of all arcs."""
    p = explorer.leads.parameter
    return sorted(
        [
            _places(explorer, arc),
            sorted(round(b.range(p)[1] - b.range(p)[0], 5) for b in arc.branches),
        ]
        for arc in explorer.arcs
    )


@pytest.mark.parametrize("name", [*_ONE_CROSSES, *_SEVERAL_CROSS])
def test_arcs_are_those_of_change_points_located_anew(name: str) -> None:
    anew, known = _both(lw.example(name))
    assert len(known.crossings) > 1
    assert _arcs(known) == _arcs(anew)


@pytest.mark.parametrize("name", ["toggle-press", "beam-engine"])
def test_a_change_point_is_located_once(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    located: list[Crossing | None] = []
    locate = curve_crossing.crossing_beyond

    def counted(*given: Any) -> Crossing | None:
        located.append(locate(*given))
        return located[-1]

    monkeypatch.setattr("linkwork.core.numerics.curve_tracing.crossing_beyond", counted)
    drive = Drive.of_circuits(lw.example(name).model)
    explorer = _visited(explorer_of(drive), _seeds(drive))
    assert sum(one is not None for one in located) == len(explorer.crossings)


@pytest.mark.parametrize("offsets", [(0.01,), (0.1, 0.01), (0.03, 0.01)])
def test_change_points_near_each_other_are_told_apart(offsets: tuple[float, ...]) -> None:
    """A branch that lies next to the tangent of the second one meets the first one before."""
    sizes = [(2.8, 1.2), (1.3, 2.9), (3.5, 1.3)]
    loops = [
        Loop(ground, crank, ground, crank, offset, -1.0)
        for (ground, crank), offset in zip(sizes, (0.0, *offsets), strict=False)
    ]
    anew, known = _both(train(loops, (30.0, 390.0, 10.0)))
    # two arcs for every change point: four half-branches leave each
    assert len(known.arcs) == 2 * len(known.crossings) > 4
    assert _arcs(known) == _arcs(anew)


def test_a_leader_without_a_change_point_is_avoided_once() -> None:
    loops = [
        Loop(2.0, 1.8, 2.0, 1.8, side=-1.0),
        Loop(2.9, 2.7, 2.9, 2.7, 0.1, -1.0),
        Loop(2.2, 3.1, 1.1, 4.2, -0.01, -1.0),
    ]
    anew, known = _both(train(loops, (30.0, 390.0, 10.0)))
    assert _arcs(known) == _arcs(anew)


def test_arcs_on_which_redundant_links_do_not_fit_are_not_followed() -> None:
    drive = Drive.of_circuits(lw.example("dixon-two").model)
    explorer = _visited(Explorer(drive, certify=False), _seeds(drive))
    assert len(explorer.arcs) > 4
    assert all(explorer.fits(arc) for arc in explorer.arcs)


def test_configurations_that_do_not_fit_are_not_built_on() -> None:
    model = lw.example("dixon-two").model
    found = positions_at(model, model.start_inputs)
    assert len(found.v) == 2
    # positions of the last of nine dyads on 2 combinations of the others, not on all 32
    assert found.paths[-1].real == 4
