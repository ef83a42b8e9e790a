"""Solved rows as a motion: every quantity by its name, in everyday units."""

from __future__ import annotations

from linkwork.foundation.arrays import BoolArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.model import Model
from linkwork.motion.reading import named_series
from linkwork.motion.rows import SolvedRows
from linkwork.results.motion import Motion

__all__ = ["motion_of_rows"]


def motion_of_rows(model: Model, rows: SolvedRows, message: str, added: BoolArray) -> Motion:
    """Name the columns of solved rows; ``added`` marks rows that were not asked for."""
    found = rows.status == Status.CONVERGED.code
    named = named_series(model, rows.v, rows.first, rows.second, rows.inputs, found)
    return Motion(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        inputs=named.inputs,
        input_units=model.input_units,
        derivative_unit=model.derivative_unit,
        unknowns=named.unknowns,
        links=named.links,
        riding=model.riding,
        sliders=named.sliders,
        points=named.points,
        outputs=named.outputs,
        status=tuple(Status.of_code(int(code)) for code in rows.status),
        message=message,
        residual=rows.residual,
        iterations=rows.iterations,
        condition=rows.condition,
        certification=tuple(Certification.of_code(int(c)) for c in rows.certification),
        radius=rows.radius,
        unique_within=rows.unique,
        branch=tuple(rows.branch),
        limit=tuple(rows.limit),
        added=added,
        speed=model.speed,
        q=rows.v[:, : model.compiled.solver.unknowns],
    )
