"""Rows of phasor terms, the one shape of every planar closure equation and point.

    F_l = Σ_t c_t s_t exp(i ψ_t),     ψ_t = Σ_k W_kt v_k

``v`` holds unknowns and inputs, angles in radians; ``s_t`` is one variable length or 1; ``c_t`` is
complex and holds fixed lengths and fixed offsets. A turning link has W = 1; a relative angle, a
gear ratio or an input is just another column of W. Everything is batched: ``v`` is (B, N).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.foundation.products import tall_product

__all__ = ["PhasorRows"]


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
