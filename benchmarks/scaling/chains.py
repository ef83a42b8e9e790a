"""Mechanisms of any size: chains of four-bars, and ternary links that are solved together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.peers.dyad_linkage import Dyad, DyadLinkage
from benchmarks.peers.loop_system import LoopSystem, newton

__all__ = ["coupled_loops", "dyad_chain"]


def dyad_chain(count: int) -> DyadLinkage:
    """``count`` parallelograms in a row, each rocker the crank of the next; the last is traced.

    Their change points lie at 0 and 180 degrees.
    """
    ground = {f"O{k}": complex(100.0 * k) for k in range(count + 1)}
    dyads = [
        Dyad(
            point=f"A{k}",
            first=f"A{k - 1}",
            first_length=100.0,
            second=f"O{k}",
            second_length=40.0,
            left=True,
        )
        for k in range(1, count + 1)
    ]
    return DyadLinkage(
        ground=ground, pivot="O0", pin="A0", radius=40.0, dyads=dyads, traced=f"A{count}"
    )


def coupled_loops(count: int) -> LoopSystem:
    """One irreducible block of ``count`` loops: a four-bar for one, else an Assur group.

    ``count - 1`` ternary links are pinned to each other in a row. The first hangs on the crank's
    pin by a bar, the last and every one of them stand on ground by a bar each: no part of them
    closes before the whole does. Dimensions are irregular (seeded), the crank is short.
    """
    system = _ternary_links(count - 1) if count > 1 else _four_bar()
    return replace(system, start=newton(system, np.zeros(1))[0])


def _four_bar() -> LoopSystem:
    return LoopSystem(
        turning=np.array([[120.0, -80.0]], complex),
        sliding=np.zeros((1, 0), complex),
        crank=np.array([10.0], complex),
        fixed=np.array([-100.0], complex),
        traced=np.array([0.0, 80.0, 0.0, 100.0], complex),
        start=np.radians([41.0, 88.0]),
    )


def _ternary_links(links: int) -> LoopSystem:
    """Unknown angles: of the ternary links, then of the bars to crank pin, ground, …, ground.

    Every loop is the position of the upper end of a bar, reached along the row of links, less the
    same reached from its lower end; the first bar's own loop gives the row its start.
    """
    rng = np.random.default_rng(2)  # with these the crank turns fully, whatever the size
    row = 100.0 * np.arange(links + 1) + 1j * rng.uniform(90.0, 110.0, links + 1)
    middle = 0.5 * (row[:-1] + row[1:]) - 30j + rng.uniform(-15.0, 15.0, links)
    tops = np.array([row[0], *middle, row[-1]])
    feet = tops - 1j * rng.uniform(110.0, 150.0, links + 2)
    feet += rng.uniform(-70.0, 70.0, links + 2)
    crank = 10.0
    bars = tops - feet
    angles = links + len(bars)
    turning = np.zeros((links + 1, angles), complex)
    fixed = np.zeros(links + 1, complex)
    for loop in range(links + 1):  # from the first bar to bar loop + 1
        turning[loop, links] = abs(bars[0])
        turning[loop, links + 1 + loop] = -abs(bars[loop + 1])
        for link in range(min(loop, links)):
            turning[loop, link] = row[link + 1] - row[link]
        if loop < links:
            turning[loop, loop] = tops[loop + 1] - row[loop]
        fixed[loop] = (feet[0] - crank) - feet[loop + 1]
    traced = np.zeros(angles + 2, complex)
    traced[-3], traced[-1] = abs(bars[-1]), feet[-1]
    return LoopSystem(
        turning=turning,
        sliding=np.zeros((links + 1, 0), complex),
        crank=np.full(links + 1, crank, complex),
        fixed=fixed,
        traced=traced,
        start=np.concatenate((np.zeros(links), np.angle(bars))),
    )
