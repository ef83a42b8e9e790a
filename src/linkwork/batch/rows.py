"""The solved rows of all designs, with their evidence."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.foundation.aligned import allocate_aligned
from linkwork.foundation.arrays import Array, BoolArray, StatusArray, TurnArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.numerics.rows import SolvedRows

__all__ = ["DesignRows"]


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRows:
    """D designs over R rows of inputs, internal units; written by the march, then frozen.

    ``v`` (n, R, D): unknowns, NaN where there is no position. ``status``, ``certification``
    (R, D): codes. ``radius`` (R, D): of the proof, weighted, NaN without one; (0, D) if none is
    requested. ``limits`` (2, D): lower and upper end of the branch, ``limit_kinds`` (2, D): their
    kinds, see :func:`linkwork.batch.limits.ends_as_limits`; NaN without a position.
    ``alone`` (D,): designs computed one at a time; ``own``: their own results. ``inputs``
    (R, p, D): if designs have inputs of their own instead of the table's.
    """

    v: Array
    status: StatusArray
    certification: StatusArray
    radius: Array
    limits: Array
    limit_kinds: StatusArray
    alone: BoolArray
    own: dict[int, SolvedRows] = field(default_factory=dict)
    inputs: Array | None = None

    @classmethod
    def blank(
        cls, unknowns: int, rows: int, designs: int, certify: bool, falling: bool
    ) -> DesignRows:
        """Rows without positions, uninitialised until they are filled or cleared.

        If inputs decrease, unknowns and radii are stored by increasing inputs, the order in which
        the march writes them.
        """
        way = slice(None, None, -1 if falling else 1)
        return cls(
            v=allocate_aligned(unknowns, rows, designs)[:, way],
            status=np.empty((rows, designs), dtype=np.int8),
            certification=np.empty((rows, designs), dtype=np.int8),
            radius=allocate_aligned(rows if certify else 0, designs)[way],
            limits=np.full((2, designs), np.nan),
            limit_kinds=np.zeros((2, designs), dtype=np.int8),
            alone=np.zeros(designs, dtype=bool),
        )

    @cached_property
    def turns(self) -> TurnArray:
        """Whole turns from the requested input to that of the position, (R, D)."""
        return np.zeros(self.status.shape, dtype=np.int32)

    def freeze(self) -> DesignRows:
        """Make all arrays read-only."""
        for array in vars(self).values():
            if isinstance(array, np.ndarray):
                array.setflags(write=False)
        return self

    def clear(self, where: BoolArray, certify: bool) -> None:
        """Remove the position of some rows (R, D) and the status of all."""
        self.v[:, where] = np.nan
        self.status[:] = Status.NO_START.code
        none = Certification.NO_POSITION if certify else Certification.NOT_ASKED
        self.certification[:] = none.code
        if certify:
            self.radius[where] = np.nan
