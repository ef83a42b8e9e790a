"""What can be simulated: its start speeds, its stops, and what refuses it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import ExpressionError, InputError, choices
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.statuses import ChangePointPolicy
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import speed_per_second
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.motion.model import Model, bounded_quantity
from linkwork.forces.dynamics.events import Bound

_MASSLESS = 1e-12  # of the largest eigenvalue of the matrix of masses: none


def model_name(model: Model) -> str:
    """The mechanism's name in quotation marks."""
    return f'"{model.description.name}"'


def straight_or_stop(change_points: str | ChangePointPolicy) -> ChangePointPolicy:
    """The policy at change points of a motion in time, which takes no other branch.

    Raises
    ------
    InputError
        For another policy.
    """
    policy = ChangePointPolicy.of(change_points)
    if policy is ChangePointPolicy.TURN:
        raise InputError('a simulation goes straight on or stops: change_points "stop", "straight"')
    return policy


def check_loaded(model: Model) -> LoadedBodies:
    """The description of a mechanism that loads can move.

    Raises
    ------
    InputError
        If a law drives it, or nothing in it has mass.
    """
    description, name = model.description, model_name(model)
    if not isinstance(description, LoadedBodies):
        raise InputError(f"{name} has plain equations: only links have masses")
    if description.inputs and all(which.law is not None for which in description.inputs):
        raise InputError(f"a law drives {name}: leave it out to simulate")
    if not description.inputs:
        raise InputError(f"{name} has no input: it does not move")
    if not description.masses and all(each.inertia is None for each in description.inputs):
        raise InputError(f"nothing in {name} has mass: add [masses], or inertia to the input")
    return description


def check_masses_move(model: Model, masses: Array) -> None:
    """Refuse inputs that can move without a mass; ``masses`` (f, f) at the start.

    Raises
    ------
    InputError
        With what to add.
    """
    sizes = np.linalg.eigvalsh(masses)
    if not sizes[0] > _MASSLESS * sizes[-1]:
        raise InputError(
            f"{model_name(model)} has {len(model.description.inputs)} inputs, and they can move at "
            "the start without moving a mass: add [masses], or inertia to the inputs"
        )


def start_speeds(model: Model, given: Number | Mapping[str, Number]) -> Array:
    """The speed of every input at the start, [rad/s] or [length/s], (p,)."""
    description = model.description
    names = [variable.name for variable in model.equations.inputs]
    if not isinstance(given, Mapping):
        if len(names) > 1 and given not in (0, "0"):
            raise InputError(
                f"{model_name(model)} has {len(names)} inputs: name the start speed of each, "
                f"for example {names[0]}={given}"
            )
        given = {names[0]: given} if len(names) == 1 else {}
    known = {canonical(name): k for k, name in enumerate(names)}
    speeds = np.zeros(len(names))
    for name, value in given.items():
        name = canonical(name)
        if name not in known:
            raise InputError(
                f'start speed: there is no input "{name}" {choices("inputs", names, name)}'
            )
        k = known[name]
        if description.inputs[k].law is not None:
            raise InputError(f"start speed: a law drives {names[k]}, which has its speed")
        kind = description.inputs[k].drives[0]
        try:
            own = speed_per_second(value, kind, description.numbers, description.length)
        except ExpressionError as error:
            raise InputError(f"start speed: {error.message}") from None
        speeds[k] = own * float(model.input_scale[k])
    return speeds


def bounds_of(named: Model) -> list[Bound]:
    """The bounds of all stops."""
    description = named.description
    assert isinstance(description, LoadedBodies)
    numbers = description.numbers
    return [
        Bound(
            key=("stops", k, field),
            asked=bounded_quantity(stop.of, named.motion_quantities),
            value=numbers(value),
            side=side,
            restitution=numbers(stop.restitution),
        )
        for k, stop in enumerate(description.stops)
        for field, value, side in (("from", stop.from_, 1.0), ("to", stop.to, -1.0))
        if value is not None
    ]
