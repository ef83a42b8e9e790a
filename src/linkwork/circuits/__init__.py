"""circuits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.circuits.circuit_list import branch_start as branch_start, circuits as circuits
    from linkwork.circuits.configuration_list import (
        configurations as configurations,
        solve_configuration as solve_configuration,
        start_in_configuration as start_in_configuration,
    )
    from linkwork.circuits.functions import inversions as inversions
    from linkwork.circuits.inverting import (
        driven_otherwise as driven_otherwise,
        inversion as inversion,
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
