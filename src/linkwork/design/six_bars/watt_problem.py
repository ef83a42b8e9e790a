"""Watt-II six-bars through pairs of angles, as polynomial equations in isotropic coordinates.

Two four-bars share the fixed pivot B0: A0 A B B0 with the crank, and C0 D C B0 with the rocker. B
and C are on one link, the bell crank. Each four-bar is seen along its ground, which is its unit of
length: from A0 to B0 the crank is the complex number a in the first position, the arm B0 B is b;
from C0 to B0 the rocker C0 D is d, the arm B0 C is c; ā, b̄, c̄, d̄ are unknowns of their own, which
are conjugates at real solutions.
Turned by u and v crank and rocker leave the couplers' lengths as they are if the bell crank has
turned by t = 1 + s with

    p s² + q s + r = 0,    p' s² + q' s + r' = 0,

and elimination of s leaves one equation for a pair u, v. Nine pairs, the first one included,
determine the eight unknowns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.foundation.arrays import BoolArray, ComplexArray
from linkwork.numerics.homotopy.bilinear_homotopy import normal_numbers
from linkwork.numerics.homotopy.parameter_path import Equations

__all__ = ["WATT", "WattProblem", "bell_crank_turns"]

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
        """Numbers that tell solutions (B, n) apart: there are no cognates of one kind."""
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
