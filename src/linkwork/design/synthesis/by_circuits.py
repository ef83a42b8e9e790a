"""Circuit and branch defects of a mechanism of any kind, from its proved circuits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from linkwork.design.synthesis.defect_messages import Defect
from linkwork.design.synthesis.verdicts import DefectKind
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.results.circuits import Circuit, Circuits
from linkwork.results.motion import Motion

__all__ = ["branches_of_positions", "defects_by_circuits", "is_passed"]

# more than a segment of a circuit: rows at its ends are rounded
_BEYOND = 1e-6
# of a point's way: cubics between rows miss a position of the branch by less, and other branches
# are farther away, unless the input is nearer than the square of this to a dead point
_MISSED = 1e-6

#: Places of some points, which together tell the branches of a mechanism apart [length].
Places = Mapping[str, complex]


def defects_by_circuits(
    circuits: Circuits, inputs: Sequence[float], places: Sequence[Places]
) -> tuple[Defect, ...]:
    """The circuit or branch defect of a mechanism that passes positions; none if it has neither.

    Parameters
    ----------
    circuits : Circuits
        All circuits of the mechanism.
    inputs : sequence of float
        The leading input at the positions [file units].
    places : sequence of Mapping[str, complex]
        Places of points at the positions.
    """
    branches = branches_of_positions(circuits, inputs, places)
    for number, (one, other) in enumerate(pairwise(branches), start=1):
        between = number, number + 1
        if _circuit(one) != _circuit(other):
            message = f"circuit changes between positions {number} and {number + 1}"
            return (Defect(kind=DefectKind.CIRCUIT, between=between, message=message),)
        if one != other:
            message = f"branch changes between positions {number} and {number + 1}"
            return (Defect(kind=DefectKind.BRANCH, between=between, message=message),)
    return ()


def is_passed(motion: Motion, inputs: Sequence[float], places: Sequence[Places]) -> bool:
    """Whether a motion on one branch, found in all rows, passes positions as exactly as can be told
    from its rows. Then the mechanism has no defect, whatever its other circuits.

    ``motion``: rows from the least input to the greatest; ``inputs``, ``places``: as for
    :func:`defects_by_circuits`.
    """
    if len(motion) < 2 or not motion.found.all() or len(set(motion.branch)) > 1:
        return False
    name, along = next(iter(motion.inputs.items()))
    row = np.clip(np.searchsorted(along, inputs) - 1, 0, len(along) - 2)
    step = along[row + 1] - along[row]
    t = (np.asarray(inputs) - along[row]) / step
    step = step * {"deg": np.pi / 180.0}.get(motion.input_units[name], 1.0)
    for point in places[0]:
        x, y = motion.series(f"{point}.x"), motion.series(f"{point}.y")
        z, slope = x.value + 1j * y.value, x.first + 1j * y.first
        # Hermite's cubic between rows
        change = z[row + 1] - z[row]
        begin, end = slope[row] * step - change, change - slope[row + 1] * step
        there = z[row] + t * (change + (1.0 - t) * (begin * (1.0 - t) + end * t))
        missed = np.abs(there - [place[point] for place in places]).max()
        if not missed <= _MISSED * np.abs(np.diff(z)).sum():
            return False
    return True


def branches_of_positions(
    circuits: Circuits, inputs: Sequence[float], places: Sequence[Places]
) -> list[str]:
    """The branch that comes nearest to each position at its input, ``circuit 1 branch 2``; "" if
    none has this input.
    """
    found = []
    for value, here in zip(inputs, places, strict=True):
        distances = [_nearest(circuit, circuits.input, value, here) for circuit in circuits]
        found.append(min(distances, default=(np.inf, ""))[1])
    return found


def _circuit(branch: str) -> str:
    return branch.partition(" branch")[0]


def _nearest(circuit: Circuit, name: str, value: float, places: Places) -> tuple[float, str]:
    """The smallest distance of the points on a circuit from their places, and the branch there."""
    motion = circuit.motion
    along, branch = np.asarray(motion.inputs[name]), np.array(motion.branch)
    turn = {"deg": 360.0, "rad": 2.0 * np.pi}.get(motion.input_units[name], 0.0)
    begin, end = along[:-1], along[1:]
    passing = np.flatnonzero((branch[:-1] == branch[1:]) & (begin != end))
    begin, end = begin[passing], end[passing]
    shift = np.round((0.5 * (begin + end) - value) / turn) * turn if turn else 0.0
    share = (value + shift - begin) / (end - begin)
    inside = (share >= -_BEYOND) & (share <= 1.0 + _BEYOND)
    passing, share = passing[inside], share[inside]
    if not passing.size:
        return np.inf, ""
    missed = np.zeros(len(passing))
    for point, place in places.items():
        x, y = (_between(np.asarray(motion[f"{point}.{axis}"]), passing, share) for axis in "xy")
        missed += np.hypot(x - place.real, y - place.imag)
    best = int(missed.argmin())
    return float(missed[best]), str(branch[passing[best]])


def _between(values: Array, rows: IndexArray, share: Array) -> Array:
    """Values between rows and the next ones."""
    return np.asarray(values[rows] + share * (values[rows + 1] - values[rows]))
