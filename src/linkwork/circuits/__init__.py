"""Every way to assemble a mechanism: configurations, circuits, branches, inversions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.circuits.circuit_list import (
        inversions as inversions,
        nearest_assembly as nearest_assembly,
    )
    from linkwork.circuits.results import (
        Branch as Branch,
        Circuit as Circuit,
        Circuits as Circuits,
        Configurations as Configurations,
        PathCount as PathCount,
    )
else:
    __getattr__ = loader(__name__)
