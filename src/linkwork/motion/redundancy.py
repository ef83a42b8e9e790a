"""Check redundant conditions at the start and at every position.

The length of a redundant link is an unknown of the equations. Positions at which it does not come
out as given are no positions of the mechanism.
"""

from __future__ import annotations

import numpy as np

from linkwork.equations.compiling import Compiled
from linkwork.equations.model import LoopEquations
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import MechanismError, Problem
from linkwork.foundation.names import canonical
from linkwork.foundation.rounding import RANK_TOLERANCE
from linkwork.foundation.status import Status
from linkwork.numerics.newton import NewtonOptions

__all__ = [
    "FITS",
    "check_redundancy",
    "has_corners",
    "largest_misfits",
    "lengths_found",
    "misfit",
    "mobility_by_rank",
    "without_redundant",
]

#: Relative to the longest link: a redundant link this near to its length fits.
FITS = 1e-9


def misfit(equations: LoopEquations, v: Array) -> Array:
    """How far redundant links are from their lengths at positions v (B, N), of the longest link."""
    columns, lengths = _redundant(equations)
    if not columns:
        return np.zeros(len(v))
    gaps: Array = np.abs(v[:, columns] - lengths).max(axis=1) / equations.length_scale
    return gaps


def lengths_found(equations: LoopEquations, v: Array) -> list[float]:
    """The lengths of the redundant links at a position (N,)."""
    columns, _ = _redundant(equations)
    return [float(length) for length in v[columns]]


def largest_misfits(equations: LoopEquations, v: Array) -> dict[str, float]:
    """The same for each redundant link, the largest at any of the positions that are there."""
    columns, lengths = _redundant(equations)
    there = v[~np.isnan(v).any(axis=1)][:, columns]
    gaps = np.abs(there - lengths).max(axis=0, initial=0.0) / equations.length_scale
    links = (part.link for part in equations.redundant)
    return dict(zip(links, gaps.tolist(), strict=True))


def without_redundant(equations: LoopEquations, proved: Certification) -> Certification:
    """The certification of the mechanism from that of its equations."""
    if proved.certified and has_corners(equations):
        proved = Certification.MOTION_NOT_PROVED
    return Certification.SUBSET_CERTIFIED if equations.redundant and proved.certified else proved


def has_corners(equations: LoopEquations) -> bool:
    """Whether the speed of an input changes at once: no proof leads past that."""
    return any(law.law.corners for law in equations.laws)


def _redundant(equations: LoopEquations) -> tuple[list[int], Array]:
    """The columns of redundant lengths, and their given values."""
    number = {variable.symbol: k for k, variable in enumerate(equations.variables)}
    columns = [number[canonical(part.variable)] for part in equations.redundant]
    return columns, np.array([part.length for part in equations.redundant])


def check_redundancy(compiled: Compiled, where: str) -> None:
    """Refuse conditions too many that the others do not imply.

    Raises
    ------
    MechanismError
        If a redundant link does not fit at the start, or if with it the inputs cannot move.
    """
    equations = compiled.equations
    surplus = equations.surplus
    if not equations.redundant or surplus is None:
        return
    done = compiled.solver.solve(equations.start[None, :], NewtonOptions())
    if Status.of_code(int(done.status[0])) is not Status.CONVERGED:
        return  # said when a position is asked for
    columns, _ = _redundant(equations)
    found = done.v[0, columns]
    freedoms, inputs = mobility_by_rank(compiled, done.v[0]), len(equations.inputs)
    fits = misfit(equations, done.v)[0] <= FITS
    # several inputs may also be given values that do not belong together
    if not fits and (freedoms >= inputs or inputs < 2):
        wanted = ", ".join(
            f"{part.link} needs the length {length:.10g}, not {part.length:.10g}"
            for part, length in zip(equations.redundant, found, strict=True)
            if abs(length - part.length) > FITS * equations.length_scale
        )
        raise _refuse(surplus, f"it does not fit the sketch: {wanted}", where)
    if freedoms < inputs:
        how = f"{freedoms} degree{'s' if freedoms != 1 else ''} of freedom"
        driven = f"{inputs} input{'s' if inputs != 1 else ''}"
        raise _refuse(surplus, f"as assembled it has {how} for {driven}", where)


def _refuse(surplus: Problem, why: str, where: str) -> MechanismError:
    return MechanismError(
        [Problem(key=surplus.key, message=f"{surplus.message} ({why})", line=surplus.line)], where
    )


def mobility_by_rank(compiled: Compiled, v: Array) -> int:
    """Variables minus the rank of all equations by all variables at a position (N,)."""
    table, equations = compiled.table, compiled.equations
    scaled = table.jacobian(v[None, :])[0] * table.variable_scale / table.equation_scale[:, None]
    columns, _ = _redundant(equations)
    # a redundant length is no freedom: it has to keep its value
    scaled = np.delete(scaled, columns, axis=1)
    if not scaled.size:
        return int(scaled.shape[1])
    tolerance = RANK_TOLERANCE * np.linalg.norm(scaled, 2)
    return int(scaled.shape[1] - np.linalg.matrix_rank(scaled, tol=tolerance))  # eq. (65)
