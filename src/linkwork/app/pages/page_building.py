"""The quantities of a page: columns over the rows, and numbers of the whole motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TypeVar

import numpy as np

from linkwork.app.pages.moving_scene import MovingScene, moving_scene
from linkwork.app.pages.packing import Pack, packed, play_order, shapes_of
from linkwork.app.pages.page_data import (
    AnswerData,
    Column,
    Equation,
    ForceData,
    LimitMark,
    MotionData,
    MotionNumber,
    PackedColumn,
    PageData,
    PointData,
    QuestionData,
    ReactionData,
    RoleStyle,
    RowEvidence,
    ThemeData,
    VectorData,
)
from linkwork.core.drawing.annotations import Force, check_forces, force_unit
from linkwork.core.drawing.dimensions import polygon
from linkwork.core.drawing.mechanism_scene import reach_of
from linkwork.core.drawing.pose import Pose, printed_formula, printed_name
from linkwork.core.drawing.scene import COINCIDENT, DARK, LIGHT, Box, Role, Theme
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.description import LIMITS, Question
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import MovingLoop
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantities.motions import PATH_LENGTH, STROKE, TIME_RATIO
from linkwork.core.results.quantities.registry import Call
from linkwork.core.results.quantities.rows import RECOMMENDED, TRANSMISSION_ANGLE
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.charts.chart import lead_of, rate_label, size_label

_MOST_NUMBERED = 5  # quantities with numbers of the motion by default


def columns_of(motion: Motion, pack: Pack, requested: Sequence[str] = ()) -> Iterator[Column]:
    """Inputs, unknowns, outputs and derived quantities, then those requested by name.

    Names that the mechanism does not have, and numbers of motions, are left out.
    """
    solved = motion.found
    for name, values in motion.inputs.items():
        yield Column(
            name=name,
            shown=printed_name(name),
            unit=motion.input_units[name],
            group="input",
            values=pack(values, solved),
            first=None,
            first_unit="",
        )
    groups = dict(usual_columns(motion))
    for name, group in groups.items():
        yield _column(motion, motion.quantity(name), group, pack)
    shown = {*motion.inputs, *groups}
    for name in dict.fromkeys(requested):
        quantity = _quantity_named(motion, name)
        if isinstance(quantity, Asked) and quantity.name not in shown:
            shown.add(quantity.name)
            yield _column(motion, quantity, "asked", pack)


def usual_columns(motion: Motion) -> Iterator[tuple[str, str]]:
    """The columns of every page, and their groups."""
    yield from ((name, "unknown") for name in (*motion.unknowns, *motion.riding))
    yield from ((name, "output") for name in motion.outputs)
    traced = motion.skeleton.traced
    for name, quantity in motion.quantities.derived.items():
        if quantity.row is not None and (not quantity.row.of_path or quantity.part in traced):
            yield name, "derived"


def reactions_of(motion: Motion) -> Iterator[ReactionData]:
    """The forces of pins and loads, whose components are columns."""
    numbers = {name: k for k, name in enumerate(motion.points)}
    for name, quantity in motion.quantities.derived.items():
        stem, _, axis = name.rpartition(".")
        if quantity.row is not None and quantity.row.pin and axis == "x":
            point, on, by = quantity.row.pin
            if point in numbers:
                x, y = f"{stem}.x", f"{stem}.y"
                yield ReactionData(point=numbers[point], on=on, by=by, x=x, y=y)


def _column(motion: Motion, quantity: Asked, group: str, pack: Pack) -> Column:
    solved, base, rate = motion.found, quantity.own, quantity.rate
    bounded = rate is None
    plain = bounded and quantity.group is not Group.EVIDENCE
    series = motion.series(quantity.name) if plain else None
    values = motion[quantity.name].astype(float) if series is None else series.value
    first = None if series is None or quantity.needs > 1 else series.first
    band: tuple[float, ...] = ()
    if bounded and quantity.row is TRANSMISSION_ANGLE:
        band = tuple(bound / motion.units.angle.radians for bound in RECOMMENDED)
    return Column(
        name=quantity.name,
        shown=_label(motion, quantity),
        unit=quantity.unit,
        group=group,
        values=pack(values, solved, rate=not bounded),
        first=None if first is None else pack(first, solved, rate=True),
        first_unit=Rate.FIRST.unit(base.kind, motion.units, motion.derivative_unit),
        band=band,
    )


def _label(motion: Motion, quantity: Asked) -> str:
    if quantity.rate is None:
        return printed_name(quantity.name)
    label = size_label if quantity.group is Group.POINT else rate_label
    return label(quantity.own.name, quantity.rate, lead_of(motion))


def _quantity_named(motion: Motion, name: str) -> Asked | None:
    """A quantity or rate by name; ``None`` if the mechanism or this motion does not have it."""
    try:
        return motion.quantity(name)
    except InputError:
        return None


def numbers_of(motion: Motion, requested: Sequence[str] = ()) -> Iterator[MotionNumber]:
    """Stroke and time ratio of outputs and unknowns, lengths of traced paths, then numbers of the
    motion requested by name; names that the mechanism does not have are left out.
    """
    moving = [*motion.outputs, *motion.unknowns][:_MOST_NUMBERED]
    usual = [f"{form.word}({name})" for name in moving for form in (*STROKE, *TIME_RATIO)]
    usual += [f"{form.word}({point})" for point in motion.skeleton.traced for form in PATH_LENGTH]
    for name in dict.fromkeys([*usual, *requested]):
        try:
            quantity = motion.quantities.find_of_motion(name)
            value = motion.value(name)
        except InputError:
            continue
        if name in usual and not math.isfinite(value):
            continue  # a stroke that does not return has no time ratio
        call, of_rows = Call.read(name), ", of the rows" if motion.is_of_rows(name) else ""
        yield MotionNumber(
            name=name,
            shown=f"{call.word.replace('_', ' ')} of {printed_name(call.of)}{of_rows}",
            unit=quantity.unit,
            value=value if math.isfinite(value) else None,
        )


# ----------------------------------------------------------------------
# The questions of a page, and their answers by a motion.


_ONE_ROW = 1e-9  # of the larger number: input values that are one row


def questions_of(motion: Motion) -> Iterator[QuestionData]:
    """The questions of the mechanism; units are the same in all of its motions."""
    for question in motion.skeleton.questions:
        unit, turns = _measure(motion, question)
        yield QuestionData(
            text=question.text,
            unit=unit,
            tolerance=float(question.tolerance),
            turn=motion.units.angle.turn if turns else 0.0,
            hide=question.hide,
        )


def _measure(motion: Motion, question: Question) -> tuple[str, bool]:
    """The unit of the answer, and whether a whole turn more is the same."""
    answer = question.answer
    if not isinstance(answer, str):
        return question.unit, False
    try:
        if answer in LIMITS:
            unit = motion.input_units[next(iter(motion.inputs))]
            return unit, unit == motion.units.angle.value
        if question.at is None:
            return motion.quantities.find_of_motion(answer).unit, False
        quantity = motion.quantity(answer)
    except InputError:  # such as a rate by time without a speed
        return "", False
    return quantity.unit, quantity.rate is None and quantity.own.kind is Kind.ANGLE


def answers_of(motion: Motion) -> Iterator[AnswerData]:
    """The right answers, any one of which will do; unknown where no position gives them, or a limit
    is only nearly located.
    """
    for question in motion.skeleton.questions:
        values = _values(motion, question)
        known = all(map(math.isfinite, values)) and (bool(values) or question.answer in LIMITS)
        yield AnswerData(known=known, values=values if known else ())


def _values(motion: Motion, question: Question) -> tuple[float, ...]:
    answer = question.answer
    if not isinstance(answer, str):
        return (float(answer),)
    if answer in LIMITS:
        limits = (limit for limit in motion.limits if limit.kind.name == LIMITS[answer])
        return tuple(limit.input if limit.located else math.nan for limit in limits)
    try:
        if question.at is None:
            return (motion.value(answer),)
        lead = motion.inputs[next(iter(motion.inputs))]
        off = np.where(motion.found, np.abs(lead - question.at), np.inf)
        row = int(off.argmin())
        there = off[row] <= _ONE_ROW * max(1.0, abs(question.at))
        return (float(motion[answer][row]),) if there else ()
    except InputError:
        return ()


# ----------------------------------------------------------------------
# The vectors of the loop equations over a motion, in the form that the front end draws.


def loop_arrows(loops: Sequence[MovingLoop], motion: Motion, pack: Pack) -> Iterator[VectorData]:
    """Every vector once, head to tail around its loop, in the order chosen for the first row."""
    if not motion.found.any():
        return
    row = int(np.flatnonzero(motion.found)[0])
    pose = Pose.at_row(motion, row)
    ways = {name: motion.trace(name) for name in motion.points}
    sizes = [np.nanmax(np.abs(v.values)) for loop in loops for v in (*loop.left, *loop.right)]
    near = COINCIDENT * float(max(sizes, default=0.0))
    known: list[tuple[str, ComplexArray]] = []
    for number, loop in enumerate(loops, 1):
        for name, tail, tip in _around(loop, row, pose, ways, near):
            if np.nanmax(np.abs(tip - tail)) <= near:
                continue
            if any(name == other and _together(tail, place, near) for other, place in known):
                continue
            known.append((name, tail))
            ends = [_point(place, ways, near) for place in (tail, tip)]
            free = -1 in ends
            yield VectorData(
                name=printed_formula(name),
                start=-1 if free else ends[0],
                end=-1 if free else ends[1],
                tone=number,
                course=tuple(_course(tail, tip, motion, pack)) if free else (),
            )


def _around(
    loop: MovingLoop, row: int, pose: Pose, ways: dict[str, ComplexArray], near: float
) -> Iterator[tuple[str, ComplexArray, ComplexArray]]:
    """Name, tail and tip (N,) of every vector, beginning at the start of a row's polygon."""
    shown = loop.at(row)
    moving = dict(zip(map(id, (*shown.left, *shown.right)), (*loop.left, *loop.right), strict=True))
    left = set(map(id, shown.left))
    edges = polygon(shown, pose)
    if not edges:
        return
    first = edges[0]
    start = first.tip if (id(first.vector) in left) == first.vector.backwards else first.tail
    words = [word for word in loop.label.split() if word in pose.points]
    names = [*words, *pose.skeleton.fixed, *pose.points]
    at = next((name for name in names if abs(pose.points[name] - start) <= near), None)
    place: ComplexArray = np.full(len(next(iter(ways.values()))), start) if at is None else ways[at]
    for edge in edges:
        vector, in_left = moving[id(edge.vector)], id(edge.vector) in left
        after = place + (vector.values if in_left else -vector.values)
        ends = (after, place) if in_left == vector.backwards else (place, after)
        yield vector.name, *ends
        place = after


def _point(place: ComplexArray, ways: dict[str, ComplexArray], near: float) -> int:
    """The index of the point at this position in all rows; -1 if there is none."""
    alike = (k for k, way in enumerate(ways.values()) if _together(place, way, near))
    return next(alike, -1)


def _together(one: ComplexArray, other: ComplexArray, near: float) -> bool:
    return bool(np.nanmax(np.abs(one - other)) <= near)


def _course(
    tail: ComplexArray, tip: ComplexArray, motion: Motion, pack: Pack
) -> Iterator[PackedColumn]:
    for values in (tail.real, tail.imag, tip.real, tip.imag):
        yield pack(values, motion.found)


# ----------------------------------------------------------------------
# Build the data of a page from motions; this module solves nothing.


#: Gives the loop equations over a motion.
Loops = Callable[[Motion], Sequence[MovingLoop]]

#: Version of the page data; the front end rejects any other.
FORMAT = 1

MARGIN = 0.05  # margin as a fraction of the drawing
_NOTHING = -400.0  # exponent written for 0, below that of any float
_COARSE = 0.001  # in decades: precision of residuals and radii
_NO_COLUMN = PackedColumn(step=1.0, order=0, content="")

_Kind = TypeVar("_Kind")


def motion_page(
    motions: Mapping[str, Motion],
    *,
    equations: Sequence[tuple[str, str]] = (),
    loops: Loops | None = None,
    forces: Sequence[Force] = (),
    like: Sequence[MovingScene] = (),
) -> PageData:
    """The data of a page that shows motions of one mechanism.

    Parameters
    ----------
    motions : Mapping[str, Motion]
        By the name of the circuit or configuration, in the order of the page. Motions without any
        position are left out.
    equations : sequence of (str, str)
        Labels and MathML of the loop equations.
    loops : callable, optional
        Gives the loop equations over a motion, displayed as vectors:
        ``mechanism.moving_loops``.
    forces : sequence of Force
        Shown as arrows at their points, the same over the whole motion.
    like : sequence of MovingScene
        The same motions drawn with other dimensions, see
        :func:`~linkwork.app.pages.moving_scene.moving_scene`.

    Raises
    ------
    InputError
        If there is nothing to draw, or forces have different units.
    UnknownNameError
        If a force is at a point that does not exist.
    """
    shown = {name: motion for name, motion in motions.items() if motion.found.any()}
    if not shown:
        raise InputError("there is no motion to show: no position was found")
    within = Box.around(corner for m in shown.values() for corner in reach_of(m).corners)
    before = list(like) if len(like) == len(shown) else [None] * len(shown)
    scenes = [
        moving_scene(motion, within=within, like=old)
        for motion, old in zip(shown.values(), before, strict=True)
    ]
    return drawn_page(shown, scenes, equations, loops=loops, forces=forces)


def drawn_page(
    motions: Mapping[str, Motion],
    scenes: Sequence[MovingScene],
    equations: Sequence[tuple[str, str]] = (),
    *,
    loops: Loops | None = None,
    forces: Sequence[Force] = (),
    pack: Pack = packed,
    requested: Sequence[str] = (),
    brief: bool = False,
    rates: bool = True,
) -> PageData:
    """The data of a page from drawn motions.

    ``pack`` writes the columns: :func:`~linkwork.app.pages.packing.unpressed` is fast, for a page
    that is replaced soon, but eight times as large. ``requested`` are further quantities, rates and
    numbers of motions by name; ``brief``: no numbers of motions; without ``rates``: empty columns
    for the rates of points.
    """
    check_forces(forces, next(iter(motions.values())).points)
    first, measures = next(iter(motions.values())), scenes[0].scene.measures
    views = [scene.view.grown(MARGIN * measures.size) for scene in scenes]
    view = Box.around(corner for box in views for corner in box.corners)
    lead = next(iter(first.inputs))
    light, dark = themes()
    return PageData(
        format=FORMAT,
        title=first.mechanism,
        length_unit=first.units.length,
        derivative_unit=first.derivative_unit,
        input_unit=first.input_units[lead],
        view=(view.left, view.bottom, view.right, view.top),
        stroke=measures.stroke,
        pin=measures.pin,
        text=measures.text,
        motions=tuple(
            replace(
                _motion(name, motion, scene, () if loops is None else loops(motion), pack),
                points=tuple(_points(motion, pack, rates)),
                columns=tuple(columns_of(motion, pack, requested)),
                reactions=tuple(reactions_of(motion)),
                numbers=() if brief else tuple(numbers_of(motion, requested)),
                answers=() if brief else tuple(answers_of(motion)),
                view=box.edges,
            )
            for (name, motion), scene, box in zip(motions.items(), scenes, views, strict=True)
        ),
        light=light,
        dark=dark,
        forces=tuple(_forces(first, forces)),
        force_unit=force_unit(forces),
        equations=tuple(Equation(label=label, mathml=mathml) for label, mathml in equations),
        questions=tuple(questions_of(first)),
    )


def _motion(
    name: str, motion: Motion, scene: MovingScene, loops: Sequence[MovingLoop], pack: Pack
) -> MotionData:
    order, closed = play_order(motion)
    everyone = np.ones(len(order), dtype=bool)
    turns, frames, parts = shapes_of(motion, scene, pack)
    return MotionData(
        name=name,
        summary=_summary(motion),
        rows=len(motion),
        order=pack(order.astype(float), everyone, step=1.0),
        closed=closed,
        speed=motion.speed or 0.0,
        backwards=any(part.backwards for part in motion.skeleton.driven[:1]),
        columns=(),
        points=(),
        turns=turns,
        frames=frames,
        parts=parts,
        vectors=tuple(loop_arrows(loops, motion, pack)),
        driven=tuple(part.name for part in motion.skeleton.driven),
        evidence=_evidence(motion, pack),
        limits=tuple(_limits(motion)),
    )


def _summary(motion: Motion) -> str:
    """``361 positions found, each proved``."""
    solved, proved = int(motion.found.sum()), int(motion.certified.sum())
    text = f"{solved} of {len(motion)} positions found"
    if proved == solved:
        return f"{text}, each proved"
    return f"{text}, {proved} proved" if proved else text


def _points(motion: Motion, pack: Pack, rates: bool) -> Iterator[PointData]:
    still, solved = set(motion.skeleton.fixed), motion.found

    def rate(values: Array) -> PackedColumn:
        return pack(values, solved, rate=True) if rates else _NO_COLUMN

    for name, (x, y) in motion.points.items():
        yield PointData(
            name=name,
            shown=printed_name(name),
            drawn=name not in still,
            x=pack(x.value, solved),
            y=pack(y.value, solved),
            dx=rate(x.first),
            dy=rate(y.first),
            ddx=rate(x.second),
            ddy=rate(y.second),
        )


def _forces(motion: Motion, forces: Sequence[Force]) -> Iterator[ForceData]:
    numbers = {name: k for k, name in enumerate(motion.points)}
    for force in forces:
        yield ForceData(point=numbers[force.at], x=force.x, y=force.y)


def _evidence(motion: Motion, pack: Pack) -> RowEvidence:
    solved, every = motion.found, np.ones(len(motion), dtype=bool)
    status, statuses = _numbered(motion.status)
    proof, proofs = _numbered(motion.certification)
    branch, branch_names = _numbered(motion.branch)
    return RowEvidence(
        found=pack(solved.astype(float), every, step=1.0),
        status=pack(status, every, step=1.0),
        status_texts=tuple(one.value for one in statuses),
        certification=pack(proof, every, step=1.0),
        certification_texts=tuple(one.value for one in proofs),
        certified=pack(motion.certified.astype(float), every, step=1.0),
        residual_log10=_log10(motion.residual, motion, pack),
        radius_log10=_log10(motion.radius, motion, pack),
        iterations=pack(motion.iterations.astype(float), solved, step=1.0),
        branch=pack(branch, every, step=1.0),
        branch_names=branch_names,
    )


def _log10(values: Array, motion: Motion, pack: Pack) -> PackedColumn:
    """Exponents of numbers that are not negative."""
    known = np.log10(np.where(values > 0, values, np.nan))
    return pack(np.where(values == 0, _NOTHING, known), motion.found, step=_COARSE)


def _numbered(texts: Iterable[_Kind]) -> tuple[Array, tuple[_Kind, ...]]:
    listed = list(texts)
    if listed and listed.count(listed[0]) == len(listed):  # most tables have one status
        return np.zeros(len(listed)), (listed[0],)
    numbers = {text: k for k, text in enumerate(dict.fromkeys(listed))}
    return np.array([*map(numbers.__getitem__, listed)], dtype=float), tuple(numbers)


def _limits(motion: Motion) -> Iterator[LimitMark]:
    for row, text in enumerate(motion.limit):
        if text and motion.found[row]:
            yield LimitMark(row=row, text=text)


def themes() -> tuple[ThemeData, ThemeData]:
    """The colours of pages, light and dark."""
    return _theme(LIGHT), _theme(DARK)


@lru_cache
def _theme(theme: Theme) -> ThemeData:
    return ThemeData(
        background=theme.background,
        ink=theme.ink,
        faint=theme.faint,
        driven=theme.driven,
        tones=theme.tones,
        styles=tuple(
            RoleStyle(
                role=role.name.lower(),
                layer=role.layer,
                line=style.line,
                width=style.width,
                fill=style.fill,
                opacity=style.opacity,
                dashes=style.dashes,
            )
            for role, style in ((role, theme.styles[role]) for role in Role)
        ),
    )
