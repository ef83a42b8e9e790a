"""A report as a Word document, with equations that Word can edit."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from typing import Any

from linkwork.writers.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Table,
    Text,
    figure_files,
    office_terms,
    printed,
)

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
