"""Solved rows as a motion: every quantity by its name, in file units."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import BoolArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import name_series
from linkwork.motion.redundancy import FITS, largest_misfits, misfit
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion

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
    """Rows at which redundant links fit; the others have no position."""
    if not model.equations.redundant:
        return rows
    fits = misfit(model.equations, rows.v) <= FITS
    lost = (rows.status == Status.CONVERGED.code) & ~fits
    nothing = SolvedRows.blank(rows.inputs[lost], rows.v.shape[1], Status.DOES_NOT_FIT)
    return rows.put(np.flatnonzero(lost), nothing).demote(Certification.SUBSET_CERTIFIED)


def message_of(motion: Motion) -> str:
    """The message of the start if all rows were found, else every limit once."""
    asked = motion.asked
    missing = int((asked & ~motion.found).sum())
    if not missing:
        return motion.message
    name, unit = next(iter(motion.input_units.items()))
    told = (f"{limit.kind.word} at {limit.told(name, unit)}" for limit in motion.limits)
    misses = [status.value for status in motion.counts if not status.ok]
    return "; ".join(
        [f"{missing} of {int(asked.sum())} positions were not found", *misses, *dict.fromkeys(told)]
    )
