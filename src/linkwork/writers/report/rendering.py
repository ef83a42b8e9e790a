"""The report as a page, a PDF and a Word file."""

from __future__ import annotations

import io
import json
import re
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime
from html import escape
from importlib import metadata
from pathlib import Path
from string import Template as StringTemplate
from typing import Any
from urllib.parse import quote

from linkwork.core.drawing.matplotlib_writer import render
from linkwork.core.drawing.scene import Scene
from linkwork.core.drawing.vector_files import FixedInks, embedded_svg, inline_svg
from linkwork.core.results.listing import Column
from linkwork.writers.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Table,
    Text,
    figure_files,
    mathml_terms,
    office_terms,
    printed,
    template_text,
    typst_terms,
)

# ----------------------------------------------------------------------
# A report as a Word document, with equations that Word can edit.


_MATH = "http://schemas.openxmlformats.org/officeDocument/2006/math"
_DATE = (1980, 1, 1, 0, 0, 0)  # the first that archives can have
_SMALL, _CODE = 8.5, 8  # font sizes [pt]
_LABEL, _TEXT = 40, 126  # widths of the columns of facts [mm]
_LETTER, _SPACE = 1.9, 5.0  # width of a letter and of the margins of a cell [mm]
_WIDTH = 166.0  # of a table [mm]
_FONT, _MONOSPACED = "Arial", "DejaVu Sans Mono"


def docx_bytes(document: Document, progress: Callable[[float], None]) -> bytes:
    """The document as the content of a .docx file."""
    import docx

    pictures = {number: picture for number, *picture in figure_files(document, "png", progress)}
    file = docx.Document()
    _Writer(file, pictures).write(document)
    buffer = io.BytesIO()
    file.save(buffer)
    return _dateless(buffer.getvalue())


def _dateless(content: bytes) -> bytes:
    """The archive with fixed dates, so that the same report has the same bytes."""
    buffer = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(content)) as old,
        zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for entry in old.infolist():
            entry.date_time = _DATE
            new.writestr(entry, old.read(entry.filename), zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


class _Writer:
    """Writes blocks at the end of a document."""

    def __init__(self, file: Any, pictures: Mapping[int, Sequence[Any]]) -> None:
        import docx.enum.text
        import docx.oxml
        import docx.shared

        self.file, self.pictures = file, pictures
        self.shared, self.parse = docx.shared, docx.oxml.parse_xml
        self.right = docx.enum.text.WD_ALIGN_PARAGRAPH.RIGHT

    def write(self, document: Document) -> None:
        """The title, the lines about the author, and all sections."""
        self._set_up(document)
        self.file.add_heading(document.title, 0)
        if document.author_line:
            self.file.add_paragraph(document.author_line)
        for number, section in enumerate(document.sections, 1):
            self.file.add_heading(f"{number} {section.title}", 1)
            for block in section.blocks:
                self._block(block)

    def _set_up(self, document: Document) -> None:
        properties = self.file.core_properties
        properties.title, properties.author = document.title, document.author
        properties.comments, properties.last_modified_by = "Written by Linkwork", ""
        properties.created = properties.modified = datetime(*_DATE)
        page, millimetres = self.file.sections[0], self.shared.Mm
        page.page_width, page.page_height = millimetres(210), millimetres(297)
        page.left_margin = page.right_margin = millimetres(22)
        page.top_margin = page.bottom_margin = millimetres(22)
        normal = self.file.styles["Normal"]
        normal.font.size, normal.font.name = self.shared.Pt(10), _FONT
        normal.paragraph_format.space_after = self.shared.Pt(4)

    def _block(self, block: Block) -> None:
        match block:
            case Text(style="paragraph"):
                self.file.add_paragraph(block.text)
            case Text(style="note"):
                self.file.add_heading(block.text, 2)
            case Text():
                run = self.file.add_paragraph().add_run(block.text)
                run.font.size, run.font.name = self.shared.Pt(_CODE), _MONOSPACED
            case Facts():
                self._facts(block)
            case Equation():
                self._equation(block)
            case Table():
                self._table(block)
            case Figure():
                self._figure(block)

    def _facts(self, facts: Facts) -> None:
        if facts.pairs:
            cells = list(map(list, zip(*facts.pairs, strict=True)))
            self._grid(cells, (_LABEL, _TEXT), (False, False))
            self.file.add_paragraph()

    def _equation(self, equation: Equation) -> None:
        line = self.file.add_paragraph()
        line.paragraph_format.left_indent = self.shared.Mm(8)
        for term in office_terms(equation.mathml):
            line._p.append(self.parse(f'<m:oMath xmlns:m="{_MATH}">{term}</m:oMath>'))
            line.add_run(" ")
        line.add_run(f"   ({equation.number})")

    def _caption(self, text: str, *, above: bool) -> None:
        line = self.file.add_paragraph()
        line.paragraph_format.keep_with_next = above
        line.add_run(text).font.size = self.shared.Pt(_SMALL)

    def _table(self, table: Table) -> None:
        self._caption(f"Table {table.number}. {table.caption}", above=True)
        cells = [[c.header, *printed(c)] for c in table.columns]
        words = [column.align == "left" for column in table.columns]
        widths = [_SPACE + _LETTER * max(map(len, column)) for column in cells]
        if sum(widths) > _WIDTH:  # words are broken into lines
            numbers = sum(w for w, is_words in zip(widths, words, strict=True) if not is_words)
            most = (_WIDTH - numbers) / max(sum(words), 1)
            widths = [min(w, most) if i else w for w, i in zip(widths, words, strict=True)]
        grid = self._grid(cells, widths, [not is_words for is_words in words])
        for cell in grid.rows[0].cells:
            cell.paragraphs[0].runs[0].font.bold = True
        if table.is_short:
            for cell in grid.columns[0].cells[:-1]:
                cell.paragraphs[0].paragraph_format.keep_with_next = True
        self._rules(grid)
        self.file.add_paragraph()

    def _grid(
        self, columns: Sequence[Sequence[str]], widths: Sequence[float], right: Sequence[bool]
    ) -> Any:
        """A table without lines: ``widths`` of its columns [mm], and which are flush right."""
        grid = self.file.add_table(len(columns[0]), len(columns))
        grid.autofit = False
        for column, texts, size, flush in zip(grid.columns, columns, widths, right, strict=True):
            column.width = self.shared.Mm(size)
            for place, shown in zip(column.cells, texts, strict=True):
                place.width = self.shared.Mm(size)
                line = place.paragraphs[0]
                line.paragraph_format.space_after = self.shared.Pt(0)
                if flush:
                    line.alignment = self.right
                line.add_run(shown).font.size = self.shared.Pt(_SMALL)
        return grid

    def _rules(self, grid: Any) -> None:
        """Lines above and below the head and below the table; the head is repeated on each page."""
        border = '<w:{side} w:val="single" w:sz="{size}" w:color="333333"/>'
        sides = [border.format(side=side, size=8) for side in ("top", "bottom")]
        borders = f'<w:tblBorders xmlns:w="{_WORD}">{"".join(sides)}</w:tblBorders>'
        grid._tbl.tblPr.append(self.parse(borders))
        for cell in grid.rows[0].cells:
            below = border.format(side="bottom", size=4)
            borders = f'<w:tcBorders xmlns:w="{_WORD}">{below}</w:tcBorders>'
            cell._tc.get_or_add_tcPr().append(self.parse(borders))
        head = grid.rows[0]._tr.get_or_add_trPr()
        head.append(self.parse(f'<w:tblHeader xmlns:w="{_WORD}"/>'))

    def _figure(self, figure: Figure) -> None:
        content, width = self.pictures[figure.number]
        self.file.add_picture(io.BytesIO(content), width=self.shared.Mm(width))
        self.file.paragraphs[-1].paragraph_format.keep_with_next = True
        self._caption(f"Figure {figure.number}. {figure.caption}", above=False)


_WORD = "http://schemas.openxmlformats.org/wordprocessingml/2006/main"


# ----------------------------------------------------------------------
# A report as one HTML file that works offline and prints well on A4.


_ONE_LINE = 30  # characters of a cell
_LONGEST = 620.0  # of a drawing [CSS pixels]


def html_bytes(document: Document, progress: Callable[[float], None]) -> bytes:
    """The document as the content of an HTML file."""
    parts = []
    for k, section in enumerate(document.sections, 1):
        blocks = map(_html_block, section.blocks)
        heading = f'<h2 id="section-{k}">{k} {escape(section.title)}</h2>'
        parts += [f"<section>{heading}", *blocks, "</section>"]
        progress(k / len(document.sections))
    byline = escape(document.author_line)
    contents = (
        f'<li><a href="#section-{k}">{escape(section.title)}</a></li>'
        for k, section in enumerate(document.sections, 1)
    )
    page = StringTemplate(template_text("report.html")).substitute(
        title=escape(document.title),
        style=template_text("report.css"),
        byline=f'<p class="byline">{byline}</p>\n' if byline else "",
        contents="".join(contents),
        sections="\n".join(parts),
    )
    return page.encode()


def _html_block(block: Block) -> str:
    match block:
        case Text():
            tag = {"paragraph": "p", "note": "h3", "listing": "pre"}[block.style]
            return f"<{tag}>{escape(block.text)}</{tag}>"
        case Facts():
            pairs = (f"<dt>{escape(a)}</dt><dd>{escape(b)}</dd>" for a, b in block.pairs)
            return f"<dl>{''.join(pairs)}</dl>"
        case Equation():
            terms = " ".join(mathml_terms(block.mathml))
            return f'<div class="equation"><span>{terms}</span><span>({block.number})</span></div>'
        case Table():
            return _table(block)
        case Figure():
            caption = f"Figure {block.number}. {escape(block.caption)}"
            return f"<figure>{_svg(block)}<figcaption>{caption}</figcaption></figure>"


def _table(table: Table) -> str:
    looks = [_look(column) for column in table.columns]

    def row(cells: Sequence[str], tag: str) -> str:
        shown = zip(cells, looks, strict=True)
        return f"<tr>{''.join(f'<{tag}{look}>{escape(c)}</{tag}>' for c, look in shown)}</tr>"

    head = row([column.header for column in table.columns], "th")
    rows = zip(*map(printed, table.columns), strict=True)
    body = "".join(row(cells, "td") for cells in rows)
    name = f"table-{table.number}"
    kind = "scroll short" if table.is_short else "scroll"
    return (
        f'<p class="caption" id="{name}">Table {table.number}. {escape(table.caption)}</p>'
        f'<div class="{kind}" tabindex="0" role="group" aria-labelledby="{name}"><table>'
        f"<thead>{head}</thead><tbody>{body}</tbody></table></div>"
    )


def _look(column: Column) -> str:
    """Numbers to the right, short words on one line, sentences broken."""
    if column.align != "left":
        return ' class="n"'
    return "" if max(map(len, column.cells), default=0) > _ONE_LINE else ' class="w"'


def _svg(figure: Figure) -> str:
    if isinstance(figure.picture, Scene):
        return inline_svg(figure.picture, FixedInks(), longest=_LONGEST)
    return embedded_svg(render(figure.picture, "svg"), f"figure-{figure.number}", figure.caption)


# ----------------------------------------------------------------------
# A report as Markdown with its pictures in a folder next to it.


_MARKUP = re.compile(r"([\\`*_{}\[\]<>#|~$])")


def markdown_files(
    document: Document, stem: str, progress: Callable[[float], None]
) -> tuple[bytes, dict[str, bytes]]:
    """The text, and the pictures by their paths; ``stem`` is the name of the report's file."""
    folder = f"{stem}-pictures"
    pictures = {
        f"{folder}/figure-{number}.png": content
        for number, content, _ in figure_files(document, "png", progress)
    }
    lines = [f"# {_text(document.title)}", ""]
    if document.author_line:
        lines += [_text(document.author_line), ""]
    for number, section in enumerate(document.sections, 1):
        lines += [f"## {number} {_text(section.title)}", ""]
        for block in section.blocks:
            lines += [*_markdown_lines(block, folder), ""]
    return ("\n".join(lines).rstrip() + "\n").encode(), pictures


def _markdown_lines(block: Block, folder: str) -> Iterator[str]:
    match block:
        case Text(style="paragraph"):
            yield _text(block.text)
        case Text(style="note"):
            yield f"**{_text(block.text)}**"
        case Text():
            fence = "`" * max(3, 1 + max(map(len, re.findall("`+", block.text)), default=0))
            yield f"{fence}toml"
            yield block.text.rstrip("\n")
            yield fence
        case Facts():
            for label, text in block.pairs:
                yield (f"- {_text(label)}: {_text(text)}" if label else f"  - {_text(text)}")
        case Equation():
            yield f"$$ {block.latex} \\tag{{{block.number}}} $$"
        case Table():
            yield f"Table {block.number}. {_text(block.caption)}"
            yield ""
            yield _row([_text(column.header) for column in block.columns])
            yield _row(["---" if c.align == "left" else "---:" for c in block.columns])
            for cells in zip(*map(printed, block.columns), strict=True):
                yield _row(list(map(_text, cells)))
        case Figure():
            caption = f"Figure {block.number}. {_text(block.caption)}"
            yield f"![{caption}]({quote(folder)}/figure-{block.number}.png)"
            yield ""
            yield caption


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _text(text: str) -> str:
    """Text without signs of the markup."""
    return _MARKUP.sub(r"\\\1", text.replace("\n", " "))


# ----------------------------------------------------------------------
# A report as a PDF file, set by Typst.


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
