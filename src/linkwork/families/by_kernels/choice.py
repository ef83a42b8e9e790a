"""Whether the kernels of families serve one design, too; without loading compiled code."""

from __future__ import annotations

from collections import Counter

from linkwork.core.motion.model import Model
from linkwork.families.compiled.code_cache import LOOPS, is_loaded, loop_serves

_LOOP = "independent"  # serves every mechanism


_FEW = 24  # with fewer rows, plain NumPy takes no longer


_MAKING = 3_000  # proved rows: as long does it take to make the kernels of a topology


_LOADING = 150_000  # proved rows times unknowns: as long does it take to load compiled code


_WORK = {"": 0}


def are_served(model: Model) -> bool:
    """Whether kernels can solve a mechanism: loops and lines only, no redundant links."""
    equations, compiled = model.equations, model.compiled
    plain = not compiled.table.functions and not equations.redundant
    return bool(plain and len(equations.inputs) and compiled.solver.unknowns)


def kernels_pay(model: Model, rows: int) -> bool:
    """Whether kernels take less time for this many rows of one mechanism than plain NumPy.

    Many small tables count like a long one. Nothing is compiled for that: before the first family
    is solved, kernels do not pay.
    """
    if rows < _FEW or not are_served(model):
        return False
    table = model.compiled.table
    if not any(map(is_loaded, LOOPS)):
        _WORK[""] += rows * table.unknowns
        if _WORK[""] < _LOADING:
            return False
        _WORK[""] = 0
    if not loop_serves(_LOOP, 0):
        return False
    _ROWS[table.structure] += rows
    return _ROWS[table.structure] >= _MAKING


#: The rows of every topology that have been asked for, and rows times unknowns of all of them
#: since compiled code was looked for last.
_ROWS: Counter[bytes] = Counter()
