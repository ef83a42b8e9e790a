"""What a simulated motion asks of its contacts, and the energy of its flywheels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from linkwork.forces.solving import forces_of_motion
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.units import force_of_inertia
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.mechanism.part.belt import Belt
from linkwork.mechanism.part.cam import Cam
from linkwork.mechanism.part.rolling import Rolling
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["with_contacts", "with_flywheels"]

#: What a simulation goes on with, by how a contact fails.
_KEPT = {
    "lifts off": "keep the contact", "slips": "roll on", "goes slack": "keep the strand tight"
}  # fmt: skip
_CUTS, _ROUNDS = 16, 12  # of the time in which a contact lifts off: to rounding


def with_flywheels(model: Model, motion: Motion) -> Motion:
    """The motion with the energy of the inertia on its inputs."""
    own = model.description
    assert isinstance(own, LoadedBodies)
    unit = force_of_inertia(own.mass, own.length, own.force)
    energy = np.zeros(len(motion))
    for which in own.inputs:
        if which.inertia is not None:
            inertia = own.numbers(which.inertia) * unit
            energy += 0.5 * inertia * motion[f"{which.column}.velocity"] ** 2
    return replace(motion, flywheel_energy=energy) if energy.any() else motion


def with_contacts(
    model: Model,
    motion: Motion,
    times: Array | None = None,
    at: Callable[[Array], Motion] | None = None,
) -> Motion:
    """The motion, whose message says when a cam lifts off, a strand goes slack or a wheel slips.

    ``at``: the motion at times (B,) while it moves; ``times``: some of them, so close that no
    change is missed between them.
    """
    frictions = getattr(model.description, "friction", ())
    watched = {
        part.name: isinstance(part, Rolling) and part.name in frictions
        for part in getattr(model.description, "parts", ())
        if isinstance(part, Belt | Cam | Rolling)
    }
    if not watched:
        return motion
    looks = [motion] if at is None or times is None or not len(times) else [motion, at(times)]
    t = np.concatenate([each["t"] for each in looks])
    order = np.argsort(t, kind="stable")
    found = [_unheld(model, each) for each in looks]
    told = [motion.message]
    for name, how in found[0]:
        wrong = np.concatenate([each[name, how] for each in found])[order]
        if not wrong.any():
            continue
        k = int(wrong.argmax())
        low, high = t[order][[max(k - 1, 0), k]].tolist()
        for _ in range(0 if len(looks) == 1 else _ROUNDS):
            assert at is not None
            inside = np.linspace(low, high, _CUTS + 1)
            cut = _unheld(model, at(inside))[name, how]
            if not cut.any():
                break
            first = max(int(cut.argmax()), 1)
            low, high = inside[[first - 1, first]].tolist()
        told.append(f"{name} {how} at t = {high:.10g} s: later rows {_KEPT[how]}")
    told += [
        f"{name} rolls without slip"
        for name, grips in watched.items()
        if grips and not any(each[name, "slips"].any() for each in found)
    ]
    return replace(motion, message="; ".join(told))


def _unheld(model: Model, motion: Motion) -> dict[tuple[str, str], BoolArray]:
    """The rows (B,) in which a contact does not hold, by its name and by how it fails."""
    found = forces_of_motion(model, motion)
    wrong: dict[tuple[str, str], BoolArray] = {}
    for tables, how in ((found.slipping, "slips"), (found.lifted, "lifts off")):
        for name, rows in tables.items():
            part, _, force = name.partition(".")
            slack = how == "lifts off" and force.startswith("tension")
            key = (name, "goes slack") if slack else (part, how)
            wrong[key] = wrong.get(key, np.zeros(len(motion), dtype=bool)) | rows
    return wrong
