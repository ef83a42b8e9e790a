"""Whether a set of solutions is complete: their trace moves along a straight line.

Let the last equation be linear in numbers m(z) of which the other equations leave a curve, and let
it move in parallel, in the chart ℓ(m) = 1,

    F(z; c) + s ℓ(m(z)) = 0.

The sum of another linear function of m/ℓ over all solutions is then a linear function of s, and
over a part of them almost never (Sommese, Verschelde, Wampler 2002, SIAM J. Numer. Anal. 40, 2026).
The equation itself with other parameters is such a function ℓ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from linkwork.foundation.arrays import ComplexArray
from linkwork.numerics.homotopy.bilinear_homotopy import normal_numbers
from linkwork.numerics.homotopy.monodromy import Member, follow_all
from linkwork.numerics.homotopy.parameter_path import (
    Equations,
    ParameterPath,
    ParametrizedSystem,
    Tracker,
)

__all__ = ["TraceDefect", "trace_defect"]


class _WithLast(ParametrizedSystem, Protocol):
    """A system whose last equation belongs to some of the parameters alone."""

    @property
    def last(self) -> slice:
        """The parameters of the last equation."""


@dataclass(frozen=True)
class _Moving:
    """A system with the last equation moving: parameters c, those of ℓ, and s."""

    system: _WithLast

    @property
    def unknowns(self) -> int:
        return self.system.unknowns

    @property
    def parameters(self) -> int:
        last = self.system.last
        return self.system.parameters + len(range(last.start, last.stop)) + 1

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        own, last = self.system.parameters, self.system.last
        given, rates, s, s_rate = list(c[:own]), list(rate[:own]), c[-1], rate[-1]
        values, slopes, changes = (list(part) for part in self.system.equations(z, given, rates))
        given[last], rates[last] = c[own:-1], rate[own:-1]
        chart = self.system.equations(z, given, rates)
        values[-1] = values[-1] + s * chart[0][-1]  # eq. (115)
        slopes[-1] = [a + s * b for a, b in zip(slopes[-1], chart[1][-1], strict=True)]
        changes[-1] = changes[-1] + s * chart[2][-1] + s_rate * chart[0][-1]
        return values, slopes, changes


@dataclass(frozen=True, kw_only=True)
class TraceDefect:
    """How far the trace is from a straight line, relative to its way, and how far that of all
    solutions but the first; paths that were lost.
    """

    relative: float
    less: float
    lost: int


def trace_defect(
    system: _WithLast,
    member: Member,
    rng: np.random.Generator,
    tracker: Tracker,
    reach: float = 1.0,
) -> TraceDefect:
    """Move the last equation of a solved member both ways and compare the three traces.

    ``reach``: |s|; of tens of thousands of paths some pass too near to a degenerate solution on
    their whole way.
    """
    moving, c = _Moving(system), member.parameters
    width = system.last.stop - system.last.start
    chart, probe = normal_numbers(rng, 2, width)
    turn = reach * np.exp(2j * np.pi * rng.uniform())
    terms, lost = list[ComplexArray](), 0
    for s in (-turn, 0.0, turn):
        start, goal = (np.concatenate([c, chart, [end]]) for end in (0.0, s))
        path, x = ParameterPath(system=moving, start=start, goal=goal), member.x
        if s:
            x = follow_all(path, x, tracker)
            lost += len(member.x) - len(x)
        values = [_last_value(system, x, c, own) for own in (probe, chart)]
        terms.append(values[0] / values[1])
    return TraceDefect(relative=_bend(terms), less=_bend([x[1:] for x in terms]), lost=lost)


def _bend(terms: Sequence[ComplexArray]) -> float:
    """How far the sums of three sets of terms are from a straight line, relative to their way."""
    one, middle, other = (complex(x.sum()) for x in terms)
    # no solutions have no trace
    return abs(one - 2.0 * middle + other) / abs(other - one) if one != other else math.inf


def _last_value(
    system: _WithLast, x: ComplexArray, c: ComplexArray, own: ComplexArray
) -> ComplexArray:
    """The last equation's left side (B,), with its own parameters replaced."""
    given = c.copy()
    given[system.last] = own
    f, _ = ParameterPath(system=system, start=given, goal=given).residual_and_jacobian(x)
    return f[:, -1]
