"""Members of families of systems that were solved, as starts of members near them.

No member of a linear family has more isolated solutions than almost every one has. So where
Newton's method from the solutions of a member near by leads to as many regular ones, these are all.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable

import numpy as np

from linkwork.foundation.arrays import ComplexArray
from linkwork.numerics.homotopy.polynomial_system import (
    STEPS_TO_REGULAR,
    ClosureSystem,
    distinct_solutions,
    polish_roots,
)

__all__ = ["keep_member", "solutions_from_member"]

_NEAR = 0.1  # of the largest coefficient: members further away do not help
_MOST = 64  # members of a family that are kept

#: Closures and solutions of members of every family that have as many as a random one.
_MEMBERS: dict[Hashable, deque[tuple[ComplexArray, ComplexArray]]] = {}


def solutions_from_member(
    system: ClosureSystem, family: Hashable, expected: int
) -> ComplexArray | None:
    """All solutions, from those of the nearest member kept; ``None`` if they are not all."""
    members = _MEMBERS.get(family)
    if not members or not expected:
        return None
    goal = _closures(system)
    away = [float(np.abs(closures - goal).max()) for closures, _ in members]
    nearest = int(np.argmin(away))
    x = members[nearest][1]
    if len(x) != expected or not away[nearest] <= _NEAR * float(np.abs(goal).max()):
        return None
    if not away[nearest]:
        return x
    with np.errstate(all="ignore"):
        x, steps = polish_roots(system, x, STEPS_TO_REGULAR)
    # slow convergence marks a multiple solution
    if (steps <= 0).any() or len(distinct_solutions(x)) < expected:
        return None
    keep_member(system, family, x)
    return x


def keep_member(system: ClosureSystem, family: Hashable, x: ComplexArray) -> None:
    """Keep the solutions x (B, n) of a member, as many as a random one has."""
    kept = _MEMBERS.setdefault(family, deque(maxlen=_MOST))
    kept.append((_closures(system), x))


def _closures(system: ClosureSystem) -> ComplexArray:
    return np.stack([system.left, system.right])
