"""Names of cells: ``a2`` is the address of a cell, so the dimension a2 is called ``a2_``."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from linkwork.foundation.names import canonical

__all__ = ["CellNames", "chart_text"]

#: Names that spreadsheets read as a cell, row, column or Boolean.
_TAKEN = re.compile(r"[a-z]{1,3}[0-9]+|[rc][0-9]*([rc][0-9]*)?|true|false", re.IGNORECASE)
_ODD = re.compile(r"[^\w.]")
_LONGEST = 200


def chart_text(text: str) -> str:
    """A text for a chart's title or axis: XlsxWriter takes what looks like ``sheet!A1`` for a cell.

    An invisible character (U+2060, word joiner) after the mark makes it a text.
    """
    return text.replace("!", "!\u2060")


@dataclass
class CellNames:
    """Unique valid names of cells; spreadsheets ignore case."""

    cells: dict[str, str] = field(default_factory=dict)
    _used: set[str] = field(default_factory=set)

    def claim(self, key: str, wanted: str) -> str:
        """A cell name for ``key``, as similar as possible to the preferred one."""
        stem = _ODD.sub("_", canonical(wanted).replace("'", "_prime"))[:_LONGEST]
        if not (stem[0].isalpha() or stem[0] == "_"):
            stem = f"_{stem}"
        if _TAKEN.fullmatch(stem):
            stem += "_"
        name, count = stem, 1
        while name.casefold() in self._used:
            count += 1
            name = f"{stem.rstrip('_')}_{count}"
        self._used.add(name.casefold())
        self.cells[key] = name
        return name
