"""A chain of n dyads, each rocker driving the next, to measure growth with size."""

from __future__ import annotations

import linkwork as lw

__all__ = ["dyad_chain"]


def dyad_chain(count: int) -> lw.Mechanism:
    """A crank that drives ``count`` four-bar loops in series along the x axis.

    All loops are nearly parallelograms: the rod is slightly longer than the ground, so that no loop
    has a change point near the start.
    """
    points: dict[str, tuple[float, float]] = {"O0": (0.0, 0.0), "A0": (0.0, 40.0)}
    links: dict[str, list[str]] = {"ground": ["O0"], "crank": ["O0", "A0"]}
    lengths: dict[str, float] = {"O0 A0": 40.0}
    for k in range(1, count + 1):
        points[f"O{k}"] = (100.0 * k, 0.0)
        points[f"A{k}"] = (100.0 * k, 40.0)
        links["ground"].append(f"O{k}")
        links[f"rod{k}"] = [f"A{k - 1}", f"A{k}"]
        links[f"rocker{k}"] = [f"O{k}", f"A{k}"]
        lengths[f"A{k - 1} A{k}"] = 100.0
        lengths[f"O{k} A{k}"] = 40.0
    return lw.linkage(
        name=f"chain of {count} dyads",
        points=points,
        links=links,
        lengths=lengths,
        inputs=lw.Input(link="crank"),
    )
