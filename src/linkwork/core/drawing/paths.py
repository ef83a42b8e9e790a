"""Adds points to a path between its rows, so that a quick turn is drawn as a curve."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from linkwork.core.drawing.annotations import Annotation, rate_of, usual_most
from linkwork.core.drawing.guides import guide_symbols, track_gaps, tracks
from linkwork.core.drawing.labels import Choice, places_beside
from linkwork.core.drawing.links import link_symbols, pin_symbols, tones
from linkwork.core.drawing.pose import Path, Pose, lead_text, printed_name
from linkwork.core.drawing.scene import (
    COINCIDENT,
    Box,
    Hatch,
    Measures,
    Polygon,
    Primitive,
    Role,
    drawn_area,
    drawn_disc,
    drawn_line,
    drawn_text,
    xy,
)
from linkwork.core.drawing.wheels import part_symbols, wheel_symbols
from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.link_motion import Centrodes, InstantCentre
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind

UNSEEN = 1.25e-4  # of the size of a drawing: 0.1 pixels of 800

_CORNER = np.radians(60.0)  # a path that turns by more between two rows has a corner
_MOST = 40  # pieces between two rows
_MORE = 0.5 * (np.sqrt(5.0) - 1.0)
_LESS = 0.5 * (3.0 - np.sqrt(5.0))


def smoothed(
    path: ComplexArray,
    width: float,
    first: ComplexArray | None = None,
    second: ComplexArray | None = None,
) -> ComplexArray:
    """A path with points between its rows, where a straight line would differ visibly.

    Every two neighbouring rows are joined by a cubic curve with the tangents at both; where the
    path turns by more than 60° it has a corner, and the line stays straight. At a dead
    point, where the derivatives are infinite, the tangent follows from the chord and from tangent
    and curvature at the neighbouring row.

    Parameters
    ----------
    path : array (N,)
        Points x + iy; NaN interrupts it.
    width : float
        The largest deviation from the curve that cannot be seen.
    first, second : array (N,), optional
        The derivatives of the path by any parameter. Without them, the tangents are those of
        circles through three points.

    References
    ----------
    J. D. Hobby: Smooth, Easy to Compute Interpolating Splines. Discrete & Computational Geometry 1
    (1986), 123-140, doi:10.1007/BF02187690; the lengths of the handles.
    """
    if len(path) < 2:
        return path
    chord = np.diff(path)
    with np.errstate(all="ignore"):
        along = chord / np.abs(chord)
        tangent, bend = _tangents(path, first, second)
        # the angles from the tangents to the chord, and from the chord to the tangents
        before, after = _turn(tangent[:-1], along), -_turn(tangent[1:], along)
        half = 0.5 * np.abs(chord)
        ahead, behind = 3.0 * after - half * bend[1:], 3.0 * before - half * bend[:-1]
        unknown, unknown_after = np.isnan(before), np.isnan(after)
        before = np.where(unknown, _likely(ahead, after), before)
        after = np.where(unknown_after, _likely(behind, before), after)
        visible = np.abs(chord) * np.maximum(np.abs(before), np.abs(after)) / (4.0 * width)
        curved = (np.abs(before) < _CORNER) & (np.abs(after) < _CORNER) & (visible > 1.0)
    pieces = np.ones(len(chord), dtype=int)
    pieces[curved] = np.minimum(np.ceil(np.sqrt(visible[curved])), _MOST).astype(int)
    if not curved.any():
        return path
    row = np.repeat(np.arange(len(chord)), pieces)
    share = 1.0 - (np.cumsum(pieces)[row] - np.arange(len(row)) - 1) / pieces[row]
    inner = _cubic(path[row], chord[row], before[row], after[row], share)
    found: ComplexArray = np.concatenate((path[:1], np.where(share < 1.0, inner, path[row + 1])))
    return found


def _turn(tangent: ComplexArray, along: ComplexArray) -> Array:
    """The angle from a tangent, in the sense of the path, to the chord; NaN at a corner."""
    ahead = np.where((tangent * along.conj()).real < 0.0, -tangent, tangent)
    angle: Array = np.angle(along * ahead.conj())
    return np.where(np.isfinite(ahead) & np.isfinite(along), angle, np.nan)


def _likely(angle: Array, other: Array) -> Array:
    """The angle at an end without tangent, by the curvature at the other end, else of a circle."""
    likely: Array = np.where(np.abs(angle - 2.0 * other) < np.abs(other), angle - other, other)
    return likely


def _tangents(
    path: ComplexArray, first: ComplexArray | None, second: ComplexArray | None
) -> tuple[ComplexArray, Array]:
    """Tangents and curvatures at the rows, in the sense of the path; NaN where unknown."""
    middle = np.full(len(path), complex(np.nan, np.nan))
    bend = np.full(len(path), np.nan)
    chord = np.diff(path)
    inverse = 1.0 / chord.conj()
    turn = np.abs(np.angle(chord[1:] / chord[:-1]))
    middle[1:-1] = np.where(turn < _CORNER, inverse[:-1] + inverse[1:], np.nan)
    if first is None:
        return middle, bend
    if second is not None:
        bend = (first.conj() * second).imag / np.abs(first) ** 3
        step = np.diff(path, append=path[-1:])
        step = np.where(np.isfinite(step) & (step != 0.0), step, np.roll(step, 1))
        bend = np.where((step * first.conj()).real < 0.0, -bend, bend)
    return np.where(np.isfinite(first) & (first != 0.0), first, complex(np.nan, np.nan)), bend


def _cubic(
    start: ComplexArray, chord: ComplexArray, before: Array, after: Array, share: Array
) -> ComplexArray:
    """A point of the curve at a share of its parameter."""
    out = start + _handle(before, after) * chord * np.exp(-1j * before)
    back = start + chord - _handle(after, before) * chord * np.exp(1j * after)
    rest = 1.0 - share
    point: ComplexArray = (
        rest**3 * start
        + 3.0 * rest**2 * share * out
        + 3.0 * rest * share**2 * back
        + share**3 * (start + chord)
    )
    return point


def _handle(near: Array, far: Array) -> Array:
    """The length of a handle by its own angle to the chord and that at the other end."""
    odd = (np.sin(near) - np.sin(far) / 16.0) * (np.sin(far) - np.sin(near) / 16.0)
    rise = 2.0 + np.sqrt(2.0) * odd * (np.cos(near) - np.cos(far))
    handle: Array = rise / (3.0 * (1.0 + _MORE * np.cos(near) + _LESS * np.cos(far)))
    return handle


# ----------------------------------------------------------------------
# The paths of points: dotted lines, broken at missing positions.


def trace_symbols(pose: Pose, names: tuple[str, ...], measures: Measures) -> Iterator[Primitive]:
    """The path of every named point; an isolated position is a dot."""
    width = measures.stroke / 2
    for name in names:
        path = smoothed(pose.paths[name], UNSEEN * measures.size, *pose.rates[name])
        for run in drawn_once(thinned(path, width), width):
            if len(run) > 1:
                yield drawn_line(Role.TRACE, name, run)
            else:
                yield drawn_disc(Role.TRACE, name, run[0], 0.4 * measures.dot)


def thinned(path: Path, width: float) -> Path:
    """A path (m,) without points less than ``width`` after the preceding one, along the path.

    Ends are kept, also those next to NaN; a path of larger steps is unchanged.
    """
    finite = np.isfinite(path)
    along = np.concatenate(([0.0], np.cumsum(np.nan_to_num(np.abs(np.diff(path))))))
    stretch = np.floor(along / width)
    padded = np.concatenate(([False], finite, [False]))
    inner = padded[:-2] & finite & padded[2:]
    return path[~inner | (np.diff(stretch, prepend=-1.0) > 0)]


def drawn_once(path: Path, width: float) -> list[Path]:
    """The runs of a path (m,) without NaN and without pieces that overlap earlier ones.

    The point of a rocker moves back and forth on one arc: dots drawn twice would merge to a line.
    Pieces overlap if they are within ``width``. A run of one point is an isolated position.
    """
    finite = np.isfinite(path)
    length = np.abs(np.diff(path))
    # At a gap, the path length increases enough to exclude all earlier pieces.
    reached = np.concatenate(([0.0], np.cumsum(np.where(np.isfinite(length), length, 9 * width))))
    covered = np.zeros(len(path), dtype=bool)
    point, piece = _near_each_other(path, width)
    # Neighbours along the path are always near: only pieces some distance back count.
    behind = reached[point] - reached[piece + 1] > 4 * width
    point, piece = point[behind], piece[behind]
    step, offset = path[piece + 1] - path[piece], path[point] - path[piece]
    squared = np.where(step == 0, 1.0, step.real**2 + step.imag**2)
    share = np.clip((offset.real * step.real + offset.imag * step.imag) / squared, 0.0, 1.0)
    covered[point[np.abs(offset - share * step) <= width]] = True
    kept = np.isfinite(length) & ~(covered[:-1] & covered[1:])
    edges = np.flatnonzero(np.diff(np.concatenate(([0], kept.astype(int), [0]))))
    runs = [(a, b + 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    padded = np.concatenate(([False], finite, [False]))
    lone = np.flatnonzero(finite & ~padded[:-2] & ~padded[2:] & ~covered)
    return [path[a:b] for a, b in sorted([*runs, *((k, k + 1) for k in lone)])]


def _near_each_other(path: Path, width: float) -> tuple[IndexArray, IndexArray]:
    """Candidate pairs of points and pieces, including all within ``width`` of each other.

    The plane is divided into squares as wide as the longest piece: near objects have their middles
    in the same or an adjacent square.
    """
    points, pieces = np.flatnonzero(np.isfinite(path)), np.flatnonzero(np.isfinite(np.diff(path)))
    if not len(pieces):
        return pieces, pieces
    middles, places = 0.5 * (path[pieces] + path[pieces + 1]), path[points]
    side = width + 0.5 * float(np.abs(path[pieces + 1] - path[pieces]).max())
    corner = complex(places.real.min(), places.imag.min())
    column, row = _squares((middles - corner) / side)
    high = int(row.max()) + 4
    number = column * high + row
    order = np.argsort(number, kind="stable")
    column, row = _squares((places - corner) / side)
    found_points, found_pieces = [], []
    for beside in (-1, 0, 1):
        middle = (column + beside) * high + row
        first = np.searchsorted(number[order], middle - 1)
        count = np.searchsorted(number[order], middle + 1, side="right") - first
        found_points.append(np.repeat(points, count))
        within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        found_pieces.append(pieces[order[np.repeat(first, count) + within]])
    return np.concatenate(found_points), np.concatenate(found_pieces)


def _squares(places: ComplexArray) -> tuple[IndexArray, IndexArray]:
    """Integer coordinates from 1, so that every square has neighbours."""
    return np.floor(places.real).astype(np.intp) + 1, np.floor(places.imag).astype(np.intp) + 1


# ----------------------------------------------------------------------
# The paths of points coloured by speed, with a colour scale.


_CLASSES = 32  # number of colours: neighbours are indistinguishable
_LONG = 0.34  # size of the scale as a fraction of the drawn size


def speed_traces(
    pose: Pose, motion: Motion, names: Sequence[str], measures: Measures
) -> tuple[list[Primitive], float, bool]:
    """The paths in pieces of one colour each, the speed of the last colour, and whether some parts
    are faster.
    """
    rate = rate_of(1, motion.speed is not None).value
    speeds = {name: np.abs(motion.trace(f"{name}.{rate}")) for name in names}
    every = np.concatenate([speed[motion.found] for speed in speeds.values()])
    most = usual_most(every) or 1.0
    drawn = [
        piece
        for name in names
        for piece in _pieces(name, pose, speeds[name] / most, UNSEEN * measures.size)
    ]
    return drawn, most, bool(np.nanmax(every, initial=0.0) > most)


def _pieces(name: str, pose: Pose, share: Array, unseen: float) -> list[Primitive]:
    """Runs of one colour, given by the mean speed of two rows."""
    path, (first, second) = pose.paths[name], pose.rates[name]
    mean = np.where(np.isfinite(share), share, 1.0)
    mean = np.clip((mean[:-1] + mean[1:]) / 2, 0.0, 1.0)
    levels = np.minimum((mean * _CLASSES).astype(int), _CLASSES - 1)
    there = np.isfinite(path[:-1]) & np.isfinite(path[1:])
    key = np.where(there, levels, -1)
    edges = [0, *(np.flatnonzero(np.diff(key)) + 1).tolist(), len(key)]
    runs = [(slice(a, b + 1), key[a]) for a, b in pairwise(edges) if b > a and key[a] >= 0]
    drawn: list[Primitive] = []
    for run, level in runs:
        line = drawn_line(
            Role.SPEED_TRACE, name, smoothed(path[run], unseen, first[run], second[run])
        )
        drawn.append(replace(line, level=(int(level) + 0.5) / _CLASSES))
    return drawn


def colour_scale(
    motion: Motion, names: Sequence[str], most: float, more: bool, below: Box, measures: Measures
) -> Annotation:
    """A bar of all colours under the drawing, from 0 to the speed of the last colour."""
    height, length = 0.6 * measures.text, _LONG * measures.size
    left = below.left
    top = below.bottom - 1.2 * measures.text
    bottom = top - height
    step = length / _CLASSES
    bar: list[Primitive] = []
    for k in range(_CLASSES):
        here, there = left + k * step, left + (k + 1) * step
        corners = ((here, bottom), (there, bottom), (there, top), (here, top))
        level = (k + 0.5) / _CLASSES
        bar.append(Polygon(role=Role.SCALE, of="speed", level=level, points=corners))
    rate = rate_of(1, motion.speed is not None)
    unit = rate.unit(Kind.LENGTH, motion.units, motion.derivative_unit)
    mark = "\u2265 " if more else ""
    said = f"{mark}{float(f'{most:.3g}'):g} {unit}  speed of "
    said += ", ".join(map(printed_name, names))
    size = 0.8 * measures.text
    base = bottom + 0.5 * height - 0.3 * size
    write = partial(drawn_text, Role.SCALE_NAME, "speed", offset=(0.0, 0.0), height=size)
    bar.append(write("0", complex(left - 0.4 * size, base), align=1))
    bar.append(write(said, complex(left + length + 0.4 * size, base), align=-1))
    return Annotation(drawn=bar)


# ----------------------------------------------------------------------
# A motion in one picture: some faint further positions, and marks at its limits.


_FADE = 0.84  # fading of further positions
_FADE_OF_LIMITS = 0.4
_LIMITS = {kind.word: kind for kind in (LimitKind.DEAD_POINT, LimitKind.CHANGE_POINT)}


@dataclass(frozen=True, kw_only=True)
class Further:
    """A further position of the motion: its row, its points, and its limit, if any."""

    row: int
    pose: Pose
    limit: LimitKind | None


def further_positions(pose: Pose, motion: Motion, count: int) -> list[Further]:
    """All limits of the motion, and up to ``count`` of its other positions.

    Each position is the one furthest from ``pose`` and those chosen before, measured by the point
    with the largest displacement, so that they are spread over the motion (Gonzalez 1985).

    References
    ----------
    T. F. Gonzalez, Clustering to minimize the maximum intercluster distance, Theoretical Computer
    Science 38 (1985) 293-306, doi:10.1016/0304-3975(85)90224-5.
    """
    found = np.flatnonzero(motion.found)
    if not len(found):
        return []
    places = np.stack([pose.paths[name][found] for name in pose.paths], axis=1)
    near = COINCIDENT * max(float(np.abs(places - places[0]).max()), 1e-300)
    limit = [_LIMITS.get(motion.limit[row]) for row in found]
    away = np.full(len(found), np.inf)
    shown: list[int] = []
    for k in [k for k, kind in enumerate(limit) if kind is not None]:
        if away[k] > near:
            shown.append(k)
            away = np.minimum(away, np.abs(places - places[k]).max(axis=1))
    own = np.array([pose.points[name] for name in pose.paths])
    away = np.minimum(away, np.abs(places - own).max(axis=1))
    for _ in range(count):
        k = int(np.argmax(away))
        if away[k] <= near:
            break
        shown.append(k)
        away = np.minimum(away, np.abs(places - places[k]).max(axis=1))
    rows = [int(found[k]) for k in shown]
    limits = [limit[k] for k in shown]
    return [
        Further(row=row, pose=pose.moved_to(motion, row), limit=kind)
        for row, kind in zip(rows, limits, strict=True)
    ]


def faint_symbols(shown: Sequence[Further], measures: Measures) -> Iterator[Primitive]:
    """All moving parts at every further position; limits are less faint."""
    for further in shown:
        pose = further.pose
        found = tracks(pose, measures, tones(pose))
        still = set(pose.skeleton.fixed)
        moving = [
            *wheel_symbols(pose, measures, moving=True),
            *part_symbols((f for f in pose.skeleton.figures if f.shown_again), pose, measures),
            *link_symbols(pose, track_gaps(found, measures)),
            *guide_symbols(found, measures),
            *part_symbols(pose.skeleton.struts, pose, measures),
            *(p for p in pin_symbols(pose, measures) if p.role is Role.PIN and p.of not in still),
        ]
        lying = (Role.GROUND, Role.HATCH, Role.FRAME, Role.MARK)
        fade = _FADE if further.limit is None else _FADE_OF_LIMITS
        for primitive in moving:
            if primitive.role not in lying:
                yield replace(primitive, fade=fade)


def driven_point(pose: Pose) -> str:
    """The point driven most directly by the first input, for marks of its limits."""
    skeleton = pose.skeleton
    travel = {name: _travel(path) for name, path in pose.paths.items()}
    wanted: list[str] = []
    for part in skeleton.driven[:1]:
        for bar in skeleton.bars:
            if bar.name == part.name:
                pivot = pose.points[part.pivot or bar.points[0]]
                wanted += sorted(bar.points, key=lambda name: -abs(pose.points[name] - pivot))
        wanted += [guide.point for guide in skeleton.guides if guide.name == part.name]
        wanted += [end for s in skeleton.struts if s.name == part.name for end in s.between]
    wanted += skeleton.traced
    most = max(travel, key=lambda name: travel[name])
    return next((name for name in wanted if travel[name] > COINCIDENT * travel[most]), most)


def _travel(path: ComplexArray) -> float:
    found = path[np.isfinite(path)]
    return float(np.abs(found - found[0]).max()) if len(found) else 0.0


def limit_marks(
    shown: Sequence[Further], motion: Motion | None, measures: Measures
) -> tuple[list[Primitive], list[Choice]]:
    """A stop across the path at every dead point, a diamond at every change point; and names."""
    marks: list[Primitive] = []
    names: list[Choice] = []
    for further in shown:
        if further.limit is None or motion is None:
            continue
        of = driven_point(further.pose)
        place = further.pose.points[of]
        if further.limit is LimitKind.DEAD_POINT:
            across = 3.0 * measures.pin * _direction(further, of) * 1j
            marks.append(drawn_line(Role.LIMIT, of, (place - across, place + across)))
        else:
            corners = (place + 1.7 * measures.pin * 1j**k for k in range(4))
            marks.append(drawn_area(Role.LIMIT, of, corners))
        text = f"{further.limit.word} {lead_text(motion, further.row)}"
        height = 0.8 * measures.text
        names.append(places_beside(Role.LIMIT_NAME, of, text, place, height, measures))
    return marks, names


def _direction(further: Further, name: str) -> complex:
    """The unit tangent of a point's path at its current position."""
    path = further.pose.paths[name]
    rows = np.flatnonzero(np.isfinite(path))
    away = path[rows] - path[further.row]
    least = 1e-3 * float(np.abs(away).max(initial=0.0))
    near = rows[np.abs(away) > least]
    if not len(near):
        return 1 + 0j
    step = complex(path[near[np.argmin(np.abs(near - further.row))]] - path[further.row])
    return step / abs(step)


# ----------------------------------------------------------------------
# Symbols of instant centres (numbered crosses) and centrodes (curves).


_SUBSCRIPT = str.maketrans("0123456789,", "₀₁₂₃₄₅₆₇₈₉‚")
_FAR = 0.35  # of the drawn size: centres further outside are counted, not drawn
_OUTSIDE = 0.3  # of the drawn size: curves are cut off at this distance outside


def numbered(centres: Sequence[InstantCentre]) -> dict[str, int]:
    """The number of every link among the centres: ground is 1."""
    links = dict.fromkeys(link for centre in centres for link in centre.links)
    return {link: number for number, link in enumerate(links, 1)}


def centre_symbols(centres: Sequence[InstantCentre], within: Box, measures: Measures) -> Annotation:
    """A cross at every centre in or near the picture, and a caption of the link numbers."""
    number = numbered(centres)
    near = within.grown(_FAR * measures.size)
    groups: list[tuple[complex, list[str]]] = []
    far = endless = 0
    for centre in centres:
        if centre.place is None:
            endless += 1
        elif near.distance(xy(centre.place)) > 0.0:
            far += 1
        else:
            name = _name(number[centre.links[0]], number[centre.links[1]], len(number))
            _gather(groups, centre.place, name, COINCIDENT * measures.size)
    drawn: list[Primitive] = []
    names: list[Choice] = []
    for place, together in groups:
        text = " ".join(together)
        drawn.append(_cross(place, text, measures))
        height = measures.text  # subscripts are smaller
        names.append(places_beside(Role.CENTRE_NAME, text, text, place, height, measures))
    links = ", ".join(f"{k}:{printed_name(link)}" for link, k in number.items())
    left = [f"{far} further away"] * bool(far) + [f"{endless} at infinity"] * bool(endless)
    caption = "; ".join([f"instant centres of links {links}", *left])
    return Annotation(drawn=drawn, names=names, caption=caption)


def _gather(
    groups: list[tuple[complex, list[str]]], place: complex, name: str, near: float
) -> None:
    """Add a name to the group at its position."""
    for other, names in groups:
        if abs(other - place) <= near:
            names.append(name)
            return
    groups.append((place, [name]))


def _name(one: int, two: int, count: int) -> str:
    """``I₁₂``; with a comma for two-digit numbers."""
    comma = "," if count > 9 else ""
    return "I" + f"{one}{comma}{two}".translate(_SUBSCRIPT)


def _cross(place: complex, of: str, measures: Measures) -> Hatch:
    arm = 1.25 * measures.pin * cmath.exp(0.25j * cmath.pi)
    strokes = tuple((xy(place - a), xy(place + a)) for a in (arm, 1j * arm))
    return Hatch(role=Role.CENTRE, of=of, strokes=strokes)


def centrode_symbols(
    paths: Sequence[Centrodes], pose: Pose, within: Box, measures: Measures
) -> Annotation:
    """The fixed centrode of every link, and the moving one at the current position."""
    drawn: list[Primitive] = []
    near = within.grown(_OUTSIDE * measures.size)
    for path in paths:
        moving = _placed(path, pose)
        for role, curve in ((Role.FIXED_CENTRODE, path.fixed), (Role.MOVING_CENTRODE, moving)):
            drawn += _curve(role, path.link, curve, near, measures)
    links = ", ".join(printed_name(path.link) for path in paths)
    return Annotation(drawn=drawn, caption=f"centrodes of {links}: fixed solid, moving dashed")


def _placed(path: Centrodes, pose: Pose) -> ComplexArray:
    """The moving centrode in the plane, at the current position of its link."""
    bar = next(bar for bar in pose.skeleton.bars if bar.name == path.link)
    origin = pose.points[bar.points[0]]
    if path.link in pose.angles:
        turn = cmath.exp(1j * pose.angles[path.link])
    else:
        others = [pose.points[name] - origin for name in bar.points[1:]]
        along = next(z for z in others if z)
        turn = along / abs(along)
    placed: ComplexArray = origin + turn * path.moving
    return placed


def _curve(
    role: Role, link: str, curve: ComplexArray, near: Box, measures: Measures
) -> list[Primitive]:
    """A curve in and near the picture, in one or more pieces."""
    (left, bottom), (right, top) = near.corners
    inside = (curve.real >= left) & (curve.real <= right)
    inside &= (curve.imag >= bottom) & (curve.imag <= top)
    kept = np.where(inside, curve, complex(np.nan, np.nan))
    width = measures.stroke / 2
    return [
        drawn_line(role, link, run)
        for run in drawn_once(thinned(kept, width), width)
        if len(run) > 1
    ]
