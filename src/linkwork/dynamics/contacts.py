"""What a simulated motion asks of its contacts, and the energy of its flywheels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from linkwork.forces.solving import forces_of_motion
from linkwork.foundation.arrays import Array
from linkwork.foundation.units import force_of_inertia
from linkwork.mechanism.loaded import LoadedBodies
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
    parts = {
        part.names[0]: part for part in getattr(model.description, "parts", ()) if part.lets_go
    }
    if not parts:
        return motion
    looks = [motion] if at is None or times is None or not len(times) else [motion, at(times)]
    t = np.concatenate([each["t"] for each in looks])
    order = np.argsort(t, kind="stable")
    found = [forces_of_motion(model, each) for each in looks]
    told = [motion.message]
    for name in found[0].values:
        part = parts.get(name.partition(".")[0])
        for tables, slips in (("lifted", False), ("slipping", True)):
            wrong = np.concatenate([getattr(each, tables)[name] for each in found])[order]
            if part is None or not wrong.any():
                continue
            k = int(wrong.argmax())
            low, high = t[order][[max(k - 1, 0), k]].tolist()
            for _ in range(0 if len(looks) == 1 else _ROUNDS):
                assert at is not None
                inside = np.linspace(low, high, _CUTS + 1)
                cut = getattr(forces_of_motion(model, at(inside)), tables)[name]
                if not cut.any():
                    break
                first = max(int(cut.argmax()), 1)
                low, high = inside[[first - 1, first]].tolist()
            how = part.lets_go[slips]
            told.append(f"{name} {how} at t = {high:.10g} s: later rows {_KEPT[how]}")
    frictions = getattr(model.description, "friction", ())
    told += [
        f"{name} rolls without slip"
        for name, part in parts.items()
        if "slips" in part.lets_go and name in frictions and not any(name in x for x in told[1:])
    ]
    return replace(motion, message="; ".join(told))
