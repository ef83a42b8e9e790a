"""Certificates of solved rows: the position, and the motion from the start to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.foundation.status import Status
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath, Node, Track, rows_of_nodes
from linkwork.numerics.continuation.path_proof import prove_path
from linkwork.numerics.proof.position_proof import rounding_of_inputs
from linkwork.numerics.rows import SolvedRows

__all__ = ["inputs_apart", "prove_rows", "unproved", "way_is_proved"]

_FAR_FROM_SINGULAR = 1e5  # condition up to which a track's nodes must be proved
_TURN = 1e-9  # rad: an input this near to whole turns from the input asked for is the same one


def prove_rows(
    solver: BlockSolver,
    path: InputPath,
    track: Track,
    rows: SolvedRows,
    asked: Array,
    progress: Callable[[float], None] | None = None,
) -> tuple[SolvedRows, bool]:
    """Prove rows solved along a track for the inputs ``asked`` (B, p).

    The rows and the track's nodes around them are sorted along the path; every position and every
    step between neighbours is proved, and a row is certified if proved steps join it to the
    track's start.

    Returns
    -------
    rows, up_to_ends
        The rows with ``certification``, ``radius`` and ``uniqueness_radius``; whether the track
        itself is proved up to both ends.
    """
    found = np.flatnonzero(rows.status == Status.CONVERGED.code)
    if not len(found):
        return unproved(rows, Certification.NO_POSITION), True
    nodes = _nodes_around(track, rows.t[found])
    points, place = _path_points(solver, [track.nodes[k] for k in nodes], rows, asked, found)
    anchor = int(place[nodes.index(track.start)])
    proof = prove_path(solver, path, points, anchor=anchor, progress=progress)
    joined = proof.connected_to(anchor)
    mine = place[len(nodes) :]
    position = proof.position.holds[mine]
    certification = np.select(
        [joined[mine], ~position, proof.given_up_before(anchor)[mine]],
        [
            Certification.CERTIFIED.code,
            Certification.POSITION_NOT_PROVED.code,
            Certification.PROOF_TOO_LONG.code,
        ],
        default=Certification.MOTION_NOT_PROVED.code,
    )
    proved = unproved(rows, Certification.NO_POSITION).set(
        found,
        certification=certification,
        radius=np.where(position, proof.position.radius[mine], np.nan),
        uniqueness_radius=np.where(position, proof.position.least_uniqueness_radius[mine], np.nan),
    )
    return proved, bool(joined[place[: len(nodes)]].all())


def unproved(rows: SolvedRows, why: Certification) -> SolvedRows:
    """The rows without proofs, all for one reason."""
    unknown = np.full(len(rows), np.nan)
    code = np.full(len(rows), why.code, dtype=np.int8)
    return rows.with_columns(certification=code, radius=unknown, uniqueness_radius=unknown)


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
    solver: BlockSolver, nodes: Sequence[Node], rows: SolvedRows, asked: Array, found: IndexArray
) -> tuple[SolvedRows, IndexArray]:
    """Nodes and rows sorted along the path; the place of each of them, the nodes first."""
    apart = inputs_apart(rows.v[found][:, solver.unknowns :], asked[found])
    points = SolvedRows.concatenate(
        [_points_of(solver, nodes), rows.take(found).with_columns(input_radius=apart)]
    )
    order = np.argsort(points.t, kind="stable")
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    return points.take(order), place


def _points_of(solver: BlockSolver, nodes: Sequence[Node]) -> SolvedRows:
    points = rows_of_nodes(nodes)
    return points.with_columns(input_radius=rounding_of_inputs(points.v, solver.unknowns))


def way_is_proved(solver: BlockSolver, path: InputPath, nodes: Sequence[Node]) -> bool:
    """Whether every position and every step of a track is proved."""
    points = _points_of(solver, nodes)
    return bool(prove_path(solver, path, points, anchor=0).connected_to(0).all())


def inputs_apart(inputs: Array, asked: Array) -> Array:
    """How far the intended inputs may be from given ones, modulo whole turns, (B, p).

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
