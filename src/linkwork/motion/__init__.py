"""Positions, whole cycles and rates of a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.motion.checking import check as check
    from linkwork.motion.circuit_list import (
        branch_start as branch_start,
        circuits as circuits,
    )
    from linkwork.motion.classifying.inverting import (
        driven_otherwise as driven_otherwise,
        inversion as inversion,
        inversions as inversions,
    )
    from linkwork.motion.configuration_list import (
        configurations as configurations,
        solve_configuration as solve_configuration,
        start_in_configuration as start_in_configuration,
    )
    from linkwork.motion.extremes import check_quantities as check_quantities
    from linkwork.motion.higher_rates import derivatives_of as derivatives_of
    from linkwork.motion.iterating import (
        guessed_points as guessed_points,
        iterates as iterates,
        pulled_guess as pulled_guess,
    )
    from linkwork.motion.model import (
        Model as Model,
        model_of as model_of,
    )
    from linkwork.motion.named_start import as_described as as_described
    from linkwork.motion.nearest_assembling import nearest_assembly as nearest_assembly
    from linkwork.motion.round_start import solve_round_start as solve_round_start
    from linkwork.motion.solving import solve as solve
    from linkwork.motion.sweeping import sweep as sweep
    from linkwork.motion.vector_loops import (
        moving_loops as moving_loops,
        vector_loops as vector_loops,
    )
    from linkwork.motion.warm_start import warm_started as warm_started
else:
    __getattr__ = loader(__name__)
