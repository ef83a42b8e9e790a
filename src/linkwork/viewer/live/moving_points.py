"""Move points of a file: coordinates, and the lengths and angles that follow them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import permutations

from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import canonical
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.textfile.text_edits import TextEdits

__all__ = ["Before", "held_places", "move_points", "put_place", "rounded"]

_DIGITS = 12  # digits of measured dimensions; redundant ones must agree to nine


@dataclass(frozen=True, kw_only=True)
class Before:
    """The mechanism before a change, and coordinates of its points at the start (x, y)."""

    description: Description
    places: Mapping[str, tuple[float, float]]

    def place(self, point: str) -> complex:
        """The coordinates of a point: assembled, or as sketched if it cannot be assembled."""
        if point in self.places:
            return complex(*self.places[point])
        assert isinstance(self.description, Draft)
        return self.description.sketched(point)


def move_points(
    text: TextEdits,
    before: Before,
    linkage: Draft,
    places: Mapping[str, complex],
    *,
    follow: bool = True,
    keep: Collection[str] = (),
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Write other coordinates of points, and the dimensions that follow from them.

    Returns
    -------
    (followed, stayed)
        The dimensions that changed with the points, and those that did not: without ``follow``,
        those in ``keep``, and formulas.

    Raises
    ------
    InputError
        If the coordinates of a point are formulas.
    """
    for point, place in places.items():
        if formulas := [c for c in linkage.points[point] if isinstance(c, str)]:
            raise InputError(
                f'"{point}" has the formula {formulas[0]}: change a dimension in it instead'
            )
        put_place(text, point, place)
    # dimensions between points that move together do not change
    measured = [m for m in linkage.measured if _is_cut(m.points, places)]
    followed, stayed = [" ".join(m.points) for m in measured], []
    kept = set(map(_folded, keep))
    for table in ("lengths", "angles"):
        for key, number in getattr(linkage, table).items():
            names = key.split()
            if not _is_cut(names, places) or not linkage.points.keys() >= {*names}:
                continue
            # a formula keeps its dependence on dimensions
            if isinstance(number, str) or not follow or _folded(key) in kept:
                stayed.append(key)
                continue
            here = {p: places[p] if p in places else before.place(p) for p in names}
            text.put((table, key), _measure(key, here, linkage))
            followed.append(key)
    return tuple(followed), tuple(stayed)


def held_places(
    linkage: Draft, before: Before, wanted: Mapping[str, complex], keep: Collection[str]
) -> Mapping[str, complex]:
    """The places nearest to those wanted at which the lengths in ``keep`` stay."""
    # a lock may outlive its points
    kept = [key for key in keep if set(key.split()) <= linkage.points.keys()]
    held = list(_held_lengths(before, wanted, kept))
    if not held:
        return wanted
    if len(wanted) > 1 or len(held) > 2:
        return {point: before.place(point) for point in wanted}
    ((point, place),) = wanted.items()
    here = before.place(point)
    (centre, radius), *more = [(before.place(other), length) for other, length in held]
    if not more:
        away = place - centre
        return {point: centre + radius * away / abs(away) if away else here}
    found = _crossings(centre, radius, *more[0]) or [here]
    return {point: min(found, key=lambda crossing: abs(crossing - here))}


def _held_lengths(
    before: Before, wanted: Mapping[str, complex], keep: Collection[str]
) -> Iterator[tuple[str, float]]:
    """The other end of every kept length at a moved point, and the length."""
    for one, other in (pair for key in keep for pair in permutations(key.split(), 2)):
        if one in wanted and other not in wanted:
            yield other, abs(before.place(one) - before.place(other))


def _crossings(centre: complex, radius: float, other: complex, second: float) -> list[complex]:
    """The intersections of two circles."""
    apart = abs(other - centre)
    if not apart:
        return []
    along = (apart**2 + radius**2 - second**2) / (2 * apart)
    square = radius**2 - along**2
    if square < 0:
        return []
    unit = (other - centre) / apart
    return [centre + unit * complex(along, side * square**0.5) for side in (1, -1)]


def _is_cut(names: Collection[str], places: Mapping[str, complex]) -> bool:
    """Whether some of the points move and others do not."""
    return 0 < sum(name in places for name in names) < len(names)


def _folded(key: str) -> tuple[str, ...]:
    return tuple(sorted(map(canonical, key.split())))


def _measure(key: str, places: Mapping[str, complex], linkage: Draft) -> float:
    """A measured length, or angle in the file's unit, between points with coordinates."""
    match key.split():
        case [a, b]:
            return rounded(abs(places[b] - places[a]))
        case [a, vertex, b]:
            rays = (places[b] - places[vertex]) * (places[a] - places[vertex]).conjugate()
            return rounded(linkage.angle.from_radians(phase(rays)))
    raise ValueError(f"{key} names neither two nor three points")


def rounded(number: float) -> float:
    """A number with the digits of a file."""
    return float(f"{number:.{_DIGITS}g}")


def put_place(text: TextEdits, point: str, place: complex) -> None:
    """Write the coordinates of a point."""
    text.put(("points", point, 0), rounded(place.real))
    text.put(("points", point, 1), rounded(place.imag))
