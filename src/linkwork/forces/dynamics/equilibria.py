"""Equilibria of several free inputs: Newton's method from a grid of starts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import islice, pairwise, product

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import ChangePointPolicy
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.higher_rates import model_in_time
from linkwork.core.motion.model import Model
from linkwork.core.motion.solving import solve
from linkwork.core.results.quantity import Kind
from linkwork.forces.dynamics.input_dynamics import InputDynamics
from linkwork.forces.dynamics.reduced_leg import ReducedLeg
from linkwork.forces.dynamics.reduction import Reduction
from linkwork.forces.dynamics.simulated import (
    bounds_of,
    check_loaded,
    check_masses_move,
    model_name,
    straight_or_stop,
)
from linkwork.forces.dynamics.simulation import start_of
from linkwork.forces.reactions.geometry import AppliedLoads
from linkwork.forces.results import Equilibrium

_STARTS, _LARGEST_GRID = 5, 125  # for each input, fewer if all together were more
_MOST_STARTS = 250  # lengths have one more each; two of each of many inputs would be too many
_STRIDE = 0.25  # radians, or longest links: the longest step to a start
_LONGEST = 0.3  # of Newton's method
_NEWTON_STEPS = 60
_SETTLED = 1e-12
_DIFFERENCE = 1e-3  # of fourth order: its error is that of rounding
_SAME_POSITION = 1e-7
_FLAT = 1e-9  # of the largest stiffness, or of 1/s²: none, by differences of rounding


def input_equilibria(
    model: Model, at: float | Mapping[str, float] | None
) -> tuple[Equilibrium, ...]:
    """The equilibria that are found, by the values of the inputs.

    Raises
    ------
    InputError
        For a law, and a start at which an input moves no mass.
    """
    if model.description.timed:
        raise InputError(f"a law drives {model_name(model)}: leave it out for equilibria")
    start = model.from_position(solve(model, at, certify=False, throw=True))
    dynamics = InputDynamics(Reduction(model, model_in_time(model)), start.equations.start.copy())
    check_masses_move(model, dynamics.masses())
    bounds = bounds_of(dynamics.reduction.named)
    found: list[tuple[Array, Array, Array]] = []
    for target in _grid(model, dynamics):
        dynamics.restart()
        _walk(dynamics, target)
        settled = _settle(dynamics)
        if settled is None:
            continue
        v, slope = settled
        place = _folded(model, v)
        still = np.zeros((1, len(place)))
        solved = dynamics.reduction.geometry(place[None], still, still, np.zeros(1)).solved
        if any(bound.inside(solved)[0] < 0.0 for bound in bounds):
            continue
        if not any(_is_same(model, dynamics, place, other, slope) for other, *_ in found):
            found.append((place, v, slope))
    lead = dynamics.solver.unknowns
    found.sort(key=lambda each: tuple(np.round(each[0][lead:], 6)))
    return tuple(_with_modes(model, place, slope) for place, _, slope in found)


def _grid(model: Model, dynamics: InputDynamics) -> Iterator[Array]:
    """The starts: a turn of every angle, the table's range of every length."""
    here, count = dynamics.here, len(dynamics.here)
    # five to the third power is the largest grid: its root may be rounded down
    each = max(2, min(_STARTS, int(_LARGEST_GRID ** (1.0 / count) + 1e-9)))
    ranges = []
    for k, variable in enumerate(model.equations.inputs):
        if variable.kind == "angle":
            ranges.append(here[k] + FULL_TURN * np.arange(each) / each)
        else:
            ends = model.description.rows(model.description.inputs[k])[[0, -1]]
            scaled = ends * model.input_scale[k] / dynamics.size[k]
            first, last = map(float, scaled)
            ranges.append(np.concatenate([here[k : k + 1], np.linspace(first, last, each)]))
    return (np.array(target) for target in islice(product(*ranges), _MOST_STARTS))


def _walk(dynamics: InputDynamics, target: Array) -> None:
    """Towards a start, as far as positions are found."""
    here = dynamics.here
    count = int(np.ceil(np.abs(target - here).max() / _STRIDE))
    for share in np.linspace(0.0, 1.0, count + 1)[1:]:
        if not dynamics.settle(here + share * (target - here), 0.0):
            return


def _settle(dynamics: InputDynamics) -> tuple[Array, Array] | None:
    """The equilibrium to which Newton's method leads: variables (N,), ∂q̈/∂q (f, f)."""
    for _ in range(_NEWTON_STEPS):
        bend, slope = _linearised(dynamics)
        if not (np.isfinite(bend).all() and np.isfinite(slope).all()):
            return None
        step = -(_stiff_inverse(slope) @ bend)
        # along directions without stiffness every place is as good, if nothing pulls that way
        if np.abs(bend + slope @ step).max() > _FLAT * max(1.0, float(np.abs(slope).max())):
            step = -np.asarray(np.linalg.lstsq(slope, bend, rcond=None)[0], dtype=float)
        size = float(np.abs(step).max())
        if size < _SETTLED * max(1.0, float(np.abs(dynamics.here).max())):
            return dynamics.variables, slope
        step *= min(1.0, _LONGEST / size)
        while not dynamics.settle(dynamics.here + step, 0.0):
            step *= 0.5
            if np.abs(step).max() < _SETTLED:
                return None
    return None


def _linearised(dynamics: InputDynamics) -> tuple[Array, Array]:
    """The accelerations from rest (f,), and their derivatives by the inputs (f, f)."""
    here = dynamics.here
    count = len(here)
    steps = _DIFFERENCE * np.array([1.0, -1.0, 2.0, -2.0])
    around = [here + step * unit for step in steps for unit in np.eye(count)]
    q = np.stack([here, *around])
    found = dynamics.acceleration(q, np.zeros_like(q), np.zeros(len(q)))
    up, down, far_up, far_down = found[1:].reshape(4, count, count)
    slope = (8.0 * (up - down) - (far_up - far_down)) / (12.0 * _DIFFERENCE)
    return found[0], slope.T


def _with_modes(model: Model, v: Array, slope: Array) -> Equilibrium:
    """The equilibrium of several inputs at variables (N,), by ∂q̈/∂q (f, f)."""
    # eq. (171)
    squares = np.linalg.eigvals(-slope).astype(complex)
    squares[np.abs(squares) <= _FLAT * max(1.0, float(np.abs(squares).max()))] = 0.0
    growth = np.abs(np.sqrt(-squares).real)
    oscillates = (squares.real > 0.0) & (growth <= 1e-6 * np.sqrt(np.abs(squares)))
    rates = np.where(oscillates, np.sqrt(squares).real, -growth) / FULL_TURN
    rank = int(np.linalg.matrix_rank(_stiff_inverse(slope)))
    indifferent = "" if rank == len(slope) else "near" if rank else "everywhere"
    stable = bool(oscillates.all()) and not indifferent
    return _equilibrium(model, v, tuple(map(float, np.sort(rates) + 0.0)), stable, indifferent)


def _equilibrium(
    model: Model, v: Array, frequencies: tuple[float, ...], stable: bool, indifferent: str
) -> Equilibrium:
    """The equilibrium at variables (N,) in file units."""
    values = {
        variable.name: float(value) / model.units.scale(Kind(variable.kind))
        for variable, value in zip(model.equations.variables, v, strict=True)
    }
    return Equilibrium(
        input=values[model.equations.inputs[0].name],
        values=values,
        stable=stable,
        frequency=frequencies[0],
        frequencies=frequencies,
        indifferent=indifferent,
    )


def _folded(model: Model, v: Array) -> Array:
    """Angles within half a turn of 0."""
    angles = np.array([variable.kind == "angle" for variable in model.equations.variables])
    return np.where(angles, v - FULL_TURN * np.round(v / FULL_TURN), v)


def _stiff_inverse(slope: Array) -> Array:
    """The inverse of ∂q̈/∂q (f, f) for directions that have a stiffness."""
    size = float(np.linalg.norm(slope, 2))
    cut = _FLAT * max(1.0, 1.0 / size) if size else 1.0
    return np.asarray(np.linalg.pinv(slope, rcond=cut), dtype=float)


def _is_same(model: Model, dynamics: InputDynamics, one: Array, other: Array, slope: Array) -> bool:
    """Whether two are one position, or differ along directions without stiffness only."""
    gap = _folded(model, one - other) / dynamics.solver.variable_scale
    if float(np.abs(gap).max()) < _SAME_POSITION:
        return True
    inverse = _stiff_inverse(slope)
    if np.linalg.matrix_rank(inverse) == len(slope):
        return False
    moved = gap[dynamics.solver.unknowns :]
    return float(np.abs(inverse @ (slope @ moved)).max()) < _SAME_POSITION


# ----------------------------------------------------------------------
# Equilibria of a mechanism, their stability and natural frequencies.


_LOOKS = 256  # places of a panel at which the sign of the net force is compared
_CUTS = 12
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
        As :func:`linkwork.forces.dynamics.simulation.simulate`.
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
        return (_with_frequency(legs[curve.home], curve.value, none, "everywhere"),)
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
            free = (g for g in gains if not any(b.is_beyond(leg, s, 0.0, g) for b in bounds))
            gain = next(free, None)
            if gain is not None:
                found.append(_with_frequency(leg, s, gain, "near" if high > low else ""))
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
    sizes = [np.abs(load * moved.d1) for load, moved in applied.moving(state.displaced)]
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
        low, high, side = float(looks[k]), float(looks[k + 1]), bool(force[k] > 0.0)
        for _ in range(_CUTS):
            inside = np.linspace(low, high, 17)
            over = _force(leg, inside) > 0.0
            over[[0, -1]] = side, not side  # near zero a sign may change with its last bit
            cut = int(np.flatnonzero(over[1:] != over[:-1])[0])
            low, high = float(inside[cut]), float(inside[cut + 1])
            if high - low <= 4.0 * np.spacing(abs(low)):
                break
        s = 0.5 * (low + high)
        if abs(float(_force(leg, np.array([s]))[0])) <= _BALANCED * largest:
            yield s, s


def _with_frequency(leg: ReducedLeg, s: float, gain: Array, indifferent: str) -> Equilibrium:
    """The equilibrium of one input at a place of its leg."""
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
    return _equilibrium(leg.reduction.model, v, (frequency,), stiffness > 0.0, indifferent)


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
