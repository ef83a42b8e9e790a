"""The shape of a link from its lengths and angles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, UNIT_ROUNDOFF, AnyArray, Array, BoolArray
from linkwork.core.foundation.lanes import (
    Lanes,
    Rest,
    choose,
    cis,
    degrees,
    detached,
    everywhere,
    first_lanes,
    is_batched,
    is_steady,
    largest,
    phase,
    rest_of,
    smallest,
    vector,
)
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.precise import Precise, chosen, joined, precise, sin_cos, sqrt
from linkwork.core.mechanism.bodies import Bodies, Measured, Shapes
from linkwork.core.mechanism.description import Problems

# ----------------------------------------------------------------------
# Least-norm solutions of small linear systems, of one or many designs.


_CUT = 1e-12  # relative: smaller singular values count as zero
_APART = 1e-9  # relative: a row nearer to those before depends on them
_REGULAR = 1e-8  # the determinant of the Gram matrix of rows of length 1


def least_norm(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> Sequence[float]:
    """The shortest least-squares solution of m equations in k unknowns, m <= k.

    Parameters
    ----------
    matrix : m rows of k numbers
    right : m numbers

    Raises
    ------
    LinAlgError
        If the numbers are not finite.
    """
    lanes = first_lanes(number for row in (*matrix, right) for number in row)
    if lanes is None:
        known, wanted = np.array(matrix), np.array(right)
        # LAPACK prints a line about such numbers
        if not (np.isfinite(known).all() and np.isfinite(wanted).all()):
            raise np.linalg.LinAlgError
        found: Array = np.linalg.lstsq(known, wanted, rcond=_CUT)[0]
        return [float(number) for number in found]
    shortest = lanes.arithmetic.solve_shortest(matrix, right)
    if shortest is not None:
        return shortest
    a, b = _stacked(matrix, lanes), _stacked([right], lanes)[:, 0]
    finite: BoolArray = np.isfinite(np.concatenate([a, b[:, :, None]], axis=2)).all(axis=(1, 2))
    if lanes.arithmetic.decide(~finite):
        raise np.linalg.LinAlgError
    x = np.full((len(a), a.shape[2]), np.nan)
    regular, rows, sizes = _regular(a)
    gram = rows @ rows.swapaxes(1, 2)
    y = np.linalg.solve(gram[regular], (b / sizes)[regular][:, :, None])
    x[regular] = (rows[regular].swapaxes(1, 2) @ y)[:, :, 0]
    others = np.flatnonzero(~regular & finite)
    x[others] = (np.linalg.pinv(a[others], rcond=_CUT) @ b[others][:, :, None])[:, :, 0]
    return [lanes.arithmetic.lanes(column) for column in x.T]


def independent(matrix: Sequence[Sequence[float]]) -> list[int]:
    """The rows, from the first on, that do not depend on those before."""
    found: list[int] = []
    base = np.empty((0, len(matrix[0])))
    for k, row in enumerate(np.array(matrix)):
        rest = row - base.T @ (base @ row)
        rest -= base.T @ (base @ rest)  # once more, against rounding
        if (size := np.linalg.norm(rest)) > _APART * np.linalg.norm(row):
            found.append(k)
            base = np.vstack([base, rest / size])
    return found


def _stacked(matrix: Sequence[Sequence[float]], lanes: Lanes) -> Array:
    """One matrix per lane, (n, m, k)."""
    found = np.empty((len(lanes.values), len(matrix), len(matrix[0])))
    for i, row in enumerate(matrix):
        for j, number in enumerate(row):
            found[:, i, j] = number.values if is_batched(number) else number
    return found


def _regular(a: Array) -> tuple[BoolArray, Array, Array]:
    """Lanes with clearly independent rows; all rows normalised; their lengths."""
    sizes: Array = np.linalg.norm(a, axis=2)
    rows: AnyArray = a / sizes[:, :, None]
    gram = rows @ rows.swapaxes(1, 2)
    regular: BoolArray = np.linalg.det(gram) > _REGULAR
    return regular, rows, sizes


# ----------------------------------------------------------------------
# Distances and angles between the points of one link.


AGREE = 1e-9  # relative, or [rad]: nearer to its dimensions a shape may be placed by them
_ROUNDED = 1e-13  # the same of numbers without their rests


class ShapeError(Exception):
    """Dimensions of one link that contradict each other."""

    def __init__(self, message: str, table: str = "", key: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.table = table
        self.key = key


@dataclass(frozen=True)
class Distance:
    """|ab| = size + rest: the part that is lost where it is rounded to a float."""

    a: str
    b: str
    size: float
    rest: float = 0.0
    table = "lengths"

    @property
    def key(self) -> str:
        return f"{self.a} {self.b}"

    @property
    def points(self) -> tuple[str, ...]:
        return (self.a, self.b)

    @property
    def amount_text(self) -> str:
        return f"{self.size:.12g}"

    def error(self, z: Mapping[str, complex]) -> float:
        """Relative disagreement with placed points."""
        return (abs(z[self.b] - z[self.a]) - self.size) / self.size

    def precise_error(self, z: Mapping[str, Precise]) -> Precise:
        """The error near a shape that has none."""
        span, length = z[self.b] - z[self.a], Precise(self.size, self.rest)
        square = span.real * span.real + span.imag * span.imag
        return (square / (length * length) - 1.0) * 0.5

    def shown(self, z: Mapping[str, complex]) -> str:
        return f"|{self.a}{self.b}| = {abs(z[self.b] - z[self.a]):.12g}"

    def gradients(self, z: Mapping[str, complex]) -> dict[str, complex]:
        """The derivatives of the error by every point's x and, times i, by its y."""
        span = z[self.b] - z[self.a]
        size = abs(span)
        slope = span / (size * self.size) if size else 0j
        return {self.a: -slope, self.b: slope}

    def bend(self, z: Mapping[str, complex], point: str, move: complex) -> dict[str, complex]:
        """The change of the gradients per move of a point."""
        span = z[self.b] - z[self.a]
        change = move if point == self.b else -move
        # i u Im(u* δ) / (|span| · length), u = span / |span|
        slope = 1j * span * (span.conjugate() * change).imag / (abs(span) ** 3 * self.size)
        return {self.a: -slope, self.b: slope}


@dataclass(frozen=True)
class VertexAngle:
    """The angle [rad] at ``vertex``, counter-clockwise from the ray to ``a`` to that to ``b``.

    It is ``size`` + ``rest``.
    """

    a: str
    vertex: str
    b: str
    size: float
    rest: float = 0.0
    table = "angles"

    @property
    def key(self) -> str:
        return f"{self.a} {self.vertex} {self.b}"

    @property
    def points(self) -> tuple[str, ...]:
        return (self.a, self.vertex, self.b)

    @property
    def amount_text(self) -> str:
        return f"{degrees(self.size):.12g}°"

    def error(self, z: Mapping[str, complex]) -> float:
        """Disagreement with placed points [rad], within half a turn."""
        rays = (z[self.b] - z[self.vertex]) * (z[self.a] - z[self.vertex]).conjugate()
        # the difference as a rotation has no jump at half a turn
        return phase(rays * cis(-self.size)) if rays else math.inf

    def precise_error(self, z: Mapping[str, Precise]) -> Precise:
        """The error near a shape that has none [rad]."""
        rays = (z[self.b] - z[self.vertex]) * (z[self.a] - z[self.vertex]).conjugate()
        sine, cosine = sin_cos(Precise(self.size, self.rest))
        return (rays.imag * cosine - rays.real * sine) / abs(rays)

    def shown(self, z: Mapping[str, complex]) -> str:
        rays = (z[self.b] - z[self.vertex]) * (z[self.a] - z[self.vertex]).conjugate()
        return f"an angle of {degrees(phase(rays)):.12g}° at {self.vertex}"

    def gradients(self, z: Mapping[str, complex]) -> dict[str, complex]:
        """The derivatives of the error by every point's x and, times i, by its y."""
        first, second = z[self.a] - z[self.vertex], z[self.b] - z[self.vertex]
        if not (first and second):
            return {point: complex(math.nan) for point in self.points}
        # d arg r = Im(dr / r)
        to_a, to_b = -1j / first.conjugate(), 1j / second.conjugate()
        return {self.a: to_a, self.vertex: -(to_a + to_b), self.b: to_b}

    def bend(self, z: Mapping[str, complex], point: str, move: complex) -> dict[str, complex]:
        """The change of the gradients per move of a point."""
        first, second = z[self.a] - z[self.vertex], z[self.b] - z[self.vertex]
        turns = [
            -move if point == self.vertex else move * (point == end) for end in (self.a, self.b)
        ]
        to_a = 1j * turns[0].conjugate() / first.conjugate() ** 2
        to_b = -1j * turns[1].conjugate() / second.conjugate() ** 2
        return {self.a: to_a, self.vertex: -(to_a + to_b), self.b: to_b}


Given = Distance | VertexAngle


def agrees(row: Given, z: Mapping[str, complex], tolerance: float) -> bool:
    """Whether placed points have a dimension."""
    error = row.error(z)
    # one that agrees by chance would no longer if a number changed
    return abs(error) <= tolerance and is_steady(error)


def fits(row: Given, z: Mapping[str, Precise], tolerance: float) -> bool:
    """Whether placed points have a dimension, in numbers as exact as they are."""
    rounded = {p: place.high for p, place in z.items()}
    if not all(place.has_rest for place in z.values()):
        return agrees(row, rounded, max(tolerance, _ROUNDED))
    return agrees(row, rounded, AGREE) and abs(row.precise_error(z).high) <= tolerance


def compared(row: Given, z: Mapping[str, Precise]) -> str:
    """What placed points have instead of a dimension, and how far it is off if digits hide it."""
    rounded = {p: place.high for p, place in z.items()}
    text = f"{row.shown(rounded)}, not {row.amount_text}"
    if abs(row.error(rounded)) > AGREE:
        return text
    off = abs(row.precise_error(z).high)
    told = f"relative difference {off:.1e}" if isinstance(row, Distance) else f"{off:.1e} rad apart"
    return f"{text} ({told})"


# ----------------------------------------------------------------------
# The shape of a link that has given dimensions and is nearest to its sketch.


#: Relative, or [rad]: by how much a redundant dimension may differ from what the others give.
REDUNDANT = 1e-14
_HELD = 2.0 * EPSILON  # the same of dimensions that determine the shape: their rounding

_MOST_STEPS = 60
_POLISHES = 3
_SMALL = 1e-10  # relative: Newton's last step
_FIRST_STEPS = 6  # most shapes need four


def nearest_shape(
    points: tuple[str, ...], exact: Mapping[str, Precise], rows: Sequence[Given]
) -> tuple[dict[str, Precise], list[Distance]]:
    """Solve the dimensions together, nearest to the sketch; measure there what they leave open.

    Those that follow from others in whatever place the points are, are compared only.
    """
    sketch = {p: place.high for p, place in exact.items()}
    # the sketch selects a shape; only what is measured in it enters its dimensions
    start = {p: detached(sketch[p]) for p in points}
    given = rows
    rows, missing = _determining(points, given)
    held = list(map(_detached, rows))
    placed = _gauss_newton(start, held, _MOST_STEPS)
    varies = any(own is not row for own, row in zip(held, rows, strict=True))
    if missing:
        placed = _nearest(placed, sketch, held, rows)
    elif varies:
        # one exact step from the solution has its derivatives (implicit function theorem)
        errors = [row.error(placed) for row in rows]
        placed = _moved(placed, least_norm(_slopes(placed, held), errors))
    found = {p: Precise(place) for p, place in placed.items()}
    wrong = [row for row in rows if not agrees(row, placed, AGREE)]
    if not wrong:
        found = _polished(placed, rows) if rows else dict(exact)
        wrong = [row for row in rows if not fits(row, found, _HELD)]
        wrong += [row for row in given if not fits(row, found, _explained(row, placed, rows))]
    if wrong:
        raise ShapeError(
            "no link has these dimensions near the sketch; "
            f"nearest has {compared(wrong[0], found)}",
            wrong[0].table,
            wrong[0].key,
        )
    return found, [Distance(a, b, abs(found[b] - found[a]).high) for a, b in missing]


def _explained(row: Given, z: Mapping[str, complex], held: Sequence[Given]) -> float:
    """By how much rounding of the dimensions that determine a shape changes another one."""
    if any(map(is_batched, z.values())):
        return REDUNDANT
    follows = np.array(_slopes(z, [row])[0]) @ np.linalg.pinv(np.array(_slopes(z, held)))
    return REDUNDANT + 4.0 * _HELD * float(np.abs(follows).sum())


def _polished(z: Mapping[str, complex], rows: Sequence[Given]) -> dict[str, Precise]:
    """The points of a shape that satisfies all rows to rounding, as exact as these are."""
    found = {p: Precise(place) for p, place in z.items()}
    if not all(place.has_rest for place in found.values()):
        return found
    slopes = _slopes(z, rows)
    for _ in range(_POLISHES):
        errors = [row.precise_error(found).high for row in rows]
        step = _moved(dict.fromkeys(z, 0j), least_norm(slopes, errors))
        found = {p: place + step[p] for p, place in found.items()}
    return found


def _determining(
    points: tuple[str, ...], rows: Sequence[Given]
) -> tuple[list[Given], list[tuple[str, str]]]:
    """The rows that do not follow from those before, and pairs whose distances complete them, in
    whatever place the points of a link are.
    """
    places = np.random.default_rng(len(points)).normal(size=(len(points), 2)) @ [1.0, 1j]
    z = dict(zip(points, map(complex, places), strict=True))
    across = {frozenset((row.a, row.b)) for row in rows if isinstance(row, VertexAngle)}
    pairs = sorted(combinations(points, 2), key=lambda pair: frozenset(pair) in across)
    unit = [Distance(row.a, row.b, 1.0) if isinstance(row, Distance) else row for row in rows]
    candidates = [Distance(a, b, 1.0) for a, b in pairs]
    found = independent(_slopes(z, [*unit, *candidates]))
    held = [rows[k] for k in found if k < len(rows)]
    return held, [pairs[k - len(rows)] for k in found if k >= len(rows)]


def _nearest(
    z: dict[str, complex],
    sketch: Mapping[str, complex],
    held: Sequence[Given],
    rows: Sequence[Given],
) -> dict[str, complex]:
    """The shape with given dimensions whose points are nearest to the sketched ones.

    Newton's method for the least sum of squares under conditions: the points, and a multiplier for
    every dimension. ``held``: the rows without derivatives.
    """
    size = largest(abs(z[b] - z[a]) for a, b in combinations(z, 2))
    weights: Sequence[float] = [0.0] * len(rows)
    small = False
    for _ in range(_MOST_STEPS):
        start = {p: detached(sketch[p]) for p in z}
        step = _lagrange_step(z, start, held, held, weights, size)
        moved = _moved(z, step)
        z = {p: choose(small, place, moved[p]) for p, place in z.items()}
        weights = [w - change for w, change in zip(weights, step[2 * len(z) :], strict=True)]
        # the error after a step is about its square
        small = largest(map(abs, step[: 2 * len(z)])) <= _SMALL * size
        if everywhere(small):
            # one exact step from the solution has its derivatives (implicit function theorem)
            return _moved(z, _lagrange_step(z, sketch, held, rows, weights, size))
    raise np.linalg.LinAlgError


def _lagrange_step(
    z: Mapping[str, complex],
    sketch: Mapping[str, complex],
    held: Sequence[Given],
    rows: Sequence[Given],
    weights: Sequence[float],
    size: float,
) -> Sequence[float]:
    """Newton's step of x, y and multipliers, to be subtracted.

    Stationary: z - sketch + Σ w ∇(size · error) = 0; dimensions: size · error = 0.
    """
    count, many = 2 * len(z), len(rows)
    slopes = [[size * slope for slope in row] for row in _slopes(z, held)]
    bend = _bend(z, held, [size * w for w in weights])
    matrix = [[*bend[k], *(row[k] for row in slopes)] for k in range(count)]
    matrix += [[*row, *[0.0] * many] for row in slopes]
    pull = _slopes(z, rows)
    away = [z[p] - sketch[p] for p in z]
    right = [d.real for d in away] + [d.imag for d in away]
    for k, w in enumerate(weights):
        right = [r + size * w * slope for r, slope in zip(right, pull[k], strict=True)]
    return least_norm(matrix, [*right, *(size * row.error(z) for row in rows)])


def _bend(
    z: Mapping[str, complex], rows: Sequence[Given], weights: Sequence[float]
) -> list[list[float]]:
    """The identity plus the second derivatives of weighted errors, x then y: 2n rows of 2n."""
    names, count = list(z), len(z)
    found = [[float(i == k) for k in range(2 * count)] for i in range(2 * count)]
    for row, weight in zip(rows, weights, strict=True):
        for point in row.points:
            for axis, unit in ((0, 1.0 + 0j), (count, 1j)):
                for other, change in row.bend(z, point, unit).items():
                    i, k = names.index(other), names.index(point) + axis
                    found[i][k] = found[i][k] + weight * change.real
                    found[i + count][k] = found[i + count][k] + weight * change.imag
    return found


def _gauss_newton(
    z: dict[str, complex], rows: Sequence[Given], steps: int, first: int = _FIRST_STEPS
) -> dict[str, complex]:
    """Points that satisfy all rows, or the result of the last step.

    Designs that have not converged after ``first`` steps continue separately.
    """
    for k in range(steps):
        errors = [row.error(z) for row in rows]
        done = largest(abs(error) for error in errors) <= 1e-14
        if everywhere(done):
            break
        # in a family most designs need few steps: the others continue separately
        if k == first and (rest := rest_of(done)) is not None:
            return _gone_on(z, rows, steps - k, rest)
        moved = _moved(z, least_norm(_slopes(z, rows), errors))
        z = {p: choose(done, place, moved[p]) for p, place in z.items()}
    return z


def _moved(z: Mapping[str, complex], step: Sequence[float]) -> dict[str, complex]:
    """Points less a step of their coordinates, x then y."""
    count = len(z)
    return {p: place - vector(step[k], step[k + count]) for k, (p, place) in enumerate(z.items())}


def _detached(row: Given) -> Given:
    """A dimension without the derivatives of its number."""
    size = detached(row.size)
    return row if size is row.size else replace(row, size=size)


def _narrow(row: Given, rest: Rest) -> Given:
    return replace(row, size=rest.narrow(row.size), rest=rest.narrow(row.rest))


def _gone_on(
    z: Mapping[str, complex], rows: Sequence[Given], steps: int, rest: Rest
) -> dict[str, complex]:
    """Further steps of the designs that have not converged."""
    own = {point: rest.narrow(place) for point, place in z.items()}
    try:
        found = _gauss_newton(own, [_narrow(row, rest) for row in rows], steps, first=steps)
    finally:
        rest.leave()
    return {point: rest.widen(place, found[point]) for point, place in z.items()}


def _slopes(z: Mapping[str, complex], rows: Sequence[Given]) -> list[list[float]]:
    """Derivatives of the rows' errors with respect to all coordinates, x then y: rows of 2n."""
    found = []
    for row in rows:
        by = row.gradients(z)
        at = [by.get(point, 0j) for point in z]
        found.append([g.real for g in at] + [g.imag for g in at])
    return found


# ----------------------------------------------------------------------
# Construction of one rigid link from distances and angles between its points.


_IN_LINE = 2.0 * UNIT_ROUNDOFF  # of three sides: decimals in line may not be so as floats


@dataclass(frozen=True)
class LinkShape:
    """Local coordinates, real axis from the first to the second point, and measured dimensions.

    ``rest``: what the coordinates lose where they are rounded to floats.
    """

    local: Mapping[str, complex]
    measured: tuple[Distance, ...] = ()
    rest: Mapping[str, complex] = field(default_factory=dict)


@dataclass
class _Placing:
    """The state of placing points one by one."""

    points: tuple[str, ...]
    sketch: Mapping[str, Precise]
    distances: dict[frozenset[str], Precise]
    vertices: Sequence[VertexAngle]
    measured: Sequence[Distance] = ()
    z: dict[str, Precise] = field(default_factory=dict)

    def place_all(self) -> bool:
        """Place all points by given dimensions, from the first distance that leads to all."""
        rays = {frozenset((v.vertex, ray)) for v in self.vertices for ray in (v.a, v.b)}
        # a side of an angle first: its vertex has to be placed before the other side
        first = frozenset(self.points[:2])
        for pair in sorted(self.distances, key=lambda pair: (pair != first, pair not in rays)):
            a, b = sorted(pair, key=self.points.index)
            self.z = {a: Precise(0j), b: self.distances[pair] + 0j}
            while self.place_next():
                pass
            if len(self.z) == len(self.points):
                return True
        return False

    def direction(self, point: str) -> tuple[str, Precise] | None:
        """A placed vertex and the given direction from it to ``point``, a unit vector."""
        for v in self.vertices:
            other = v.a if v.b == point else v.b
            if point not in (v.a, v.b) or not {v.vertex, other} <= self.z.keys():
                continue
            ray = self.z[other] - self.z[v.vertex]
            sine, cosine = sin_cos(Precise(v.size, v.rest))
            turn = joined(cosine, sine if v.b == point else -sine)
            return v.vertex, turn * (ray / abs(ray))
        return None

    def place_next(self) -> bool:
        """Place one more point."""
        for point in self.points:
            if point in self.z:
                continue
            centres = [q for q in self.z if frozenset((q, point)) in self.distances]
            seen = self.direction(point)
            if seen is not None and centres:
                vertex, direction = seen
                length = self.distances.get(frozenset((vertex, point)))
                if length is not None:
                    self.z[point] = self.z[vertex] + direction * length
                else:
                    self.z[point] = self.on_ray(point, vertex, direction, centres[0])
                return True
            # two circles around placed points determine a point up to its side
            if len(centres) >= 2:
                self.z[point] = self.trilaterated(point, *centres[:2])
                return True
        return False

    def on_ray(self, point: str, vertex: str, direction: Precise, centre: str) -> Precise:
        """Where a ray from a vertex meets a circle, at the distance nearest to the sketched one."""
        radius = self.distances[frozenset((centre, point))]
        seen = (self.z[centre] - self.z[vertex]) * direction.conjugate()
        square, size = (radius - seen.imag) * (radius + seen.imag), radius.high * radius.high
        if square.high < -AGREE * size:
            raise ShapeError(
                f"no triangle has |{centre}{point}| = {radius.high:.12g} and this angle at "
                f"{vertex}, {abs(seen).high:.12g} away from {centre}"
            )
        # a ray that touches the circle: rounding must not part the two places
        half = sqrt(chosen(square.high > _IN_LINE * size, square, Precise(0.0)))
        near, far = seen.real - half, seen.real + half
        sketched = abs(self.sketch[point] - self.sketch[vertex]).high
        length = chosen(abs(near.high - sketched) < abs(far.high - sketched), near, far)
        return self.z[vertex] + direction * length

    def trilaterated(self, point: str, first: str, second: str) -> Precise:
        """The intersection of two circles, on the side of the sketch."""
        r1, r2 = (self.distances[frozenset((centre, point))] for centre in (first, second))
        base = self.z[second] - self.z[first]
        seen = [self.sketch[q] - self.sketch[first] for q in (point, second)]
        triangle = {frozenset(pair) for pair in combinations((first, second, point), 2)}
        if triangle <= {frozenset(d.points) for d in self.measured}:
            return self.z[first] + seen[0] / seen[1] * base
        d = abs(base)
        if d.high <= AGREE * largest((r1.high, r2.high)):
            raise ShapeError(
                f"{first} and {second} are at the same place: "
                f"{point} cannot be placed by its distances from both"
            )
        # law of cosines
        both, gap = r1 + r2, r1 - r2
        x = (both * gap / d + d) / 2.0
        square = r1 * r1 - x * x
        size = largest((r1.high, r2.high, d.high)) ** 2
        if square.high < -AGREE * size:
            raise ShapeError(
                f"no triangle has |{first}{second}| = {d.high:.12g}, "
                f"|{first}{point}| = {r1.high:.12g} and |{second}{point}| = {r2.high:.12g}"
            )
        # sides in line to the rounding of their numbers: it must not push the point off the line
        slack = smallest([(both - d).high, (d - abs(gap)).high])
        y = sqrt(chosen(slack > _IN_LINE * (both + d).high, square, Precise(0.0)))
        y = chosen((seen[0] * seen[1].conjugate()).imag.high < 0, -y, y)
        return self.z[first] + joined(x, y) * (base / d)


def place(
    points: tuple[str, ...],
    sketch: Mapping[str, complex | Precise],
    distances: Sequence[Distance],
    vertices: Sequence[VertexAngle],
) -> LinkShape:
    """Local coordinates of the points of one link.

    Parameters
    ----------
    points : tuple of str
        In the order of the link; one point gives the trivial shape.
    sketch : Mapping[str, complex]
        Sketched coordinates: select the mirror image and supply missing dimensions.
    distances, vertices : sequences
        Given dimensions of this link.

    Raises
    ------
    ShapeError
        If dimensions contradict each other.

    Notes
    -----
    Where exactly the missing distances are not given, they are measured. Where more are not given,
    the shape is the one nearest to the sketch: the sum of the squared distances of its points from
    the sketched ones is least. Neither depends on the order or the names of points and dimensions.

    Points are placed one by one if possible; otherwise Gauss-Newton solves all dimensions together.
    """
    if len(points) == 1:
        return LinkShape({points[0]: 0j}, rest={points[0]: 0j})
    seen = {p: precise(place) for p, place in sketch.items()}
    given: list[Given] = [*distances, *vertices]
    # n points have 2n coordinates; a link may still be moved and turned, 3 freedoms
    lacks = 2 * len(points) - 3 - len(given)
    measured = _measurable(points, seen, given) if lacks > 0 else []
    if len(measured) != lacks:
        measured = []
    for d in measured:
        if not d.size:
            raise ShapeError(
                f"{d.a} and {d.b} are sketched at the same place: give {d.key} a length"
            )
    known = {frozenset(d.points): Precise(d.size, d.rest) for d in (*distances, *measured)}
    state = _Placing(points, seen, known, vertices, measured)
    placed = (lacks <= 0 or bool(measured)) and state.place_all()
    if placed and all(fits(g, state.z, REDUNDANT) for g in given):
        return _upright(state.z, points, measured)
    try:
        with np.errstate(all="ignore"):  # overflow counts as disagreement and is reported
            z, more = nearest_shape(points, seen, [*given, *measured])
    except (np.linalg.LinAlgError, ShapeError) as error:
        if lacks < 0 and placed:
            raise _contradiction(given, state.z, points) from None
        if isinstance(error, ShapeError):
            raise
        raise ShapeError("no link has these dimensions near the sketch") from None
    return _upright(z, points, [*measured, *more])


def _measurable(
    points: tuple[str, ...], sketch: Mapping[str, Precise], given: Sequence[Given]
) -> list[Distance]:
    """The distances in the sketch that are not given, nor across from a given angle."""
    known = {frozenset(g.points) for g in given if isinstance(g, Distance)}
    for vertex in points:
        fans = [{g.a, g.b} for g in given if isinstance(g, VertexAngle) and g.vertex == vertex]
        # angles at one vertex add up
        for k, fan in enumerate(fans):
            for other in fans[:k]:
                fan |= other if fan & other else set()
        known |= {frozenset(pair) for fan in fans for pair in combinations(fan, 2)}
    return [
        Distance(a, b, length.high, length.low)
        for a, b in combinations(points, 2)
        if frozenset((a, b)) not in known
        for length in [abs(sketch[b] - sketch[a])]
    ]


def _contradiction(
    given: Sequence[Given], z: Mapping[str, Precise], points: tuple[str, ...]
) -> ShapeError:
    rounded = {p: place.high for p, place in z.items()}
    worst = max(given, key=lambda g: abs(g.error(rounded)))
    return ShapeError(
        f"a link of {len(points)} points has {2 * len(points) - 3} dimensions, "
        f"{len(given)} are given and disagree: the others give {compared(worst, z)}",
        worst.table,
        worst.key,
    )


def _upright(
    z: Mapping[str, Precise], points: tuple[str, ...], measured: Sequence[Distance]
) -> LinkShape:
    """Move the first point to the origin and the second onto the positive real axis."""
    axis = z[points[1]] - z[points[0]]
    if axis.high == 0:
        raise ShapeError(
            f"{points[0]} and {points[1]} coincide: the angle of a link needs two places"
        )
    size = abs(axis)
    turned = {p: (z[p] - z[points[0]]) * axis.conjugate() / size for p in points[2:]}
    local = {points[0]: Precise(0j), points[1]: size + 0j, **turned}
    low = {p: place.low for p, place in local.items()}
    return LinkShape({p: place.high for p, place in local.items()}, tuple(measured), low)


# ----------------------------------------------------------------------
# The exact shape of every link from its lengths and angles; the sketch selects sides.
#
# A link of n points has 2n - 3 dimensions. Those not given are measured between the sketched points
# and reported, or follow from the shape nearest to the sketch; more than 2n - 3 must agree.


def link_shapes(linkage: Bodies, problems: Problems) -> Shapes:
    """Shapes of all links; contradictions are added to ``problems``."""
    local: dict[str, Mapping[str, complex]] = {}
    rest: dict[str, Mapping[str, complex]] = {}
    numbers = linkage.numbers
    measured: list[Measured] = []
    lengths = {tuple(key.split()): number for key, number in linkage.lengths.items()}
    angles = {tuple(key.split()): number for key, number in linkage.angles.items()}
    lengths_at = _by_point(lengths)
    angles_at = _by_point(angles)
    for link, points in linkage.links.items():
        sketch = {point: linkage.precisely_sketched(point) for point in points}
        distances = [
            Distance(pair[0], pair[1], length.high, length.low)
            for pair in _inside(lengths_at, points)
            for length in [numbers.precise(lengths[pair])]
        ]
        vertices = [
            VertexAngle(a, v, b, angle.high, angle.low)
            for a, v, b in _inside(angles_at, points)
            for angle in [numbers.precise_angle(angles[a, v, b])]
        ]
        try:
            if link == GROUND:
                local[link] = {point: place.high for point, place in sketch.items()}
                rest[link] = {point: place.low for point, place in sketch.items()}
                _check_ground(local[link], distances, vertices)
                continue
            shape = place(tuple(points), sketch, distances, vertices)
        except ShapeError as error:
            problems.add(_key_of(error, link), error.message)
            continue
        local[link], rest[link] = shape.local, shape.rest
        measured += _measured(link, shape, linkage, problems)
    return Shapes(local, tuple(measured), rest)


def _by_point(table: Mapping[tuple[str, ...], object]) -> dict[str, list[tuple[str, ...]]]:
    found: dict[str, list[tuple[str, ...]]] = {}
    for key in table:
        found.setdefault(key[0], []).append(key)
    return found


def _inside(
    by_point: Mapping[str, list[tuple[str, ...]]], points: tuple[str, ...]
) -> list[tuple[str, ...]]:
    """The keys whose points all lie on one link, in the order of that link."""
    own = set(points)
    return [key for point in points for key in by_point.get(point, ()) if own.issuperset(key)]


def _key_of(error: ShapeError, link: str) -> tuple[str, ...]:
    return (error.table, error.key) if error.key else ("links", link)


def _check_ground(
    sketch: Mapping[str, complex], distances: list[Distance], vertices: list[VertexAngle]
) -> None:
    """Report ground dimensions that disagree with the exact coordinates."""
    named: dict[complex, str] = {}
    varying: list[str] = []
    for point, place_ in sketch.items():
        if is_batched(place_):
            varying.append(point)
        elif (other := named.setdefault(place_, point)) != point:
            raise _same_point(other, point)
    for k, point in enumerate(varying):
        for other in (*named.values(), *varying[:k]):
            if sketch[other] == sketch[point]:
                raise _same_point(*sorted((other, point), key=list(sketch).index))
    dimensions: list[Distance | VertexAngle] = [*distances, *vertices]
    for given in dimensions:
        if not agrees(given, sketch, AGREE):
            raise ShapeError(
                f"ground coordinates are exact and give {given.shown(sketch)}, "
                f"not {given.amount_text}: change [points] or leave this out",
                given.table,
                given.key,
            )


def _same_point(first: str, second: str) -> ShapeError:
    return ShapeError(f"{first} and {second} of ground are the same point: give it one name")


def _measured(link: str, shape: LinkShape, linkage: Bodies, problems: Problems) -> list[Measured]:
    found = [Measured(link=link, points=(d.a, d.b), length=d.size) for d in shape.measured]
    if linkage.sketch and found:
        wanted = ", ".join(f'"{m.points[0]} {m.points[1]}"' for m in found)
        problems.add(
            ("links", link),
            f"needs {wanted} in [lengths]: with sketch = true nothing is measured from [points]",
        )
    return found
