"""Decide whether compiled kernels can solve a mechanism faster than NumPy."""

from __future__ import annotations

from linkwork.kernels.program.kernel_cache import kernels_are_compiled, kernels_are_loaded
from linkwork.motion.model import Model

__all__ = ["are_served", "kernels_pay"]

_ROWS = 5_000  # with fewer, preparing the programs takes longer than the rows
_LOADING = 400_000  # proved rows times unknowns: as long does it take to load the kernels
_WITHOUT_PROOF = 0.4  # as much of that time is saved where nothing is proved


def are_served(model: Model) -> bool:
    """Whether kernels can solve a mechanism: loops and lines only, no redundant links."""
    equations = model.equations
    return bool(
        not model.compiled.table.functions and not equations.redundant and len(equations.inputs)
    )


def kernels_pay(model: Model, rows: int, certify: bool) -> bool:
    """Whether kernels take less time for so many rows of one mechanism than plain NumPy.

    Nothing is compiled for that: before the first family is solved, they do not.
    """
    if rows < _ROWS or not are_served(model):
        return False
    saved = rows * model.compiled.solver.unknowns * (1.0 if certify else _WITHOUT_PROOF)
    return kernels_are_loaded() or (saved >= _LOADING and kernels_are_compiled())
