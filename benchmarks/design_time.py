"""Equations of a family built at once against the same designs built one at a time."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, interleaved
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import LinkworkError
from linkwork.core.mechanism.varied_numbers import varied_numbers
from linkwork.families import Designs, designs_of

__all__ = ["measure"]

#: A mechanism, its varied table, and the limit: time per design, at once / one at a time.
FAMILIES = (
    ("four-bar", "lengths", 1e-3),
    ("rapier-drive", "dimensions", 2e-3),
    ("jansen-leg", "lengths", 2e-3),
    ("rapier-drive-links", "lengths", 5e-3),  # angles solved by Gauss-Newton
)
_COUNT = 100_000
_ALONE = 20


def measure(repeats: int = 5) -> bool:
    """Limits: time per design of 100,000 designs against that of 20 designs alone."""
    print("equations of 100,000 designs at once / one at a time, per design")
    held = True
    for name, table, limit in FAMILIES:
        mechanism = lw.example(name)
        asked = _asked(mechanism, table)
        designs = designs_of(mechanism, asked)
        few = designs.take(slice(0, _ALONE))
        alone, together = interleaved(
            [partial(_one_at_a_time, few), partial(designs_of, mechanism, asked)], repeats
        )
        ratios = [b / _COUNT / (a / _ALONE) for a, b in zip(alone, together, strict=True)]
        sound = int((designs.problem == 0).sum())
        text = f"{name}: {sound} sound, {_gap(few):.0e} apart"
        held = bar(text, [1e3 * ratio for ratio in ratios], 1e3 * limit) and held
    print("    (thousandths)")
    return held


def _asked(mechanism: lw.Mechanism, table: str) -> Mapping[str, Array]:
    """All numbers of a table within one per cent, except those of ground, which has coordinates."""
    rng = np.random.default_rng(4)
    ground = set(getattr(mechanism.description, "links", {}).get("ground", ()))
    return {
        quantity.name: quantity.of(mechanism.description) * rng.uniform(0.99, 1.01, _COUNT)
        for quantity in varied_numbers(mechanism.description)
        if quantity.table == table and not ground.issuperset(quantity.key.split())
    }


def _one_at_a_time(designs: Designs) -> None:
    for k in range(len(designs)):
        try:
            designs.design(k)
        except LinkworkError:
            continue


def _gap(designs: Designs) -> float:
    """The largest relative difference of a coefficient from that of the design alone."""
    gaps = [0.0]
    for k in np.flatnonzero(designs.problem == 0):
        alone = designs.design(int(k)).compiled.table.loops.coefficient
        gap = np.abs(designs.loops[k] - alone) / designs.length_scale[k]
        gaps.append(float(gap.max()))
    return max(gaps)
