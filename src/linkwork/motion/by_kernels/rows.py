"""Rows of one mechanism computed by the compiled kernels.

A kernel computes rows along a straight path of inputs from one known position. It predicts them
from each other, proves every position, and proves that no branch was changed on the way. This
module loads compiled code.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, CountArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.kernels.march.position_programs import along_rows
from linkwork.kernels.march.sweep_kernel import Steps
from linkwork.kernels.program.execution import Execution
from linkwork.motion.by_kernels.equations import own_coefficients, zero_names
from linkwork.motion.by_kernels.kernels import kernel_of, row_program_of
from linkwork.motion.drive import Drive
from linkwork.numerics.continuation.branch_tracking import Node
from linkwork.numerics.rows import SolvedRows

__all__ = ["kernel_rows"]

_TWICE = 1e-6  # of the distance between rows: values of t so near to each other are refused


def kernel_rows(drive: Drive, anchor: Node, t: Array, spread: Array) -> SolvedRows | None:
    """Proved rows at values of t (B,), all joined to the anchor by proved steps.

    ``None`` where the kernels do not find all of them.

    Parameters
    ----------
    spread : (p,)
        How far inputs may be from their exact values, besides their rounding.
    """
    times, place = np.unique(np.append(t, anchor.t), return_inverse=True)
    gaps = np.diff(times)
    if len(gaps) and gaps.min() <= _TWICE * gaps.mean():
        return None
    model, path, n = drive.model, drive.path, drive.solver.unknowns
    coefficients = own_coefficients(model)
    zeros = zero_names(coefficients)
    for j, (origin, rate) in enumerate(zip(path.origin, path.rate, strict=True)):
        own = {"origin": origin, "rate": rate, "spread": spread[j]}
        coefficients |= {f"u{j}.{name}": np.array([value]) for name, value in own.items()}
    kernel = kernel_of(model, zeros, True)
    kernel.choose_execution(Execution(positions=len(times)))
    steps = Steps().times(path.size)
    march = kernel.prepare_single(coefficients, anchor.v[:n], anchor.t, times, steps)
    done = march.run()
    if done is None:
        return None
    v = np.vstack([done[0][:, :, 0], path.at(times).T])
    read = along_rows(row_program_of(model, zeros, True), coefficients, v)
    rows = _solved(read, v, path.rate, march.counts)
    # the only solution so near to its row at the anchor's own place has to be the anchor
    here = int(place[-1])
    away = float((np.abs(rows.v[here] - anchor.v) / drive.solver.variable_scale).max())
    proved = np.isfinite(rows.radius).all() and away < float(rows.uniqueness_radius[here])
    return rows.take(place[:-1]) if proved else None


def _solved(read: Array, v: Array, rate: Array, counts: CountArray) -> SolvedRows:
    """The values that the row program gives at positions v (N, R)."""
    rows, inputs = v.shape[1], len(rate)
    n = len(v) - inputs
    moving = np.repeat(rate[:, None], rows, axis=1)
    condition, residual, radius, uniqueness_radius = read[2 * n :]
    return SolvedRows(
        v=v.T,
        first=np.concatenate([read[:n], moving]).T,
        second=np.concatenate([read[n : 2 * n], np.zeros_like(moving)]).T,
        status=np.full(rows, Status.CONVERGED.code, dtype=np.int8),
        condition=condition,
        residual=residual,
        iterations=counts,
        certification=np.full(rows, Certification.CERTIFIED.code, dtype=np.int8),
        radius=radius,
        uniqueness_radius=uniqueness_radius,
    )
