"""The input limits of every design of a family."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, StatusArray
from linkwork.foundation.frozen import read_only
from linkwork.foundation.internal import internal
from linkwork.motion.limits import BranchEnd
from linkwork.results.motion import LimitKind

__all__ = ["LIMIT_KINDS", "FamilyLimits", "ends_as_limits"]

#: Kind of the end of a branch, by code; 0 for none.
LIMIT_KINDS: tuple[LimitKind | None, ...] = (None, *LimitKind)


@internal("of")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FamilyLimits:
    """The ends of the branch on which each of D designs starts.

    Parameters
    ----------
    lower, upper : (D,)
        The leading input at the ends, in file units, below and above the input of the design's
        start: -∞, ∞ if the branch has no end on the path to the rows of the table; NaN if an end
        was met but not located, or the design has no position.
    lower_kind, upper_kind : (D,) text
        ``dead point``, ``change point``, ``limit`` (not located), or "" for none.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").driven_by(link="rocker", relative_to="ground")
    >>> limits = bar.family({"O2 A": [40, 42]}).sweep().limits
    >>> limits.lower.round(2), limits.lower_kind
    (array([54.9 , 52.03]), array(['dead point', 'dead point'], dtype='<U12'))
    """

    lower: Array
    upper: Array
    lower_kind: AnyArray
    upper_kind: AnyArray

    def __post_init__(self) -> None:
        for field in ("lower", "upper", "lower_kind", "upper_kind"):
            object.__setattr__(self, field, read_only(getattr(self, field)))

    @classmethod
    def of(cls, limits: Array, kinds: StatusArray, unit: float) -> FamilyLimits:
        """Limits from values (2, D) and codes (2, D); ``unit``: internal units per file unit."""
        words = np.array(["" if kind is None else kind.word for kind in LIMIT_KINDS])
        lower, upper = limits / unit
        lower_kind, upper_kind = words[kinds]
        return cls(lower=lower, upper=upper, lower_kind=lower_kind, upper_kind=upper_kind)

    def __len__(self) -> int:
        return len(self.lower)

    def __repr__(self) -> str:
        ends = np.concatenate([self.lower_kind, self.upper_kind])
        told = ", ".join(
            f"{int((ends == kind.word).sum())} {kind.word}s" for kind in LIMIT_KINDS if kind
        )
        return f"<FamilyLimits of {len(self)} designs: {told}>"


def ends_as_limits(ends: Iterable[BranchEnd]) -> tuple[Array, StatusArray]:
    """Where a branch ends below and above, values of the path (2,), and the kinds as codes (2,).

    Infinite where nothing ended it, NaN where the place was not located.
    """
    limits, kinds = np.array([-np.inf, np.inf]), np.zeros(2, dtype=np.int8)
    for end in ends:
        which = int(end.side > 0.0)
        limits[which] = end.t if end.limit.located else np.nan
        kinds[which] = LIMIT_KINDS.index(end.limit.kind)
    return limits, kinds
