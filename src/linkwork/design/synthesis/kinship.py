"""Delivered designs that are alike: Roberts' cognates, and images of one mechanism."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.design.synthesis.result import Synthesis, SynthesizedDesign

__all__ = ["are_cognates", "are_images", "groups_among"]

_ALIKE = 0.01  # of the longest link: fits of one minimum, reached from several starts
_SAME = 1e-3  # relative: numbers of mirror images


def groups_among(
    found: Synthesis, related: Callable[[SynthesizedDesign, SynthesizedDesign], bool]
) -> list[list[int]]:
    """The numbers of delivered loops that are related to the first one of their group."""
    groups: list[list[SynthesizedDesign]] = []
    for design in (own for own in found.of_loops if own.delivered):
        for group in groups:
            if related(group[0], design):
                group.append(design)
                break
        else:
            groups.append([design])
    return [[design.number for design in group] for group in groups if len(group) > 1]


def are_cognates(one: SynthesizedDesign, other: SynthesizedDesign) -> bool:
    """Whether four-bars have P in one place, and the other is a cognate of the first."""
    if not one.points.keys() == other.points.keys() == {"A0", "B0", "A", "B", "P"}:
        return False
    a0, b0, a, b, p = (one.points[name] for name in ("A0", "B0", "A", "B", "P"))
    share = (p - a) / (b - a)
    c0 = a0 + share * (b0 - a0)
    # parallelograms at A0 and B0, and triangles like that of the coupler
    left, right = a0 + p - a, b0 + p - b
    first = [(a0, left), (c0, left + share * (a - a0))]
    second = [(b0, right), (c0, right + (1.0 - share) * (b - b0))]
    own = np.array(
        [(other.points["A0"], other.points["A"]), (other.points["B0"], other.points["B"])]
    )
    away = np.abs([first - own, first - own[::-1], second - own, second - own[::-1]])
    most = max(away.max(axis=(1, 2)).min(), abs(other.points["P"] - p))
    return bool(most <= _ALIKE * max(one.size, other.size))


def are_images(one: SynthesizedDesign, other: SynthesizedDesign) -> bool:
    """Whether designs have the same links, by their longest, their shortest and their angle."""
    first, second = ((d.size, d.shortest, d.transmission) for d in (one, other))
    alike = one.mechanism == other.mechanism and one.drive is other.drive
    return alike and np.allclose(first, second, rtol=_SAME, atol=0.0)
