"""Certificates of solved rows: the position, and the motion from the start to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.foundation.status import Status
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath, Node, Track, TrackRows
from linkwork.numerics.continuation.path_proof import PathPoints, prove_path
from linkwork.numerics.proof.position_proof import rounding_of_inputs

__all__ = ["RowProofs", "inputs_apart", "prove_rows", "unproved", "way_is_proved"]

_FAR_FROM_SINGULAR = 1e5  # condition up to which a track's nodes must be proved
_TURN = 1e-9  # rad: an input this near to whole turns from the input asked for is the same one


@dataclass(frozen=True, kw_only=True, eq=False)
class RowProofs:
    """(B,) codes of :class:`Certification`, radii of existence and of uniqueness (weighted).

    ``up_to_ends``: whether the track itself is proved up to its ends.
    """

    code: StatusArray
    radius: Array
    uniqueness_radius: Array
    up_to_ends: bool = True


def unproved(count: int, why: Certification) -> RowProofs:
    """No proofs, all for one reason."""
    return RowProofs(
        code=np.full(count, why.code, dtype=np.int8),
        radius=np.full(count, np.nan),
        uniqueness_radius=np.full(count, np.nan),
    )


def prove_rows(
    solver: BlockSolver,
    path: InputPath,
    track: Track,
    rows: TrackRows,
    asked: Array,
    progress: Callable[[float], None] | None = None,
) -> RowProofs:
    """Prove rows solved along a track for the inputs ``asked`` (B, p).

    The rows and the track's nodes around them are sorted along the path; every position and every
    step between neighbours is proved, and a row is certified if proved steps join it to the
    track's start.
    """
    count = len(rows.t)
    if not all(block.system.has_curvature_bound for block in solver.blocks):
        return unproved(count, Certification.NO_BOUND)
    found = np.flatnonzero(rows.status == Status.CONVERGED.code)
    if not len(found):
        return unproved(count, Certification.NO_POSITION)
    nodes = _nodes_around(track, rows.t[found])
    points, place = _path_points(solver, [track.nodes[k] for k in nodes], rows, asked, found)
    anchor = int(place[nodes.index(track.start)])
    proof = prove_path(solver, path, points, anchor=anchor, progress=progress)
    joined = proof.connected_to(anchor)
    mine = place[len(nodes) :]
    proofs = unproved(count, Certification.NO_POSITION)
    position = proof.position.holds[mine]
    proofs.code[found] = np.select(
        [joined[mine], ~position, proof.given_up_before(anchor)[mine]],
        [
            Certification.CERTIFIED.code,
            Certification.POSITION_NOT_PROVED.code,
            Certification.PROOF_TOO_LONG.code,
        ],
        default=Certification.MOTION_NOT_PROVED.code,
    )
    proofs.radius[found] = np.where(position, proof.position.radius[mine], np.nan)
    proofs.uniqueness_radius[found] = np.where(
        position, proof.position.least_uniqueness_radius[mine], np.nan
    )
    return replace(proofs, up_to_ends=bool(joined[place[: len(nodes)]].all()))


def _nodes_around(track: Track, t: Array) -> list[int]:
    """The numbers of the nodes between the start and all rows, and of those that can be proved."""
    begin = track.nodes[track.start].t
    low, high = min(begin, float(t.min())), max(begin, float(t.max()))
    return [
        k
        for k, node in enumerate(track.nodes)
        # nodes beyond the rows are proved too where that is easy, so that ends can be certified
        if low <= node.t <= high or node.nearness < _FAR_FROM_SINGULAR
    ]


def _path_points(
    solver: BlockSolver, nodes: Sequence[Node], rows: TrackRows, asked: Array, found: IndexArray
) -> tuple[PathPoints, IndexArray]:
    """Nodes and rows sorted along the path; the place of each of them, the nodes first."""
    t = np.concatenate([[node.t for node in nodes], rows.t[found]])
    order = np.argsort(t, kind="stable")

    def gathered(of_nodes: list[Array], of_rows: Array) -> Array:
        joined: Array = np.concatenate([np.stack(of_nodes), of_rows])[order]
        return joined

    input_radius = [rounding_of_inputs(node.v[None, :], solver.unknowns)[0] for node in nodes]
    points = PathPoints(
        t=t[order],
        v=gathered([node.v for node in nodes], rows.v[found]),
        first=gathered([node.first for node in nodes], rows.rates.first[found]),
        second=gathered([node.second for node in nodes], rows.rates.second[found]),
        input_radius=gathered(
            input_radius, inputs_apart(rows.v[found][:, solver.unknowns :], asked[found])
        ),
    )
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    return points, place


def way_is_proved(solver: BlockSolver, path: InputPath, nodes: Sequence[Node]) -> bool:
    """Whether every position and every step of a track is proved."""
    if not all(block.system.has_curvature_bound for block in solver.blocks):
        return False
    v = np.stack([node.v for node in nodes])
    points = PathPoints(
        t=np.array([node.t for node in nodes]),
        v=v,
        first=np.stack([node.first for node in nodes]),
        second=np.stack([node.second for node in nodes]),
        input_radius=rounding_of_inputs(v, solver.unknowns),
    )
    return bool(prove_path(solver, path, points, anchor=0).connected_to(0).all())


def inputs_apart(inputs: Array, asked: Array) -> Array:
    """How far the inputs meant may be from some, whole turns aside, (B, p).

    From the conversion of units, the rounding of a straight line, and 2π, which is no float.
    """
    gap = np.abs(inputs - asked)
    turns = np.round(gap / (2.0 * np.pi))
    rest = np.abs(gap - turns * (2.0 * np.pi)) + UNIT_ROUNDOFF * 2.0 * (
        np.abs(inputs) + np.abs(asked)
    )
    # a gap that is no whole turn counts in full
    turned = (turns > 0) & (rest < _TURN)
    apart: Array = rounding_of_inputs(inputs, 0) + np.where(turned, rest, gap)
    return apart
