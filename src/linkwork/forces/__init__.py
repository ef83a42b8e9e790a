"""loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.drawing.annotations import Force as Force
    from linkwork.forces.dynamics.simulation import simulate as simulate
    from linkwork.forces.functions import equilibria as equilibria, stalls as stalls
    from linkwork.forces.reactions.solving import (
        force_quantities as force_quantities,
        forces_of_motion as forces_of_motion,
        forces_of_position as forces_of_position,
    )
    from linkwork.forces.reactions.switches import beside_switches as beside_switches
    from linkwork.forces.results import (
        Equilibrium as Equilibrium,
        ForceStatus as ForceStatus,
        Reactions as Reactions,
    )
    from linkwork.forces.stall import Stall as Stall
else:
    __getattr__ = loader(__name__)
