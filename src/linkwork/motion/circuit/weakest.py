"""The position of a circuit at which its Jacobian is closest to being singular."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.equations.parametrized_table import ParametrizedTable
from linkwork.foundation.arrays import Array
from linkwork.motion.curve_branches import CurveBranch
from linkwork.numerics.continuation.branch_tracking import Node
from linkwork.numerics.continuation.local_parametrization import coincide, fastest_leader
from linkwork.numerics.continuation.step_division import sign_change

__all__ = ["weakest_place"]


def weakest_place(leads: ParametrizedTable, branches: Sequence[CurveBranch]) -> tuple[float, Array]:
    """The smallest singular value σ along branches without limits, and the position (N,) there.

    σ = uᵀ J w of the scaled Jacobian by all variables but the parameter. Along a curve it changes
    by dσ/dt = uᵀ (dJ/dt) w; between the samples on both sides of each smallest one the zero of that
    rate is found to rounding.

    Notes
    -----
    A smallest sample is left alone if it lies higher above the smallest value found than its
    neighbours lie above it.
    """
    found: list[tuple[float, Array]] = []
    valleys: list[tuple[float, float, Array]] = []
    for branch in branches:
        v = _close_curve(leads, branch.v)
        values = smallest_singular_values(leads, v)
        if np.isinf(values[0]):  # there are no equations
            return np.inf, v[0]
        k = int(np.argmin(values))
        # the ends of an open branch may be weakest without being a valley
        found.append((float(values[k]), v[k]))
        inner = np.arange(1, len(v) - 1)
        low = inner[(values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])]
        for k in low:
            rise = float(values[[k - 1, k + 1]].max() - values[k])
            valleys.append((float(values[k]), rise, v[k - 1 : k + 2]))
    best = min(found, key=lambda pair: pair[0])
    for value, rise, three in sorted(valleys, key=lambda valley: valley[0]):
        # the true minimum can lie below the sample by about as much as its neighbours lie above it
        if value - rise < best[0]:
            bottom = _bottom(leads, three)
            if bottom is not None and bottom[0] < best[0]:
                best = bottom
    return best


def smallest_singular_values(leads: ParametrizedTable, v: Array) -> Array:
    """Of the scaled Jacobian by all variables but the parameter, at positions (B, N): (B,)."""
    values = np.linalg.svd(leads.jacobian(v), compute_uv=False)
    return np.asarray(values.min(axis=1, initial=np.inf), dtype=float)


def _close_curve(leads: ParametrizedTable, v: Array) -> Array:
    """Positions (K, N) along a curve; of a closed one with the second position again at the end."""
    if len(v) > 2 and coincide(leads, v[0], v[-1]):
        return np.concatenate([v, v[1:2] + (v[-1] - v[0])])
    return v


def _bottom(leads: ParametrizedTable, v: Array) -> tuple[float, Array] | None:
    """The smallest value between three neighbouring positions (3, N), and where it is."""
    direction = np.abs(v[2] - v[0]) / leads.scale
    leader = fastest_leader(leads, v[1], direction)
    if leader is None:
        return None
    led, middle = leader
    low, high = led.node(v[0]), led.node(v[2])
    if not (low.t - middle.t) * (high.t - middle.t) < 0.0:
        return None

    def rate(node: Node) -> float:
        return leads.weakening(led.whole(node.v), led.whole(node.first))

    if not rate(low) * rate(high) < 0.0:
        return None
    here = led.whole(sign_change(led, low, high, rate, to_rounding=True).v)
    return float(smallest_singular_values(leads, here[None, :])[0]), here
