"""Roberts' cognates of a four-bar, in isotropic coordinates: three linkages with one coupler curve.

A linkage is x, x̄, a, ā, y, ȳ, b, b̄: moving pivots A, B and fixed pivots A0, B0 from the traced
point, see :mod:`linkwork.design.precision.problem`. The third fixed pivot makes a triangle with A0
and B0 that is similar to the coupler's (E. A. Dijksman, Motion Geometry of Mechanisms, 1976).
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import ComplexArray

__all__ = ["cognates", "exchange_legs", "third_pivot"]


def third_pivot(linkage: ComplexArray) -> ComplexArray:
    """c and c̄ of linkages (B, 8), (B, 2)."""
    x, a, y, b = (linkage[:, k : k + 2] for k in (0, 2, 4, 6))
    with np.errstate(all="ignore"):
        pivot: ComplexArray = a + x / (x - y) * (b - a)  # eq. (113)
    return pivot


def exchange_legs(linkage: ComplexArray) -> ComplexArray:
    """The same linkages (B, 8) with A and A0 named B and B0."""
    return np.concatenate([linkage[:, 4:], linkage[:, :4]], axis=1)


def cognates(linkage: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Both cognates of linkages (B, 8): with the fixed pivots A0, C0, and with B0, C0."""
    pivot, found = third_pivot(linkage), []
    for leg in (linkage, exchange_legs(linkage)):
        x, a, y = (leg[:, k : k + 2] for k in (0, 2, 4))
        with np.errstate(all="ignore"):
            # parallelogram A0 A P A', and a coupler similar to A B P
            moved, beside = a - x, (a - x) * y / (y - x)
        found.append(np.concatenate([moved, a, beside, pivot], axis=1))
    return found[0], found[1]
