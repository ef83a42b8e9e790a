"""Forces of a position and of a motion as results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from linkwork.equations.input_motion import TIME
from linkwork.forces.applied import load_formulas
from linkwork.forces.quantities import check_formulas
from linkwork.forces.switch_places import beside_switches
from linkwork.forces.system import solve_forces
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError, KeyWords, key_text
from linkwork.foundation.frozen import ComputedDict
from linkwork.foundation.value_types import check_class
from linkwork.motion.between_rows import between_rows
from linkwork.motion.in_time import model_in_time
from linkwork.motion.model import Model
from linkwork.motion.own_motion import check_own_motion
from linkwork.results.motion import Motion
from linkwork.results.position import Position
from linkwork.results.quantities.definition import Solved
from linkwork.results.reactions import ForceStatus, Reactions

__all__ = ["forces_of_motion", "forces_of_position"]


def forces_of_position(model: Model, position: Position, place: KeyWords = key_text) -> Reactions:
    """Efforts and reactions at one position; ``place`` words the key of a load without a value.

    Raises
    ------
    InputError
        If nothing loads the mechanism.
    """
    return _reactions(model, position, dict(position.input), position.input_units, (), place)


def forces_of_motion(model: Model, motion: Motion, place: KeyWords = key_text) -> Reactions:
    """Efforts and reactions in all rows of a motion of the mechanism; raises like
    :func:`forces_of_position`, and for other motions.
    """
    check_class("the motion", motion, Motion)
    if model.untimed is None and TIME in motion.inputs:  # a simulated motion
        model = model_in_time(model)
    check_own_motion(model, motion)
    found = _reactions(model, motion, motion.inputs, motion.input_units, (len(motion),), place)
    if TIME in motion.inputs or any(motion.limit) or not motion.found.all() or len(motion) < 2:
        return found
    names = [*found.inputs, *found.values]
    return replace(found, at_switches=ComputedDict(names, _SwitchValues(model, motion).of))


class _SwitchValues:
    """Quantities on both sides of all switches of loads in a table, computed at first need."""

    def __init__(self, model: Model, motion: Motion) -> None:
        self.model, self.motion = model, motion

    @cached_property
    def rows(self) -> Solved | None:
        """The positions; ``None`` if nothing switches."""
        lead = list(self.motion.inputs).index(self.model.motion_quantities.names.lead)
        t = np.asarray(list(self.motion.inputs.values())[lead]) * self.model.input_scale[lead]
        at = between_rows(self.model, self.motion)
        places = beside_switches(self.model, at, np.sort(t))
        return at(places) if len(places) else None

    def of(self, name: str) -> Array:
        """A quantity, (2K,)."""
        if self.rows is None:
            return np.zeros(0)
        found: Array = self.model.quantities.find(name).values(self.rows, self.model.speed)
        return found


def _reactions(
    model: Model,
    solved: Solved,
    inputs: Mapping[str, Array] | Mapping[str, float],
    input_units: Mapping[str, str],
    shape: tuple[int, ...],
    place: KeyWords,
) -> Reactions:
    if not getattr(model.description, "loaded", False):
        raise InputError(
            f"nothing loads {model.description.name}: add [masses], [[loads]] or a spring with a "
            "stiffness"
        )
    check_formulas(model, at_rest=False)
    rows = solve_forces(model, solved)
    values = rows.values.items()
    return Reactions(
        mechanism=model.description.name,
        inputs={name: np.asarray(value) for name, value in inputs.items()},
        input_units=input_units,
        values={name: force.value.reshape(shape) for name, force in values},
        kinds={name: force.kind for name, force in values},
        units={name: model.units.of(force.kind) for name, force in values},
        about={name: force.about for name, force in values},
        statuses=ForceStatus.of_codes(rows.status),
        undetermined={name: force.undetermined.reshape(shape) for name, force in values},
        lifted={name: force.lifted.reshape(shape) for name, force in values},
        slipping={name: force.slipping.reshape(shape) for name, force in values},
        undefined={
            f'{place(key)} "{formula}"': rows.undefined[formula].reshape(shape)
            for key, formula in load_formulas(model.description)
            if formula in rows.undefined
        },
        proved=rows.proved.reshape(shape),
    )
