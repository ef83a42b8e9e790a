"""A motion in one picture: some faint further positions, and marks at its limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.drawing.captions import lead_text
from linkwork.drawing.guide_symbols import guide_symbols, track_gaps, tracks
from linkwork.drawing.label_placement import Choice, places_beside
from linkwork.drawing.link_symbols import link_symbols, pin_symbols, tones
from linkwork.drawing.measures import COINCIDENT, Measures
from linkwork.drawing.part.index import part_symbols
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, xy
from linkwork.drawing.wheel_symbols import wheel_symbols
from linkwork.foundation.arrays import ComplexArray
from linkwork.results.motion import LimitKind, Motion

__all__ = ["Further", "driven_point", "faint_symbols", "further_positions", "limit_marks"]

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
    return [
        Further(
            row=int(found[k]),
            pose=replace(
                pose,
                points=dict(zip(pose.paths, places[k].tolist(), strict=True)),
                angles={
                    name: float(series.value[found[k]]) * motion.units.angle.radians
                    for name, series in motion.links.items()
                },
            ),
            limit=limit[k],
        )
        for k in shown
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
            ends = (xy(place - across), xy(place + across))
            marks.append(Polyline(role=Role.LIMIT, of=of, points=ends))
        else:
            corners = tuple(xy(place + 1.7 * measures.pin * 1j**k) for k in range(4))
            marks.append(Polygon(role=Role.LIMIT, of=of, points=corners))
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
