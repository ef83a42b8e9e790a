"""Conversion of results and files to events: numbers in lists, ``None`` for missing values."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePath

from linkwork.equations.notation import PlainText
from linkwork.equations.writing import EquationSheet
from linkwork.foundation.errors import ExpressionError, MechanismError, key_text
from linkwork.foundation.names import GROUND
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.loops import Loops
from linkwork.mechanism.varied_number import varied_numbers
from linkwork.results.configurations import Configurations
from linkwork.results.iterates import Iterate, Iterates
from linkwork.results.limit import Limit
from linkwork.results.motion import Motion
from linkwork.results.nearest_assembly import LinkEnd, NearestAssembly
from linkwork.results.position import Position
from linkwork.viewer.live import events as tell
from linkwork.viewer.live.exported_file import ExportedFile
from linkwork.viewer.live.force_entries import entries_shown
from linkwork.viewer.live.history import History
from linkwork.viewer.live.mass_entries import masses_shown
from linkwork.viewer.live.part_entries import parts_shown
from linkwork.viewer.live.readiness import lacks_of
from linkwork.viewer.live.subject import Subject
from linkwork.viewer.page_data import PageData
from linkwork.viewer.still_page import still_page

__all__ = [
    "cannot_close",
    "configurations_found",
    "exported",
    "file_state",
    "limit_found",
    "motion_found",
    "newton_shown",
    "position_found",
    "problems_found",
]

Numbers = dict[str, float | None]


def motion_found(
    motion: Motion, *, live: bool, message: str = "", page: PageData | None = None
) -> tell.MotionFound:
    """The cycle with its page data."""
    name, unit = next(iter(motion.input_units.items()))
    return tell.MotionFound(
        live=live,
        rows=len(motion),
        missing=int((motion.asked & ~motion.found).sum()),
        certified=int(motion.certified.sum()),
        limits=tuple(limit_found(limit, name, unit) for limit in motion.limits),
        message=message or motion.message,
        page=page,
    )


def limit_found(limit: Limit, name: str, unit: str) -> tell.LimitFound:
    """A dead point or change point; ``name`` and ``unit`` are the leading input's."""
    return tell.LimitFound(
        what=limit.kind.word,
        input=limit.input,
        located=limit.located,
        sentence=limit.told(name, unit),
    )


def exported(file: ExportedFile, source: str, word: str = "") -> tell.Exported:
    """A file named like the mechanism file ``source``, with a further word."""
    return tell.Exported(
        name=f"{PurePath(source).stem}{word}.{file.suffix}",
        media_type=file.media_type,
        content=base64.b64encode(file.content).decode(),
        notices=file.notices,
    )


def position_found(position: Position) -> tell.PositionFound:
    """One position, or the reason why there is none."""
    return tell.PositionFound(
        status=position.status.name,
        message=position.message,
        input=dict(position.input),
        unknowns=_numbers(position.unknowns),
        links=_numbers(position.links),
        sliders=_numbers(position.sliders),
        outputs=_numbers(position.outputs),
        points=_points(position.points),
        residual=_number(position.residual),
        iterations=position.iterations,
        condition=_number(position.condition),
        certified=position.certificate.certified,
        page=_still(position),
    )


def cannot_close(
    nearest: NearestAssembly,
    message: str,
    remedies: Mapping[str, float],
    elsewhere: Mapping[str, float],
) -> tell.CannotClose:
    """The least-squares position of a mechanism that cannot be closed."""
    return tell.CannotClose(
        message=message,
        input=dict(nearest.input),
        gap=nearest.gap,
        gaps=dict(nearest.gaps),
        unknowns=dict(nearest.unknowns),
        points=_points(nearest.points),
        open_ends=_open_ends(nearest.apart),
        remedies=dict(remedies),
        elsewhere=dict(elsewhere),
        page=_still(nearest),
    )


def _still(found: Position | NearestAssembly) -> PageData | None:
    """The drawing of a position; ``None`` without points."""
    points = _points(found.points)
    # a position that was not found has no coordinates
    if not points or points.keys() != found.points.keys():
        return None
    return still_page(found.skeleton, points, units=found.units, title=found.mechanism)


def _open_ends(ends: Iterable[LinkEnd]) -> tuple[tell.OpenEnd, ...]:
    return tuple(tell.OpenEnd(link=e.link, point=e.point, joint=e.joint, end=e.end) for e in ends)


def configurations_found(found: Configurations) -> tell.ConfigurationsFound:
    """All configurations with their pictures."""
    return tell.ConfigurationsFound(
        input=dict(found.input),
        ways=tuple(
            tell.Way(
                name=way.configuration, unknowns=dict(way.unknowns), points=_points(way.points)
            )
            for way in found
        ),
        completeness=found.message,
    )


def newton_shown(
    shown: Iterates, guess: Mapping[str, float], guessed: tuple[str, ...]
) -> tell.NewtonShown:
    """The iterates and the final status.

    ``guess`` are the changed unknowns of the guess, ``guessed`` its points.
    """
    position = shown.position
    trouble = None if position.failure is None else position.failure.trouble
    return tell.NewtonShown(
        guess=dict(guess),
        guessed=guessed,
        iterates=tuple(map(_iterate, shown.iterates)),
        status=position.status.name,
        trouble="" if trouble is None else trouble.name,
        message=position.message,
        input=dict(position.input),
        unknowns=_numbers(position.unknowns),
        points=_points(position.points),
    )


def _iterate(each: Iterate) -> tell.NewtonIterate:
    return tell.NewtonIterate(
        equations=each.equations,
        k=each.k,
        unknowns=_numbers(each.unknowns),
        residuals=_row(each.residuals),
        norm=_number(each.norm),
        jacobian=tuple(map(_row, each.jacobian)),
        step=None if each.step is None else _number(each.step),
        points=_points(each.points),
        open_ends=_open_ends(each.apart),
    )


def problems_found(error: MechanismError, *, lines: bool = True) -> tell.ProblemsFound:
    """The problems reported by the reader, with ``lines`` if the text is visible to the user."""
    return tell.ProblemsFound(
        where=error.where,
        problems=tuple(
            tell.ProblemShown(
                line=p.line if lines else None, key=key_text(p.key), message=p.message
            )
            for p in error.problems
        ),
    )


def _changeable_numbers(
    description: Description, kinds: Mapping[str, str]
) -> Iterator[tell.ChangeableNumber]:
    """All named numbers of a file, then the lengths measured in its sketch.

    ``kinds``: angle, length or number for every variable of the equations.
    """
    for quantity in varied_numbers(description):
        written = quantity.written(description)
        try:
            value = description.numbers(written)
        except ExpressionError:  # of a draft, which says so
            continue
        yield tell.ChangeableNumber(
            name=quantity.name,
            value=value,
            unit=quantity.unit(description, kinds),
            table=quantity.table,
            formula=written if isinstance(written, str) else "",
        )
    if isinstance(description, Draft):
        for measured in description.measured:
            yield tell.ChangeableNumber(
                name=" ".join(measured.points),
                value=measured.length,
                unit=description.length,
                table="measured",
            )


def _unknowns_of(sheet: EquationSheet, description: Description) -> tuple[tell.Unknown, ...]:
    """The unknowns with their guess, in file units."""
    units = {"angle": description.angle.value, "length": description.length}
    scale = {"angle": description.angle.radians}
    equations = sheet.equations
    return tuple(
        tell.Unknown(
            name=unknown.name,
            unit=units.get(unknown.kind, ""),
            guess=float(start) / scale.get(unknown.kind, 1.0),
        )
        for unknown, start in zip(equations.unknowns, equations.start, strict=False)
    )


def _driven_inputs(sheet: EquationSheet, description: Description) -> tuple[tell.DrivenInput, ...]:
    """The driven quantities and their ranges."""
    found = []
    timed = [which for which in description.inputs if which.law is not None]
    # laws of several inputs share the time
    inputs = timed[:1] or description.inputs
    for which, variable in zip(inputs, sheet.equations.inputs, strict=True):
        rows = description.rows(which)
        found.append(
            tell.DrivenInput(
                name=variable.name,
                unit={"angle": description.angle.value, "length": description.length}.get(
                    variable.kind, ""
                ),
                drive=which.drives[0],
                start=float(rows[0]),
                stop=float(rows[-1]),
                rows=len(rows),
                speed="" if which.speed is None else str(which.speed),
            )
        )
    return tuple(found)


def _sketched_points(description: Description) -> dict[str, tuple[float, float]]:
    """The movable points of a sketch; none if they are given by equations."""
    if not isinstance(description, Draft):
        return {}
    found = description.drawable if description.problems else description
    places = {point: found.sketched(point) for point in found.points}
    return {point: (float(z.real), float(z.imag)) for point, z in places.items()}


def _links_of(description: Description) -> tuple[tell.Link, ...]:
    """The links of a file."""
    links: Mapping[str, tuple[str, ...]] = getattr(description, "links", {})
    return tuple(tell.Link(name=name, points=tuple(points)) for name, points in links.items())


def _drives_of(sheet: EquationSheet | None, description: Description) -> tuple[tell.Drive, ...]:
    """Possible inputs: links, displacements and lengths of a linkage, otherwise any variable."""
    if isinstance(description, Draft):
        named = [("link", name) for name in description.links if name != GROUND]
        named += [(part.drive, part.label) for part in description.parts if part.drive]
    elif sheet is None:
        named = []
    else:
        named = [("variable", variable.name) for variable in sheet.equations.variables]
    return tuple(tell.Drive(kind=kind, name=name) for kind, name in named)


def _loop_texts(sheet: EquationSheet) -> tuple[str, ...]:
    """The equations in textbook notation."""
    plain = PlainText()
    loops = tuple(sheet.loop(loop, plain) for loop in sheet.equations.loops)
    return loops or tuple(f"{row} = 0" for row in sheet.real_rows(plain))


def _form_of(description: Description) -> str:
    """The form of the file."""
    if isinstance(description, Draft):
        return "points-and-links"
    return "loops" if isinstance(description, Loops) else "plain-equations"


def _row(values: Iterable[float]) -> tuple[float | None, ...]:
    return tuple(map(_number, values))


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _numbers(table: Mapping[str, float]) -> Numbers:
    return {name: _number(value) for name, value in table.items()}


def _points(table: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    """Points with finite coordinates."""
    return {p: (x, y) for p, (x, y) in table.items() if math.isfinite(x) and math.isfinite(y)}


def file_state(
    file: str, subject: Subject, history: History, *, text: str, unsaved: bool
) -> tell.FileState:
    """A file as the page edits it: its text, and the parts, numbers and equations read from it."""
    description = subject.description
    sheet = None if subject.solvable is None else subject.solvable.equations()
    kinds = {} if sheet is None else {v.name: v.kind for v in sheet.equations.variables}
    parts = tuple(parts_shown(description)) if isinstance(description, Draft) else ()
    return tell.FileState(
        file=file,
        title=description.name,
        text=text,
        form=_form_of(description),
        unsaved=unsaved,
        undo=history.undo_what,
        redo=history.redo_what,
        length_unit=description.length,
        angle_unit=description.angle.value,
        configuration=description.configuration,
        numbers=tuple(_changeable_numbers(description, kinds)) if subject.readable else (),
        unknowns=() if sheet is None else _unknowns_of(sheet, description),
        inputs=() if sheet is None else _driven_inputs(sheet, description),
        points=_sketched_points(description),
        links=_links_of(description),
        parts=tuple(part.name for part in parts),
        part_entries=parts,
        masses=tuple(masses_shown(description)),
        mass_unit=getattr(description, "mass", ""),
        force_unit=getattr(description, "force", ""),
        force_entries=tuple(entries_shown(description)),
        drives=_drives_of(sheet, description),
        traceable=tuple(getattr(description, "points", ())),
        traced=description.trace,
        outputs=tuple(description.outputs),
        equations=() if sheet is None else _loop_texts(sheet),
        lacks=lacks_of(subject),
        readable=subject.readable,
    )
