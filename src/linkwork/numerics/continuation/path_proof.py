"""Proving that a row of positions lies on one branch: many steps at once, halved where needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, CountArray, IndexArray
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.continuation.step_halving import (
    Allowance,
    Halving,
    OpenSteps,
    Prover,
    Strand,
    prove_backwards,
    prove_steps,
    take_expansions,
)
from linkwork.numerics.proof.position_proof import Proof, prove
from linkwork.numerics.rows import SolvedRows

__all__ = ["ProvenPath", "prove_path", "prove_paths"]

_MOST = 30_000  # positions solved in between for the proof of one path
_MOST_EACH = 8  # and this many more for each of its own positions
_PIECE = 1024  # positions proved together: arrays that fit the cache


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvenPath:
    """``position``: the proofs of K positions. ``connected`` (K-1,): which steps are proved.
    ``pieces`` (K-1,): into how many steps each was divided for that. ``given_up`` (K-1,): which
    are not proved because that would have taken too many.
    """

    position: Proof
    connected: BoolArray
    pieces: CountArray
    given_up: BoolArray

    def connected_to(self, anchor: int) -> BoolArray:
        """The positions joined to one of them by proved steps and proved themselves, (K,)."""
        return _connected_outwards(self.connected, anchor) & self.position.holds

    def given_up_before(self, anchor: int) -> BoolArray:
        """The positions whose first step without a proof, on the way from one, was given up."""
        joined = _connected_outwards(self.connected, anchor)
        as_if = _connected_outwards(self.connected | self.given_up, anchor)
        first_broken = as_if & ~joined
        # beyond a step that was given up others may be broken for other reasons
        right = np.logical_or.accumulate(first_broken[anchor:])
        left = np.logical_or.accumulate(first_broken[: anchor + 1][::-1])[::-1]
        return np.concatenate([left[:-1], right])


def _connected_outwards(connected: BoolArray, anchor: int) -> BoolArray:
    """Which of K positions are joined to one of them, (K,)."""
    right = np.logical_and.accumulate(connected[anchor:])
    left = np.logical_and.accumulate(connected[:anchor][::-1])[::-1]
    return np.concatenate([left, [True], right])


def prove_path(
    solver: BlockSolver,
    path: InputPath,
    points: SolvedRows,
    *,
    anchor: int | None = None,
    most: int | None = None,
    exact: bool = False,
    progress: Callable[[float], None] | None = None,
) -> ProvenPath:
    """Prove every position and every step between neighbours.

    Parameters
    ----------
    points : SolvedRows
        In the order of t, with ``first``, ``second`` and ``input_radius``.
    anchor : int, optional
        The point that the others have to be joined to: steps near it are proved first, and those
        beyond one that cannot be proved are left alone. Without it all steps count alike.
    most : int, optional
        How many positions in between may be solved for the proof of the whole path; by default a
        number that grows with the path's own.
    exact : bool
        Take residuals that are rounded once: slower, for places where branches nearly cross.
    progress : callable, optional
        Called with the finished fraction.

    Notes
    -----
    A step that is not proved from its left end is tried from its right end, then halved at a
    position solved in between. Many open steps are worked on together.
    """
    count = len(points.t)
    prover = Prover(solver, path, exact)
    allowance = Allowance(_MOST + _MOST_EACH * count if most is None else most)
    begins = list(range(0, max(count - 1, 1), _PIECE))
    if anchor is not None:
        # near the anchor first: beyond a step that is not proved no other one is of use
        begins.sort(key=lambda begin: abs(begin + _PIECE // 2 - anchor))
    found: dict[int, ProvenPath] = {}
    for k, begin in enumerate(begins, start=1):
        part = points.take(slice(begin, begin + _PIECE + 1))
        inside = None if anchor is None else min(max(anchor - begin, 0), len(part.t) - 1)
        strand = Strand(begin=0, end=len(part.t), anchor=inside)
        found[begin] = _piece(prover, part, [strand], allowance)
        if progress is not None:
            progress(k / len(begins))
    pieces = [found[begin] for begin in sorted(begins)]
    if len(pieces) == 1:
        return pieces[0]
    # neighbouring pieces share one position
    proofs = [pieces[0].position, *[_part(piece.position, slice(1, None)) for piece in pieces[1:]]]
    return ProvenPath(
        position=Proof(
            holds=np.concatenate([p.holds for p in proofs]),
            existence_radius=np.concatenate([p.existence_radius for p in proofs]),
            uniqueness_radius=np.concatenate([p.uniqueness_radius for p in proofs]),
            error_bound=np.concatenate([p.error_bound for p in proofs]),
        ),
        connected=np.concatenate([piece.connected for piece in pieces]),
        pieces=np.concatenate([piece.pieces for piece in pieces]),
        given_up=np.concatenate([piece.given_up for piece in pieces]),
    )


def prove_paths(
    solver: BlockSolver,
    path: InputPath,
    paths: Sequence[SolvedRows],
    *,
    anchors: Sequence[int],
    most: int,
    halvings: int | None = None,
) -> list[ProvenPath]:
    """:func:`prove_path` of several paths together, each with an anchor of its own.

    ``halvings`` of one step, at most; the usual number by default.
    """
    prover, allowance = Prover(solver, path, False), Allowance(most)
    prover = prover if halvings is None else replace(prover, halvings=halvings)
    found: list[ProvenPath] = []
    for some in _groups([len(points.t) for points in paths]):
        strands, begin = [], 0
        for k in some:
            end = begin + len(paths[k].t)
            strands.append(Strand(begin=begin, end=end, anchor=begin + anchors[k]))
            begin = end
        points = SolvedRows.concatenate([paths[k] for k in some])
        whole = _piece(prover, points, strands, allowance)
        for strand in strands:
            steps = slice(strand.begin, strand.end - 1)
            found.append(
                ProvenPath(
                    position=_part(whole.position, slice(strand.begin, strand.end)),
                    connected=whole.connected[steps],
                    pieces=whole.pieces[steps],
                    given_up=whole.given_up[steps],
                )
            )
    return found


def _groups(sizes: Sequence[int]) -> list[list[int]]:
    """Consecutive numbers in groups whose sizes fit the cache."""
    found: list[list[int]] = []
    room = 0
    for k, size in enumerate(sizes):
        if size > room:
            found.append([])
            room = _PIECE
        found[-1].append(k)
        room -= size
    return found


def _part(p: Proof, rows: slice) -> Proof:
    return Proof(
        holds=p.holds[rows],
        existence_radius=p.existence_radius[rows],
        uniqueness_radius=p.uniqueness_radius[rows],
        error_bound=p.error_bound[rows],
    )


def _piece(
    prover: Prover,
    points: SolvedRows,
    strands: Sequence[Strand],
    allowance: Allowance,
) -> ProvenPath:
    """Strands one after the other; what lies between two of them is no step."""
    solver, places = prover.solver, prover.expansions(points.v)
    position = prove(solver, points.v, points.input_radius, places)
    steps = len(points.t) - 1
    nothing = np.zeros(steps, dtype=bool)
    pieces = np.ones(steps, dtype=np.int64)
    if not steps:
        return ProvenPath(position=position, connected=nothing, pieces=pieces, given_up=nothing)
    own = np.ones(steps, dtype=bool)
    own[[strand.begin - 1 for strand in strands[1:]]] = False
    left, right = points.take(slice(None, -1)), points.take(slice(1, None))
    near = np.maximum(position.error_bound[1:], position.error_bound[:-1])
    connected, apart = prove_steps(
        solver, left, right, near, take_expansions(places, slice(None, -1))
    )
    hold = position.holds[1:] & position.holds[:-1] & own
    connected &= hold
    open_ = np.flatnonzero(~connected & hold)
    parts = np.ones(0, dtype=np.int64)
    if len(open_):
        # a step towards a change point is often proved from its far end only
        whole = _open_steps(left, right, near, open_)
        connected[open_], disproved, parts = prove_backwards(solver, whole, places)
        apart[open_] |= disproved
        left_over = ~connected[open_]
        open_, parts = open_[left_over], parts[left_over]
    if not len(open_):
        return ProvenPath(position=position, connected=connected, pieces=pieces, given_up=nothing)
    work = Halving(prover, strands, position.holds)
    work.lose(np.flatnonzero(apart & own))
    queue = work.of_use(_open_steps(left, right, near, open_))
    parts = parts[np.searchsorted(open_, queue.owner)]
    work.run(work.divide(queue, parts, allowance), allowance)
    connected[open_] = work.proved[open_]
    return ProvenPath(
        position=position, connected=connected, pieces=pieces + work.pieces, given_up=work.given_up
    )


def _open_steps(left: SolvedRows, right: SolvedRows, near: Array, steps: IndexArray) -> OpenSteps:
    return OpenSteps(left=left.take(steps), right=right.take(steps), near=near[steps], owner=steps)
