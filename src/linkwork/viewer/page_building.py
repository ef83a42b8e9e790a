"""Build the data of a page from motions; this module solves nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TypeVar

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.captions import printed_name
from linkwork.drawing.drawn_box import reach_of
from linkwork.drawing.moving_scene import MovingScene, moving_scene
from linkwork.drawing.scene import Role
from linkwork.drawing.theme import DARK, LIGHT, Theme
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.results.force import Force, check_forces, force_unit
from linkwork.results.motion import Motion
from linkwork.results.vector_loop import MovingLoop
from linkwork.viewer.loop_arrows import loop_arrows
from linkwork.viewer.packing import Pack, packed
from linkwork.viewer.page_columns import columns_of, numbers_of, reactions_of
from linkwork.viewer.page_data import (
    Equation,
    ForceData,
    LimitMark,
    MotionData,
    PackedColumn,
    PageData,
    PointData,
    RoleStyle,
    RowEvidence,
    ThemeData,
)
from linkwork.viewer.page_questions import answers_of, questions_of
from linkwork.viewer.page_shapes import shapes_of
from linkwork.viewer.play_order import play_order

__all__ = ["FORMAT", "MARGIN", "Loops", "drawn_page", "motion_page", "themes"]

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
        :func:`~linkwork.drawing.moving_scene.moving_scene`.

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
    asked: Sequence[str] = (),
    brief: bool = False,
    rates: bool = True,
) -> PageData:
    """The data of a page from drawn motions.

    ``pack`` writes the columns: :func:`~linkwork.viewer.packing.unpressed` is fast, for a page that
    is replaced soon, but eight times as large. ``asked`` are further quantities, rates and numbers
    of motions by name; ``brief``: no numbers of motions; without ``rates``: empty columns
    for the rates of points.
    """
    check_forces(forces, next(iter(motions.values())).points)
    first, measures = next(iter(motions.values())), scenes[0].scene.measures
    views = [scene.view.grown(MARGIN * measures.size) for scene in scenes]
    view = Box.around(corner for own in views for corner in own.corners)
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
                columns=tuple(columns_of(motion, pack, asked)),
                reactions=tuple(reactions_of(motion)),
                numbers=() if brief else tuple(numbers_of(motion, asked)),
                answers=() if brief else tuple(answers_of(motion)),
                view=own.edges,
            )
            for (name, motion), scene, own in zip(motions.items(), scenes, views, strict=True)
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
    found, proved = int(motion.found.sum()), int(motion.certified.sum())
    text = f"{found} of {len(motion)} positions found"
    if proved == found:
        return f"{text}, each proved"
    return f"{text}, {proved} proved" if proved else text


def _points(motion: Motion, pack: Pack, rates: bool) -> Iterator[PointData]:
    still, found = set(motion.skeleton.fixed), motion.found

    def rate(values: Array) -> PackedColumn:
        return pack(values, found, rate=True) if rates else _NO_COLUMN

    for name, (x, y) in motion.points.items():
        yield PointData(
            name=name,
            shown=printed_name(name),
            drawn=name not in still,
            x=pack(x.value, found),
            y=pack(y.value, found),
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
    found, every = motion.found, np.ones(len(motion), dtype=bool)
    status, statuses = _numbered(motion.status)
    proof, proofs = _numbered(motion.certification)
    branch, branch_names = _numbered(motion.branch)
    return RowEvidence(
        found=pack(found.astype(float), every, step=1.0),
        status=pack(status, every, step=1.0),
        status_texts=tuple(one.value for one in statuses),
        certification=pack(proof, every, step=1.0),
        certification_texts=tuple(one.value for one in proofs),
        certified=pack(motion.certified.astype(float), every, step=1.0),
        residual_log10=_log10(motion.residual, motion, pack),
        radius_log10=_log10(motion.radius, motion, pack),
        iterations=pack(motion.iterations.astype(float), found, step=1.0),
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
