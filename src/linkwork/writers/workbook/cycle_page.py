"""The sheet of positions: a row for every value of the input."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.equations.writing import EquationSheet
from linkwork.core.foundation.statuses import Certification
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import cell_number, cell_text
from linkwork.writers.workbook.book import (
    CYCLE,
    FIRST,
    LINKWORK,
    NEWTON,
    PRINTED,
    Book,
    Table,
    add_curve,
    apart,
    chart_text,
    column_name,
    print_on_one_page,
    print_table,
)
from linkwork.writers.workbook.dimension_page import input_table
from linkwork.writers.workbook.load_cells import force_problem
from linkwork.writers.workbook.newton_page import NewtonColumns

# ----------------------------------------------------------------------
# The status of a row as a formula: a proof is shown for the numbers that Linkwork proved only.


_LONGEST = 200  # characters of names in a text of a formula, which takes 255
_MOST_ARGUMENTS = 250  # of a function, which takes 255
_CELL_AGREES = 1e-9  # of a full size: cells that differ less from Linkwork's contain its position
_SAME_INPUT = 1e-12  # of the largest value: rounding of first value + step · k
_PROVED = {
    Certification.CERTIFIED: "proved for {}",
    Certification.CONFIGURATION_CERTIFIED: "proved for {}",
    Certification.SUBSET_CERTIFIED: "proved for {}, without the redundant links",
    Certification.MOTION_NOT_PROVED: "position proved, motion not proved, for {}",
    Certification.PROOF_TOO_LONG: "position proved, motion not proved, for {}",
    Certification.BRANCH_CHOSEN: "position proved, branch chosen at a change point, for {}",
    Certification.NOT_ASKED: "converged (proofs were switched off)",
}
_NOT_PROVED = "converged (not proved)"


@dataclass(frozen=True)
class StatusFormulas:
    """The formulas of the checks in row k of the sheet of positions, without equals sign."""

    book: Book
    columns: dict[str, int]

    def cell(self, key: str, k: int) -> str:
        """The cell of a column in row k."""
        return f"{column_name(self.columns[key])}{FIRST + k + 1}"

    def as_solved(self, k: int) -> str:
        """``yes`` while dimensions and input are those that Linkwork solved."""
        return f'IF(AND(changes=0,{self.same_input(k)}),"yes","no")'

    def same_input(self, k: int) -> str:
        """Whether the input is the one that Linkwork solved."""
        parts = []
        for variable in self.book.model.equations.inputs:
            cell = self.cell(variable.symbol, k)
            other = column_name(self.book.linkwork_columns[variable.name])
            size = float(abs(self.book.motion.inputs[variable.name]).max()) or 1.0
            near = cell_number(float(f"{_SAME_INPUT * size:.1e}"))
            parts.append(f"ABS({cell}-{LINKWORK}!{other}{self.source(k)})<={near}")
        return ",".join(parts)

    def source(self, k: int) -> int:
        """The row of position k on the sheet of Linkwork's values."""
        return int(self.book.iterations.rows[k]) + FIRST + 1

    def difference(self, k: int) -> str:
        """The distance of the unknowns from Linkwork's, of a radian and of the longest link."""
        terms, row = [], FIRST + k + 1
        for size, column, other, count in self._runs:
            here, theirs = (
                f"{column_name(first)}{line}:{column_name(first + count - 1)}{line}"
                for first, line in ((column, row), (other, self.source(k)))
            )
            terms.append(f"SUMXMY2({here},{LINKWORK}!{theirs})/{cell_number(size)}^2")
        distance = f"SQRT({'+'.join(terms)})" if terms else "0"
        return f'IF(as_solved="yes",IFERROR({distance},"-"),"-")'

    @cached_property
    def _runs(self) -> list[tuple[float, int, int, int]]:
        """Neighbouring columns of one size: size, first column, Linkwork's first column, count."""
        book = self.book
        sizes = book.model.compiled.solver.variable_scale / book.scales
        listed = [
            (float(f"{size:.6g}"), self.columns[v.symbol], book.linkwork_columns[v.name])
            for size, v in zip(sizes, book.model.equations.unknowns, strict=False)
            if v.name in book.motion.unknowns
        ]
        groups = groupby(enumerate(listed), lambda e: (e[1][0], e[1][1] - e[0], e[1][2] - e[0]))
        runs = []
        for _, entries in groups:
            run = [entry for _, entry in entries]
            runs.append((*run[0], len(run)))
        return runs

    def closes(self, k: int) -> str:
        """``yes`` if the row has a position that fulfils the equations."""
        unknowns = [v.symbol for v in self.book.model.equations.unknowns]
        if not unknowns:
            return '"yes"'
        every = f"SUM({self.cell(unknowns[0], k)}:{self.cell(unknowns[-1], k)})"
        if "squares" not in self.columns:
            return f'IF(ISNUMBER({every}),"yes","NO")'
        squares = self.cell("squares", k)
        if not any(block.reason for block in self.book.closure.blocks):
            every = squares
        return f'IF(ISNUMBER({every}),IF({squares}<tolerance,"yes","NO"),"NO")'

    def status(self, k: int) -> str:
        """Linkwork's statement while it holds, otherwise that of the cells."""
        said = f"{LINKWORK}!{column_name(self.book.statements)}{self.source(k)}"
        holds = 'as_solved="yes"'
        if self.book.iterations.found[k]:
            holds = f"AND({holds},{self.cell('difference', k)}<={cell_number(_CELL_AGREES)})"
        solved = f'IF({self.cell("closes", k)}="yes",{self._converged},{self._lost(k)})'
        stale = 'IF(unused_changes>0,"not solved: a changed cell is not used"'
        return f"IF({holds},{said},{stale},{solved}))"

    @cached_property
    def _held(self) -> list[Variable]:
        """The unknowns that cells do not solve for."""
        unknowns = self.book.model.equations.unknowns
        return [unknowns[k] for b in self.book.closure.blocks if b.reason for k in b.unknowns]

    def _lost(self, k: int) -> str:
        """The status of a row that does not close after a change."""
        text = '"no convergence from the row above"'
        if not self._held:
            return text
        held = self._held[:_MOST_ARGUMENTS]
        cells = ",".join(self.cell(v.symbol, k) for v in held)
        stale = f'"{self._names} not recalculated for another input"'
        return f"IF(COUNT({cells})={len(held)},{text},{stale})"

    @cached_property
    def _names(self) -> str:
        return " ".join(self.book.shown(v) for v in self._held)[:_LONGEST].replace('"', "'")

    @cached_property
    def _converged(self) -> str:
        """The status of a row that closes after a change."""
        book = self.book
        text = f'"{_NOT_PROVED}"'
        if self._held:
            text = f'"converged, {self._names} as before (not proved)"'
        for redundant, formula in book.closure.released:
            variable = next(
                v for v in book.model.equations.unknowns if v.name == redundant.variable
            )
            released = cell_text(formula, book.names.of)
            near = cell_number(float(f"{_CELL_AGREES * book.model.equations.length_scale:.1e}"))
            fits = f"ABS({book.names.of[variable.symbol]}-({released}))<={near}"
            link = redundant.link[:_LONGEST].replace('"', "'")
            text = f'IF({fits},{text},"redundant link {link} does not fit")'
        return text


def statement(book: Book, row: int) -> str:
    """Linkwork's statement about a row of the motion."""
    status = book.motion.status[row]
    if not status.ok:
        return f"no position: {status.value.partition(':')[0]} ({status.name})"
    inputs = (
        f"{book.shown(v)} = {book.motion.inputs[v.name][row]:.10g} {book.unit(v.kind)}".rstrip()
        for v in book.model.equations.inputs
    )
    certification = book.motion.certification[row]
    return _PROVED.get(certification, _NOT_PROVED).format(", ".join(inputs))


# ----------------------------------------------------------------------
# The sheet of positions: a row for every value of the input.


_GROUPS = {
    "link": "Links that turn with another link", "point": "Points", "output": "Outputs",
}  # fmt: skip
_STATUS = 60  # the largest width of the column of statuses


def write_cycle(book: Book, sheet: Any, newton: NewtonColumns) -> dict[str, int]:
    """Write all positions; returns the columns by key."""
    table = Table(book, CYCLE, sheet, 13)
    _Page(book, table, newton).write()
    return table.of


@dataclass
class _Page:
    book: Book
    table: Table
    newton: NewtonColumns

    def write(self) -> None:
        """Write column by column."""
        book, table = self.book, self.table
        self.status = StatusFormulas(book, table.of)
        self._inputs()
        self._unknowns()
        self._equations()
        # each from preceding ones
        for quantity in book.closure.quantities:
            table.group = _GROUPS[quantity.of]
            unit = book.model.units.of(quantity.kind)
            table.formula(quantity.shown, unit, quantity.formula, key=quantity.key)
        said = [statement(book, int(row)) for row in book.iterations.rows]
        self._check(said)
        note = (
            "After a change, statuses follow: Linkwork's proofs are shown only for rows as "
            "Linkwork solved them."
        )
        widest = min(max(map(len, said), default=0), _STATUS)
        table.finish("positions", note, 1 + len(book.model.equations.inputs), widest=widest)

    def _inputs(self) -> None:
        book, table = self.book, self.table
        table.group = "Input"
        for variable in book.model.equations.inputs:
            symbol = variable.symbol
            column = table.add(book.shown(variable), book.unit(variable.kind), symbol)
            values = book.motion.inputs[variable.name][book.iterations.rows]
            # an even table is first + step·k in cells, so that both can be changed
            even = input_table(values) is not None
            first, step = (book.names.of.get(f"{word} {symbol}") for word in ("from", "step"))
            for k, value in enumerate(values):
                at = FIRST + k, column
                if even:
                    formula = f"={first}+{step}*($A{FIRST + k + 1}-1)"
                    table.sheet.write_formula(*at, formula, book.style["number"], value)
                else:
                    table.sheet.write_number(*at, value, book.style["input_number"])

    def _unknowns(self) -> None:
        book, table, values = self.book, self.table, self.book.iterations.values[-1]
        table.group = "Unknowns"
        for number, variable in enumerate(book.model.equations.unknowns):
            column = table.add(book.shown(variable), book.unit(variable.kind), variable.symbol)
            look = "number" if number in self.newton.last else "value"

            def text(k: int, number: int = number, variable: Variable = variable) -> str:
                return apart(f"={self._unknown(number, variable, k)}", FIRST + k)

            table.cells(column, text, values[:, number], look)

    def _unknown(self, number: int, variable: Variable, k: int) -> str:
        """The formula of an unknown in one row: the last iterate, or Linkwork's value, or #N/A."""
        book, done, row = self.book, self.book.iterations, FIRST + k + 1
        solved = "NA()"
        if done.found[k] and variable.name in book.motion.unknowns:
            letter = column_name(book.linkwork_columns[variable.name])
            solved = f"{LINKWORK}!{letter}{self.status.source(k)}"
        elif done.found[k]:
            solved = cell_number(float(done.values[-1][k, number]))
        last = self.newton.last.get(number)
        if last is None:
            # its cells do not solve: right for the inputs of the file only
            return f"IF(AND({self.status.same_input(k)}),{solved},NA())"
        iterate = f'IF(converged="yes",{NEWTON}!{column_name(last)}{row},NA())'
        return iterate if done.live[k] else f'IF(as_solved="yes",{solved},{iterate})'

    def _equations(self) -> None:
        """The equations in the order in which they are printed, and the sum of their squares."""
        book, table = self.book, self.table
        table.group = "Equations, 0 where they close"
        rows = sorted(
            (row for block in book.closure.blocks for row in block.rows),
            key=lambda row: int(row.name[1:]),
        )
        if not rows:
            return
        first = column_name(table.end)
        values = [table.formula(row.name, "", row.formula, "small") for row in rows]
        last = column_name(table.end - 1)

        def text(k: int) -> str:
            return f"=SUMSQ({first}{FIRST + k + 1}:{last}{FIRST + k + 1})"

        squares = np.sum(np.square(values), axis=0)
        table.cells(table.add("ΣF²", "", "squares"), text, squares, "small")

    def _check(self, said: list[str]) -> None:
        book, table, status = self.book, self.table, self.status
        solved = book.iterations.found.tolist()
        closes = ["yes" if there else "NO" for there in solved]
        none = ["-" if not there else 0.0 for there in solved]
        table.group = "Check"
        book.names.claim("as_solved", "as_solved")
        # formulas of each refer to the columns before it
        table.add("as solved", "by Linkwork", "as_solved")
        table.add("difference", "relative", "difference")
        table.add("closes", "", "closes")
        table.add("status", "", "status", look="head_indented")
        for key, formula, values, look in (
            ("as_solved", status.as_solved, ["yes"] * book.count, "right"),
            ("difference", status.difference, none, "relative"),
            ("closes", status.closes, closes, "right"),
            ("status", status.status, said, "status"),
        ):
            for k, value in enumerate(values):
                at = FIRST + k, table.of[key]
                table.sheet.write_formula(*at, f"={formula(k)}", book.style[look], value)
        self._highlight()

    def _highlight(self) -> None:
        """Colour the statuses, and fade cells without a value."""
        style, columns, last = self.book.style, self.table.of, self.book.last - 1

        def colour(first: int, end: int, look: str, **rule: Any) -> None:
            self.table.sheet.conditional_format(
                FIRST, first, last, end, {**rule, "format": style[look]}
            )

        closes, status = columns["closes"], columns["status"]
        colour(closes, closes, "wrong", type="cell", criteria="==", value='"NO"')
        colour(status, status, "good", type="text", criteria="begins with", value="proved for")
        colour(status, status, "doubtful", type="text", criteria="containing", value="not proved")
        colour(status, status, "lost", type="text", criteria="begins with", value="no ")
        colour(1, closes, "faded", type="errors")


# ----------------------------------------------------------------------
# The sheet with charts of unknowns and outputs over the input.


_CHART_PAGE_WIDTH, _HEIGHT, _ROWS = 1100, 400, 21
_PRINTED = 72  # percent: two charts on a page


def write_charts(book: Book, sheet: Any, columns: dict[str, int]) -> None:
    """Write one chart for each unit; ``columns`` are those of the positions."""
    sheet.write(0, 0, f"{book.model.description.name}: charts", book.style["title"])
    sheet.hide_gridlines(2)
    sheet.set_print_scale(_PRINTED)
    row = 2
    for kind in Kind:
        curves = _curves(book, kind)
        if curves:
            chart = _chart(book, kind, curves, columns)
            sheet.insert_chart(row, 0, chart)
            row += _ROWS
    sheet.set_h_pagebreaks(list(range(2 + 2 * _ROWS, row, 2 * _ROWS)))


def _curves(book: Book, kind: Kind) -> list[tuple[str, str]]:
    """Keys and names of all quantities of one kind."""
    curves = [
        (v.symbol, book.shown(v))
        for v in book.model.equations.unknowns
        if v.kind == kind.value and v.name in book.motion.unknowns
    ]
    outputs = (quantity for quantity in book.closure.quantities if quantity.of == "output")
    return curves + [(output.key, output.shown) for output in outputs if output.kind is kind]


def _chart(book: Book, kind: Kind, curves: list[tuple[str, str]], columns: dict[str, int]) -> Any:
    chart = book.workbook.add_chart({"type": "scatter", "subtype": "straight"})
    leading, rows = book.leading, (FIRST, book.last - 1)
    for key, name in curves:
        look = {"name": name, "line": {"width": 1.75}}
        add_curve(chart, CYCLE, rows, (columns[leading.symbol], columns[key]), look)
    values = book.motion.inputs[leading.name][book.iterations.rows]
    grid = {"visible": True, "line": {"color": "#e4e7eb", "width": 0.5}}
    axis: dict[str, Any] = {
        "name": f"{book.shown(leading)} [{chart_text(book.unit(leading.kind))}]",
        "min": float(values.min()), "max": float(values.max()),
        "major_gridlines": grid, "label_position": "low", "num_format": "General",
    }  # fmt: skip
    if leading.kind == "angle" and book.unit("angle") == "deg":
        axis["major_unit"] = _right_angles(float(values.max() - values.min()))
    chart.set_x_axis(axis)
    unit = chart_text(book.unit(kind.value))
    title = {"angle": "angles", "length": "lengths", "number": "numbers"}[kind.value]
    chart.set_y_axis({"name": f"{title} [{unit}]" if unit else title, "major_gridlines": grid})
    heading = f"{title.capitalize()} over {book.shown(leading)}"
    chart.set_title({"name": heading, "name_font": {"size": 13}})
    chart.set_legend({"position": "right"})
    chart.show_na_as_empty_cell()  # a gap where there is no position, not a line across
    chart.set_size({"width": _CHART_PAGE_WIDTH, "height": _HEIGHT})
    return chart


def _right_angles(span: float) -> float:
    """Degrees between gridlines."""
    return next((d for d in (5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0) if span / d <= 13), 360.0)


# ----------------------------------------------------------------------
# The sheet of Linkwork's results, for comparison.


_WIDEST, _STATEMENT = 24, 40  # width of columns


def write_linkwork(book: Book, sheet: Any) -> None:
    """Write all columns of the motion's table and further quantities at full precision."""
    motion, style = book.motion, book.style
    table = motion.table()
    further = motion.table(*book.further) if book.further else table
    said = {"statement": np.array([statement(book, row) for row in range(len(motion))])}
    columns = {**table.columns, **said, **further.columns}
    units = {**table.units, "statement": "", **further.units}
    book.title(sheet, "values by Linkwork")
    sheet.write(
        1, 0,
        "Numbers only: this sheet does not recalculate. Its statements hold for the inputs in the "
        "same row and the dimensions that Linkwork solved.", style["note"],
    )  # fmt: skip
    widths = [
        _STATEMENT if name == "statement" else min(max(12, len(name) + 2), _WIDEST)
        for name in columns
    ]
    last = min(len(motion), PRINTED)
    repeated = len(book.model.equations.inputs)
    print_table(sheet, widths, repeated, FIRST + last - 1)
    if len(motion) > last:
        sheet.write(2, 0, f"Printed: the first {last} rows.", style["note"])
    for column, (name, values) in enumerate(columns.items()):
        numeric = values.dtype.kind in "fiu"
        sheet.write_string(FIRST - 2, column, name, style["head" if numeric else "head_left"])
        sheet.write_string(FIRST - 1, column, units[name], style["unit"])
        look = style["small"] if name in ("residual", "condition") else style["general"]
        write = sheet.write_number if numeric else sheet.write
        for k, value in enumerate(values.tolist()):
            if not isinstance(value, float) or math.isfinite(value):
                write(FIRST + k, column, value, look)
    sheet.freeze_panes(FIRST, 1)


# ----------------------------------------------------------------------
# The first sheet of a workbook: instructions, units, evidence, equations.


_ONE_PAGE = 70  # rows
_ABOUT_PAGE_WIDTH = 110  # characters per line of equations
_LINE, _LINE_LENGTH = 15.0, 95  # height of a text line, and its characters


def write_about(book: Book, sheet: Any, columns: dict[str, int], version: str) -> None:
    """Write title, instructions, parts that do not recalculate, Linkwork's evidence, equations."""
    style, description = book.style, book.model.description
    sheet.hide_gridlines(2)
    sheet.set_column(0, 0, 30)
    sheet.set_column(1, 1, 100)
    sheet.write(0, 0, description.name, style["title"])
    row = 2
    for head, text in _facts(book, version):
        sheet.write(row, 0, head, style["head_left"])
        _wrapped(sheet, row, text, style["wrapped"])
        row += 1
    row = _checks(book, sheet, columns, row + 1)
    row = _listed(book, sheet, row + 1, "To note", list(notices(book)), "warning")
    limits = [book.motion.message] if book.motion.limits or not book.motion.found.all() else []
    row = _listed(book, sheet, row, "Limits of the motion", limits, "wrapped")
    row += 1
    sheet.write(row, 0, "Equations", style["heading"])
    sheet.write(row, 1, "", style["heading"])
    for line in EquationSheet(book.model.equations).text(_ABOUT_PAGE_WIDTH).splitlines():
        row += 1
        sheet.write_string(row, 0, line, style["code"])
    print_on_one_page(sheet, tall=1 if row < _ONE_PAGE else 0)


def _facts(book: Book, version: str) -> list[tuple[str, str]]:
    description, count = book.model.description, book.count
    statuses = ", ".join(f"{s.name} {n}" for s, n in book.motion.counts.items())
    proved = sum(c is Certification.CERTIFIED for c in book.motion.certification)
    source = [("Source", description.source)] if description.source else []
    use = (
        "Edit a yellow cell of the sheet Dimensions: the formulas of the sheet Newton solve all "
        "rows of Cycle again, and Velocities follows. Drawing shows the row whose number you enter "
        "there."
    )
    units = f"in {description.length}, angles in {book.unit('angle')}, counter-clockwise"
    names = (
        "A name that looks like a cell gets an underscore: a2 becomes a2_. Names of unknowns and "
        "points refer to the row of the formula."
    )
    solved = int(book.iterations.found.sum())
    evidence = (
        f"{statuses}; {proved} of {len(book.motion)} rows proved, for the dimensions and inputs of "
        "the file. The lines below and the statuses of Cycle follow the cells."
    )
    return [
        ("How to use it", use),
        *source,
        ("Written by", f"Linkwork {version}; the sheet Linkwork contains its results"),
        ("Units", f"lengths {units}"),
        ("Names", names),
        ("Rows", f"{count} values of the input, {solved} with a position"),
        ("By Linkwork", evidence),
        ("Iterations in every row", str(book.iterations.count)),
    ]


def _checks(book: Book, sheet: Any, columns: dict[str, int], row: int) -> int:
    """Checks of the cells, as formulas."""
    style = book.style
    rows = f"{FIRST + 1}", f"{book.last}"

    def whole(key: str) -> str:
        letter = column_name(columns[key])
        return f"{CYCLE}!{letter}{rows[0]}:{letter}{rows[1]}"

    solved = int(book.iterations.found.sum())
    lines: list[tuple[str, str, float, str]] = []
    if solved:
        largest = f"=MAX({whole('difference')})"
        lines.append(("Largest relative difference", largest, 0.0, "result"))
    closing = f'=COUNTIF({whole("closes")},"yes")'
    lines.append(("Rows with a position", closing, solved, "result_count"))
    proved = f'=COUNTIF({whole("status")},"proved for*")'
    certified = sum(statement(book, int(k)).startswith("proved for") for k in book.iterations.rows)
    lines.append(("Rows still proved", proved, certified, "result_count"))
    lines.append(("Changed cells", "=changes", 0, "result_count"))
    for head, formula, value, look in lines:
        sheet.write(row, 0, head, style["head_left"])
        sheet.write_formula(row, 1, formula, style[look], value)
        row += 1
    return row


def _listed(book: Book, sheet: Any, row: int, title: str, lines: list[str], look: str) -> int:
    if not lines:
        return row
    sheet.write(row, 0, title, book.style["head_left"])
    for line in lines:
        _wrapped(sheet, row, line, book.style[look])
        row += 1
    return row + 1


def _wrapped(sheet: Any, row: int, text: str, look: Any) -> None:
    """A long text broken into lines."""
    sheet.write(row, 1, text, look)
    sheet.set_row(row, _LINE * -(-len(text) // _LINE_LENGTH))


def notices(book: Book) -> Iterator[str]:
    """The parts that do not follow the yellow cells, with reasons, and special rows."""
    unknowns = book.model.equations.unknowns
    for block in book.closure.blocks:
        if block.reason:
            listed = ", ".join(book.shown(unknowns[k]) for k in block.unknowns)
            yield f"{listed}: {block.reason}; the column contains Linkwork's values"
    fixed = [d.name for d in book.dimensions if not d.live]
    if fixed:
        yield (
            f"{', '.join(fixed)}: no formula connects these with the equations; they keep the "
            "values of the file"
        )
    names = {d.key: d.name for d in book.dimensions}
    settled = [names.get(key, key) for key in book.traced.settled]
    if settled:
        yield f"{', '.join(settled)}: gear ratios keep the values of the file"
    keys = {quantity.key for quantity in book.closure.quantities}
    outputs = [name for name in book.motion.outputs if f"output {name}" not in keys]
    if outputs:
        yield f"{', '.join(outputs)}: values on the sheet Linkwork only"
    held = int((book.iterations.found & ~book.iterations.live).sum())
    if held:
        yield (
            f"{held} rows: Newton-Raphson does not converge there, as at a change point; they "
            "contain Linkwork's values until something changes"
        )
    problem = force_problem(book)
    if problem:
        yield f"no sheets of forces: {problem}"
    lost = book.count - int(book.iterations.found.sum())
    if lost:
        yield f"rows without a position, with Linkwork's reason in their status: {lost}"
    done = book.iterations
    apart = int((done.live & (done.above < 0)).sum()) - 1
    if apart > 0:
        yield f"rows that start from separate estimates, yellow cells of Newton: {apart}"
    added = int(np.count_nonzero(book.motion.added))
    if added:
        yield (
            f"{added} rows in addition to the table, at limits and on further branches, are on "
            "the sheet Linkwork only"
        )
