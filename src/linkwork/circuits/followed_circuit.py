"""The circuit of one position, followed only as far as a question about it needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.circuits.arcs import Arc, Explorer, is_regular, positions_at_value
from linkwork.circuits.branches import CurveBranch
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.statuses import CONVERGED, CircuitEnd, Status
from linkwork.core.motion.following import Drive, track_to
from linkwork.core.motion.model import FITS, misfit
from linkwork.core.numerics.branch_tracking import node_at, rows_on_track
from linkwork.core.numerics.local_parametrization import same_position


@dataclass(frozen=True, kw_only=True, eq=False)
class StraightWay:
    """A branch over some values of the input, followed without turning back.

    ``v`` (K, N): the positions at the values, NaN where the branch ends before; ``low`` and
    ``high``: the input at its dead points, infinite where it was not followed to one.
    """

    v: Array
    low: float
    high: float


def straight_way(drive: Drive, start: Array, values: Sequence[float]) -> StraightWay | None:
    """The branch of a position (N,) between the least and the greatest of K values of the input.

    ``None`` if it was lost on the way or ends at a change point, if a position at a value was not
    found, or if redundant links do not fit along it.
    """
    solver, t = drive.solver, np.array(values)
    node = node_at(solver, drive.path, float(start[drive.leads.parameter]), start)
    track = track_to(solver, drive.path, node, values)
    if any(end.status is not Status.OUT_OF_REACH for end in track.ends):
        return None
    v = np.full((len(t), len(start)), np.nan)
    inside = np.flatnonzero((t >= track.first_t) & (t <= track.last_t))
    if len(inside):
        rows = rows_on_track(solver, drive.path, track, t[inside])
        if not (rows.status == CONVERGED).all():
            return None
        v[inside] = rows.v
    way = np.concatenate([np.stack([node.v for node in track.nodes]), v[inside]])
    if (misfit(drive.model.equations, way) > FITS).any():
        return None
    low = -np.inf if track.below is None else track.first_t
    high = np.inf if track.above is None else track.last_t
    return StraightWay(v=v, low=low, high=high)


def explorer_of(drive: Drive) -> Explorer:
    """The arcs that all circuits of a question have in common, none followed yet."""
    return Explorer(drive, certify=False, prove_turns=False)


class FollowedCircuit:
    """The circuit through a position at which the input can lead.

    Parameters
    ----------
    explorer : Explorer
        With the arcs that other circuits have followed: each is followed once.
    start : (N,)

    Attributes
    ----------
    arcs, known : list of Arc, list of CurveBranch
        Its curves between change points, and their branches, as far as they are followed.
    """

    def __init__(self, explorer: Explorer, start: Array) -> None:
        self.leads = explorer.leads
        self.arcs: list[Arc] = []
        self.known: list[CurveBranch] = []
        self._explorer = explorer
        self._first = explorer.arc_through(start)
        self._seen: set[int] = set()
        self._crossings: dict[int, None] = {}
        self.join_arcs()

    def follow_next(self) -> bool:
        """Take over one more of the arcs that change points may join; whether there was one."""
        known = len(self.arcs)
        # in case that another circuit has followed it
        self.join_arcs()
        if len(self.arcs) > known:
            return True
        found = any(self._explorer.branch_off(number) for number in self._crossings)
        self.join_arcs()
        return found

    def join_arcs(self) -> None:
        """Take over the arcs that meet those of the circuit: none through an arc that does not fit,
        on which nothing can move.
        """
        joined = True
        while joined:
            joined = False
            for number, arc in enumerate(self._explorer.arcs):
                meets = number == self._first or not self._crossings.keys().isdisjoint(
                    arc.crossings
                )
                if meets and number not in self._seen:
                    self._seen.add(number)
                    if self._explorer.fits(arc):
                        self.arcs.append(arc)
                        self.known += arc.branches
                        self._crossings.update(dict.fromkeys(arc.crossings))
                        joined = True

    def branches(self) -> Iterator[CurveBranch]:
        """All branches; those behind a change point are followed when they are asked for."""
        number = 0
        while number < len(self.known) or self.follow_next():
            yield from self.known[number : number + 1]
            number = min(number + 1, len(self.known))

    @property
    def ended(self) -> bool:
        """Whether no other arc is left to follow."""
        return not any(self._explorer.half_branches(number) for number in self._crossings)

    @property
    def is_open(self) -> bool:
        """Whether a curve of the circuit, as far as it is followed, was given up on its way."""
        given_up = (CircuitEnd.NEVER_CLOSES, CircuitEnd.SINGULAR)
        return any(arc.end in given_up for arc in self.arcs)

    @property
    def is_whole(self) -> bool:
        """Whether all of it is followed."""
        return self.ended and not self.is_open

    def has(self, v: Array) -> bool:
        """Whether a position (N,) lies on it, as far as it is followed."""
        number = self._explorer.known_arc(v)
        return number is not None and self._explorer.arcs[number] in self.arcs

    def meets(self, other: FollowedCircuit) -> bool:
        """Whether both have an arc in common, as far as they are followed."""
        return any(arc in other.arcs for arc in self.arcs)

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
