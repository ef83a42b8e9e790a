"""Springs have no equations."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.spring import Spring

__all__ = ["write"]


def write(spring: Spring, key: Key, rows: PartRows) -> None:
    """Write no equation."""
