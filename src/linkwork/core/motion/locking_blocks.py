"""Dead points block by block: where several blocks lock at one input, equal to rounding.

There the equations as a whole lose one rank for each such block, and whichever variable leads,
curves cross. With the blocks that it depends on each of them is a mechanism of its own with an
ordinary dead point: no branch goes on beyond the first of these.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.rounding import EPSILON
from linkwork.core.motion.following import Drive
from linkwork.core.numerics.branch_tracking import InputPath, Node
from linkwork.core.numerics.change_point import crossing_near, singular_blocks
from linkwork.core.numerics.decomposition import closure_of
from linkwork.core.numerics.turning_point import turn_beyond
from linkwork.core.table.loop_table import TableSplitter

# Condition up to which a node is far enough from a dead point to begin the search for it. Nodes
# must be proved up to 1e5 (motion.proving) and exist up to 3e6 (TrackOptions): a tenth of the first
# leaves no doubt that this one is proved.
_SOUND = 1e4
_APART = 16.0 * EPSILON  # relative: dead points nearer to each other are at one input


@dataclass(frozen=True, kw_only=True, eq=False)
class Lock:
    """A value ``t`` of the path at which blocks lock, within ``bracket``, proved; ``v`` (N,): the
    position, as it was before for all variables that these blocks do not need.
    """

    t: float
    bracket: tuple[float, float]
    v: Array


def locks_ahead(drive: Drive, nodes: Sequence[Node], side: float) -> Lock | None:
    """The first dead point ahead of a track's last node, if several blocks are singular there.

    ``None`` if that is no more than one, or none is proved to have a dead point.
    """
    blocks = singular_blocks(drive.solver, nodes[-1].v)
    if len(blocks) < 2:
        return None
    # next to a change point, in its own loops or in those that drive it, rounding makes a dead
    # point of a crossing
    locking = [
        block
        for block in blocks
        if set(closure_of(drive.solver, block)).isdisjoint({*blocks} - {block})
        and crossing_near(drive.solver, drive.path, block, nodes[-1].v) is None
    ]
    found = [lock for block in locking if (lock := _lock(drive, nodes, block, side)) is not None]
    found.sort(key=lambda lock: side * lock.t)
    if not found:
        return None
    low, high = found[0].bracket
    v = found[0].v.copy()
    for lock in found:
        slack = _APART * max(1.0, abs(lock.t))
        if lock.bracket[0] > high + slack or lock.bracket[1] < low - slack:
            break
        low, high = min(low, lock.bracket[0]), max(high, lock.bracket[1])
        moved = lock.v != nodes[-1].v
        v[moved] = lock.v[moved]
    t = found[0].t
    v[drive.solver.unknowns :] = drive.path.at(t)
    return Lock(t=t, bracket=(low, high), v=v)


def _lock(drive: Drive, nodes: Sequence[Node], block: int, side: float) -> Lock | None:
    """The dead point of one block with those that it depends on; ``None`` if none is proved."""
    solver, path = drive.solver, drive.path
    members = [solver.blocks[k] for k in closure_of(solver, block)]
    equations = [e for member in members for e in member.equations]
    unknowns = [int(k) for member in members for k in member.unknowns]
    table, known = TableSplitter(drive.model.compiled.table).part(equations, unknowns)
    inputs = [k - solver.unknowns for k in known]
    moving = [k for k in inputs if path.rate[k]]
    if not moving:
        return None
    lead = drive.lead if drive.lead in moving else moving[0]
    own = InputPath(origin=path.origin[inputs], rate=path.rate[inputs], size=path.size)
    leads = ParametrizedTable(table, own, inputs.index(lead))
    order, rate, origin = np.array([*unknowns, *known]), path.rate[lead], path.origin[lead]
    for node in sound_nodes(nodes):
        way = math.copysign(1.0, side * rate)
        ahead = turn_beyond(leads, node.v[order], node.first[order] / rate, way)
        if ahead is None or not ahead.located:
            continue
        t, *edges = ((x - origin) / rate for x in (ahead.turn.t, *ahead.turn.bracket))
        v = nodes[-1].v.copy()
        v[order] = ahead.turn.v
        return Lock(t=float(t), bracket=(min(edges), max(edges)), v=v)
    return None


def sound_nodes(nodes: Sequence[Node]) -> list[Node]:
    """The nodes of a track from which a dead point ahead is looked for: the last one that is proved
    with the others, since rounding is worst at the very last one, and that one.
    """
    sound = next((node for node in reversed(nodes) if node.nearness < _SOUND), nodes[-1])
    return [sound, nodes[-1]] if sound is not nodes[-1] else [sound]
