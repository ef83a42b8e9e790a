"""A random member of a family, solved by closed paths until the trace test confirms it.

The test moves the last equation alone. If the others leave several curves, it confirms what lies on
each of them, not that all of them are known; closed paths of a few solutions would lead to
another curve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from linkwork.numerics.homotopy.monodromy import (
    IDLE,
    Family,
    Member,
    solve_by_few,
    solve_by_monodromy,
    solve_further,
)
from linkwork.numerics.homotopy.parameter_path import Tracker
from linkwork.numerics.homotopy.trace_test import TraceDefect, trace_defect

__all__ = ["DIRECTIONS", "ConfirmedMember", "LastFamily", "solve_and_confirm"]

_STRAIGHT = 1e-7  # a trace's distance from a straight line that rounding explains
_SEEN = 100.0  # times less straight is the trace of one solution less
#: Random directions of a trace test: of many paths one may be lost in some of them, or jump.
DIRECTIONS = 20


class LastFamily(Family, Protocol):
    """A family whose last equation belongs to some of the parameters alone."""

    @property
    def last(self) -> slice:
        """The parameters of the last equation."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ConfirmedMember:
    """A solved member, and the defects of the traces of all solutions and of all but one.

    ``denied``: a closed path led to a further solution.
    """

    member: Member
    trace: TraceDefect
    denied: bool = False

    @property
    def confirmed(self) -> bool:
        """Whether no solution is missing, and one less would be noticed."""
        trace = self.trace
        straight = not trace.lost and trace.relative <= _STRAIGHT
        return straight and trace.less >= _SEEN * trace.relative and not self.denied


def solve_and_confirm(
    family: LastFamily,
    rng: np.random.Generator,
    tracker: Tracker,
    report: Callable[[int], object] = lambda found: None,
    *,
    reach: float = 1.0,
    idle: int = IDLE,
    directions: int = DIRECTIONS,
    rounds: int = 1,
) -> ConfirmedMember:
    """Solve a random member; follow further closed paths while the trace test denies it.

    Parameters
    ----------
    family : LastFamily
    rng : numpy.random.Generator
    tracker : Tracker
        May raise an error to end the work.
    report : callable, optional
        Gets the number of solutions after every closed path.
    reach : float
        Of the trace test, see :func:`trace_defect`.
    idle : int
        Closed paths without a new solution before a trace test.
    directions : int
        Of a trace test at most; one that confirms the solutions is enough.
    rounds : int
        Trace tests at most; the last result is returned, confirmed or not.
    """
    member = solve_by_monodromy(family, rng, tracker, report, idle)
    while True:
        rounds -= 1
        found = _tested(family, member, rng, tracker, reach, directions)
        if found.confirmed:
            member = solve_by_few(family, member, rng, tracker)
            if member is found.member:
                return found
        if rounds < 1:
            return replace(found, denied=True)
        member = solve_further(family, member, rng, tracker, report, idle)


def _tested(
    family: LastFamily,
    member: Member,
    rng: np.random.Generator,
    tracker: Tracker,
    reach: float,
    directions: int,
) -> ConfirmedMember:
    for _ in range(directions):
        trace = trace_defect(family, member, rng, tracker, reach)
        found = ConfirmedMember(member=member, trace=trace)
        # a set with a gap is straight in no direction
        if found.confirmed:
            break
    return found
