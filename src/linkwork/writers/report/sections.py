"""Templates of reports: sections, their order, and their contents."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.circuits.results import Circuits, Configurations
from linkwork.core import motion, textfile
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.annotations import SceneOptions
from linkwork.core.drawing.mechanism_scene import scene_of
from linkwork.core.equations.notation import Latex
from linkwork.core.equations.writing import EquationSheet, MathML
from linkwork.core.foundation.errors import InputError, Problem, choices
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import canonical, pretty
from linkwork.core.foundation.statuses import Certification
from linkwork.core.foundation.values import (
    Constant,
    Key,
    ListOf,
    PlainNumber,
    Text as TextKey,
    as_told,
)
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import varied_numbers
from linkwork.core.motion.iterating import vector_loops
from linkwork.core.results.check import CheckReport, check_fields, measured_part_columns
from linkwork.core.results.listing import (
    Column,
    certificate_text,
    changes_text,
    evidence_fields,
    fixed,
    inputs_text,
    lengths,
    radius_measure,
    short,
    significant,
    system_columns,
    trail_columns,
)
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.quantity import Kind
from linkwork.core.textfile.keys import FORMAT, Form
from linkwork.core.textfile.reader import Structure, check_format, located_error
from linkwork.core.textfile.toml_text import Lines, bytes_of, data_of, text_of
from linkwork.core.textfile.writer import part_lines
from linkwork.design.tolerance_results import Tolerance
from linkwork.design.tolerances import tolerance
from linkwork.forces.functions import stalls
from linkwork.forces.results import ForceStatus, Reactions, Stall
from linkwork.writers.formulas.rate_formulas import dimension_kinds
from linkwork.writers.formulas.traced import traced
from linkwork.writers.report.document import (
    Block,
    Equation,
    Facts,
    Figure,
    Table,
    Text,
    shown_name,
    split_columns,
    template_text,
)

#: The sections that a report can have.
SECTIONS = (
    "summary", "drawing", "vectors", "dimensions", "equations", "newton", "motion", "plots",
    "paths", "circuits", "configurations", "forces", "tolerances", "proof", "versions", "file",
)  # fmt: skip
#: The templates of the package.
TEMPLATES = ("engineer", "student")

_BYLINE = ("author", "institution", "date")
_NAMES = ListOf(TextKey(), "quantity")
_KEYS = Form(
    "template",
    "The sections of a report and their contents",
    "",
    (
        Key("format", Constant(FORMAT), "The version of this file format; write format = 1"),
        Key(
            "sections",
            ListOf(TextKey(SECTIONS), "section", 1),
            "The sections in their order",
            required=True,
        ),
        Key("title", TextKey(), "The title; by default the name of the mechanism"),
        Key("author", TextKey(), "Who wrote the report"),
        Key("institution", TextKey(), "University, company or course"),
        Key("date", TextKey(), "The date as it is printed; there is none by default"),
        Key("every", PlainNumber(), "Step of the input between rows of the table of the motion"),
        Key("quantities", _NAMES, "Columns of the table and of the plots"),
        Key("tolerances_of", _NAMES, "The quantities whose tolerances are given"),
    ),
)


@dataclass(frozen=True, kw_only=True)
class Template:
    """What a report contains.

    ``every`` is the step of the input between rows of the table of the motion, in file units;
    ``quantities`` replace the unknowns, outputs and traced points; ``tolerances_of`` the outputs.
    """

    sections: tuple[str, ...]
    title: str = ""
    author: str = ""
    institution: str = ""
    date: str = ""
    every: float | None = None
    quantities: tuple[str, ...] = ()
    tolerances_of: tuple[str, ...] = ()

    @property
    def byline(self) -> tuple[tuple[str, str], ...]:
        """The stated ones of author, institution and date."""
        return tuple((name, text) for name in _BYLINE if (text := getattr(self, name)))

    def with_head(self, head: Mapping[str, str | None]) -> Template:
        """A copy with another title, author, institution or date.

        Raises
        ------
        InputError
            If one of them is not text.
        """
        texts: dict[str, Any] = {name: text for name, text in head.items() if text is not None}
        for name, text in texts.items():
            if not isinstance(text, str):
                raise InputError(f"the {name} of a report must be text, got {as_told(text)}")
        return replace(self, **texts)


def template_of(name: str | Path) -> Template:
    """A template of the package by its name, or that of a file.

    Raises
    ------
    MechanismFileError
        If the file does not exist; else all its problems with line, key and remedy.
    """
    shown = str(as_path(name))
    if shown in TEMPLATES:
        return _read(template_text(f"{shown}.toml"), shown)
    path = as_path(name)
    if not path.exists() and path.parent == Path() and not path.suffix:
        raise InputError(
            f'there is no template "{shown}" {choices("templates", TEMPLATES, shown)}; a path '
            "names a file"
        )
    return _read(text_of(bytes_of(path, shown), shown), shown)


def _read(text: str, name: str) -> Template:
    data = data_of(text, name)
    lines = Lines.of(text)
    check_format(data, lines, name)
    structure = Structure(data, _KEYS)
    problems = [*structure.problems, *_problems(structure.content)]
    if problems:
        raise located_error(problems, lines, name)
    content: dict[str, Any] = {
        key: tuple(entry) if isinstance(entry, list) else entry
        for key, entry in structure.content.items()
        if key != "format"
    }
    return Template(**content)


def _problems(content: Mapping[str, Any]) -> list[Problem]:
    """Repeated sections, and a step that is no step."""
    listed = content.get("sections", [])
    twice = [name for name in dict.fromkeys(listed) if listed.count(name) > 1]
    problems = [
        Problem(key=("sections",), message=f'has "{name}" twice: name each section once')
        for name in twice
    ]
    if content.get("every", 1.0) <= 0:
        problems.append(Problem(key=("every",), message="must be a positive step of the input"))
    return problems


# ----------------------------------------------------------------------
# The results that a report shows.


#: Finished fractions of a report: sweep, circuits.
SWEPT, FOLLOWED = 0.3, 0.6
_MOST_TOLERANCES = 6  # quantities, if the template names none
NO_INPUT, NOT_FOUND = "the mechanism has no input", "no position was found"
_HIDDEN = "a question of the file hides it: report a copy of the file without [[questions]]"
#: The sections that would show the answer of a question.
_HIDING = {
    "numbers": ("vectors", "newton", "motion", "configurations", "forces", "tolerances"),
    "charts": ("plots",),
    "limits": ("motion", "circuits", "proof"),
    "input": ("vectors", "newton", "configurations"),
    "equations": ("equations", "vectors", "newton"),
}


def needs(condition: object, reason: str) -> None:
    """Leave out a section without this condition.

    Raises
    ------
    InputError
        With the reason.
    """
    if not condition:
        raise InputError(reason)


class Findings:
    """The results of one mechanism, each computed when a section first shows it.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        The input of the position that is drawn and solved step by step.
    configuration : str, optional
        The configuration or branch of position and motion.
    progress : callable
        Called with the finished fraction, up to :data:`FOLLOWED`.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        template: Template,
        at: float | Mapping[str, float] | None = None,
        configuration: str | None = None,
        progress: Callable[[float], None] = lambda fraction: None,
    ) -> None:
        self.mechanism, self.model, self.template = mechanism, mechanism.model, template
        self.at, self.configuration, self.progress = at, configuration, progress

    @property
    def source(self) -> str:
        """The mechanism file."""
        read = self.mechanism.read
        return textfile.write_text(self.mechanism.description) if read is None else read.text

    @cached_property
    def check(self) -> CheckReport:
        """How the file was read."""
        return self.mechanism.check()

    @cached_property
    def motion(self) -> Motion | None:
        """The sweep over the table of the input; ``None`` without an input."""
        if not self.model.description.inputs:
            return None
        return self.mechanism.sweep(
            configuration=self.configuration, progress=lambda part: self.progress(SWEPT * part)
        )

    @property
    def cycle(self) -> Motion:
        """The motion.

        Raises
        ------
        InputError
            If the mechanism has no input, or no position was found.
        """
        if self.motion is None:
            raise InputError(NO_INPUT)
        needs(self.motion.found.any(), NOT_FOUND)
        return self.motion

    @cached_property
    def position(self) -> Position:
        """The position that is drawn, by default at round values near those of the guess."""
        swept, steps = self.motion, self.configuration is None
        position = self.mechanism.solve(self.at, configuration=self.configuration, with_steps=steps)
        if self.at is not None or swept is None or not swept.found.any():
            return position
        model = self.model if steps else self.model.from_position(position)
        near = motion.solve_round_start(model, swept, position)
        if not near.status.ok or near.input == position.input:
            return position
        return self.mechanism.solve(near.input, with_steps=True) if steps else near

    @property
    def where(self) -> str:
        """The input of the position, ``at crank = 60 deg``; "" without an input."""
        return inputs_text(self.position.input, self.position.input_units)

    @cached_property
    def circuits(self) -> Circuits:
        """All circuits."""
        return self.mechanism.circuits(
            progress=lambda part: self.progress(SWEPT + (FOLLOWED - SWEPT) * part)
        )

    @cached_property
    def configurations(self) -> Configurations:
        """The configurations at the input of the drawn position."""
        return self.mechanism.configurations(self.position.input or None)

    @cached_property
    def forces(self) -> Reactions:
        """The forces in the rows of the motion."""
        return self.mechanism.forces(motion=self.cycle)

    @property
    def stalls(self) -> tuple[Stall, ...]:
        """Where friction stops the motion."""
        if ForceStatus.SELF_LOCKING not in self.forces.statuses:
            return ()
        return stalls(self.mechanism, motion=self.cycle, configuration=self.configuration)

    @cached_property
    def tolerances(self) -> tuple[Tolerance, ...]:
        """The tolerances at the drawn position."""
        usual = self.position.outputs or self.position.unknowns
        names = self.template.tolerances_of or tuple(usual)[:_MOST_TOLERANCES]
        at = self.position.input or None
        return tuple(
            tolerance(self.mechanism, of, at, configuration=self.configuration) for of in names
        )

    def check_hidden(self, section: str) -> None:
        """Leave out a section that would give the answer of a question.

        Raises
        ------
        InputError
            With the reason.
        """
        for question in self.model.description.questions:
            hidden = {name for part in question.hide for name in _HIDING[part]}
            needs(section not in hidden | {"file"}, _HIDDEN)

    def shown(self, section: str) -> Any:
        """The result of a section with the same name; ``None`` if the report leaves it out."""
        if section not in self.template.sections:
            return None
        try:
            self.check_hidden(section)
            return getattr(self, section)
        except InputError:
            return None


# ----------------------------------------------------------------------
# Sections about the mechanism itself: summary, drawings, dimensions, equations, iterations.


_TABLES = {
    "dimensions": "Dimensions",
    "lengths": "Lengths of links",
    "angles": "Angles of links",
    "sliders": "Offsets of sliders",
}


def tables(caption: str, columns: list[Column]) -> Iterator[Table]:
    """One table, or several if it is wider than the page."""
    for k, part in enumerate(split_columns(columns)):
        yield Table(caption=caption if not k else f"{caption} (continued)", columns=part)


def summary(findings: Findings) -> Iterator[Block]:
    """What the mechanism is, and how the file was read."""
    description = findings.model.description
    texts = {"purpose": description.purpose, "source": description.source}
    units = f"lengths in {description.length}, angles in {description.angle.value}"
    pairs = [(label, text) for label, text in texts.items() if text]
    pairs += [*check_fields(findings.check), ("units", units)]
    if not findings.position.status.ok and findings.position.failure is not None:
        pairs += findings.position.failure.sentences()
    yield Facts(pairs=tuple(pairs), quoted=frozenset(texts))


def drawing(findings: Findings) -> Iterator[Block]:
    """The position with its dimensions, and the paths of traced points."""
    needs(findings.position.status.ok, NOT_FOUND)
    needs(findings.model.compiled.points.names, "the mechanism has no points to draw")
    options = SceneOptions(dimensions=True, title="")
    scene = scene_of(findings.position, findings.motion, options=options)
    description = findings.model.description
    hidden = any("input" in question.hide for question in description.questions)
    where = "" if hidden else findings.where
    traced_points = findings.motion is not None and findings.motion.skeleton.traced
    paths = ", with the paths of traced points" if traced_points else ""
    caption = f"The mechanism {where}".rstrip() + f"{paths}. Lengths in {description.length}."
    yield Figure(caption=caption, picture=scene)


def vectors(findings: Findings) -> Iterator[Block]:
    """The loop equations as vectors: a diagram and their sizes and directions."""
    needs(findings.position.status.ok, NOT_FOUND)
    needs(findings.mechanism.loop_equations.loops, "the mechanism has no loop equations")
    loops = vector_loops(findings.model, findings.position)
    options = SceneOptions(vectors=loops, title="", arrows=False)
    scene = scene_of(findings.position, None, options=options)
    yield Figure(
        caption=f"The loop equations as vectors, head to tail, {findings.where}".rstrip(" ,") + ".",
        picture=scene,
    )
    unit = findings.model.description.length
    for k, loop in enumerate(loops, 1):
        sides = [("left", vector) for vector in loop.left]
        sides += [("right", vector) for vector in loop.right]
        values = [vector.value for _, vector in sides]
        angles = [math.degrees(phase(z)) if z else math.nan for z in values]
        columns = [
            Column(header="vector", cells=[vector.name for _, vector in sides]),
            Column(header="side", cells=[side for side, _ in sides]),
            Column(header=f"size [{unit}]", cells=lengths(map(abs, values)), align="point"),
            Column(header="direction [deg]", cells=[fixed(a, 3) for a in angles], align="point"),
            Column(header=f"x [{unit}]", cells=lengths(z.real for z in values), align="point"),
            Column(header=f"y [{unit}]", cells=lengths(z.imag for z in values), align="point"),
        ]
        yield from tables(
            f"Vectors of loop {k}, {pretty(loop.label)}, {findings.where}".rstrip(" ,"), columns
        )


def dimensions(findings: Findings) -> Iterator[Block]:
    """The given numbers by their tables in the file, then the parts."""
    description = findings.model.description
    kinds = {v.name: v.kind for v in findings.model.equations.variables}
    named = dimension_kinds(traced(description))
    numbers = [n for n in varied_numbers(description) if n.table != "guess"]
    for table, caption in _TABLES.items():
        rows = [n for n in numbers if n.table == table]
        if not rows:
            continue
        units = [
            findings.model.units.of(named.get(canonical(n.key), Kind.NUMBER))
            if table == "dimensions"
            else n.unit(description, kinds)
            for n in rows
        ]
        written = [n.written(description) for n in rows]
        formulas = [f"= {entry}" if isinstance(entry, str) else "" for entry in written]
        # numbers of the file as they are, values of formulas rounded
        cells = [
            short(n.of(description), 7 if formula else 10)
            for n, formula in zip(rows, formulas, strict=True)
        ]
        columns = [
            Column(header="name", cells=[shown_name(n.name) for n in rows]),
            Column(header="value", cells=cells, align="point", units=units),
        ]
        if any(formulas):
            columns.append(Column(header="formula", cells=formulas))
        yield from tables(caption, columns)
    yield from _points(findings)
    if findings.check.measured:
        links, points, values = zip(*findings.check.measured, strict=True)
        columns = [
            Column(header="link", cells=links),
            Column(header="points", cells=points),
            Column(header=f"length [{description.length}]", cells=lengths(values), align="point"),
        ]
        yield from tables("Lengths measured in the sketch", columns)
    if findings.check.measured_in_parts:
        columns = measured_part_columns(findings.check)
        yield from tables("Measured in the sketch for parts", columns)
    parts = part_lines(description)
    if parts:
        names, entry = zip(*parts, strict=True)
        columns = [Column(header="table", cells=names), Column(header="given", cells=entry)]
        yield from tables("Further data of the file, in its words and units", columns)


def _points(findings: Findings) -> Iterator[Table]:
    """The coordinates in the file, a row for every point."""
    description = findings.model.description
    if not isinstance(description, Draft) or not description.points:
        return
    unit = description.length
    ground = findings.model.equations.fixed
    columns = [Column(header="point", cells=list(map(pretty, description.points)))]
    for axis, letter in enumerate("xy"):
        coordinates = [description.numbers(place[axis]) for place in description.points.values()]
        header = f"{letter} [{unit}]"
        columns.append(Column(header=header, cells=list(map(short, coordinates)), align="point"))
    of = ["fixed" if name in ground else "sketch" for name in description.points]
    columns.append(Column(header="", cells=of))
    yield from tables("Coordinates of points in the file", columns)


def equations(findings: Findings) -> Iterator[Block]:
    """The closure equations in complex form and as scalar equations."""
    sheet = EquationSheet(findings.model.equations)
    printed = sheet.equations
    kinds = [("unknowns", printed.unknowns), ("inputs", printed.inputs)]
    listed = [
        (name, ", ".join(f"{pretty(v.shown)} ({v.kind})" for v in variables))
        for name, variables in kinds
        if variables
    ]
    yield Facts(pairs=tuple(listed))
    if not printed.labels:
        yield Text(text="There is no loop: all positions follow from the inputs directly.")
    mathml, latex = MathML(), Latex()
    if printed.loops:
        yield Text(text="Loop closure equations in complex form", style="note")
        for loop in printed.loops:
            yield Equation(mathml=sheet.loop(loop, mathml).element(), latex=sheet.loop(loop, latex))
        yield Text(text="Scalar equations: real parts, imaginary parts, others", style="note")
    rows = zip(sheet.real_rows(mathml), sheet.real_rows(latex), strict=True)
    for row, tex in rows:
        zero = mathml.equation(row, mathml.number("0"))
        yield Equation(mathml=zero.element(), latex=f"{tex} = 0")
    for law in printed.laws:
        if law.meaning:
            yield Text(text=f"{pretty(law.label)}: {law.meaning}")


def newton(findings: Findings) -> Iterator[Block]:
    """The iterations of every block: the iterates, then F, J and Δ of each."""
    position, units = findings.position, findings.model.units
    needs(findings.mechanism.loop_equations.unknowns, "the mechanism has no unknowns")
    needs(position.steps, "a chosen configuration has no iterations from the guess")
    kinds = {v.name: Kind(v.kind) for v in findings.model.equations.unknowns}
    yield Text(
        text=f"Newton-Raphson solves F(x) = 0 from the guess of the file {findings.where}".rstrip()
        + ": in each iteration J Δ = −F gives the change Δ of the unknowns, with J = ∂F/∂x "
        "(angles in radians)."
    )
    for trail in position.steps:
        block = ", ".join(map(pretty, trail.equations))
        yield from tables(f"Iterates of {block}", trail_columns(trail, kinds, units))
        if not trail.status.ok:
            yield Text(text=f"{trail.status.value}.")
        for step in trail.steps[:-1]:
            yield from tables(f"F and J of {block} at k = {step.k}", system_columns(trail, step))
            yield Text(text=f"Δ: {changes_text(step, kinds, units)}")


# ----------------------------------------------------------------------
# Sections about evidence: proofs, versions, the file.


def proof(findings: Findings) -> Iterator[Block]:
    """One paragraph on which results are proved, and the evidence in numbers."""
    others = [name for name in ("forces", "tolerances") if findings.shown(name)]
    listed = " and ".join(", ".join(["rates", "plots", *others]).rsplit(", ", 1))
    unproved = f"Not proved are {listed}: they are computed in double precision from the positions."
    yield Text(text=" ".join([*_positions(findings), *_lists(findings), unproved]))
    if findings.motion is not None and findings.motion.found.any():
        measure = " of the longest link" if findings.model.equations.loops else ""
        yield Facts(pairs=tuple(evidence_fields(findings.motion, measure)))


def _positions(findings: Findings) -> Iterator[str]:
    motion, equations = findings.motion, findings.model.equations
    radius = radius_measure(equations.loops, equations.real)
    if motion is None:
        if not findings.position.status.ok:
            yield f"No position was found: {findings.position.message}."
            return
        certificate = certificate_text(findings.position.certificate, radius)
        yield f"Certificate of the position: {certificate}."
        return
    there = int(motion.found.sum())
    yield f"Rows with a position: {there} of {len(motion)}."
    if not there:
        return
    proved = np.flatnonzero(motion.certified)
    yield f"Rows with a complete proof: {len(proved)}."
    if len(proved):
        largest = significant(float(motion.radius[proved].max()), 2)
        yield (
            f"In each of these, a true position lies within {largest}"
            f"{radius} of the computed one, no other lies near it, and the motion from "
            "the start to it stays on one branch."
        )
    for reason in Certification:
        count = sum(
            c is reason for c, here in zip(motion.certification, motion.found, strict=True) if here
        )
        if count and reason is not Certification.CERTIFIED:
            yield f"Rows without it: {count}; {reason.value}."


def _lists(findings: Findings) -> Iterator[str]:
    """How many circuits and configurations are proved, and whether their lists are complete."""
    circuits, configurations = findings.shown("circuits"), findings.shown("configurations")
    if circuits is not None:
        certified = sum(circuit.certified for circuit in circuits)
        if len(circuits):
            yield f"Circuits proved to be one curve: {certified} of {len(circuits)}."
        yield _sentence(circuits.message)
    if configurations is not None:
        certified = sum(p.certificate.certified for p in configurations)
        if len(configurations):
            yield f"Proved configurations: {certified} of {len(configurations)}."
        yield _sentence(f"configurations: {configurations.message}")


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


def versions(findings: Findings) -> Iterator[Block]:
    """The programs that computed the results."""
    yield Facts(
        pairs=(
            ("Linkwork", metadata.version("linkwork")),
            ("NumPy", np.__version__),
            ("Python", platform.python_version()),
        )
    )


def file(findings: Findings) -> Iterator[Block]:
    """The mechanism file, complete."""
    yield Text(text="All results of this report are computed from the file below.")
    yield Text(text=findings.source, style="listing")
