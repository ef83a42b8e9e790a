"""Mechanisms as input of compiled kernels."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.motion.model import Model
from linkwork.core.record.closure import BlockPart

# ----------------------------------------------------------------------
# The equations of a mechanism as input of compiled kernels.


def are_served(model: Model) -> bool:
    """Whether kernels can solve a mechanism: loops and lines only, no redundant links."""
    equations, compiled = model.equations, model.compiled
    plain = not compiled.table.functions and not equations.redundant
    return bool(plain and len(equations.inputs) and compiled.solver.unknowns)


def block_parts(model: Model) -> list[BlockPart]:
    """The blocks of a mechanism in the order in which they are solved."""
    return [
        BlockPart(equations=block.equations, unknowns=tuple(block.unknowns.tolist()))
        for block in model.compiled.solver.blocks
    ]


def lines_of_lengths(model: Model) -> set[int]:
    """The linear rows that are equations of lengths."""
    return {k for k, line in enumerate(model.equations.linear) if line.kind == "length"}


def own_coefficients(model: Model) -> dict[str, Array]:
    """A mechanism's own coefficients, constants and weights, (1,) each, by register."""
    table = model.compiled.table
    found = {"length": model.equations.length_scale}
    for term, c in enumerate(table.loops.coefficient.tolist()):
        found[f"c{term}.re"], found[f"c{term}.im"] = c.real, c.imag
    found |= {f"k{row}": x for row, x in enumerate(table.linear.constant.tolist())}
    weights = table.variable_scale.tolist()
    found |= {f"scale{k}": weights[k] for k in np.flatnonzero(~table.is_angle).tolist()}
    return {name: np.array([value]) for name, value in found.items()}


def zero_names(coefficients: Mapping[str, Array]) -> frozenset[str]:
    """Names of those that are zero."""
    return frozenset(name for name, values in coefficients.items() if not values.any())
