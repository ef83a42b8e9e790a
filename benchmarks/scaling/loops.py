"""Time per row as a mechanism grows: dyads one after the other, and loops that are coupled."""

from __future__ import annotations

import numpy as np

from benchmarks.peers.registry import chosen
from benchmarks.peers.work import Member, Work, dyad_work
from benchmarks.scaling.chains import coupled_loops, dyad_chain
from benchmarks.scaling.part import Growth, grown

__all__ = ["chain_of_dyads", "coupled"]

LENGTHS = (1, 10, 100, 1_000)


def chain_of_dyads(repeats: int) -> Growth:
    """Every dyad is solved when those before it are: time per dyad should stay the same."""
    inputs = np.radians(np.linspace(60.0, 120.0, 61))
    works = [
        (count, dyad_work(f"chain of {count:,} dyads", [dyad_chain(count)], inputs))
        for count in LENGTHS
    ]
    return grown(
        title="chain of dyads, 61 rows",
        unit="ns per row and dyad",
        size="dyads",
        works=works,
        peers=chosen(["linkwork", "pylinkage step_fast", "NumPy", "scipy", "exudyn"]),
        repeats=repeats,
        most={"linkwork, certified": 100, "scipy fsolve": 10, "exudyn": 100},
        share=float,
    )


def coupled(repeats: int) -> Growth:
    """2n equations that no order of dyads solves; one loop is a four-bar."""
    inputs = np.linspace(0.0, 2.0 * np.pi, 361)
    works = [
        (
            count,
            Work(
                name=f"{count} coupled loops",
                members=[Member(loops=coupled_loops(count))],
                inputs=inputs,
            ),
        )
        for count in range(1, 7)
    ]
    return grown(
        title="coupled loops, 361 rows",
        unit="ns per row",
        size="loops",
        works=works,
        peers=chosen(["linkwork", "casadi fast_newton, C", "scipy"]),
        repeats=repeats,
    )
