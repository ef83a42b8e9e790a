"""Random goals of the library's mechanisms, and whether designs called sound pass their table.

The referee is the list of all circuits: a branch at the design's first position reaches from the
first input of the table to the last.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

import linkwork as lw
from linkwork.core.foundation.errors import LinkworkError
from linkwork.core.results.motion import Motion
from tests.campaigns.library_defects import MECHANISMS, branches_at

__all__ = ["goal_campaign"]

_STARTS, _SPREAD = 3, 0.1
_MET = 1e-9  # of the wanted value
_SAME = 1e-10  # of the wanted value, the miss or the file unit
_EQUAL = 1e-5  # of the longest path: branches that are no farther apart
_ROUNDING = 1e-9  # of the ends of branches [file units]


def goal_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """One goal of one mechanism."""
    name, rng = MECHANISMS[part % len(MECHANISMS)], np.random.default_rng([91, part])
    bar = lw.example(name)
    try:
        motion = bar.sweep(certify=False)
    except LinkworkError:
        return Counter({"without a motion": 1}), []
    calls = list(_calls(motion))
    if not motion.found.all() or bar.description.timed or len(motion.inputs) > 1 or not calls:
        return Counter({"without a whole motion": 1}), []
    of = calls[int(rng.integers(len(calls)))]
    target = motion.value(of) * float(rng.uniform(0.6, 1.5))
    counts: Counter[str] = Counter(goals=1)
    try:
        designs = lw.synthesis.improve(
            bar, {"of": of, "target": target}, starts=_STARTS, spread=_SPREAD, seed=part
        )
    except LinkworkError:
        return Counter({"without a number that varies": 1}), []
    false = []
    for design in designs:
        counts["met" if design.largest <= _MET * abs(target) else "not met"] += 1
        if not design.sound:
            counts["not sound"] += 1
            continue
        counts["sound"] += 1
        told, motion = design.goals[of], lw.Mechanism(design.description).sweep()
        if not abs(told - abs(motion.value(of) - target)) <= _SAME * max(1.0, abs(target), told):
            false.append(f"part {part}: {name}, {of} = {target!r}, not missed by {told!r}")
        if not _passes(lw.Mechanism(design.description)):
            numbers = dict(design.numbers)
            false.append(f"part {part}: {name}, {of} = {target!r} ends in between: {numbers}")
    return counts, false


def _calls(motion: Motion) -> Iterator[str]:
    for name in motion.unknowns:
        yield from (f"{word}({name})" for word in ("stroke", "max", "min"))
    for point in motion.points:
        if np.ptp(motion.trace(point).real) > 0.0:
            yield from (f"stroke({point}.x)", f"max({point}.y)", f"path_length({point})")


def _passes(bar: lw.Mechanism) -> bool:
    motion, circuits = bar.sweep(), bar.circuits()
    along = motion.inputs[circuits.input]
    turn = {"deg": 360.0, "rad": 2.0 * np.pi}.get(motion.input_units[circuits.input], 0.0)
    places = {point: complex(motion.trace(point)[0]) for point in motion.points}
    here = branches_at(circuits, float(along[0]), places, _EQUAL)
    low, high = float(along.min()), float(along.max())
    for circuit in circuits:
        for branch in circuit.branches:
            begin, end = branch.input_range
            around = bool(turn) and end - begin >= turn - _ROUNDING
            shift = np.round((0.5 * (begin + end - low - high)) / (turn or np.inf)) * turn
            within = begin - _ROUNDING <= low + shift and high + shift <= end + _ROUNDING
            if branch.name in here and (around or within):
                return True
    return False
