"""Proof that a real four-bar goes exactly through its positions, near a computed one.

With the moving pivots A_j and B_j in position j, from the point there, as unknowns of their own all
conditions are quadratic,

    |A_j + δ_j - a|² = |x - a|²,   |B_j + δ_j - b|² = |y - b|²,   |A_j| = |x|,   B_j x = A_j y,

in a pose A_j = e_j x and B_j = e_j y. So the second derivatives are constant, and Newton-Kantorovich
(:mod:`linkwork.numerics.proof.kantorovich`) needs no bound of a region. The computed linkage is
refined in whole numbers of 2^-DIGITS, in which residuals have no rounding at all: a nearly singular
solution is proved as long as the inverse of its Jacobian is known to one digit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.design.precision.problem import CONDITIONS
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.numerics.proof.kantorovich import radii

__all__ = ["DIGITS", "Positions", "ProvedLinkages", "prove_linkages"]

#: Binary digits behind the point.
DIGITS = 320
_ROUNDS = 12  # refinements
_SMALL = 1e-40  # a correction that needs no further one
_FLOOR = 1e-3  # smallest weight of an unknown, of the size of the positions


@dataclass(frozen=True, kw_only=True, eq=False)
class Positions:
    """What a linkage has to do, from its first position.

    Parameters
    ----------
    poses : (M, 2) complex
        e and δ of every pose.
    points : (N,) complex
        δ of every point.
    pivots : (0, 1 or 2,) complex
        Given fixed pivots.
    """

    poses: ComplexArray
    points: ComplexArray
    pivots: ComplexArray


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvedLinkages:
    """Proofs of linkages, (B,): whether one ``holds``, and the largest ``error`` of x, a, y, b.

    ``linkage`` (B, 4): x, a, y, b, refined.
    """

    holds: BoolArray
    error: Array
    linkage: ComplexArray
