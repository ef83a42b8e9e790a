"""Arms of plates: bars along the shortest tree between holes, inner corners rounded by fillets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.export.plates.outline import Outline
from linkwork.export.plates.packages import shapely
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.elementwise import phase

__all__ = ["Arms", "arms_between"]

_EQUAL = 9  # decimals of a length over the longest: equal ones are taken in the order of the file
_STRAIGHT = 1e-9  # rad: arms that continue each other have no corner, those in one line no room
_ROOM = 1.0 - 1e-6  # of an arm, for the fillets at both ends

#: The numbers of the places at both ends of an arm.
Ends = tuple[int, int]


@dataclass(frozen=True, kw_only=True, eq=False)
class Arms:
    """The outline of a plate with arms; ``core``: convex pieces whose neighbourhood it fills."""

    outline: Outline
    core: tuple[ComplexArray, ...]


@dataclass(frozen=True, kw_only=True)
class _Corner:
    """Where the way around the arms goes from one to the next at ``place``.

    ``arriving``, ``leaving``: unit vectors; ``angle``: outside of the plate, between the arms
    [rad]; ``reach``: how far its fillet goes along both arms, 0 at an outer corner.
    """

    place: complex
    arriving: complex
    leaving: complex
    angle: float
    reach: float


def arms_between(
    places: Sequence[complex], slots: Collection[Ends], radius: float, fillet: float
) -> Arms | None:
    """The plate whose arms join places, with corners rounded; ``None`` without room for fillets.

    Parameters
    ----------
    places : sequence of complex
        Three or more, not in a line [mm].
    slots : collection of (int, int)
        Pairs of places that an arm has to join.
    radius, fillet : float
        Half the width of arms, and the radius of inner corners [mm].

    Notes
    -----
    Arms without a common end are farther apart than the width and twice the fillet, and fillets at
    both ends of an arm do not meet: then the outline does not cross itself.
    """
    arms, out = _tree(places, slots), radius + fillet
    lines = [shapely().LineString([(z.real, z.imag) for z in map(places.__getitem__, arm)])
             for arm in arms]  # fmt: skip
    for (one, first), (other, second) in itertools.combinations(zip(arms, lines, strict=True), 2):
        if not set(one) & set(other) and shapely().distance(first, second) < 2.0 * out:
            return None
    corners = list(_around(places, arms, out))
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        if start.reach + end.reach > _ROOM * abs(end.place - start.place):
            return None
    sides = [side for corner in corners for side in _sides(corner, radius)]
    fillets = (
        [c.place - c.reach * c.arriving, c.place, c.place + c.reach * c.leaving]
        for c in corners
        if c.reach
    )
    pieces = [[places[a], places[b]] for a, b in arms]
    return Arms(
        outline=Outline(
            corners=np.array([z for z, _ in sides]), bulges=np.array([b for _, b in sides])
        ),
        core=tuple(np.array(piece) for piece in (*pieces, *fillets)),
    )


def _tree(places: Sequence[complex], slots: Collection[Ends]) -> list[Ends]:
    """The shortest tree that joins all places and has the slots (Kruskal)."""
    pairs = list(itertools.combinations(range(len(places)), 2))
    length = {pair: abs(places[pair[1]] - places[pair[0]]) for pair in pairs}
    longest = max(length.values())
    pairs.sort(key=lambda pair: (pair not in slots, round(length[pair] / longest, _EQUAL)))
    group, found = list(range(len(places))), []
    for a, b in pairs:
        old, new = group[b], group[a]
        if old != new:
            found.append((a, b))
            group = [new if own == old else own for own in group]
    return found


def _around(places: Sequence[complex], arms: Sequence[Ends], out: float) -> Iterator[_Corner]:
    """The corners of the way around all arms, with these to the left."""
    near = {a: [b for arm in arms if a in arm for b in arm if b != a] for a in range(len(places))}

    def angle(before: int, here: int, after: int) -> float:
        if after == before:
            return math.tau
        back, onward = (places[k] - places[here] for k in (before, after))
        return phase(onward / back) % math.tau

    begin = before, here = arms[0]
    while True:
        turned, after = min((angle(before, here, k), k) for k in near[here])
        arriving, leaving = places[here] - places[before], places[after] - places[here]
        inner = turned < math.pi - _STRAIGHT
        yield _Corner(
            place=places[here],
            arriving=arriving / abs(arriving),
            leaving=leaving / abs(leaving),
            angle=turned,
            reach=out / math.tan(max(turned, _STRAIGHT) / 2.0) if inner else 0.0,
        )
        before, here = here, after
        if (before, here) == begin:
            return


def _sides(corner: _Corner, radius: float) -> Iterator[tuple[complex, float]]:
    """The arc at a corner and the line that leaves it: their starts, with bulges."""
    bent = corner.angle - math.pi
    if abs(bent) <= _STRAIGHT:
        return
    yield corner.place - (corner.reach + 1j * radius) * corner.arriving, math.tan(bent / 4.0)
    yield corner.place + (corner.reach - 1j * radius) * corner.leaving, 0.0
