"""Growth of the time for building and solving with the length of a chain of dyads."""

from __future__ import annotations

from functools import partial

from benchmarks.dyad_chain import dyad_chain
from benchmarks.timing import bar, seconds

__all__ = ["measure"]


def measure(repeats: int = 5) -> bool:
    """Limit: time per dyad of 1,000 dyads at most 1.5 × that of 100.

    The proof of a motion has no limit: its number of steps grows linearly with the chain, as
    ``docs/benchmarks.md`` derives.
    """
    print("chain of dyads: ms per dyad (build, solve and prove, follow by 10°, the same proved)")
    per_dyad: dict[int, list[list[float]]] = {}
    for count in (10, 100, 1000):
        rows = []
        for _ in range(repeats):
            build = seconds(partial(dyad_chain, count))
            mechanism = dyad_chain(count)
            solve = seconds(partial(mechanism.solve, throw=True))
            follow = seconds(partial(mechanism.solve, at=100, certify=False, throw=True))
            proved = seconds(partial(mechanism.solve, at=100, throw=True))
            rows.append([1e3 * t / count for t in (build, solve, follow, proved)])
        per_dyad[count] = rows
        best = "  ".join(f"{min(row[k] for row in rows):7.3f}" for k in range(4))
        print(f"  {count:5d} dyads   {best}")
    held = True
    for k, what in enumerate(("build", "solve", "follow")):
        base = min(row[k] for row in per_dyad[100])
        ratios = [row[k] / base for row in per_dyad[1000]]
        held = bar(f"{what}: per dyad, 1,000 against 100", ratios, 1.5) and held
    return held
