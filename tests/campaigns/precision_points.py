"""The referee of four-bars through precision positions.

Nine random points in half of the tasks. The other tasks are positions of a random four-bar, nine
points or those of another family; it has to be among the solutions.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.synthesis.precision.positions import PrecisionPositions
from linkwork.synthesis.precision.solving import (
    SHIPPED_PROBLEMS,
    CompiledTracker,
    PrecisionFourBars,
    four_bars_through,
    start_member,
)

__all__ = ["precision_campaign"]

_ROUNDING = 64.0 * 2.0**-53  # of the referee's own sums, relative to the largest number
_NEAR = 1e-6  # of the original's size: a solution this near is the original


def precision_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """So many tasks; what was found, and what is false."""
    counts, false = Counter[str](), list[str]()
    for k in range(part * count, (part + 1) * count):
        rng = np.random.default_rng([41, k])
        others = SHIPPED_PROBLEMS[1:]
        problem = others[(k // 4) % len(others)] if k % 4 == 3 else SHIPPED_PROBLEMS[0]
        original = None
        if k % 4 < 2:
            points, none = normal_numbers(rng, 9), np.zeros(0, dtype=complex)
            task = PrecisionPositions.of(points, np.full(9, np.nan), none)
        else:
            original, points, turns = _random_four_bar(rng, 1 + problem.poses + problem.points)
            posed = rng.permutation(len(points))[: problem.poses + 1 if problem.poses else 0]
            angles = np.where(np.isin(np.arange(len(points)), posed), turns, np.nan)
            pivots = original[: problem.pivots, 0]
            task = PrecisionPositions.of(points, angles, pivots)
        found = four_bars_through(task, CompiledTracker(1))
        name = f"{problem.name}{'' if original is None else ' of a four-bar'}"
        _count(counts, name, found)
        false += [f"task {k}, {name}: {what}" for what in _wrong(task, found, original)]
    return counts, false


def _random_four_bar(
    rng: np.random.Generator, count: int
) -> tuple[ComplexArray, ComplexArray, Array]:
    """Fixed and moving pivots (2, 1 + J), the point (J,) and the angles (J,) of the coupler."""
    while True:
        ground, crank, coupler, rocker = rng.uniform(0.3, 2.0, 4)
        turned = np.sort(rng.uniform(0.0, 2.0 * np.pi, count))
        a = crank * np.exp(1j * turned)
        away = ground - a
        cosine = (np.abs(away) ** 2 + coupler**2 - rocker**2) / (2.0 * np.abs(away) * coupler)
        if np.abs(cosine).max() < 0.999:
            break
    b = a + coupler * away / np.abs(away) * np.exp(1j * np.arccos(cosine))
    points = a + (b - a) * complex(*rng.normal(size=2))
    ends = np.stack([np.concatenate([[0.0], a]), np.concatenate([[ground], b])])
    return ends, points, np.angle(b - a)


def _count(counts: Counter[str], name: str, found: PrecisionFourBars) -> None:
    roots = found.roots
    expected = roots.paths
    counts[f"{name}: tasks"] += 1
    counts[f"{name}: solutions found"] += len(roots.x)
    counts[f"{name}: solutions missing"] += (
        expected - len(roots.x) - roots.at_infinity - len(roots.singular)
    )
    counts[f"{name}: tasks with all solutions"] += len(roots.x) == expected
    counts[f"{name}: tasks called complete"] += found.completeness.complete
    counts[f"{name}: paths lost"] += roots.lost
    counts[f"{name}: at infinity"] += roots.at_infinity
    counts[f"{name}: singular"] += len(roots.singular)
    counts[f"{name}: added as mirror images"] += roots.by_mirror
    counts[f"{name}: added by detours"] += roots.by_detour
    counts[f"{name}: real"] += found.real
    counts[f"{name}: four-bars"] += len(found)
    counts[f"{name}: four-bars proved"] += int(found.proved.sum())


def _wrong(
    task: PrecisionPositions, found: PrecisionFourBars, original: ComplexArray | None
) -> list[str]:
    """False claims: proved four-bars that miss, a complete list without the original."""
    false = []
    lengths = (
        found.moving_a - found.fixed_a[:, None], found.moving_b - found.fixed_b[:, None],
        found.moving_b - found.moving_a, found.guided - found.moving_a,
        found.guided - found.moving_b,
    )  # fmt: skip
    largest = max(float(np.abs(z).max(initial=0.0)) for z in (*lengths, found.guided))
    allowed = 4.0 * found.error + _ROUNDING * largest
    for z in lengths:
        off = np.abs(np.abs(z) - np.abs(z[:, :1])).max(axis=1, initial=0.0)
        wrong = np.flatnonzero(found.proved & (off > allowed))
        false += [f"proved four-bar {k} changes a length by {off[k]:.1e}" for k in wrong]
    roots, expected = found.roots, len(start_member(task.problem).x)
    if roots.complete != (
        len(roots.x) + roots.at_infinity + len(roots.singular) == expected and bool(roots.closed)
    ):
        false.append("complete without all solutions")
    if original is not None and found.completeness.complete and not _is_found(found, original):
        false.append("the original is not in a complete list")
    return false


def _is_found(found: PrecisionFourBars, original: ComplexArray) -> bool:
    legs = np.stack([
        np.concatenate([found.fixed_a[:, None], found.moving_a], axis=1),
        np.concatenate([found.fixed_b[:, None], found.moving_b], axis=1),
    ])  # fmt: skip
    size = np.abs(original).max()
    return any(
        bool((np.abs(legs[order] - original[:, None]).max(axis=(0, 2)) < _NEAR * size).any())
        for order in ([0, 1], [1, 0])
        if len(found)
    )
