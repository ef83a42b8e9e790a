"""Certificates of solved rows: each position, and the motion that leads to it from the start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.proven_path import Beads, prove_path
from linkwork.numerics.track import InputPath, Node, Rows, Track

__all__ = ["RowProofs", "prove_rows", "unproved", "way_is_proved"]


_FAR_FROM_SINGULAR = 1e5  # condition up to which a track's nodes must be proved


@dataclass(frozen=True, kw_only=True, eq=False)
class RowProofs:
    """(B,) codes of :class:`Certification`, radii of existence and of uniqueness (weighted).

    ``up_to_ends`` tells whether the track itself is proved up to where it ends.
    """

    code: StatusArray
    radius: Array
    unique: Array
    up_to_ends: bool = True


def unproved(count: int, why: Certification) -> RowProofs:
    """No proofs, all for one reason."""
    return RowProofs(
        code=np.full(count, why.code, dtype=np.int8),
        radius=np.full(count, np.nan),
        unique=np.full(count, np.nan),
    )


def prove_rows(
    solver: BlockSolver,
    path: InputPath,
    track: Track,
    t: Array,
    rows: Rows,
    progress: Callable[[float], None] | None = None,
) -> RowProofs:
    """Prove the rows solved at the values t (B,) of a track.

    The rows and the track's nodes around them are sorted along the path; every position and every
    step between neighbours is proved, and a row is certified if proved steps join it to the
    track's start.
    """
    count = len(t)
    if not all(block.system.bends_boundedly for block in solver.blocks):
        return unproved(count, Certification.NO_BOUND)
    found = np.flatnonzero(rows.status == Status.CONVERGED.code)
    if not len(found):
        return unproved(count, Certification.NO_POSITION)
    begin = track.nodes[track.start].t
    low, high = min(begin, t[found].min()), max(begin, t[found].max())
    nodes = [
        k
        for k, node in enumerate(track.nodes)
        if low <= node.t <= high or node.condition < _FAR_FROM_SINGULAR
    ]
    all_t = np.concatenate([[track.nodes[k].t for k in nodes], t[found]])
    order = np.argsort(all_t, kind="stable")

    def gathered(of_nodes: list[Array], of_rows: Array) -> Array:
        joined: Array = np.concatenate([np.stack(of_nodes), of_rows[found]])[order]
        return joined

    chosen = [track.nodes[k] for k in nodes]
    beads = Beads(
        t=all_t[order],
        v=gathered([node.v for node in chosen], rows.v),
        first=gathered([node.first for node in chosen], rows.rates.first),
        second=gathered([node.second for node in chosen], rows.rates.second),
    )
    proof = prove_path(solver, path, beads, progress)
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    joined = proof.connected_to(int(place[nodes.index(track.start)]))
    mine = place[len(nodes) :]
    proofs = unproved(count, Certification.NO_POSITION)
    position = proof.position.holds[mine]
    proofs.code[found] = np.where(
        joined[mine],
        Certification.CERTIFIED.code,
        np.where(
            position, Certification.MOTION_NOT_PROVED.code, Certification.POSITION_NOT_PROVED.code
        ),
    )
    proofs.radius[found] = np.where(position, proof.position.radius[mine], np.nan)
    proofs.unique[found] = np.where(position, proof.position.alone_within[mine], np.nan)
    return replace(proofs, up_to_ends=bool(joined[place[: len(nodes)]].all()))


def way_is_proved(solver: BlockSolver, path: InputPath, nodes: Sequence[Node]) -> bool:
    """Whether every node of a track and every step between them is proved."""
    if not all(block.system.bends_boundedly for block in solver.blocks):
        return False
    beads = Beads(
        t=np.array([node.t for node in nodes]),
        v=np.stack([node.v for node in nodes]),
        first=np.stack([node.first for node in nodes]),
        second=np.stack([node.second for node in nodes]),
    )
    return bool(prove_path(solver, path, beads).connected_to(0).all())
