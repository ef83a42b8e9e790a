"""Scenes of positions, composed from symbols without solving."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from linkwork.drawing.annotations import Subject, annotation_of
from linkwork.drawing.box import Box
from linkwork.drawing.captions import inputs_caption, reached_caption
from linkwork.drawing.coupling_symbols import coupling_symbols, couplings
from linkwork.drawing.drawn_box import drawn_box
from linkwork.drawing.further_positions import (
    Further,
    faint_symbols,
    further_positions,
    limit_marks,
)
from linkwork.drawing.ground_symbols import ground_symbols
from linkwork.drawing.guide_symbols import Track, guide_symbols, track_gaps, tracks
from linkwork.drawing.input_arrow import input_arrows
from linkwork.drawing.label_placement import Kept, link_names, placed, point_names
from linkwork.drawing.link_symbols import link_symbols, pin_symbols, tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.part.index import part_symbols
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Primitive, Role, Scene, xy
from linkwork.drawing.scene_options import SceneOptions
from linkwork.drawing.trace_path import trace_symbols
from linkwork.drawing.vector_polygon import Edge
from linkwork.drawing.vector_symbols import vector_edges
from linkwork.drawing.wheel_symbols import wheel_symbols
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import as_names
from linkwork.foundation.value_types import given_or
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["SceneOptions", "scene_of", "scene_of_pose", "symbols", "traced"]

_BEHIND = 0.62  # fading of the mechanism behind its vectors
_FIRM = (Role.GROUND, Role.HATCH, Role.TRACE, Role.PIN, Role.POINT, Role.TRACED)


def scene_of(
    position: Position,
    motion: Motion | None = None,
    *,
    labels: bool = True,
    traces: Sequence[str] | None = None,
    options: SceneOptions | None = None,
) -> Scene:
    """The picture of a position, in the mechanism's length unit.

    Parameters
    ----------
    position : Position
        A position that was found.
    motion : Motion, optional
        Its motion, for paths of points and the lengths of rails, slots and cylinders.
    labels : bool
        Write the names of points.
    traces : sequence of str, optional
        The points whose paths are shown; by default those of ``[trace]``.
    options : SceneOptions, optional
        Further choices.

    Raises
    ------
    InputError
        If the position was not found, the mechanism has no points, the motion is of another
        mechanism, or traces are requested without a motion.
    UnknownNameError
        If a traced point does not exist.

    Notes
    -----
    Writers choose colours and fonts, see :mod:`linkwork.drawing.theme`.
    """
    chosen = given_or(SceneOptions(), "options", options)
    pose = Pose.of(position, motion, bare=bool(chosen.vectors))
    names = traced(pose, traces)
    _check_motion(chosen, names, motion)
    further: list[Further] = []
    if motion is not None and chosen.further and pose.points:
        further = further_positions(pose, motion, chosen.further)
    polygons = tuple(map(tuple, vector_edges(chosen.vectors, pose)))
    wanted_places = [mark.place for mark in chosen.positions]
    within = chosen.within or _within(pose, names, further, polygons, wanted_places)
    measures = Measures.of(within, pose.gaps, chosen.larger)
    found = tracks(pose, measures, tones(pose))
    sense = -1.0 if motion is not None and (motion.speed or 0.0) < 0 else 1.0
    marks, limit_names = limit_marks(further, motion, measures)
    own = list(symbols(pose, found, () if chosen.speed else names, measures))
    primitives: list[Primitive] = [
        *faint_symbols(further, measures),
        *(map(_faded, own) if chosen.vectors else own),
        *marks,
    ]
    told = annotation_of(
        Subject(position, motion, pose, names, polygons, within, measures), chosen, primitives
    )
    primitives += told.drawn
    if chosen.arrows:
        primitives += input_arrows(pose, found, measures, sense, primitives)
    wanted = [
        *(point_names(pose, measures) if labels else []),
        *(link_names(pose, measures) if chosen.link_names else []),
        *limit_names,
        *told.names,
    ]
    primitives += placed(wanted, primitives)
    caption = _caption(position, motion if further else None)
    return Scene(
        primitives=tuple(primitives),
        measures=measures,
        within=within,
        unit=position.units.length,
        title=position.mechanism if chosen.title is None else chosen.title,
        caption="; ".join(filter(None, (caption, told.caption))),
    )


def scene_of_pose(
    pose: Pose, *, size: float, unit: str = "", title: str = "", kept: Kept | None = None
) -> Scene:
    """The symbols, input arrows and names of a pose, which need not be a solved position.

    ``size``: the least length by which symbols are sized, such as half the width of a sheet.
    ``kept``: places of names and arrows in a similar picture, which stay; others are added to it.
    """
    drawn = drawn_box(pose, (), []) if pose.points else Box(0.0, 0.0, size, size)
    left, bottom = drawn.left, drawn.bottom
    within = drawn.with_box(Box(left, bottom, left + size, bottom))
    measures = Measures.of(within, pose.gaps)
    found = tracks(pose, measures, tones(pose))
    primitives = list(symbols(pose, found, (), measures))
    primitives += input_arrows(pose, found, measures, 1.0, primitives, kept)
    primitives += placed(point_names(pose, measures), primitives, kept)
    return Scene(
        primitives=tuple(primitives), measures=measures, within=drawn, unit=unit, title=title
    )


def _within(
    pose: Pose,
    names: tuple[str, ...],
    further: Sequence[Further],
    polygons: Iterable[Iterable[Edge]],
    places: Iterable[complex],
) -> Box:
    """The box of the picture: the mechanism in all its positions, vectors, positions of a task."""
    others = [xy(end) for edges in polygons for edge in edges for end in (edge.tail, edge.tip)]
    others += map(xy, places)
    if not pose.points:
        return Box.around(others)
    box = drawn_box(pose, names, [other.pose for other in further])
    return Box.around([*box.corners, *others])


def _faded(primitive: Primitive) -> Primitive:
    """The moving parts, faded as a background for vectors."""
    return primitive if primitive.role in _FIRM else replace(primitive, fade=_BEHIND)


def _check_motion(chosen: SceneOptions, names: tuple[str, ...], motion: Motion | None) -> None:
    """Reject options that need a motion."""
    if motion is None and chosen.centrodes:
        raise InputError("centrodes cannot be drawn from one position: give the motion too")
    if motion is None and chosen.speed:
        raise InputError("speeds along a path cannot be drawn from one position: give the motion")
    if chosen.speed and not names:
        raise InputError("there is no path to colour by speed: name the points to trace")


def symbols(
    pose: Pose, found: list[Track], names: tuple[str, ...], measures: Measures
) -> Iterator[Primitive]:
    """All symbols of one position, from ground to pins, with the paths of points."""
    figures = pose.skeleton.figures
    yield from ground_symbols(pose, measures)
    yield from wheel_symbols(pose, measures)
    yield from coupling_symbols(couplings(pose.skeleton), pose, measures, tones(pose))
    yield from part_symbols((f for f in figures if not f.over), pose, measures)
    yield from guide_symbols(found, measures)
    yield from link_symbols(pose, track_gaps(found, measures))
    yield from part_symbols(pose.skeleton.struts, pose, measures)
    yield from trace_symbols(pose, names, measures)
    yield from part_symbols((f for f in figures if f.over), pose, measures)
    yield from pin_symbols(pose, measures)


def traced(pose: Pose, wanted: Sequence[str] | None) -> tuple[str, ...]:
    """The points whose paths are shown: those given, otherwise those of ``[trace]``.

    Raises
    ------
    InputError
        If a path is requested without a motion.
    UnknownNameError
        If a point does not exist.
    """
    if wanted is None:
        return pose.skeleton.traced if pose.paths else ()
    wanted = as_names("traces", wanted)
    for name in wanted:
        if name not in pose.points:
            raise UnknownNameError(
                f'there is no point "{name}" to trace {choices("points", pose.points, name)}'
            )
    if wanted and not pose.paths:
        raise InputError(
            f"the paths of {', '.join(wanted)} cannot be drawn from one position: "
            "give the motion too"
        )
    return tuple(dict.fromkeys(wanted))


def _caption(position: Position, motion: Motion | None) -> str:
    """The input values with units, and the range of faintly drawn positions: ``crank = 60°``."""
    here = inputs_caption(position.input, position.input_units, position.units)
    return here if motion is None else f"{here}; faint: {reached_caption(motion)}"
