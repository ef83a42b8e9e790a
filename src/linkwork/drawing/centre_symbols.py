"""Symbols of instant centres (numbered crosses) and centrodes (curves)."""

from __future__ import annotations

import cmath
from collections.abc import Sequence

import numpy as np

from linkwork.drawing.annotation import Annotation
from linkwork.drawing.box import Box
from linkwork.drawing.captions import printed_name
from linkwork.drawing.label_placement import Choice, places_beside
from linkwork.drawing.measures import COINCIDENT, Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Hatch, Polyline, Primitive, Role, xy
from linkwork.drawing.trace_path import drawn_once, thinned
from linkwork.foundation.arrays import ComplexArray
from linkwork.results.instant_centres import Centrodes, InstantCentre

__all__ = ["centre_symbols", "centrode_symbols", "numbered"]

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
        Polyline(role=role, of=link, points=tuple(map(xy, run)))
        for run in drawn_once(thinned(kept, width), width)
        if len(run) > 1
    ]
