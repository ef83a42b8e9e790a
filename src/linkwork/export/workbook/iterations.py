"""The values of the Newton cells, in which every row starts from the row above."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.export.formulas.closure_formulas import ClosureFormulas
from linkwork.foundation.arrays import AnyArray, Array, BoolArray, IndexArray
from linkwork.motion.model import Model
from linkwork.numerics.newton import corrections
from linkwork.results.motion import Motion

__all__ = ["Iterations", "iterated"]

_FEWEST, _MOST = 3, 8  # iterations in a row of cells
_SPARE = 1  # additional iterations, for changed dimensions
_DONE = 1e-11  # weighted: a correction of this size is the last one needed
_RIGHT = 1e-10  # weighted: tolerance between the cells and the position


@dataclass(frozen=True, kw_only=True, eq=False)
class Iterations:
    """The iterations of R requested rows.

    Parameters
    ----------
    rows : (R,)
        Row numbers in the motion.
    values : (K + 1, R, N)
        Unknowns at every iterate, then inputs, in file units; NaN without a position.
    above : (R,)
        The row from which each row starts, -1 for a separate estimate.
    found, live : (R,) bool
        Rows with a position, and those whose cells find it.
    """

    rows: IndexArray
    values: Array
    above: IndexArray
    found: BoolArray
    live: BoolArray

    @property
    def count(self) -> int:
        """K: the number of iterations of every row."""
        return len(self.values) - 1


def iterated(model: Model, motion: Motion, closure: ClosureFormulas) -> Iterations:
    """Simulate the cells.

    A row that does not converge to its position from the row above starts from a rounded estimate
    of it; if that fails too, as at a change point, its cells contain values only.
    """
    rows = np.flatnonzero(motion.asked)
    scale = _file_units(model)
    inputs = np.stack([motion.inputs[v.name] for v in model.equations.inputs], axis=1)[rows]
    right = np.concatenate([motion.q[rows] / scale[: motion.q.shape[1]], inputs], axis=1)
    found = motion.found[rows] & np.isfinite(right).all(axis=1)
    right[~found] = np.nan
    before = np.full(len(rows), -1, dtype=np.intp)
    last = -1
    for k in range(len(rows)):
        before[k] = last
        # rows without a position are skipped: nothing can start from them
        last = k if found[k] else last
    start, above = _rounded(model, right), np.full(len(rows), -1, dtype=np.intp)
    values = np.repeat(right[None], _MOST + 1, axis=0)
    live = np.zeros(len(rows), dtype=bool)
    # each attempt takes the rows that the one before it could not recalculate
    for attempt in ("above", "estimate", "value"):
        trying = np.flatnonzero(found & ~live & ((before >= 0) | (attempt != "above")))
        if attempt == "above":
            guess = right[before[trying]]
        else:
            guess = start[trying] if attempt == "estimate" else right[trying]
        tried = _newton(model, closure, guess, right[trying])
        away = np.abs((tried[-1] - right[trying]) * scale / _sizes(model)).max(axis=1, initial=0.0)
        good = away <= _RIGHT
        values[:, trying[good]] = tried[:, good]
        live[trying[good]] = True
        if attempt == "above":
            above[trying[good]] = before[trying[good]]
        # the cells of such a row hold the solution itself
        elif attempt == "value":
            values[:, trying[~good]] = right[trying[~good]]
    needed = _needed(model, values[:, live])
    return Iterations(
        rows=rows,
        values=values[: min(max(needed + _SPARE, _FEWEST), _MOST) + 1],
        above=above,
        found=found,
        live=live,
    )


def _file_units(model: Model) -> Array:
    """Internal units per file unit of all variables, (N,)."""
    turns = np.array([v.kind == "angle" for v in model.equations.variables])
    return np.where(turns, model.equations.angle.radians, 1.0)


def _sizes(model: Model) -> Array:
    return model.compiled.solver.variable_scale


def _rounded(model: Model, right: Array) -> Array:
    """Estimates rounded to three digits of a variable's size."""
    digits = [
        int(2 - np.floor(np.log10(size / unit)))
        for size, unit in zip(_sizes(model), _file_units(model), strict=True)
    ]
    columns = [np.round(column, d) for column, d in zip(right.T, digits, strict=True)]
    return np.stack(columns, axis=1) if columns else right


def _newton(model: Model, closure: ClosureFormulas, guess: Array, right: Array) -> Array:
    """Iterates of the cells, (K + 1, B, N), block by block with the values of earlier blocks."""
    scale = _file_units(model)
    known = right.copy()
    values = np.repeat(right[None], _MOST + 1, axis=0)
    for block, formulas in zip(model.compiled.solver.blocks, closure.blocks, strict=True):
        if not formulas.rows:
            continue
        own = block.unknowns
        known[:, own] = guess[:, own]
        values[0][:, own] = guess[:, own]
        for k in range(_MOST):
            here = (known * scale)[:, block.variables]
            with np.errstate(all="ignore"):
                f, jacobian = block.system.residual_and_jacobian(here)
                # full steps: cells have no step control
                change, _ = corrections(jacobian[:, :, : len(own)], f)
            known[:, own] += change / scale[own]
            values[k + 1][:, own] = known[:, own]
    return values


def _needed(model: Model, values: Array) -> int:
    """The number of iterations until all rows converge; the most if cells solve none."""
    if not values.shape[1]:
        return _MOST
    scale = _file_units(model) / _sizes(model)
    changes: AnyArray = np.abs(np.diff(values, axis=0) * scale).max(axis=(1, 2), initial=0.0)
    large = np.flatnonzero(changes > _DONE)
    return int(large[-1]) + 1 if len(large) else 1
