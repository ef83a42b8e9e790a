"""Sections on motions and forces, and the report."""

from __future__ import annotations

import errno
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np

from linkwork.circuits.circuit_list import (
    branch_columns,
    circuit_fields,
    completeness_fields,
    configuration_columns,
)
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.mechanism_scene import configuration_sheet
from linkwork.core.foundation.arrays import Array, CountArray
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.files import as_path, save_bytes, suffix_of, unwritten, written_folder
from linkwork.core.foundation.loading import installed_with
from linkwork.core.foundation.names import pretty
from linkwork.core.motion.model import Model
from linkwork.core.results.listing import (
    NOTHING,
    Column,
    fixed,
    how_many,
    inputs_text,
    lengths,
    limit_fields,
    range_columns,
    range_text,
    short,
    status_fields,
)
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked
from linkwork.core.results.quantity import Kind
from linkwork.design.tolerance_results import (
    SensitivityStatus,
    contribution_columns,
    tolerance_fields,
)
from linkwork.forces.results import finite_forces, force_fields, force_status_fields
from linkwork.writers.charts.chart import Chart
from linkwork.writers.charts.lines import circuit_chart
from linkwork.writers.charts.plane import motion_plot
from linkwork.writers.report.document import (
    Block,
    Document,
    Facts,
    Figure,
    Section,
    Text,
    shown_name,
)
from linkwork.writers.report.rendering import docx_bytes, html_bytes, markdown_files, pdf_bytes
from linkwork.writers.report.sections import (
    FOLLOWED,
    NO_INPUT,
    NOT_FOUND,
    SECTIONS,
    Findings,
    Template,
    dimensions,
    drawing,
    equations,
    file,
    needs,
    newton,
    proof,
    summary,
    tables,
    template_of,
    vectors,
    versions,
)

# ----------------------------------------------------------------------
# Sections on motions and forces.


# ----------------------------------------------------------------------
# Sections about the motion: table, plots, paths, circuits, configurations.


_ROWS = 12  # steps of the table of a motion
_NOISE = 1e-12  # relative to the largest value of the same unit: rounding, printed as 0
_DECIMALS = {"deg": 3, "rad": 5}
_SHORT, _DIGITS = 3, 7  # decimals of angles, digits of input values
_WHOLE = 1e-9  # of a step: rounding of an input value
_PANELS = 4  # panels of a figure


def quantities_of(motion: Motion, template: Template) -> list[str]:
    """The quantities of tables and plots."""
    traced = (f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy")
    usual = [*motion.unknowns, *motion.riding, *motion.outputs, *traced]
    return list(dict.fromkeys(template.quantities or usual))


def check_template(template: Template, model: Model) -> None:
    """Refuse a template that does not fit a mechanism, before any computation.

    Raises
    ------
    InputError
        If the table has no two rows at the distance ``every``.
    UnknownNameError
        With the names that exist.
    """
    for name in template.quantities:
        model.quantities.find(name).check_rate(model.speed)
    for name in template.tolerances_of:
        of_motion = "(" in name
        (model.quantities.find_of_motion if of_motion else model.quantities.find)(name)
    if "motion" in template.sections and template.every is not None and model.description.inputs:
        _spaced(model.rows_in_file_units[:, 0], template.every, model.input_units)


def motion(findings: Findings) -> Iterator[Block]:
    """Counts and limits, the table of chosen rows with rates, ranges."""
    if findings.motion is None:
        yield from _position(findings)
        return
    swept = findings.motion
    head = f"{range_text(swept)}: {how_many(swept)}"
    yield Facts(pairs=(("rows", head), *status_fields(swept), *limit_fields(swept)))
    if not swept.found.any():
        return
    names = quantities_of(swept, findings.template)
    if not names:
        return
    rows = _chosen(swept, findings.template.every)
    for caption, listed in _groups(swept, names):
        columns = _columns(swept, listed, rows)
        yield from tables(caption, [*_inputs(swept, rows), *columns, *_notes(swept, rows)])
    yield from tables("Ranges over all rows of the motion", ranges_of(swept, names))


def ranges_of(swept: Motion, names: Sequence[str]) -> list[Column]:
    """The smallest and the largest values of at least one quantity."""
    first, low, low_at, high, high_at, units = range_columns(swept, names, _SHORT)
    sizes: dict[str, float] = {}
    for column in (low, high):
        for cell, unit in zip(column.cells, units.cells, strict=True):
            sizes[unit] = max(sizes.get(unit, 0.0), _size(cell))

    def clean(column: Column) -> Column:
        pairs = zip(column.cells, units.cells, strict=True)
        cells = [c if c == NOTHING or _size(c) > _NOISE * sizes[unit] else "0" for c, unit in pairs]
        return replace(column, cells=cells)

    shown = replace(first, cells=list(map(shown_name, first.cells)))
    return [shown, clean(low), _shortened(low_at), clean(high), _shortened(high_at), units]


def _size(cell: str) -> float:
    return 0.0 if cell == NOTHING else abs(float(cell))


def _shortened(inputs: Column) -> Column:
    """Input values with fewer digits."""
    cells = [c if c == NOTHING else short(float(c), _DIGITS) for c in inputs.cells]
    return replace(inputs, cells=cells)


def _position(findings: Findings) -> Iterator[Block]:
    """The only position of a mechanism without input."""
    position = findings.position
    yield Text(text="The mechanism has no input: it has the position below.")
    if not position.status.ok:
        return
    values = {**position.unknowns, **position.outputs}
    places = {
        f"{name}.{a}": z
        for name, p in position.points.items()
        for a, z in zip("xy", p, strict=True)
    }
    for caption, listed in (("Unknowns and outputs", values), ("Points", places)):
        if listed:
            cells = [
                fixed(v) if position.value_units.get(n) in _DECIMALS else short(v, 8)
                for n, v in listed.items()
            ]
            units = [position.value_units.get(name, "") for name in listed]
            columns = [
                Column(header="name", cells=list(map(pretty, listed))),
                Column(header="value", cells=cells, align="point", units=units),
            ]
            yield from tables(caption, columns)


def _chosen(swept: Motion, every: float | None) -> CountArray:
    """Rows of the table of the input, evenly spaced, and those at limits."""
    requested = np.flatnonzero(swept.asked)
    values = next(iter(swept.inputs.values()))[requested]
    if every is None:
        last = len(requested) - 1
        divisors = (s for s in range(1, last + 1) if not last % s and last // s <= _ROWS)
        stride = next(divisors, 1)
        if last // stride < _ROWS // 2:  # a number of rows with few divisors
            stride = max(math.ceil(last / _ROWS), 1)
        rows = requested[[*range(0, len(requested), stride)]]
    else:
        rows = requested[_spaced(values, every, swept.input_units)]
    limits = np.flatnonzero([bool(limit) for limit in swept.limit] & swept.found)
    return np.union1d(np.union1d(rows, requested[-1:]), limits)


def _spaced(values: Array, every: float, units: Mapping[str, str]) -> CountArray:
    """The rows at multiples of a distance from the first one; ``units`` by input.

    Raises
    ------
    InputError
        If there is only the first one.
    """
    steps = (values - values[0]) / every
    rows = np.flatnonzero(
        np.abs(steps - np.round(steps)) <= _WHOLE * np.maximum(1.0, np.abs(steps))
    )
    if len(rows) < 2 <= len(values):
        name, unit = next(iter(units.items()))
        raise InputError(
            f"every = {every:g}: the motion has no two rows of {name} at this distance; take "
            f"a multiple of its step, {short(values[1] - values[0])} {unit}".rstrip()
        )
    return rows


def _groups(swept: Motion, names: Sequence[str]) -> Iterator[tuple[str, list[Asked]]]:
    """The quantities, their first and their second rates, each with a caption."""
    rates = [("Velocities", ".velocity"), ("Accelerations", ".acceleration")]
    if swept.speed is None:
        by = next(iter(swept.inputs))
        rates = [
            (f"First derivatives with respect to {by}", ".d1"),
            (f"Second derivatives with respect to {by}", ".d2"),
        ]
    yield "Motion", [swept.quantity(name) for name in names]
    for caption, rate in rates:
        listed = []
        for name in names:
            # a rate of a rate, or of a number of parts, does not exist
            with suppress(InputError, UnknownNameError):
                listed.append(swept.quantity(name + rate))
        if listed:
            yield caption, listed


def _columns(swept: Motion, listed: Sequence[Asked], rows: CountArray) -> Iterator[Column]:
    values = [np.asarray(swept[quantity.name], dtype=float) for quantity in listed]
    sizes: dict[str, float] = {}
    for quantity, column in zip(listed, values, strict=True):
        most = float(np.nanmax(np.abs(column[np.isfinite(column)]), initial=0.0))
        sizes[quantity.unit] = max(sizes.get(quantity.unit, 0.0), most)
    for quantity, column in zip(listed, values, strict=True):
        unit = f" [{quantity.unit}]" if quantity.unit else ""
        cells = number_cells(column[rows], quantity.unit, sizes[quantity.unit])
        yield Column(header=f"{shown_name(quantity.own.name)}{unit}", cells=cells, align="point")


def number_cells(values: Array, unit: str, size: float) -> list[str]:
    """Numbers of a column with common decimals; ``size`` is the largest of the same unit."""
    clean = np.where(np.abs(values) <= _NOISE * size, 0.0, values)
    if not clean[np.isfinite(clean)].any():
        return ["0" if value == 0.0 else NOTHING for value in clean.tolist()]
    if unit in _DECIMALS:
        return [fixed(value, _DECIMALS[unit]) for value in clean.tolist()]
    return lengths(clean.tolist())


def _inputs(swept: Motion, rows: CountArray) -> Iterator[Column]:
    for name, values in swept.inputs.items():
        unit = swept.input_units[name]
        cells = [short(value, _DIGITS) for value in values[rows]]
        header = f"{pretty(name)} [{unit}]" if unit else pretty(name)
        yield Column(header=header, cells=cells, align="point")


def _notes(swept: Motion, rows: CountArray) -> Iterator[Column]:
    """Limits and missing positions, if there are any."""
    cells = [
        swept.limit[row] or ("" if swept.status[row].ok else swept.status[row].label)
        for row in rows
    ]
    if any(cells):
        yield Column(header="note", cells=cells)


def plots(findings: Findings) -> Iterator[Block]:
    """The quantities and their rates over the input."""
    cycle = findings.cycle
    names = quantities_of(cycle, findings.template)
    needs(names, "the mechanism has no unknown, output or traced point")
    over = next(iter(cycle.inputs))
    for caption, listed in _groups(cycle, names):
        about = "Displacements" if caption == "Motion" else caption
        chart = motion_plot(cycle, [quantity.name for quantity in listed])
        yield from figures_of(chart, f"{about} over {pretty(over)}.")


def figures_of(chart: Chart, caption: str) -> Iterator[Figure]:
    """A chart without its headings, in figures that fit a page."""
    plain = replace(chart, title="", caption="")
    if not chart.panels:
        return
    if chart.projection != "graph" or len(chart.panels) <= _PANELS:
        yield Figure(caption=caption, picture=plain)
        return
    count = math.ceil(len(chart.panels) / _PANELS)
    size = math.ceil(len(chart.panels) / count)
    for k in range(count):
        part = replace(plain, panels=chart.panels[k * size : (k + 1) * size])
        yield Figure(caption=caption if not k else f"{caption[:-1]} (continued).", picture=part)


def paths(findings: Findings) -> Iterator[Block]:
    """The paths of the traced points."""
    needs(findings.model.compiled.points.names, "the mechanism has no points to draw")
    traced = findings.cycle.skeleton.traced
    needs(traced, "the file traces no point")
    chart = motion_plot(findings.cycle, traced, kind="path")
    what = "Path of point" if len(traced) == 1 else "Paths of points"
    yield Figure(
        caption=f"{what} {', '.join(map(pretty, traced))}.",
        picture=replace(chart, title="", caption=""),
    )


def circuits(findings: Findings) -> Iterator[Block]:
    """Every circuit with its branches, ranges, dead points; a chart of all."""
    needs(findings.model.description.inputs, NO_INPUT)
    listed = findings.circuits
    yield Text(
        text="A circuit is the set of all positions that the mechanism can reach without "
        "disassembly; a branch is a part of it between dead points."
    )
    for circuit in listed:
        yield from tables(f"Branches of {circuit.name}", branch_columns(listed, circuit, _DIGITS))
        yield Facts(pairs=tuple(circuit_fields(listed, circuit)))
    reasons = [] if listed.failure is None else list(listed.failure.sentences())
    yield Facts(pairs=(*reasons, ("complete", listed.message)))
    if len(listed):
        chart = circuit_chart(listed, ())
        yield from figures_of(chart, f"All circuits over {pretty(listed.input)}.")


def configurations(findings: Findings) -> Iterator[Block]:
    """All assembly configurations at the input of the drawn position."""
    listed = findings.configurations
    kinds = {v.name: Kind(v.kind) for v in findings.model.equations.unknowns}
    where = inputs_text(listed.input, listed.input_units)
    if len(listed):
        yield from tables(
            f"Configurations {where}".rstrip(), configuration_columns(listed, kinds, _SHORT)
        )
    yield Facts(pairs=tuple(completeness_fields(listed)))
    if len(listed) and findings.model.compiled.points.names:
        sheet = replace(configuration_sheet(listed), title="", caption="")
        yield Figure(caption=f"The configurations {where}".rstrip() + ".", picture=sheet)


# ----------------------------------------------------------------------
# Sections about forces and tolerances.


def forces(findings: Findings) -> Iterator[Block]:
    """Efforts of the inputs and reactions of the joints."""
    acting, cycle = findings.forces, findings.cycle
    rest = "at rest" if cycle.speed is None else "with the inertia of its masses"
    yield Text(text=f"Forces of the mechanism {rest}, over the rows of its motion.")
    yield Facts(pairs=tuple(force_status_fields(acting)))
    listed = finite_forces(acting)
    if listed:
        yield from tables("Smallest and largest forces", ranges_of(cycle, listed))
    yield Facts(pairs=tuple(force_fields(acting, findings.stalls)))
    efforts = [name for name in acting.efforts if name in listed]
    if efforts:
        chart = motion_plot(cycle, efforts)
        over = pretty(next(iter(cycle.inputs)))
        what = "Effort" if len(efforts) == 1 else "Efforts"
        yield from figures_of(chart, f"{what} of the input over {over}.")


def tolerances(findings: Findings) -> Iterator[Block]:
    """How tolerances and clearances affect every requested quantity."""
    position = findings.position
    needs(position.status.ok, NOT_FOUND)
    needs(
        findings.template.tolerances_of or position.outputs or position.unknowns,
        "the mechanism has no unknown and no output",
    )
    yield Text(
        text="Worst case, root sum square and shares are of first order in the deviations and "
        "clearances of the file."
    )
    for each in findings.tolerances:
        where = f" at {each.where}" if each.where else ""
        if each.status is not SensitivityStatus.FOUND:
            yield Facts(pairs=((each.of, each.status.value),))
            continue
        yield Text(text=f"{pretty(each.of)}{where}", style="note")
        yield Facts(pairs=tuple(tolerance_fields(each)))
        yield from tables(f"Contributions to {pretty(each.of)}{where}", contribution_columns(each))


# ----------------------------------------------------------------------
# The mechanism as a report for people: the sections of a template, in the format of a file.


#: Formats of reports by suffix.
FORMATS = (".html", ".pdf", ".docx", ".md")

#: The packages that formats need, with their names.
_PACKAGES = {
    ".pdf": ("typst", "PDF reports need Typst"),
    ".docx": ("docx", "Word reports need python-docx"),
}
_SECTIONS: Mapping[str, tuple[str, Callable[[Findings], Iterator[Block]]]] = {
    "summary": ("Summary", summary),
    "drawing": ("Drawing", drawing),
    "vectors": ("Vector diagram", vectors),
    "dimensions": ("Given dimensions", dimensions),
    "equations": ("Equations", equations),
    "newton": ("Newton-Raphson step by step", newton),
    "motion": ("Motion", motion),
    "plots": ("Plots", plots),
    "paths": ("Paths of points", paths),
    "circuits": ("Circuits and dead points", circuits),
    "configurations": ("Configurations", configurations),
    "forces": ("Forces", forces),
    "tolerances": ("Tolerances", tolerances),
    "proof": ("What is proved", proof),
    "versions": ("Versions", versions),
    "file": ("Mechanism file", file),
}
assert tuple(_SECTIONS) == SECTIONS


def write_report(
    mechanism: Mechanism,
    path: str | Path,
    at: float | Mapping[str, float] | None = None,
    *,
    template: str | Path = "engineer",
    configuration: str | None = None,
    title: str | None = None,
    author: str | None = None,
    institution: str | None = None,
    date: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Path, ...]:
    """Write a report: equations, drawings, tables, plots, proofs, the file.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the format: ``.html``, ``.pdf``, ``.docx``, or ``.md`` with
        its pictures in the folder ``<name>-pictures``.
    at : number or Mapping[str, number], optional
        The input of the drawing, the vectors, the configurations and the iterations; by default
        round values near those of the guess.
    template : str or Path
        ``engineer``, ``student``, or a template file, which names the sections.
    configuration : str, optional
        The configuration or branch of the motion, as in :meth:`~linkwork.Mechanism.solve`.
    title, author, institution, date : str, optional
        The head of the report, instead of that in the template.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Returns
    -------
    tuple of Path
        The files that were written: the report, then its pictures.

    Raises
    ------
    InputError
        If the suffix is unknown, the template has errors or does not fit the mechanism, or the
        file cannot be written.
    MissingPackageError
        If the package that writes the format is not installed.

    Examples
    --------
    >>> import linkwork as lw, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (file,) = lw.example("four-bar").write(f"{folder}/bar.html", kind="report", title="Bar")
    ...     text = file.read_text("utf-8")
    >>> file.name, "What is proved" in text
    ('bar.html', True)
    """
    target = as_path(path)
    check_report_file(target)
    chosen = template_of(template).with_head(
        {"title": title, "author": author, "institution": institution, "date": date}
    )
    check_template(chosen, mechanism.model)
    tell = progress or (lambda fraction: None)
    results = Findings(mechanism, chosen, at, configuration, tell)
    content, pictures = report_of(
        results, target, lambda part: tell(FOLLOWED + (1.0 - FOLLOWED) * part)
    )
    return save_report(target, content, pictures)


def check_report_file(path: Path) -> None:
    """Reject a file that cannot be written here before any computation.

    Raises
    ------
    InputError
        If the suffix is not one of :data:`FORMATS`.
    MissingPackageError
        If the package that writes the format is not installed.
    """
    suffix = suffix_of(path, "a report", FORMATS)
    if suffix in _PACKAGES:
        package, name = _PACKAGES[suffix]
        with installed_with("report", f"{suffix} reports need {name}"):
            import_module(package)


def document_of(findings: Findings) -> Document:
    """The sections of the template with their content; the last one names those left out."""
    written: list[Section] = []
    absent: list[tuple[str, str]] = []
    for name in findings.template.sections:
        heading, build = _SECTIONS[name]
        try:
            findings.check_hidden(name)
            written.append(Section(title=heading, blocks=tuple(build(findings))))
        except UnknownNameError:  # of the template
            raise
        except InputError as error:
            absent.append((heading, str(error)))
    if absent:
        written.append(Section(title="Sections left out", blocks=(Facts(pairs=tuple(absent)),)))
    title = findings.template.title or findings.model.description.name
    return Document.numbered(title, findings.template.byline, written)


def report_of(
    findings: Findings, path: Path, progress: Callable[[float], None] = lambda fraction: None
) -> tuple[bytes, Mapping[str, bytes]]:
    """The content of the file, and of pictures by their paths relative to its folder.

    The same results give the same bytes.
    """
    document = document_of(findings)
    match path.suffix.lower():
        case ".html":
            return html_bytes(document, progress), {}
        case ".pdf":
            return pdf_bytes(document, progress), {}
        case ".docx":
            return docx_bytes(document, progress), {}
        case _:
            return markdown_files(document, path.stem, progress)


def save_report(path: Path, content: bytes, pictures: Mapping[str, bytes]) -> tuple[Path, ...]:
    """Write the file with its pictures, or nothing; returns all paths, that of the file first.

    Raises
    ------
    InputError
        If one of them cannot be written.
    """
    places = [path.parent / name for name in pictures]
    if not places:
        save_bytes(content, path)
        return (path,)
    folder = places[0].parent  # all pictures are in one
    if not folder.parent.is_dir():
        raise unwritten(folder, FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT)))
    with written_folder(folder) as part:
        for place, picture in zip(places, pictures.values(), strict=True):
            (part / place.name).write_bytes(picture)
        save_bytes(content, path)
    return path, *places
