"""The coefficients of designs by register of the compiled programs."""

from __future__ import annotations

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.foundation.arrays import Array

__all__ = ["loop_coefficients", "zero_coefficients"]


def loop_coefficients(designs: Designs) -> dict[str, Array]:
    """Coefficients of loops, constants of lines, weights of lengths, (D,) each."""
    found: dict[str, Array] = {}
    for term in range(designs.loops.shape[1]):
        column = designs.loops[:, term]
        found[f"c{term}.re"] = np.ascontiguousarray(column.real)
        found[f"c{term}.im"] = np.ascontiguousarray(column.imag)
    for row in range(designs.linear.shape[1]):
        found[f"k{row}"] = np.ascontiguousarray(designs.linear[:, row])
    for k, turns in enumerate(designs.base.compiled.table.is_angle):
        if not turns:
            found[f"scale{k}"] = designs.length_scale
    return found


def zero_coefficients(designs: Designs, coefficients: dict[str, Array]) -> set[str]:
    """Coefficients that are 0 in every design without a problem."""
    fine = np.flatnonzero(designs.problem == 0)
    which = slice(None) if len(fine) == len(designs) else fine
    return {name for name, values in coefficients.items() if not values[which].any()}
