"""Mechanisms as input of compiled kernels."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import (
    UNIT_ROUNDOFF,
    AnyArray,
    Array,
    BoolArray,
    IndexArray,
    StatusArray,
    TurnArray,
    allocate_aligned,
    read_only,
)
from linkwork.core.foundation.errors import LinkworkError, internal
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.inputs import Input
from linkwork.core.motion.branch_rows import RowsBetween, motion_of_rows
from linkwork.core.motion.following import Drive
from linkwork.core.motion.limits import BranchEnd
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.motion.sweeping import sweep, sweep_rows
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.record.closure import BlockPart
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.motion import Motion
from linkwork.families.building import Designs, stay_open
from linkwork.families.compiled.code_cache import Execution, has_compiler

# ----------------------------------------------------------------------
# The equations of a mechanism as input of compiled kernels.


def are_served(model: Model) -> bool:
    """Whether kernels can solve a mechanism: loops and lines only, no redundant links."""
    equations, compiled = model.equations, model.compiled
    plain = not compiled.table.functions and not equations.redundant
    return bool(plain and len(equations.inputs) and compiled.solver.unknowns)


def block_parts(model: Model) -> list[BlockPart]:
    """The blocks of a mechanism in the order in which they are solved."""
    return [
        BlockPart(equations=block.equations, unknowns=tuple(block.unknowns.tolist()))
        for block in model.compiled.solver.blocks
    ]


def lines_of_lengths(model: Model) -> set[int]:
    """The linear rows that are equations of lengths."""
    return {k for k, line in enumerate(model.equations.linear) if line.kind == "length"}


# ----------------------------------------------------------------------
# Sweeps of all designs of a family: their rows, the limits of their branches.


def loop_coefficients(designs: Designs) -> dict[str, Array]:
    """Coefficients of loops, constants of lines, weights of lengths, (D,) each."""
    found: dict[str, Array] = {}
    for term in range(designs.loops.shape[1]):
        column = designs.loops[:, term]
        found[f"c{term}.re"] = np.ascontiguousarray(column.real)
        found[f"c{term}.im"] = np.ascontiguousarray(column.imag)
    for row in range(designs.linear.shape[1]):
        found[f"k{row}"] = np.ascontiguousarray(designs.linear[:, row])
    for k, turns in enumerate(designs.base.compiled.table.is_angle):
        if not turns:
            found[f"scale{k}"] = designs.length_scale
    return found


def zero_coefficients(designs: Designs, coefficients: dict[str, Array]) -> set[str]:
    """Coefficients that are 0 in every design without a problem."""
    fine = np.flatnonzero(designs.problem == 0)
    which = slice(None) if len(fine) == len(designs) else fine
    return {name for name, values in coefficients.items() if not values[which].any()}


# ----------------------------------------------------------------------
# The solved rows of all designs, with their evidence.


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRows:
    """D designs over R rows of inputs, internal units; written by the march, then frozen.

    ``v`` (n, R, D): unknowns, NaN where there is no position. ``status``, ``certification``
    (R, D): codes. ``radius`` (R, D): of the proof, weighted, NaN without one; (0, D) if none is
    requested. ``limits`` (2, D): lower and upper end of the branch, values of the path, infinite
    where nothing ended it, NaN where the place was not located or without a position;
    ``limit_kinds`` (2, D): their kinds, indices in :data:`LIMIT_KINDS`.
    ``alone`` (D,): designs computed one at a time; ``own``: their own results. ``inputs``
    (R, p, D): if designs have inputs of their own instead of the table's.
    """

    v: Array
    status: StatusArray
    certification: StatusArray
    radius: Array
    limits: Array
    limit_kinds: StatusArray
    alone: BoolArray
    own: dict[int, SolvedRows] = field(default_factory=dict)
    inputs: Array | None = None

    @classmethod
    def blank(
        cls, unknowns: int, rows: int, designs: int, certify: bool, falling: bool
    ) -> DesignRows:
        """Rows without positions, uninitialised until they are filled or cleared.

        If inputs decrease, unknowns and radii are stored by increasing inputs, the order in which
        the march writes them.
        """
        way = slice(None, None, -1 if falling else 1)
        return cls(
            v=allocate_aligned(unknowns, rows, designs)[:, way],
            status=np.empty((rows, designs), dtype=np.int8),
            certification=np.empty((rows, designs), dtype=np.int8),
            radius=allocate_aligned(rows if certify else 0, designs)[way],
            limits=np.full((2, designs), np.nan),
            limit_kinds=np.zeros((2, designs), dtype=np.int8),
            alone=np.zeros(designs, dtype=bool),
        )

    @cached_property
    def turns(self) -> TurnArray:
        """Whole turns from the requested input to that of the position, (R, D)."""
        return np.zeros(self.status.shape, dtype=np.int32)

    def freeze(self) -> DesignRows:
        """Make all arrays read-only."""
        for array in vars(self).values():
            if isinstance(array, np.ndarray):
                array.setflags(write=False)
        return self

    def clear(self, where: BoolArray, certify: bool) -> None:
        """Remove the position of some rows (R, D) and the status of all."""
        self.v[:, where] = np.nan
        self.status[:] = Status.NO_START.code
        none = Certification.NO_POSITION if certify else Certification.NOT_ASKED
        self.certification[:] = none.code
        if certify:
            self.radius[where] = np.nan


# ----------------------------------------------------------------------
# The input limits of every design of a family.


#: Kind of the end of a branch, by code; 0 for none.
LIMIT_KINDS: tuple[LimitKind | None, ...] = (None, *LimitKind)


@internal("of")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FamilyLimits:
    """The ends of the branch on which each of D designs starts.

    Parameters
    ----------
    lower, upper : (D,)
        The leading input at the ends, in file units, below and above the input of the design's
        start: -∞, ∞ if the branch has no end on the path to the rows of the table; NaN if an end
        was met but not located, or the design has no position.
    lower_kind, upper_kind : (D,) text
        ``dead point``, ``change point``, ``limit`` (not located), or "" for none.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").driven_by(link="rocker", relative_to="ground")
    >>> limits = bar.family({"O2 A": [40, 42]}).sweep().limits
    >>> limits.lower.round(2), limits.lower_kind
    (array([54.9 , 52.03]), array(['dead point', 'dead point'], dtype='<U12'))
    """

    lower: Array
    upper: Array
    lower_kind: AnyArray
    upper_kind: AnyArray

    def __post_init__(self) -> None:
        for name in ("lower", "upper", "lower_kind", "upper_kind"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @classmethod
    def of(cls, limits: Array, kinds: StatusArray, unit: float) -> FamilyLimits:
        """Limits from values (2, D) and codes (2, D); ``unit``: internal units per file unit."""
        words = np.array(["" if kind is None else kind.word for kind in LIMIT_KINDS])
        lower, upper = limits / unit
        lower_kind, upper_kind = words[kinds]
        return cls(lower=lower, upper=upper, lower_kind=lower_kind, upper_kind=upper_kind)

    def __len__(self) -> int:
        return len(self.lower)

    def __repr__(self) -> str:
        ends = np.concatenate([self.lower_kind, self.upper_kind])
        told = ", ".join(
            f"{int((ends == kind.word).sum())} {kind.word}s" for kind in LIMIT_KINDS if kind
        )
        return f"<FamilyLimits of {len(self)} designs: {told}>"


# ----------------------------------------------------------------------
# Sweep single designs one after the other.


def _at_shared_inputs(designs: Designs, k: int) -> Model:
    """A single design with the family's table, in case its own table depends on varied numbers."""
    base, model = designs.base, designs.design(k)
    # a range given by formulas of dimensions can differ from design to design
    if np.array_equal(model.rows_in_file_units, base.rows_in_file_units):
        return model
    return with_table(model, base)


def with_table(model: Model, base: Model, parts: int = 1) -> Model:
    """A mechanism with the table of another one, whose steps are divided into parts."""
    inputs = tuple(_with_plain_range(base, which, parts) for which in base.description.inputs)
    return replace(model, description=replace(model.description, inputs=inputs))


def _with_plain_range(base: Model, which: Input, parts: int) -> Input:
    rows = base.description.rows(which).tolist()
    step = (rows[-1] - rows[0]) / max(1, parts * (len(rows) - 1))
    return replace(which, from_=rows[0], to=rows[-1], step=step or None)


def leave_open(designs: Designs, which: IndexArray, found: DesignRows) -> None:
    """The rows of designs (W,) that have no position at the start, as their sweeps leave them."""
    base = designs.base
    rows = SolvedRows.blank(
        base.rows_in_file_units, base.compiled.solver.variables, Status.NO_START
    )
    found.alone[which] = True
    found.v[:, :, which] = found.radius[:, which] = np.nan
    found.status[:, which] = Status.NO_START.code
    found.certification[:, which] = Certification.NO_POSITION.code
    found.own.update(dict.fromkeys(which.tolist(), rows))


def sweep_single(designs: Designs, k: int, found: DesignRows, certify: bool) -> None:
    """Sweep one design by :mod:`linkwork.core.motion.sweeping`."""
    found.alone[k] = True
    try:
        rows, ends = sweep_rows(_at_shared_inputs(designs, k), certify=certify)
    except LinkworkError:  # reported by ``message_single``
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
    found.own[k] = rows
    _note_way(designs.base, k, rows, ends, found)


def _note_way(
    base: Model, k: int, rows: SolvedRows, ends: tuple[BranchEnd, ...], found: DesignRows
) -> None:
    """Store the whole turns to the rows of a design swept alone, and its limits."""
    if not (rows.status == Status.CONVERGED.code).any():
        return
    found.limits[:, k] = -np.inf, np.inf
    for end in ends:
        which = int(end.side > 0.0)
        found.limits[which, k] = end.t if end.limit.located else np.nan
        found.limit_kinds[which, k] = LIMIT_KINDS.index(end.limit.kind)
    if base.equations.inputs[0].kind == "angle":
        # a row reached in the other direction has an input whole turns away
        gap = (rows.v[:, len(found.v)] - base.rows[:, 0]) / FULL_TURN
        found.turns[:, k] = np.round(np.where(np.isnan(gap), 0.0, gap))


def single_motion(designs: Designs, k: int, found: DesignRows) -> Motion:
    """The motion of a design swept alone."""
    model, rows = _at_shared_inputs(designs, k), found.own[k]
    motion = motion_of_rows(model, rows, "", np.zeros(len(rows), dtype=bool))
    return replace(motion, between=RowsBetween(model, rows))


def message_single(designs: Designs, k: int) -> str:
    """The message of a design's motion, or the reason why it has none."""
    try:
        return sweep(_at_shared_inputs(designs, k), certify=False).message
    except LinkworkError as error:
        return str(error)


# ----------------------------------------------------------------------
# Solve designs over a table of inputs: by compiled kernels, the remaining ones one by one.


_ON_PATH = 1e-12  # relative: a start so near to the table's line lies on it


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

    def march(self, designs: Designs, certify: bool, threads: int, execution: Execution) -> Any:
        """The march of designs that start on the path or can be moved to it."""
        march = wings.use("families.family_march").FamilyMarch
        return march(self, designs, self.starts_of(designs)[1], certify, threads, execution)

    def starts_of(self, designs: Designs) -> tuple[Array, BoolArray]:
        """Where designs start, values of t (D,), and which of them start on the path (D,)."""
        inputs = designs.start[:, self.model.compiled.solver.unknowns :]
        start = inputs[:, self.lead]
        away = np.abs(inputs - (self.origin + self.rate * start[:, None]))
        return start, np.all(away <= _ON_PATH * np.maximum(1.0, np.abs(inputs)), axis=1)

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


_LONG = 1.0  # seconds from which on compiled code is worth its installation
_FASTER = 5.0  # times, in one thread; designs swept alone gain far more
_OFFERED: list[bool] = []  # once in a process


def _fill(
    path: TablePath,
    designs: Designs,
    found: DesignRows,
    certify: bool,
    threads: int,
    execution: Execution,
) -> BoolArray:
    """Fill in the designs that reach all rows, by compiled code or with arrays; their mask."""
    if has_compiler():
        return path.fill(designs, found, certify, threads, execution)
    found.clear(np.ones(found.status.shape, dtype=bool), certify)
    done: BoolArray = wings.use("families.array_march").fill(path, designs, found, certify)
    return done


def _offer_compiler(positions: int, seconds: float) -> None:
    """Say how long compiled code would take, once."""
    if seconds < _LONG or _OFFERED or has_compiler():
        return
    _OFFERED.append(True)
    logging.getLogger("linkwork").warning(
        "%s positions took %.1f s; with the extra fast they take about %.1f s: "
        'pip install "linkwork[fast]", or ".[fast]" in a clone',
        f"{positions:,}",
        seconds,
        seconds / _FASTER,
    )


def design_rows(
    designs: Designs, *, certify: bool, threads: int = 1, execution: Execution | None = None
) -> DesignRows:
    """Solve every design over the rows of the mechanism's table, on the branch of its start.

    The compiled march handles loop and linear equations; designs that it cannot complete (dead
    points, change points, no position at the start) and mechanisms with other equations are swept
    one at a time, so every row has the same status as in a single sweep.
    """
    model, begin = designs.base, perf_counter()
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
        left &= ~_fill(path, designs, found, certify, threads, execution or Execution())
        # most of those without a start need not be built to be tried
        if left.any():
            open_ones = left & stay_open(designs)
            leave_open(designs, np.flatnonzero(open_ones), found)
            left &= ~open_ones
    for k in np.flatnonzero(left):
        sweep_single(designs, int(k), found, certify)
    if path is not None:
        _offer_compiler(found.status.size, perf_counter() - begin)
    return found.freeze()
