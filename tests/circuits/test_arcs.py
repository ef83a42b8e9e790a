"""Arcs between change points, followed with proofs of dead points and without."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.arcs import Explorer, is_regular
from linkwork.circuits.assembling import positions_at
from linkwork.circuits.circuit_sweep import explorer_of
from linkwork.core.foundation.arrays import Array
from linkwork.core.motion.following import Drive
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
    """All arcs, with dead points proved, and without."""
    drive = Drive.of_circuits(mechanism.model)
    seeds = _seeds(drive)
    proved, plain = Explorer(drive, certify=False), explorer_of(drive)
    return _visited(proved, seeds), _visited(plain, seeds)


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
def test_arcs_are_those_of_proved_dead_points(name: str) -> None:
    proved, plain = _both(lw.example(name))
    assert len(plain.crossings) > 1
    assert _arcs(plain) == _arcs(proved)


@pytest.mark.parametrize("offsets", [(0.01,), (0.1, 0.01), (0.03, 0.01)])
def test_change_points_near_each_other_are_told_apart(offsets: tuple[float, ...]) -> None:
    """A branch that lies next to the tangent of the second one meets the first one before."""
    sizes = [(2.8, 1.2), (1.3, 2.9), (3.5, 1.3)]
    loops = [
        Loop(ground, crank, ground, crank, offset, -1.0)
        for (ground, crank), offset in zip(sizes, (0.0, *offsets), strict=False)
    ]
    proved, plain = _both(train(loops, (30.0, 390.0, 10.0)))
    # two arcs for every change point: four half-branches leave each
    assert len(plain.arcs) == 2 * len(plain.crossings) > 4
    assert _arcs(plain) == _arcs(proved)


def test_blocks_that_cross_nearly_together_are_told_apart() -> None:
    loops = [
        Loop(2.0, 1.8, 2.0, 1.8, side=-1.0),
        Loop(2.9, 2.7, 2.9, 2.7, 0.1, -1.0),
        Loop(2.2, 3.1, 1.1, 4.2, -0.01, -1.0),
    ]
    proved, plain = _both(train(loops, (30.0, 390.0, 10.0)))
    assert _arcs(plain) == _arcs(proved)


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
