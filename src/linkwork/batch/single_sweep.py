"""Sweep single designs one after the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.batch.limits import ends_as_limits
from linkwork.batch.rows import DesignRows
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import LinkworkError
from linkwork.foundation.status import Status
from linkwork.mechanism.driven_input import Input
from linkwork.motion import sweep
from linkwork.motion.limits import BranchEnd
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.motion.rows_between import RowsBetween
from linkwork.motion.sweeping import sweep_rows
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion

__all__ = ["leave_open", "message_single", "single_motion", "sweep_single", "with_table"]


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
    return replace(which, start=rows[0], stop=rows[-1], step=step or None)


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
    """Sweep one design by :mod:`linkwork.motion.sweeping`."""
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
    found.limits[:, k], found.limit_kinds[:, k] = ends_as_limits(ends)
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
