"""Whether a motion that a caller gives is one of the mechanism."""

from __future__ import annotations

from linkwork.foundation.errors import InputError
from linkwork.foundation.value_types import check_class
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["check_own_motion"]


def check_own_motion(model: Model, motion: Motion) -> None:
    """Check that a motion belongs to the mechanism, by its name and inputs.

    Raises
    ------
    InputError
        With the mechanism that it belongs to.
    """
    check_class("the motion", motion, Motion)
    names = [v.name for v in model.equations.inputs]
    if motion.mechanism != model.description.name or list(motion.inputs) != names:
        raise InputError(
            f'the motion belongs to "{motion.mechanism}", not to "{model.description.name}": '
            "give a sweep of this mechanism"
        )
