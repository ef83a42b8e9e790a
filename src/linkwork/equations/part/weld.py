"""Welds have no equations: both links share one angle variable (see ``Frames``)."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.weld import Weld

__all__ = ["write"]


def write(weld: Weld, key: Key, rows: PartRows) -> None:
    """Write no equation."""
