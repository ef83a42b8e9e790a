"""The circuit of one position, followed only as far as a question about it needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.rounding import REGULAR_CONDITION
from linkwork.foundation.status import CONVERGED
from linkwork.motion.circuit.arcs import Arc, Explorer, positions_at_value
from linkwork.motion.circuit.walks import Walks
from linkwork.motion.curve_branches import CurveBranch
from linkwork.motion.drive import Drive
from linkwork.motion.redundancy import FITS, misfit
from linkwork.motion.tracking import track_to
from linkwork.numerics.continuation.branch_tracking import node_at, rows_on_track
from linkwork.numerics.continuation.local_parametrization import (
    Parametrizations,
    coincide,
    same_position,
)

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

    Attributes
    ----------
    arcs, known : list of Arc, list of CurveBranch
        Its curves between change points, and their branches, as far as they are followed.
    ended : bool
        Whether no other arc is left to follow.
    """

    def __init__(self, drive: Drive, start: Array) -> None:
        self.leads = drive.leads
        self.arcs: list[Arc] = []
        self.known: list[CurveBranch] = []
        self.ended = False
        self._explorer = Explorer(Walks(drive, certify=False, prove_turns=False))
        self._further = self._explorer.follow(start)
        self._apart: list[Arc] = []

    def follow_next(self) -> bool:
        """Follow one more of the arcs that change points may join; whether there was one."""
        number = next(self._further, None)
        self.ended = number is None or not self._explorer.crossings
        if number is not None and self._explorer.fits(self._explorer.arcs[number]):
            self._apart.append(self._explorer.arcs[number])
            self._join_arcs()
        return number is not None

    def _join_arcs(self) -> None:
        """Take over the arcs that meet those of the circuit: none through an arc that does not fit,
        on which nothing can move.
        """
        joined = True
        while joined and self._apart:
            met = {crossing for arc in self.arcs for crossing in arc.crossings}
            joined = False
            for arc in list(self._apart):
                if arc is self._explorer.arcs[0] or met.intersection(arc.crossings):
                    self._apart.remove(arc)
                    self.arcs.append(arc)
                    self.known += arc.branches
                    joined = True

    def branches(self) -> Iterator[CurveBranch]:
        """All branches; those behind a change point are followed when they are asked for."""
        number = 0
        while number < len(self.known) or self.follow_next():
            yield from self.known[number : number + 1]
            number = min(number + 1, len(self.known))

    @property
    def is_open(self) -> bool:
        """Whether a curve of the circuit, as far as it is followed, was given up on its way."""
        given_up = (CircuitEnd.NEVER_CLOSES, CircuitEnd.SINGULAR)
        return any(arc.end in given_up for arc in self.arcs)

    @property
    def is_whole(self) -> bool:
        """Whether all of it is followed."""
        return self.ended and not self.is_open

    def meets(self, other: FollowedCircuit) -> bool:
        """Whether both have a change point in common, as far as they are followed."""
        mine, theirs = self._crossings(), other._crossings()
        return any(coincide(self.leads, v, w) for v in mine for w in theirs)

    def _crossings(self) -> list[Array]:
        met = {crossing for arc in self.arcs for crossing in arc.crossings}
        return [self._explorer.crossings[number].v for number in met]

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
