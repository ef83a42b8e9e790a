"""Equations as rows of phasor terms."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property, lru_cache
from math import comb, cos, sin
from typing import Protocol, runtime_checkable

import numpy as np

from linkwork.core.foundation.arrays import (
    EXTENDED_EPSILON,
    UNIT_ROUNDOFF,
    Array,
    ComplexArray,
    IndexArray,
    tall_product,
)

# ----------------------------------------------------------------------
# Rows of phasor terms, the one shape of every planar closure equation and point.
#
#     F_l = Σ_t c_t s_t exp(i ψ_t),     ψ_t = Σ_k W_kt v_k
#
# ``v`` holds unknowns and inputs, angles in radians; ``s_t`` is one variable length or 1; ``c_t``
# is complex and holds fixed lengths and fixed offsets. A turning link has W = 1; a relative angle,
# a gear ratio or an input is just another column of W. Everything is batched: ``v`` is (B, N).


@dataclass(frozen=True, kw_only=True)
class PhasorRows:
    """Sparse description of R complex rows over N variables, T terms.

    Parameters
    ----------
    rows, variables : int
        R and N.
    row : (T,) int
        The row each term belongs to.
    coefficient : (T,) complex
    length : (T,) int
        Index of the term's variable length, -1 for none.
    phase_term, phase_variable, phase_weight : (P,)
        The non-zero entries W[variable, term].
    """

    rows: int
    variables: int
    row: IndexArray
    coefficient: ComplexArray
    length: IndexArray
    phase_term: IndexArray
    phase_variable: IndexArray
    phase_weight: Array

    @cached_property
    def weight_matrix(self) -> Array:
        """W, (N, T): what every variable turns the phase of every term by."""
        w = np.zeros((self.variables, len(self.row)))
        np.add.at(w, (self.phase_variable, self.phase_term), self.phase_weight)
        return w

    @cached_property
    def _sliding(self) -> IndexArray:
        """The terms with a variable length."""
        return np.flatnonzero(self.length >= 0)

    @cached_property
    def _gather(self) -> ComplexArray:
        """Adds terms into rows, (T, R)."""
        g = np.zeros((len(self.row), self.rows), dtype=complex)
        g[np.arange(len(self.row)), self.row] = 1.0
        return g

    @cached_property
    def _slopes(self) -> ComplexArray:
        """Adds terms, then bare phasors of sliding terms, into Jacobian entries, (T + S, R N)."""
        terms, sliding = len(self.row), self._sliding
        m = np.zeros((terms + len(sliding), self.rows, self.variables), dtype=complex)
        t, k = self.phase_term, self.phase_variable
        np.add.at(m, (t, self.row[t], k), 1j * self.phase_weight)  # eq. (2): turning
        s = np.arange(len(sliding))
        m[terms + s, self.row[sliding], self.length[sliding]] += 1.0  # eq. (2): sliding
        return m.reshape(terms + len(sliding), self.rows * self.variables)

    def _phasors(self, v: Array, coefficient: ComplexArray | None = None) -> ComplexArray:
        # eq. (1)
        own = self.coefficient if coefficient is None else coefficient
        phasors: ComplexArray = own * np.exp(1j * tall_product(v, self.weight_matrix))
        return phasors

    def _terms(self, v: Array, phasors: ComplexArray) -> ComplexArray:
        sliding = self._sliding
        if not len(sliding):
            return phasors
        # the bare phasors are needed again, for the derivatives by lengths
        terms = phasors.copy()
        terms[:, sliding] *= v[:, self.length[sliding]]
        return terms

    def value(self, v: Array) -> ComplexArray:
        """F, (B, R)."""
        return tall_product(self._terms(v, self._phasors(v)), self._gather)

    def value_and_jacobian(
        self, v: Array, coefficient: ComplexArray | None = None
    ) -> tuple[ComplexArray, ComplexArray]:
        """F, (B, R), and dF/dv, (B, R, N); ``coefficient``: other ones in each position, (B, T)."""
        phasors = self._phasors(v, coefficient)
        terms = self._terms(v, phasors)
        sliding = self._sliding
        both = np.concatenate([terms, phasors[:, sliding]], axis=1) if len(sliding) else terms
        jacobian = tall_product(both, self._slopes).reshape(len(v), self.rows, self.variables)
        return tall_product(terms, self._gather), jacobian

    def by_coefficients(self, v: Array) -> ComplexArray:
        """The derivatives of terms by their coefficients, (B, T)."""
        return self._terms(v, self._phasors(v, np.ones_like(self.coefficient)))

    def jet(self, v: Array, d1: Array, d2: Array) -> tuple[ComplexArray, ...]:
        """F with first and second derivative along a path with v' = d1, v'' = d2; each (B, R).

        For d2 = 0 the last one is the directional second derivative D²F[d1, d1].
        """
        e = self._phasors(v)
        psi1, psi2 = tall_product(d1, self.weight_matrix), tall_product(d2, self.weight_matrix)
        s, s1, s2 = np.ones_like(psi1), np.zeros_like(psi1), np.zeros_like(psi1)
        sliding = self._sliding
        index = self.length[sliding]
        s[:, sliding], s1[:, sliding], s2[:, sliding] = v[:, index], d1[:, index], d2[:, index]
        value = e * s
        first = e * (s1 + 1j * s * psi1)
        # eq. (3) with a = b, and the terms of v''
        second = e * (s2 - s * psi1**2 + 1j * (2.0 * s1 * psi1 + s * psi2))
        g = self._gather
        return tall_product(value, g), tall_product(first, g), tall_product(second, g)

    def hessians(self, v: Array, weights: ComplexArray) -> Array:
        """Second derivatives of the real parts of K sums of rows at one position, (K, N, N).

        Parameters
        ----------
        v : (N,)
        weights : (K, R) complex
            The factor of every row in each sum.
        """
        phasors = weights[:, self.row] * self._phasors(v[None, :])
        terms = self._terms(np.broadcast_to(v, (len(phasors), len(v))), phasors)
        turning, sliding = self.weight_matrix, self._sliding
        found: Array = -(turning * terms.real[:, None, :]) @ turning.T  # eq. (3)
        if len(sliding):
            slopes = np.zeros_like(found)
            both = turning[:, sliding] * -phasors.imag[:, None, sliding]
            np.add.at(slopes.transpose(2, 0, 1), self.length[sliding], both.transpose(2, 0, 1))
            found += slopes + slopes.transpose(0, 2, 1)
        return found

    def moduli(self, v: Array, factor: Array) -> tuple[Array, Array]:
        """|terms|, (B, T), and in dF/dv sums of moduli times each term's factor, (B, R, N)."""
        modulus = np.broadcast_to(np.abs(self.coefficient), factor.shape)
        terms = np.abs(self._terms(v, modulus.astype(complex)))
        sliding = self._sliding
        both = np.concatenate([terms * factor, (modulus * factor)[:, sliding]], axis=1)
        slopes = tall_product(both, np.abs(self._slopes))
        return terms, slopes.reshape(len(v), self.rows, self.variables)


# ----------------------------------------------------------------------
# Rows of phasor terms and lines at one position, rounded once: in whole-number arithmetic.
#
# Double precision loses a unit or two of rounding per term, which is enough to move a dead point
# that lies close to a change point: there an error δ of a closure shifts the input by δ / |sin θ|.
# Angles are multiples of 2^-B, lengths of a power of 2 that depends on the smallest of them.


_BITS = 160  # B: products of two floats, sums of many, and room
_ONE = 1 << _BITS
_MANTISSA = 53  # bits of a float


def exact_rows(rows: PhasorRows, v: Array) -> ComplexArray:
    """F of all rows at one position v (N,), each part rounded once, (R,)."""
    values, coefficients = v.tolist(), rows.coefficient.tolist()
    lengths = [values[k] if k >= 0 else None for k in rows.length.tolist()]
    phases = [0] * len(rows.row)
    lists = (x.tolist() for x in (rows.phase_term, rows.phase_variable, rows.phase_weight))
    for t, k, w in zip(*lists, strict=True):
        phases[t] += (_whole(w, _BITS) * _whole(values[k], _BITS)) >> _BITS
    parts = [part for factor in coefficients for part in (factor.real, factor.imag)]
    bits = _BITS + _room(parts) + _room(length for length in lengths if length is not None)
    sums = [[0, 0] for _ in range(rows.rows)]
    terms = zip(phases, rows.row.tolist(), coefficients, lengths, strict=True)
    for phase, row, factor, length in terms:
        c, s = _cosine_and_sine(phase)
        re, im = _whole(factor.real, bits), _whole(factor.imag, bits)
        along, across = (re * c - im * s) >> _BITS, (re * s + im * c) >> _BITS
        if length is not None:
            by = _whole(length, bits)
            along, across = (by * along) >> bits, (by * across) >> bits
        sums[row][0] += along
        sums[row][1] += across
    one = 1 << bits
    return np.array([complex(re / one, im / one) for re, im in sums], dtype=complex)


def exact_line(constant: float, weights: Sequence[float], values: Sequence[float]) -> float:
    """Σ w v + constant, rounded once."""
    pairs = zip(weights, values, strict=True)
    return float(sum((Fraction(w) * Fraction(x) for w, x in pairs if w), Fraction(constant)))


def _whole(x: float, bits: int) -> int:
    """x · 2^bits."""
    part, exponent = math.frexp(x)
    shift = exponent + bits - _MANTISSA
    whole = int(math.ldexp(part, _MANTISSA))
    return whole << shift if shift >= 0 else whole >> -shift


def _room(sizes: Iterable[float]) -> int:
    """How many bits more the smallest of some numbers needs to be as precise as 1 is."""
    return max([0, *(-math.frexp(size)[1] for size in sizes if size)])


@cache
def _quarter() -> int:
    """π/2 · 2^B by Machin's formula, π/4 = 4 atan(1/5) - atan(1/239)."""
    extra = 64  # for whole turns

    def arc(n: int) -> int:
        power = (1 << (_BITS + extra)) // n
        total, k, sign = power, 1, 1
        while power:
            power //= n * n
            k, sign = k + 2, -sign
            total += sign * (power // k)
        return total

    return 2 * (4 * arc(5) - arc(239))


@lru_cache(maxsize=256)  # many terms of a mechanism turn together
def _cosine_and_sine(angle: int) -> tuple[int, int]:
    """cos and sin of ``angle`` · 2^-B, times 2^B."""
    quarter = _quarter()
    extra = quarter.bit_length() - 1 - _BITS
    number = ((angle << extra) + quarter // 2) // quarter
    rest = angle - ((number * quarter) >> extra)
    c, s, term, k = _ONE, 0, _ONE, 0
    while term:
        k += 1
        term = ((term * rest) >> _BITS) // k
        if -1 <= term <= 0:
            break
        sign = -1 if k % 4 in (2, 3) else 1
        if k % 2:
            s += sign * term
        else:
            c += sign * term
    return ((c, s), (-s, c), (-c, -s), (s, -c))[number % 4]


# ----------------------------------------------------------------------
# Real equations of a loop table: linear ones, and those given by functions.


class FunctionRow(Protocol):
    """A real equation given by any smooth function of a few variables."""

    @property
    def variables(self) -> tuple[int, ...]:
        """Indices of the variables it depends on."""

    def moved(self, new_index: dict[int, int]) -> FunctionRow:
        """The same row over renumbered variables."""

    def value_and_gradient(self, v: Array) -> tuple[Array, Array]:
        """Value (B,) and derivatives by ``variables`` (B, len(variables))."""

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """Second derivative along d, (B,)."""

    def repeats_after(self, turns: Array) -> bool:
        """Whether ``variables`` (k,) moved by these whole turns are known to satisfy the same."""


@runtime_checkable
class EnclosedRow(FunctionRow, Protocol):
    """A row that is known over boxes."""

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest value (2, B), and derivatives by ``variables`` (2, B, k), over boxes
        around v (B, N) with half widths ``box`` (B, N).
        """


def hessian_of(row: FunctionRow, v: Array) -> Array:
    """The second derivatives of a row at one position v (N,), (N, N)."""
    # a row may name a variable twice
    i, j = (index.ravel() for index in np.meshgrid(*[np.unique(row.variables)] * 2))
    steps, places = np.eye(len(v)), np.tile(v, (len(i), 1))
    along = row.second_directional_derivative(places, steps[i] + steps[j])
    across = row.second_directional_derivative(places, steps[i] - steps[j])
    found = np.zeros((len(v), len(v)))
    found[i, j] = 0.25 * (along - across)  # eq. (5)
    return found


@dataclass(frozen=True, kw_only=True)
class LinearRows:
    """Rows Σ_k weight v_k + constant = 0 as sparse entries."""

    constant: Array
    row: IndexArray
    variable: IndexArray
    weight: Array

    @classmethod
    def none(cls) -> LinearRows:
        """No rows."""
        empty = np.zeros(0, dtype=np.intp)
        return cls(constant=np.zeros(0), row=empty, variable=empty, weight=np.zeros(0))


# ----------------------------------------------------------------------
# Real functions given piece by piece: polynomials plus one sine, joined smoothly.
#
#     f(x) = Σ_k c_k t^k + A sin(ω t + ψ),     t = x - b,  b ≤ x < next b
#
# Motion laws of cams and cubic splines are of this kind. A function either repeats itself after its
# period, or continues as a straight line beyond its ends.


_PARTS = 32  # of each piece, in which its bend is bounded


@dataclass(frozen=True, kw_only=True, eq=False)
class Piecewise:
    """A function with continuous slope, K pieces.

    Parameters
    ----------
    breaks : (K + 1,)
        Where pieces begin and the last one ends, increasing.
    powers : (K, D + 1)
        c_k of every piece, lowest power first.
    sines : (K, 3)
        A, ω, ψ of every piece.
    periodic : bool
        Whether it repeats itself after ``breaks[-1] - breaks[0]``.
    corners : tuple of int
        The joints, counted from that of the first two pieces, at which its slope changes: bounds
        hold on either side of them, not across.
    """

    breaks: Array
    powers: Array
    sines: Array
    periodic: bool = True
    corners: tuple[int, ...] = ()

    @property
    def period(self) -> float:
        """How long all pieces are together."""
        return float(self.breaks[-1] - self.breaks[0])

    def slope(self) -> Piecewise:
        """The derivative as a function; beyond open ends it continues as a straight line.

        Its slope is continuous only if the second derivative of this one is.
        """
        k = np.arange(1, self.powers.shape[1])
        a, w, p = self.sines.T
        return Piecewise(
            breaks=self.breaks,
            powers=self.powers[:, 1:] * k,
            sines=np.stack([a * w, w, p + np.pi / 2.0], axis=1),
            periodic=self.periodic,
        )

    def slope_before_joints(self) -> Array:
        """The derivative at the end of all pieces but the last, (K - 1,)."""
        t = np.diff(self.breaks)[:-1]
        degrees = np.arange(1, self.powers.shape[1])
        a, w, p = self.sines[:-1].T
        straight = (self.powers[:-1, 1:] * degrees * t[:, None] ** (degrees - 1.0)).sum(axis=1)
        found: Array = straight + a * w * np.cos(w * t + p)
        return found

    def times(self, factor: float) -> Piecewise:
        """The function with all values multiplied."""
        return replace(
            self, powers=factor * self.powers, sines=self.sines * np.array([factor, 1.0, 1.0])
        )

    def locate(self, x: Array) -> tuple[IndexArray, Array, Array]:
        """Piece of each x, t inside it, and how far x lies beyond an open end."""
        low, high = self.breaks[0], self.breaks[-1]
        if self.periodic:
            inside = low + np.mod(x - low, self.period)
            beyond = np.zeros_like(x)
        else:
            inside = np.clip(x, low, high)
            beyond = x - inside
        piece = np.clip(np.searchsorted(self.breaks, inside, side="right") - 1, 0, None)
        piece = np.minimum(piece, len(self.breaks) - 2)
        return piece, inside - self.breaks[piece], beyond

    def jet(self, x: Array) -> tuple[Array, Array, Array]:
        """Value, first and second derivative at any x; the second from the right at a joint."""
        shape, x = np.shape(x), np.ravel(np.asarray(x, dtype=float))
        piece, t, beyond = self.locate(x)
        c = self.powers[piece]
        value, first, second = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        for k in range(c.shape[1] - 1, -1, -1):
            second = second * t + 2.0 * first
            first = first * t + value
            value = value * t + c[:, k]
        a, w, p = self.sines[piece].T
        sine, cosine = a * np.sin(w * t + p), a * w * np.cos(w * t + p)
        first = first + cosine
        value = value + sine + first * beyond
        second = np.where(beyond == 0.0, second - w**2 * sine, 0.0)
        return value.reshape(shape), first.reshape(shape), second.reshape(shape)

    @cached_property
    def _lists(self) -> tuple[list[float], list[list[float]], list[list[float]]]:
        """Breaks, powers from the highest on, and sines."""
        return self.breaks.tolist(), self.powers[:, ::-1].tolist(), self.sines.tolist()

    def jet_at(self, x: float) -> tuple[float, float, float]:
        """:meth:`jet` at one number."""
        breaks, powers, sines = self._lists
        low, high = breaks[0], breaks[-1]
        inside = low + (x - low) % (high - low) if self.periodic else min(max(x, low), high)
        beyond = 0.0 if self.periodic else x - inside
        piece = min(max(bisect_right(breaks, inside) - 1, 0), len(powers) - 1)
        t = inside - breaks[piece]
        value = first = second = 0.0
        for c in powers[piece]:
            second = second * t + 2.0 * first
            first = first * t + value
            value = value * t + c
        a, w, p = sines[piece]
        sine, cosine = a * sin(w * t + p), a * w * cos(w * t + p)
        first += cosine
        return value + sine + first * beyond, first, 0.0 if beyond else second - w * w * sine

    def __call__(self, x: Array) -> Array:
        """The value at any x."""
        return self.jet(x)[0]

    @cached_property
    def bend(self) -> float:
        """No smaller than |f''| anywhere."""
        count = self.powers.shape[1]
        lengths = np.diff(self.breaks)
        half = lengths / (2.0 * _PARTS)
        largest = np.zeros(len(lengths))
        for part in range(_PARTS):
            middle = (2 * part + 1) * half
            total = np.zeros(len(lengths))
            for j in range(count - 2):  # Taylor coefficients of f'' about the middle of the part
                coefficient = np.zeros(len(lengths))
                for k in range(count - 1, j + 1, -1):
                    coefficient = coefficient * middle + self.powers[:, k] * (
                        k * (k - 1) * comb(k - 2, j)
                    )
                total += np.abs(coefficient) * half**j
            largest = np.maximum(largest, total)
        sine = np.abs(self.sines[:, 0]) * self.sines[:, 1] ** 2
        own = float((largest + sine).max(initial=0.0)) * (1.0 + 1e-9)
        return own + self.gaps[1] / self.period

    @cached_property
    def gaps(self) -> tuple[float, float]:
        """How far this function and its slope may be from one that really is smooth.

        Coefficients are rounded, so pieces meet only nearly. With jumps J of the value and D of the
        slope at the joints, adding a function of no more than Σ|J| + P Σ|D|, whose slope is no more
        than 2 Σ|D| + Σ|J|/P and whose second derivative is Σ D/P, leaves none (P: all pieces).
        """
        exact = np.longdouble
        unit = EXTENDED_EPSILON
        c, (a, w, p) = self.powers.astype(exact), self.sines.T.astype(exact)
        t = np.diff(self.breaks.astype(exact))
        degrees = np.arange(c.shape[1])
        powers = t[:, None] ** degrees
        slopes = c[:, 1:] * degrees[1:]
        phase = w * t + p
        value = (c * powers).sum(axis=1) + a * np.sin(phase)
        slope = (slopes * powers[:, :-1]).sum(axis=1) + a * w * np.cos(phase)
        factor = unit * (2.0 * c.shape[1] + 8.0)
        slack = factor * (np.abs(c) * powers).sum(axis=1) + unit * np.abs(a) * (8 + np.abs(phase))
        steep = factor * (np.abs(slopes) * powers[:, :-1]).sum(axis=1)
        steep += unit * np.abs(a * w) * (8 + np.abs(phase))
        begin, rate = c[:, 0] + a * np.sin(p), c[:, 1] + a * w * np.cos(p)
        jumps = np.abs(value - np.roll(begin, -1)) + 2.0 * (slack + np.roll(slack, -1))
        bends = np.abs(slope - np.roll(rate, -1)) + 2.0 * (steep + np.roll(steep, -1))
        bends[list(self.corners)] = 0.0
        last = None if self.periodic else -1
        jump, bend = float(jumps[:last].sum()), float(bends[:last].sum())
        return jump + self.period * bend, 2.0 * bend + jump / self.period

    def rounding(self, x: Array) -> tuple[Array, Array]:
        """Bounds of the error of computing the value and the first derivative at x (B,)."""
        piece, t, beyond = self.locate(x)
        c, degrees = np.abs(self.powers[piece]), np.arange(self.powers.shape[1])
        t = np.abs(t)
        powers = t[:, None] ** degrees
        a, w, p = np.abs(self.sines[piece].T)
        phase = 8.0 + w * t + p
        slope_powers = (c[:, 1:] * degrees[1:]) * powers[:, :-1]
        moved = 2.0 * (np.abs(x) + self.period + np.abs(self.breaks).max())
        factor = 2.0 * self.powers.shape[1] + 8.0
        slope_error = factor * slope_powers.sum(axis=1) + a * w * phase + self.bend * moved
        steepest = np.abs(self.jet(x)[1]) + UNIT_ROUNDOFF * slope_error
        value_error = factor * (c * powers).sum(axis=1) + a * phase + steepest * moved
        value_error += (factor * steepest + slope_error) * np.abs(beyond)
        apart, steeper = self.gaps
        return apart + UNIT_ROUNDOFF * value_error + steeper * np.abs(
            beyond
        ), steeper + UNIT_ROUNDOFF * slope_error


# ----------------------------------------------------------------------
# Rows that tie variables by a function of one sum: Σ a v + constant - f(Σ w v + offset) = 0.


_TURN = 2.0 * np.pi
TURN_ROUNDING = 8.0 * UNIT_ROUNDOFF  # a third is no float, but three of them are one turn


@dataclass(frozen=True, kw_only=True, eq=False)
class LawRow:
    """One real equation with a function whose bend is bounded.

    Parameters
    ----------
    variables : tuple of int
    weights, constant
        a (k,) and the constant of the straight part.
    law : Piecewise
    inner, offset
        w (k,) and the offset of the function's argument.
    error
        How far the function may be from the one that it stands for.
    """

    variables: tuple[int, ...]
    weights: Array
    constant: float
    law: Piecewise
    inner: Array
    offset: float
    error: float = 0.0

    def moved(self, new_index: dict[int, int]) -> LawRow:
        """The same row over renumbered variables."""
        return replace(self, variables=tuple(new_index[k] for k in self.variables))

    @cached_property
    def terms(self) -> list[tuple[int, float, float]]:
        """Every variable with its weight and inner weight."""
        parts = self.weights.tolist(), self.inner.tolist()
        return list(zip(self.variables, *parts, strict=True))

    def jet_at(self, v: Sequence[float]) -> tuple[float, float, float]:
        """The row's value at one position v (N,), and both derivatives of the law there."""
        straight, argument = self.constant, self.offset
        for k, a, w in self.terms:
            straight += a * v[k]
            argument += w * v[k]
        value, slope, bend = self.law.jet_at(argument)
        return straight - value, slope, bend

    def _argument(self, v: Array) -> Array:
        argument: Array = v[:, list(self.variables)] @ self.inner + self.offset
        return argument

    def value_and_gradient(self, v: Array) -> tuple[Array, Array]:
        """Value (B,) and derivatives by ``variables`` (B, k)."""
        value, slope, _ = self.law.jet(self._argument(v))
        straight = v[:, list(self.variables)] @ self.weights + self.constant
        return straight - value, self.weights - slope[:, None] * self.inner  # eq. (4)

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """Second derivative along d, (B,)."""
        turned = d[:, list(self.variables)] @ self.inner
        # second derivative of eq. (4)
        second: Array = -self.law.jet(self._argument(v))[2] * turned**2
        return second

    def repeats_after(self, turns: Array) -> bool:
        """Whether ``variables`` (k,) moved by this many whole turns satisfy the same equation."""
        straight, bulk = self.weights @ turns, np.abs(self.weights) @ np.abs(turns)
        inner, size = self.inner @ turns, np.abs(self.inner) @ np.abs(turns)
        if self.law.periodic:
            unit = _TURN / self.law.period
            inner, size = inner * unit - np.round(inner * unit), size * unit
        return bool(abs(straight) <= TURN_ROUNDING * bulk and abs(inner) <= TURN_ROUNDING * size)

    @property
    def bend(self) -> float:
        """No smaller than the second derivative of the function anywhere."""
        return self.law.bend

    def rounding(self, v: Array) -> tuple[Array, Array]:
        """Bounds of the error of the value (B,) and of its derivatives (B, k)."""
        x = v[:, list(self.variables)]
        value, slope = self.law.rounding(self._argument(v))
        argument = np.abs(x) @ np.abs(self.inner) + abs(self.offset)
        count = len(self.variables) + 3.0
        moved = count * UNIT_ROUNDOFF * argument
        straight = np.abs(x) @ np.abs(self.weights) + abs(self.constant)
        steepest = np.abs(self.law.jet(self._argument(v))[1]) + self.law.bend * moved
        size = np.abs(self.law(self._argument(v)))
        # polynomials of degree five that are off by so much have slopes off by 50 of it a piece
        slope = slope + 50.0 * self.error * len(self.law.powers) / self.law.period
        value = value + self.error
        error = value + steepest * moved + UNIT_ROUNDOFF * (count * straight + 2.0 * size)
        slopes = (slope + self.law.bend * moved + 2.0 * UNIT_ROUNDOFF * steepest)[:, None] * np.abs(
            self.inner
        )
        return error, slopes + 2.0 * UNIT_ROUNDOFF * np.abs(self.weights)
