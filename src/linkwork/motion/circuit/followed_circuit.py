"""The circuit of one position, followed only as far as a question about it needs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.rounding import REGULAR_CONDITION
from linkwork.motion.circuit.arcs import Explorer, positions_at_value
from linkwork.motion.circuit.walks import Walks
from linkwork.motion.curve_branches import CurveBranch
from linkwork.motion.drive import Drive
from linkwork.numerics.continuation.local_parametrization import Parametrizations, same_position

__all__ = ["FollowedCircuit", "is_regular"]


class FollowedCircuit:
    """The circuit through a position at which the input can lead.

    Parameters
    ----------
    drive : Drive
    start : (N,)
    """

    def __init__(self, drive: Drive, start: Array) -> None:
        self.leads = drive.leads
        self._explorer = Explorer(Walks(drive, certify=False))
        self._further = self._explorer.follow(start)

    def branches(self) -> Iterator[CurveBranch]:
        """All branches; those behind a change point are followed when they are asked for."""
        number = 0
        while number < len(self._explorer.arcs) or next(self._further, None) is not None:
            arc = self._explorer.arcs[number]
            number += 1
            # where redundant links do not fit, nothing moves along the arc
            if self._explorer.fits(arc):
                yield from arc.branches

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
