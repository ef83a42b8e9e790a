"""One cycle of 361 rows against 1,000 small linear solves, with success and accuracy; and the cost
of certificates.
"""

from __future__ import annotations

from functools import partial

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, interleaved

__all__ = ["measure"]

CYCLES = ("rapier-drive", "four-bar", "jansen-leg", "stephenson-far-crank", "andrews-squeezer")


def measure(repeats: int = 15) -> bool:
    """Limits: the rapier's certified cycle at most 3 × 1,000 ``numpy.linalg.solve`` of 8×8, and
    certified at most 3 × uncertified.
    """
    print("one cycle of 361 rows / 1,000 numpy.linalg.solve of 8x8")
    rng = np.random.default_rng(8)
    matrices, right = rng.normal(size=(1000, 8, 8)), rng.normal(size=(1000, 8))

    def reference() -> None:
        for matrix, vector in zip(matrices, right, strict=True):
            np.linalg.solve(matrix, vector)

    held = True
    for name in CYCLES:
        mechanism = lw.example(name)
        bare = partial(mechanism.sweep, certify=False)
        unit, cycle, uncertified = interleaved([reference, mechanism.sweep, bare], repeats)
        motion = mechanism.sweep()
        text = f"{name}: {motion.certified.sum()} certified, residual {motion.worst:.0e}"
        limit = 3.0 if name == "rapier-drive" else float("inf")
        ratios = [b / a for a, b in zip(unit, cycle, strict=True)]
        held = bar(text, ratios, limit) and held
        cost = [b / a for a, b in zip(uncertified, cycle, strict=True)]
        held = bar(f"{name}: certified / uncertified", cost, 3.0) and held
    return held
