"""Proofs for a decomposed system: positions block by block, and that steps stay on one branch.

A block is proved for every value that the blocks before it may have, so errors are carried from
block to block. The step from one position to the next is proved by a ball around the first that
contains exactly one solution for *every* input in between, and contains the second.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, BoolArray, IndexArray
from linkwork.core.numerics.block_solver import (
    FEW,
    Block,
    BlockSolver,
    Linearised,
    linearise_block,
)
from linkwork.core.numerics.kantorovich import Enclosed, Expansion, Radii, expansion
from linkwork.core.numerics.newton import UNKNOWN, Columns, Recorded


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

    def radii(self, block: Block, known: Array, *, fitted: bool = False) -> Radii:
        """The proofs for known variables that may be off by ``known`` (B, p), in usual weights."""
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
        rows = range(len(self.rows))[index] if isinstance(index, slice) else index.tolist()
        return RecordedRows(self.record, [self.rows[k] for k in rows])

    def radii(self, block: Block, known: Array, *, fitted: bool = False) -> Radii:
        """The proofs for known variables that may be off by ``known`` (B, p), in usual weights."""
        n, within = len(block.unknowns), self.record.of_floats.within
        found = np.zeros((3 + 2 * n, len(self.rows)))  # nothing is proved
        for k, (row, errors) in enumerate(zip(self.rows, known.tolist(), strict=True)):
            with suppress(ArithmeticError, ValueError):
                if row is not None:
                    found[:, k] = within(*row, *errors)
        return _radii_where(found[0] > 0.0, found[1], found[2], found[3:].reshape(2, n, -1))


def _radii_where(holds: BoolArray, radius: Array, unique: Array, own: Array) -> Radii:
    """Radii where the proof holds; own (2, n, B): errors and distances of others."""
    return Radii(
        holds=holds,
        existence_radius=np.where(holds, radius, np.inf),
        uniqueness_radius=np.where(holds, unique, 0.0),
        error_bound=np.where(holds, own[0], np.inf).T,
        isolation_radius=np.where(holds, own[1], 0.0).T,
    )


#: The data of a block at some positions.
KnownPlace = Expansion | RecordedPlace | RecordedRows | Enclosed
#: The same; ``None`` where no bounds are known.
Place = KnownPlace | None


class Proof(Columns):
    """Proofs of B positions with K blocks.

    ``holds`` (B,): all blocks proved. ``existence_radius``, ``uniqueness_radius`` (B, K): radii per
    block, weighted. ``error_bound`` (B, N): how far every variable may be from its value, in its
    own unit; for the inputs the given radius. ``isolation_radius`` (B, n): how far all other
    solutions are, in one unknown at least.
    """

    holds: BoolArray
    existence_radius: Array
    uniqueness_radius: Array
    error_bound: Array
    isolation_radius: Array = UNKNOWN

    @property
    def radius(self) -> Array:
        """Within this a true position lies, (B,), weighted."""
        return np.asarray(self.existence_radius.max(axis=1, initial=0.0))

    @property
    def least_uniqueness_radius(self) -> Array:
        """Within this there is no other, (B,), weighted."""
        return np.asarray(self.uniqueness_radius.min(axis=1, initial=np.inf))


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
    return _proof(solver, v, input_radius, places, _position)


#: Proves a block at positions v (B, N) for known variables that may be off by (B, N).
_ProofOfBlock = Callable[[Block, KnownPlace, Array, Array], Radii]


def _proof(
    solver: BlockSolver,
    v: Array,
    input_radius: Array,
    places: Sequence[Place],
    radii_of: _ProofOfBlock,
) -> Proof:
    """Block after block, each for all values that those before it may have."""
    count = len(v)
    error_bound = np.zeros((count, solver.variables))
    error_bound[:, solver.unknowns :] = input_radius
    holds = np.ones(count, dtype=bool)
    existence_radius = np.full((count, len(solver.blocks)), np.inf)
    uniqueness_radius = np.zeros((count, len(solver.blocks)))
    isolation_radius = np.zeros((count, solver.unknowns))
    for k, (block, place) in enumerate(zip(solver.blocks, places, strict=True)):
        if place is None:
            holds[:] = False
            continue
        found = radii_of(block, place, v, error_bound)
        holds &= found.holds
        existence_radius[:, k] = found.existence_radius
        uniqueness_radius[:, k] = found.uniqueness_radius
        error_bound[:, block.unknowns] = found.error_bound
        isolation_radius[:, block.unknowns] = found.isolation_radius
    return Proof(
        holds=holds,
        existence_radius=existence_radius,
        uniqueness_radius=uniqueness_radius,
        error_bound=error_bound,
        isolation_radius=isolation_radius,
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


def _position(block: Block, place: KnownPlace, v: Array, error_bound: Array) -> Radii:
    """In the block's own weights; where they do not suffice, in fitted ones."""
    n = len(block.unknowns)
    known, weights = error_bound[:, block.variables[n:]], block.system.variable_scale[:n]
    found = place.radii(block, known)
    # fitting costs several products: the usual weights serve for most positions
    open_ = np.flatnonzero(~found.holds)
    if not len(open_) or isinstance(place, Enclosed):
        return found
    if isinstance(place, Expansion):
        again: KnownPlace | None = place.take(open_)
    else:
        with np.errstate(all="ignore"):
            again = _place(block, linearise_block(block, v[open_]), v[open_])
    assert again is not None
    fitted = again.radii(block, known[open_], fitted=True)
    return found.put(
        open_,
        fitted.with_columns(  # back in the usual weights, in which radii are reported
            existence_radius=(fitted.error_bound / weights).max(axis=1),
            uniqueness_radius=(fitted.isolation_radius / weights).min(axis=1),
        ),
    )


def reach(
    solver: BlockSolver,
    v: Array,
    input_radius: Array,
    places: Sequence[Place] | None = None,
) -> Proof:
    """How far around positions v (B, N) one solution exists for all inputs in ``input_radius``.

    As :func:`prove`, in weights fitted to each step where ``places`` are expansions, as by default.
    """
    places = expansions(solver, v) if places is None else places
    return _proof(solver, v, input_radius, places, _fitted)


def _fitted(block: Block, place: KnownPlace, v: Array, error_bound: Array) -> Radii:
    return place.radii(block, error_bound[:, block.variables[len(block.unknowns) :]], fitted=True)


def steps_connected(v: Array, following: Array, reached: Proof, near: Array) -> BoolArray:
    """Whether each step from v to ``following`` is proved to stay on its branch, (B,).

    Parameters
    ----------
    v, following : (B, N)
    reached : Proof
        Of ``v`` for all inputs up to those of ``following``.
    near : (B, N)
        How far the true positions at both ends may be from ``v`` and ``following``.
    """
    n = reached.isolation_radius.shape[1]
    inside = np.abs(following - v)[:, :n] + near[:, :n] < reached.isolation_radius  # eq. (33)
    held: BoolArray = reached.holds & inside.all(axis=1)
    return held


def steps_disproved(v: Array, following: Array, reached: Proof, near: Array) -> BoolArray:
    """Whether each step from v to ``following`` is proved to lead to another branch, (B,).

    The branch of v stays within the error bound for all inputs up to those of ``following``.
    Parameters are those of :func:`steps_connected`.
    """
    n = reached.isolation_radius.shape[1]
    outside = np.abs(following - v)[:, :n] - near[:, :n] > reached.error_bound[:, :n]
    held: BoolArray = reached.holds & outside.any(axis=1)
    return held
