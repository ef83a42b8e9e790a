"""Branches and circuits of positions, from the circuits of a mechanism of any kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.circuits import Circuit, Circuits

__all__ = ["branch_of_position", "branches_of_positions"]


def branches_of_positions(
    circuits: Circuits, inputs: Sequence[float], points: Sequence[Mapping[str, complex]]
) -> list[str]:
    """The branch of every position, ``circuit 1 branch 2``; "" if no branch passes it.

    Parameters
    ----------
    circuits : Circuits
        All circuits of the mechanism.
    inputs : sequence of float
        The leading input at the positions [file units].
    points : sequence of mappings
        Places of some points at the positions, enough to tell its branches apart [length].
    """
    return [
        branch_of_position(circuits, value, places)
        for value, places in zip(inputs, points, strict=True)
    ]


def branch_of_position(circuits: Circuits, value: float, places: Mapping[str, complex]) -> str:
    """The branch whose positions at an input value come nearest to some places of points."""
    nearest = (np.inf, "")
    for circuit in circuits:
        nearest = min(nearest, _nearest(circuit, circuits.input, value, places))
    return nearest[1]


def _nearest(
    circuit: Circuit, name: str, value: float, places: Mapping[str, complex]
) -> tuple[float, str]:
    """The smallest distance of the points on a circuit from their places, and the branch there."""
    motion = circuit.motion
    along, branch = motion.inputs[name], np.array(motion.branch)
    turn = circuit_turn(circuit, name)
    miss = np.full(len(along) - 1, np.inf)
    begin, end = along[:-1], along[1:]
    same = (branch[:-1] == branch[1:]) & (begin != end)
    shift = np.round((0.5 * (begin + end) - value) / turn) * turn if turn else 0.0
    with np.errstate(all="ignore"):
        share = (value + shift - begin) / (end - begin)
    # a little more than the segment: rows at its ends are rounded
    inside = same & (share >= -1e-6) & (share <= 1.0 + 1e-6)
    total = np.zeros(len(miss))
    for point, place in places.items():
        x, y = (np.asarray(motion[f"{point}.{axis}"]) for axis in "xy")
        total += np.abs(_between(x, share) + 1j * _between(y, share) - place)
    miss = np.where(inside, total, np.inf)
    best = int(miss.argmin())
    return float(miss[best]), str(branch[best])


def circuit_turn(circuit: Circuit, name: str) -> float:
    """A whole turn of the leading input in file units; 0 for a length."""
    unit = circuit.motion.input_units[name]
    return {"deg": 360.0, "rad": 2.0 * np.pi}.get(unit, 0.0)


def _between(values: Array, share: Array) -> Array:
    return np.asarray(values[:-1] + share * (values[1:] - values[:-1]))
