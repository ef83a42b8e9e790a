"""A report as a PDF file, set by Typst."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from linkwork.core.results.listing.motion_listing import Column
from linkwork.writers.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Table,
    Text,
    figure_files,
    printed,
    template_text,
    typst_terms,
)

_ONE_LINE = 30  # characters of a cell


def pdf_bytes(document: Document, progress: Callable[[float], None]) -> bytes:
    """The document as the content of a PDF file."""
    import typst

    # Typst reads pictures from a folder only
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        widths: dict[int, float] = {}
        for number, content, widths[number] in figure_files(document, "svg", progress):
            (folder / f"{number}.svg").write_bytes(content)
        data = json.dumps(document_data(document, widths))
        (folder / "report.json").write_text(data, "utf-8")
        main = folder / "report.typ"
        main.write_text(template_text(main.name), "utf-8")
        pdf: bytes = typst.compile(main, root=folder, format="pdf", timestamp=0)
    return pdf


def document_data(document: Document, widths: Mapping[int, float]) -> dict[str, Any]:
    """The document as JSON-ready data for ``report.typ``; ``widths`` of the figures [mm]."""
    return {
        "title": document.title,
        "author": document.author,
        "byline": document.author_line,
        "colophon": f"Written by Linkwork {metadata.version('linkwork')}",
        "sections": [
            {"title": section.title, "blocks": [_block_data(b, widths) for b in section.blocks]}
            for section in document.sections
        ],
    }


def _block_data(block: Block, widths: Mapping[int, float]) -> dict[str, Any]:
    match block:
        case Text():
            return {"kind": block.style, "text": block.text}
        case Facts():
            return {"kind": "facts", "pairs": block.pairs}
        case Equation():
            formula = " ".join(typst_terms(block.mathml))
            return {"kind": "equation", "formula": formula, "number": block.number}
        case Table():
            return {
                "kind": "table",
                "caption": f"Table {block.number}. {block.caption}",
                "short": block.is_short,
                "columns": list(map(_column_data, block.columns)),
            }
        case Figure():
            return {
                "kind": "figure",
                "caption": f"Figure {block.number}. {block.caption}",
                "file": f"{block.number}.svg",
                "width": widths[block.number],
            }


def _column_data(column: Column) -> dict[str, Any]:
    words = column.align == "left"
    long = words and max(map(len, column.cells), default=0) > _ONE_LINE
    cells = printed(column)
    return {"header": column.header, "words": words, "long": long, "cells": cells}
