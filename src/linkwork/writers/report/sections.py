"""Sections about the mechanism itself: summary, drawings, dimensions, equations, iterations."""

from __future__ import annotations

import math
import platform
from collections.abc import Iterator
from importlib import metadata

import numpy as np

from linkwork.core.drawing.annotations import SceneOptions
from linkwork.core.drawing.mechanism_scene import scene_of
from linkwork.core.equations.notation import Latex
from linkwork.core.equations.writing import EquationSheet, MathML
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import canonical, pretty
from linkwork.core.foundation.statuses import Certification
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import varied_numbers
from linkwork.core.motion import vector_loops
from linkwork.core.results.listing.check_listing import check_fields, measured_part_columns
from linkwork.core.results.listing.motion_listing import (
    Column,
    certificate_text,
    changes_text,
    evidence_fields,
    fixed,
    lengths,
    radius_measure,
    short,
    significant,
    system_columns,
    trail_columns,
)
from linkwork.core.results.quantity import Kind
from linkwork.core.textfile.writer import part_lines
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
)
from linkwork.writers.report.findings import NOT_FOUND, Findings, needs

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
