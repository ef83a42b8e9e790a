"""The energy of a motion under conservative loads, which must not drift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.dynamics.reduction import Reduction
from linkwork.expression.grammar import CONSTANTS
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.load import apply_load
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import EPSILON
from linkwork.mechanism.part.load import Load
from linkwork.results.motion import Motion

__all__ = ["watch_energy"]

_DRIFTS = 1e-9  # of the largest kinetic energy
_ROUNDING = 64.0 * EPSILON  # of the largest energy


def watch_energy(motion: Motion, reduction: Reduction) -> Motion:
    """The motion; where its energy drifts, it says so and is not certified from there.

    Shocks at stops may take energy, so that it is compared between two of them.
    """
    if not _is_conservative(reduction):
        return motion
    with np.errstate(all="ignore"):
        kinetic, potential = _energies(motion, reduction)
        energy = kinetic + potential
    drift = np.zeros(len(energy))
    shocks = [k + 1 for k, event in enumerate(motion.limit) if event.startswith("stop of")]
    for part in np.split(np.arange(len(energy)), shocks):
        drift[part] = np.abs(energy[part] - energy[part[:1]])
    largest = float(np.nanmax(kinetic, initial=0.0))
    floor = _ROUNDING * float(np.nanmax(np.abs(potential), initial=0.0))
    first = np.flatnonzero(drift > _DRIFTS * largest + floor)
    if not len(first):
        return motion
    begin = int(first[0])
    share, since = float(np.nanmax(drift)) / largest, float(motion.inputs["t"][begin])
    certification = [
        Certification.ENERGY_DRIFTS if k >= begin and each.certified else each
        for k, each in enumerate(motion.certification)
    ]
    told = f"{motion.message}; its energy drifts by {share:.1e} of the largest kinetic energy, "
    return replace(
        motion,
        message=f"{told}first at t = {since:.10g} s: rows are not certified from there",
        certification=tuple(certification),
    )


def _is_conservative(reduction: Reduction) -> bool:
    """Whether weights, springs and constant loads alone move the mechanism."""
    description = reduction.description
    driven = any(motor is not None and not motor.constant for motor in reduction.motors)
    laws = any(which.law is not None for which in description.inputs)
    varying = bool(reduction.names - set(CONSTANTS))
    lossy = any(
        part.turns_with is not None if isinstance(part, Load) else part.damping != 0
        for part in reduction.acting
    )
    return not (driven or laws or varying or lossy or reduction.rubs or reduction.forcing)


def _energies(motion: Motion, reduction: Reduction) -> tuple[Array, Array]:
    """The kinetic energy, flywheels included, and the energy of all that loads the mechanism."""
    geometry = Geometry(reduction.named, motion)
    applied = reduction.loaded(geometry)
    applied.weigh(reduction.description)
    zero = np.zeros(geometry.shape)
    kinetic, stored = sum(applied.kinetic, zero), sum(applied.stored, zero)
    for which, inertia, motor in zip(
        reduction.model.equations.inputs, reduction.inertias, reduction.motors, strict=True
    ):
        jet = geometry.own(which.name)
        kinetic = kinetic + 0.5 * inertia * jet.d1**2
        if motor is not None:
            stored = stored - motor.torque(0.0 * jet.v) * jet.v
    pushed = AppliedLoads(geometry, 1.0)
    for load in (part for part in reduction.acting if isinstance(part, Load)):
        apply_load(load, pushed)
    for point, force, _ in pushed.forces:
        stored = stored - (force.conj() * geometry.place(point).v).real
    for link, torque in pushed.torques:
        stored = stored - torque * geometry.angle(link).v
    return kinetic, stored
