"""Positions on the circuits of any mechanism, so that all defects and none occur, with the verdict
that all circuits give.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

import linkwork as lw
from linkwork.circuits.results import Circuit, Circuits
from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.synthesis.defects.verdicts import DefectKind

__all__ = [
    "MECHANISMS",
    "JudgedCase",
    "branches_at",
    "judged_change",
    "library_cases",
    "library_defect_campaign",
]

#: The mechanisms of the library.
MECHANISMS = tuple(lw.examples())
_CASES = 24  # of a mechanism

_EQUAL = 1e-5  # of the longest path: points of two branches at one input that are no farther apart
_BEYOND = 1e-6  # more than a segment of a circuit: rows at its ends are rounded
_EDGE = 0.06  # of a branch's range of input: positions this near to its ends are left out

#: A kind of defect and the numbers of the positions it lies between.
Change = tuple[DefectKind, tuple[int, int]]


@dataclass(frozen=True, kw_only=True)
class JudgedCase:
    """Positions of a point, and the defect that all circuits show, if any."""

    point: str
    inputs: tuple[float, ...]
    places: tuple[complex, ...]
    change: Change | None


def judged_change(mechanism: lw.Mechanism, case: JudgedCase) -> Change | None:
    """The verdict on a case; ``NOT_PROVED`` and other kinds lie between no positions: (0, 0)."""
    places = [(place.real, place.imag) for place in case.places]
    found = lw.Task.path(places).defects_of(mechanism, case.inputs, point=case.point)
    return next(((defect.kind, defect.between or (0, 0)) for defect in found), None)


def library_defect_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """Counts by defect and false claims about one mechanism of the library."""
    name = MECHANISMS[part % len(MECHANISMS)]
    mechanism = lw.example(name)
    counts: Counter[str] = Counter()
    false: list[str] = []
    for case in library_cases(mechanism, _CASES, part):
        found = judged_change(mechanism, case)
        counts["neither" if found is None else found[0].value] += 1
        proved = found is None or found[0] is not DefectKind.NOT_PROVED
        if proved and found != case.change:
            what = f"{found}, by circuits {case.change}"
            false.append(f"part {part}, {name}, {case.point} at {case.inputs}: {what}")
    return counts, false


def library_cases(mechanism: lw.Mechanism, count: int, seed: int) -> Iterator[JudgedCase]:
    """Cases of 2 to 5 positions on one branch, on two of a circuit, on any two, or on any."""
    if not mechanism.description.inputs:
        return
    circuits = mechanism.circuits(certify=False)
    pieces = [
        (circuit, branch.name)
        for circuit in circuits
        for branch in circuit.branches
        if branch.end is not CircuitEnd.INPUT_CONSTANT and len(_inner(circuit, branch.name)[1])
    ]
    points = _points(mechanism, circuits)
    rng = np.random.default_rng([77, seed])
    for number in range(count if pieces and points else 0):
        point = points[int(rng.integers(len(points)))]
        first = pieces[int(rng.integers(len(pieces)))]
        others = [one for one in pieces if number % 4 != 1 or one[0] is first[0]]
        second = others[int(rng.integers(len(others)))] if number % 4 else first
        size, change = int(rng.integers(2, 6)), int(rng.integers(1, 5))
        chosen = [first if k < change else second for k in range(size)]
        if number % 4 == 3:
            chosen = [pieces[int(rng.integers(len(pieces)))] for _ in range(size)]
        rows = [(one[0], _row(*one, rng)) for one in chosen]
        inputs = tuple(float(c.motion.inputs[circuits.input][row]) for c, row in rows)
        places = tuple(complex(_place(c, point)[0][row]) for c, row in rows)
        if len(set(places)) < len(places):
            continue
        found = [
            branches_at(circuits, value, {point: place}, _EQUAL)
            for value, place in zip(inputs, places, strict=True)
        ]
        yield JudgedCase(
            point=point, inputs=inputs, places=places, change=_change_of_branches(found)
        )


def _points(mechanism: lw.Mechanism, circuits: Circuits) -> list[str]:
    """The traced points, or that which moves most."""
    traced = list(mechanism.description.trace)
    names = list(circuits[0].motion.points) if circuits else []
    moves = {name: float(np.ptp(_place(circuits[0], name)[0].real)) for name in names}
    return traced or sorted(names, key=lambda name: -moves[name])[:1]


def _inner(circuit: Circuit, branch: str) -> tuple[Array, IndexArray]:
    """The inputs of a circuit, and its rows on a branch away from the branch's ends."""
    along = next(iter(circuit.motion.inputs.values()))
    rows = np.flatnonzero(np.array(circuit.motion.branch) == branch)
    low, high = along[rows].min(), along[rows].max()
    edge = _EDGE * (high - low)
    inside = (along[rows] > low + edge) & (along[rows] < high - edge)
    return along, rows[inside]


def _row(circuit: Circuit, branch: str, rng: np.random.Generator) -> int:
    """A row of a branch, at any of its inputs with equal probability."""
    along, rows = _inner(circuit, branch)
    value = rng.uniform(along[rows].min(), along[rows].max())
    return int(rows[np.abs(along[rows] - value).argmin()])


def _place(circuit: Circuit, point: str) -> tuple[ComplexArray, ComplexArray]:
    """A point along a circuit and its derivative by the input in radians or lengths."""
    x, y = (circuit.motion.series(f"{point}.{axis}") for axis in "xy")
    return x.value + 1j * y.value, x.first + 1j * y.first


def _change_of_branches(found: Sequence[set[str]]) -> Change | None:
    """The first change, if no branch passes all positions; ``found``: the branches at each."""
    branches = found[0]
    for number, (_, there) in enumerate(pairwise(found), start=1):
        if not branches & there:
            joined = {_circuit(name) for name in branches} & {_circuit(name) for name in there}
            kind = DefectKind.BRANCH if joined else DefectKind.CIRCUIT
            return kind, (number, number + 1)
        branches = branches & there
    return None


def _circuit(branch: str) -> str:
    return branch.partition(" branch")[0]


def branches_at(
    circuits: Circuits, value: float, places: Mapping[str, complex], within: float
) -> set[str]:
    """The branches that come nearest to places at an input; more than one if they come equally
    near, to this part of the longest path.
    """
    found = [
        miss for circuit in circuits for miss in _misses(circuit, circuits.input, value, places)
    ]
    # a point may rest on one branch
    allowed = within * max((way for _, way, _ in found), default=0.0)
    least = min((missed for missed, _, _ in found), default=np.inf)
    return {name for missed, _, name in found if missed <= least + allowed}


def _misses(
    circuit: Circuit, name: str, value: float, places: Mapping[str, complex]
) -> Iterator[tuple[float, float, str]]:
    """How far points are from places where a circuit has an input, the length of their paths, and
    the branch.
    """
    motion = circuit.motion
    along, branch = np.asarray(motion.inputs[name]), np.array(motion.branch)
    unit = {"deg": np.pi / 180.0}.get(motion.input_units[name], 1.0)
    turn = {"deg": 360.0, "rad": 2.0 * np.pi}.get(motion.input_units[name], 0.0)
    begin, end = along[:-1], along[1:]
    passing = np.flatnonzero((branch[:-1] == branch[1:]) & (begin != end))
    begin, end = begin[passing], end[passing]
    shift = np.round((0.5 * (begin + end) - value) / (turn or np.inf)) * turn
    t = (value + shift - begin) / (end - begin)
    inside = (t >= -_BEYOND) & (t <= 1.0 + _BEYOND)
    passing, at = passing[inside], (value + shift)[inside]
    missed, way = np.zeros(len(passing)), 0.0
    for point, place in places.items():
        z, slope = _place(circuit, point)
        dead = np.isnan(slope)
        for k, row in enumerate(passing.tolist()):
            here = slice(row, row + 2)
            own = along[dead & (branch == branch[row])]
            missed[k] += abs(_between(along[here], z[here], unit * slope[here], own, at[k]) - place)
        way += float(np.abs(np.diff(z)).sum())
    for k, row in enumerate(passing.tolist()):
        yield float(missed[k]), way, str(branch[row])


def _between(
    inputs: Array, z: ComplexArray, slope: ComplexArray, singular: Array, at: float
) -> complex:
    """A place between two rows by Hermite's cubic, in the square root of the distance from the
    nearest input without rates, a dead point; a line in it from there on.
    """
    w, now, rate = inputs, at, slope
    origins = singular[(singular - inputs[0]) * (singular - inputs[1]) >= 0.0]
    if len(origins):
        origin = origins[np.abs(origins - inputs.mean()).argmin()]
        w, now = np.sqrt(np.abs(inputs - origin)), np.sqrt(abs(at - origin))
        rate = slope * 2.0 * w * np.sign(inputs.mean() - origin)
    change, step = z[1] - z[0], w[1] - w[0]
    t = (now - w[0]) / step if step else 0.0
    ahead, behind = rate[0] * step - change, change - rate[1] * step
    bend = t * (1.0 - t) * (ahead * (1.0 - t) + behind * t)
    return complex(z[0] + t * change + np.nan_to_num(bend))
