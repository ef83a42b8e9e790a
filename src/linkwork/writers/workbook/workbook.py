"""A motion as an Excel workbook with live formulas."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_bytes
from linkwork.core.foundation.loading import installed_with
from linkwork.core.motion.higher_rates import check_own_motion
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.writers.formulas.closure_formulas import ClosureFormulas
from linkwork.writers.formulas.rate_formulas import RateFormulas
from linkwork.writers.formulas.traced import traced
from linkwork.writers.workbook.book import (
    CYCLE,
    DIMENSIONS,
    FORCES,
    LINKWORK,
    NEWTON,
    VELOCITIES,
    Book,
    FastCells,
    iterated,
    set_up_page,
)
from linkwork.writers.workbook.cycle_page import (
    notices,
    write_about,
    write_charts,
    write_cycle,
    write_linkwork,
)
from linkwork.writers.workbook.dimension_page import (
    SHEET as DRAWING,
    has_drawing,
    write_dimensions,
    write_drawing,
)
from linkwork.writers.workbook.force_page import EQUILIBRIUM, write_equilibrium, write_forces
from linkwork.writers.workbook.load_cells import LOADS, force_problem, write_loads
from linkwork.writers.workbook.newton_page import (
    PARTIALS,
    check_size,
    write_newton,
    write_partials,
    write_velocities,
)

_MOST_ROWS = 20_000
_NEWTON, _SHEETS = 0.4, 0.55  # finished fractions after sheets; then the file


@dataclass(frozen=True, kw_only=True)
class WrittenWorkbook:
    """The bytes of an .xlsx file, and its parts that do not recalculate."""

    content: bytes
    notices: tuple[str, ...]


def workbook_of(
    model: Model,
    motion: Motion,
    further: Sequence[str] = (),
    progress: Callable[[float], None] = lambda fraction: None,
) -> WrittenWorkbook:
    """Write a motion of a mechanism as a workbook that solves it again.

    Parameters
    ----------
    model : Model
    motion : Motion
        A sweep of this mechanism.
    further : sequence of str
        Further quantities, as values on the sheet Linkwork.
    progress : callable
        Called with the finished fraction.

    Raises
    ------
    InputError
        If the motion belongs to another mechanism, or has too many rows for a workbook.
    MissingPackageError
        If XlsxWriter is not installed.

    Notes
    -----
    Sheets: About, Dimensions, Cycle (a row for every position), Velocities, Drawing, Charts, Newton
    (the iterations), Linkwork (its values). Cells contain their results, for programs that do not
    calculate.
    """
    _check(model, motion)
    version = metadata.version("linkwork")
    buffer = io.BytesIO()
    workbook, sheet_class = _new(buffer)
    description = model.description
    workbook.set_properties(
        {"title": description.name, "comments": f"Written by Linkwork {version}"}
    )
    formulas = ClosureFormulas(model, traced(description))
    done = iterated(model, motion, formulas)
    rates = RateFormulas(formulas)
    book = Book(workbook, model, motion, formulas.traced, formulas, rates, done, tuple(further))
    names = ["About", DIMENSIONS, CYCLE, VELOCITIES, DRAWING, "Charts", NEWTON, LINKWORK]
    if not has_drawing(book):
        names.remove(DRAWING)
    if force_problem(book) is None:
        partials = [PARTIALS] if len(model.equations.inputs) > 1 else []
        names[-2:-2] = [*partials, LOADS, FORCES]
        if DRAWING in names:
            names[-2:-2] = [EQUILIBRIUM]
    sheets = {name: workbook.add_worksheet(name, sheet_class) for name in names}
    _write_sheets(book, sheets, version, progress)
    large = [sheets[name] for name in (CYCLE, VELOCITIES, NEWTON, LINKWORK)]
    for k, sheet in enumerate(large):
        span = (1.0 - _SHEETS) / len(large)
        sheet.follow(progress, _SHEETS + k * span, span / book.last)
    for name, sheet in sheets.items():
        set_up_page(sheet, name, description.name)
    workbook.close()
    return WrittenWorkbook(content=buffer.getvalue(), notices=tuple(notices(book)))


def _write_sheets(
    book: Book, sheets: dict[str, Any], version: str, progress: Callable[[float], None]
) -> None:
    """Write all sheets; sheets to which other ones refer come first."""
    check_size(book)
    write_dimensions(book, sheets[DIMENSIONS])
    newton = write_newton(book, sheets[NEWTON], lambda part: progress(_NEWTON * part))
    columns = write_cycle(book, sheets[CYCLE], newton)
    write_velocities(book, sheets[VELOCITIES], newton)
    if DRAWING in sheets:
        write_drawing(book, sheets[DRAWING], columns)
    if PARTIALS in sheets:
        write_partials(book, sheets[PARTIALS], newton)
    if LOADS in sheets:
        cells = write_loads(book, sheets[LOADS])
        forces = write_forces(book, sheets[FORCES], cells)
        if EQUILIBRIUM in sheets:
            write_equilibrium(book, sheets[EQUILIBRIUM], cells, forces, columns)
    write_charts(book, sheets["Charts"], columns)
    write_linkwork(book, sheets[LINKWORK])
    write_about(book, sheets["About"], columns, version)
    progress(_SHEETS)


def check_xlsxwriter() -> None:
    """Check that XlsxWriter is installed.

    Raises
    ------
    MissingPackageError
        If it is not.
    """
    with installed_with("tables", "workbooks need XlsxWriter"):
        import xlsxwriter  # noqa: F401  # loaded as it will be for the workbook


def _new(buffer: io.BytesIO) -> tuple[Any, type]:
    """A workbook, and the class of its sheets."""
    check_xlsxwriter()
    import xlsxwriter
    from xlsxwriter.worksheet import Worksheet

    options = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
    return xlsxwriter.Workbook(buffer, options), type("Sheet", (FastCells, Worksheet), {})


def _check(model: Model, motion: Motion) -> None:
    check_own_motion(model, motion)
    rows = int(motion.asked.sum())
    if rows > _MOST_ROWS:
        raise InputError(
            f"{rows} rows are too many for a workbook with formulas (at most {_MOST_ROWS}): "
            "take a larger step, or write CSV"
        )


def write_workbook(
    mechanism: Mechanism, path: str | Path, motion: Motion | None = None
) -> tuple[str, ...]:
    """Write a sweep as an Excel workbook whose formulas solve the cycle again.

    Parameters
    ----------
    path : str or Path
        The .xlsx file.
    motion : Motion, optional
        A sweep of this mechanism; by default :meth:`~linkwork.Mechanism.sweep`.

    Returns
    -------
    tuple of str
        The parts of the workbook that contain values only and do not recalculate.

    Raises
    ------
    InputError
        If the suffix is not .xlsx, the motion belongs to another mechanism, or the file cannot
        be written.
    MissingPackageError
        If XlsxWriter is not installed.

    Examples
    --------
    >>> import linkwork as lw, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lw.example("four-bar").write(f"{folder}/bar.xlsx")
    ()
    """
    if as_path(path).suffix.lower() != ".xlsx":
        raise InputError(f'cannot write "{path}": a workbook needs the suffix .xlsx')
    cycle = mechanism.sweep() if motion is None else motion
    written = workbook_of(mechanism.model, cycle)
    save_bytes(written.content, path)
    return written.notices
