"""Sizes of drawn wheels: they fit the distance of their centres and the wheels that exist."""

from __future__ import annotations

from linkwork.mechanism.draft import Draft
from linkwork.mechanism.part.wheel_pair import WheelPair

__all__ = ["gear_teeth", "pulley_radii"]

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
    found = [
        size if size > 0 else _radius(draft, wheel)
        for size, wheel in zip(sizes, wheels, strict=True)
    ]
    usual = found[0] or found[1] or distance / 4
    return found[0] or usual, found[1] or usual


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
