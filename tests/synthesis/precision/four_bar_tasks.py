"""Tasks for four-bars, and what is known of their solutions."""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.synthesis.precision.positions import PrecisionPositions
from linkwork.synthesis.precision.solving import PrecisionFourBars

#: Problem 3 of Wampler, Morgan, Sommese 1992; numbers as in the README of TOMS algorithm 921.
PROBLEM_3 = np.array([
    0.25, 0.52 + 0.10j, 0.80 + 0.70j, 1.20 + 1.00j, 1.40 + 1.30j, 1.10 + 1.48j, 0.70 + 1.40j,
    0.20 + 1.00j, 0.02 + 0.40j,
])  # fmt: skip
#: Nine points of the README of FourBarLinkages.jl.
NINE_POINTS = np.array([
    0.8961867 - 0.09802917j, 1.2156535 - 1.18749100j, 1.5151435 - 0.85449808j,
    1.6754775 - 0.48768058j, 1.7138690 - 0.30099232j, 1.7215236 + 0.03269953j,
    1.6642029 + 0.33241088j, 1.4984171 + 0.74435576j, 1.3011834 + 0.92153806j,
])  # fmt: skip
#: Five points on a line, pivots at 0 and 1 (Morgan, Wampler 1990; problem 7 of phcpy's tutorial).
LINE = np.array([0.50 + 1.06j, -0.83 - 0.27j, -0.34 + 0.22j, -0.13 + 0.43j, 0.22 + 0.78j])

GROUND, CRANK, COUPLER, ROCKER = 4.0, 1.5, 3.5, 3.0
POINT = 1.0 + 0.7j  # of the coupler, from A


def positions(
    points: ComplexArray, angles: Array | None = None, *pivots: complex
) -> PrecisionPositions:
    free = np.full(len(points), np.nan)
    return PrecisionPositions.of(
        points, free if angles is None else angles, np.array(pivots, dtype=complex)
    )


def four_bar_points(crank: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """A, B and P of a real four-bar with A0 = 0, on its open branch, at crank angles [rad]."""
    a = CRANK * np.exp(1j * crank)
    away = GROUND - a
    far = np.abs(away)
    along = (far**2 + COUPLER**2 - ROCKER**2) / (2.0 * far * COUPLER)
    b = a + COUPLER * np.exp(1j * (np.angle(away) + np.arccos(along)))
    return a, b, a + POINT * (b - a) / COUPLER


def passes(found: PrecisionFourBars, positions: ComplexArray) -> float:
    """The largest change of a bar's length, or distance from a position, of all four-bars."""
    worst = float(np.abs(found.guided - positions).max(initial=0.0))
    pairs = (
        (found.moving_a, found.fixed_a[:, None]),
        (found.moving_b, found.fixed_b[:, None]),
        (found.moving_a, found.moving_b),
        (found.moving_a, found.guided),
        (found.moving_b, found.guided),
    )
    for one, other in pairs:
        lengths = np.abs(one - other)
        worst = max(worst, float(np.abs(lengths - lengths[:, :1]).max(initial=0.0)))
    # the coupler is not turned over
    sense = ((found.moving_b - found.moving_a) * (found.guided - found.moving_a).conj()).imag
    return max(worst, float(np.abs(sense - sense[:, :1]).max(initial=0.0)))


def viable(found: PrecisionFourBars) -> list[tuple[int, str]]:
    """Four-bars and drives that pass the positions in order on one branch."""
    sound = []
    for k in range(len(found)):
        for drive in ("A0", "B0"):
            a0, b0, a, b = found.fixed_a[k], found.fixed_b[k], found.moving_a[k], found.moving_b[k]
            if drive == "B0":
                a0, b0, a, b = b0, a0, b, a
            side = ((b - a).conj() * (b - b0)).imag
            turned = np.mod(np.angle((a - a0) / (a[0] - a0)), 2.0 * np.pi)
            ordered = (np.diff(turned) > 0.0).all() or (np.diff(turned[1:]) < 0.0).all()
            if ((side > 0.0).all() or (side < 0.0).all()) and ordered:
                sound.append((k, drive))
    return sound
