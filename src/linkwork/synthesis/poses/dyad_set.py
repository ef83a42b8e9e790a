"""Dyads by their pivots and lines, and the mechanisms that pairs of them make."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, replace

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray, StatusArray
from linkwork.synthesis.loops.candidates import Candidates, LoopKind
from linkwork.synthesis.loops.limits import cross, dot
from linkwork.synthesis.poses.dyads import KINDS, Dyads, Refusal

#: The mechanisms of pairs of KINDS, by their places.
_MADE = {
    (0, 0): LoopKind.FOUR_BAR, (0, 1): LoopKind.SLIDER_CRANK, (0, 2): LoopKind.INVERTED,
    (1, 1): LoopKind.DOUBLE_SLIDER, (1, 2): LoopKind.RAPSON, (2, 2): LoopKind.OLDHAM,
}  # fmt: skip
_MOST_GUIDED = 24  # dyads of each kind for them: thousands of pairs of a family differ little
#: Relative: pivots nearer to each other are one pivot.
_ONE_PIVOT = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseSet:
    """T tasks of N poses: places of the body's point, and e^{iθ}, (T, N) complex."""

    points: ComplexArray
    turns: ComplexArray


@dataclass(frozen=True, kw_only=True, eq=False)
class DyadSet:
    """K dyads of T tasks.

    Parameters
    ----------
    task : (K,)
        The task of each dyad.
    kind : (K,)
        The place of its kind in :data:`~linkwork.synthesis.poses.dyads.KINDS`.
    moving : (K,) complex
        The moving pivot in the body's frame; of an RP dyad a point of its line [length].
    fixed : (K,) complex
        The fixed pivot; of a PR dyad a point of its line [length].
    normal : (K,) complex
        The unit normal of that line, in the body's frame or fixed; 0 for an RR dyad.
    error : (K,)
        A bound of the errors of pivots, and of how far the line is missed at any pose [length].
    refusal : (K,)
        Codes of :class:`Refusal`.
    """

    task: IndexArray
    kind: StatusArray
    moving: ComplexArray
    fixed: ComplexArray
    normal: ComplexArray
    error: Array
    refusal: StatusArray

    def __len__(self) -> int:
        return len(self.task)

    def take(self, index: IndexArray | BoolArray) -> DyadSet:
        """Some of the dyads."""
        return DyadSet(**{f.name: getattr(self, f.name)[index] for f in fields(self)})

    @classmethod
    def joined(cls, parts: Iterable[DyadSet]) -> DyadSet:
        """The dyads of several sets, in their order."""
        every = list(parts)
        return cls(
            **{
                f.name: np.concatenate([getattr(part, f.name) for part in every])
                for f in fields(cls)
            }
        )

    def of_one_task(self) -> DyadSet:
        """The dyads as those of a single task."""
        return replace(self, task=np.zeros(len(self), dtype=np.intp))

    @classmethod
    def of_solutions(cls, solutions: Dyads, poses: PoseSet) -> DyadSet:
        """The real solutions of five-pose tasks."""
        task, column = np.nonzero(solutions.is_real)
        x = solutions.x[task, column].real
        size, centre = solutions.poses.size[task], solutions.poses.centre[task]
        kind = solutions.kinds[task, column]
        a, g, b = x[:, 1] + 1j * x[:, 2], x[:, 3] + 1j * x[:, 4], x[:, 5] + 1j * x[:, 6]
        normal_of = np.where(kind == 1, g, a)
        length = np.abs(normal_of)
        with np.errstate(all="ignore"):
            line = normal_of / length * (0.5 * x[:, 7] / length)
            moving = np.choose(kind, [a / x[:, 0], b / g.conj(), line])
            fixed = np.choose(kind, [g / x[:, 0], line, (b / a).conj()])
            # an error e of every coordinate, complex ones √2 e, in a quotient
            error = np.sqrt(2.0) * solutions.error[task, column]
            divisor = np.where(kind == 0, np.abs(x[:, 0]), length) - error
            far = np.maximum(np.abs(moving), np.abs(fixed))
            error = np.where(divisor > 0, error * (1.0 + far) / divisor, np.inf)
        made = cls(
            task=task,
            kind=kind,
            moving=np.asarray(moving * size, dtype=np.complex128),
            fixed=centre + fixed * size,
            normal=np.where(kind > 0, normal_of / length, 0.0),
            error=error * size,
            refusal=solutions.refusal[task, column],
        )
        return made.take(np.isfinite(moving) & np.isfinite(fixed)).with_misses(poses)

    def with_misses(self, poses: PoseSet) -> DyadSet:
        """With the distances from lines in the errors: a slider fits to rounding only."""
        d, e = poses.points[self.task], poses.turns[self.task]
        pin = d + self.moving[:, None] * e - self.fixed[:, None]
        normal = np.where((self.kind == 1)[:, None], self.normal[:, None], self.normal[:, None] * e)
        miss = np.abs((normal.conj() * pin).real).max(axis=1)
        return replace(self, error=np.where(self.kind > 0, self.error + miss, self.error))

    @classmethod
    def made(
        cls,
        kind: int,
        moving: ComplexArray,
        fixed: ComplexArray,
        error: Array,
        normal: ComplexArray | None = None,
    ) -> DyadSet:
        """Dyads of one kind and task, as far as their numbers are finite."""
        good = np.isfinite(moving) & np.isfinite(fixed) & np.isfinite(error)
        count = int(good.sum())
        return cls(
            task=np.zeros(count, dtype=np.intp),
            kind=np.full(count, kind, dtype=np.int8),
            moving=moving[good],
            fixed=fixed[good],
            normal=np.zeros(count, dtype=complex) if normal is None else normal[good],
            error=error[good],
            refusal=np.full(count, Refusal.NONE.code, dtype=np.int8),
        )

    def inverted(self) -> DyadSet:
        """RP dyads from the PR dyads of the inverted poses."""
        kind = np.full(len(self), KINDS.index("RP"), dtype=np.int8)
        return replace(self, kind=kind, moving=self.fixed, fixed=self.moving)

    def dyads(self) -> Iterator[tuple[str, complex, complex, complex, float, Refusal]]:
        """Kind, moving, fixed, normal, error and refusal of each."""
        for k in range(len(self)):
            yield (
                KINDS[self.kind[k]],
                complex(self.moving[k]),
                complex(self.fixed[k]),
                complex(self.normal[k]),
                float(self.error[k]),
                Refusal.of_code(int(self.refusal[k])),
            )


def pair_dyads(dyads: DyadSet, poses: PoseSet, leading: int = 0) -> list[Candidates]:
    """All four-bars and slider-cranks that pairs of dyads of one task make.

    A crank with an RP dyad is an inverted slider-crank. Pairs without a crank are left out, and
    pairs with a common pivot, which do not move. ``leading``: one of the first so many dyads is in
    every pair, as its crank.
    """
    cranks = dyads.take(dyads.kind == 0)
    pairs = []
    first, second = _pairs(cranks.task, cranks.task)
    later = (first < second) & (first < (leading or len(cranks)))
    if leading:
        later &= second >= leading
    later &= _differ(cranks.moving, first, second) & _differ(cranks.fixed, first, second)
    if later.any():
        pairs.append(_made(cranks.take(first[later]), cranks.take(second[later]), poses))
    # a block at the crank's own fixed pivot, or a slider at its moving pivot, does not move
    for kind, pivots in ((1, "moving"), (2, "fixed")):
        guided = dyads.take(dyads.kind == kind)
        first, second = _pairs(cranks.task, guided.task)
        pivot, other = getattr(cranks, pivots)[first], getattr(guided, pivots)[second]
        led = first < (leading or len(cranks))
        led &= np.abs(pivot - other) > _ONE_PIVOT * np.abs(pivot)
        if led.any():
            pairs.append(_made(cranks.take(first[led]), guided.take(second[led]), poses))
    return pairs


def pair_guides(dyads: DyadSet, poses: PoseSet) -> tuple[list[Candidates], int]:
    """The mechanisms without a crank that pairs of dyads of one task make, and how many pairs make
    none: pairs of parallel lines only translate the body, those with a common pivot only turn it.

    Of many dyads of one kind some are taken, spread evenly.
    """
    guides = []
    for kind in (1, 2):
        of_kind = np.flatnonzero(dyads.kind == kind)
        if len(np.unique(dyads.task)) <= 1 and len(of_kind) > _MOST_GUIDED:
            of_kind = of_kind[np.linspace(0, len(of_kind) - 1, _MOST_GUIDED).astype(int)]
        guides.append(dyads.take(of_kind))
    pairs, immobile = [], 0
    for one, other in ((0, 0), (0, 1), (1, 1)):
        first, second = _pairs(guides[one].task, guides[other].task)
        if one == other:
            first, second = first[first < second], second[first < second]
        left, right = guides[one].take(first), guides[other].take(second)
        moves = np.ones(len(first), dtype=bool)
        if one == other:
            moves = np.abs(cross(left.normal, right.normal)) > _ONE_PIVOT
            moves &= _differ(getattr(guides[one], ("moving", "fixed")[one]), first, second)
        immobile += int((~moves).sum())
        if moves.any():
            pairs.append(_made(left.take(moves), right.take(moves), poses))
    return pairs, immobile


def _differ(pivots: ComplexArray, first: IndexArray, second: IndexArray) -> BoolArray:
    size = np.maximum(np.abs(pivots[first]), np.abs(pivots[second]))
    return np.asarray(np.abs(pivots[first] - pivots[second]) > _ONE_PIVOT * size)


def _pairs(tasks: IndexArray, others: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Indices of all pairs of one task; both lists are sorted by task."""
    begin = np.searchsorted(others, tasks, side="left")
    count = np.searchsorted(others, tasks, side="right") - begin
    first = np.repeat(np.arange(len(tasks)), count)
    offset = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return first, np.repeat(begin, count) + offset


def _made(crank: DyadSet, other: DyadSet, poses: PoseSet) -> Candidates:
    """The mechanisms of dyads, of which the first carries A: a crank, or a guide of a pivot."""
    d, e = poses.points[crank.task], poses.turns[crank.task]
    kind = _MADE[int(crank.kind[0]), int(other.kind[0])]
    # the normal is on the left of the direction
    a, b, along_a, along = crank.moving, other.moving, -1j * crank.normal, -1j * other.normal
    error = np.maximum(crank.error, other.error)
    pins_a, pins = ((dyads.fixed[:, None] - d) / e for dyads in (crank, other))
    if kind is LoopKind.OLDHAM:
        # A and B on the body's lines, as far from their crossing as the blocks come and to the
        # same side
        n, m = crank.normal, other.normal
        sine = cross(n, m)
        centre = (dot(n, a) * (-1j * m) + dot(m, b) * (1j * n)) / sine
        reach_a, reach = _reach(along_a, pins_a, centre), _reach(along, pins, centre)
        a, b = centre + reach_a * along_a, centre + reach * along
        seen = np.abs(b - a) / (b - a)
        along_a, along = along_a * np.sign(reach_a) * seen, along * np.sign(reach) * seen
        # the crossing of two lines moves farther than these
        error = 4.0 * error / np.abs(sine)
    elif kind.body_line:
        # of the body's line: as far from the foot of A as the block comes, and to the same side
        reach = _reach(along, pins, a)
        along = along * np.sign(reach)
        away = dot(other.normal, b - a) * other.normal + np.abs(reach) * along
        b, along = a + away, along * np.abs(away) / away
    return Candidates(
        kind=kind,
        fixed_a=crank.fixed,
        fixed_b=other.fixed,
        direction=along,
        moving_a=d + a[:, None] * e,
        moving_b=d + b[:, None] * e,
        guided=d,
        error=error,
        miss=np.zeros(len(crank)),
        direction_a=along_a,
    )


def _reach(along: ComplexArray, pins: ComplexArray, start: ComplexArray) -> Array:
    """The farthest places of pins (D, N) along lines (D,) from their starts, with their signs."""
    places = dot(along[:, None], pins - start[:, None])
    farthest = np.abs(places).argmax(axis=1)[:, None]
    return np.asarray(np.take_along_axis(places, farthest, axis=1)[:, 0])
