"""All isolated solutions of a random member of a family, from one of them.

A closed path of parameters permutes the solutions, so that paths from known ones may end at new
ones; where all solutions are connected, closed paths lead to all of them sooner or later
(Duff, Hill, Jensen, Lee, Leykin, Sommars 2019, IMA J. Numer. Anal. 39, 1421). That nothing new
comes is no proof; :mod:`linkwork.circuits.homotopy.monodromy` confirms that none is missing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.circuits.homotopy.dead_points import DeadPointSystem
from linkwork.circuits.homotopy.path_tracking import (
    ARRIVED,
    QUICK,
    SURE,
    Equations,
    ParameterPath,
    ParametrizedSystem,
    Tracker,
    polish_ends,
)
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray

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


def solve_further(
    family: Family,
    member: Member,
    rng: np.random.Generator,
    tracker: Tracker,
    report: Callable[[int], object] = lambda found: None,
    idle: int = IDLE,
) -> Member:
    """A member with the solutions that closed paths from known ones lead to; ``report`` their
    number.

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


# ----------------------------------------------------------------------
# Whether a set of solutions is complete: their trace moves along a straight line.
#
# Let the last equation be linear in numbers m(z) of which the other equations leave a curve, and
# let it move in parallel, in the chart ℓ(m) = 1,
#
#     F(z; c) + s ℓ(m(z)) = 0.
#
# The sum of another linear function of m/ℓ over all solutions is then a linear function of s, and
# over a part of them almost never (Sommese, Verschelde, Wampler 2002, SIAM J. Numer. Anal. 40,
# 2026).
# The equation itself with other parameters is such a function ℓ.


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


# ----------------------------------------------------------------------
# A random member of a family, solved by closed paths until the trace test confirms it.
#
# The test moves the last equation alone. If the others leave several curves, it confirms what lies
# on each of them, not that all of them are known; closed paths of a few solutions would lead to
# another curve.


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
    c, one = family.random_member(rng)
    member = solve_further(family, Member(parameters=c, x=one[None]), rng, tracker, report, idle)
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


# ----------------------------------------------------------------------
# Curves of dead points: can the mechanism really move while its input rests?
#
# Where equal links lie on each other, a :class:`DeadPointSystem` has curves of solutions besides
# the isolated ones. A position is real if V = U* and its rates are those of real angles and
# lengths, ω = ω* and σ = -σ*. On a curve along which the input keeps a value that is not real,
# there is none.
# Elsewhere one is looked for by Gauss-Newton steps among points of this kind,
#
#     U = a + i b,   V = a - i b,   ω,   σ = -i s     with a, b, ω, s real,
#
# and then a second one near it that has the same input.


#: The input's e^{iθ} or length at x (n,), as U and as V have it, (2,), and the slopes, (2, n).
Lead = Callable[[ComplexArray], tuple[ComplexArray, ComplexArray]]

_FREE = 1e-7  # singular values this small, relative to the largest, are zero but for rounding
_KEPT = 1e-6  # a slope of the input along a curve that counts as zero
_COMPLEX = 1e-3  # a distance of the input from its mirror image that rounding does not explain
_STEPS = 60  # towards a real position
_CLOSED = 1e-11  # residual of a position, relative to its size squared
_STRIDE = 1e-2  # of a motion with the input held,
_MOVED = 0.1  # and how much of it has to remain


def keeps_complex_input(system: DeadPointSystem, x: ComplexArray, lead: Lead) -> bool:
    """Whether the input has one value, and no real one, all along the curve through x (n,).

    It is constant on an irreducible curve if its slope vanishes at a regular point of the curve.
    """
    value, slope = lead(x)
    size = 1.0 + float(np.abs(value).max())
    _, jacobian = system.residual_and_jacobian(x[None])
    along = slope @ _kernel(jacobian[0])
    unreal = abs(value[0] - value[1].conj()) > _COMPLEX * size
    return bool(unreal and np.abs(along).max(initial=0.0) <= _KEPT * size)


def real_motion(
    system: DeadPointSystem, x: ComplexArray, lead: Lead
) -> tuple[ComplexArray, ComplexArray] | None:
    """Two real positions, (n,) each, of a motion during which the input rests.

    Parameters
    ----------
    x : (n,)
        A solution on a curve from which a real one is looked for.

    Returns
    -------
    tuple or None
        ``None`` if none was found, which does not prove that there is none.
    """
    real = RealPoints(system, lead)
    with np.errstate(all="ignore"):
        here = real.correct(real.near(x), None)
        if here is None:
            return None
        held = real.value(here)
        _, jacobian = real.equations(here, held)
        size = 1.0 + float(np.abs(here).max())
        for way in _kernel(jacobian).T.real:
            there = real.correct(here + _STRIDE * size * way, held)
            if there is not None and np.abs(there - here).max() > _MOVED * _STRIDE * size:
                return real.place(here), real.place(there)
    return None


def _kernel(matrix: ComplexArray | Array) -> ComplexArray:
    """A basis (n, k) of the null space of a matrix (m, n), rounding allowed for."""
    _, sizes, rows = np.linalg.svd(matrix)
    # the rank with rounding allowed for
    rank = int((sizes > _FREE * sizes[0]).sum())
    basis: ComplexArray = rows[rank:].conj().T.astype(complex)
    return basis


class RealPoints:
    """The system in real coordinates y = (a, b, ω, s), (2M + 2 own,), with x = ``basis`` y."""

    def __init__(self, system: DeadPointSystem, lead: Lead) -> None:
        m, rates = system.size, 2 * system.own
        self.system, self.lead = system, lead
        self.turning = np.ones(rates, dtype=bool)
        for _, _, number, weight, mirrored in system.slots:
            # rates of angles are mirrored with the same sign, those of lengths with the opposite
            # one
            self.turning[number] &= weight == mirrored
        one = np.eye(m)
        self.basis = np.zeros((2 * m + rates, 2 * m + rates), dtype=complex)
        self.basis[:m, :m], self.basis[:m, m : 2 * m] = one, 1j * one
        self.basis[m : 2 * m, :m], self.basis[m : 2 * m, m : 2 * m] = one, -1j * one
        self.basis[2 * m :, 2 * m :] = np.diag(np.where(self.turning, 1.0, -1j))
        self.norm = np.zeros(2 * m + rates)

    def near(self, x: ComplexArray) -> Array:
        """A real point next to x (n,): directions of length 1, and rates that fit them best."""
        system, m = self.system, self.system.size
        u = 0.5 * (x[:m] + x[m : 2 * m].conj())
        p, q, p1, q1 = system.rows
        turns = (p == q) & (p1 == m) & (q1 == m)
        u[p[turns]] /= np.abs(u[p[turns]])
        y = np.concatenate([u.real, u.imag, np.zeros(2 * system.own)])
        _, jacobian = self.equations(y, None)
        _, _, rows = np.linalg.svd(jacobian[:-1, 2 * m :])
        self.norm[2 * m :] = y[2 * m :] = rows[-1]
        return y

    def place(self, y: Array) -> ComplexArray:
        """x (n,) of a real point."""
        x: ComplexArray = self.basis @ y.astype(complex)
        return x

    def value(self, y: Array) -> ComplexArray:
        """The input as U and as V have it, (2,)."""
        return self.lead(self.place(y))[0]

    def equations(self, y: Array, held: ComplexArray | None) -> tuple[Array, Array]:
        """Real residuals and their derivative; with the input ``held`` at a value (2,)."""
        x = self.place(y)
        f, jacobian = self.system.residual_and_jacobian(x[None])
        value, slope = f[0, :-1], jacobian[0, :-1] @ self.basis  # rates have a norm of their own
        if held is not None:
            now, change = self.lead(x)
            value = np.concatenate([value, now - held])
            slope = np.concatenate([slope, change @ self.basis])
        residual = np.concatenate([value.real, value.imag, [self.norm @ y - 1.0]])
        return residual, np.concatenate([slope.real, slope.imag, self.norm[None]])

    def correct(self, y: Array, held: ComplexArray | None) -> Array | None:
        """The solution that Gauss-Newton steps of least length lead to; ``None`` if to none."""
        for _ in range(_STEPS):
            f, jacobian = self.equations(y, held)
            if not np.isfinite(f).all():
                return None
            y = y - np.linalg.lstsq(jacobian, f, rcond=_FREE)[0]
        f, _ = self.equations(y, held)
        size = 1.0 + float(np.abs(y).max())
        return y if np.abs(f).max() <= _CLOSED * size * size else None
