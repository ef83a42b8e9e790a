"""Contacts along curves: how a point slides on another body, and the normal of its path."""

from __future__ import annotations

import numpy as np

from linkwork.forces.geometry import Geometry
from linkwork.foundation.arrays import AnyArray, ComplexArray, IndexArray
from linkwork.foundation.lanes import is_batched

__all__ = ["moving_most", "normal_away", "of_input", "sliding"]


def sliding(geometry: Geometry, point: str, body: str, center: str) -> ComplexArray:
    """The velocity of a point relative to a body with a centre, per unit of each input, (p, B)."""
    arm = geometry.place(point).v - geometry.place(center).v
    found: ComplexArray = (
        geometry.partial(point) - geometry.partial(center) - 1j * geometry.turning(body) * arm
    )
    return found


def of_input(rates: AnyArray, which: IndexArray | None) -> AnyArray:
    """Rates by the input that :func:`moving_most` has chosen in every row, (B,)."""
    return rates if which is None else np.take_along_axis(rates, which, axis=0)[0]


def moving_most(rates: AnyArray) -> IndexArray | None:
    """Which input moves something most in every row, (1, B).

    ``None`` for rates (B,) of one input, as of numbers on a tape.
    """
    if is_batched(rates) or rates.ndim == 1:
        return None
    found: IndexArray = np.argmax(np.nan_to_num(np.abs(rates)), axis=0)[None, :]
    return found


def normal_away(along: ComplexArray, away: ComplexArray) -> ComplexArray:
    """The unit normal of a direction on the side of another one, (B,)."""
    with np.errstate(all="ignore"):
        normal = 1j * along / np.abs(along)
    found: ComplexArray = normal * np.where((normal.conj() * away).real < 0.0, -1.0, 1.0)
    return found
