"""Writing results for other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.export.csv_file import csv_lines, csv_text
    from linkwork.export.workbook.workbook import WrittenWorkbook, workbook_of
else:
    __getattr__ = loader(
        __name__,
        {
            "csv_file": ("csv_lines", "csv_text"),
            "workbook.workbook": ("WrittenWorkbook", "workbook_of"),
        },
    )

__all__ = ["WrittenWorkbook", "csv_lines", "csv_text", "workbook_of"]
