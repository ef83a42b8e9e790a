"""How far a motion in a box is at most from its tangent: second order in the size of the box.

A box is a position with all solutions for inputs of an interval around its own, proved to be within
bounds (:func:`~linkwork.numerics.proof.position_proof.reach`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.products import matrix_vector
from linkwork.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.numerics.block_solver import BlockSolver, Linearised
from linkwork.numerics.proof.kantorovich import Expansion

__all__ = ["tangent_errors"]


def tangent_errors(
    solver: BlockSolver,
    linear: Sequence[Linearised],
    places: Sequence[Expansion],
    first: Array,
    span: Array,
    bound: Array,
    rounding: Array,
) -> Array:
    """How far solutions in boxes around B positions are at most from the tangent, (B, N).

    A solution v + e with |e| ≤ ``bound`` is at most this far from v + s x', where s is the change
    of the path's parameter, |s| ≤ ``span``.

    Parameters
    ----------
    linear, places : sequences
        The blocks at the positions, with curvature bounds.
    first : (B, N)
        x', the rates of all variables.
    span : (B,)
    bound : (B, N)
    rounding : (B, p)
        How far inputs are from their straight line.
    """
    found = np.zeros_like(bound)
    found[:, solver.unknowns :] = rounding
    reached = np.abs(first) * span[:, None]
    with np.errstate(all="ignore"):
        for block, part, at in zip(solver.blocks, linear, places, strict=True):
            n, own = len(block.unknowns), block.variables
            here, known = bound[:, own], own[n:]
            lost = np.abs(part.inverse) @ np.abs(part.jacobian[:, :, n:])
            rounded = matrix_vector(lost, reached[:, known]) * (len(own) + 4) * UNIT_ROUNDOFF
            # eq. (190)
            found[:, block.unknowns] = PROOF_SLACK * (
                at.residual
                + matrix_vector(at.defect, here[:, :n])
                + matrix_vector(at.slope, found[:, known])
                + _remainder(at, here)
                + rounded
            )
    return found


def _remainder(at: Expansion, bound: Array) -> Array:
    """What the second derivatives of a block change at most in boxes, (B, n)."""
    turned = bound @ at.weights
    found = matrix_vector(at.phase, 0.5 * turned**2)
    if len(at.pair_length):
        longer, own = bound[:, at.pair_length], turned[:, at.pair_group]
        found += matrix_vector(at.slide, longer * own * (1.0 + 0.5 * own))
    return found
