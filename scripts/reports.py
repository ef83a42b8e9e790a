"""Reports of library mechanisms, read back by pypdf and python-docx."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pathlib import Path

import linkwork as lw
from linkwork.writers.report.document import Figure, Table
from linkwork.writers.report.report import document_of, report_of
from linkwork.writers.report.sections import Findings, template_of

__all__ = ["READERS", "read_report"]

#: Packages that read the formats.
READERS = {".pdf": "pypdf", ".docx": "docx"}
_TEMPLATE = template_of("engineer")


@cache
def _found(name: str) -> Findings:
    return Findings(lw.example(name), _TEMPLATE)


def read_report(name: str, suffix: str, folder: Path) -> str:
    """The size of a report, and whether its tables and figures are those of the document."""
    found = _found(name)
    file = folder / f"report{suffix}"
    file.write_bytes(report_of(found, file)[0])
    document = document_of(found)
    blocks = [block for section in document.sections for block in section.blocks]
    tables = [block.number for block in blocks if isinstance(block, Table)]
    figures = [block.number for block in blocks if isinstance(block, Figure)]
    size = f"{len(tables)} tables, {len(figures)} figures"
    if suffix == ".docx":
        read = import_module("docx").Document(str(file))
        captions = [line.text for line in read.paragraphs]
        there = len(read.inline_shapes) == len(figures)
    else:
        pages = import_module("pypdf").PdfReader(file).pages
        captions = [" ".join(page.extract_text().split()) for page in pages]
        size, there = f"{len(pages)} pages, {size}", True
    text = "\n".join(captions)
    named = [f"Table {number}. " for number in tables] + [f"Figure {k}. " for k in figures]
    lost = [caption for caption in named if caption not in text]
    return size + ("" if there and not lost else f" WRONG {lost[:3]}")
