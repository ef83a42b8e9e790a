"""Flywheel of an input whose effort fluctuates."""

from __future__ import annotations

from linkwork.design.whole_turn import first_extreme, whole_turn
from linkwork.forces.drives import effort_name
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
    if description.timed:
        raise InputError("a law fixes the speed of the input: leave it out, and give speed")
    speed, lead = model.speed, model.motion_quantities.names.lead
    if not speed:
        raise InputError('a flywheel needs the speed of the input: speed = "300 rpm"')
    curve = whole_turn(model, motion, effort_name(lead)).curve
    mean = curve.mean()
    # power in is positive along the motion, also of an input that turns backwards
    angle, energy = curve.missing(mean)
    (fastest, high), (slowest, low) = (first_extreme(angle, k * energy) for k in (1.0, -1.0))
    stored = high + low
    unit = force_of_inertia(description.mass, description.length, description.force)
    scale, units = model.units.scale(Kind.ANGLE), model.units
    return Flywheel(
        fluctuation=fluctuation,
        mean=mean,
        energy=stored,
        # eq. (78)
        inertia=stored / (fluctuation * (speed * speed)) / unit,
        slowest=slowest / scale,
        fastest=fastest / scale,
        units={
            "mean": units.of(Kind.MOMENT),
            "energy": units.of(Kind.ENERGY),
            "inertia": f"{description.mass}·{description.length}²",
            "input": units.of(Kind.ANGLE),
        },
    )
