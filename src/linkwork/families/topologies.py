"""Mechanisms as input of compiled kernels."""

from __future__ import annotations

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
