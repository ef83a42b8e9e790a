"""Designs over a table of inputs by the compiled march; what it leaves open, one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linkwork.batch.coefficients import loop_coefficients, zero_coefficients
from linkwork.batch.designs import Designs
from linkwork.batch.entering import led_to_rows
from linkwork.batch.limits import LIMIT_KINDS
from linkwork.batch.own_rows import OwnRows, ends_as_limits
from linkwork.foundation.aligned import aligned
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, IndexArray, StatusArray, TurnArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import LinkworkError
from linkwork.foundation.status import Status
from linkwork.kernels.lanes.folding import dead_points
from linkwork.kernels.lanes.gear import Gear
from linkwork.kernels.lanes.lane_kernel import LaneRows, RowsOfOne, Steps
from linkwork.mechanism.parts import Input
from linkwork.motion import sweep
from linkwork.motion.by_kernels import are_served, kernel_of
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd
from linkwork.motion.lock_step import lock_step
from linkwork.motion.model import Model
from linkwork.motion.rows import SolvedRows
from linkwork.motion.sweeping import swept_rows
from linkwork.motion.tracking import turns_freely
from linkwork.results.motion import LimitKind

__all__ = ["DesignRows", "March", "Path", "design_rows", "message_alone"]

_ON_PATH = 1e-12
_FINEST = 1e-8  # step, of a radian or a length, where a row lies right in front of a dead point
_UNIT = float(np.finfo(float).eps) / 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRows:
    """D designs over R rows of inputs, internal units.

    ``v`` (n, R, D): unknowns, NaN where there is no position. ``status``, ``certification``
    (R, D): codes. ``radius`` (R, D): of the proof, weighted, NaN without one; (0, D) if none is
    asked for. ``limits`` (2, D): where the branch ends below and above, and ``limit_kinds`` (2, D)
    what ends it, see :func:`linkwork.batch.own_rows.ends_as_limits`; NaN without a position.
    ``alone`` (D,): designs that were computed one at a time; ``own``: what they say themselves.
    """

    v: Array
    status: StatusArray
    certification: StatusArray
    radius: Array
    limits: Array
    limit_kinds: StatusArray
    alone: BoolArray
    own: dict[int, OwnRows] = field(default_factory=dict)

    @classmethod
    def blank(
        cls, unknowns: int, rows: int, designs: int, certify: bool, falling: bool
    ) -> DesignRows:
        """No positions yet; rows are left as they come until they are filled or cleared.

        Where inputs fall, unknowns and radii stand in memory by rising inputs: so does the march
        write them.
        """
        way = slice(None, None, -1 if falling else 1)
        return cls(
            v=aligned(unknowns, rows, designs)[:, way],
            status=np.empty((rows, designs), dtype=np.int8),
            certification=np.empty((rows, designs), dtype=np.int8),
            radius=aligned(rows if certify else 0, designs)[way],
            limits=np.full((2, designs), np.nan),
            limit_kinds=np.zeros((2, designs), dtype=np.int8),
            alone=np.zeros(designs, dtype=bool),
        )

    @cached_property
    def turns(self) -> TurnArray:
        """How many whole turns further the position of a row was found, (R, D)."""
        return np.zeros(self.status.shape, dtype=np.int32)

    def clear(self, where: BoolArray, certify: bool) -> None:
        """No position in some rows (R, D); no status in any of them."""
        self.v[:, where] = np.nan
        self.status[:] = Status.NO_START.code
        none = Certification.NO_POSITION if certify else Certification.NOT_ASKED
        self.certification[:] = none.code
        if certify:
            self.radius[where] = np.nan


def design_rows(
    designs: Designs, *, certify: bool, threads: int = 1, gear: Gear | None = None
) -> DesignRows:
    """Every design over the rows of the mechanism's table, on the branch of its own start.

    The compiled march serves equations of loops and lines; designs that it cannot lead through
    all rows (dead points, change points, no position at the start) and mechanisms with other
    equations are swept one at a time, so that every row has the status that it has by itself.
    """
    model = designs.base
    left = designs.problem == 0
    march = Path.of(model)
    found = DesignRows.blank(
        model.compiled.solver.unknowns,
        len(model.rows),
        len(designs),
        certify,
        falling=march is not None and march.falling,
    )
    if march is None:
        found.clear(np.ones(found.status.shape, dtype=bool), certify)
    else:
        left &= ~march.fill(designs, found, certify, threads, gear or Gear())
    for k in np.flatnonzero(left):
        _alone(designs, int(k), found, certify)
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """The straight line through the table's inputs: u = origin + rate t; ``size``: of a step."""

    model: Model
    lead: int
    origin: Array
    rate: Array
    size: float

    @classmethod
    def of(cls, model: Model) -> Path | None:
        """``None`` where the compiled march does not serve."""
        if not are_served(model):
            return None
        lead, rate = lock_step(model.rows)
        drive = Drive.through(model, model.rows[0], rate, lead)
        path = drive.path
        return cls(model=model, lead=lead, origin=path.origin, rate=path.rate, size=path.size)

    @property
    def falling(self) -> bool:
        """Whether the table goes towards smaller values of t."""
        t = self.model.rows[:, self.lead]
        return bool(t[-1] < t[0])

    def spread(self, start: Array) -> Array:
        """How far inputs asked for, or computed on the way from ``start`` (D,), are off, (p,)."""
        t = self.model.rows[:, self.lead]
        gap = np.abs(self.model.rows - (self.origin + np.outer(t, self.rate))).max(axis=0)
        farthest = max(np.abs(t).max(), np.abs(start[np.isfinite(start)]).max(initial=0.0))
        rounds = (self.origin != 0.0) & (self.rate != 0.0)
        size = np.abs(self.origin) + np.abs(self.rate) * farthest
        spread: Array = gap + np.where(rounds, 4.0 * _UNIT * size, 0.0)
        return spread

    def fill(
        self, designs: Designs, found: DesignRows, certify: bool, threads: int, gear: Gear
    ) -> BoolArray:
        """Designs that went through all rows are filled in; which they are, (D,)."""
        march = self.march(designs, certify, threads, gear)
        t = self.model.rows[:, self.lead]
        way = slice(None, None, -1 if self.falling else 1)
        march.turns = lambda: found.turns[way]
        whole, reached = march.through(t[way].copy(), found.v[:, way], found.radius[way])
        self._note(found, reached[way], whole, certify)
        march.note_limits(found, whole)
        return whole

    def march(self, designs: Designs, certify: bool, threads: int, gear: Gear) -> March:
        """The march of designs whose start lies on the path, or can be led to it."""
        inputs = designs.start[:, self.model.compiled.solver.unknowns :]
        start = inputs[:, self.lead]
        away = np.abs(inputs - (self.origin + self.rate * start[:, None]))
        served: BoolArray = np.all(away <= _ON_PATH * np.maximum(1.0, np.abs(inputs)), axis=1)
        return March(self, designs, served, certify, threads, gear)

    def _note(self, found: DesignRows, reached: BoolArray, whole: BoolArray, certify: bool) -> None:
        """Statuses of rows that were reached, and of the others of designs that are done."""
        proof = Certification.CERTIFIED if certify else Certification.NOT_ASKED
        if reached.all():
            found.status[:], found.certification[:] = Status.CONVERGED.code, proof.code
            return
        found.clear(~reached, certify)
        found.status[:, whole] = Status.OUT_OF_REACH.code
        np.copyto(found.status, Status.CONVERGED.code, where=reached)
        np.copyto(found.certification, proof.code, where=reached)


class March:
    """The compiled march of a family, and what becomes of designs that stop at dead points."""

    def __init__(
        self,
        path: Path,
        designs: Designs,
        served: BoolArray,
        certify: bool,
        threads: int,
        gear: Gear,
    ) -> None:
        self.path, self.certify, self.threads = path, certify, threads
        compiled, model = path.model.compiled, path.model
        n = compiled.solver.unknowns
        fine = designs.problem == 0
        self.coefficients = _coefficients(path, designs)
        self.zeros = zero_coefficients(designs, self.coefficients)
        self.kernel = kernel_of(model, frozenset(self.zeros), certify, gear.device)
        self.kernel.shift(gear)
        self.guess = np.where(served & fine, designs.start[:, :n].T, np.nan)  # else not found
        self.start = designs.start[:, n + path.lead].copy()
        self._enter(designs, np.flatnonzero(fine & ~served))
        self.free = turns_freely(model)
        #: Those of each row, where a design goes around for it.
        self.turns: Callable[[], TurnArray] | None = None
        self.limits = np.repeat([[-np.inf], [np.inf]], len(designs), axis=1)

    def _enter(self, designs: Designs, beside: IndexArray) -> None:
        """Let designs whose start lies beside the path begin at the row they can be led to."""
        if not len(beside):
            return
        t = self.path.model.rows[:, self.path.lead]
        rows = self.path.origin + np.outer(t, self.path.rate)
        v, nearest = led_to_rows(
            designs, rows, self.kernel, self.coefficients, beside, self.threads
        )
        self.guess[:, beside], self.start[beside] = v, t[nearest]

    def note_limits(self, found: DesignRows, which: BoolArray) -> None:
        """Enter where some designs can move; what the march has located are dead points."""
        if which.all():
            found.limits[:] = self.limits
        else:
            found.limits[:, which] = self.limits[:, which]
        if not np.isfinite(self.limits).any():
            return
        dead = LIMIT_KINDS.index(LimitKind.DEAD_POINT)
        found.limit_kinds[:, which] = np.where(np.isfinite(self.limits[:, which]), dead, 0)

    def through(self, t: Array, v: Array, radius: Array) -> tuple[BoolArray, BoolArray]:
        """March through increasing values of t.

        Returns
        -------
        done, reached : (D,), (R, D)
            Which designs need nothing more: each row is reached, or lies beyond a dead point.
        """
        rows = self._marched(t, v, radius, slice(None))
        reached = rows.reached
        if reached.all():  # as a rule, and quicker to tell than of each design
            return np.ones(len(rows.found), dtype=bool), reached
        done: BoolArray = np.logical_and.reduce(reached, axis=0)
        stopped = np.flatnonzero(rows.found & ~done)
        if not len(stopped) or len(self.path.rate) > 1:
            return done, reached
        limits = np.repeat([[-np.inf], [np.inf]], len(stopped), axis=1)
        self._limit(limits, rows.take(stopped), stopped)
        around = (-1, 1) if self.free else ()
        for turns in around:
            self._wind(t, turns, v, radius, reached, stopped, limits)
        for turns in (0, *around):  # rows right in front of dead points
            self._wind(t, turns, v, radius, reached, stopped, limits, _FINEST)
        self.limits[:, stopped] = limits
        settled = self._settled(t, reached[:, stopped], limits)
        done[stopped[settled]] = True
        return done, reached

    def of_one(self, t: Array) -> RowsOfOne:
        """The rows of a family of one design, to be computed again and again."""
        return self.kernel.alone(
            self.coefficients,
            self.guess[:, 0],
            float(self.start[0]),
            t,
            Steps().times(self.path.size),
        )

    def _marched(
        self,
        t: Array,
        v: Array,
        radius: Array,
        where: IndexArray | slice,
        apart: float = 0.0,
        smallest: float | None = None,
    ) -> LaneRows:
        """Rows at values of t that may be ``apart`` from those that are meant.

        ``smallest``: of the steps, if it is another one than usual.
        """
        steps = Steps() if smallest is None else Steps(smallest=smallest)
        found = LaneRows.over(v, radius, self.kernel)
        coefficients = {name: values[where] for name, values in self.coefficients.items()}
        coefficients["u0.spread"] = coefficients["u0.spread"] + apart
        self.kernel.run(
            coefficients,
            self.guess[:, where],
            self.start[where],
            t,
            steps.times(self.path.size),
            found,
            self.threads,
        )
        return found

    def _limit(self, limits: Array, rows: LaneRows, mine: IndexArray) -> None:
        """Note between which values of t designs can move, where rows say that they were stopped.

        ``limits`` (2, S): infinite where nothing has stopped them; NaN where what did is no dead
        point that was found.
        """
        for way in range(2):
            ended = np.flatnonzero(~np.isnan(rows.stopped[way]) & np.isinf(limits[way]))
            if not len(ended):
                continue
            folds = dead_points(
                self.path.model.compiled.table,
                self.zeros,
                {name: values[mine[ended]] for name, values in self.coefficients.items()},
                self.kernel.last_nodes(rows, way, ended),
                way,
                self.certify,
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
        """Fill the rows that designs reach so many turns away, with steps as small as that."""
        moved = t + turns * FULL_TURN
        inside = (moved[:, None] >= limits[0]) & (moved[:, None] <= limits[1])
        those = np.flatnonzero((~reached[:, stopped] & inside).any(axis=0))
        if not len(those):
            return
        mine = stopped[those]
        own, radii = np.empty((len(v), len(t), len(mine))), np.empty((len(radius), len(mine)))
        # neither 2π nor the sum is exact
        apart = 4.0 * _UNIT * (float(np.abs(t).max()) + abs(turns) * FULL_TURN) if turns else 0.0
        further = self._marched(moved, own, radii, mine, apart, smallest)
        row, column = np.nonzero(further.reached & ~reached[:, mine])
        v[:, row, mine[column]] = own[:, row, column]
        if self.certify:
            radius[row, mine[column]] = radii[row, column]
        reached[row, mine[column]] = True
        if self.turns is not None and turns:
            self.turns()[row, mine[column]] = turns
        known = limits[:, those]
        self._limit(known, further, mine)
        limits[:, those] = known

    def _settled(self, t: Array, reached: BoolArray, limits: Array) -> BoolArray:
        """Designs of which no row is missing that lies within their limits, (S,)."""
        low, high = limits
        settled: BoolArray = np.logical_not(np.isnan(limits).any(axis=0))
        most = int((t[-1] - t[0]) / FULL_TURN) + 2 if self.free else 0
        for turns in range(-most, most + 1):
            moved = t[:, None] + turns * FULL_TURN
            settled &= ~(~reached & (moved >= low) & (moved <= high)).any(axis=0)
        return settled


def _coefficients(path: Path, designs: Designs) -> dict[str, Array]:
    """What the programs of a family read, by register, (D,) each."""
    found = loop_coefficients(designs)
    spread = path.spread(designs.start[:, path.model.compiled.solver.unknowns + path.lead])
    for j, (origin, rate) in enumerate(zip(path.origin, path.rate, strict=True)):
        found[f"u{j}.origin"] = np.full(len(designs), origin)
        found[f"u{j}.rate"] = np.full(len(designs), rate)
        found[f"u{j}.spread"] = np.full(len(designs), spread[j])
    return found


def _at_shared_inputs(designs: Designs, k: int) -> Model:
    """A design by itself with the family's table, should its own depend on what varies."""
    base, model = designs.base, designs.design(k)
    if np.array_equal(model.everyday_rows, base.everyday_rows):
        return model
    inputs = tuple(_with_plain_range(base, which) for which in base.description.inputs)
    description = replace(model.description, inputs=inputs)
    return Model(description, model.equations, model.compiled, model.skeleton, model.branch)


def _with_plain_range(base: Model, which: Input) -> Input:
    start, stop, step = (
        None if value is None else base.description.numbers(value)
        for value in (which.start, which.stop, which.step)
    )
    return replace(which, start=start, stop=stop, step=step)


def _alone(designs: Designs, k: int, found: DesignRows, certify: bool) -> None:
    """One design by the ordinary sweep."""
    found.alone[k] = True
    try:
        rows, ends = swept_rows(_at_shared_inputs(designs, k), certify=certify)
    except LinkworkError:  # told by ``message_alone``
        found.v[:, :, k] = found.radius[:, k] = np.nan
        found.status[:, k] = Status.NO_START.code
        none = Certification.NO_POSITION if certify else Certification.NOT_ASKED
        found.certification[:, k] = none.code
        return
    n = len(found.v)
    found.v[:, :, k] = rows.v[:, :n].T
    found.status[:, k], found.certification[:, k] = rows.status, rows.certification
    if certify:
        found.radius[:, k] = rows.radius
    found.own[k] = OwnRows.of(rows, n)
    _note_way(designs.base, k, rows, ends, found)


def _note_way(
    base: Model, k: int, rows: SolvedRows, ends: tuple[BranchEnd, ...], found: DesignRows
) -> None:
    """Whole turns to the rows of a design that went alone, and the limits it met."""
    if not (rows.status == Status.CONVERGED.code).any():
        return
    found.limits[:, k], found.limit_kinds[:, k] = ends_as_limits(ends)
    if base.equations.inputs[0].kind == "angle":
        gap = (rows.v[:, len(found.v)] - base.rows[:, 0]) / FULL_TURN
        found.turns[:, k] = np.round(np.where(np.isnan(gap), 0.0, gap))


def message_alone(designs: Designs, k: int) -> str:
    """What a design has to say of its own motion, or why it has none."""
    try:
        return sweep(_at_shared_inputs(designs, k), certify=False).message
    except LinkworkError as error:
        return str(error)
