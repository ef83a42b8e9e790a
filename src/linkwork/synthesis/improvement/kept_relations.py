"""Where fits begin: numbers around those of a mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import LinkworkError
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import write_text
from linkwork.design.edits.unit_change import FileDegrees
from linkwork.synthesis.improvement.settings import Improvement
from linkwork.synthesis.lane_least_squares import Box

STARTS = 16


def spread_starts(model: Model, numbers: Sequence[VariedNumber], settings: Improvement) -> Array:
    """Numbers (D, P) around those of the mechanism, which come first."""
    x = np.array([float(q.of(model.description)) for q in numbers])
    rng = np.random.default_rng(settings.seed)
    count = settings.starts or STARTS
    # a number of 0 spreads by the size of its quantity
    sizes = np.where(x == 0.0, _sizes(model, numbers, x), x)
    starts = x + settings.spread * sizes * rng.uniform(-1.0, 1.0, (count, len(x)))
    starts[0] = x
    return starts


def _sizes(model: Model, numbers: Sequence[VariedNumber], x: Array) -> Array:
    """Sizes of numbers (P,): a radian, or the longest link or distance of points."""
    description = model.description
    # of dimensions the kind is not known
    largest = float(np.abs(x[[q.table != "angles" for q in numbers]]).max(initial=0.0))
    size = largest or 1.0
    if isinstance(description, Draft):
        lengths = [float(description.numbers(length)) for length in description.lengths.values()]
        places = [[float(description.numbers(c)) for c in p] for p in description.points.values()]
        spans = np.ptp(places, axis=0) if places else np.zeros(2)
        size = max(lengths, default=0.0) or float(spans.max()) or size
    radian = description.angle.from_radians(1.0)
    return np.array([radian if q.table == "angles" else size for q in numbers])


# ----------------------------------------------------------------------
# Numbers that change together, so that a mechanism keeps its special dimensions.
#
# Equal sides of parallelograms, centre distances of gears and the sides of inversors are relations
# without which designs lock, or have no position. A fit of single numbers soon breaks them.


_EQUAL = 1e-9  # relative difference of numbers that are equal, or that are a distance of pivots
_TRIED = 1e-3  # relative change of a group, to see whether it can change alone


@dataclass(frozen=True, kw_only=True, eq=False)
class Together:
    """Sizes of groups, by which numbers change in proportion.

    Parameters
    ----------
    x : (P,)
        The numbers as they are [file units].
    sizes : (G,)
        The sizes of the groups as they are.
    slopes : (P, G)
        The changes of the numbers by those of the sizes; at most one in a row is not zero.
    """

    x: Array
    sizes: Array
    slopes: Array

    @classmethod
    def of(cls, x: Array, groups: Sequence[Array]) -> Together:
        """Groups by their directions (P,), which are disjoint and not zero."""
        sizes = np.array([np.abs(group).max() for group in groups])
        return cls(x=x, sizes=sizes, slopes=np.stack(groups, axis=1) / sizes)

    def numbers(self, sizes: Array) -> Array:
        """All numbers (D, P) at sizes (D, G)."""
        return np.asarray(self.x + (sizes - self.sizes) @ self.slopes.T)

    def box(self, box: Box) -> Box:
        """The bounds of the sizes, within which all numbers are in a box."""
        with np.errstate(all="ignore"):
            ends = [
                np.where(self.slopes != 0.0, (end - self.x)[:, None] / self.slopes, np.nan)
                for end in (box.least, box.most)
            ]
        least = self.sizes + np.nanmax(np.minimum(*ends), axis=0)
        most = self.sizes + np.nanmin(np.maximum(*ends), axis=0)
        # of a mechanism out of its bounds the sizes stay
        least, most = np.minimum(least, self.sizes), np.maximum(most, self.sizes)
        return Box(least=least, most=most, least_effect=box.least_effect)


def kept_relations(
    model: Model, motion: Motion, numbers: Sequence[VariedNumber]
) -> Iterator[Together]:
    """Directions of change: equal lengths stay equal and the ground in proportion; numbers that
    cannot change alone are left out. Last, all lengths in proportion.
    """
    x = np.array([float(q.of(model.description)) for q in numbers])
    if len(x) < 2:
        return
    scaled = _scaled(model, numbers, x)
    free = []
    for group in _groups(model, numbers, x, scaled):
        # numbers that cannot change together may change alone
        alone = [group, *(np.eye(len(x)) * group)[group != 0.0]]
        moving = [step for step in alone if _moves(model, motion, numbers, x + _TRIED * step)]
        free += moving[:1] if moving and moving[0] is group else moving
    if free and len(free) < len(numbers):
        yield Together.of(x, free)
    if scaled.any() and not any(np.array_equal(scaled, step) for step in free):
        yield Together.of(x, [scaled])


def _scaled(model: Model, numbers: Sequence[VariedNumber], x: Array) -> Array:
    """The change of numbers (P,) if all lengths grow about the first fixed pivot, else 0."""
    description = model.description
    center = np.zeros(2)
    if isinstance(description, Draft):
        for name in description.links.get(GROUND, ())[:1]:
            center = np.array([description.numbers(c) for c in description.points[name]])
    try:
        degrees = FileDegrees(data_of(write_text(description), description.name))
        kinds = {q: degrees.of_name(q.key) for q in numbers if q.table == "dimensions"}
    except LinkworkError:  # formulas that mix kinds
        kinds = {}
    about = [center[q.axis] if q.table == "points" else 0.0 for q in numbers]
    lengths = [
        q.table in ("lengths", "points", "sliders") or kinds.get(q) == "length" for q in numbers
    ]
    return np.where(lengths, x - about, 0.0)


def _groups(
    model: Model, numbers: Sequence[VariedNumber], x: Array, scaled_all: Array
) -> Iterator[Array]:
    """The directions of groups: equal lengths, the ground, and every other number alone."""
    description = model.description
    fixed = description.links.get(GROUND, ()) if isinstance(description, Draft) else ()
    pivots = [q.table == "points" and q.key in fixed for q in numbers]
    spans: list[float] = []
    if isinstance(description, Draft) and any(pivots):
        places = [complex(*map(description.numbers, description.points[n])) for n in fixed]
        spans = [abs(a - b) for k, a in enumerate(places) for b in places[:k]]
    left = {k for k, pivot in enumerate(pivots) if not pivot}
    # coordinates of a sketch are no lengths that could be equal
    scaled = np.where([q.table == "points" for q in numbers], 0.0, scaled_all)
    alike = _same(x, left, scaled, spans)
    ground = np.where(pivots, scaled_all, 0.0)
    ground[alike] = scaled[alike]
    if ground.any():
        yield ground
    left -= set(alike)
    while left:
        k = min(left)
        members = _same(x, left, scaled, (abs(x[k]),)) if scaled[k] else [k]
        direction = np.zeros(len(x))
        # a number of 0 has no proportion
        direction[members] = np.where(x[members] == 0.0, 1.0, x[members])
        yield direction
        left -= set(members)


def _same(x: Array, among: set[int], scaled: Array, sizes: Sequence[float]) -> list[int]:
    """The lengths among numbers that have one of some sizes."""
    return [
        k
        for k in sorted(among)
        if scaled[k] and any(abs(abs(x[k]) - size) <= _EQUAL * size for size in sizes)
    ]


def _moves(model: Model, motion: Motion, numbers: Sequence[VariedNumber], x: Array) -> bool:
    """Whether a mechanism with other numbers has as many positions."""
    try:
        other = with_numbers(model.description, dict(zip(numbers, map(float, x), strict=True)))
        solved = sweep(model_of(other), certify=False).found
    except LinkworkError:
        return False
    return int(solved.sum()) >= int(motion.found.sum())
