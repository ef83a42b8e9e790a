"""Statics and inverse dynamics: efforts of the inputs, and reactions of the joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.forces.reactions.solving import (
        force_quantities as force_quantities,
        forces_of_motion as forces_of_motion,
        forces_of_position as forces_of_position,
        locate_stalls as locate_stalls,
    )
    from linkwork.forces.reactions.switches import beside_switches as beside_switches
else:
    __getattr__ = loader(__name__)
