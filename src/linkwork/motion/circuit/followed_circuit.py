"""The circuit of one position, followed only as far as a question about it needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.rounding import REGULAR_CONDITION
from linkwork.foundation.status import CONVERGED
from linkwork.motion.circuit.arcs import Explorer, positions_at_value
from linkwork.motion.circuit.walks import Walks
from linkwork.motion.curve_branches import CurveBranch
from linkwork.motion.drive import Drive
from linkwork.motion.redundancy import FITS, misfit
from linkwork.motion.tracking import track_to
from linkwork.numerics.continuation.branch_tracking import node_at, rows_on_track
from linkwork.numerics.continuation.local_parametrization import Parametrizations, same_position

__all__ = ["FollowedCircuit", "is_regular", "straight_way"]


def straight_way(drive: Drive, start: Array, values: Sequence[float]) -> Array | None:
    """The positions (K, N) at values of the input on the branch of a position (N,).

    ``None`` if the branch, followed straight to the least and the greatest value, ends before, or
    redundant links do not fit along it.
    """
    solver, t = drive.solver, np.array(values)
    node = node_at(solver, drive.path, float(start[drive.leads.parameter]), start)
    track = track_to(solver, drive.path, node, values)
    if track.ends:
        return None
    rows = rows_on_track(solver, drive.path, track, t)
    way = np.concatenate([np.stack([node.v for node in track.nodes]), rows.v])
    if not (rows.status == CONVERGED).all() or (misfit(drive.model.equations, way) > FITS).any():
        return None
    return rows.v


class FollowedCircuit:
    """The circuit through a position at which the input can lead.

    Parameters
    ----------
    drive : Drive
    start : (N,)
    """

    def __init__(self, drive: Drive, start: Array) -> None:
        self.leads = drive.leads
        self._explorer = Explorer(Walks(drive, certify=False, prove_turns=False))
        self._further = self._explorer.follow(start)
        self._branches: list[CurveBranch] = []

    def branches(self) -> Iterator[CurveBranch]:
        """All branches; those behind a change point are followed when they are asked for."""
        yield from self._branches
        while (number := next(self._further, None)) is not None:
            arc = self._explorer.arcs[number]
            # where redundant links do not fit, nothing moves along the arc
            if self._explorer.fits(arc):
                begin = len(self._branches)
                self._branches += arc.branches
                yield from self._branches[begin:]

    @property
    def is_open(self) -> bool:
        """Whether a curve of the circuit, as far as it is followed, was given up on its way."""
        return any(
            arc.end in (CircuitEnd.NEVER_CLOSES, CircuitEnd.SINGULAR) for arc in self._explorer.arcs
        )

    def branch_of(self, v: Array) -> CurveBranch | None:
        """The branch with a position (N,) at which the input can lead."""
        return next((branch for branch in self.branches() if self.lies_on(branch, v)), None)

    def lies_on(self, branch: CurveBranch, v: Array) -> bool:
        """Whether a position (N,) at which the input can lead is one of a branch."""
        places = self.positions(branch, float(v[self.leads.parameter]))
        return any(same_position(self.leads, place, v) for place in places)

    def positions(self, branch: CurveBranch, value: float) -> list[Array]:
        """The positions (N,) of a branch at a value of the input, modulo whole turns."""
        found = positions_at_value(self.leads, branch, value)
        own = self.leads.with_parameter(self.leads.parameter)
        if own is None or not found or not is_regular(self.leads, branch.anchor):
            return found
        # next to a dead point Newton-Raphson may come onto the branch beyond it, where det J has
        # another sign
        side = own.node(branch.anchor).orientation
        return [v for v in found if np.array_equal(own.node(v).orientation, side)]


def is_regular(leads: Parametrizations, v: Array) -> bool:
    """Whether the input can lead at a position (N,): not at dead points and change points."""
    own = leads.with_parameter(leads.parameter)
    return own is not None and own.node(v).nearness < REGULAR_CONDITION
