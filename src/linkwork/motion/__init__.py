"""Positions, whole cycles and rates of a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.motion.assembly.configurations import (
        configurations,
        solve_configuration,
        start_in_configuration,
    )
    from linkwork.motion.checking import check
    from linkwork.motion.circuit.circuits import branch_start, circuits
    from linkwork.motion.classifying.inverting import driven_otherwise, inversion, inversions
    from linkwork.motion.described import as_described
    from linkwork.motion.extremes import check_quantities
    from linkwork.motion.iterating import guessed_points, iterates, pulled_guess
    from linkwork.motion.model import Model, model_of
    from linkwork.motion.nearest_assembling import nearest_assembly
    from linkwork.motion.solving import solve
    from linkwork.motion.sweeping import sweep
    from linkwork.motion.vector_loops import moving_loops, vector_loops
    from linkwork.motion.warm_start import warm_started
else:
    __getattr__ = loader(
        __name__,
        {
            "assembly.configurations": (
                "configurations",
                "solve_configuration",
                "start_in_configuration",
            ),
            "described": ("as_described",),
            "checking": ("check",),
            "circuit.circuits": ("branch_start", "circuits"),
            "extremes": ("check_quantities",),
            "classifying.inverting": ("driven_otherwise", "inversion", "inversions"),
            "iterating": ("guessed_points", "iterates", "pulled_guess"),
            "model": ("Model", "model_of"),
            "nearest_assembling": ("nearest_assembly",),
            "warm_start": ("warm_started",),
            "solving": ("solve",),
            "sweeping": ("sweep",),
            "vector_loops": ("moving_loops", "vector_loops"),
        },
    )

__all__ = [
    "Model",
    "as_described",
    "branch_start",
    "check",
    "check_quantities",
    "circuits",
    "configurations",
    "driven_otherwise",
    "guessed_points",
    "inversion",
    "inversions",
    "iterates",
    "model_of",
    "moving_loops",
    "nearest_assembly",
    "pulled_guess",
    "solve",
    "solve_configuration",
    "start_in_configuration",
    "sweep",
    "vector_loops",
    "warm_started",
]
