"""Equilibria of a mechanism, their stability and natural frequencies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from linkwork.dynamics.events import Bound
from linkwork.dynamics.input_equilibria import input_equilibria
from linkwork.dynamics.reduced_leg import ReducedLeg
from linkwork.dynamics.simulated import bounds_of, check_loaded, straight_or_stop
from linkwork.dynamics.simulation import start_of
from linkwork.forces.applied import AppliedLoads
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.motion.model import Model
from linkwork.results.equilibrium import Equilibrium
from linkwork.results.quantity import Kind

__all__ = ["equilibria"]

_LOOKS = 256  # places of a panel at which the sign of the net force is compared
_ROUNDS = 12
_SLOPE = 1e-3  # of a panel: differences of fourth order for the stiffness
_SAME_PLACE = 1e-9  # of a turn, or of the longest link
_BALANCED = 1e-9  # of the largest net force: a zero, not a jump of a comparison
_NONE = 1e-12  # of the largest loads: a net force of rounding
_STRETCH = 5  # places in a row without a net force: no zero of a lower order is so wide


def equilibria(
    model: Model,
    at: float | Mapping[str, float] | None = None,
    *,
    change_points: str | ChangePointPolicy = ChangePointPolicy.STOP,
) -> tuple[Equilibrium, ...]:
    """All equilibria on the circuit of the start within the stops, in its order.

    The net force along the motion is zero there, at rest and at t = 0. Two equilibria between two
    of 256 places of a panel are not seen. Where loads balance at all positions, or on a stretch,
    one is listed for it. With several inputs: those to which Newton's method leads
    from a grid of starts.

    Raises
    ------
    InputError
        As :func:`linkwork.dynamics.simulate`.
    """
    policy = straight_or_stop(change_points)
    check_loaded(model)
    if len(model.description.inputs) > 1:
        return input_equilibria(model, at)
    reduction, curve = start_of(model, at, policy, False)
    bounds = bounds_of(reduction.named)
    found: list[Equilibrium] = []
    legs = [ReducedLeg(reduction, leg, curve.gain) for leg in curve.legs]
    zeros = [[*_zeros(leg)] for leg in legs]
    if all(
        ends == [tuple(leg.table.edges[[0, -1]])] for leg, ends in zip(legs, zeros, strict=True)
    ):
        none = np.zeros(legs[0].variables)
        return (_equilibrium(legs[curve.home], curve.value, none, "everywhere"),)
    last: list[Equilibrium] = []  # of the last stretch, if it reaches the end of its leg
    for leg, ends in zip(legs, zeros, strict=True):
        backwards, is_home = leg.leg.begin > leg.leg.end, leg is legs[curve.home]
        first, end = leg.table.edges[[-1, 0] if backwards else [0, -1]]
        before, last = last, []
        for low, high in sorted(ends, reverse=backwards):
            # a stretch is listed once, near the start if it comes there
            s = min(max(curve.value, low), high) if is_home else 0.5 * (low + high)
            if before and high > low and first in (low, high):
                if not is_home:
                    last = before if end in (low, high) else []
                    continue
                found.remove(before[0])
            # from the start a place may be reached forwards or backwards
            laps = (0, -1, 1) if curve.closed and bounds else (0,)
            gains = [lap * curve.gain for lap in laps]
            gain = next((gain for gain in gains if _inside(leg, s, gain, bounds)), None)
            if gain is not None:
                found.append(_equilibrium(leg, s, gain, "near" if high > low else ""))
                if high > low and end in (low, high):
                    last = found[-1:]
    kept: list[Equilibrium] = []
    for each in found:
        if not any(_same(model, each, other) for other in kept):
            kept.append(each)
    return tuple(kept)


def _force(leg: ReducedLeg, s: Array) -> Array:
    still = np.zeros_like(s)
    return leg.acceleration(s, still, still, np.zeros(leg.variables)) * leg.numbers(s)[:, 0]


def _load_size(leg: ReducedLeg, s: Array) -> float:
    """The largest sum of the sizes of all works per unit of the leader at rest."""
    still = np.zeros_like(s)
    state = leg.state(s, still, still, np.zeros(leg.variables))
    applied, weights = leg.reduction.loaded(state.moving), AppliedLoads(state.displaced, 1.0)
    weights.weigh(leg.reduction.description)
    sizes = [np.abs(force * state.displaced.place(at).d1) for at, force, _ in applied.forces]
    sizes += [np.abs(own * state.displaced.angle(link).d1) for link, own in applied.torques]
    sizes += [np.abs(body.weight_rate) for body in weights.masses]
    return float(np.max(sum(sizes, still)))


def _zeros(leg: ReducedLeg) -> Iterator[tuple[float, float]]:
    """The places without a net force, each twice, and both ends of stretches without any."""
    edges = leg.table.edges
    looks = np.concatenate([np.linspace(a, b, _LOOKS + 1)[:-1] for a, b in pairwise(edges)])
    looks = np.append(looks, edges[-1])
    force = _force(leg, looks)
    largest = float(np.abs(force).max())
    none = np.abs(force) <= _NONE * _load_size(leg, looks)
    flat = np.zeros_like(none)
    jumps = np.diff(np.concatenate([[0], none, [0]]).astype(int))
    for first, end in zip(np.flatnonzero(jumps > 0), np.flatnonzero(jumps < 0), strict=True):
        if end - first >= _STRETCH:
            flat[first:end] = True
            yield float(looks[first]), float(looks[end - 1])
    for k in (0, -1):
        # a zero at the joint of two legs may change its sign on neither
        if largest and abs(float(force[k])) <= _BALANCED * largest and not flat[k]:
            yield float(looks[k]), float(looks[k])
    changes = (force[:-1] > 0.0) != (force[1:] > 0.0)
    for k in np.flatnonzero(changes & ~flat[:-1] & ~flat[1:]).tolist():
        low, high = float(looks[k]), float(looks[k + 1])
        for _ in range(_ROUNDS):
            inside = np.linspace(low, high, 17)
            over = _force(leg, inside) > 0.0
            cut = int(np.flatnonzero(over[1:] != over[:-1])[0])
            low, high = float(inside[cut]), float(inside[cut + 1])
            if high - low <= 4.0 * np.spacing(abs(low)):
                break
        s = 0.5 * (low + high)
        if abs(float(_force(leg, np.array([s]))[0])) <= _BALANCED * largest:
            yield s, s


def _inside(leg: ReducedLeg, s: float, gain: Array, bounds: Sequence[Bound]) -> bool:
    """Whether no stop is in the way."""
    return not any(bound.is_beyond(leg, s, 0.0, gain) for bound in bounds)


def _equilibrium(leg: ReducedLeg, s: float, gain: Array, indifferent: str = "") -> Equilibrium:
    model = leg.reduction.model
    panel = int(leg.table.locate(np.array([s]))[0][0])
    step = _SLOPE * float(leg.table.edges[panel + 1] - leg.table.edges[panel])
    down, far_down, up, far_up = _force(leg, s + step * np.array([-1.0, -2.0, 1.0, 2.0]))
    stiffness = -float(8.0 * (up - down) - (far_up - far_down)) / (12.0 * step)
    mass = float(leg.numbers(np.array([s]))[0, 0])
    # eq. (93)
    frequency = math.copysign(math.sqrt(abs(stiffness) / mass), stiffness) / FULL_TURN
    if indifferent:
        stiffness = frequency = 0.0
    v = leg.leg.rows(np.array([s]), False).v[0] + gain
    names = model.equations.variables
    values = {
        variable.name: float(value) / model.units.scale(Kind(variable.kind))
        for variable, value in zip(names, v, strict=True)
    }
    return Equilibrium(
        input=values[names[-1].name], values=values, stable=stiffness > 0.0, frequency=frequency,
        frequencies=(frequency,), indifferent=indifferent,
    )  # fmt: skip


def _same(model: Model, one: Equilibrium, other: Equilibrium) -> bool:
    """Whether two are one position, whole turns apart or at the joint of two legs."""
    turn = model.units.angle.turn
    size = model.equations.length_scale
    for variable in model.equations.variables:
        gap = one.values[variable.name] - other.values[variable.name]
        angle = variable.kind == "angle"
        gap = math.remainder(gap, turn) / turn if angle else gap / size
        if abs(gap) > _SAME_PLACE:
            return False
    return True
