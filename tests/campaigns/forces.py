"""Random masses and loads on the library: two ways to the efforts agree, and power is balanced.

Motions take turns: linkages with constant loads, with springs, dampers and formulas, with friction
in every joint, and files of loops.
"""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np

import linkwork as lw
from linkwork.core.foundation.arrays import BoolArray
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from tests.forces.random_loads import loaded, rubbed, sprung

__all__ = ["force_campaign"]

_MOST_CONDITION = 1e8
_AGREE = 1e-10  # of the largest term
_BALANCED = 1e-12  # of the powers
_COEFFICIENTS = (0.02, 0.1, 0.3)
_KINDS = ("constant loads", "springs and formulas", "friction", "loops")


@cache
def _driven(kind: type[Linkage | Loops]) -> tuple[lw.Mechanism, ...]:
    every = map(lw.example, lw.examples())
    return tuple(
        one for one in every if isinstance(one.description, kind) and one.description.inputs
    )


def _mechanism(number: int) -> tuple[str, lw.Mechanism]:
    """The kind of a motion, and its mechanism."""
    which, kind = divmod(number, len(_KINDS))
    known = _driven(Loops if _KINDS[kind] == "loops" else Linkage)
    mechanism = loaded(known[which % len(known)], seed=number)
    if _KINDS[kind] == "springs and formulas":
        mechanism = sprung(mechanism, seed=number)
    if _KINDS[kind] == "friction":
        mechanism = rubbed(mechanism, _COEFFICIENTS[which % len(_COEFFICIENTS)])
    return _KINDS[kind], mechanism


def force_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many motions."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        kind, mechanism = _mechanism(number)
        motion = mechanism.sweep(certify=False)
        found = mechanism.forces(motion=motion)
        counts[f"motions, {kind}"] += 1
        for status in found.statuses:
            counts[f"row {status.name}, {kind}"] += 1
        fine = motion.found & (motion.condition <= _MOST_CONDITION)
        fine &= np.isfinite(np.asarray(found["power"]))
        counts["rows balanced"] += int(fine.sum())
        checked = "disagreement" in found.values
        if not checked:
            counts[f"motions without reactions, {kind}"] += 1
        else:
            counts["rows of two ways"] += int(fine.sum())
        false += [f"{number}, {mechanism.name}: {claim}" for claim in _judge(found, fine)]
    return counts, false


def _judge(found: lw.forces.Reactions, fine: BoolArray) -> list[str]:
    false = []
    if "disagreement" in found.values:
        apart = np.asarray(found["disagreement"])[fine]
        if not (apart <= _AGREE).all():
            false.append(f"efforts differ by {apart.max():.1e}")
    names = ("power", "load_power", "energy_rate", "friction_power")
    powers = [np.asarray(found[n])[fine] for n in names if n in found.values]
    left = np.abs(powers[0] + powers[1] - powers[2] - sum(powers[3:]))
    most = np.max(np.abs(powers), axis=0, initial=0.0)
    if not (left <= _BALANCED * (most + most.max(initial=0.0))).all():
        false.append(f"power and energy differ by {np.max(left / most):.1e}")
    return false
