"""Proofs for a decomposed system: positions block by block, and that steps stay on one branch.

A block is proved for every value that the blocks before it may have, so errors are carried from
block to block. The step from one position to the next is proved by a ball around the first that
contains exactly one solution for *every* input in between, and contains the second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.numerics.block_solver import Block, BlockSolver, Linearised
from linkwork.numerics.certificate import Radii, bounds, radii

__all__ = ["Proof", "links_hold", "prove", "prove_block", "rounding_of_inputs"]

_UNIT = np.finfo(float).eps / 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Proof:
    """What is proved at B positions with K blocks.

    ``holds`` (B,): all blocks proved. ``exists``, ``unique`` (B, K): radii per block, weighted.
    ``each`` (B, N): how far every variable may be from its value, in its own unit; for the inputs
    what was given.
    """

    holds: BoolArray
    exists: Array
    unique: Array
    each: Array

    @property
    def radius(self) -> Array:
        """Within this a true position lies, (B,), weighted."""
        radius: Array = self.exists.max(axis=1, initial=0.0)
        return radius

    @property
    def alone_within(self) -> Array:
        """Within this there is no other, (B,), weighted."""
        alone: Array = self.unique.min(axis=1, initial=np.inf)
        return alone


def rounding_of_inputs(v: Array, unknowns: int) -> Array:
    """How far an input may be from the value it stands for, (B, p): conversion of units."""
    spread: Array = 2.0 * _UNIT * np.abs(v[:, unknowns:])
    return spread


def prove(
    solver: BlockSolver,
    v: Array,
    spread: Array,
    linear: Sequence[Linearised] | None = None,
) -> Proof:
    """Prove positions for all inputs within ``spread`` of those in v.

    Parameters
    ----------
    v : (B, N)
    spread : (B, p)
        In each input's own unit.

    Notes
    -----
    A block without a curvature bound (function rows) proves nothing: ``holds`` is false.
    """
    parts = solver.linearise(v) if linear is None else linear
    count = len(v)
    each = np.zeros((count, solver.variables))
    each[:, solver.unknowns :] = spread
    holds = np.ones(count, dtype=bool)
    exists = np.full((count, len(solver.blocks)), np.inf)
    unique = np.zeros((count, len(solver.blocks)))
    for k, (block, part) in enumerate(zip(solver.blocks, parts, strict=True)):
        if not block.system.bends_boundedly:
            holds[:] = False
            continue
        found = prove_block(block, part, v, each)
        holds &= found.holds
        exists[:, k], unique[:, k] = found.exists, found.unique
        each[:, block.unknowns] = found.each
    return Proof(holds=holds, exists=exists, unique=unique, each=each)


def prove_block(block: Block, part: Linearised, v: Array, each: Array) -> Radii:
    """Prove one block at v (B, N) for all values of what it takes as known within ``each`` (B, N).

    Parameters
    ----------
    part : Linearised
        The block at v. Its system has to have a curvature bound.
    """
    n = len(block.unknowns)
    known = each[:, block.variables[n:]]
    with np.errstate(all="ignore"):
        return radii(
            bounds(block.system, v[:, block.variables], part.jacobian, part.inverse, known),
            block.system.variable_scale[:n],
        )


def links_hold(
    solver: BlockSolver, v: Array, following: Array, reach: Proof, arrival: Array
) -> BoolArray:
    """Whether each step from v to ``following`` is proved to stay on its branch, (B,).

    Parameters
    ----------
    v, following : (B, N)
    reach : Proof
        Of ``v`` for all inputs up to those of ``following``.
    arrival : (B, K)
        ``exists`` of the proofs of ``following``.
    """
    held = reach.holds.copy()
    for k, block in enumerate(solver.blocks):
        weights = solver.variable_scale[block.unknowns]
        distance = np.abs((following - v)[:, block.unknowns] / weights).max(axis=1, initial=0.0)
        held &= distance + arrival[:, k] < reach.unique[:, k]
    return held
