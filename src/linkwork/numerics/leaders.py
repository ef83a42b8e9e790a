"""Leaders: the variables of a curve of positions that can be taken as known, one at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.angles import within_half_a_turn
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.track import InputPath, Node, node_at

__all__ = ["Leads", "Led", "apart", "fastest_leader", "same_position"]

_SAME = 1e-6  # weighted distance below which two positions at one input can be the same


@dataclass(frozen=True, kw_only=True, eq=False)
class Led:
    """The equations with the variable ``lead`` known.

    ``order`` (N,): the variables of the whole in the solver's order, the leading one last.
    """

    lead: int
    solver: BlockSolver
    order: IndexArray

    @property
    def path(self) -> InputPath:
        """The leading variable is its own path."""
        size = float(self.solver.variable_scale[-1])
        return InputPath(origin=np.zeros(1), rate=np.ones(1), size=size)

    def node(self, v: Array) -> Node:
        """The node of a position (N,) given in the whole's order."""
        return node_at(self.solver, self.path, float(v[self.lead]), v[self.order])

    def place(self, variable: int) -> int:
        """Where a variable of the whole stands in the solver's order."""
        return int(np.flatnonzero(self.order == variable)[0])

    def whole(self, part: Array) -> Array:
        """Variables (..., N) of the solver's order in the whole's order."""
        found = np.empty_like(part)
        found[..., self.order] = part
        return found


class Leads(Protocol):
    """Equations that can be solved with any variable in the lead."""

    parameter: int
    scale: Array
    turns: BoolArray

    def by(self, lead: int) -> Led | None:
        """The equations led by one variable; ``None`` if it does not determine the others."""


def fastest_leader(
    leads: Leads, v: Array, speed: Array, avoid: int | None = None, first: int | None = None
) -> tuple[Led, Node] | None:
    """The fastest variable that determines all others at a position, and the node it gives."""
    by_speed = [int(k) for k in np.argsort(-speed, kind="stable")]
    for lead in by_speed if first is None else [first, *by_speed]:
        led = leads.by(lead) if lead != avoid and speed[lead] > 0.0 else None
        if led is not None:
            node = led.node(v)
            if np.isfinite(node.second).all():
                return led, node
    return None


def apart(leads: Leads, a: Array, b: Array) -> Array:
    """b - a with angles reduced to half a turn, (..., N)."""
    return within_half_a_turn(b - a, leads.turns)


def same_position(leads: Leads, a: Array, b: Array) -> bool:
    """Whether two positions agree, whole turns aside."""
    return bool(np.abs(apart(leads, a, b) / leads.scale).max() < _SAME)
