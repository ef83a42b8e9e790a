"""Dyads by their pivots and lines, and the mechanisms that pairs of them make."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, replace
from itertools import permutations

import numpy as np

from linkwork.core.foundation.arrays import (
    RANK_TOLERANCE,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    StatusArray,
)
from linkwork.synthesis.loops.limits import Candidates, LoopKind, cross, dot
from linkwork.synthesis.poses.dyads import KINDS, Dyads, NormalPoses, Refusal, solve_on_lines

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


# ----------------------------------------------------------------------
# Four poses: the centre-point curve as proved arcs, and proved dyads along it.
#
# A fixed pivot p sees the body turn through four poses on a circle if
#
#     Im( k13 (p - P13) k24 (p - P24) conj( k23 (p - P23) k14 (p - P14) ) ) = 0,
#
# with the poles Pjk, about which the body turns from pose j to pose k (Burmester 1888). On the line
# through P13 of direction u = e^{iφ} this is quadratic in the distance t from P13, eq. (151):
#
#     Im(u (b̄ + c̄ - ā)) t² + ( Im(a (b̄ + c̄)) + Im(u² b̄ c̄) ) t + Im(u a b̄ c̄) = 0,
#
# a = P13 - P24, b = P13 - P23, c = P13 - P14. Its discriminant is a trigonometric polynomial of
# degree 2 in 2φ. Between its roots, at most four, there are two points of the curve or none.


_SAMPLES = 48  # directions over all arcs
_THROUGH = np.exp(0.25j * np.pi * np.arange(4))  # directions of lines through a given pivot
_AT_POLE = 1e-7  # of the size of the task: a pivot this near is the pole of the pencil
#: Turns from pose to pose below this leave no finite pole.
_SMALLEST_TURN = 1e-6
# roundings of the discriminant's coefficients: products of four, sums of a few
_LOSS = 64.0 * UNIT_ROUNDOFF


@dataclass(frozen=True, kw_only=True)
class Arc:
    """An arc of the centre-point curve, seen from the pole of poses 1 and 3 of the pencil.

    Parameters
    ----------
    start, stop : float
        Directions of its lines [rad]; ``stop - start`` is π for an arc without ends.
    closed : bool
        Whether both points of a line join at the ends.
    proved : bool
        Whether its ends are certain, and that there are no further ones.
    """

    start: float
    stop: float
    closed: bool
    proved: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class CentrePoints:
    """The centre-point curve of four poses.

    Parameters
    ----------
    pole : complex
        The vertex of the pencil of lines [length].
    arcs : tuple of Arc
    differences : (complex, complex, complex)
        a, b, c of the equation.
    """

    pole: complex
    arcs: tuple[Arc, ...]
    differences: tuple[complex, complex, complex]

    def points(self, directions: Array) -> ComplexArray:
        """The two points (K, 2) on lines of directions (K,) [rad]; NaN where there are none."""
        u = np.exp(1j * directions)
        a, b, c = (np.conj(z) for z in self.differences)
        # eq. (151)
        alpha = (u * (b + c - a)).imag
        beta = (np.conj(a) * (b + c)).imag + (u**2 * b * c).imag
        gamma = (u * np.conj(a) * b * c).imag
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(beta**2 - 4.0 * alpha * gamma)
            # without cancellation
            q = -0.5 * (beta + np.where(beta >= 0, root, -root))
            t = np.stack([q / alpha, gamma / q], axis=1)
        return np.asarray(self.pole + t * u[:, None])


def centre_points(points: ComplexArray, angles: Array) -> CentrePoints | None:
    """The centre-point curve of four poses (4,), (4,); ``None`` if three of them are parallel."""
    labels = _labels(angles)
    if labels is None:
        return None
    d, e = points[labels], np.exp(-1j * angles[labels])

    def pole(j: int, k: int) -> complex:
        return complex((e[j] * d[j] - e[k] * d[k]) / (e[j] - e[k]))

    vertex = pole(0, 2)
    differences = vertex - pole(1, 3), vertex - pole(1, 2), vertex - pole(0, 3)
    return CentrePoints(pole=vertex, arcs=_arcs(*differences), differences=differences)


def _labels(angles: Array) -> list[int] | None:
    """The order of poses in which the four turns that are used are largest."""
    turns = np.exp(1j * angles)
    best, order = _SMALLEST_TURN, None
    for labels in permutations(range(4)):
        i, j, k, m = labels
        pairs = ((i, k), (j, m), (j, k), (i, m))
        least = min(abs(turns[x] - turns[y]) for x, y in pairs)
        if least > best * (1.0 + 1e-9):
            best, order = least, list(labels)
    return order


def _arcs(a: complex, b: complex, c: complex) -> tuple[Arc, ...]:
    """The arcs, from the roots of the discriminant on the circle of w = u²."""
    coefficients, error = _discriminant(a, b, c)
    w, proved, on_circle = _roots(coefficients, error)
    half = 0.5 * np.sort(np.mod(np.angle(w[on_circle]), 2.0 * np.pi))
    if not half.size:
        free = _value(coefficients, 0.0) > 0
        return (Arc(start=0.0, stop=np.pi, closed=False, proved=proved),) if free else ()
    ends = zip(half, [*half[1:], half[0] + np.pi], strict=True)
    return tuple(
        Arc(start=float(start), stop=float(stop), closed=True, proved=proved)
        for start, stop in ends
        if _value(coefficients, 0.5 * (start + stop)) > 0
    )


def _discriminant(a: complex, b: complex, c: complex) -> tuple[ComplexArray, float]:
    """c2, c1, c0 of c0 + Re(c1 w) + Re(c2 w²), w = e^{2iφ}, and a bound of their errors."""
    x, y = np.conj(b + c - a), a * np.conj(b * c)
    z, free = np.conj(b * c), (a * np.conj(b + c)).imag
    # β = free + Im(w z); β² = free² + 2 free Im(w z) + |z|²/2 - Re(w² z²)/2
    # 4 α γ = 4 Im(u x) Im(u y) = 2 Re(x ȳ) - 2 Re(w x y)
    second = -0.5 * z**2
    first = -2j * free * z + 2.0 * x * y
    zeroth = free**2 + 0.5 * abs(z) ** 2 - 2.0 * (x * np.conj(y)).real
    size = (abs(a) + abs(b) + abs(c)) ** 4
    return np.array([second, first, zeroth]), _LOSS * size


def _value(coefficients: ComplexArray, phi: float) -> float:
    w = np.exp(2j * phi)
    second, first, zeroth = coefficients
    return float(zeroth.real + (first * w).real + (second * w * w).real)


def _roots(coefficients: ComplexArray, error: float) -> tuple[ComplexArray, bool, BoolArray]:
    """The roots w, whether their number on the circle is proved, and which are on it.

    Smith's discs contain all roots, one each where they are disjoint. A disc without its mirror
    image in another one has a root on the circle.
    """
    second, first, zeroth = coefficients
    # times 2 w²: c2 w⁴ + c1 w³ + 2 c0 w² + c̄1 w + c̄2
    polynomial = np.array([second, first, 2.0 * zeroth.real, np.conj(first), np.conj(second)])
    w = np.asarray(np.roots(polynomial), dtype=np.complex128)
    if len(w) < 4:
        return w, False, np.abs(np.abs(w) - 1.0) < _AT_POLE
    powers = np.abs(w)[:, None] ** np.arange(4, -1, -1)
    loss = 2.0 * error * powers.sum(axis=1) + 16.0 * UNIT_ROUNDOFF * (powers @ np.abs(polynomial))
    others = np.abs(w[:, None] - w[None]) + np.eye(4)
    divisor = np.abs(second) - error
    with np.errstate(all="ignore"):
        radius = 4.0 * (np.abs(np.polyval(polynomial, w)) + loss) / (divisor * others.prod(axis=1))
    if divisor <= 0 or not np.isfinite(radius).all():
        return w, False, np.abs(np.abs(w) - 1.0) < _AT_POLE
    apart = others > 2.0 * (radius[:, None] + radius[None])
    np.fill_diagonal(apart, True)
    away = np.abs(np.abs(w) - 1.0) > 1.1 * radius
    # the mirror image 1/w̄ of a root in a small disc about the circle is in the same disc
    on_circle = ~away
    alone = (radius < 0.1).all()
    return w, bool(apart.all() and alone), on_circle


def sampled_dyads(points: ComplexArray, angles: Array, samples: int = _SAMPLES) -> DyadSet:
    """Proved dyads through four poses (4,), (4,), whose fixed pivots are spread over all arcs.

    Also the PR and RP dyads, which are single.
    """
    curve = centre_points(points, angles)
    if curve is None or not curve.arcs:
        directions = np.linspace(0.0, np.pi, samples, endpoint=False)
    else:
        total = sum(arc.stop - arc.start for arc in curve.arcs)
        parts = []
        for arc in curve.arcs:
            count = max(4, round(samples * (arc.stop - arc.start) / total))
            share = 0.5 - 0.5 * np.cos((2 * np.arange(count) + 1) * np.pi / (2 * count))
            parts.append(arc.start + share * (arc.stop - arc.start))
        directions = np.concatenate(parts)
    vertex = complex(points.mean()) if curve is None else curve.pole
    dyads = _dyads_on_lines(vertex, np.exp(1j * directions), points, angles)
    away = np.abs(dyads.fixed - vertex) > _AT_POLE * float(np.abs(points - points.mean()).max())
    pinned = dyads.take((dyads.kind == 0) & away)
    # every line finds the same RP dyad
    sliding = np.flatnonzero(dyads.kind == 2)[:1]
    return DyadSet.joined([pinned, dyads.take(sliding)]).of_one_task()


def _dyads_on_lines(
    through: complex, directions: ComplexArray, points: ComplexArray, angles: Array
) -> DyadSet:
    """The dyads whose fixed pivots are on lines through a point, each line as a task of its own."""
    many = len(directions)
    lines = np.stack([np.full(many, through), directions], axis=1)
    d, theta = np.tile(points, (many, 1)), np.tile(angles, (many, 1))
    solved = solve_on_lines(d, theta, lines)
    return DyadSet.of_solutions(solved, PoseSet(points=d, turns=np.exp(1j * theta)))


def dyads_with_pivots(
    pivots: ComplexArray, points: ComplexArray, angles: Array, reach: float
) -> DyadSet:
    """The RR dyads through four poses (4,), (4,) whose fixed pivots are nearest to given ones (K,).

    On a line through a given pivot the four poses determine the dyad: the square system is that of
    :func:`solve_on_lines`, with its proof. Of several lines the nearest proved pivot counts, which
    differs from the given one by as much as that is off the curve. A given pivot without a dyad
    within ``reach`` is left out.
    """
    nearest = []
    for pivot in pivots:
        dyads = _dyads_on_lines(pivot, _THROUGH, points, angles)
        away = np.abs(dyads.fixed - pivot)
        near = np.flatnonzero((dyads.kind == 0) & (away < reach))
        order = np.lexsort([away[near], dyads.refusal[near] != Refusal.NONE.code])
        nearest.append(dyads.take(near[order[:1]]))
    return DyadSet.joined(nearest).of_one_task()


def sliding_dyad(points: ComplexArray, angles: Array) -> DyadSet:
    """The PR dyad through four poses (4,), (4,); none where it is not determined."""
    poses = NormalPoses.of(points[None], angles[None])
    # G, B and C of the dyad's equation, with a = A = 0
    _, sizes, right = np.linalg.svd(poses.rows()[0][:, 3:])
    g, b, c = right[-1][0] + 1j * right[-1][1], right[-1][2] + 1j * right[-1][3], right[-1][4]
    size, centre = float(poses.size[0]), complex(poses.centre[0])
    if sizes[-1] < RANK_TOLERANCE * sizes[0] or abs(g) < RANK_TOLERANCE:
        nowhere = np.full(1, np.nan + 0j)
        return DyadSet.made(1, nowhere, nowhere, np.array([np.inf]))
    normal = g / abs(g)
    # a singular vector moves by the roundings of the matrix over the smallest singular value
    error = size * _LOSS * sizes[0] / sizes[-1] * (1.0 + abs(b / g)) / abs(g)
    made = DyadSet.made(
        1,
        np.array([size * b / g.conjugate()]),
        np.array([centre + size * normal * 0.5 * c / abs(g)]),
        np.array([error]),
        np.array([normal]),
    )
    return made.with_misses(PoseSet(points=points[None], turns=np.exp(1j * angles)[None]))
