"""Forces of loaded mechanisms, and their motion in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.drawing.annotations import Force as Force
    from linkwork.forces.functions import equilibria as equilibria, stalls as stalls
    from linkwork.forces.results import (
        Equilibrium as Equilibrium,
        ForceStatus as ForceStatus,
        Reactions as Reactions,
        Stall as Stall,
    )
else:
    __getattr__ = loader(__name__)
