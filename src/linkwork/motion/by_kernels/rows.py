"""Long tables of one mechanism computed by the compiled kernels.

A track has been followed to the ends of the table. The kernels compute the rows along it, which
they predict from each other and prove from each other; the row next to every node of the track is
solved along the track too, and has to be the same position. This module loads compiled code.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.kernels.march.position_programs import along_rows
from linkwork.kernels.march.sweep_kernel import Steps
from linkwork.kernels.program.execution import Execution
from linkwork.motion.by_kernels.equations import own_coefficients, zero_names
from linkwork.motion.by_kernels.kernels import kernel_of, row_program_of
from linkwork.motion.drive import Drive
from linkwork.numerics.continuation.branch_tracking import Node, Track
from linkwork.numerics.rows import SolvedRows

__all__ = ["KernelRows", "kernel_rows"]

_FINE = 32  # rows: a track with steps as short as that comes near to its end
_TWICE = (
    1e-6  # of the distance between rows: two rows so near to each other are one row, listed twice
)
_SAME_POSITION = 1e-9  # weighted: positions nearer to each other are one


@dataclass(frozen=True, kw_only=True, eq=False)
class KernelRows:
    """Some rows of a table along a track.

    ``where`` (R,): which rows they are. ``checked`` (C,): rows of the table that have to be solved
    along the track, among them all that are not here.
    """

    where: IndexArray
    rows: SolvedRows
    checked: IndexArray

    def put_into(
        self, found: SolvedRows, there: IndexArray, weights: Array, certify: bool
    ) -> SolvedRows | None:
        """Rows with those filled that are not there yet; ``None`` if checked ones are not the same.

        Parameters
        ----------
        found : SolvedRows
            With the rows that are checked, proved if ``certify``.
        there : (B,)
            Where the rows of the table are in ``found``.
        weights : (N,)
            Of the variables.
        """
        mine = np.flatnonzero(np.isin(self.where, self.checked))
        place = there[self.where[mine]]
        away = (np.abs(found.v[place] - self.rows.v[mine]) / weights).max(axis=1)
        same = (found.status[place] == Status.CONVERGED.code) & (away <= _SAME_POSITION)
        if certify:
            same &= found.certification[place] == Certification.CERTIFIED.code
            same &= away + self.rows.radius[mine] < found.uniqueness_radius[place]
            same &= bool(np.isfinite(self.rows.radius).all())
        if not same.all():
            return None
        fresh = np.delete(np.arange(len(self.where)), mine)
        return found.put(there[self.where[fresh]], self.rows.take(fresh))


def kernel_rows(
    drive: Drive, track: Track, t: Array, spread: Array, certify: bool
) -> KernelRows | None:
    """Rows at rising values of t (B,) on a track; ``None`` where kernels are not the way.

    Parameters
    ----------
    spread : (p,)
        How far inputs may be from their exact values, besides their rounding.
    """
    where = _inner(track, t)
    rows = t[where]
    if len(rows) < _FINE:
        return None
    model, path, n = drive.model, drive.path, drive.solver.unknowns
    coefficients = own_coefficients(model)
    zeros = zero_names(coefficients)
    for j, (origin, rate) in enumerate(zip(path.origin, path.rate, strict=True)):
        own = {"origin": origin, "rate": rate, "spread": spread[j]}
        coefficients |= {f"u{j}.{name}": np.array([value]) for name, value in own.items()}
    kernel = kernel_of(model, zeros, certify)
    kernel.choose_execution(Execution(positions=len(rows)))
    nearest, begin = _nearest(track, rows)
    steps = Steps().times(path.size)
    march = kernel.prepare_single(coefficients, begin.v[:n], begin.t, rows, steps)
    done = march.run()
    if done is None:
        return None
    v = np.vstack([done[0][:, :, 0], path.at(rows).T])
    read = along_rows(row_program_of(model, zeros, certify), coefficients, v)
    moving = np.repeat(path.rate[:, None], len(rows), axis=1)
    unproved = np.full((0 if certify else 2, len(rows)), np.nan)
    condition, residual, radius, uniqueness_radius = np.concatenate([read[2 * n :], unproved])
    proof = Certification.CERTIFIED if certify else Certification.NOT_ASKED
    return KernelRows(
        where=where,
        rows=SolvedRows(
            v=v.T,
            first=np.concatenate([read[:n], moving]).T,
            second=np.concatenate([read[n : 2 * n], np.zeros_like(moving)]).T,
            status=np.full(len(rows), Status.CONVERGED.code, dtype=np.int8),
            condition=condition,
            residual=residual,
            iterations=march.counts,
            certification=np.full(len(rows), proof.code, dtype=np.int8),
            radius=radius,
            uniqueness_radius=uniqueness_radius,
        ),
        checked=np.setdiff1d(np.arange(len(t)), np.delete(where, nearest)),
    )


def _inner(track: Track, t: Array) -> IndexArray:
    """Rows away from the track's ends, without the first, the last, and repeated rows."""
    times, gap = _times(track), (t[-1] - t[0]) / (len(t) - 1)
    coarse = np.flatnonzero(np.diff(times) >= _FINE * gap)
    if not len(coarse):
        return np.zeros(0, dtype=np.intp)
    inside = (np.diff(t, prepend=t[0]) > _TWICE * gap) & (t < t[-1])
    inside &= (t >= times[coarse[0]]) & (t <= times[coarse[-1] + 1])
    return np.flatnonzero(inside)


def _nearest(track: Track, rows: Array) -> tuple[IndexArray, Node]:
    """The rows next to the track's nodes, and the node that is nearest to a row."""
    times = _times(track)
    behind = np.searchsorted(rows, times).clip(1, len(rows) - 1)
    nearest = behind - (times - rows[behind - 1] < rows[behind] - times)
    closest = int(np.abs(rows[nearest] - times).argmin())
    return np.unique(nearest), track.nodes[closest]


def _times(track: Track) -> Array:
    return np.array([node.t for node in track.nodes])
