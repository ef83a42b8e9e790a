"""Construction of one rigid link from distances and angles between its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from linkwork.foundation.elementwise import (
    choose,
    detached,
    everywhere,
    largest,
    phase,
    rect,
    sqrt,
    vector,
)
from linkwork.foundation.lanes import Rest, rest_of
from linkwork.mechanism.least_norm import full_rank, least_norm
from linkwork.mechanism.link_dimension import Distance, Given, VertexAngle

__all__ = ["LinkShape", "ShapeError", "place"]

_AGREE = 1e-9
_MOST_STEPS = 60
_FIRST_STEPS = 6  # most shapes need four


class ShapeError(Exception):
    """Dimensions of one link that contradict each other."""

    def __init__(self, message: str, table: str = "", key: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.table = table
        self.key = key


@dataclass(frozen=True)
class LinkShape:
    """Local coordinates, real axis from the first to the second point, and measured dimensions."""

    local: Mapping[str, complex]
    measured: tuple[Distance, ...] = ()


@dataclass
class _Placing:
    """The state of placing points one by one."""

    points: tuple[str, ...]
    sketch: Mapping[str, complex]
    distances: dict[frozenset[str], float]
    vertices: Sequence[VertexAngle]
    z: dict[str, complex] = field(default_factory=dict)
    measured: list[Distance] = field(default_factory=list)

    def distance(self, a: str, b: str, measure: bool) -> float | None:
        """The given distance, or on request the sketched one, recorded as measured."""
        given = self.distances.get(frozenset((a, b)))
        if given is not None or not measure:
            return given
        length = abs(self.sketch[b] - self.sketch[a])
        if length == 0.0:
            raise ShapeError(f"{a} and {b} are sketched at the same place: give {a} {b} a length")
        self.measured.append(Distance(a, b, length))
        self.distances[frozenset((a, b))] = length
        return length

    def direction(self, point: str) -> tuple[str, float] | None:
        """A placed vertex and the given direction from it to ``point``."""
        for v in self.vertices:
            if v.vertex not in self.z:
                continue
            if v.b == point and v.a in self.z:
                return v.vertex, phase(self.z[v.a] - self.z[v.vertex]) + v.angle
            if v.a == point and v.b in self.z:
                return v.vertex, phase(self.z[v.b] - self.z[v.vertex]) - v.angle
        return None

    def place_next(self, measure: int) -> bool:
        """Place one more point from given and at most ``measure`` measured dimensions."""
        for point in self.points:
            if point in self.z:
                continue
            seen = self.direction(point)
            if seen is not None:
                vertex, direction = seen
                length = self.distance(vertex, point, measure >= 1)
                if length is not None:
                    self.z[point] = self.z[vertex] + rect(length, direction)
                    return True
            centres = [q for q in self.z if frozenset((q, point)) in self.distances]
            if seen is not None and centres:
                self.z[point] = self.on_ray(point, *seen, centres[0])
                return True
            # two circles around placed points determine a point up to its side
            if len(centres) + measure < 2:
                continue
            others = [q for q in self.points if q in self.z and q not in centres]
            first, second = (centres + others)[:2]
            self.z[point] = self.trilaterated(point, first, second)
            return True
        return False

    def on_ray(self, point: str, vertex: str, direction: float, centre: str) -> complex:
        """Where a ray from a vertex meets a circle, at the distance nearest to the sketched one."""
        radius = self.distance(centre, point, measure=False)
        assert radius is not None
        seen = (self.z[centre] - self.z[vertex]) * rect(1.0, -direction)
        square = radius * radius - seen.imag * seen.imag
        if square < -_AGREE * radius * radius:
            raise ShapeError(
                f"no triangle has |{centre}{point}| = {radius:.12g} and this angle at {vertex}, "
                f"{abs(seen):.12g} away from {centre}"
            )
        # a ray that touches the circle: rounding must not part the two places
        half = sqrt(choose(square > 1e-14 * radius * radius, square, 0.0))
        near, far = seen.real - half, seen.real + half
        sketched = abs(self.sketch[point] - self.sketch[vertex])
        length = choose(abs(near - sketched) < abs(far - sketched), near, far)
        return self.z[vertex] + rect(length, direction)

    def trilaterated(self, point: str, first: str, second: str) -> complex:
        """The intersection of two circles, on the side of the sketch."""
        r1 = self.distance(first, point, measure=True)
        r2 = self.distance(second, point, measure=True)
        assert r1 is not None
        assert r2 is not None
        base = self.z[second] - self.z[first]
        d = abs(base)
        if d <= _AGREE * largest((r1, r2)):
            raise ShapeError(
                f"{first} and {second} are at the same place: "
                f"{point} cannot be placed by its distances from both"
            )
        # law of cosines
        x = (r1 * r1 - r2 * r2 + d * d) / (2.0 * d)
        square = r1 * r1 - x * x
        size = largest((r1, r2, d)) ** 2
        if square < -_AGREE * size:
            raise ShapeError(
                f"no triangle has |{first}{second}| = {d:.12g}, |{first}{point}| = {r1:.12g} "
                f"and |{second}{point}| = {r2:.12g}"
            )
        # three points in line: rounding must not push the third off the line
        y = sqrt(choose(square > 1e-14 * size, square, 0.0))
        sketched = (self.sketch[point] - self.sketch[first]) * (
            self.sketch[second] - self.sketch[first]
        ).conjugate()
        y = choose(sketched.imag < 0, -y, y)
        return self.z[first] + vector(x, y) * base / d


def place(
    points: tuple[str, ...],
    sketch: Mapping[str, complex],
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
    Points are placed one by one if possible; otherwise Gauss-Newton solves all given dimensions
    together with the sketched distances that complete them.
    """
    if len(points) == 1:
        return LinkShape({points[0]: 0j})
    known = {frozenset(d.points): d.length for d in distances}
    state = _Placing(points, sketch, known, vertices)
    a, b = _base(points, distances, vertices)
    length = state.distance(a, b, measure=True)
    assert length is not None
    state.z = {a: 0j, b: length + 0j}
    while len(state.z) < len(points):
        # given dimensions first, so that as few as possible are measured in the sketch
        if not (state.place_next(0) or state.place_next(1)):
            state.place_next(2)
    given: list[Given] = [*distances, *vertices]
    # what places a point before the last dimension is used need not be measured after all
    measured = state.measured if len(given) < 2 * len(points) - 3 else []
    z = state.z
    if not all(g.agrees(z, _AGREE) for g in given):
        # n points have 2n coordinates; a link may still be moved and turned, 3 freedoms
        if len(given) > 2 * len(points) - 3:
            raise _contradiction(given, z, points)
        try:
            with np.errstate(all="ignore"):  # overflow counts as disagreement and is reported
                z, measured = _together(points, sketch, given)
        except np.linalg.LinAlgError:
            raise ShapeError("no link has these dimensions near the sketch") from None
    return LinkShape(_upright(z, points), tuple(measured))


def _base(
    points: tuple[str, ...], distances: Sequence[Distance], vertices: Sequence[VertexAngle]
) -> tuple[str, str]:
    """The pair placed first: the link's first two points unless others have a given distance."""
    given = {frozenset(d.points) for d in distances}
    first = (points[0], points[1])
    if frozenset(first) in given or not given:
        return first
    pairs = [d.points for d in distances]
    with_angle = [
        (v.vertex, ray)
        for v in vertices
        for ray in (v.a, v.b)
        if frozenset((v.vertex, ray)) in given
    ]
    a, b = (with_angle or pairs)[0]
    return a, b


def _contradiction(
    given: Sequence[Given], z: Mapping[str, complex], points: tuple[str, ...]
) -> ShapeError:
    worst = max(given, key=lambda g: abs(g.error(z)))
    return ShapeError(
        f"a link of {len(points)} points has {2 * len(points) - 3} dimensions, "
        f"{len(given)} are given and disagree: "
        f"the others give {worst.shown(z)}, not {worst.amount_text}",
        worst.table,
        worst.key,
    )


def _together(
    points: tuple[str, ...], sketch: Mapping[str, complex], given: Sequence[Given]
) -> tuple[dict[str, complex], list[Distance]]:
    """Solve all dimensions together from the sketch, completed by measured distances."""
    rows: list[Given] = list(given)
    measured: list[Distance] = []
    # the sketch selects a shape; only what is measured in it enters its dimensions
    start = {p: detached(sketch[p]) for p in points}
    for i in range(len(points)):
        for j in range(i + 1, len(points)):
            if len(rows) >= 2 * len(points) - 3:
                break
            length = abs(sketch[points[j]] - sketch[points[i]])
            candidate = Distance(points[i], points[j], length)
            # a measured length is added only if it is independent of the others
            if length and full_rank(_slopes(start, _detached([*rows, candidate])), 1e-9):
                rows.append(candidate)
                measured.append(candidate)
    held = _detached(rows)
    placed = _gauss_newton(start, held, _MOST_STEPS)
    if any(own is not row for own, row in zip(held, rows, strict=True)):
        # one exact step from the solution has its derivatives (implicit function theorem)
        errors = [row.error(placed) for row in rows]
        placed = _moved(placed, least_norm(_slopes(placed, held), errors))
    wrong = [row for row in given if not row.agrees(placed, _AGREE)]
    if wrong:
        raise ShapeError(
            f"no link has these dimensions near the sketch; nearest has {wrong[0].shown(placed)}, "
            f"not {wrong[0].amount_text}",
            wrong[0].table,
            wrong[0].key,
        )
    return placed, measured


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


def _detached(rows: Sequence[Given]) -> list[Given]:
    """Dimensions without the derivatives of their numbers."""
    return [row.detached() for row in rows]


def _gone_on(
    z: Mapping[str, complex], rows: Sequence[Given], steps: int, rest: Rest
) -> dict[str, complex]:
    """Further steps of the designs that have not converged."""
    own = {point: rest.narrow(place) for point, place in z.items()}
    try:
        found = _gauss_newton(own, [row.narrow(rest) for row in rows], steps, first=steps)
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


def _upright(z: Mapping[str, complex], points: tuple[str, ...]) -> dict[str, complex]:
    """Move the first point to the origin and the second onto the positive real axis."""
    axis = z[points[1]] - z[points[0]]
    if axis == 0:
        raise ShapeError(
            f"{points[0]} and {points[1]} coincide: the angle of a link needs two places"
        )
    size = abs(axis)
    turned = {p: (z[p] - z[points[0]]) * axis.conjugate() / size for p in points[2:]}
    return {points[0]: 0j, points[1]: size + 0j, **turned}
