"""The exact shape of every link from its lengths and angles; the sketch selects sides.

A link of n points has 2n - 3 dimensions. Those not given are measured between the sketched points
and reported, or follow from the shape nearest to the sketch; more than 2n - 3 must agree.
"""

from __future__ import annotations

from collections.abc import Mapping

from linkwork.foundation.lanes import is_batched
from linkwork.foundation.names import GROUND
from linkwork.mechanism.bodies import Bodies, Measured, Shapes
from linkwork.mechanism.description import Problems
from linkwork.mechanism.link_dimension import AGREE, Distance, ShapeError, VertexAngle
from linkwork.mechanism.link_shape import LinkShape, place

__all__ = ["link_shapes"]


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
        if not given.agrees(sketch, AGREE):
            raise ShapeError(
                f"ground coordinates are exact and give {given.shown(sketch)}, "
                f"not {given.amount_text}: change [points] or leave this out",
                given.table,
                given.key,
            )


def _same_point(first: str, second: str) -> ShapeError:
    return ShapeError(f"{first} and {second} of ground are the same point: give it one name")


def _measured(link: str, shape: LinkShape, linkage: Bodies, problems: Problems) -> list[Measured]:
    found = [Measured(link=link, points=(d.a, d.b), length=d.length) for d in shape.measured]
    if linkage.sketch and found:
        wanted = ", ".join(f'"{m.points[0]} {m.points[1]}"' for m in found)
        problems.add(
            ("links", link),
            f"needs {wanted} in [lengths]: with sketch = true nothing is measured from [points]",
        )
    return found
