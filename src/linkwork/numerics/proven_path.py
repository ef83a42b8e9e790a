"""Proving that a row of positions lies on one branch: many steps at once, halved where needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, CountArray, IndexArray
from linkwork.foundation.status import Status
from linkwork.numerics.block_solver import BlockSolver, Linearised, Rates
from linkwork.numerics.proof import Proof, links_hold, prove, rounding_of_inputs
from linkwork.numerics.track import InputPath

__all__ = ["Beads", "ProvenPath", "prove_path"]

_CONVERGED = Status.CONVERGED.code
_ROUNDS = 45  # halvings of one step before it counts as not proved
_MOST = 200_000  # steps looked at in one round
_UNIT = np.finfo(float).eps / 2
_PIECE = 1024  # positions proved together: arrays that fit the cache


@dataclass(frozen=True, kw_only=True, eq=False)
class Beads:
    """Positions along a path with their derivatives by t: t (K,), the others (K, N).

    ``spread`` (K, p): how far the inputs may be from those in v, in their own units.
    """

    t: Array
    v: Array
    first: Array
    second: Array
    spread: Array

    def take(self, index: IndexArray | slice) -> Beads:
        """Some of them, in the order of ``index``."""
        return Beads(
            t=self.t[index],
            v=self.v[index],
            first=self.first[index],
            second=self.second[index],
            spread=self.spread[index],
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvenPath:
    """``position``: the proofs of K positions. ``linked`` (K-1,): which steps are proved.
    ``pieces`` (K-1,): into how many steps each was divided for that.
    """

    position: Proof
    linked: BoolArray
    pieces: CountArray

    def connected_to(self, anchor: int) -> BoolArray:
        """The positions joined to one of them by proved steps and proved themselves, (K,)."""
        right = np.cumprod(self.linked[anchor:]).astype(bool)
        left = np.cumprod(self.linked[:anchor][::-1]).astype(bool)[::-1]
        joined = np.concatenate([left, [True], right])
        return joined & self.position.holds


def prove_path(
    solver: BlockSolver,
    path: InputPath,
    beads: Beads,
    progress: Callable[[float], None] | None = None,
) -> ProvenPath:
    """Prove every position and every step between neighbours.

    Parameters
    ----------
    beads : Beads
        In the order of t.
    progress : callable, optional
        Called with the finished fraction.

    Notes
    -----
    A step that is not proved from its left end is tried from its right end, then halved at a
    position solved in between. All open steps of one round are worked on together.
    """
    count = len(beads.t)
    pieces = []
    for begin in range(0, max(count - 1, 1), _PIECE):
        pieces.append(_piece(solver, path, beads.take(slice(begin, begin + _PIECE + 1))))
        if progress is not None:
            progress(min(1.0, (begin + _PIECE) / count))
    if len(pieces) == 1:
        return pieces[0]
    # neighbouring pieces share one position
    proofs = [pieces[0].position, *[_behind_first(piece.position) for piece in pieces[1:]]]
    return ProvenPath(
        position=Proof(
            holds=np.concatenate([p.holds for p in proofs]),
            exists=np.concatenate([p.exists for p in proofs]),
            unique=np.concatenate([p.unique for p in proofs]),
            each=np.concatenate([p.each for p in proofs]),
        ),
        linked=np.concatenate([piece.linked for piece in pieces]),
        pieces=np.concatenate([piece.pieces for piece in pieces]),
    )


def _behind_first(p: Proof) -> Proof:
    return Proof(holds=p.holds[1:], exists=p.exists[1:], unique=p.unique[1:], each=p.each[1:])


def _piece(solver: BlockSolver, path: InputPath, beads: Beads) -> ProvenPath:
    parts = solver.linearise(beads.v)
    position = prove(solver, beads.v, beads.spread, parts)
    count = len(beads.t)
    if count < 2:
        nothing = np.zeros(0, dtype=np.int64)
        return ProvenPath(position=position, linked=nothing.astype(bool), pieces=nothing)
    left, right = beads.take(slice(None, -1)), beads.take(slice(1, None))
    linked = _steps(solver, left, right, position.exists[1:], _cut(parts, slice(None, -1)))
    linked &= position.holds[1:] & position.holds[:-1]
    open_ = np.flatnonzero(~linked & position.holds[1:] & position.holds[:-1])
    if len(open_):
        back = _cut(parts, open_ + 1)
        arrival = position.exists[open_]
        linked[open_] = _steps(solver, right.take(open_), left.take(open_), arrival, back)
        open_ = open_[~linked[open_]]
    pieces = np.ones(count - 1, dtype=np.int64)
    if len(open_):
        linked[open_], pieces[open_] = _halved(
            solver, path, left.take(open_), right.take(open_), position.exists[open_ + 1]
        )
    return ProvenPath(position=position, linked=linked, pieces=pieces)


def _cut(parts: Sequence[Linearised], index: IndexArray | slice) -> list[Linearised]:
    return [
        Linearised(jacobian=p.jacobian[index], inverse=p.inverse[index], sign=p.sign[index])
        for p in parts
    ]


def _steps(
    solver: BlockSolver,
    start: Beads,
    goal: Beads,
    arrival: Array,
    linear: Sequence[Linearised] | None = None,
) -> BoolArray:
    """Which steps are proved from their start, for all inputs from those of one end to the other's.

    The inputs are taken from the positions: those of a row may differ from the path's by rounding.
    """
    spread = np.abs(goal.v - start.v)[:, solver.unknowns :] * (1.0 + 8.0 * _UNIT)
    spread += start.spread + goal.spread
    reach = prove(solver, start.v, spread, linear)
    return links_hold(solver, start.v, goal.v, reach, arrival)


def _halved(
    solver: BlockSolver, path: InputPath, left: Beads, right: Beads, arrival: Array
) -> tuple[BoolArray, CountArray]:
    """Which steps are proved after halving them as often as needed, and in how many pieces."""
    owner = np.arange(len(left.t))
    proved = np.ones(len(left.t), dtype=bool)
    pieces = np.ones(len(left.t), dtype=np.int64)
    for _ in range(_ROUNDS):
        np.add.at(pieces, owner, 1)
        middle, found = _between(solver, path, left, right)
        proof = prove(solver, middle.v, middle.spread)
        good = found & proof.holds
        proved[owner[~good]] = False
        keep = np.flatnonzero(good & proved[owner])
        left, right, middle = left.take(keep), right.take(keep), middle.take(keep)
        halfway, arrival, owner = proof.exists[keep], arrival[keep], owner[keep]
        if not len(keep):
            return proved, pieces
        first = _steps(solver, left, middle, halfway)
        second = _steps(solver, middle, right, arrival)
        left = _joined(left.take(np.flatnonzero(~first)), middle.take(np.flatnonzero(~second)))
        right = _joined(middle.take(np.flatnonzero(~first)), right.take(np.flatnonzero(~second)))
        arrival = np.concatenate([halfway[~first], arrival[~second]])
        owner = np.concatenate([owner[~first], owner[~second]])
        if not len(owner):
            return proved, pieces
        if len(owner) > _MOST:
            break
    proved[owner] = False
    return proved, pieces


def _joined(a: Beads, b: Beads) -> Beads:
    return Beads(
        t=np.concatenate([a.t, b.t]),
        v=np.concatenate([a.v, b.v]),
        first=np.concatenate([a.first, b.first]),
        second=np.concatenate([a.second, b.second]),
        spread=np.concatenate([a.spread, b.spread]),
    )


def _between(
    solver: BlockSolver, path: InputPath, left: Beads, right: Beads
) -> tuple[Beads, BoolArray]:
    """Positions halfway in t, started from the quintic through both ends."""
    h = (right.t - left.t)[:, None]
    guess = 0.5 * (left.v + right.v) + 5.0 / 32.0 * h * (left.first - right.first)
    guess += h * h / 64.0 * (left.second + right.second)
    t = 0.5 * (left.t + right.t)
    guess[:, solver.unknowns :] = path.at(t)
    done = solver.solve(guess)
    rates: Rates = solver.rates(done.v, path.rate)
    spread = rounding_of_inputs(done.v, solver.unknowns)
    beads = Beads(t=t, v=done.v, first=rates.first, second=rates.second, spread=spread)
    return beads, done.status == _CONVERGED
