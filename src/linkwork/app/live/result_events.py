"""Files for the visitor: the mechanism as text, picture, table, workbook, page or film."""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import PurePath

import numpy as np

from linkwork.app.live.events import (
    BranchFound,
    CannotClose,
    CircuitFound,
    CircuitsFound,
    ConfigurationsFound,
    Exported,
    LimitFound,
    MotionFound,
    NewtonIterate,
    NewtonShown,
    OpenEnd,
    PositionFound,
    ProblemsFound,
    Way,
)
from linkwork.app.live.file_state import (
    ChangeableNumber,
    Drive,
    DrivenInput,
    FileState,
    Link,
    ProblemShown,
    Unknown,
)
from linkwork.app.live.force_entries import entries_shown, masses_shown
from linkwork.app.live.history import History
from linkwork.app.live.palette import parts_shown
from linkwork.app.live.subject import Subject, missing_items
from linkwork.app.pages.animation import FilmOptions, animation, check_animation
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.app.pages.offline_page import offline_page, still_page
from linkwork.app.pages.page_building import motion_page
from linkwork.app.pages.page_data import PageData
from linkwork.circuits.results import Branch, Circuit, Circuits, Configurations
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.mechanism_scene import scene_of
from linkwork.core.drawing.scene import Scene
from linkwork.core.drawing.vector_files import FixedInks, inline_svg
from linkwork.core.equations.notation import PlainText
from linkwork.core.equations.writing import EquationSheet
from linkwork.core.foundation.errors import (
    ExpressionError,
    InputError,
    MechanismError,
    UnknownNameError,
    choices,
    key_text,
)
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.varied_numbers import varied_numbers
from linkwork.core.motion.iterating import moving_loops
from linkwork.core.results.failure import Limit
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Iterate, Iterates, LinkEnd, NearestAssembly, Position
from linkwork.core.results.tables import csv_text

_MEDIA_TYPES = {
    "toml": "application/toml",
    "svg": "image/svg+xml",
    "csv": "text/csv",
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "html": "text/html",
    "gif": "image/gif",
    "webp": "image/webp",
    "mp4": "video/mp4",
}
_LONGEST = 1200.0  # the longer side of a picture [CSS pixels]


@dataclass(frozen=True, kw_only=True)
class ExportedFile:
    """A file: its suffix, media type and content; ``notices`` are remarks on it."""

    suffix: str
    media_type: str
    content: bytes
    notices: tuple[str, ...] = ()


def exported_file(
    suffix: str,
    subject: Subject,
    motion: Motion | None,
    text: str,
    *,
    row: int | None = None,
    dark: bool = False,
    progress: Callable[[float], None] | None = None,
) -> ExportedFile:
    """A mechanism, or the text of a draft, in one of several formats.

    Parameters
    ----------
    suffix : str
        ``toml``, ``svg``, ``csv``, ``xlsx``, ``html``, ``gif``, ``webp`` or ``mp4``.
    motion : Motion, optional
        Its cycle; without one there are text and picture only.
    text : str
        Its text as edited.
    row : int, optional
        The row of a picture; by default the first with a position.
    dark : bool
        Pictures and films for dark pages.
    progress : callable, optional
        Receives the finished fraction of a film; may raise an error to cancel it.

    Raises
    ------
    UnknownNameError
        If the format is not known.
    InputError
        If there is nothing to write.
    MissingPackageError
        If this installation cannot write the format.
    """
    if suffix not in _MEDIA_TYPES:
        known = choices("formats", _MEDIA_TYPES, suffix)
        raise UnknownNameError(f'cannot write the format "{suffix}" {known}')
    notices: tuple[str, ...] = ()
    if suffix == "toml":
        content = text.encode()
    elif suffix == "svg":
        scene = _scene(subject.mechanism, motion, row)
        content = inline_svg(scene, FixedInks(dark=dark), longest=_LONGEST).encode()
    else:
        if motion is None or not motion.found.any():
            raise InputError(f"a .{suffix} file needs a motion: the mechanism has none")
        mechanism = subject.mechanism
        if suffix == "csv":
            content = csv_text(motion.table()).encode()
        elif suffix == "html":
            equations = mechanism.equations().mathml()
            loops = partial(moving_loops, mechanism.model)
            page = motion_page({"motion": motion}, equations=equations, loops=loops)
            content = offline_page(page).encode()
        elif suffix == "xlsx":
            # most visitors write none
            from linkwork.writers.workbook.workbook import workbook_of

            written = workbook_of(mechanism.model, motion)
            content, notices = written.content, written.notices
        else:
            options = FilmOptions(theme="dark" if dark else "light")
            check_animation(f"film.{suffix}", options)
            content = animation({"": motion}, suffix, options=options, progress=progress)
    return ExportedFile(
        suffix=suffix, media_type=_MEDIA_TYPES[suffix], content=content, notices=notices
    )


def _scene(mechanism: Mechanism, motion: Motion | None, row: int | None) -> Scene:
    """The picture of a row, or without a motion of the only position."""
    if motion is None:
        position = mechanism.solve()
        if not position.status.ok:
            raise InputError(f"there is no position to draw: {position.message}")
        return scene_of(position)
    if not motion.found.any():
        raise InputError("there is no position to draw: no row of the motion has one")
    shown = int(np.flatnonzero(motion.found)[0]) if row is None else row
    if not 0 <= shown < len(motion):
        raise InputError(f"there is no row {row}: the motion has {len(motion)}")
    return moving_scene(motion).at(shown)


# ----------------------------------------------------------------------
# Conversion of results and files to events: numbers in lists, ``None`` for missing values.


Numbers = dict[str, float | None]


def motion_found(
    motion: Motion, *, live: bool, message: str = "", page: PageData | None = None
) -> MotionFound:
    """The cycle with its page data."""
    name, unit = next(iter(motion.input_units.items()))
    return MotionFound(
        live=live,
        rows=len(motion),
        missing=int((motion.asked & ~motion.found).sum()),
        certified=int(motion.certified.sum()),
        limits=tuple(limit_found(limit, name, unit) for limit in motion.limits),
        message=message or motion.message,
        page=page,
    )


def limit_found(limit: Limit, name: str, unit: str) -> LimitFound:
    """A dead point or change point; ``name`` and ``unit`` are the leading input's."""
    return LimitFound(
        what=limit.kind.word,
        input=limit.input,
        located=limit.located,
        sentence=limit.told(name, unit),
    )


def exported(file: ExportedFile, source: str, word: str = "") -> Exported:
    """A file named like the mechanism file ``source``, with a further word."""
    return Exported(
        name=f"{PurePath(source).stem}{word}.{file.suffix}",
        media_type=file.media_type,
        content=base64.b64encode(file.content).decode(),
        notices=file.notices,
    )


def position_found(position: Position) -> PositionFound:
    """One position, or the reason why there is none."""
    return PositionFound(
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
) -> CannotClose:
    """The least-squares position of a mechanism that cannot be closed."""
    return CannotClose(
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


def _still(position: Position | NearestAssembly) -> PageData | None:
    """The drawing of a position; ``None`` without points."""
    points = _points(position.points)
    # a position that was not solved has no coordinates
    if not points or points.keys() != position.points.keys():
        return None
    return still_page(position.skeleton, points, units=position.units, title=position.mechanism)


def _open_ends(ends: Iterable[LinkEnd]) -> tuple[OpenEnd, ...]:
    return tuple(OpenEnd(link=e.link, point=e.point, joint=e.joint, end=e.end) for e in ends)


def configurations_found(configurations: Configurations) -> ConfigurationsFound:
    """All configurations with their pictures."""
    return ConfigurationsFound(
        input=dict(configurations.input),
        ways=tuple(
            Way(name=way.configuration, unknowns=dict(way.unknowns), points=_points(way.points))
            for way in configurations
        ),
        completeness=configurations.message,
    )


def newton_shown(
    shown: Iterates, guess: Mapping[str, float], guessed: tuple[str, ...]
) -> NewtonShown:
    """The iterates and the final status.

    ``guess`` are the changed unknowns of the guess, ``guessed`` its points.
    """
    position = shown.position
    trouble = None if position.failure is None else position.failure.trouble
    return NewtonShown(
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


def _iterate(each: Iterate) -> NewtonIterate:
    return NewtonIterate(
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


def problems_found(error: MechanismError, *, lines: bool = True) -> ProblemsFound:
    """The problems reported by the reader, with ``lines`` if the text is visible to the user."""
    return ProblemsFound(
        where=error.where,
        problems=tuple(
            ProblemShown(line=p.line if lines else None, key=key_text(p.key), message=p.message)
            for p in error.problems
        ),
    )


def _changeable_numbers(
    description: Description, kinds: Mapping[str, str]
) -> Iterator[ChangeableNumber]:
    """All named numbers of a file, then the lengths measured in its sketch.

    ``kinds``: angle, length or number for every variable of the equations.
    """
    for quantity in varied_numbers(description):
        written = quantity.written(description)
        try:
            value = description.numbers(written)
        except ExpressionError:  # of a draft, which says so
            continue
        yield ChangeableNumber(
            name=quantity.name,
            value=value,
            unit=quantity.unit(description, kinds),
            table=quantity.table,
            formula=written if isinstance(written, str) else "",
        )
    if isinstance(description, Draft):
        for measured in description.measured:
            yield ChangeableNumber(
                name=" ".join(measured.points),
                value=measured.length,
                unit=description.length,
                table="measured",
            )


def _unknowns_of(sheet: EquationSheet, description: Description) -> tuple[Unknown, ...]:
    """The unknowns with their guess, in file units."""
    units = {"angle": description.angle.value, "length": description.length}
    scale = {"angle": description.angle.radians}
    equations = sheet.equations
    return tuple(
        Unknown(
            name=unknown.name,
            unit=units.get(unknown.kind, ""),
            guess=float(start) / scale.get(unknown.kind, 1.0),
        )
        for unknown, start in zip(equations.unknowns, equations.start, strict=False)
    )


def _driven_inputs(sheet: EquationSheet, description: Description) -> tuple[DrivenInput, ...]:
    """The driven quantities and their ranges."""
    driven = []
    timed = [which for which in description.inputs if which.law is not None]
    # laws of several inputs share the time
    inputs = timed[:1] or description.inputs
    for which, variable in zip(inputs, sheet.equations.inputs, strict=True):
        rows = description.rows(which)
        driven.append(
            DrivenInput(
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
    return tuple(driven)


def _sketched_points(description: Description) -> dict[str, tuple[float, float]]:
    """The movable points of a sketch; none if equations define them."""
    if not isinstance(description, Draft):
        return {}
    drawable = description.drawable if description.problems else description
    places = {point: drawable.sketched(point) for point in drawable.points}
    return {point: (float(z.real), float(z.imag)) for point, z in places.items()}


def _links_of(description: Description) -> tuple[Link, ...]:
    """The links of a file."""
    links: Mapping[str, tuple[str, ...]] = getattr(description, "links", {})
    return tuple(Link(name=name, points=tuple(points)) for name, points in links.items())


def _drives_of(sheet: EquationSheet | None, description: Description) -> tuple[Drive, ...]:
    """Possible inputs: links, displacements and lengths of a linkage, otherwise any variable."""
    if isinstance(description, Draft):
        named = [("link", name) for name in description.links if name != GROUND]
        named += [(part.drive, part.label) for part in description.parts if part.drive]
    elif sheet is None:
        named = []
    else:
        named = [("variable", variable.name) for variable in sheet.equations.variables]
    return tuple(Drive(kind=kind, name=name) for kind, name in named)


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
) -> FileState:
    """A file as the page edits it: its text, and the parts, numbers and equations read from it."""
    description = subject.description
    sheet = None if subject.solvable is None else subject.solvable.equations()
    kinds = {} if sheet is None else {v.name: v.kind for v in sheet.equations.variables}
    parts = tuple(parts_shown(description)) if isinstance(description, Draft) else ()
    return FileState(
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
        lacks=missing_items(subject),
        readable=subject.readable,
    )


# ----------------------------------------------------------------------
# The circuits of a mechanism as an event, with a page of their motions.


def circuits_found(circuits: Circuits, motion: Motion | None) -> CircuitsFound:
    """All circuits; ``motion`` is that of the file."""
    here = set() if motion is None else set(motion.branch) - {""}
    drawn = {c.name: c.motion for c in circuits if c.motion.points and c.motion.found.any()}
    return CircuitsFound(
        input=circuits.input,
        input_unit=circuits.input_unit,
        circuits=tuple(_circuit(circuit, circuits, here) for circuit in circuits),
        message=circuits.message,
        page=motion_page(drawn) if drawn else None,
    )


def _circuit(circuit: Circuit, circuits: Circuits, here: set[str]) -> CircuitFound:
    limits = (*circuit.dead_points, *circuit.change_points)
    names = {circuit.name, *(branch.name for branch in circuit.branches)}
    return CircuitFound(
        name=circuit.name,
        current=not here.isdisjoint(names),
        end=circuit.end.explanation,
        certified=circuit.certified,
        input_range=circuit.input_range,
        turns=circuit.turns,
        limits=tuple(limit_found(one, circuits.input, circuits.input_unit) for one in limits),
        branches=tuple(map(_branch, circuit.branches)),
    )


def _branch(branch: Branch) -> BranchFound:
    return BranchFound(
        name=branch.name,
        start=branch.configuration or branch.name,
        input_range=branch.input_range,
        certified=branch.certified,
    )
