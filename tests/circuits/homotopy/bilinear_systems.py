"""Bilinear systems made by hand, and random ones with known real solutions."""

from __future__ import annotations

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import Roots
from linkwork.circuits.homotopy.isolated_roots import isolated_roots, structure_of
from linkwork.core.numerics.bilinear import BilinearSystem

__all__ = ["THETA_18", "TRUSS_18", "angles_only", "random_triad", "real_solution", "roots_of"]

Complex = np.ndarray

#: A three-loop truss of which all eighteen configurations are real.
TRUSS_18 = (
    np.array(
        [
            [0, 0, -8.35, 7.36, 0, 9.63],
            [7.34, 0, -8.35, 0, 0.77 - 3.29j, 5.93 + 1.87j],
            [-7.34, 5.5, 0, 0, 5.72, 0],
        ]
    ),
    np.array([0.23 - 8.61j, 6.02 - 5.55j, -5.59 + 4.33j]),
)
THETA_18 = np.array(
    [
        1.0675047795, 1.8523893497, 2.2568427146, 2.3703196212, 2.4020564300, 2.4040860320,
        2.4425660413, 2.4609171110, 2.4779944139, 2.4996262265, 2.5005184651, 3.0033828677,
        3.1290751211, 3.4877992734, 3.6583929729, 3.6962500980, 4.0926185124, 4.2522002201,
    ]
)  # fmt: skip


def angles_only(c: Complex, f: Complex) -> BilinearSystem:
    """C t + f = 0 with all unknowns directions."""
    size = c.shape[1]
    left = np.concatenate([c, f[:, None]], axis=1) / max(np.abs(c).max(), np.abs(f).max())
    k, one = np.arange(size), np.full(size, size)
    return BilinearSystem(
        left=left.astype(complex), right=left.conj(), rows=np.array([k, k, one, one])
    )


def random_triad(seed: int) -> tuple[BilinearSystem, Complex]:
    """A platform on three legs, and one of its configurations t (4,)."""
    rng = np.random.default_rng(seed)
    legs = rng.uniform(0.5, 2.0, 3)
    platform = rng.normal(size=2) + 1j * rng.normal(size=2)
    c = np.array([[legs[0], -legs[1], 0, platform[0]], [legs[0], 0, -legs[2], platform[1]]])
    t = np.exp(1j * rng.uniform(0.0, 2 * np.pi, 4))
    return angles_only(c, -c @ t), t


def real_solution(t: Complex) -> Complex:
    """(U, V) of directions."""
    return np.concatenate([t, t.conj()])


def roots_of(system: BilinearSystem) -> Roots:
    """All isolated solutions of a system with at least two loops."""
    return isolated_roots(system, structure_of(system))
