"""Watt-II six-bars through pairs of angles, as polynomial equations in isotropic coordinates.

Two four-bars share the fixed pivot B0: A0 A B B0 with the crank, and C0 D C B0 with the rocker. B
and C are on one link, the bell crank. Each four-bar is seen along its ground, which is its unit of
length: from A0 to B0 the crank is the complex number a in the first position, the arm B0 B is b;
from C0 to B0 the rocker C0 D is d, the arm B0 C is c; ā, b̄, c̄, d̄ are separate unknowns, which
are conjugates at real solutions.
Turned by u and v crank and rocker leave the couplers' lengths as they are if the bell crank has
turned by t = 1 + s with

    p s² + q s + r = 0,    p' s² + q' s + r' = 0,

and elimination of s leaves one equation for a pair u, v. Nine pairs, the first one included,
determine the eight unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.circuits.homotopy.monodromy import Member
from linkwork.circuits.homotopy.parameter_roots import ParameterRoots, roots_at
from linkwork.circuits.homotopy.path_tracking import Equations, Tracker
from linkwork.core.foundation.arrays import ALMOST_REAL, Array, BoolArray, ComplexArray
from linkwork.core.foundation.statuses import Completeness
from linkwork.synthesis.precision.positions import exact_turn, prove_numbers, whole_unit
from linkwork.synthesis.precision.problem import ComplexPlace, ProductSums, ProductWriter
from linkwork.synthesis.precision.solving import SparingTracker, stored_member

_UNKNOWNS = 8
_ARMS = [2, 3, 6, 7]  # b, b̄, c, c̄
_TURN = 0.7  # rad, of random complex rotations
_CLOSE, _FAR = 0.1, 10.0  # rotations of a random six-bar beyond these make a bad start
_NOTHING = 1e-9  # of the largest number of a solution: zero
_OFF_CIRCLE = 1e-9  # how far a rotation of a real task is from the unit circle

#: p, q, r; their derivatives by the four unknowns; and by the rotation.
_Loop = tuple[tuple[Any, Any, Any], tuple[list[Any], list[Any], list[Any]], tuple[Any, Any, Any]]


@dataclass(frozen=True)
class WattProblem:
    """All Watt-II six-bars through nine pairs of angles.

    Notes
    -----
    Unknowns are a, ā, b, b̄, d, d̄, c, c̄; parameters are u and v of every pair after the first.
    """

    @property
    def unknowns(self) -> int:
        """n."""
        return _UNKNOWNS

    @property
    def parameters(self) -> int:
        """P."""
        return 2 * _UNKNOWNS

    @property
    def last(self) -> slice:
        """The parameters of the last pair."""
        return slice(2 * _UNKNOWNS - 2, 2 * _UNKNOWNS)

    @property
    def name(self) -> str:
        """The name of its start set."""
        return "watt-ii"

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        """The equations, with operators alone."""
        values, slopes, changes = list[Any](), list[list[Any]](), list[Any]()
        for k in range(0, 2 * _UNKNOWNS, 2):
            one, other = _loop(z[:4], c[k]), _loop(z[4:], c[k + 1])
            (p1, q1, r1), (p2, q2, r2) = one[0], other[0]
            d, e, g = p1 * r2 - p2 * r1, p1 * q2 - p2 * q1, q1 * r2 - q2 * r1
            twice = d + d
            # derivatives by p, q, r of both loops
            first = (twice * r2 - g * q2, g * p2 - e * r2, e * q2 - twice * p2)
            second = (g * q1 - twice * r1, e * r1 - g * p1, twice * p1 - e * q1)
            values.append(d * d - e * g)  # eq. (181)
            slopes.append(_combined(first, one[1]) + _combined(second, other[1]))
            changes.append(_sum(first, one[2]) * rate[k] + _sum(second, other[2]) * rate[k + 1])
        return values, slopes, changes

    def proper(self, x: ComplexArray, c: ComplexArray) -> BoolArray:
        """Which solutions (B, n) are six-bars: a link of no length leaves its neighbour at rest,
        and so do B at A0 and C at C0, whatever crank and rocker are.
        """
        size = np.abs(x)
        moves = np.abs(1.0 + x[:, _ARMS]).max(axis=1) > _NOTHING
        return np.asarray(moves & (size.min(axis=1) > _NOTHING * size.max(axis=1, initial=1.0)))

    def is_real(self, c: ComplexArray) -> bool:
        """Whether parameters (P,) are rotations by real angles."""
        return bool((np.abs(np.abs(c) - 1.0) < _OFF_CIRCLE).all())

    def mirrored(self, x: ComplexArray) -> ComplexArray:
        """The mirror images (B, n): ā in place of a, and so on."""
        return x[:, np.arange(_UNKNOWNS) ^ 1].conj()

    def fingerprint(self, x: ComplexArray, c: ComplexArray) -> ComplexArray:
        """Numbers by which solutions (B, n) differ: there are no cognates of one kind."""
        return x

    def random_parameters(self, rng: np.random.Generator) -> ComplexArray:
        """Random complex parameters (P,)."""
        return np.asarray(np.exp(_TURN * 1j * normal_numbers(rng, 2 * _UNKNOWNS)))

    def random_member(self, rng: np.random.Generator) -> tuple[ComplexArray, ComplexArray]:
        """Random parameters (P,) and one of their solutions (n,): a random six-bar that moves."""
        while True:
            z = normal_numbers(rng, _UNKNOWNS)
            u = np.exp(_TURN * 1j * normal_numbers(rng, _UNKNOWNS))
            with np.errstate(all="ignore"):
                t = 1.0 + _root(rng, *_loop(z[:4], u)[0])
                # the second four-bar, driven by its other end
                v = 1.0 + _root(rng, *_loop(-z[[6, 7, 4, 5]], t)[0])
            turned = np.abs(np.concatenate([t, v]))
            if (turned > _CLOSE).all() and (turned < _FAR).all():
                return np.stack([u, v], axis=1).ravel(), z


WATT = WattProblem()


def bell_crank_turns(x: ComplexArray, u: ComplexArray, v: ComplexArray) -> ComplexArray:
    """The rotations t (B, J) of bell cranks of solutions x (B, n) at pairs u, v (J,)."""
    z = x.T[:, :, None]
    (p1, q1, r1), (p2, q2, r2) = _loop(z[:4], u)[0], _loop(z[4:], v)[0]
    with np.errstate(all="ignore"):
        turns: ComplexArray = 1.0 - (p1 * r2 - p2 * r1) / (p1 * q2 - p2 * q1)  # eq. (181)
    return turns


def _loop(z: Any, u: Any) -> _Loop:
    """p, q, r of a four-bar with the crank a turned by u."""
    a, a_bar, b, b_bar = z
    back, end, end_bar = 1.0 - u, 1.0 + b, 1.0 + b_bar
    left = a * u * end_bar - a_bar * end
    p, r = b * (u - a_bar), back * left  # eq. (180)
    q = (b - b_bar) * u - b * a_bar + b_bar * a * u * u + r
    by = [back * u * end_bar, -(back * end), -(back * a_bar), back * a * u]
    slopes = (
        [0.0, -b, u - a_bar, 0.0],
        [b_bar * u * u + by[0], by[1] - b, u - a_bar + by[2], a * u * u - u + by[3]],
        by,
    )
    r_rate = back * a * end_bar - left
    return (p, q, r), slopes, (b, b - b_bar + 2.0 * b_bar * a * u + r_rate, r_rate)


def _root(rng: np.random.Generator, p: Any, q: Any, r: Any) -> ComplexArray:
    """A random root of p s² + q s + r."""
    sign = rng.choice([-1.0, 1.0], len(p))
    return np.asarray((sign * np.sqrt(q * q - 4.0 * p * r) - q) / (2.0 * p))


def _sum(factors: tuple[Any, ...], terms: tuple[Any, ...]) -> Any:
    return factors[0] * terms[0] + factors[1] * terms[1] + factors[2] * terms[2]


def _combined(factors: tuple[Any, ...], rows: tuple[list[Any], ...]) -> list[Any]:
    """The sum of rows times factors."""
    return [_sum(factors, column) for column in zip(*rows, strict=True)]


# ----------------------------------------------------------------------
# A solved random member of the Watt-II six-bars, shipped with the package.
#
# ``scripts/start_linkages`` computes it by monodromy and confirms it by the trace test.


SHIPPED = Path(__file__).with_name("start_six_bars.npz")


@cache
def watt_member() -> Member:
    """The shipped solved member.

    Raises
    ------
    InputError
        If the installation is damaged.
    """
    return stored_member(WATT, SHIPPED)


# ----------------------------------------------------------------------
# Proof that a real Watt-II six-bar goes exactly through its pairs of angles.
#
# Both four-bars are seen from the ground of the crank to that of the rocker: a is the crank, b and
# c are the arms of the bell crank, e is the rocker. The arms in every position, seen from crank and
# rocker, are separate unknowns, B = b t / u and C = c t / v. With m = b̄ c all conditions are
# quadratic equations, eq. (182):
#
#     |B|² = |b|²,   B̄ C = m u v̄,   |ū + B - a|² = |1 + b - a|²,   |v̄ + e - C|² = |1 + e - c|².


_SIZE = 1.0  # of the numbers: each four-bar has its ground as the unit
_POSITIONS = 8  # after the first


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvedSixBars:
    """Proofs of D six-bars.

    Parameters
    ----------
    arms : (D, 4) complex
        a, b, c, e, refined [ground of their four-bar].
    turns : (D, 9) complex
        The rotations of the bell crank.
    holds : (D,) bool
    error : (D,)
        A bound of the errors of all arms in all positions [ground of their four-bar]; infinite
        where no proof holds.
    """

    arms: ComplexArray
    turns: ComplexArray
    holds: BoolArray
    error: Array


def prove_six_bars(x: ComplexArray, inputs: Array, outputs: Array) -> ProvedSixBars:
    """Refine real solutions (D, 8), and prove them.

    ``inputs``, ``outputs``: (8,) angles of crank and rocker from their first ones [rad].
    """
    u, v = (np.exp(1j * angle) for angle in (inputs, outputs))
    a, b, d, c = (0.5 * (x[:, k] + x[:, k + 1].conj()) for k in (0, 2, 4, 6))
    c, e = -c, -d
    turns = bell_crank_turns(x, u, v)
    with np.errstate(all="ignore"):
        turns = turns / np.abs(turns)
    parts = [a, b, c, e, b.conj() * c]
    for t, one, other in zip(turns.T, u, v, strict=True):
        parts += [b * t / one, c * t / other]
    guess = np.ascontiguousarray(np.stack(parts, axis=1)).view(float)
    bits = whole_unit(_SIZE)
    proof = prove_numbers(_equations(), guess, _parameters(inputs, outputs, bits), bits, _SIZE)
    pairs = proof.v[:, 0::2] + 1j * proof.v[:, 1::2]
    arms = pairs[:, :4]
    with np.errstate(all="ignore"):
        turned = pairs[:, 5 : 5 + 2 * _POSITIONS : 2] * u / arms[:, 1:2]
        turned = turned / np.abs(turned)
    return ProvedSixBars(
        arms=arms,
        turns=np.concatenate([np.ones((len(x), 1)), turned], axis=1),
        holds=proof.holds,
        error=proof.error,
    )


def _parameters(inputs: Array, outputs: Array, bits: int) -> list[int]:
    """u, v and u v̄ of all pairs, and 1, as whole numbers."""
    numbers = list[int]()
    for one, other in zip(inputs.tolist(), outputs.tolist(), strict=True):
        (ur, ui), (vr, vi) = exact_turn(one, bits), exact_turn(other, bits)
        numbers += [ur, ui, vr, vi, (ur * vr + ui * vi) >> bits, (ui * vr - ur * vi) >> bits]
    return [*numbers, 1 << bits, 0]


@cache
def _equations() -> ProductSums:
    """The equations; v is a, b, c, e, m, all B and C, then u, v and u v̄ of all pairs, 1 and 0."""
    places = [(k, k + 1) for k in range(0, 10 + 10 * _POSITIONS + 2, 2)]
    a, b, c, e, m = places[:5]
    arms = places[5 : 5 + 2 * _POSITIONS]
    rotations, one = places[5 + 2 * _POSITIONS : -1], places[-1]
    writer = ProductWriter()
    for part, terms in zip(m, _conjugate_product(b, c), strict=True):
        writer.equation((-1, part, one[0]), *terms)
    for k in range(_POSITIONS):
        arm_b, arm_c = arms[2 * k : 2 * k + 2]
        u, v, both = rotations[3 * k : 3 * k + 3]
        # eq. (182)
        writer.equal_lengths(arm_b, b)
        real, imag = _conjugate_product(arm_b, arm_c)
        writer.equation(*real, (-1, m[0], both[0]), (1, m[1], both[1]))
        writer.equation(*imag, (-1, m[0], both[1]), (-1, m[1], both[0]))
        _coupler(writer, (u, a, arm_b), (a, b), one)
        _coupler(writer, (v, arm_c, e), (c, e), one)
    return writer.sums(places[5 + 2 * _POSITIONS][0], one[1] + 1)


def _coupler(
    writer: ProductWriter,
    moved: tuple[ComplexPlace, ComplexPlace, ComplexPlace],
    start: tuple[ComplexPlace, ComplexPlace],
    one: ComplexPlace,
) -> None:
    """|w̄ + y - x|² = |1 + y0 - x0|² for w, x, y, where |x| = |x0| and |y| = |y0|."""
    turn, x, y = moved
    x0, y0 = start
    writer.equation(
        *_real_product(1, turn, y),
        *_real_product(-1, turn, x),
        *[(-1, i, j) for i, j in zip(y, x, strict=True)],
        (-1, one[0], y0[0]),
        (1, one[0], x0[0]),
        *[(1, i, j) for i, j in zip(y0, x0, strict=True)],
    )


def _real_product(
    factor: int, x: ComplexPlace, y: ComplexPlace
) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """The real part of x y."""
    return (factor, x[0], y[0]), (-factor, x[1], y[1])


def _conjugate_product(
    x: ComplexPlace, y: ComplexPlace
) -> tuple[list[tuple[int, int, int]], list[tuple[int, int, int]]]:
    """Both parts of x̄ y."""
    return [(1, x[0], y[0]), (1, x[1], y[1])], [(1, x[0], y[1]), (-1, x[1], y[0])]


# ----------------------------------------------------------------------
# All Watt-II six-bars through nine pairs of angles: solved, counted, and proved where real.


#: Pairs of angles that a Watt-II six-bar meets exactly, the first one included.
PAIRS = 9
_SEED = 20_140_601  # of detours; every run gives the same answer
_LEAST_SIZE = 0.1  # of the ground: numbers are compared relative to at least this


@dataclass(frozen=True, kw_only=True, eq=False)
class WattSixBars:
    """Real Watt-II six-bars through nine pairs, and how many solutions there are.

    Parameters
    ----------
    arms : (D, 4) complex
        Crank a and arm b at the first position, seen along the ground of the first four-bar, and
        arm c and rocker e along that of the second one [ground of their four-bar].
    turns : (D, 9) complex
        The rotations of the bell crank, e^{iψ}, from the first position.
    inputs, outputs : (9,)
        Angles of crank and rocker from their first ones [rad].
    proved : (D,) bool
    error : (D,)
        A bound of the errors of all arms in all positions [ground of their four-bar]; infinite
        where it is not proved.
    roots : ParameterRoots
        All complex solutions, and the outcome of every path.
    """

    arms: ComplexArray
    turns: ComplexArray
    inputs: Array
    outputs: Array
    proved: BoolArray
    error: Array
    roots: ParameterRoots

    def __len__(self) -> int:
        return len(self.arms)

    @property
    def completeness(self) -> Completeness:
        """Whether all real six-bars are listed."""
        return self.roots.graded(self.proved)


def watt_six_bars(
    inputs: Array,
    outputs: Array,
    tracker: Tracker | None = None,
    *,
    member: Member | None = None,
    progress: Callable[[float], None] | None = None,
) -> WattSixBars:
    """All Watt-II six-bars whose rocker has turned by ``outputs`` at the inputs.

    Parameters
    ----------
    inputs, outputs : (9,)
        Angles [rad], of which differences from the first ones count.
    tracker : Tracker, optional
        By default compiled where that saves time.
    member : Member, optional
        A solved member to start from; by default the shipped one.
    progress : callable, optional
        Called with the finished fraction of the paths; may raise an error to end the work.
    """
    member = member or watt_member()
    inputs, outputs = inputs - inputs[0], outputs - outputs[0]
    goal = np.exp(1j * np.stack([inputs[1:], outputs[1:]], axis=1)).ravel()
    tracker = tracker or SparingTracker(len(member.x), progress)
    roots = roots_at(WATT, member, goal, tracker, np.random.default_rng(_SEED))
    apart = np.abs(WATT.mirrored(roots.x) - roots.x) / (_LEAST_SIZE + np.abs(roots.x))
    real = roots.x[apart.max(axis=1, initial=0.0) < ALMOST_REAL]
    proofs = prove_six_bars(real, inputs[1:], outputs[1:])
    return WattSixBars(
        arms=proofs.arms,
        turns=proofs.turns,
        inputs=inputs,
        outputs=outputs,
        proved=proofs.holds,
        error=proofs.error,
        roots=roots,
    )
