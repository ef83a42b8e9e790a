"""One cycle of 361 rows against 1,000 small linear solves, with success and accuracy."""

from __future__ import annotations

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, interleaved

__all__ = ["measure"]

CYCLES = ("rapier-drive", "four-bar", "jansen-leg", "stephenson-far-crank", "andrews-squeezer")


def measure(repeats: int = 15) -> bool:
    """Bar: the rapier's cycle at most 3 × 1,000 ``numpy.linalg.solve`` of 8×8."""
    print("one cycle of 361 rows / 1,000 numpy.linalg.solve of 8x8")
    rng = np.random.default_rng(8)
    matrices, right = rng.normal(size=(1000, 8, 8)), rng.normal(size=(1000, 8))

    def reference() -> None:
        for matrix, vector in zip(matrices, right, strict=True):
            np.linalg.solve(matrix, vector)

    held = True
    for name in CYCLES:
        mechanism = lw.example(name)
        unit, cycle = interleaved([reference, mechanism.sweep], repeats)
        motion = mechanism.sweep()
        found, worst = int(motion.found.sum()), float(np.nanmax(motion.residual))
        text = f"{name}: {found} rows, worst residual {worst:.0e}"
        limit = 3.0 if name == "rapier-drive" else float("inf")
        ratios = [b / a for a, b in zip(unit, cycle, strict=True)]
        held = bar(text, ratios, limit) and held
    return held
