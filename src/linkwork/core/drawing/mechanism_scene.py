"""The extent of a picture: all drawn parts of a mechanism, now and over a motion."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from linkwork.core.drawing.annotations import SceneOptions
from linkwork.core.drawing.dimensions import Edge, Subject, annotation_of, vector_edges
from linkwork.core.drawing.guides import Track, guide_symbols, input_arrows, track_gaps, tracks
from linkwork.core.drawing.labels import Kept, link_names, placed, point_names
from linkwork.core.drawing.links import (
    coupling_symbols,
    couplings,
    ground_symbols,
    link_symbols,
    pin_symbols,
    stems,
    tones,
)
from linkwork.core.drawing.paths import (
    Further,
    faint_symbols,
    further_positions,
    limit_marks,
    trace_symbols,
)
from linkwork.core.drawing.pose import Pose, inputs_caption, reached_caption
from linkwork.core.drawing.scene import Box, Measures, Primitive, Role, Scene, xy
from linkwork.core.drawing.wheels import part_symbols, rounds, wheel_symbols
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, as_names
from linkwork.core.foundation.values import given_or
from linkwork.core.mechanism.bodies import Contour, DiscFigure
from linkwork.core.mechanism.part.guides import GenevaWheel
from linkwork.core.mechanism.part.rolling import RollingLine
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position

if TYPE_CHECKING:
    from linkwork.circuits.results import Configurations

_OF_OUTLINE = 90  # points of an outline that are tracked over a motion


def drawn_box(pose: Pose, traces: tuple[str, ...], others: Sequence[Pose]) -> Box:
    """The box of all drawn parts: points and round parts in all poses, traces, fixed guides."""
    poses = [pose, *others]
    drawn = [name for name in pose.points if name not in pose.construction]
    places = (one.points[name] for one in poses for name in drawn)
    along = {guide.point for guide in pose.skeleton.guides if pose.on_ground(guide)}
    along |= {point for rail in pose.skeleton.rails for point in rail.points}
    along |= {track.center for track in pose.skeleton.of(RollingLine)}
    paths = [pose.paths[name] for name in (*traces, *along) if name in pose.paths]
    travelled = chain.from_iterable(path[np.isfinite(path)] for path in paths)
    rounds = chain.from_iterable(map(_round_parts, poses))
    box = Box.around((float(z.real), float(z.imag)) for z in chain(places, travelled, rounds))
    # Blocks on stems are further out, by some symbol sizes.
    ends = (
        one.points[name] + stem
        for one in poses
        for name, stem in stems(one, Measures.of(box, pose.gaps)).items()
    )
    return Box.around([*box.corners, *((float(z.real), float(z.imag)) for z in ends)])


def _round_parts(pose: Pose) -> Iterator[complex]:
    """Outermost points of wheels, cams and curves, and of rolling lines without a motion."""
    if not pose.paths:
        for track in pose.skeleton.of(RollingLine):
            yield from (pose.points[name] for name in track.line)
    for center, radius in _discs(pose):
        yield from (pose.points[center] + radius * 1j**k for k in range(4))
    for contour in pose.skeleton.of(Contour):
        yield from map(complex, pose.placed(contour))


def _discs(pose: Pose) -> Iterator[tuple[str, float]]:
    """Centres and radii of wheels, Geneva wheels, locking discs and coupling discs."""
    yield from ((disc.center, disc.radius) for disc in pose.skeleton.of(DiscFigure))
    for wheel in pose.skeleton.of(GenevaWheel):
        yield from rounds(wheel, pose)
    for coupling in couplings(pose.skeleton):
        yield from ((coupling.discs[k][1], coupling.radius(pose, k)) for k in range(2))


def reach_of(motion: Motion) -> Box:
    """The box of every point, wheel and cam of a mechanism over a whole motion.

    Raises
    ------
    InputError
        If the motion has no points, or no position was found.
    """
    rows = motion.found
    if not rows.any() or not motion.points:
        raise InputError(
            f'the motion of "{motion.mechanism}" has nothing to draw: '
            f"{int(rows.sum())} positions, {len(motion.points)} points"
        )
    skeleton = motion.skeleton
    places = [motion.trace(name)[rows] for name in motion.points]
    for name, radius in _discs(Pose.at_row(motion, int(np.flatnonzero(rows)[0]))):
        centre = motion.trace(name)[rows]
        places += [centre + radius * 1j**k for k in range(4)]
    for contour in skeleton.of(Contour):
        points = np.array(contour.points)
        points = points[:: max(1, len(points) // _OF_OUTLINE)]
        turned: ComplexArray = np.ones(int(rows.sum()), dtype=complex)
        if contour.link != GROUND:
            degrees = motion.links[contour.link].value[rows]
            turned = np.exp(1j * degrees * motion.units.angle.radians)
        centre = motion.trace(contour.center)[rows]
        places.append((centre[:, None] + turned[:, None] * points).ravel())
    everything = np.concatenate(places)
    x, y = everything.real, everything.imag
    return Box(float(x.min()), float(y.min()), float(x.max()), float(y.max()))


# ----------------------------------------------------------------------
# Scenes of positions, composed from symbols without solving.


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
    Writers choose colours and fonts, see :mod:`linkwork.core.drawing.scene`.
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


# ----------------------------------------------------------------------
# Several pictures side by side with equal scale.


_WIDTH, _SMALLEST_CELL = 7.5, 2.2  # inches
_USUAL = 5.2  # inches: smaller pictures have enlarged names and symbols
_LARGEST = 2.0
_WHOLE = 6.0  # inches: larger pictures, of a single configuration, have smaller names

#: The maximum height-to-width ratio of a picture.
TALLEST = 1.6


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Scenes in rows that show the same part of the plane."""

    title: str
    caption: str
    scenes: tuple[Scene, ...]

    @property
    def columns(self) -> int:
        """The number of scenes in a row."""
        return max(1, min(4, math.ceil(math.sqrt(len(self.scenes)))))

    @property
    def cell(self) -> float:
        """The width of a scene including its margin [inches]."""
        return max(_SMALLEST_CELL, _WIDTH / self.columns)

    @property
    def view(self) -> Box:
        """The part of the plane shown by every scene."""
        return reduce(Box.with_box, (scene.box for scene in self.scenes))


def configuration_sheet(found: Configurations) -> Sheet:
    """Every configuration as a picture, its name above it.

    Raises
    ------
    InputError
        If there is no configuration, or the mechanism has no points to draw.
    """
    if not len(found):
        raise InputError(f'"{found.mechanism}" has no configuration to draw: {found.message}')
    count = len(found)
    where = inputs_caption(found.input, found.input_units, found.positions[0].units)
    what = f"{count} configuration{'' if count == 1 else 's'}"
    caption = f"{what} at {where}" if where else what
    sheet = Sheet(title=found.mechanism, caption=caption, scenes=tuple(map(scene_of, found)))
    # the same frame for all, so that sizes are comparable
    within = reduce(Box.with_box, (scene.within for scene in sheet.scenes))
    printed = _printed(within, sheet.cell)
    larger = min(max(_USUAL / printed, min(_WHOLE / printed, 1.0)), _LARGEST)
    scenes = []
    for position in found:
        options = SceneOptions(title=position.configuration, within=within, larger=larger)
        scenes.append(replace(scene_of(position, options=options), caption=""))
    return replace(sheet, scenes=tuple(scenes))


def _printed(box: Box, cell: float) -> float:
    """The longer side of a box that fills a cell [inches]."""
    width, height = max(box.width, 1e-9), max(box.height, 1e-9)
    return max(width, height) * min(cell / width, TALLEST * cell / height)
