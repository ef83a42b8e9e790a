"""All isolated solutions of a random member of a family, from one of them.

A closed path of parameters permutes the solutions, so that paths from known ones may end at new
ones; where all solutions are connected, closed paths lead to all of them sooner or later
(Duff, Hill, Jensen, Lee, Leykin, Sommars 2019, IMA J. Numer. Anal. 39, 1421). That nothing new
comes is no proof; :mod:`linkwork.numerics.homotopy.trace_test` confirms that none is missing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import BoolArray, ComplexArray, IndexArray
from linkwork.marching.solution_path import ARRIVED
from linkwork.numerics.homotopy.parameter_path import (
    QUICK,
    SURE,
    ParameterPath,
    ParametrizedSystem,
    Tracker,
    polish_ends,
)

__all__ = [
    "IDLE",
    "Family",
    "Member",
    "first_of_each",
    "follow_all",
    "solve_by_few",
    "solve_by_monodromy",
    "solve_further",
]

_REPEATED = 1e-6  # relative: fingerprints of solutions that count as one
#: Closed paths without a new solution after which no more are tried.
IDLE = 3
_LOOPS = 100  # closed paths at most
_AROUND, _FEW = 16, 4  # closed paths from a few solutions; each exchanges kinds every other time


class Family(ParametrizedSystem, Protocol):
    """A family of systems of which a member with one solution can be made."""

    def random_parameters(self, rng: np.random.Generator) -> ComplexArray:
        """Random complex parameters (P,)."""

    def random_member(self, rng: np.random.Generator) -> tuple[ComplexArray, ComplexArray]:
        """Random parameters (P,) and one of their solutions (n,)."""

    def proper(self, x: ComplexArray, c: ComplexArray) -> BoolArray:
        """Which solutions (B, n) do not belong to a set that solves every member, (B,)."""

    def fingerprint(self, x: ComplexArray, c: ComplexArray) -> ComplexArray:
        """Numbers (B, K) of solutions (B, n), equal for those that count as one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Member:
    """A member of a family: its parameters (P,) and solutions (R, n)."""

    parameters: ComplexArray
    x: ComplexArray


def solve_by_monodromy(
    family: Family,
    rng: np.random.Generator,
    tracker: Tracker,
    report: Callable[[int], object] = lambda found: None,
    idle: int = IDLE,
) -> Member:
    """A random member with the solutions that closed paths lead to; ``report`` their number."""
    c, one = family.random_member(rng)
    return solve_further(family, Member(parameters=c, x=one[None]), rng, tracker, report, idle)


def solve_further(
    family: Family,
    member: Member,
    rng: np.random.Generator,
    tracker: Tracker,
    report: Callable[[int], object] = lambda found: None,
    idle: int = IDLE,
) -> Member:
    """A member with the solutions that closed paths from known ones lead to.

    ``idle``: closed paths without a new solution after which no more are tried.
    """
    left = idle
    for _ in range(_LOOPS):
        found = _around(family, member, member.x, rng, tracker)
        left = idle if len(found.x) > len(member.x) else left - 1
        member = found
        report(len(member.x))
        if not left:
            break
    return member


def solve_by_few(
    family: Family, member: Member, rng: np.random.Generator, tracker: Tracker
) -> Member:
    """A member with what many closed paths from a few of its solutions lead to, if that is new.

    If the solutions are of several kinds that closed paths exchange as a whole, as mirror images of
    a link are, a few of them show it.
    """
    for _ in range(_AROUND):
        few = member.x[rng.choice(len(member.x), min(_FEW, len(member.x)), replace=False)]
        found = _around(family, member, few, rng, tracker)
        if len(found.x) > len(member.x):
            return found
    return member


def _around(
    family: Family, member: Member, x: ComplexArray, rng: np.random.Generator, tracker: Tracker
) -> Member:
    """A member with the ends of a closed path from some of its solutions x (B, n)."""
    here = c = member.parameters
    for there in (family.random_parameters(rng), family.random_parameters(rng), c):
        path = ParameterPath(system=family, start=here, goal=there)
        x = follow_all(path, x, tracker)
        here = there
    both = np.concatenate([member.x, x[family.proper(x, c)]])
    return Member(parameters=c, x=both[first_of_each(family.fingerprint(both, c))])


def follow_all(path: ParameterPath, x: ComplexArray, tracker: Tracker) -> ComplexArray:
    """The ends (B, n) of the paths from x (R, n) that arrive; lost ones are followed again."""
    paths = tracker(path, x, QUICK)
    w, lost = paths.w.copy(), np.flatnonzero(paths.state != ARRIVED)
    again = tracker(path, x[lost], SURE)
    w[lost] = again.w
    arrived = paths.state == ARRIVED
    arrived[lost] = again.state == ARRIVED
    ends = polish_ends(path, w[arrived])
    return ends.x[ends.regular]


def first_of_each(fingerprints: ComplexArray) -> IndexArray:
    """The rows of (B, K) without those that repeat an earlier one, within rounding."""
    count = len(fingerprints)
    # bounded numbers, whose differences are at most relative ones
    small = fingerprints / (1.0 + np.abs(fingerprints))
    # equal rows are near each other in the order of any combination of their numbers
    mixed = small.real @ np.sin(np.arange(1.0, small.shape[1] + 1.0))
    order = np.argsort(mixed, kind="stable")
    repeats = np.zeros(count, dtype=bool)
    for step in range(1, count):
        one, other = order[:-step], order[step:]
        near = np.abs(mixed[one] - mixed[other]) < _REPEATED * small.shape[1]
        if not near.any():
            break
        same = near & (np.abs(small[one] - small[other]).max(axis=1, initial=0.0) < _REPEATED)
        repeats[np.maximum(one, other)[same]] = True
    return np.flatnonzero(~repeats)
