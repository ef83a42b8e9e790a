"""Transmission angles and obstacles between the rows of the library, against rows 100 times finer.

Obstacles are circles that links nearly touch: their radii are the least distance in the finer rows
more or less a part of the longest link, from a tenth to a ten-millionth.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkwork import Mechanism
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.results.motion import Motion
from linkwork.synthesis.improvement.proved_design import Contact, WholeMotion
from tests.library_mechanisms import driven_examples, read_example

__all__ = ["EVERY", "distances", "whole_motion_campaign"]

#: All driven mechanisms of the library.
EVERY = len(driven_examples())

_FINER = 100
_COARSER = (1.0, 2.0, 5.0, 10.0)  # than the table of the file
_OBSTACLES = 40
_ANGLE = 1e-6  # rad: between the bounds of the least angle, and what finer rows miss of it
_ROUNDING = 1e-11  # of the longest link, or rad


@dataclass(frozen=True)
class _Case:
    """A mechanism in rows, and the same in finer ones."""

    name: str
    mechanism: Mechanism
    whole: WholeMotion
    fine: Motion

    @property
    def sides(self) -> list[tuple[str, str]]:
        """The lines between two points of every moving link."""
        description = self.mechanism.model.description
        links = description.links if isinstance(description, Draft) else {}
        return [s for name, own in links.items() if name != GROUND for s in combinations(own, 2)]

    def distance(self, motion: Motion, centre: complex) -> float:
        """The least distance of all sides from a point in the rows of a motion."""
        return distances([(motion.trace(p), motion.trace(q)) for p, q in self.sides], centre)


def distances(sides: Sequence[tuple[ComplexArray, ComplexArray]], centre: complex) -> float:
    """The least distance of sides between points in rows from a centre."""
    return min(float(_from_side(a - centre, b - centre).min()) for a, b in sides)


def _from_side(a: ComplexArray, b: ComplexArray) -> Array:
    """The distances of sides between a and b from the origin, by three cases."""
    ends = np.minimum(np.abs(a), np.abs(b))
    length = np.abs(b - a)
    with np.errstate(all="ignore"):
        along = ((b - a).conj() * -a).real / length
        line = np.abs(((b - a).conj() * a).imag) / length
    return np.asarray(np.where((along > 0.0) & (along < length), line, ends))


def _case(part: int, rng: np.random.Generator) -> _Case | None:
    """A mechanism of one input whose rows are all proved, and which no law of time drives."""
    name = driven_examples()[part % EVERY]
    mechanism = read_example(name)
    model = mechanism.model
    if model.untimed is not None or len(model.rows) < 2 or len(model.equations.inputs) > 1:
        return None
    table = model.rows_in_file_units[:, 0]
    step = float(rng.choice(_COARSER)) * (table[1] - table[0])
    motion = mechanism.sweep(step=step)
    whole = WholeMotion.of(model, motion)
    if whole is None:
        return None
    # the last row of the file may lie beyond that of a coarser table
    last = float(next(iter(motion.inputs.values()))[-1])
    fine = mechanism.sweep(from_=float(table[0]), to=last, step=step / _FINER, certify=False)
    return _Case(name, mechanism, whole, fine)


def whole_motion_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of one mechanism with random obstacles."""
    counts: Counter[str] = Counter()
    rng = np.random.default_rng([28, part])
    case = _case(part, rng)
    if case is None:
        counts["mechanisms of several inputs, in time, or with rows not proved"] += 1
        return counts, []
    counts["mechanisms"] += 1
    false = [*_angle_claims(case, counts)]
    if case.sides:
        for _ in range(_OBSTACLES):
            false += _obstacle_claims(case, rng, counts)
    return counts, [f"part {part}, {case.name}: {claim}" for claim in false]


def _angle_claims(case: _Case, counts: Counter[str]) -> Iterator[str]:
    if not case.whole.dyads:
        return
    turn = case.mechanism.model.description.angle.turn
    seen = min(
        float(np.minimum(a, turn / 2.0 - a).min())
        for a in (case.fine[f"{dyad.pin}.transmission"] for dyad in case.whole.dyads)
    )
    angle = seen * 2.0 * np.pi / turn
    found = case.whole.least_transmission(0.0)
    counts["least transmission angles"] += 1
    if found.low > angle + _ROUNDING:
        yield f"the least transmission angle is {angle}, proved to be {found.low} or more"
    if found.high - found.low > _ANGLE:
        counts["least transmission angles that are not close"] += 1
    if angle > found.high + _ANGLE:
        yield f"a transmission angle is {angle} or more in all rows, found to be {found.high}"
    # just below it is proved, just above it is refused
    for wanted in (found.low - 1e-7, found.high + 1e-7):
        asked = case.whole.least_transmission(wanted)
        if (asked.low >= wanted) is not (wanted < found.low):
            yield f"asked for {wanted} it is {asked.low} to {asked.high}"


def _obstacle_claims(case: _Case, rng: np.random.Generator, counts: Counter[str]) -> Iterator[str]:
    paths = np.concatenate([case.fine.trace(p) for side in case.sides for p in side])
    size = case.mechanism.model.equations.length_scale
    low, high = paths.real.min() - 0.2 * size, paths.real.max() + 0.2 * size
    below, above = paths.imag.min() - 0.2 * size, paths.imag.max() + 0.2 * size
    centre = complex(rng.uniform(low, high), rng.uniform(below, above))
    gap = size * 10 ** rng.uniform(-7.0, -1.0) * rng.choice([-1.0, 1.0])
    seen = case.distance(case.fine, centre)
    radius = seen - gap
    if radius <= 0.0:
        return
    found = case.whole.contact(case.sides, np.array([[centre.real, centre.imag, radius]]))
    counts[f"obstacles {_told(found)}"] += 1
    if found.met is None:
        if found.open is None and gap < -_ROUNDING * size:
            yield f"clear of {centre}, {radius}, which is {-gap} nearer in a row"
        return
    there = case.mechanism.sweep(from_=found.met[1], to=found.met[1], certify=False)
    away = case.distance(there, centre)
    if not away <= radius + _ROUNDING * size:
        yield f"meets {centre}, {radius} at {found.met[1]}, where it is {away} away"


def _told(found: Contact) -> str:
    if found.met is not None:
        return "met"
    return "kept clear of" if found.open is None else "not decided"
