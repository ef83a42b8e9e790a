"""Solved rows, and in which of them variables have finite derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.position import Position
from linkwork.results.quantities.definition import Solved

__all__ = ["RegularRows", "row_of", "rows_of"]


@dataclass(frozen=True, eq=False)
class RegularRows:
    """Solved rows: variables (B, N), which exist, which have rates, and the rows themselves."""

    v: Array
    found: BoolArray
    regular: BoolArray
    solved: Solved

    def take(self, order: IndexArray) -> RegularRows:
        """Rows in another order."""
        return RegularRows(self.v[order], self.found[order], self.regular[order], self.solved)


def row_of(model: Model, position: Position) -> RegularRows:
    """One position as a row."""
    v = np.append(position.q, np.array([*position.input.values()]) * model.input_scale)[None, :]
    found = np.array([position.status.ok])
    return RegularRows(v, found, _rates_exist(model, position, 1), position)


def rows_of(model: Model, motion: Motion, *further: Motion) -> RegularRows:
    """The rows of a motion, and those of further ones behind them."""
    parts = (motion, *further)
    v = [
        np.column_stack(
            [each.q, *(each.inputs[x.name] * s for x, s in zip(
                model.equations.inputs, model.input_scale, strict=True))]
        )
        for each in parts
    ]  # fmt: skip
    found = np.concatenate([each.found for each in parts])
    regular = np.concatenate([_rates_exist(model, each, len(each)) for each in parts])
    return RegularRows(np.concatenate(v), found, regular, motion)


def _rates_exist(model: Model, solved: Solved, count: int) -> BoolArray:
    """Where the unknowns have derivatives by the input."""
    found = np.ones(count, dtype=bool)
    if model.equations.inputs:
        for unknown in model.motion_quantities.names.unknowns:
            found &= np.isfinite(np.atleast_1d(solved.own(unknown).d1))
    return found
