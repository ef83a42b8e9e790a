"""Solve designs over a table of inputs by compiled kernels, the remaining ones one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.batch.coefficients import loop_coefficients, zero_coefficients
from linkwork.batch.designs import Designs
from linkwork.batch.limits import LIMIT_KINDS
from linkwork.batch.open_loops import stay_open
from linkwork.batch.path_entry import lead_to_rows
from linkwork.batch.rows import DesignRows
from linkwork.batch.single_sweep import leave_open, sweep_single
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.foundation.status import Status
from linkwork.kernels.march.dead_points import dead_points
from linkwork.kernels.march.sweep_kernel import Steps
from linkwork.kernels.march.work_arrays import MarchResult
from linkwork.kernels.program.execution import Execution
from linkwork.motion.by_kernels import are_served, kernel_of
from linkwork.motion.drive import Drive
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.tracking import turns_freely
from linkwork.results.motion import LimitKind

__all__ = ["FamilyMarch", "TablePath", "design_rows"]

_ON_PATH = 1e-12
_FINEST = 1e-8  # relative step for rows directly before a dead point


def design_rows(
    designs: Designs, *, certify: bool, threads: int = 1, execution: Execution | None = None
) -> DesignRows:
    """Solve every design over the rows of the mechanism's table, on the branch of its start.

    The compiled march handles loop and linear equations; designs that it cannot complete (dead
    points, change points, no position at the start) and mechanisms with other equations are swept
    one at a time, so every row has the same status as in a single sweep.
    """
    model = designs.base
    left = designs.problem == 0
    path = TablePath.of(model)
    found = DesignRows.blank(
        model.compiled.solver.unknowns,
        len(model.rows),
        len(designs),
        certify,
        falling=path is not None and path.falling,
    )
    if path is None:
        found.clear(np.ones(found.status.shape, dtype=bool), certify)
    else:
        left &= ~path.fill(designs, found, certify, threads, execution or Execution())
        # most of those without a start need not be built to be tried
        if left.any():
            open_ones = left & stay_open(designs)
            leave_open(designs, np.flatnonzero(open_ones), found)
            left &= ~open_ones
    for k in np.flatnonzero(left):
        sweep_single(designs, int(k), found, certify)
    return found.freeze()


@dataclass(frozen=True, kw_only=True, eq=False)
class TablePath:
    """The straight line through the table's inputs: u = origin + rate t; ``size``: step."""

    model: Model
    lead: int
    origin: Array
    rate: Array
    size: float

    @classmethod
    def of(cls, model: Model) -> TablePath | None:
        """``None`` if the compiled march cannot be used."""
        if not are_served(model):
            return None
        lead, rate = leading_input(model.rows)
        drive = Drive.through(model, model.rows[0], rate, lead)
        path = drive.path
        return cls(model=model, lead=lead, origin=path.origin, rate=path.rate, size=path.size)

    @property
    def falling(self) -> bool:
        """Whether t decreases along the table."""
        t = self.model.rows[:, self.lead]
        return bool(t[-1] < t[0])

    def input_radius(self, start: Array) -> Array:
        """Error bounds of requested inputs, and of those computed from ``start`` (D,), (p,)."""
        t = self.model.rows[:, self.lead]
        gap = np.abs(self.model.rows - (self.origin + np.outer(t, self.rate))).max(axis=0)
        farthest = max(np.abs(t).max(), np.abs(start[np.isfinite(start)]).max(initial=0.0))
        rounds = (self.origin != 0.0) & (self.rate != 0.0)
        size = np.abs(self.origin) + np.abs(self.rate) * farthest
        input_radius: Array = gap + np.where(rounds, 4.0 * UNIT_ROUNDOFF * size, 0.0)
        return input_radius

    def fill(
        self, designs: Designs, found: DesignRows, certify: bool, threads: int, execution: Execution
    ) -> BoolArray:
        """Fill in the designs that reached all rows; returns their mask, (D,)."""
        march = self.march(designs, certify, threads, execution)
        t = self.model.rows[:, self.lead]
        way = slice(None, None, -1 if self.falling else 1)
        # the march needs rising values; a falling table is written backwards through views
        whole, reached = march.through(t[way].copy(), found.v[:, way], found.radius[way])
        self._note(found, reached[way], whole, certify)
        for rows, which, turns in march.wound:
            found.turns[way][rows, which] = turns
        march.note_limits(found, whole)
        return whole

    def march(
        self, designs: Designs, certify: bool, threads: int, execution: Execution
    ) -> FamilyMarch:
        """The march of designs that start on the path or can be moved to it."""
        inputs = designs.start[:, self.model.compiled.solver.unknowns :]
        start = inputs[:, self.lead]
        away = np.abs(inputs - (self.origin + self.rate * start[:, None]))
        served: BoolArray = np.all(away <= _ON_PATH * np.maximum(1.0, np.abs(inputs)), axis=1)
        return FamilyMarch(self, designs, served, certify, threads, execution)

    def _note(self, found: DesignRows, reached: BoolArray, whole: BoolArray, certify: bool) -> None:
        """Set the status of reached rows, and of the other rows of finished designs."""
        proof = Certification.CERTIFIED if certify else Certification.NOT_ASKED
        if reached.all():
            found.status[:], found.certification[:] = Status.CONVERGED.code, proof.code
            return
        found.clear(~reached, certify)
        # rows beyond the dead points of designs whose every other row was found
        found.status[:, whole] = Status.OUT_OF_REACH.code
        np.copyto(found.status, Status.CONVERGED.code, where=reached)
        np.copyto(found.certification, proof.code, where=reached)


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
            folds = dead_points(
                self.path.model.compiled.table,
                self.zeros,
                {name: values[mine[ended]] for name, values in self.coefficients.items()},
                self.kernel.last_nodes(found, way, there[ended]),
                way,
            )
            limits[way, ended] = np.where(folds.found, folds.t, np.nan)

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
