"""Trusses that a crank makes movable: one pin of the frame sits on a crank instead."""

from __future__ import annotations

import numpy as np

import linkwork as lw
from tests.oracles.trusses import edges_of

__all__ = ["cranked_truss"]


def cranked_truss(
    graph: str, rng: np.random.Generator, *, ground: int = 0, size: float = 1.0
) -> lw.Mechanism:
    """A random mechanism of one degree of freedom whose loops are solved together.

    The sketch is one of its positions; the input is the crank.
    """
    count, edges = edges_of(graph)
    places = size * rng.uniform(-1.0, 1.0, (len(edges), 2))
    driven = next(k for k, edge in enumerate(edges) if ground in edge)
    x, y = (places[driven] + size * rng.uniform(-0.5, 0.5, 2)).tolist()
    links = {
        "ground" if link == ground else f"b{link}": tuple(
            f"J{k}" for k, edge in enumerate(edges) if link in edge
        )
        for link in range(count)
    }
    frame = tuple(joint for joint in links["ground"] if joint != f"J{driven}")
    return lw.linkage(
        name=f"Truss {graph} with a crank",
        points={f"J{k}": (float(a), float(b)) for k, (a, b) in enumerate(places)} | {"O": (x, y)},
        links=links | {"ground": ("O", *frame), "crank": ("O", f"J{driven}")},
        inputs=lw.Input(link="crank", from_=0, to=360, step=10),
    )
