"""Efforts of the inputs by virtual work."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.forces.applied import AppliedLoads
from linkwork.foundation.arrays import AnyArray, Array

__all__ = ["efforts", "energies", "work_terms"]


def efforts(applied: AppliedLoads) -> tuple[Array, Array]:
    """The effort of every input and the size of the largest term of its sum, (p, B) each.

    The size of a term is that of its two factors: where a force is normal to the motion, rounding
    errors are relative to it.
    """
    geometry = applied.geometry
    shape = (len(geometry.driven.equations.inputs), geometry.rows)
    total, largest = np.zeros(shape), np.zeros(shape)
    for load, moved in work_terms(applied):
        # eq. (71)
        total -= (np.conj(load) * moved).real
        largest = np.maximum(largest, np.abs(load) * np.abs(moved))
    return total, largest


def work_terms(applied: AppliedLoads) -> Iterator[tuple[AnyArray, AnyArray]]:
    """Every load (B,), and what it moves per unit of every input, (p, B)."""
    geometry = applied.geometry
    for point, force, _ in applied.forces:
        yield force, geometry.partial(point)
    for link, torque in applied.torques:
        yield torque, geometry.turning(link)
    for body in applied.masses:
        yield body.force, geometry.partial_local(body.link, body.centre)
        yield body.torque, geometry.turning(body.link)


def energies(applied: AppliedLoads) -> dict[str, Array]:
    """Energies, and the power of all loads that store none, (B,) each."""
    geometry, rate = applied.geometry, applied.rate
    zero = np.zeros(geometry.shape)
    found = {
        "kinetic_energy": sum(applied.kinetic, zero),
        "stored_energy": sum(applied.stored, zero),
    }
    pushed = sum(((f.conj() * geometry.place(p).d1).real for p, f, _ in applied.forces), zero)
    turned = sum((torque * geometry.angle(link).d1 for link, torque in applied.torques), zero)
    weights = sum((body.weight_rate for body in applied.masses), zero)
    moving = sum((body.kinetic_rate for body in applied.masses), zero)
    stored = sum(applied.stored_rates, zero)
    found["load_power"] = (pushed + turned) * rate + weights + stored
    found["energy_rate"] = moving + stored
    return found
