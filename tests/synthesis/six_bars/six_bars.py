"""A Watt-II six-bar whose rocker follows a logarithm to a few hundredths of a degree."""

from __future__ import annotations

import numpy as np

from linkwork.circuits.homotopy.monodromy import Member
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.synthesis.six_bars import WATT

#: Crank and arm b seen along A0 B0, rocker and arm c seen along C0 B0, at the first position.
ARMS = (0.0361 + 0.0034j, 0.0671 - 0.0088j, -0.1173 - 0.3793j, -0.2613 + 1.0242j)


def chebyshev(count: int = 9) -> Array:
    """Shares of a range, as precision positions have them."""
    k = np.arange(1, count + 1)
    return np.asarray(0.5 - 0.5 * np.cos((2 * k - 1) * np.pi / (2 * count)))


def turned(arms: tuple[complex, ...], inputs: Array) -> Array:
    """The angles of the rocker from the first position, by circles [rad]."""
    a, b, d, c = arms
    crank = a * np.exp(1j * inputs)
    # the bell crank turns about 1, from b to where the coupler's circle is met
    t = _other_end(crank, b, abs(1.0 + b - a)) / b
    v = _other_end(-c * t, -d, abs(1.0 + c - d)) / -d
    return np.asarray(np.unwrap(np.angle(v)))


def _other_end(moving: ComplexArray, arm: complex, coupler: float) -> ComplexArray:
    """The arm about 1 whose end is a coupler away from moving points, on the first one's side."""
    away = 1.0 - moving
    far = np.abs(away)
    along = (coupler**2 - abs(arm) ** 2 - far**2) / (2.0 * far)
    across = np.sqrt(abs(arm) ** 2 - along**2)
    side = np.sign((arm / away[0]).imag)
    found: ComplexArray = (along + 1j * side * across) * away / far
    return found


def member_of(arms: tuple[complex, ...], inputs: Array) -> Member:
    """A member of the family of six-bars with one solution: this one at its own pairs."""
    u, v = np.exp(1j * (inputs - inputs[0])), np.exp(1j * turned(arms, inputs - inputs[0]))
    x = np.array([[z, z.conjugate()] for z in map(complex, arms)]).reshape(1, -1)
    assert WATT.is_real(np.concatenate([u, v]))
    return Member(parameters=np.stack([u[1:], v[1:]], axis=1).ravel(), x=x)
