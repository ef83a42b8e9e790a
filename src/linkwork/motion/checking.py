"""What was understood: loops, unknowns, blocks, mobility, and whether the start closes."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loops import Loops
from linkwork.motion.classifying.classify import block_groups, classify
from linkwork.motion.model import Model
from linkwork.motion.start import first_position
from linkwork.numerics.newton import NewtonOptions
from linkwork.results.check import BlockSummary, CheckReport
from linkwork.results.quantity import Kind

__all__ = ["check", "grubler_count"]

_LARGEST = 100  # unknowns up to which a singular mechanism is looked at as one matrix
_RANK_TOLERANCE = 1e-9  # relative to the largest singular value of the scaled Jacobian


def check(model: Model) -> CheckReport:
    """Report what was understood of a mechanism and try its start position."""
    description, equations = model.description, model.equations
    start = first_position(model, model.start_inputs, NewtonOptions())
    rank = None
    if start.status.ok:
        found = _rank(model, start.v)
        rank = None if found is None else len(equations.variables) - found
    measured: tuple[tuple[str, str, float], ...] = ()
    links = joints = 0
    count = None
    if isinstance(description, Linkage):
        form, count = "points and links", grubler_count(description)
        measured = tuple(
            (m.link, " ".join(m.points), m.length) for m in description.shapes.measured
        )
        links = len(description.links) + len(description.cylinders)
        joints = _pins(description) + len(description.sliders) + len(description.slots)
    else:
        form = "loops" if isinstance(description, Loops) else "equations"
    units = model.units
    return CheckReport(
        mechanism=description.name,
        form=form,
        links=links,
        joints=joints,
        loops=equations.labels,
        unknowns=tuple((v.name, units.of(Kind(v.kind))) for v in equations.unknowns),
        inputs=tuple((v.name, units.of(Kind(v.kind))) for v in equations.inputs),
        rows=len(model.rows) if description.inputs else 0,
        blocks=tuple(
            BlockSummary(
                equations=tuple(equations.labels[e] for e in block.equations),
                unknowns=tuple(equations.unknowns[k].name for k in block.unknowns),
                group=group,
            )
            for block, group in zip(model.compiled.solver.blocks, block_groups(model), strict=True)
        ),
        mobility_count=count,
        mobility_rank=rank,
        measured=measured,
        start=start.status,
        start_message=start.message,
        start_input={
            v.name: float(value)
            for v, value in zip(equations.inputs, model.everyday_start, strict=True)
        },
        residual=start.residual,
        failure=start.failure,
        classification=classify(model),
    )


def _pins(linkage: Linkage) -> int:
    """Revolute joints, a pin of k bodies counting k - 1."""
    return sum(max(len(bodies) - 1, 0) for bodies in linkage.carriers().values())


def grubler_count(linkage: Linkage) -> int:
    """Grübler's mobility 3(n - 1) - 2·(pins and sliders) - (slots).

    A cylinder counts as its two links and their sliding joint: one body with one freedom more.
    """
    bodies = len(linkage.links) + len(linkage.cylinders)
    lower_pairs = _pins(linkage) + len(linkage.sliders)
    return 3 * (bodies - 1) - 2 * lower_pairs - len(linkage.slots) + len(linkage.cylinders)


def _rank(model: Model, v: Array) -> int | None:
    """Rank of all equations by all variables, inputs included, scaled.

    Regular blocks have full rank together. Otherwise all equations are looked at as one matrix,
    unless that would be very large.
    """
    solver = model.compiled.solver
    full = True
    for block in solver.blocks:
        n = len(block.unknowns)
        system = block.system
        j = system.jacobian(v[None, block.variables])[0, :, :n]
        full &= _rank_of(j * system.variable_scale[:n] / system.equation_scale[:, None]) == n
    if full:
        return solver.unknowns
    if solver.unknowns > _LARGEST:
        return None
    table = model.compiled.table
    jacobian = table.jacobian(v[None, :])[0]
    return _rank_of(jacobian * table.variable_scale / table.equation_scale[:, None])


def _rank_of(scaled: Array) -> int:
    if not scaled.size:
        return 0
    return int(np.linalg.matrix_rank(scaled, tol=_RANK_TOLERANCE * np.linalg.norm(scaled, 2)))
