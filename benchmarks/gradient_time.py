"""Gradients by all dimensions over the certified sweep whose rows they belong to."""

from __future__ import annotations

from functools import partial
from time import process_time

import linkwork as lw
from benchmarks.timing import bar, interleaved

__all__ = ["measure"]

#: A mechanism, and a quantity of its rows or of its motion.
GRADIENTS = (
    ("four-bar", "B.x"),
    ("four-bar", "stroke(rocker)"),
    ("slider-crank", "d.d2"),
    ("rapier-drive", "E.x"),
    ("jansen-leg", "F.x"),
    ("jansen-leg", "path_length(F)"),
)
_LIMIT = 3.0


def measure(repeats: int = 7) -> bool:
    """Limits: processor time of the gradient by every number of the file over that of a sweep of
    as many proved rows, which the gradient is given.
    """
    print("gradients by all dimensions / certified sweep, processor time")
    held = True
    for name, of in GRADIENTS:
        mechanism = lw.example(name)
        motion = mechanism.sweep()
        count = len(lw.design.gradient(mechanism, of, motion=motion))
        sweep, gradient = interleaved(
            [mechanism.sweep, partial(lw.design.gradient, mechanism, of, motion=motion)],
            repeats,
            process_time,
        )
        ratios = [b / a for a, b in zip(sweep, gradient, strict=True)]
        held = bar(f"{name}: {of} by {count} numbers", ratios, _LIMIT) and held
    return held
