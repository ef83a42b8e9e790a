"""A weld makes no equation: both links have one angle (see ``Frames``)."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.weld import Weld

__all__ = ["write"]


def write(weld: Weld, key: Key, rows: PartRows) -> None:
    """Nothing is left to write."""
