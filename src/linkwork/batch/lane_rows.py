"""Designs over a table of inputs by the compiled march; what it leaves open, one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.foundation.arrays import Array, BoolArray, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import LinkworkError
from linkwork.foundation.status import Status
from linkwork.kernels.lanes.closure import BlockPart
from linkwork.kernels.lanes.lane_kernel import LaneKernel, LaneRows, Steps
from linkwork.motion import sweep
from linkwork.motion.drive import Drive
from linkwork.motion.lock_step import lock_step
from linkwork.motion.model import Model

__all__ = ["DesignRows", "design_rows"]

_ON_PATH = 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRows:
    """D designs over R rows of inputs, internal units.

    ``v`` (n, R, D): unknowns, NaN where there is no position. ``status``, ``certification``
    (R, D): codes. ``radius`` (R, D): of the proof, weighted; NaN without one.
    ``alone`` (D,): designs that were computed one at a time.
    """

    v: Array
    status: StatusArray
    certification: StatusArray
    radius: Array
    alone: BoolArray

    @classmethod
    def blank(cls, unknowns: int, rows: int, designs: int, certify: bool) -> DesignRows:
        """No positions yet; unknowns are left as they come."""
        none = Certification.NO_POSITION if certify else Certification.NOT_ASKED
        return cls(
            v=np.empty((unknowns, rows, designs)),
            status=np.full((rows, designs), Status.NO_START.code, dtype=np.int8),
            certification=np.full((rows, designs), none.code, dtype=np.int8),
            radius=np.full((rows, designs), np.nan),
            alone=np.zeros(designs, dtype=bool),
        )


def design_rows(designs: Designs, *, certify: bool, threads: int = 1) -> DesignRows:
    """Every design over the rows of the mechanism's table, on the branch of its own start.

    The compiled march serves equations of loops and lines; designs that it cannot lead through
    all rows (dead points, change points, no position at the start) and mechanisms with other
    equations are swept one at a time, so that every row has the status that it has by itself.
    """
    model = designs.base
    found = DesignRows.blank(model.compiled.solver.unknowns, len(model.rows), len(designs), certify)
    left = designs.problem == 0
    march = _Path.of(model)
    if march is None:
        found.v[:] = np.nan
    else:
        left &= ~march.fill(designs, found, certify, threads)
    for k in np.flatnonzero(left):
        _alone(designs, int(k), found, certify)
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class _Path:
    """The straight line through the table's inputs: u = origin + rate t."""

    model: Model
    lead: int
    origin: Array
    rate: Array

    @classmethod
    def of(cls, model: Model) -> _Path | None:
        """``None`` where the compiled march does not serve."""
        table = model.compiled.table
        if table.functions or model.equations.redundant or not len(model.equations.inputs):
            return None
        lead, rate = lock_step(model.rows)
        drive = Drive.through(model, model.rows[0], rate, lead)
        return cls(model=model, lead=lead, origin=drive.path.origin, rate=drive.path.rate)

    def fill(self, designs: Designs, found: DesignRows, certify: bool, threads: int) -> BoolArray:
        """Designs that went through all rows are filled in; which they are, (D,)."""
        n = self.model.compiled.solver.unknowns
        inputs = designs.start[:, n:]
        start = inputs[:, self.lead]
        away = np.abs(inputs - (self.origin + self.rate * start[:, None]))
        served = (designs.problem == 0) & (away <= _ON_PATH * np.maximum(1.0, np.abs(inputs))).all(
            axis=1
        )
        t = self.model.rows[:, self.lead]
        way = slice(None, None, -1 if t[-1] < t[0] else 1)
        radius = found.radius[way] if certify else found.radius[:0]
        rows = LaneRows.over(found.v[:, way], radius)
        kernel, coefficients = self._kernel(designs, certify)
        guess = np.where(served, designs.start[:, :n].T, np.nan)  # not found, so not followed
        kernel.run(coefficients, guess, start, t[way].copy(), Steps(), rows, threads)
        whole: BoolArray = np.logical_and.reduce(rows.reached, axis=0)
        reached = rows.reached[way]
        found.v[:, ~reached] = np.nan
        found.status[reached] = Status.CONVERGED.code
        if certify:
            found.certification[reached] = Certification.CERTIFIED.code
        return whole

    def _kernel(self, designs: Designs, certify: bool) -> tuple[LaneKernel, dict[str, Array]]:
        compiled = self.model.compiled
        coefficients: dict[str, Array] = {}
        for term in range(designs.loops.shape[1]):
            column = designs.loops[:, term]
            coefficients[f"c{term}.re"] = np.ascontiguousarray(column.real)
            coefficients[f"c{term}.im"] = np.ascontiguousarray(column.imag)
        for row in range(designs.linear.shape[1]):
            coefficients[f"k{row}"] = np.ascontiguousarray(designs.linear[:, row])
        zeros = {name for name, values in coefficients.items() if not values.any()}
        length = designs.length_scale
        for k, turns in enumerate(compiled.table.turns):
            if not turns:
                coefficients[f"scale{k}"] = length
        for j, (origin, rate) in enumerate(zip(self.origin, self.rate, strict=True)):
            coefficients[f"u{j}.origin"] = np.full(len(designs), origin)
            coefficients[f"u{j}.rate"] = np.full(len(designs), rate)
        parts = [
            BlockPart(equations=block.equations, unknowns=tuple(block.unknowns.tolist()))
            for block in compiled.solver.blocks
        ]
        return LaneKernel(compiled.table, parts, zeros, certify), coefficients


def _alone(designs: Designs, k: int, found: DesignRows, certify: bool) -> None:
    """One design by the ordinary sweep."""
    found.alone[k] = True
    try:
        motion = sweep(designs.design(k), certify=certify)
    except LinkworkError:  # what is wrong with it is told by ``designs.message``
        found.v[:, :, k] = found.radius[:, k] = np.nan
        found.status[:, k] = Status.NO_START.code
        none = Certification.NO_POSITION if certify else Certification.NOT_ASKED
        found.certification[:, k] = none.code
        return
    asked = ~motion.added
    found.v[:, :, k] = motion.q[asked].T
    found.status[:, k] = [s.code for s, a in zip(motion.status, asked, strict=True) if a]
    found.certification[:, k] = [
        c.code for c, a in zip(motion.certification, asked, strict=True) if a
    ]
    found.radius[:, k] = motion.radius[asked]
