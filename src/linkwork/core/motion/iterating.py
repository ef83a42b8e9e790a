"""The iterates of Newton-Raphson from any guess."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwork import wings
from linkwork.core.equations.model import Term
from linkwork.core.equations.notation import PlainText
from linkwork.core.expression.tree import NumberNode
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import as_name
from linkwork.core.foundation.values import as_told, check_class, given_or, is_listed, plain_number
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import Named, name_series, target_values
from linkwork.core.motion.solving import solve
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import (
    Iterate,
    Iterates,
    MovingLoop,
    MovingVector,
    NewtonTrail,
    Position,
    VectorLoop,
)
from linkwork.core.results.quantity import Kind

_PULLS = 4  # one is enough where a point runs on a circle or line
_STEP = 1e-4  # of an unknown, for central differences


def iterates(
    model: Model,
    guess: Mapping[str, float] | None = None,
    at: float | Mapping[str, float] | None = None,
    *,
    options: NewtonOptions | None = None,
) -> Iterates:
    """Newton-Raphson from a guess at the asked input values directly, nothing followed.

    Parameters
    ----------
    guess : Mapping[str, number], optional
        Unknowns in file units; those left out start where the mechanism's own guess does.
    at : number or Mapping[str, number], optional
        Input value(s) in file units; the guess's own if left out.

    Raises
    ------
    UnknownNameError, InputError
        For names that are no unknowns, and values that are no numbers.
    """
    options = given_or(NewtonOptions(), "options", options)
    model = model.with_guess({} if guess is None else guess)
    position = solve(model, at, from_guess=True, options=options, with_steps=True)
    unknowns = model.equations.unknowns
    place = {u.name: (k, model.units.scale(Kind(u.kind))) for k, u in enumerate(unknowns)}
    v = model.equations.start.copy()
    v[len(unknowns) :] = target_values(model, at) * model.input_scale
    found: list[Iterate] = []
    for trail in position.steps:
        rows = np.repeat(v[None, :], len(trail.steps), axis=0)
        for name in trail.steps[0].unknowns:
            k, scale = place[name]
            rows[:, k] = [step.unknowns[name] * scale for step in trail.steps]
        found += _iterates_of(model, trail, rows)
        v = rows[-1]  # later blocks know where this one ended
    return Iterates(position=replace(position, steps=()), iterates=tuple(found))


def _iterates_of(model: Model, trail: NewtonTrail, v: Array) -> list[Iterate]:
    """The iterates of one block, at all variables v (K, N)."""
    named = _named(model, v)
    points = _points_of(named, len(v))
    open_ends = wings.use("circuits.failure.remedies").open_ends
    return [
        Iterate(
            equations=trail.equations,
            k=step.k,
            unknowns=step.unknowns,
            residuals=step.values,
            norm=step.residual,
            jacobian=step.jacobian,
            step=step.step,
            points=points[row],
            apart=open_ends(model, named, points[row], row),
        )
        for row, step in enumerate(trail.steps)
    ]


def pulled_guess(
    model: Model,
    point: str,
    place: tuple[float, float],
    guess: Mapping[str, float] | None = None,
    at: float | Mapping[str, float] | None = None,
) -> dict[str, float]:
    """A guess with one unknown changed so that a point comes as near to a place as possible.

    Of the unknowns that move the point that is changed which moves fewest points: that of the
    last link that carries it. The mechanism need not close.

    Parameters
    ----------
    point : str
    place : (float, float)
        Where the point is wanted, in the mechanism's length unit.
    guess, at
        As for :func:`iterates`.

    Returns
    -------
    dict[str, float]
        All unknowns in file units; as they were where none of them moves the point.

    Raises
    ------
    UnknownNameError, InputError
        For names that are no unknowns or no points, and values that are no numbers.
    """
    model = model.with_guess({} if guess is None else guess)
    names, unknowns = model.compiled.points.names, model.equations.unknowns
    if as_name(point) not in names:
        raise UnknownNameError(f'there is no point "{point}" {choices("points", names, point)}')
    numbers = [plain_number(each) for each in place] if is_listed(place) else []
    if len(numbers) != 2 or not all(n is not None and math.isfinite(n) for n in numbers):
        told = as_told(place)
        raise InputError(f"the coordinates of {point} must be two finite numbers, got {told}")
    v = model.equations.start.copy()
    v[len(unknowns) :] = target_values(model, at) * model.input_scale
    wanted = complex(*place)
    moving = _moving(model, v, point)
    for _ in range(_PULLS if moving >= 0 else 0):
        here, rate = _moved_by(model, v, moving, point)
        if unknowns[moving].kind == "angle":
            # the point moves at rate = i (here - centre) per radian
            centre = here + 1j * rate  # of the circle on which it runs
            change = float(np.angle((wanted - centre) / (here - centre)))
        else:
            change = float(((wanted - here) * rate.conjugate()).real) / abs(rate) ** 2
        trial = v.copy()
        trial[moving] += change
        # no longer nearer: where the path is no circle one pull can overshoot
        if abs(wanted - _moved_by(model, trial, moving, point)[0]) >= abs(wanted - here):
            break
        v = trial
    scales = [model.units.scale(Kind(u.kind)) for u in unknowns]
    return {u.name: float(v[k] / scales[k]) for k, u in enumerate(unknowns)}


def guessed_points(model: Model) -> tuple[str, ...]:
    """The points that a guess of the unknowns places: those that :func:`pulled_guess` can move."""
    moved = set[str]().union(*_moved(model, model.equations.start))
    return tuple(name for name in model.compiled.points.names if name in moved)


def _moving(model: Model, v: Array, point: str) -> int:
    """The unknown that moves a point and fewest other points; -1 if no unknown moves it."""
    moved = _moved(model, v)
    movers = [k for k, points in enumerate(moved) if point in points]
    return min(movers, key=lambda k: (len(moved[k]), -k), default=-1)


def _moved(model: Model, v: Array) -> list[set[str]]:
    """The points that each unknown moves."""
    n = model.compiled.solver.unknowns
    rows = np.repeat(v[None, :], n + 1, axis=0)
    steps = _STEP * model.compiled.solver.variable_scale[:n]
    rows[np.arange(n), np.arange(n)] += steps
    found = _points(model, rows)
    own = {name: complex(*place) for name, place in found[-1].items()}
    first = next(iter(own.values()), 0j)
    # points that the step moves by rounding only do not count
    size = 1e-6 * _STEP * (max((abs(place - first) for place in own.values()), default=0.0) or 1.0)
    return [
        {name for name, place in found[k].items() if abs(complex(*place) - own[name]) > size}
        for k in range(n)
    ]


def _moved_by(model: Model, v: Array, unknown: int, point: str) -> tuple[complex, complex]:
    """Where a point is, and how fast it moves with an unknown."""
    step = _STEP * float(model.compiled.solver.variable_scale[unknown])
    rows = np.repeat(v[None, :], 3, axis=0)
    rows[1, unknown] -= step
    rows[2, unknown] += step
    here, below, above = (complex(*points[point]) for points in _points(model, rows))
    return here, (above - below) / (2.0 * step)


def _points(model: Model, v: Array) -> list[dict[str, tuple[float, float]]]:
    """The points at every row of v (B, N)."""
    return _points_of(_named(model, v), len(v))


def _named(model: Model, v: Array) -> Named:
    none = np.zeros_like(v)
    inputs = v[:, model.compiled.solver.unknowns :] / model.input_scale
    return name_series(model, v, none, none, inputs, np.ones(len(v), dtype=bool))


def _points_of(named: Named, count: int) -> list[dict[str, tuple[float, float]]]:
    return [
        {p: (float(x.value[row]), float(y.value[row])) for p, (x, y) in named.points.items()}
        for row in range(count)
    ]


# ----------------------------------------------------------------------
# The terms of the loop equations at a position or over a motion, as vectors for a diagram.


_PLAIN = PlainText()


def vector_loops(model: Model, position: Position) -> tuple[VectorLoop, ...]:
    """Every loop equation at a position of the mechanism, term by term.

    Raises
    ------
    InputError
        If the mechanism is not written in loops, or the position was not found.
    """
    if not model.equations.loops:
        raise InputError(f'"{model.description.name}" has no loop equations to show as vectors')
    if not position.status.ok:
        raise InputError(f'"{model.description.name}" has no position here: {position.message}')
    equations = model.equations
    found = np.append(position.q, [position.input[v.name] for v in equations.inputs])
    found[len(position.q) :] *= model.input_scale
    return tuple(loop.at(0) for loop in _loops(model, found[None, :]))


def moving_loops(model: Model, motion: Motion) -> tuple[MovingLoop, ...]:
    """Every loop equation over the rows of a motion of the mechanism, term by term; none if it is
    not written in loops.
    """
    check_class("the cycle", motion, Motion)
    inputs = [motion.inputs[v.name] for v in model.equations.inputs]
    v = np.column_stack([motion.q, *inputs])
    v[:, motion.q.shape[1] :] *= model.input_scale
    return _loops(model, v)


def _loops(model: Model, v: Array) -> tuple[MovingLoop, ...]:
    """The loops at variables (N, n), internal units."""
    equations = model.equations
    values = {variable.symbol: v[:, k] for k, variable in enumerate(equations.variables)}
    shown = {variable.symbol: variable.shown for variable in equations.variables}
    return tuple(
        MovingLoop(
            label=loop.label,
            left=tuple(_vector(term, values, shown) for term in loop.left),
            right=tuple(_vector(term, values, shown) for term in loop.right),
        )
        for loop in equations.loops
    )


def _vector(term: Term, values: Mapping[str, Array], shown: Mapping[str, str]) -> MovingVector:
    any_of_them = next(iter(values.values()))
    angle = np.zeros_like(any_of_them)
    for name, weight in term.phase:
        angle = angle + weight * values[name]
    length = np.where(np.isnan(any_of_them), np.nan, 1.0)
    if term.length is not None:
        length = values[term.length]
    return MovingVector(
        name=_name(term, shown),
        values=term.value * length * np.exp(1j * angle),
        backwards=term.sign < 0,
    )


def _name(term: Term, shown: Mapping[str, str]) -> str:
    """Modulus and direction in polar form: ``a2∠θ12``; the modulus alone along the x-axis."""
    factors = []
    if term.magnitude is not None and term.magnitude != NumberNode(1.0):
        factors.append(_PLAIN.node(term.magnitude))
    if term.length is not None:
        factors.append(_PLAIN.name(shown[term.length]))
    angle = ""
    for name, weight in term.phase:
        size = "" if abs(weight) == 1.0 else f"{abs(weight):.6g}"
        angle += _signed(weight, f"{size}{_PLAIN.name(shown[name])}", angle)
    if term.turn:
        angle += _signed(term.turn, f"{round(abs(math.degrees(term.turn)), 2):g}°", angle)
    return ("·".join(factors) or "1") + (f"∠{angle}" if angle else "")


def _signed(number: float, shown: str, before: str) -> str:
    """A summand with its sign, as it follows the text before it."""
    return ("\u2212" if number < 0 else "+" if before else "") + shown
