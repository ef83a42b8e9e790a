"""The circuits of a mechanism as an event, with a page of their motions."""

from __future__ import annotations

from linkwork.results.circuits import Branch, Circuit, Circuits
from linkwork.results.motion import Motion
from linkwork.viewer.live import events as tell
from linkwork.viewer.live.result_events import limit_found
from linkwork.viewer.page_building import motion_page

__all__ = ["circuits_found"]


def circuits_found(circuits: Circuits, motion: Motion | None) -> tell.CircuitsFound:
    """All circuits; ``motion`` is that of the file."""
    here = set() if motion is None else set(motion.branch) - {""}
    drawn = {c.name: c.motion for c in circuits if c.motion.points and c.motion.found.any()}
    return tell.CircuitsFound(
        input=circuits.input,
        input_unit=circuits.input_unit,
        circuits=tuple(_circuit(circuit, circuits, here) for circuit in circuits),
        message=circuits.message,
        page=motion_page(drawn) if drawn else None,
    )


def _circuit(circuit: Circuit, circuits: Circuits, here: set[str]) -> tell.CircuitFound:
    limits = (*circuit.dead_points, *circuit.change_points)
    names = {circuit.name, *(branch.name for branch in circuit.branches)}
    return tell.CircuitFound(
        name=circuit.name,
        current=not here.isdisjoint(names),
        end=circuit.end.story,
        certified=circuit.certified,
        input_range=circuit.input_range,
        turns=circuit.turns,
        limits=tuple(limit_found(one, circuits.input, circuits.input_unit) for one in limits),
        branches=tuple(map(_branch, circuit.branches)),
    )


def _branch(branch: Branch) -> tell.BranchFound:
    return tell.BranchFound(
        name=branch.name,
        start=branch.configuration or branch.name,
        input_range=branch.input_range,
        certified=branch.certified,
    )
