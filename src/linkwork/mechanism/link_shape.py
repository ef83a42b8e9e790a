"""Construction of one rigid link from distances and angles between its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from linkwork.foundation.elementwise import largest, smallest
from linkwork.foundation.precise import Precise, chosen, joined, precise, sin_cos, sqrt
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.mechanism.link_dimension import (
    AGREE,
    Distance,
    Given,
    ShapeError,
    VertexAngle,
    compared,
    fits,
)
from linkwork.mechanism.nearest_shape import REDUNDANT, nearest_shape

__all__ = ["LinkShape", "ShapeError", "place"]

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
            sine, cosine = sin_cos(Precise(v.angle, v.rest))
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
        if not d.length:
            raise ShapeError(
                f"{d.a} and {d.b} are sketched at the same place: give {d.key} a length"
            )
    known = {frozenset(d.points): Precise(d.length, d.rest) for d in (*distances, *measured)}
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
