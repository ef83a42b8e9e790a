"""Delivered designs that are alike: Roberts' cognates, and images of one mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from linkwork.design.precision.cognates import cognates, exchange_legs
from linkwork.design.synthesis.result import Synthesis, SynthesizedDesign

__all__ = ["alike_among"]

_ALIKE = 0.01  # of the longest link of the smaller one: fits of one minimum from several starts
_EQUAL_NUMBERS = 1e-3  # relative: numbers of mirror images

_LEGS = ("A", "A0", "B", "B0")
_Pair = tuple[SynthesizedDesign, SynthesizedDesign]


def alike_among(found: Synthesis) -> Iterator[str]:
    """The groups of delivered loops that are alike, in words."""
    loops = [design for design in found.of_loops if design.delivered]
    images = list(_images(loops))
    # of a symmetric curve a cognate may be the mirror image, which has the same links
    others = [pair for pair in _cognates(loops) if pair not in images]
    for told, pairs in (
        ("Cognates draw one curve with different links", others),
        ("The same links in different places", images),
    ):
        groups: list[set[int]] = []
        for one, other in pairs:
            pair = {one.number, other.number}
            joined = [group for group in groups if group & pair]
            groups = [g for g in groups if g not in joined] + [pair.union(*joined)]
        shown = [", ".join(map(str, sorted(group))) for group in sorted(groups, key=min)]
        if shown:
            yield f"{told}: designs {'; '.join(shown)}."


def _cognates(loops: Sequence[SynthesizedDesign]) -> Iterator[_Pair]:
    """Four-bars with P in one place, the second of which is a cognate of the first."""
    loops = [design for design in loops if design.points.keys() == {*_LEGS, "P"}]
    places = np.array([[d.points[name] for name in (*_LEGS, "P")] for d in loops]).reshape(-1, 5)
    legs, sizes = places[:, :4] - places[:, 4:], np.array([design.size for design in loops])
    linkages = np.stack([legs, legs.conj()], axis=2).reshape(-1, 8)
    for k, one in enumerate(loops):
        rest = slice(k + 1, None)
        wanted = np.array([linkages[rest], exchange_legs(linkages[rest])])
        own = np.array(cognates(linkages[k : k + 1]))[:, None]
        away = np.abs(own - wanted).max(axis=3).min(axis=(0, 1))
        away = np.maximum(away, np.abs(places[rest, 4] - places[k, 4]))
        near = away <= _ALIKE * np.minimum(sizes[rest], sizes[k])
        yield from ((one, loops[k + 1 + int(i)]) for i in np.flatnonzero(near))


def _images(loops: Sequence[SynthesizedDesign]) -> Iterator[_Pair]:
    """Designs with the same links, by their longest, their shortest and their angle."""
    numbers = np.array([(d.size, d.shortest, d.transmission) for d in loops]).reshape(-1, 3)
    for k, one in enumerate(loops):
        alike = np.isclose(numbers[k + 1 :], numbers[k], rtol=_EQUAL_NUMBERS, atol=0.0)
        for other in (loops[k + 1 + int(i)] for i in np.flatnonzero(alike.all(axis=1))):
            if one.mechanism == other.mechanism and one.drive is other.drive:
                yield one, other
