"""Structural errors of four-bars and slider-cranks, and largest ones that are equal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.design.loops.loop_limits import dot
from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import EPSILON

__all__ = [
    "Errors",
    "levelled",
    "levels_minimise",
    "rocker_errors",
    "slider_errors",
]

#: Structural errors (K,) of parameters (n,), and derivatives (K, n); NaN where a loop is open.
Errors = Callable[[Array], tuple[Array, Array]]

_MOST_STEPS = 100
_SMALLEST_STEP = 1e-13  # relative: Newton steps end in rounding
_REGULAR = 1e-7  # relative: far above the rounding of derivatives
_LEVEL = 1e-9  # by which the largest error may exceed that of the reference points


def rocker_errors(inputs: Array, outputs: Array, side: float | Array) -> Errors:
    """The errors of a rocker's angle, for parameters a, b, c of a four-bar with ground 1.

    ``inputs``, ``outputs``: (K,) [rad]; ``side``: the sign of (B - A) × (B - B0). With lanes
    (D, K), sides (D, 1) and parameters (3, D, 1), errors are (D, K). The last derivative is that
    by the input.
    """

    def errors(lengths: Array) -> tuple[Array, Array]:
        a, b, c = lengths
        crank = np.exp(1j * inputs)
        base = 1.0 - a * crank
        square = np.abs(base) ** 2
        along = 0.5 * (square + c**2 - b**2)
        with np.errstate(invalid="ignore", divide="ignore"):
            across = np.sqrt(square * c**2 - along**2)
            coupler = base * (along + 1j * side * across) / square
            # B - B0 = A + coupler - 1, divided by a signed length
            rocker = (coupler - base) / b
            found = np.angle(rocker)
            wrong = np.mod(found - outputs + np.pi, 2.0 * np.pi) - np.pi
            slope = b * dot(coupler, 1j * rocker)
            gradient = [dot(coupler, crank), -dot(coupler, rocker), c + 0.0 * wrong]
            gradient.append(dot(coupler, 1j * a * crank))
            return wrong, np.stack([part / slope for part in gradient], axis=-1)

    return errors


def slider_errors(inputs: Array, outputs: Array, side: float | Array) -> Errors:
    """The errors of a slider's displacement, for parameters a, e, c: crank, offset and rod.

    ``inputs`` (K,) [rad], ``outputs`` (K,) [length]; ``side``: the sign of (B - A) along the line.
    Lanes and derivatives as of :func:`rocker_errors`.
    """

    def errors(lengths: Array) -> tuple[Array, Array]:
        a, e, c = lengths
        crank = np.exp(1j * inputs)
        height = e - a * crank.imag
        with np.errstate(invalid="ignore", divide="ignore"):
            reach = side * np.sqrt(c**2 - height**2)
            wrong = a * crank.real + reach - outputs
            gradient = [crank.real + height * crank.imag / reach, -height / reach, c / reach]
            gradient.append(a * (height * crank.real / reach - crank.imag))
            return wrong, np.stack(gradient, axis=-1)

    return errors


def levels_minimise(errors: Errors, x: Array, points: list[int]) -> bool:
    """Whether n + 1 equal errors, the largest ones, are a strict local minimum of the largest one.

    They are if every step enlarges one of them: a sum of their derivatives with positive weights
    is zero, and n of the derivatives are independent (Kuhn and Tucker).
    """
    e, jacobian = errors(x)
    if np.abs(e).max() > np.abs(e[points]).min() * (1.0 + _LEVEL) + EPSILON:
        return False
    rows = np.sign(e[points])[:, None] * jacobian[points]
    scale = np.linalg.norm(rows, axis=0)
    if not scale.all():  # errors of zero, too: there is nothing to make smaller
        return False
    rows = rows / scale
    _, values, turned = np.linalg.svd(rows.T)
    weights = turned[-1] * np.sign(turned[-1].sum())
    return bool(values[-1] > _REGULAR * values[0] and weights.min() > _REGULAR)


def levelled(errors: Errors, start: Array, points: list[int]) -> tuple[Array, float] | None:
    """The parameters for which errors at the points are ±E, and E."""
    x = start.copy()
    e, jacobian = errors(x)
    signs = np.sign(e[points])
    for _ in range(_MOST_STEPS):
        matrix = np.column_stack([jacobian[points], -signs])
        try:
            change = np.linalg.solve(matrix, -e[points])
        except np.linalg.LinAlgError:
            return None
        x = x + change[:-1]
        e, jacobian = errors(x)
        if not np.isfinite(e).all():
            return None
        if np.abs(change[:-1]).max() <= _SMALLEST_STEP * np.abs(x).max():
            break
    return x, float(np.abs(e[points]).max())
