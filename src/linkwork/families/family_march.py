"""Families solved with arrays, many designs side by side: where nothing is compiled.

All designs of a part are followed through the same nodes, the rows between them are corrected and
proved as those of one table are. Designs that some row leaves open are left to others.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, BoolArray, IndexArray
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import turns_freely
from linkwork.core.motion.model import Model
from linkwork.core.results.failure import LimitKind
from linkwork.families.building import Designs
from linkwork.families.compiled.code_cache import Execution
from linkwork.families.design_sweep import (
    LIMIT_KINDS,
    DesignRows,
    TablePath,
    block_parts,
    lines_of_lengths,
    loop_coefficients,
    zero_coefficients,
)
from linkwork.families.gpu.kernel import DeviceKernel
from linkwork.families.march.dead_points import dead_points
from linkwork.families.march.march_programs import Steps
from linkwork.families.march.step_trial import MarchResult
from linkwork.families.march.sweep_kernel import SweepKernel

# ----------------------------------------------------------------------
# The compiled march of families through a table, and the kernels of their topologies.


# ----------------------------------------------------------------------
# The kernels of topologies, each made once; this module loads compiled code.


_KEPT = 128  # kernels; one takes a hundredth of a second to make, and some 100 kB


@dataclass(frozen=True)
class _Topology:
    """A mechanism as all with the same ``key`` are: their equations differ in numbers only.

    ``zeros``: coefficients that are zero, by register.
    """

    key: Hashable
    zeros: frozenset[str]
    model: Model = field(compare=False)

    @classmethod
    def of(cls, model: Model, zeros: frozenset[str]) -> _Topology:
        blocks = tuple((tuple(p.equations), p.unknowns) for p in block_parts(model))
        lengths = tuple(sorted(lines_of_lengths(model)))
        return cls((model.compiled.table.structure, blocks, lengths), zeros, model)


def kernel_of(
    model: Model, zeros: frozenset[str], certify: bool, device: str = "cpu"
) -> SweepKernel:
    """The kernel of a mechanism's topology.

    Parameters
    ----------
    zeros : frozenset of str
        Coefficients that are zero, by register.
    """
    return _kernel(_Topology.of(model, zeros), certify, device)


@lru_cache(maxsize=_KEPT)
def _kernel(topology: _Topology, certify: bool, device: str) -> SweepKernel:
    kind = DeviceKernel if device == "gpu" else SweepKernel
    model = topology.model
    return kind(model.compiled.table, block_parts(model), topology.zeros, certify)


# ----------------------------------------------------------------------
# Move designs whose start is off the table's path of inputs to that path.


_CHUNK = 1 << 22  # distances in memory at a time


def lead_to_rows(
    designs: Designs,
    rows: Array,
    kernel: SweepKernel,
    coefficients: Mapping[str, Array],
    which: IndexArray,
    threads: int,
) -> tuple[Array, IndexArray]:
    """Move designs from their starts to the nearest row, along a straight line of inputs.

    Parameters
    ----------
    rows : (R, p)
        Two or more inputs at the rows of the table.
    coefficients : Mapping[str, (D,)]
        By register.
    which : (M,)
        The designs.

    Returns
    -------
    v : (n, M)
        Unknowns at the rows, NaN if a row is not reached; proved with the kernel's steps.
    nearest : (M,)
        The rows.
    """
    n, count = kernel.table.unknowns, len(which)
    own = designs.start[which, n:]
    nearest = _nearest(designs, rows, which)
    rate = rows[nearest] - own
    given = {name: values[which] for name, values in coefficients.items()}
    for j in range(own.shape[1]):
        given[f"u{j}.origin"], given[f"u{j}.rate"] = own[:, j].copy(), rate[:, j].copy()
        given[f"u{j}.spread"] = 4.0 * UNIT_ROUNDOFF * (np.abs(own[:, j]) + np.abs(rate[:, j]))
    v, radius = np.empty((n, 2, count)), np.empty((2 if kernel.certified else 0, count))
    found = kernel.result(v, radius)
    # each design has its own path, from its start (0) to its row (1)
    ends = np.array([0.0, 1.0])
    kernel.run(given, designs.start[which, :n].T, np.zeros(count), ends, Steps(), found, threads)
    return np.where(found.reached[1], v[:, 1], np.nan), nearest


def _nearest(designs: Designs, rows: Array, which: IndexArray) -> IndexArray:
    """The row with the nearest inputs, lengths relative to the longest link, (M,)."""
    n = designs.base.compiled.solver.unknowns
    turns = designs.base.compiled.table.is_angle[n:]
    found = np.empty(len(which), dtype=np.intp)
    # all distances at once would not fit into memory for a million designs
    step = max(1, _CHUNK // rows.size)
    for begin in range(0, len(which), step):
        mine = which[begin : begin + step]
        weights = np.where(turns, 1.0, designs.length_scale[mine, None])
        away = np.abs(rows - designs.start[mine, None, n:]) / weights[:, None, :]
        found[begin : begin + step] = away.max(axis=2).argmin(axis=1)
    return found


# ----------------------------------------------------------------------
# The march of a family, and the designs that it leaves to others.


_FINEST = 1e-8  # relative step for rows directly before a dead point


class FamilyMarch:
    """The compiled march of a family, with the treatment of dead points."""

    def __init__(
        self,
        path: TablePath,
        designs: Designs,
        served: BoolArray,
        certify: bool,
        threads: int,
        execution: Execution,
    ) -> None:
        self.path, self.certify, self.threads = path, certify, threads
        compiled, model = path.model.compiled, path.model
        n = compiled.solver.unknowns
        fine = designs.problem == 0
        self.coefficients = _coefficients(path, designs)
        self.zeros = zero_coefficients(designs, self.coefficients)
        self.kernel = kernel_of(model, frozenset(self.zeros), certify, execution.device)
        self.kernel.choose_execution(execution)
        # NaN: the march leaves such designs out
        self.guess = np.where(served & fine, designs.start[:, :n].T, np.nan)  # otherwise not found
        self.start = designs.start[:, n + path.lead].copy()
        self._enter(designs, np.flatnonzero(fine & ~served))
        self.free = turns_freely(model)
        #: Rows (W,) reached by designs (W,) after whole turns, and the number of turns.
        self.wound: list[tuple[IndexArray, IndexArray, int]] = []
        self.limits = np.repeat([[-np.inf], [np.inf]], len(designs), axis=1)

    def _enter(self, designs: Designs, beside: IndexArray) -> None:
        """Move designs that start off the path to a row on it."""
        if not len(beside):
            return
        t = self.path.model.rows[:, self.path.lead]
        rows = self.path.origin + np.outer(t, self.path.rate)
        v, nearest = lead_to_rows(
            designs, rows, self.kernel, self.coefficients, beside, self.threads
        )
        self.guess[:, beside], self.start[beside] = v, t[nearest]

    def note_limits(self, found: DesignRows, which: BoolArray) -> None:
        """Store the limits of some designs; those located by the march are dead points."""
        np.copyto(found.limits, self.limits, where=which)
        dead = LIMIT_KINDS.index(LimitKind.DEAD_POINT)
        np.copyto(found.limit_kinds, np.int8(dead), where=which & np.isfinite(self.limits))

    def through(self, t: Array, v: Array, radius: Array) -> tuple[BoolArray, BoolArray]:
        """March through increasing values of t.

        Returns
        -------
        done, reached : (D,), (R, D)
            Designs that are finished: each row is reached or lies beyond a dead point.
        """
        begun, found = self._march(t, v, radius, slice(None))
        reached = found.reached
        if reached.all():  # the usual case, quicker to check for all designs together
            return np.ones(len(begun), dtype=bool), reached
        done: BoolArray = np.logical_and.reduce(reached, axis=0)
        stopped = np.flatnonzero(begun & ~done)
        # with several inputs no dead point is proved here: such designs are swept one at a time
        if not len(stopped) or len(self.path.rate) > 1:
            return done, reached
        limits = np.repeat([[-np.inf], [np.inf]], len(stopped), axis=1)
        self._limit(limits, found, stopped, stopped)
        # a row beyond a dead point may lie on the branch a turn away
        around = (-1, 1) if self.free else ()
        for turns in around:
            self._wind(t, turns, v, radius, reached, stopped, limits)
        for turns in (0, *around):  # rows directly before dead points
            self._wind(t, turns, v, radius, reached, stopped, limits, _FINEST)
        self.limits[:, stopped] = limits
        settled = self._find_complete(t, reached[:, stopped], limits)
        done[stopped[settled]] = True
        return done, reached

    def _march(
        self,
        t: Array,
        v: Array,
        radius: Array,
        where: IndexArray | slice,
        apart: float = 0.0,
        smallest: float | None = None,
    ) -> tuple[BoolArray, MarchResult]:
        """Rows at values of t, which may differ by ``apart`` from the requested ones, and a mask of
        the designs that began.

        ``smallest``: minimum step, if not the default.
        """
        steps = Steps() if smallest is None else Steps(smallest=smallest)
        found = self.kernel.result(v, radius)
        coefficients = {name: values[where] for name, values in self.coefficients.items()}
        # a new array: the family's own must not change
        coefficients["u0.spread"] = coefficients["u0.spread"] + apart
        begun = self.kernel.run(
            coefficients,
            self.guess[:, where],
            self.start[where],
            t,
            steps.times(self.path.size),
            found,
            self.threads,
        )
        return begun, found

    def _limit(
        self, limits: Array, found: MarchResult, there: IndexArray, mine: IndexArray
    ) -> None:
        """Store the range of t of designs stopped in a march; ``there`` (S,): their indices in the
        march, ``mine`` (S,): in the family.

        ``limits`` (2, S): infinite if the march was not stopped; NaN if it was stopped without a
        located dead point.
        """
        for way in range(2):
            ended = np.flatnonzero(~np.isnan(found.end[way, there]) & np.isinf(limits[way]))
            if not len(ended):
                continue
            limits[way, ended] = dead_points(
                self.path.model.compiled.table,
                self.zeros,
                {name: values[mine[ended]] for name, values in self.coefficients.items()},
                self.kernel.last_nodes(found, way, there[ended]),
                way,
            )

    def _wind(
        self,
        t: Array,
        turns: int,
        v: Array,
        radius: Array,
        reached: BoolArray,
        stopped: IndexArray,
        limits: Array,
        smallest: float | None = None,
    ) -> None:
        """Fill the rows reached after whole ``turns``, with steps down to ``smallest``."""
        moved = t + turns * FULL_TURN
        inside = (moved[:, None] >= limits[0]) & (moved[:, None] <= limits[1])
        those = np.flatnonzero((~reached[:, stopped] & inside).any(axis=0))
        if not len(those):
            return
        mine = stopped[those]
        own, radii = np.empty((len(v), len(t), len(mine))), np.empty((len(radius), len(mine)))
        # 2π and the sum are rounded
        apart = (
            4.0 * UNIT_ROUNDOFF * (float(np.abs(t).max()) + abs(turns) * FULL_TURN)
            if turns
            else 0.0
        )
        _, further = self._march(moved, own, radii, mine, apart, smallest)
        row, column = np.nonzero(further.reached & ~reached[:, mine])
        v[:, row, mine[column]] = own[:, row, column]
        if self.certify:
            radius[row, mine[column]] = radii[row, column]
        reached[row, mine[column]] = True
        if turns:
            self.wound.append((row, mine[column], turns))
        known = limits[:, those]
        self._limit(known, further, np.arange(len(mine)), mine)
        limits[:, those] = known

    def _find_complete(self, t: Array, reached: BoolArray, limits: Array) -> BoolArray:
        """Designs without missing rows within their limits, (S,)."""
        low, high = limits
        settled: BoolArray = np.logical_not(np.isnan(limits).any(axis=0))
        # turns that can bring a row of the table between two limits
        most = int((t[-1] - t[0]) / FULL_TURN) + 2 if self.free else 0
        for turns in range(-most, most + 1):
            moved = t[:, None] + turns * FULL_TURN
            settled &= ~(~reached & (moved >= low) & (moved <= high)).any(axis=0)
        return settled


def _coefficients(path: TablePath, designs: Designs) -> dict[str, Array]:
    """The coefficients of a family by register, (D,) each."""
    found = loop_coefficients(designs)
    input_radius = path.input_radius(
        designs.start[:, path.model.compiled.solver.unknowns + path.lead]
    )
    for j, (origin, rate) in enumerate(zip(path.origin, path.rate, strict=True)):
        found[f"u{j}.origin"] = np.full(len(designs), origin)
        found[f"u{j}.rate"] = np.full(len(designs), rate)
        found[f"u{j}.spread"] = np.full(len(designs), input_radius[j])
    return found
