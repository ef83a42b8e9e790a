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

__all__ = ["Family", "Member", "first_of_each", "follow_all", "solve_by_monodromy"]

_REPEATED = 1e-6  # relative: fingerprints of solutions that count as one
_IDLE = 3  # closed paths without a new solution after which no more are tried
_LOOPS = 100  # closed paths at most


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
) -> Member:
    """A random member with the solutions that closed paths lead to; ``report`` their number."""
    c, one = family.random_member(rng)
    x, idle = one[None], 0
    for _ in range(_LOOPS):
        ends, here = x, c
        for there in (family.random_parameters(rng), family.random_parameters(rng), c):
            path = ParameterPath(system=family, start=here, goal=there)
            ends = follow_all(path, ends, tracker)
            here = there
        ends = ends[family.proper(ends, c)]
        both = np.concatenate([x, ends])
        found = both[first_of_each(family.fingerprint(both, c))]
        idle = 0 if len(found) > len(x) else idle + 1
        x = found
        report(len(x))
        if idle == _IDLE:
            break
    return Member(parameters=c, x=x)


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
