"""Where motions begin: every mechanism solved at the input of its guess."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, CountArray
from linkwork.core.record.recorder import LANES
from linkwork.families import march as loops
from linkwork.families.compiled.code_cache import loop_serves
from linkwork.families.compiled.compiling import compiled_for, types
from linkwork.families.march.step_trial import (
    GOOD,
    LIVE,
    TOPOLOGY,
    InputTable,
    MarchResult,
    Tasks,
    Topology,
    copy_lane,
    correct_slowly,
    load_all_lanes,
    predict_by_tangent,
)

_PLAIN = types.Array(types.float64, 2, "C")


@compiled_for(
    types.void(TOPOLOGY, _PLAIN, _PLAIN, _PLAIN, _PLAIN, types.Array(types.boolean, 1, "C"))
)
def begin(
    topology: Topology, w: Array, design: Array, guess: Array, node: Array, found: BoolArray
) -> None:
    """Solve every mechanism at its guess's input value.

    Parameters
    ----------
    topology : Topology
    w : (registers, LANES) workspace with constants and options in place
    design : (C, M) coefficients
    guess, node : (S, M) the guess, and the node found from it
    found : (M,) bool, set
    """
    count, nodes, good = design.shape[1], topology.nodes, topology.noted[GOOD]
    for base in range(0, count, LANES):
        width = min(LANES, count - base)
        load_all_lanes(w, topology.coefficients, design, base, width)
        load_all_lanes(w, nodes[1], guess, base, width)
        for lane in range(LANES):
            for role in range(len(nodes)):
                copy_lane(w, lane, nodes[role], nodes[1])
            predict_by_tangent(w, lane, topology.weights, 0.0)
            w[good, lane] = 1.0
        correct_slowly(topology, w, 1 if width == 1 else LANES)
        for lane in range(width):
            member = base + lane
            fine = w[good, lane] > 0.5
            for live in topology.noted[LIVE:]:
                fine &= w[live, lane] == 0.0
            for j in range(nodes.shape[1]):
                node[j, member] = w[nodes[0, j], lane]
                fine &= math.isfinite(node[j, member])
            found[member] = fine


# ----------------------------------------------------------------------
# One design at a time, its rows side by side in the lanes.


@dataclass(frozen=True, eq=False)
class LoadedFamily:
    """A topology and the coefficients (C, D) of designs."""

    topology: Topology
    design: Array

    def part(self, which: slice) -> LoadedFamily:
        """Some of the designs."""
        return LoadedFamily(self.topology, np.ascontiguousarray(self.design[:, which]))

    def one(self, k: int) -> LoadedFamily:
        """One of the designs."""
        return self.part(slice(k, k + 1))

    def load(self, space: Array, k: int) -> None:
        """One design into all lanes of a workspace."""
        space[self.topology.coefficients] = self.design[:, k, None]


class Scout(Protocol):
    """Finds starts from guesses that are not near; see :class:`SweepKernel`."""

    def guess_nodes(self, guess: Array, start: Array) -> Array:
        """Guesses (n, D) at ``start`` (D,) as nodes, (S, D)."""

    def start_nodes(
        self, family: LoadedFamily, space: Array, given: Array
    ) -> tuple[Array, BoolArray]:
        """Nodes (S, D) where designs start, and whether they do, (D,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SingleDesign:
    """The rows of one design; the workspace holds one design at a time.

    ``proving``: the kernel itself. ``fresh``: makes a workspace. ``scale`` (D, n): weights of the
    unknowns.
    """

    scout: Scout
    proving: Scout
    fresh: Callable[[], Array]
    family: LoadedFamily
    ahead: LoadedFamily
    space: Array
    own: Array
    table: InputTable
    scale: Array

    def with_design(self, k: int) -> LoadedDesign:
        """With a design in place, until another one is."""
        self.family.load(self.space, k)
        if self.own is not self.space:
            self.ahead.load(self.own, k)
        return LoadedDesign(
            self, k, (self.family.topology, self.ahead.topology, self.space, self.own)
        )


@dataclass(frozen=True, eq=False)
class LoadedDesign:
    """One design in place."""

    alone: SingleDesign
    design: int
    spaces: tuple[Topology, Topology, Array, Array]

    def run_side_by_side(self, guess: Array, found: MarchResult, counts: CountArray) -> bool:
        """From a guess (n + 1,) of the unknowns and of t; whether all rows are found.

        ``counts`` (R,): filled with the corrections that they took.
        """
        alone, scale = self.alone, self.alone.scale[self.design]
        code = loops.by_rows(*self.spaces, guess, False, alone.table, scale, found, counts)
        if code == loops.NOT_NEAR:
            node = alone.scout.guess_nodes(guess[:-1, None], guess[-1:])
            start, begun = alone.scout.start_nodes(alone.ahead.one(self.design), alone.own, node)
            if not begun[0]:
                return False
            own = start[:, 0].copy()
            code = loops.by_rows(*self.spaces, own, True, alone.table, scale, found, counts)
        return bool(code == loops.DONE)

    def run_in_turn(self, guess: Array, found: MarchResult, counts: CountArray) -> bool:
        """The same, row after row, down and up from the guess."""
        alone, own = self.alone, self.alone.family.one(self.design)
        given, space = alone.proving.guess_nodes(guess[:-1, None], guess[-1:]), alone.fresh()
        node, begun = alone.proving.start_nodes(own, space, given)
        march_in_turn(own, space, node, begun, alone.table, found, counts)
        return bool(begun[0] and found.reached[:, found.first].all())


def march_in_turn(
    family: LoadedFamily,
    space: Array,
    node: Array,
    begun: BoolArray,
    table: InputTable,
    found: MarchResult,
    counts: CountArray,
) -> None:
    """March designs row after row, down and up from their starts.

    Parameters
    ----------
    node, begun : (S, D), (D,)
        Where they start, and whether they do.
    counts : (R,)
        Of a single design: filled with the corrections that rows took; else (0,).
    """
    members = np.repeat(np.flatnonzero(begun), 2)
    ways = np.tile([1, 0], len(members) // 2)
    tasks = Tasks(members, ways, np.ascontiguousarray(node[:, members]))
    loops.march(family.topology, space, family.design, table, tasks, len(members), found, counts)


@dataclass(frozen=True, kw_only=True, eq=False)
class RowsOfOne:
    """The rows of one design, computed as often as wanted.

    :meth:`SweepKernel.prepare_single` makes them.
    """

    loaded: LoadedDesign
    guess: Array
    room: tuple[BoolArray, Array, Array]
    counts: CountArray
    certified: bool

    def run(self) -> tuple[Array, Array] | None:
        """Unknowns (n, R, 1) and radii of their proofs (R, 1); ``None`` if this is not the way.

        How many corrections each row took is left in ``counts`` (R,).
        """
        table = self.loaded.alone.table
        rows = len(table.rows)
        v = np.empty((table.unknowns, rows, 1))
        radius = np.empty((rows if self.certified else 0, 1))
        found = MarchResult(0, v, radius, *self.room)
        if loop_serves("rowwise", rows) and self.loaded.run_side_by_side(
            self.guess, found, self.counts
        ):
            return v, radius
        found.reached[:] = False
        return (v, radius) if self.loaded.run_in_turn(self.guess, found, self.counts) else None
