"""Flywheel of an input whose effort fluctuates."""

from __future__ import annotations

import numpy as np

from linkwork.design.whole_turn import WholeTurn, whole_turn
from linkwork.forces.drives import effort_name
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.foundation.units import force_of_inertia
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.motion.model import Model
from linkwork.results.machine_design import Flywheel
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["flywheel"]


def flywheel(model: Model, motion: Motion, fluctuation: float) -> Flywheel:
    """The inertia for a fluctuation (ω_max - ω_min) / ω of the speed at a constant motor torque.

    The energy that the speed takes up and gives back is the integral of mean minus effort; its
    range ΔE asks for the inertia ΔE / (δ ω²). The efforts are those at the constant mean speed.

    Raises
    ------
    InputError
        Without a speed, a whole turn or a positive fluctuation.
    """
    description = model.description
    if not isinstance(description, LoadedBodies):
        raise InputError("a flywheel needs a mechanism with links and loads")
    if not fluctuation > 0.0:
        raise InputError(f"the fluctuation of the speed must be positive, got {fluctuation:g}")
    speed, lead = model.speed, model.motion_quantities.names.lead
    if not speed:
        raise InputError('a flywheel needs the speed of the input: speed = "300 rpm"')
    turn = whole_turn(model, motion, effort_name(lead))
    angle, energy = _energy(turn)
    low, high = int(np.argmin(energy)), int(np.argmax(energy))
    stored = float(energy[high] - energy[low])
    unit = force_of_inertia(description.mass, description.length, description.force)
    scale, units = model.units.scale(Kind.ANGLE), model.units
    return Flywheel(
        fluctuation=fluctuation,
        mean=turn.mean,
        energy=stored,
        # eq. (78)
        inertia=stored / (fluctuation * (speed * speed)) / unit,
        slowest=float(angle[low] / scale),
        fastest=float(angle[high] / scale),
        units={
            "mean": units.of(Kind.MOMENT),
            "energy": units.of(Kind.ENERGY),
            "inertia": f"{description.mass}·{description.length}²",
            "input": units.of(Kind.ANGLE),
        },
    )


def _energy(turn: WholeTurn) -> tuple[Array, Array]:
    """The energy of the flywheel, at all rows and where the effort is equal to its mean."""
    # extremes lie where the effort crosses its mean, between rows too
    surplus = turn.mean - turn.value
    a, b = surplus[:-1], surplus[1:]
    with np.errstate(all="ignore"):
        share = np.where(a * b < 0.0, a / (a - b), 0.0)
    step = np.diff(turn.angle)
    # power in is positive along the motion, also of an input that turns backwards
    before = np.concatenate([[0.0], np.cumsum((a + b) / 2.0 * step)])
    between = before[:-1] + a * share * step / 2.0
    return (
        np.concatenate([turn.angle, turn.angle[:-1] + share * step]),
        np.concatenate([before, between]),
    )
