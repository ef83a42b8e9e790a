"""Solved rows of a motion's table in internal units, with their evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, CountArray, IndexArray, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.proving import RowProofs

__all__ = ["SolvedRows"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedRows:
    """B rows; ``v``, ``first``, ``second`` (B, N) are NaN where there is no position.

    ``inputs`` (B, p): the values asked for, in file units. ``branch``, ``limit``: names, or "".
    """

    inputs: Array
    v: Array
    first: Array
    second: Array
    status: StatusArray
    iterations: CountArray
    residual: Array
    condition: Array
    certification: StatusArray
    radius: Array
    uniqueness_radius: Array
    branch: AnyArray
    limit: AnyArray

    def __len__(self) -> int:
        return len(self.status)

    @classmethod
    def blank(cls, inputs: Array, variables: int, status: Status) -> SolvedRows:
        """Rows without positions, all for one reason."""
        count = len(inputs)
        nothing = np.full((count, variables), np.nan)
        unknown = np.full(count, np.nan)
        names = np.full(count, "", dtype=object)
        return cls(
            inputs=np.array(inputs, dtype=float),
            v=nothing,
            first=nothing.copy(),
            second=nothing.copy(),
            status=np.full(count, status.code, dtype=np.int8),
            iterations=np.zeros(count, dtype=np.int64),
            residual=unknown,
            condition=unknown.copy(),
            certification=np.full(count, Certification.NO_POSITION.code, dtype=np.int8),
            radius=unknown.copy(),
            uniqueness_radius=unknown.copy(),
            branch=names,
            limit=names.copy(),
        )

    def prove(self, where: IndexArray, proofs: RowProofs) -> None:
        """Note the proofs of some rows."""
        self.certification[where] = proofs.code
        self.radius[where], self.uniqueness_radius[where] = proofs.radius, proofs.uniqueness_radius

    def demote(self, standing: Certification) -> None:
        """Give rows that are proved on a branch the certification of the way to the branch."""
        self.certification[self.certification == Certification.CERTIFIED.code] = standing.code

    def put(self, where: IndexArray, others: SolvedRows) -> None:
        """Replace some rows by others, one by one."""
        for field in fields(self):
            getattr(self, field.name)[where] = getattr(others, field.name)

    def take(self, where: IndexArray) -> SolvedRows:
        """Some rows, in the order of ``where``."""
        return SolvedRows(**{f.name: getattr(self, f.name)[where] for f in fields(self)})

    @classmethod
    def concatenate(cls, parts: Sequence[SolvedRows]) -> SolvedRows:
        """Rows one behind the other."""

        def stacked(name: str) -> AnyArray:
            return np.concatenate([getattr(part, name) for part in parts])

        return cls(**{f.name: stacked(f.name) for f in fields(cls)})
