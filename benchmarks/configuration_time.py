"""All configurations of random trusses against 1,000 small linear solves, with success."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, seconds

__all__ = ["measure"]

#: Loops, pins as pairs of links, and the limit for repeated solves of a topology.
TRUSSES: tuple[tuple[int, tuple[tuple[int, int], ...], float], ...] = (
    (2, ((0, 1), (0, 2), (0, 3), (1, 4), (2, 4), (3, 4)), 2.0),
    (3, ((0, 3), (0, 4), (1, 4), (1, 5), (2, 5), (3, 5), (0, 6), (1, 6), (2, 6)), 6.0),
    (
        4,
        (
            (0, 3), (1, 4), (2, 5), (0, 6), (1, 6), (2, 6), (2, 7), (3, 7),
            (4, 7), (1, 8), (3, 8), (5, 8),
        ),
        30.0,
    ),
    (
        5,
        (
            (0, 1), (0, 4), (0, 7), (1, 6), (2, 3), (2, 5), (2, 7), (2, 8),
            (3, 6), (3, 9), (4, 9), (4, 10), (5, 10), (6, 10), (8, 9),
        ),
        200.0,
    ),
)  # fmt: skip


def measure(repeats: int = 15) -> bool:
    """Limits for repeated solves of a topology; the first also solves the random system."""
    print("all configurations of random trusses / 1,000 numpy.linalg.solve of 8x8")
    rng = np.random.default_rng(8)
    matrices, right = rng.normal(size=(1000, 8, 8)), rng.normal(size=(1000, 8))

    def reference() -> None:
        for matrix, vector in zip(matrices, right, strict=True):
            np.linalg.solve(matrix, vector)

    seconds(reference)
    held = True
    for loops, pins, limit in TRUSSES:
        mechanisms = [_truss(pins, rng) for _ in range(repeats + 1)]
        first = seconds(mechanisms[0].configurations) / seconds(reference)
        ratios = [_ratio(reference, m.configurations) for m in mechanisms[1:]]
        found = [m.configurations() for m in mechanisms[1:]]
        whole = sum(f.completeness.complete for f in found)
        proved = sum(p.certificate.certified for f in found for p in f)
        real = sum(map(len, found))
        counts = sorted({f.paths[0].finite for f in found})
        text = f"{loops} loops: {counts}, {whole}/{repeats} complete, {proved}/{real} certified"
        held = bar(text, ratios, limit) and held
        print(f"    the first of this topology: {first:.0f}")
    return held


def _ratio(reference: Callable[[], object], solve: Callable[[], object]) -> float:
    unit = seconds(reference)
    return seconds(solve) / unit


def _truss(pins: tuple[tuple[int, int], ...], rng: np.random.Generator) -> lw.Mechanism:
    """A truss without an input, its pins anywhere."""
    links = 1 + max(max(pair) for pair in pins)
    places = rng.uniform(-1.0, 1.0, (len(pins), 2)).tolist()
    return lw.linkage(
        name="Truss",
        points={f"J{k}": (x, y) for k, (x, y) in enumerate(places)},
        links={
            f"b{link}" if link else "ground": tuple(
                f"J{k}" for k, pair in enumerate(pins) if link in pair
            )
            for link in range(links)
        },
    )
