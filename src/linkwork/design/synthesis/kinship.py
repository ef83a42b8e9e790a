"""Delivered designs that are alike: Roberts' cognates, and images of one mechanism."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.design.synthesis.result import Synthesis, SynthesizedDesign

__all__ = ["are_cognates", "are_images", "groups_among"]

_ALIKE = 0.01  # of the longest link: fits of one minimum, reached from several starts
_EQUAL_NUMBERS = 1e-3  # relative: numbers of mirror images

Relation = Callable[[SynthesizedDesign, SynthesizedDesign], bool]


def groups_among(found: Synthesis, related: Relation) -> list[list[int]]:
    """The numbers of delivered loops that are related to the first one of their group."""
    groups: list[list[SynthesizedDesign]] = []
    for design in (own for own in found.of_loops if own.delivered):
        group = next((group for group in groups if related(group[0], design)), None)
        if group is None:
            groups.append(group := [])
        group.append(design)
    return [[design.number for design in group] for group in groups if len(group) > 1]


def are_cognates(one: SynthesizedDesign, other: SynthesizedDesign) -> bool:
    """Whether four-bars have P in one place, and the other is a cognate of the first."""
    if not one.points.keys() == other.points.keys() == {"A0", "B0", "A", "B", "P"}:
        return False
    a0, b0, a, b, p = (one.points[name] for name in ("A0", "B0", "A", "B", "P"))
    c0 = a0 + (p - a) / (b - a) * (b0 - a0)
    cranks = np.array([other.points[name] for name in ("A0", "A", "B0", "B")]).reshape(2, 2)
    # a crank of the other is a side of a parallelogram at A0 or B0
    own = np.array([(a0, a0 + p - a), (b0, b0 + p - b)])
    shared = np.abs(cranks[:, None] - own).max(axis=2).min()
    away = max(shared, np.abs(cranks[:, 0] - c0).min(), abs(other.points["P"] - p))
    return bool(away <= _ALIKE * max(one.size, other.size))


def are_images(one: SynthesizedDesign, other: SynthesizedDesign) -> bool:
    """Whether designs have the same links, by their longest, their shortest and their angle."""
    first, second = ((d.size, d.shortest, d.transmission) for d in (one, other))
    alike = one.mechanism == other.mechanism and one.drive is other.drive
    return alike and np.allclose(first, second, rtol=_EQUAL_NUMBERS, atol=0.0)
