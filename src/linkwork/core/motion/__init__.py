"""Positions, whole cycles and rates of a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.motion.checking import check as check
    from linkwork.core.motion.extremes import check_quantities as check_quantities
    from linkwork.core.motion.higher_rates import derivatives_of as derivatives_of
    from linkwork.core.motion.iterating import (
        guessed_points as guessed_points,
        iterates as iterates,
        moving_loops as moving_loops,
        pulled_guess as pulled_guess,
        vector_loops as vector_loops,
    )
    from linkwork.core.motion.model import Model as Model, model_of as model_of
    from linkwork.core.motion.solving import (
        as_described as as_described,
        solve as solve,
        solve_round_start as solve_round_start,
    )
    from linkwork.core.motion.sweeping import sweep as sweep
else:
    __getattr__ = loader(__name__)
