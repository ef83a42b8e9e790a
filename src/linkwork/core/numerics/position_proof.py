"""Proofs for a decomposed system: positions block by block, and that steps stay on one branch.

A block is proved for every value that the blocks before it may have, so errors are carried from
block to block. The step from one position to the next is proved by a ball around the first that
contains exactly one solution for *every* input in between, and contains the second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.numerics.block_solver import (
    FEW,
    Block,
    BlockSolver,
    Linearised,
    linearise_block,
)
from linkwork.core.numerics.enclosed import Enclosed
from linkwork.core.numerics.kantorovich import Expansion, Majorant, Radii, expansion, weighted_radii
from linkwork.core.numerics.system import Recorded


@dataclass(frozen=True, eq=False)
class RecordedPlace:
    """A block at B positions by its record: what proofs need, (B,) each or the same for all."""

    record: Recorded
    data: Sequence[Any]
    count: int

    def take(self, index: IndexArray | slice) -> RecordedPlace:
        """At some of the positions, in the order of ``index``."""
        data = [x[index] if np.ndim(x) else x for x in self.data]
        count = len(range(self.count)[index]) if isinstance(index, slice) else len(index)
        return RecordedPlace(self.record, data, count)

    def radii(self, block: Block, known: Array) -> Radii:
        """The proofs for known variables that may be off by ``known`` (B, p)."""
        n, errors = len(block.unknowns), np.ascontiguousarray(known.T)
        with np.errstate(all="ignore"):
            holds, radius, unique, *found = self.record.of_arrays.within(*self.data, *errors)
        shape = self.count
        own = np.empty((2, n, shape))
        for k, x in enumerate(found):
            own[k // n, k % n] = x
        return _radii_where(np.broadcast_to(holds, shape), radius, unique, own)


@dataclass(frozen=True, eq=False)
class RecordedRows:
    """A block at a few positions by its record, on floats; ``None`` where there are no numbers."""

    record: Recorded
    rows: Sequence[Sequence[float] | None]

    def take(self, index: IndexArray | slice) -> RecordedRows:
        """At some of the positions, in the order of ``index``."""
        if isinstance(index, slice):
            return RecordedRows(self.record, self.rows[index])
        return RecordedRows(self.record, [self.rows[k] for k in index.tolist()])

    def radii(self, block: Block, known: Array) -> Radii:
        """The proofs for known variables that may be off by ``known`` (B, p)."""
        n, within = len(block.unknowns), self.record.of_floats.within
        found = np.empty((3 + 2 * n, len(self.rows)))
        for k, (row, errors) in enumerate(zip(self.rows, known.tolist(), strict=True)):
            try:
                found[:, k] = _NOT_PROVED if row is None else within(*row, *errors)
            except (ArithmeticError, ValueError):
                found[:, k] = _NOT_PROVED
        return _radii_where(found[0] > 0.0, found[1], found[2], found[3:].reshape(2, n, -1))


_NOT_PROVED = 0.0


def _radii_where(holds: BoolArray, radius: Array, unique: Array, own: Array) -> Radii:
    """Radii where the proof holds; own (2, n, B): errors and distances of others."""
    if holds.all():
        radius, unique = (np.broadcast_to(x, holds.shape).copy() for x in (radius, unique))
        return Radii(holds.copy(), radius, unique, own[0].T, own[1].T)
    return Radii(
        holds.copy(),
        np.where(holds, radius, np.inf),
        np.where(holds, unique, 0.0),
        np.where(holds, own[0], np.inf).T,
        np.where(holds, own[1], 0.0).T,
    )


#: The data of a block at some positions; ``None`` where no bounds are known.
Place = Expansion | RecordedPlace | RecordedRows | Enclosed | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Proof:
    """Proofs of B positions with K blocks.

    ``holds`` (B,): all blocks proved. ``existence_radius``, ``uniqueness_radius`` (B, K): radii per
    block, weighted. ``error_bound`` (B, N): how far every variable may be from its value, in its
    own unit; for the inputs the given radius.
    """

    holds: BoolArray
    existence_radius: Array
    uniqueness_radius: Array
    error_bound: Array

    @property
    def radius(self) -> Array:
        """Within this a true position lies, (B,), weighted."""
        radius: Array = self.existence_radius.max(axis=1, initial=0.0)
        return radius

    @property
    def least_uniqueness_radius(self) -> Array:
        """Within this there is no other, (B,), weighted."""
        isolation_radius: Array = self.uniqueness_radius.min(axis=1, initial=np.inf)
        return isolation_radius


def rounding_of_inputs(v: Array, unknowns: int) -> Array:
    """How far an input may be from its exact value, (B, p): conversion of units."""
    # a degree in a file is a rounded number of radians: one rounding of π, one of the product
    input_radius: Array = 2.0 * UNIT_ROUNDOFF * np.abs(v[:, unknowns:])
    return input_radius


def expansions(
    solver: BlockSolver,
    v: Array,
    linear: Sequence[Linearised] | None = None,
    *,
    exact: bool = False,
) -> list[Place]:
    """The data that proofs need of positions v (B, N), block by block, with fitted weights.

    ``exact``: see :func:`~linkwork.core.numerics.kantorovich.expansion`. ``None`` for a block
    without known bounds.
    """
    parts = solver.linearise(v) if linear is None else linear
    found: list[Place] = []
    with np.errstate(all="ignore"):
        for block, part in zip(solver.blocks, parts, strict=True):
            found.append(_place(block, part, v, exact=exact))
    return found


def recorded_places(solver: BlockSolver, v: Array) -> list[Place]:
    """The data that proofs need of positions v (B, N), block by block.

    Of blocks that are recorded in the usual weights, which suffice nearly always.
    """
    return [_recorded_place(block, v) for block in solver.blocks]


def _recorded_place(block: Block, v: Array) -> Place:
    record = block.record
    if record is None:
        return _place(block, linearise_block(block, v), v)
    if len(v) > FEW:
        here = np.ascontiguousarray(v[:, block.variables].T)
        with np.errstate(all="ignore"):
            data = record.of_arrays.place(*here)
        return RecordedPlace(record, data, len(v))
    place = record.of_floats.place
    rows: list[Sequence[float] | None] = []
    for row in v[:, block.variables].tolist():
        try:
            rows.append(place(*row))
        except (ArithmeticError, ValueError):  # a singular Jacobian, or no number
            rows.append(None)
    return RecordedRows(record, rows)


def _place(
    block: Block, part: Linearised, v: Array, *, exact: bool = False
) -> Expansion | Enclosed | None:
    system, here = block.system, v[:, block.variables]
    if system.has_curvature_bound:
        return expansion(system, here, part.jacobian, part.inverse, exact=exact)
    if system.is_enclosed:
        return Enclosed(system=system, v=here, matrix=part.inverse)
    return None


def prove(
    solver: BlockSolver,
    v: Array,
    input_radius: Array,
    places: Sequence[Place] | None = None,
) -> Proof:
    """Prove positions for all inputs within ``input_radius`` of those in v.

    Parameters
    ----------
    v : (B, N)
    input_radius : (B, p)
        In each input's own unit.
    places : list of Expansion, optional
        ``expansions(solver, v)``, if they are there already.

    Notes
    -----
    A block without known bounds proves nothing: ``holds`` is false.
    """
    places = recorded_places(solver, v) if places is None else places
    count = len(v)
    error_bound = np.zeros((count, solver.variables))
    error_bound[:, solver.unknowns :] = input_radius
    holds = np.ones(count, dtype=bool)
    existence_radius = np.full((count, len(solver.blocks)), np.inf)
    uniqueness_radius = np.zeros((count, len(solver.blocks)))
    for k, (block, place) in enumerate(zip(solver.blocks, places, strict=True)):
        if place is None:
            holds[:] = False
            continue
        found = _position(block, place, v, error_bound)
        holds &= found.holds
        existence_radius[:, k], uniqueness_radius[:, k] = (
            found.existence_radius,
            found.uniqueness_radius,
        )
        error_bound[:, block.unknowns] = found.error_bound
    return Proof(
        holds=holds,
        existence_radius=existence_radius,
        uniqueness_radius=uniqueness_radius,
        error_bound=error_bound,
    )


def roots_proved(solver: BlockSolver, v: Array) -> BoolArray:
    """Whether a small residual is evidence of a solution next to positions v (B, N), (B,).

    Where the equations are loops a dead point is one, too; a formula may be small without a root,
    so that its root has to be proved.
    """
    if not solver.has_formulas:
        return np.ones(len(v), dtype=bool)
    return prove(solver, v, rounding_of_inputs(v, solver.unknowns)).holds


def prove_block(block: Block, part: Linearised, v: Array, error_bound: Array) -> Radii:
    """Prove one block at v (B, N) for all values of its known variables.

    Parameters
    ----------
    error_bound : (B, N)
        How far these values may be from those in v.
    part : Linearised
        The block at v. Its system has to have known bounds.
    """
    with np.errstate(all="ignore"):
        place = _place(block, part, v)
    assert place is not None
    return _position(block, place, v, error_bound)


def _position(
    block: Block,
    place: Expansion | RecordedPlace | RecordedRows | Enclosed,
    v: Array,
    error_bound: Array,
) -> Radii:
    """In the block's own weights; where they do not suffice, in fitted ones."""
    found = _radii(block, place, error_bound)
    # fitting costs several products: the usual weights serve for most positions
    open_ = np.flatnonzero(~found.holds)
    if not len(open_) or isinstance(place, Enclosed):
        return found
    if isinstance(place, Expansion):
        place = place.take(open_)
    else:
        with np.errstate(all="ignore"):
            again = _place(block, linearise_block(block, v[open_]), v[open_])
        assert isinstance(again, Expansion)
        place = again
    fitted = _radii(block, place, error_bound[open_], fitted=True)
    weights = block.system.variable_scale[: len(block.unknowns)]
    found.holds[open_], found.error_bound[open_] = fitted.holds, fitted.error_bound
    found.isolation_radius[open_] = fitted.isolation_radius
    # back in the usual weights, in which radii are reported
    found.existence_radius[open_] = (fitted.error_bound / weights).max(axis=1)
    found.uniqueness_radius[open_] = (fitted.isolation_radius / weights).min(axis=1)
    return found


def _radii(
    block: Block,
    place: Expansion | RecordedPlace | RecordedRows | Enclosed,
    error_bound: Array,
    fitted: bool = False,
) -> Radii:
    """In the block's own weights or, of an expansion, in fitted ones."""
    n = len(block.unknowns)
    known = error_bound[:, block.variables[n:]]
    if isinstance(place, Enclosed):  # its boxes are of all sizes
        return place.radii(known)
    if isinstance(place, RecordedPlace | RecordedRows):
        return place.radii(block, known)
    weights = block.system.variable_scale[:n]
    with np.errstate(all="ignore"):
        majorant = Majorant(place, known)
        if fitted:
            weights = majorant.fit_weights(weights)
        return weighted_radii(majorant.bounds(weights), weights)


@dataclass(frozen=True, kw_only=True, eq=False)
class Reach:
    """Boxes around B positions with one solution for all inputs of a step.

    ``holds`` (B,): proved for all blocks. ``error_bound`` (B, n): how far the solution may be from
    the position, unknown by unknown. ``isolation_radius`` (B, n): how far all others are, in one
    unknown at least.
    """

    holds: BoolArray
    error_bound: Array
    isolation_radius: Array

    def take(self, rows: slice) -> Reach:
        """Around some of the positions."""
        return Reach(
            holds=self.holds[rows],
            error_bound=self.error_bound[rows],
            isolation_radius=self.isolation_radius[rows],
        )


def reach(
    solver: BlockSolver,
    v: Array,
    input_radius: Array,
    places: Sequence[Place] | None = None,
) -> Reach:
    """How far around positions v (B, N) one solution exists for all inputs in ``input_radius``.

    As :func:`prove`, in weights fitted to each step where ``places`` are expansions, as by default.
    """
    places = expansions(solver, v) if places is None else places
    count = len(v)
    error_bound = np.zeros((count, solver.variables))
    error_bound[:, solver.unknowns :] = input_radius
    holds = np.ones(count, dtype=bool)
    isolation_radius = np.zeros((count, solver.unknowns))
    for block, place in zip(solver.blocks, places, strict=True):
        if place is None:
            holds[:] = False
            continue
        found = _radii(block, place, error_bound, fitted=True)
        holds &= found.holds
        error_bound[:, block.unknowns], isolation_radius[:, block.unknowns] = (
            found.error_bound,
            found.isolation_radius,
        )
    return Reach(
        holds=holds,
        error_bound=error_bound[:, : solver.unknowns],
        isolation_radius=isolation_radius,
    )


def steps_connected(v: Array, following: Array, reached: Reach, near: Array) -> BoolArray:
    """Whether each step from v to ``following`` is proved to stay on its branch, (B,).

    Parameters
    ----------
    v, following : (B, N)
    reached : Reach
        Of ``v`` for all inputs up to those of ``following``.
    near : (B, N)
        How far the true positions at both ends may be from ``v`` and ``following``.
    """
    n = reached.isolation_radius.shape[1]
    inside = np.abs(following - v)[:, :n] + near[:, :n] < reached.isolation_radius  # eq. (33)
    held: BoolArray = reached.holds & inside.all(axis=1)
    return held


def steps_disproved(v: Array, following: Array, reached: Reach, near: Array) -> BoolArray:
    """Whether each step from v to ``following`` is proved to lead to another branch, (B,).

    The branch of v stays within the error bound for all inputs up to those of ``following``.
    Parameters are those of :func:`steps_connected`.
    """
    n = reached.isolation_radius.shape[1]
    outside = np.abs(following - v)[:, :n] - near[:, :n] > reached.error_bound
    held: BoolArray = reached.holds & outside.any(axis=1)
    return held
