"""A report as a PDF file, set by Typst."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from linkwork.core.foundation.loading import installed_with
from linkwork.writers.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Listing,
    Note,
    Paragraph,
    Table,
    figure_files,
    printed,
    typst_terms,
)

_PREAMBLE = """\
#set document(title: TITLE, author: AUTHOR, date: none)
#set page(paper: "a4", margin: (x: 20mm, y: 22mm), numbering: "1 / 1")
#set text(size: 10pt, lang: "en", number-width: "tabular")
#set par(justify: false)
#set heading(numbering: "1")
#show heading: set block(above: 1.6em, below: 0.8em, sticky: true)
#show raw: set text(size: 8pt)
#let note(body) = block(above: 1.2em, below: 0.7em, sticky: true, strong(body))
#let facts(..cells) = grid(columns: (auto, 1fr), column-gutter: 1em, row-gutter: 0.55em,
  ..cells.pos())
#let formula(number, body) = block(inset: (left: 1.2em), width: 100%, breakable: false,
  grid(columns: (1fr, auto), column-gutter: 1em, par(leading: 0.9em, body), number))
#let cap(body) = block(above: 1.1em, below: 0.5em, sticky: true, text(size: 9pt, body))
#let listed(caption, short, columns, align, header, ..cells) = block(breakable: not short, {
  cap(caption)
  set text(size: 9pt)
  table(columns: columns, align: align, stroke: none, inset: (x: 5pt, y: 2.6pt),
    table.hline(stroke: 0.8pt), table.header(..header, table.hline(stroke: 0.4pt)),
    ..cells, table.hline(stroke: 0.8pt))
})
#let shown(path, width, caption) = block(breakable: false, above: 1.2em, below: 1.2em)[
  #align(center, image(path, width: width))
  #text(size: 9pt, caption)
]
"""


def typst_package() -> Any:
    """Typst.

    Raises
    ------
    MissingPackageError
        If it is not installed.
    """
    with installed_with("report", "PDF reports need Typst"):
        import typst
    return typst


def pdf_bytes(document: Document, progress: Callable[[float], None]) -> bytes:
    """The document as the content of a PDF file.

    Raises
    ------
    MissingPackageError
        If Typst is not installed.
    """
    typst = typst_package()
    # Typst reads pictures from a folder only
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        widths = {}
        for figure in figure_files(document, "svg", progress):
            (folder / f"{figure.number}.svg").write_bytes(figure.content)
            widths[figure.number] = figure.width
        main = folder / "main.typ"
        main.write_text(typst_text(document, widths), "utf-8")
        content: bytes = typst.compile(main, root=folder, format="pdf", timestamp=0)
    return content


def typst_text(document: Document, widths: Mapping[int, float]) -> str:
    """The document in Typst's language; ``widths`` of the figures [mm]."""
    author = dict(document.byline).get("author", "")
    head = _PREAMBLE.replace("TITLE", _quoted(document.title)).replace(
        "AUTHOR", f"({_quoted(author)},)" if author else "()"
    )
    byline = " · ".join(text for _, text in document.byline)
    lines = [head, f"#text(size: 18pt, weight: 700, {_quoted(document.title)})", ""]
    if byline:
        lines += [f"#text(fill: luma(90), {_quoted(byline)})", ""]
    for section in document.sections:
        lines += [f"#heading({_quoted(section.title)})", ""]
        for block in section.blocks:
            lines += [*_block(block, widths), ""]
    lines.append(f"#v(1fr)\n#text(size: 8pt, fill: luma(110), {_quoted(_colophon())})")
    return "\n".join(lines) + "\n"


def _colophon() -> str:
    return f"Written by Linkwork {metadata.version('linkwork')}"


def _block(block: Block, widths: Mapping[int, float]) -> Iterator[str]:
    match block:
        case Paragraph():
            yield f"#par({_quoted(block.text)})"
        case Note():
            yield f"#note({_quoted(block.text)})"
        case Facts():
            pairs = (f"text(fill: luma(90), {_quoted(a)}), {_quoted(b)}" for a, b in block.pairs)
            yield f"#facts({', '.join(pairs)})"
        case Equation():
            terms = " ".join(typst_terms(block.mathml))
            yield f"#formula[({block.number})][${terms}$]"
        case Table():
            yield from _table(block)
        case Figure():
            caption = _quoted(f"Figure {block.number}. {block.caption}")
            width = f"{widths[block.number]:.1f}mm"
            yield f'#shown("{block.number}.svg", {width}, {caption})'
        case Listing():
            yield f"#raw({_quoted(block.text)}, block: true)"


def _table(table: Table) -> Iterator[str]:
    words = [column.align == "left" for column in table.columns]
    # a single column of words takes the rest of the line
    wide = [max(map(len, column.cells), default=0) > 30 for column in table.columns]
    columns = ", ".join(
        "1fr" if w and long else "auto" for w, long in zip(words, wide, strict=True)
    )
    align = ", ".join("left" if word else "right" for word in words)
    header = ", ".join(f"strong({_quoted(column.header)})" for column in table.columns)
    caption = _quoted(f"Table {table.number}. {table.caption}")
    short = "true" if table.is_short else "false"
    yield f"#listed({caption}, {short}, ({columns},), ({align},), ({header},),"
    for cells in zip(*map(printed, table.columns), strict=True):
        yield "  " + ", ".join(map(_quoted, cells)) + ","
    yield ")"


def _quoted(text: str) -> str:
    """A text as a string of Typst's language."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
