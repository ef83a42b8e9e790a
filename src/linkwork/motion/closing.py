"""Why loops do not close: which loop, and how large the gap is."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.status import Status
from linkwork.motion.model import Model
from linkwork.numerics.least_squares import nearest_miss

__all__ = ["explain"]

_CLOSED = 1e-10  # relative gap below which a position was found after all


def explain(model: Model, v: Array, status: Status, failed_block: int) -> tuple[Status, str]:
    """The status and sentence for a block that Newton-Raphson could not solve from ``v`` (N,).

    Blocks before the failed one are solved first; the failed one is brought as near to closing as
    a damped least-squares iteration can.
    """
    solver = model.compiled.solver
    before = solver.solve(v[None, :])
    block = solver.blocks[failed_block]
    guess = before.v[0].copy()
    guess[block.unknowns] = v[block.unknowns]
    nearest, f = nearest_miss(block.system, guess[block.variables])
    equations = model.equations
    labels = [equations.labels[e] for e in block.equations]
    loops = [k for k, e in enumerate(block.equations) if e < len(equations.loops)]
    if not np.isfinite(f).all():
        return status, status.value
    if np.abs(f / block.system.equation_scale).max() <= _CLOSED:
        values = ", ".join(
            f"{equations.unknowns[k].name} = {value / _scale(model, k):.6g}"
            for k, value in zip(block.unknowns, nearest, strict=False)
        )
        return status, f"{status.value}; a damped iteration from there does find {values}"
    if not loops or not equations.loops:
        worst = int(np.argmax(np.abs(f)))
        return status, (
            f'{status.value}; "{labels[worst % len(labels)]}" stays at {f[worst]:.6g} '
            "at best nearby"
        )
    count = len(loops)
    gaps = np.hypot(f[:count], f[count : 2 * count])
    worst = int(np.argmax(gaps))
    total = float(np.linalg.norm(gaps))
    where = ", ".join(
        f"{variable.name} = {v[solver.unknowns + k] / model.input_scale[k]:.6g}"
        f"{model.units.angle.sign if variable.kind == 'angle' else ' ' + model.units.length}"
        for k, variable in enumerate(equations.inputs)
    )
    at = f" at {where}" if where else ""
    unit = model.units.length
    names = f'loop "{labels[loops[worst]]}"'
    if count > 1:
        names += f" (largest of {count} coupled loops, together {total:.6g} {unit})"
    return (
        Status.CANNOT_CLOSE,
        f"{names} cannot be closed{at}: nearest to the guess a gap of {gaps[worst]:.6g} {unit} "
        "remains; change a length or start elsewhere",
    )


def _scale(model: Model, unknown: int) -> float:
    return model.units.angle.radians if model.equations.unknowns[unknown].kind == "angle" else 1.0
