"""Statics and inverse dynamics: efforts of the inputs, and reactions of the joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.forces.quantities import force_quantities as force_quantities
    from linkwork.forces.solving import (
        forces_of_motion as forces_of_motion,
        forces_of_position as forces_of_position,
    )
    from linkwork.forces.stalling import locate_stalls as locate_stalls
    from linkwork.forces.switch_places import beside_switches as beside_switches
else:
    __getattr__ = loader(__name__)
