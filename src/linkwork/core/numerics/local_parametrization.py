"""Leaders: the variables of a curve of positions that can be taken as known, one at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.rounding import EPSILON
from linkwork.core.foundation.units import FULL_TURN, within_half_a_turn
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Node, node_at
from linkwork.core.numerics.newton import sharp
from linkwork.core.numerics.position_proof import expansions, prove, reach

_COINCIDE = 1e-6  # weighted: rounding of places that are ill-conditioned
_NEAR = 1e-3  # weighted: positions further apart are not looked at
_ON_VALUE = 1e-9  # of the parameter, weighted: positions at different values are different
_ROUNDINGS = 8.0  # times the unit and the condition: how far two solutions that are one may be


@dataclass(frozen=True, kw_only=True, eq=False)
class Parametrization:
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

    @property
    def provable(self) -> bool:
        """Whether proofs know bounds for the equations."""
        return self.solver.is_provable

    def node(self, v: Array) -> Node:
        """The node of a position (N,) given in the whole's order."""
        return node_at(self.solver, self.path, float(v[self.lead]), v[self.order])

    def place(self, variable: int) -> int:
        """The index of a variable of the whole in the solver's order."""
        return int(np.flatnonzero(self.order == variable)[0])

    def whole(self, part: Array) -> Array:
        """Variables (..., N) of the solver's order in the whole's order."""
        found = np.empty_like(part)
        found[..., self.order] = part
        return found


class Parametrizations(Protocol):
    """Equations that can be solved with any variable in the lead."""

    parameter: int
    scale: Array
    is_angle: BoolArray

    def with_parameter(self, lead: int) -> Parametrization | None:
        """The equations led by one variable; ``None`` if it does not determine the others."""

    def repeats_after(self, turns: Array) -> bool:
        """Whether variables (N,) moved by this many whole turns satisfy the same equations."""


def fastest_leader(
    leads: Parametrizations,
    v: Array,
    speed: Array,
    avoid: int | None = None,
    first: int | None = None,
) -> tuple[Parametrization, Node] | None:
    """The fastest variable that determines all others at a position, and the node it gives."""
    by_speed = [int(k) for k in np.argsort(-speed, kind="stable")]  # eq. (35)
    for lead in by_speed if first is None else [first, *by_speed]:
        led = leads.with_parameter(lead) if lead != avoid and speed[lead] > 0.0 else None
        if led is not None:
            node = led.node(v)
            # a leader with a singular Jacobian determines nothing
            if np.isfinite(node.second).all():
                return led, node
    return None


def apart(leads: Parametrizations, a: Array, b: Array) -> Array:
    """b - a with angles reduced to half a turn, (..., N)."""
    return within_half_a_turn(b - a, leads.is_angle)


def whole_turns(leads: Parametrizations, a: Array, b: Array) -> Array:
    """How many whole turns (N,) angles have made on the way from a position to another."""
    return np.where(leads.is_angle, np.round((b - a) / FULL_TURN), 0.0)


def coincide(leads: Parametrizations, a: Array, b: Array) -> bool:
    """Whether two places that are known to rounding, such as limits, agree, modulo whole turns."""
    return bool(np.abs(apart(leads, a, b) / leads.scale).max() < _COINCIDE)


def near(
    leads: Parametrizations, places: Sequence[Array], v: Array, within: float = _NEAR
) -> list[int]:
    """The numbers of places (N,) that are near a position, modulo whole turns."""
    if not places:
        return []
    gaps = np.abs(apart(leads, v, np.stack(places)) / leads.scale).max(axis=1)
    return [int(k) for k in np.flatnonzero(gaps <= within)]


def same_position(leads: Parametrizations, a: Array, b: Array, gained: Array | None = None) -> bool:
    """Whether two positions at one value of the parameter are one, modulo whole turns.

    ``gained`` (N,): turns from a to b, and what lengths have gained in units of 2π.

    Both are iterated down to rounding with the parameter in the lead. Then it is a matter of proof:
    one lies where only the other is, or both lie apart. Where neither is proved, they agree if they
    do to rounding.
    """
    turns, p = whole_turns(leads, a, b) if gained is None else gained, leads.parameter
    # the equations are the same whole turns away, but the numbers have to agree
    there = b - FULL_TURN * turns
    gap = np.abs(there - a) / leads.scale
    own = leads.with_parameter(p)
    if own is None or gap.max() > _NEAR or gap[p] > _ON_VALUE or not leads.repeats_after(turns):
        return False
    both = np.stack([a, there])
    rounding = 8.0 * EPSILON * max(1.0, abs(float(a[p])), abs(float(b[p])))
    size = 1.0 + np.abs(both / leads.scale).max()
    # equal numbers need no proof
    if gap.max() <= _ROUNDINGS * EPSILON * size:
        return True
    # both at exactly one value of the parameter, so that only one branch is compared with the other
    both[:, p] = a[p]
    done = own.solver.solve(both[:, own.order], sharp(own.solver.options))
    found = own.solver.sharpen(done.v)
    off = np.abs(found[1] - found[0])
    if own.provable:
        input_radius = np.full((1, 1), rounding)
        places = [expansions(own.solver, v, exact=True) for v in (found[:1], found[1:])]
        first, second = (
            reach(own.solver, found[:1], input_radius, places[0]),
            prove(own.solver, found[1:], input_radius, places[1]),
        )
        if first.holds[0] and second.holds[0]:
            errors = second.error_bound[0, :-1]
            if (off[:-1] + errors < first.isolation_radius[0]).all():
                return True
            if (off[:-1] > errors + first.error_bound[0, :-1]).any():
                return False
    rates = own.solver.rates(found, own.path.rate)
    allowed = min(_COINCIDE, _ROUNDINGS * EPSILON * float(rates.condition.max()) * size)
    close = (off / own.solver.variable_scale).max() <= allowed
    # two roots that a dead point joins have opposite signs of det J
    return bool(close and np.array_equal(rates.orientation[0], rates.orientation[1]))
