"""Loads have no equations."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.load import Load

__all__ = ["write"]


def write(load: Load, key: Key, rows: PartRows) -> None:
    """Write no equation."""
