"""Rows and limits of a design swept alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from linkwork.batch.limits import LIMIT_KINDS
from linkwork.foundation.arrays import Array, BoolArray, StatusArray
from linkwork.motion.limits import BranchEnd
from linkwork.motion.rows import SolvedRows

__all__ = ["SingleRows", "ends_as_limits"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SingleRows:
    """Derivatives of the unknowns with respect to the leading input, (n, R) each; ``driven`` (2,
    R): whether the inputs have both derivatives (not at a dead point); ``condition``, ``residual``
    (R,).
    """

    first: Array
    second: Array
    driven: BoolArray
    condition: Array
    residual: Array

    @classmethod
    def of(cls, rows: SolvedRows, unknowns: int) -> SingleRows:
        """The fields of solved rows."""
        return cls(
            first=rows.first[:, :unknowns].T.copy(),
            second=rows.second[:, :unknowns].T.copy(),
            driven=~np.isnan([rows.first[:, -1], rows.second[:, -1]]),
            condition=rows.condition,
            residual=rows.residual,
        )


def ends_as_limits(ends: Iterable[BranchEnd]) -> tuple[Array, StatusArray]:
    """Lower and upper end of a branch as path parameters (2,), and their kinds as codes (2,).

    Infinite without an end, NaN if the end was not located.
    """
    limits, kinds = np.array([-np.inf, np.inf]), np.zeros(2, dtype=np.int8)
    for end in ends:
        which = int(end.side > 0.0)
        limits[which] = end.t if end.limit.located else np.nan
        kinds[which] = LIMIT_KINDS.index(end.limit.kind)
    return limits, kinds
