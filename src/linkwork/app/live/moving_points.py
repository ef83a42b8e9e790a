"""Points and links as they are written in a text."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import permutations

from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.part.gears import WheelPair
from linkwork.core.textfile.writer import TextEdits


def check_point(text: TextEdits, name: str) -> str:
    """A point as it is spelled in the text; an error if there is none."""
    known = text.keys(("points",))
    for spelled in known:
        if canonical(spelled) == canonical(name):
            return spelled
    raise UnknownNameError(f'there is no point "{name}" {choices("points", known, name)}')


def add_entry(text: TextEdits, table: str, name: str, entry: object) -> None:
    """Add a named entry to a table; an error if the name is in it."""
    if text.has((table, name)):
        raise InputError(f'"{name}" is already in [{table}]: choose another name')
    text.put((table, name), entry)


def points_of(text: TextEdits, link: str) -> list[str]:
    """The points of a link; an error if there is none."""
    if not text.has(("links", link)):
        known = text.keys(("links",))
        raise UnknownNameError(f'there is no link "{link}" {choices("links", known, link)}')
    return text.names(("links", link))


def carry(text: TextEdits, link: str, point: str) -> None:
    """Add a point to a link; an error if the link carries it."""
    points = points_of(text, link)
    if canonical(point) in map(canonical, points):
        raise InputError(f'"{link}" carries "{point}" already')
    text.put(("links", link), [*points, point])


def drop_loose_dimensions(text: TextEdits) -> None:
    """Remove lengths and angles between points that are no longer on one link."""
    links = [{canonical(p) for p in points_of(text, link)} for link in text.keys(("links",))]
    for table in ("lengths", "angles"):
        for key in text.keys((table,)):
            if not any({canonical(p) for p in key.split()} <= points for points in links):
                text.remove((table, key))


def drop_lost_inputs(text: TextEdits, *names: str) -> None:
    """Remove inputs that drive something that was removed."""
    lost = set(map(canonical, names))
    driven = ("link", "slider", "cylinder", "relative_to")
    for k, row in reversed(list(text.entries("input"))):
        if any(canonical(str(row[key])) in lost for key in driven if key in row):
            text.remove(("input", k))


# ----------------------------------------------------------------------
# Move points of a file: coordinates, and the lengths and angles that follow them.


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
    linkage: Draft, before: Before, targets: Mapping[str, complex], keep: Collection[str]
) -> Mapping[str, complex]:
    """The places nearest to ``targets`` at which the lengths in ``keep`` stay."""
    # a lock may outlive its points
    kept = [key for key in keep if set(key.split()) <= linkage.points.keys()]
    held = list(_held_lengths(before, targets, kept))
    if not held:
        return targets
    if len(targets) > 1 or len(held) > 2:
        return {point: before.place(point) for point in targets}
    ((point, place),) = targets.items()
    here = before.place(point)
    (centre, radius), *more = [(before.place(other), length) for other, length in held]
    if not more:
        away = place - centre
        return {point: centre + radius * away / abs(away) if away else here}
    places = _crossings(centre, radius, *more[0]) or [here]
    return {point: min(places, key=lambda crossing: abs(crossing - here))}


def _held_lengths(
    before: Before, targets: Mapping[str, complex], keep: Collection[str]
) -> Iterator[tuple[str, float]]:
    """The other end of every kept length at a moved point, and the length."""
    for one, other in (pair for key in keep for pair in permutations(key.split(), 2)):
        if one in targets and other not in targets:
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
    """Whether only some of the points move."""
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


# ----------------------------------------------------------------------
# Sizes of drawn wheels: they fit the distance of their centres and the wheels that exist.


_FEWEST = 20  # teeth of the smaller gear
_MOST = 2000
_LEAST = 0.02  # radius of the smaller gear, of the centre distance

_Pair = tuple[float, float]


def gear_teeth(
    draft: Draft, wheels: tuple[str, str], distance: float, sizes: _Pair, around: bool
) -> tuple[tuple[int, int], bool]:
    """Teeth of two gears, and whether one is a ring.

    Parameters
    ----------
    draft : Draft
        The wheels that exist already.
    wheels : (str, str)
        The links.
    distance : float
        Of their centres [length].
    sizes : (float, float)
        Drawn radii [length]; 0 where none was drawn.
    around : bool
        Whether the second gear is a ring around the first one, unless a radius was drawn.
    """
    known = [_radius(draft, wheel) for wheel in wheels]
    first, second = known
    if sizes[1] > 0 or (sizes[0] <= 0 < second and not first):
        second = sizes[1] if sizes[1] > 0 else second
        first = _partner(second, distance)
    elif sizes[0] > 0 or first > 0:
        first = sizes[0] if sizes[0] > 0 else first
        second = distance + first if around and sizes[0] <= 0 else _partner(first, distance)
    else:
        first = second = distance / 2
    internal = max(first, second) > distance
    count, other = (_teeth(draft, wheel) for wheel in wheels)
    if not (count or other):
        count = max(_FEWEST, round(_FEWEST * first / second))
    count = count or max(1, min(_MOST, round(other * first / second)))
    other = max(1, min(_MOST, round(count * second / first)))
    if internal and other == count:
        other += 1 if second > first else -1
    return (count, other), internal


def _partner(radius: float, distance: float) -> float:
    """The radius of a gear in mesh with another one."""
    return max(abs(distance - radius), _LEAST * distance)


def pulley_radii(draft: Draft, wheels: tuple[str, str], distance: float, sizes: _Pair) -> _Pair:
    """Radii of two pulleys [length]: as drawn, as they are, or a quarter of the distance."""
    radii = [
        size if size > 0 else _radius(draft, wheel)
        for size, wheel in zip(sizes, wheels, strict=True)
    ]
    usual = radii[0] or radii[1] or distance / 4
    return radii[0] or usual, radii[1] or usual


def _radius(draft: Draft, wheel: str) -> float:
    """The radius of a wheel that is one of a pair already; otherwise 0."""
    for pair in draft.of(WheelPair):
        if wheel in pair.wheels:
            return pair.pitch_radii(draft)[pair.wheels.index(wheel)]
    return 0.0


def _teeth(draft: Draft, wheel: str) -> int:
    """The number of teeth of a gear; 0 if it has none."""
    for pair in draft.of(WheelPair):
        if wheel in pair.wheels and pair.teeth is not None:
            return round(draft.numbers(pair.teeth[pair.wheels.index(wheel)]))
    return 0
