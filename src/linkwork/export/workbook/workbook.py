"""A motion as an Excel workbook with live formulas."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any

from linkwork.export.workbook.about_page import notices, write_about
from linkwork.export.workbook.book import CYCLE, FIRST, LINKWORK, NEWTON, Book
from linkwork.export.workbook.chart_page import write_charts
from linkwork.export.workbook.closure_formulas import ClosureFormulas
from linkwork.export.workbook.cycle_page import planned_cycle, write_cycle
from linkwork.export.workbook.dimension_page import write_dimensions
from linkwork.export.workbook.drawing_page import SHEET, has_drawing, write_drawing
from linkwork.export.workbook.iterations import iterated
from linkwork.export.workbook.linkwork_page import write_linkwork
from linkwork.export.workbook.newton_page import planned_newton, write_newton
from linkwork.export.workbook.traced_equations import traced
from linkwork.foundation.errors import InputError, MissingPackageError
from linkwork.foundation.value_types import check_class
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["WrittenWorkbook", "workbook_of"]

_MOST_ROWS = 20_000
_A4 = 9


@dataclass(frozen=True, kw_only=True)
class WrittenWorkbook:
    """The bytes of an .xlsx file, and its parts that do not recalculate."""

    content: bytes
    notices: tuple[str, ...]


def workbook_of(model: Model, motion: Motion, further: Sequence[str] = ()) -> WrittenWorkbook:
    """Write a motion of a mechanism as a workbook that solves it again.

    Parameters
    ----------
    model : Model
    motion : Motion
        A sweep of this mechanism.
    further : sequence of str
        Further quantities, as values on the sheet Linkwork.

    Raises
    ------
    InputError
        If the motion belongs to another mechanism, or has too many rows for a workbook.
    MissingPackageError
        If XlsxWriter is not installed.

    Notes
    -----
    Sheets: About, Dimensions, Cycle (a row for every position), Drawing, Charts, Newton (the
    iterations), Linkwork (its values). Cells contain their results, for programs that do not
    calculate.
    """
    _check(model, motion)
    version = metadata.version("linkwork")
    buffer = io.BytesIO()
    workbook = _new(buffer)
    description = model.description
    workbook.set_properties(
        {"title": description.name, "comments": f"Written by Linkwork {version}"}
    )
    formulas = ClosureFormulas(model, traced(description))
    done = iterated(model, motion, formulas)
    book = Book(workbook, model, motion, formulas.traced, formulas, done, tuple(further))
    about = workbook.add_worksheet("About")
    write_dimensions(book)
    cycle = workbook.add_worksheet(CYCLE)
    drawing = workbook.add_worksheet(SHEET) if has_drawing(book) else None
    charts = workbook.add_worksheet("Charts")
    newton = workbook.add_worksheet(NEWTON)
    own = workbook.add_worksheet(LINKWORK)
    iterations = planned_newton(book)
    columns = planned_cycle(book)
    write_cycle(book, cycle, columns, iterations)
    write_newton(book, newton, iterations, columns.of)
    if drawing is not None:
        write_drawing(book, drawing, columns.of)
    write_charts(book, charts, columns.of)
    write_linkwork(book, own)
    write_about(book, about, columns, version)
    cycle.repeat_rows(FIRST - 3, FIRST - 1)
    for sheet in workbook.worksheets():
        sheet.set_landscape()
        sheet.set_paper(_A4)
        if sheet.get_name() not in (CYCLE, NEWTON, LINKWORK):
            sheet.fit_to_pages(1, 0)
    workbook.close()
    return WrittenWorkbook(content=buffer.getvalue(), notices=tuple(notices(book)))


def _new(buffer: io.BytesIO) -> Any:
    try:
        import xlsxwriter
    except ImportError:
        raise MissingPackageError(
            'workbooks need XlsxWriter: pip install "linkwork[tables]"'
        ) from None
    return xlsxwriter.Workbook(buffer, {"in_memory": True})


def _check(model: Model, motion: Motion) -> None:
    check_class("the motion", motion, Motion)
    names = [v.name for v in model.equations.inputs]
    if motion.mechanism != model.description.name or list(motion.inputs) != names:
        raise InputError(
            f'the motion belongs to "{motion.mechanism}", not to "{model.description.name}": '
            "give a sweep of this mechanism"
        )
    rows = int(motion.asked.sum())
    if rows > _MOST_ROWS:
        raise InputError(
            f"{rows} rows are too many for a workbook with formulas (at most {_MOST_ROWS}): "
            "take a larger step, or write CSV"
        )
