"""Delivered designs that are alike: Roberts' cognates, and images of one mechanism."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from linkwork.design.precision.cognates import cognates, exchange_legs
from linkwork.design.synthesis.result import Synthesis, SynthesizedDesign

__all__ = ["alike_among"]

_ALIKE = 0.01  # of the longest link: fits of one minimum, reached from several starts
_EQUAL_NUMBERS = 1e-3  # relative: numbers of mirror images

_LEGS = ("A", "A0", "B", "B0")


def alike_among(found: Synthesis) -> Iterator[str]:
    """The pairs of delivered loops that are alike, in words."""
    loops = [design for design in found.of_loops if design.delivered]
    for told, related in (
        ("Cognates draw one curve with different links", _are_cognates),
        ("The same links in different places", _are_images),
    ):
        pairs = ((one, other) for one, other in combinations(loops, 2) if related(one, other))
        shown = [f"designs {one.number} and {other.number}" for one, other in pairs]
        if shown:
            yield f"{told}: {'; '.join(shown)}."


def _are_cognates(one: SynthesizedDesign, other: SynthesizedDesign) -> bool:
    """Whether four-bars have P in one place, and the other is a cognate of the first."""
    if not one.points.keys() == other.points.keys() == {*_LEGS, "P"}:
        return False
    p = one.points["P"]
    legs = np.array([[d.points[name] - p for name in _LEGS] for d in (one, other)])
    linkages = np.stack([legs, legs.conj()], axis=2).reshape(2, 8)
    wanted = np.array([linkages[1], *exchange_legs(linkages[1:])])
    away = np.abs([found - wanted for found in cognates(linkages[:1])]).max(axis=2).min()
    most = max(float(away), abs(other.points["P"] - p))
    return most <= _ALIKE * max(one.size, other.size)


def _are_images(one: SynthesizedDesign, other: SynthesizedDesign) -> bool:
    """Whether designs have the same links, by their longest, their shortest and their angle."""
    first, second = ((d.size, d.shortest, d.transmission) for d in (one, other))
    alike = one.mechanism == other.mechanism and one.drive is other.drive
    return alike and np.allclose(first, second, rtol=_EQUAL_NUMBERS, atol=0.0)
