"""Equilibria of several free inputs: Newton's method from a grid of starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice, product

import numpy as np

from linkwork.dynamics.events import Bound
from linkwork.dynamics.input_dynamics import InputDynamics
from linkwork.dynamics.reduction import Reduction
from linkwork.dynamics.simulated import bounds_of, check_masses_move, model_name
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.motion.in_time import model_in_time
from linkwork.motion.model import Model
from linkwork.motion.solving import solve
from linkwork.results.equilibrium import Equilibrium
from linkwork.results.quantity import Kind

__all__ = ["input_equilibria"]

_STARTS, _LARGEST_GRID = 5, 125  # for each input, fewer if all together were more
_MOST_STARTS = 250  # lengths have one more each; two of each of many inputs would be too many
_STRIDE = 0.25  # radians, or longest links: the longest step to a start
_LONGEST = 0.3  # of Newton's method
_ROUNDS = 60
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
        if not _inside(dynamics, place, bounds):
            continue
        if not any(_is_same(model, dynamics, place, other, slope) for other, *_ in found):
            found.append((place, v, slope))
    lead = dynamics.solver.unknowns
    found.sort(key=lambda each: tuple(np.round(each[0][lead:], 6)))
    return tuple(_equilibrium(model, place, slope) for place, _, slope in found)


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
    for _ in range(_ROUNDS):
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


def _equilibrium(model: Model, v: Array, slope: Array) -> Equilibrium:
    # eq. (171)
    squares = np.linalg.eigvals(-slope).astype(complex)
    squares[np.abs(squares) <= _FLAT * max(1.0, float(np.abs(squares).max()))] = 0.0
    growth = np.abs(np.sqrt(-squares).real)
    oscillates = (squares.real > 0.0) & (growth <= 1e-6 * np.sqrt(np.abs(squares)))
    rates = np.where(oscillates, np.sqrt(squares).real, -growth) / FULL_TURN
    values = {
        variable.name: float(value) / model.units.scale(Kind(variable.kind))
        for variable, value in zip(model.equations.variables, v, strict=True)
    }
    rates = np.sort(rates) + 0.0
    rank = int(np.linalg.matrix_rank(_stiff_inverse(slope)))
    indifferent = "" if rank == len(slope) else "near" if rank else "everywhere"
    return Equilibrium(
        input=values[model.equations.inputs[0].name],
        values=values,
        stable=bool(oscillates.all()) and not indifferent,
        frequency=float(rates[0]),
        frequencies=tuple(map(float, rates)),
        indifferent=indifferent,
    )


def _inside(dynamics: InputDynamics, v: Array, bounds: Sequence[Bound]) -> bool:
    """Whether no stop is in the way."""
    still = np.zeros((1, len(v)))
    solved = dynamics.reduction.geometry(v[None], still, still, np.zeros(1)).solved
    values = [(bound, np.atleast_1d(bound.asked.values(solved, 1.0))[0]) for bound in bounds]
    return all(bound.side * (value - bound.value) >= 0.0 for bound, value in values)


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
