"""Columns of tables of text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Column"]


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of text; ``align`` is ``left``, ``right`` or ``point`` (the decimal point).

    ``units``, if given, are printed after the cells, one for each cell.
    """

    header: str
    cells: Sequence[str]
    align: str = "left"
    units: Sequence[str] = ()
