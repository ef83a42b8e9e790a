"""Curves of dead points: can the mechanism really move while its input rests?

Where equal links lie on each other, a :class:`DeadPointSystem` has curves of solutions besides the
isolated ones. A position is real if V = U* and its rates are those of real angles and lengths,
ω = ω* and σ = -σ*. On a curve along which the input keeps a value that is not real, there is none.
Elsewhere one is looked for by Gauss-Newton steps among points of this kind,

    U = a + i b,   V = a - i b,   ω,   σ = -i s     with a, b, ω, s real,

and then a second one near it that has the same input.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.circuits.homotopy.dead_points import DeadPointSystem
from linkwork.core.foundation.arrays import Array, ComplexArray

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
