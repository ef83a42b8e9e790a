"""Solved rows as a motion: every quantity by its name, in file units."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import BoolArray, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import name_series
from linkwork.motion.redundancy import FITS, has_corners, largest_misfits, misfit
from linkwork.numerics.proof.position_proof import roots_proved
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Limit, Motion

__all__ = ["fitting", "message_of", "motion_of_rows"]


def motion_of_rows(model: Model, rows: SolvedRows, message: str, added: BoolArray) -> Motion:
    """Name the columns of solved rows; ``added`` marks rows that were not asked for."""
    rows = fitting(model, rows)
    found = rows.status == Status.CONVERGED.code
    named = name_series(model, rows.v, rows.first, rows.second, rows.inputs, found)
    return Motion(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        quantities=model.quantities,
        inputs=named.inputs,
        input_units=model.input_units,
        derivative_unit=model.derivative_unit,
        unknowns=named.unknowns,
        links=named.links,
        riding=model.riding,
        sliders=named.sliders,
        points=named.points,
        outputs=named.outputs,
        status=Status.of_codes(rows.status),
        message=message,
        residual=rows.residual,
        iterations=rows.iterations,
        condition=rows.condition,
        certification=Certification.of_codes(rows.certification),
        radius=rows.radius,
        unique_within=rows.uniqueness_radius,
        branch=tuple(rows.branch),
        limit=tuple(rows.limit),
        added=added,
        speed=model.speed,
        redundant=largest_misfits(model.equations, rows.v),
        q=rows.v[:, : model.compiled.solver.unknowns],
    )


def fitting(model: Model, rows: SolvedRows) -> SolvedRows:
    """Rows with evidence of a position: roots of formulas are proved, redundant links fit."""
    if model.compiled.solver.has_formulas:
        open_ = np.flatnonzero((rows.status == Status.CONVERGED.code) & np.isnan(rows.radius))
        lost = open_[~roots_proved(model.compiled.solver, rows.v[open_])]
        rows = _without(rows, lost, Status.ROOT_NOT_PROVED)
    if has_corners(model.equations):
        rows = rows.demote(Certification.MOTION_NOT_PROVED)
    if not model.equations.redundant:
        return rows
    fits = misfit(model.equations, rows.v) <= FITS
    lost = np.flatnonzero((rows.status == Status.CONVERGED.code) & ~fits)
    rows = _without(rows, lost, Status.DOES_NOT_FIT)
    return rows.demote(Certification.SUBSET_CERTIFIED)


def _without(rows: SolvedRows, lost: IndexArray, status: Status) -> SolvedRows:
    """The rows without the positions of some, all for one reason."""
    nothing = SolvedRows.blank(rows.inputs[lost], rows.v.shape[1], status)
    return rows.put(lost, nothing)


def message_of(motion: Motion, model: Model) -> str:
    """The message of the start if all rows were found, else every limit once."""
    asked = motion.asked
    missing = int((asked & ~motion.found).sum())
    if not missing:
        return motion.message
    name, unit = next(iter(motion.input_units.items()))
    told = (
        f"{limit.kind.word} at {limit.told(name, unit)}{_driven_to(motion, model, limit)}"
        for limit in motion.limits
    )
    misses = [status.value for status in motion.counts if not status.ok]
    return "; ".join(
        [f"{missing} of {int(asked.sum())} positions were not found", *misses, *dict.fromkeys(told)]
    )


def _driven_to(motion: Motion, model: Model, limit: Limit) -> str:
    """The values of the inputs at a limit that a law of time leads to."""
    if model.untimed is None:
        return ""
    row = int(np.argmin(np.abs(motion.inputs[next(iter(motion.inputs))] - limit.input)))
    names = [variable.name for variable in model.untimed.equations.inputs]
    values = [
        f"{name} = {motion[name][row]:.10g} {motion.quantity(name).unit}".rstrip() for name in names
    ]
    return (
        f", {', '.join(values)}" if np.isfinite([motion[name][row] for name in names]).all() else ""
    )
