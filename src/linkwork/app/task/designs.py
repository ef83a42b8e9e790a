"""Designs of any kind of mechanism as the page shows them: a skeleton that moves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from linkwork.app.live.file_state import Point
from linkwork.app.live.task_events import (
    CognatesFound,
    CognateShown,
    DesignFound,
    DesignShown,
    DyadShown,
    SkeletonShown,
    TaskSolved,
)
from linkwork.core.foundation.arrays import Array, ComplexArray, CountArray
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.motion import Motion
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.loops.driven_loop import pivots_at
from linkwork.synthesis.loops.limits import Candidates, Drive, LoopKind
from linkwork.synthesis.poses.burmester import CentrePoints, centre_points
from linkwork.synthesis.precision.problem import cognates
from linkwork.synthesis.solvers.motions import poses_of
from linkwork.synthesis.solvers.result import Synthesis, SynthesizedDesign
from linkwork.synthesis.solvers.solving import advice_of, near_misses, remark_on
from linkwork.synthesis.solvers.swept_design import SweptDesign
from linkwork.synthesis.tasks.task import Task


def design_shown(design: JudgedDesign, index: int) -> DesignShown:
    """A design in the list."""
    return DesignShown(
        index=index,
        origin="",
        number=design.number,
        mechanism=design.mechanism,
        drive=design.driven,
        sound=not design.kinds,
        delivered=design.delivered,
        transmission=finite(design.transmission),
        size=finite(design.size),
        error=finite(design.error),
        score=finite(design.score),
        reason=design.defects[0].message if design.kinds else "",
        remark=remark_on(design),
    )


def finite(value: float) -> float | None:
    """A number for the page, which knows no NaN and no infinity."""
    return float(value) if math.isfinite(value) else None


def mechanism_found(
    design: SweptDesign,
    shown: DesignShown,
    point: str = "",
    inputs: tuple[float, ...] = (),
) -> DesignFound:
    """A design with the rows of its table that have a position; ``point`` draws its path,
    ``inputs`` are those at the positions, by default the improved ones.
    """
    event = DesignFound(
        design=shown,
        skeleton=None,
        fixed=(),
        guided="",
        lines=(None, None),
        at=(),
        rows=(),
        marks=(),
        curve=(),
    )
    motion = design.improved.motion
    if motion is None or not motion.found.any():
        return event
    solved = np.flatnonzero(motion.found)
    rows = solved[np.linspace(0, len(solved) - 1, min(_ROWS, len(solved))).round().astype(int)]
    names = list(motion.points)
    places = np.array([motion.trace(name)[rows] for name in names])
    table = np.stack([places.real, places.imag], axis=1).reshape(2 * len(names), len(rows))
    traced = point or next(iter(motion.skeleton.traced), "")
    return replace(
        event,
        skeleton=_skeleton(motion.skeleton, names),
        guided=traced,
        rows=tuple(map(tuple, table.T.tolist())),
        marks=_marks(motion, inputs or design.improved.inputs, rows),
        curve=tuple(pieces(motion.trace(traced))) if traced else (),
    )


def _skeleton(skeleton: Skeleton, names: list[str]) -> SkeletonShown:
    driven = {part.name for part in skeleton.driven}
    return SkeletonShown(
        bars=tuple(tuple(names.index(p) for p in bar.points) for bar in skeleton.bars),
        driven=tuple(bar.name in driven for bar in skeleton.bars),
        fixed=tuple(names.index(p) for p in skeleton.fixed if p in skeleton.pins),
        pins=tuple(names.index(p) for p in skeleton.pins),
        blocks=tuple(
            (names.index(guide.point), names.index(guide.line[0]), names.index(guide.line[1]))
            for guide in skeleton.guides
            if guide.block
        ),
        discs=tuple(
            (names.index(disc.center), float(disc.radius))
            for disc in skeleton.figures
            if isinstance(disc, DiscFigure)
        ),
    )


def _marks(motion: Motion, inputs: tuple[float, ...], rows: CountArray) -> tuple[float, ...]:
    """The shown row at each position; an input may be turns away from those of the table."""
    if not inputs:
        return ()
    lead = next(iter(motion.inputs))
    values: Array = np.asarray(motion.inputs[lead][rows], dtype=float)
    turn = motion.units.angle.turn
    at = np.array(inputs)
    low, high = values.min(), values.max()
    laps = np.where((at < low) | (at > high), np.floor((at - low) / turn), 0.0)
    order = np.argsort(values)
    return tuple(np.interp(at - laps * turn, values[order], order.astype(float)).tolist())


def pieces(points: ComplexArray) -> Iterator[tuple[float, ...]]:
    """Runs of finite points as x, y, x, y, …"""
    whole = np.isfinite(points)
    ends = np.flatnonzero(np.diff(whole)) + 1
    for part, ok in zip(np.split(points, ends), np.split(whole, ends), strict=True):
        if len(part) > 1 and ok[0]:
            yield tuple(np.stack([part.real, part.imag], axis=1).ravel().tolist())


# ----------------------------------------------------------------------
# The designs of a synthesis as the page shows them: list, motion, cognates.


_MOST_SOUND, _MOST_REFUSED = 300, 200  # of the list on the page
_ROWS = 181  # of a motion
_CURVE = 361  # points of a coupler curve,
_CHORD, _FINEST = 0.01, 50.0  # with more between them if they are farther apart than this share
_CENTRE_CURVE = 240  # lines through the pole for each arc
_INSIDE = 1e-9  # of an arc: at its very ends rounding may leave no point
_FAR = 30.0  # sizes of the task: the centre-point curve goes to infinity
_COGNATE = 1e-6  # relative: the same pivots, solved in two ways
_MOST_DYADS = 200


def task_solved(synthesis: Synthesis, chosen: DesignFound | None, *, live: bool) -> TaskSolved:
    """The counts and the list; ``live``: without the list and the most restrictive requirement."""
    listed = [] if live else _listed(synthesis, chosen)
    # to judge without requirements takes longer than a drag waits
    judged = None if live or synthesis.sound else synthesis.most_restrictive
    requirement, costs = judged or ("", 0)
    solutions = f"{synthesis.complex} complex, {synthesis.real} real, {synthesis.proved} proved"
    if synthesis.starts:
        solutions = f"{synthesis.real} fits from {synthesis.starts} starts"
    return TaskSolved(
        live=live,
        solutions=solutions,
        linkages=synthesis.linkages,
        count=len(synthesis.designs),
        sound=synthesis.sound,
        delivered=len(synthesis.delivered),
        completeness=synthesis.completeness.name,
        message=synthesis.message,
        interrupted=synthesis.interrupted,
        error_unit=synthesis.error_unit,
        defects={kind.value: count for kind, count in synthesis.defects.items()},
        most_restrictive=requirement,
        costs=costs,
        advice="" if live else advice_of(synthesis),
        designs=tuple(design_shown(synthesis.designs[k], k) for k in listed),
        left_out=len(synthesis.designs) - len(listed),
        dyads=tuple(
            DyadShown(kind=dyad.kind, fixed=dyad.fixed, proved=dyad.proved)
            for dyad in (() if live else synthesis.dyads[:_MOST_DYADS])
        ),
        centre_curve=centre_curve(synthesis.task),
        chosen=chosen,
    )


def _listed(solved: Synthesis, chosen: DesignFound | None) -> list[int]:
    """The places of the best sound designs, then those of refused ones: near misses first."""
    refused = dict.fromkeys([*near_misses(solved), *range(solved.sound, len(solved.designs))])
    shown = [*range(min(solved.sound, _MOST_SOUND)), *[*refused][:_MOST_REFUSED]]
    # the chosen one is not left out
    return [*dict.fromkeys(shown if chosen is None else [*shown, chosen.design.index])]


def design_found(synthesis: Synthesis, index: int) -> DesignFound:
    """A design at the positions, and moving through its driven range if it is sound."""
    design = synthesis.designs[index]
    if isinstance(design, SweptDesign):
        return mechanism_found(design, design_shown(design, index), inputs=design.inputs)
    assert isinstance(design, SynthesizedDesign)
    group, k = design.group, design.index
    candidate, drive = group.candidates.take(slice(k, k + 1)), group.drive
    one = np.array([k])
    loops, travel = group.loops.take(one), group.travel
    at = (candidate.moving_a[0], candidate.moving_b[0], candidate.guided[0])
    rows: tuple[tuple[float, ...], ...] = ()
    marks: tuple[float, ...] = ()
    if not design.kinds:
        first, last = float(travel.first[k]), float(travel.last[k])
        place = np.linspace(first, last, _ROWS)
        rows = _coordinates(*(part[0] for part in pivots_at(candidate, drive, loops, place[None])))
        span = (last - first) or 1.0
        marks = tuple(((travel.place[k] - first) / span * (_ROWS - 1)).tolist())
    return DesignFound(
        design=design_shown(design, index),
        skeleton=None,
        fixed=tuple(_fixed(candidate, at)),
        guided=next((name for name, z in zip("AB", at, strict=False) if z[0] == at[2][0]), "P"),
        lines=_lines(candidate),
        at=_coordinates(*at),
        rows=rows,
        marks=marks,
        curve=_curve(candidate, drive, loops),
    )


def _fixed(loops: Candidates, at: tuple[ComplexArray, ...]) -> Iterator[tuple[Point, ...]]:
    """Of A and of B: the fixed pivot, or two points of the fixed line."""
    sides = (("A0", loops.fixed_a, loops.direction_a), ("B0", loops.fixed_b, loops.direction))
    for (pivot, (start,), (direction,)), moving in zip(sides, at[:2], strict=True):
        if pivot in loops.kind.pivots:
            yield (_point(start),)
            continue
        along = ((moving - start) * direction.conj()).real
        reach = 0.2 * max(float(np.ptp(along)), float(abs(at[1][0] - at[0][0])))
        ends = along.min() - reach, along.max() + reach
        yield tuple(_point(start + end * direction) for end in ends)


def _lines(loops: Candidates) -> tuple[float | None, float | None]:
    """The directions of the coupler's lines through A0 and B0 from that of AB [rad]."""
    coupler = loops.moving_b[0, 0] - loops.moving_a[0, 0]
    one, other = (float(np.angle(line[0, 0] / coupler)) for line in (loops.lines_a, loops.lines))
    return (one if loops.kind is LoopKind.OLDHAM else None, other if loops.kind.body_line else None)


def _coordinates(*parts: ComplexArray) -> tuple[tuple[float, ...], ...]:
    """Rows of x, y of each part (K,); rows without a position are left out."""
    table = np.stack([number for part in parts for number in (part.real, part.imag)], axis=1)
    return tuple(map(tuple, table[np.isfinite(table).all(axis=1)].tolist()))


def _curve(candidates: Candidates, drive: Drive, loops: object) -> tuple[tuple[float, ...], ...]:
    """The guided point on the branch of the first position, in pieces x, y, x, y, …"""
    if not drive.turns:
        place = np.linspace(*_slider_range(candidates), _CURVE)
    else:
        place = np.linspace(-np.pi, np.pi, _CURVE)

    def guided(at: Array) -> ComplexArray:
        return np.asarray(pivots_at(candidates, drive, loops, at[None])[2][0])  # type: ignore[arg-type]

    points = guided(place)
    finite = points[np.isfinite(points)]
    size = float(max(np.ptp(finite.real), np.ptp(finite.imag))) if len(finite) else 0.0
    # more points where the point is fast
    parts = np.ceil(np.nan_to_num(np.abs(np.diff(points))) / (_CHORD * size or np.inf))
    number = np.concatenate([[0.0], np.cumsum(np.clip(parts, 1.0, _FINEST))])
    denser = np.interp(np.arange(number[-1] + 1.0), number, place)
    return tuple(pieces(guided(denser)))


def _slider_range(loops: Candidates) -> tuple[float, float]:
    other = loops.fixed_a if loops.kind.has_crank else loops.fixed_b
    reach = abs(loops.moving_a[0, 0] - other[0]) + abs(loops.moving_b[0, 0] - loops.moving_a[0, 0])
    return -float(reach), float(reach)


def _point(z: complex) -> Point:
    return float(z.real), float(z.imag)


def alike(synthesis: Synthesis, kind: str, drive: str, pivots: ComplexArray) -> int | None:
    """The design of a kind whose pivots (4,) are nearest to those of another one, sound ones first;
    ``None`` without designs.
    """
    best: tuple[bool, float, int] | None = None
    of_loops = [(k, d) for k, d in enumerate(synthesis.designs) if isinstance(d, SynthesizedDesign)]
    groups = {id(design.group): design.group for _, design in of_loops}
    distances: dict[int, Array] = {}
    for name, group in groups.items():
        loops = group.candidates
        ends = [loops.fixed_a, loops.fixed_b, loops.moving_a[:, 0], loops.moving_b[:, 0]]
        off = np.abs(np.stack(ends, axis=1) - pivots).sum(axis=1)
        other = (loops.kind.value, group.drive.value) != (kind, drive)
        distances[name] = np.where(other, np.inf, off)
    for k, design in of_loops:
        off = float(distances[id(design.group)][design.index])
        rank = (bool(design.kinds), off, k)
        if best is None or rank < best:
            best = rank
    return None if best is None else best[2]


def centre_curve(task: Task) -> tuple[tuple[float, ...], ...]:
    """The centre-point curve of four poses as polylines; none for other tasks."""
    return tuple(piece for run in _centre_runs(task) for piece in pieces(run))


def nearest_on(task: Task, point: complex) -> complex:
    """The point of the centre-point curve nearest to a point; the point itself for other tasks."""
    runs = [run[np.isfinite(run)] for run in _centre_runs(task)]
    points = np.concatenate(runs) if runs else np.empty(0, dtype=complex)
    if not points.size:
        return point
    curve = _centre_points(task)
    assert curve is not None
    near = points[np.abs(points - point).argmin()]
    # the sample and the lines through its neighbourhood, ever finer
    angle, width = float(np.angle(near - curve.pole)), np.pi / _CENTRE_CURVE
    for _ in range(8):
        angles = angle + np.linspace(-width, width, 33)
        on_curve = curve.points(angles)
        off = np.abs(on_curve - point)
        if np.isnan(off).all():
            break
        k, side = np.unravel_index(np.nanargmin(off), off.shape)
        if off[k, side] <= abs(near - point):
            near = on_curve[k, side]
        angle, width = float(angles[k]), width / 8.0
    return complex(near)


def _centre_points(task: Task) -> CentrePoints | None:
    if task.kind != "motion" or len(task.positions) != 4:
        return None
    return centre_points(*poses_of(task))


def _centre_runs(task: Task) -> Iterator[ComplexArray]:
    """Points along the arcs, there on one side and back on the other; NaN where they are far."""
    curve = _centre_points(task)
    if curve is None:
        return
    points, _ = poses_of(task)
    middle = points.mean()
    size = max(float(np.abs(points - middle).max()), abs(curve.pole - middle))
    for arc in curve.arcs:
        share = 0.5 - (0.5 - _INSIDE) * np.cos(np.linspace(0.0, np.pi, _CENTRE_CURVE))
        sides = curve.points(arc.start + share * (arc.stop - arc.start))
        for run in _continuous(sides, size):
            yield np.where(np.abs(run - middle) < _FAR * size, run, np.nan)


def _continuous(sides: ComplexArray, size: float) -> Iterable[ComplexArray]:
    """Both sides (K, 2), which change places where their equation changes its sign, each cut where
    it jumps through infinity.
    """
    one, other = sides.T
    stay = np.abs(np.diff(one)) + np.abs(np.diff(other))
    change = np.abs(other[1:] - one[:-1]) + np.abs(one[1:] - other[:-1])
    changed = np.append(False, np.cumsum(change < stay) % 2 == 1)
    for side in (np.where(changed, other, one), np.where(changed, one, other)):
        yield np.where(np.append(np.abs(np.diff(side)), 0.0) > size, np.nan, side)


def cognates_found(synthesis: Synthesis, index: int) -> CognatesFound:
    """A four-bar and its two cognates, each with its verdict if it is among the designs."""
    design = synthesis.designs[index]
    if not isinstance(design, SynthesizedDesign):
        return CognatesFound(design=index, cognates=(), curve=())
    loop = design.group.candidates.take(slice(design.index, design.index + 1))
    curve = design_found(synthesis, index).curve
    if loop.kind is not LoopKind.FOUR_BAR or design.design.points["P"] in _joints(design):
        return CognatesFound(design=index, cognates=(), curve=curve)
    guided = loop.guided[0, 0]
    legs = [loop.moving_a[0, 0], loop.fixed_a[0], loop.moving_b[0, 0], loop.fixed_b[0]]
    x, a, y, b = (z - guided for z in legs)
    linkage = np.array([[z for pair in ((w, w.conjugate()) for w in (x, a, y, b)) for z in pair]])
    rows = [linkage[0], *(part[0] for part in cognates(linkage))]
    shown = [
        _cognate(synthesis, {name: _point(row[2 * k] + guided) for k, name in enumerate(_LEGS)}
                 | {"P": _point(guided)}, index if not place else None)
        for place, row in enumerate(rows)
        if np.isfinite(row).all()
    ]  # fmt: skip
    return CognatesFound(design=index, cognates=tuple(shown), curve=curve)


_LEGS = ("A", "A0", "B", "B0")


def _joints(design: SynthesizedDesign) -> tuple[complex, ...]:
    points = design.design.points
    return points["A"], points["B"]


def _cognate(synthesis: Synthesis, points: dict[str, Point], index: int | None) -> CognateShown:
    """A cognate with the best verdict that the list has on it, in the names of its points."""
    linkage = np.array([complex(*points[name]) for name in ("A0", "B0", "A", "B")])
    size = np.abs(linkage - linkage.mean()).max()
    for k in range(len(synthesis.designs)) if index is None else (index,):
        other = synthesis.designs[k]
        if not isinstance(other, SynthesizedDesign):
            continue
        loops, j = other.group.candidates, other.index
        ends = [loops.fixed_a[j], loops.fixed_b[j], loops.moving_a[j, 0], loops.moving_b[j, 0]]
        for exchanged, order in enumerate(([0, 1, 2, 3], [1, 0, 3, 2])):
            if np.abs(np.array(ends)[order] - linkage).max() < _COGNATE * size:
                shown = design_shown(other, k)
                drive = {"A0": "B0", "B0": "A0"}[shown.drive] if exchanged else shown.drive
                return CognateShown(
                    points=points, drive=drive, index=k, sound=shown.sound, reason=shown.reason
                )
    return CognateShown(
        points=points, drive="A0", index=-1, sound=False, reason="not among the designs"
    )
