"""Construction of one rigid link from distances and angles between its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from linkwork.foundation.elementwise import (
    choose,
    largest,
    phase,
    rect,
    sqrt,
    vector,
)
from linkwork.mechanism.link_dimension import AGREE, Distance, Given, ShapeError, VertexAngle
from linkwork.mechanism.nearest_shape import nearest_shape

__all__ = ["LinkShape", "ShapeError", "place"]


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

    def place_all(self) -> bool:
        """Place all points by given dimensions, from the first distance that leads to all."""
        rays = {frozenset((v.vertex, ray)) for v in self.vertices for ray in (v.a, v.b)}
        # a side of an angle first: its vertex has to be placed before the other side
        first = frozenset(self.points[:2])
        for pair in sorted(self.distances, key=lambda pair: (pair != first, pair not in rays)):
            a, b = sorted(pair, key=self.points.index)
            self.z = {a: 0j, b: self.distances[pair] + 0j}
            while self.place_next():
                pass
            if len(self.z) == len(self.points):
                return True
        return False

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
                    self.z[point] = self.z[vertex] + rect(length, direction)
                else:
                    self.z[point] = self.on_ray(point, vertex, direction, centres[0])
                return True
            # two circles around placed points determine a point up to its side
            if len(centres) >= 2:
                self.z[point] = self.trilaterated(point, *centres[:2])
                return True
        return False

    def on_ray(self, point: str, vertex: str, direction: float, centre: str) -> complex:
        """Where a ray from a vertex meets a circle, at the distance nearest to the sketched one."""
        radius = self.distances[frozenset((centre, point))]
        seen = (self.z[centre] - self.z[vertex]) * rect(1.0, -direction)
        square = radius * radius - seen.imag * seen.imag
        if square < -AGREE * radius * radius:
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
        r1, r2 = (self.distances[frozenset((centre, point))] for centre in (first, second))
        base = self.z[second] - self.z[first]
        d = abs(base)
        if d <= AGREE * largest((r1, r2)):
            raise ShapeError(
                f"{first} and {second} are at the same place: "
                f"{point} cannot be placed by its distances from both"
            )
        # law of cosines
        x = (r1 * r1 - r2 * r2 + d * d) / (2.0 * d)
        square = r1 * r1 - x * x
        size = largest((r1, r2, d)) ** 2
        if square < -AGREE * size:
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
    Where exactly the missing distances are not given, they are measured. Where more are not given,
    the shape is the one nearest to the sketch: the sum of the squared distances of its points from
    the sketched ones is least. Neither depends on the order or the names of points and dimensions.

    Points are placed one by one if possible; otherwise Gauss-Newton solves all dimensions together.
    """
    if len(points) == 1:
        return LinkShape({points[0]: 0j})
    given: list[Given] = [*distances, *vertices]
    # n points have 2n coordinates; a link may still be moved and turned, 3 freedoms
    lacks = 2 * len(points) - 3 - len(given)
    measured = _measurable(points, sketch, given) if lacks > 0 else []
    if len(measured) != lacks:
        measured = []
    for d in measured:
        if not d.length:
            raise ShapeError(
                f"{d.a} and {d.b} are sketched at the same place: give {d.key} a length"
            )
    known = {frozenset(d.points): d.length for d in (*distances, *measured)}
    state = _Placing(points, sketch, known, vertices)
    if (lacks <= 0 or measured) and state.place_all():
        if all(g.agrees(state.z, AGREE) for g in given):
            return LinkShape(_upright(state.z, points), tuple(measured))
    else:
        state.z = {}
    try:
        with np.errstate(all="ignore"):  # overflow counts as disagreement and is reported
            z, more = nearest_shape(points, sketch, [*given, *measured])
    except (np.linalg.LinAlgError, ShapeError) as error:
        if lacks < 0 and state.z:
            raise _contradiction(given, state.z, points) from None
        if isinstance(error, ShapeError):
            raise
        raise ShapeError("no link has these dimensions near the sketch") from None
    return LinkShape(_upright(z, points), (*measured, *more))


def _measurable(
    points: tuple[str, ...], sketch: Mapping[str, complex], given: Sequence[Given]
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
        Distance(a, b, abs(sketch[b] - sketch[a]))
        for a, b in combinations(points, 2)
        if frozenset((a, b)) not in known
    ]


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
