"""Forward dynamics: the motion under given loads, by reduction to one variable."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.forces.dynamics.equilibria import equilibria as equilibria
    from linkwork.forces.dynamics.simulation import simulate as simulate
else:
    __getattr__ = loader(__name__)
