"""Random masses and loads on the linkages of the library: two ways to the efforts agree."""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np

import linkwork as lw
from linkwork.mechanism.linkage import Linkage
from tests.forces.random_loads import loaded

__all__ = ["force_campaign"]

_MOST_CONDITION = 1e8
_AGREE = 1e-10  # of the largest term
_BALANCED = 1e-12  # of the powers


@cache
def _linkages() -> tuple[lw.Mechanism, ...]:
    every = map(lw.example, lw.examples())
    return tuple(
        one for one in every if isinstance(one.description, Linkage) and one.description.inputs
    )


def force_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many motions, some rows each."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        which = _linkages()[number % len(_linkages())]
        mechanism = loaded(which, seed=number)
        motion = mechanism.sweep(certify=False)
        found = mechanism.forces(motion=motion)
        fine = motion.found & (motion.condition <= _MOST_CONDITION)
        fine &= np.isfinite(np.asarray(found["power"]))
        powers = [np.asarray(found[name])[fine] for name in ("power", "load_power", "energy_rate")]
        rubs = "friction_power" in found.values
        lost = np.asarray(found["friction_power"])[fine] if rubs else 0.0
        apart = np.asarray(found["disagreement"])[fine]
        left = np.abs(powers[0] + powers[1] - powers[2] - lost)
        most = np.max(np.abs(powers), axis=0, initial=0.0)
        counts["motions"] += 1
        counts["rows"] += int(fine.sum())
        for status in found.statuses:
            counts[f"row {status.name}"] += 1
        if (apart > _AGREE).any():
            false.append(f"{number}, {which.name}: efforts differ by {apart.max():.1e}")
        if (left > _BALANCED * most + _BALANCED * most.max(initial=0.0)).any():
            false.append(f"{number}, {which.name}: power and energy differ")
    return counts, false
