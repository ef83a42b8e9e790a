"""KinePy: solids and pins, groups solved for all rows at once in NumPy."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from importlib import import_module
from itertools import product
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage
from benchmarks.peers.peer import DyadPeer, Prepared
from benchmarks.peers.work import Work

__all__ = ["KinepyGroups"]


class KinepyGroups(DyadPeer):
    """``System.solve_kinematics``; its signs of groups are tried beforehand."""

    name = "kinepy"
    distribution = "kinepy"
    module = "kinepy"
    most_members = 200

    def prepare(self, work: Work) -> Prepared:
        with contextlib.redirect_stdout(io.StringIO()):  # it reports how it compiles
            built = [_system(member, work) for member in work.dyads]
        inputs = work.inputs.reshape(1, -1)

        def run() -> list[Any]:
            for system, _ in built:
                system.solve_kinematics(inputs.copy())  # it scales its argument in place
            return [traced() for _, traced in built]

        def read(points: list[Any]) -> ComplexArray:
            return np.array([np.asarray(x) + 1j * np.asarray(y) for x, y in points])

        return Prepared(run=run, read=read)


def _system(linkage: DyadLinkage, work: Work) -> tuple[Any, Any]:
    """The system on the right branch, and a function that gives the traced point."""
    system = import_module("kinepy").System()
    at = {name: complex(p.reshape(-1)[0]) for name, p in linkage.positions(work.inputs[:1]).items()}
    pivot = at[linkage.pivot]
    where: dict[str, tuple[Any, tuple[float, float]]] = {
        name: (system.ground, (at[name].real, at[name].imag)) for name in linkage.ground
    }
    crank = system.add_solid("crank")
    driven = system.add_revolute(system.ground, crank, (pivot.real, pivot.imag), (0.0, 0.0))
    where[linkage.pin] = (crank, (float(linkage.radius), 0.0))
    bars: dict[frozenset[str], tuple[Any, str]] = {}
    for dyad in linkage.dyads:
        if dyad.rigid:  # a further point of the bar between the other two
            solid, base = bars[frozenset((dyad.first, dyad.second))]
            end = dyad.second if base == dyad.first else dyad.first
            local = (at[dyad.point] - at[base]) / (at[end] - at[base]) * abs(at[end] - at[base])
            where[dyad.point] = (solid, (local.real, local.imag))
            continue
        ends = []
        for base, length in ((dyad.first, dyad.first_length), (dyad.second, dyad.second_length)):
            bar = system.add_solid(f"{base} {dyad.point}")
            carrier, local_point = where[base]
            system.add_revolute(carrier, bar, local_point, (0.0, 0.0))
            bars[frozenset((base, dyad.point))] = (bar, base)
            ends.append((bar, (float(length), 0.0)))
        (one, end_one), (other, end_other) = ends
        system.add_revolute(one, other, end_one, end_other)
        where[dyad.point] = ends[1]
    system.pilot(driven)
    system.compile()
    solid, local_point = where[linkage.traced]

    def traced() -> Any:
        return solid.get_point(local_point)

    _choose_signs(system, traced, linkage, work.inputs)
    return system, traced


def _choose_signs(
    system: Any, traced: Callable[[], Any], linkage: DyadLinkage, inputs: Array
) -> None:
    """The signs whose rows are nearest to the right ones in the middle; single rows may fail."""
    groups = sum(not dyad.rigid for dyad in linkage.dyads)
    wanted = linkage.positions(inputs)[linkage.traced]
    gaps = {}
    for signs in product((1, -1), repeat=groups):
        system.change_signs(list(signs))
        system.solve_kinematics(inputs.reshape(1, -1).copy())
        x, y = traced()
        gaps[signs] = float(np.nanmedian(np.abs(x + 1j * y - wanted)))
    best, _ = min(gaps.items(), key=lambda item: item[1])
    system.change_signs(list(best))
