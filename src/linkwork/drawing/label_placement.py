"""Names of points and links, placed where they hide least.

Every name may stand in 32 places around its point (eight directions, four distances), every link
name in some more beside its bar. Each place has a penalty for what it would cover; names are placed
one by one and moved until none can do better alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.link_symbols import convex_outline, in_line, tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import (
    Arc,
    Disc,
    Hatch,
    Polygon,
    Polyline,
    Primitive,
    Role,
    Text,
    text_width,
    xy,
)
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.names import pretty

__all__ = ["link_names", "placed", "point_names", "printed_name"]


#: What it costs to cover a line or disc of a role; covering another name or a pin is worst.
_PENALTY = {
    Role.PLATE: 9.0, Role.HATCH: 6.0, Role.GROUND: 10.0, Role.TRACE: 2.5, Role.SLOT: 12.0,
    Role.SLIDER: 12.0, Role.LINK: 14.0, Role.CYLINDER: 14.0, Role.PIN: 60.0, Role.POINT: 40.0,
    Role.TRACED: 40.0, Role.INPUT: 14.0,
}  # fmt: skip
_NAME_ON_NAME = 100.0
_INSIDE_PLATE = 1.5
_FURTHER = 2.0
_CLEAR = 0.12  # left free around every name [em]: half a thick line and some air
#: Right and above is where a name is looked for first.
_PREFERENCE = {45: 0.0, 135: 0.3, 90: 0.5, 0: 0.6, 180: 0.7, 315: 0.8, 225: 0.9, 270: 1.0}
_SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@dataclass(frozen=True)
class Choice:
    """The places one name may take, with a penalty for each that knows no other name yet."""

    places: tuple[Text, ...]
    cost: tuple[float, ...]


def printed_name(name: str) -> str:
    """A name as printed in a figure: ``theta12`` → ``θ₁₂``, ``O2`` → ``O₂``."""
    shown = pretty(name)
    stem = shown.rstrip("0123456789'")
    return stem + shown[len(stem) :].translate(_SUBSCRIPT) if stem else shown


def point_names(pose: Pose, measures: Measures) -> list[Choice]:
    """Places for the name of every point that is drawn."""
    near = 1.6 * measures.pin
    found = []
    for name, place in pose.points.items():
        if name in pose.construction:
            continue
        places, cost = [], []
        for further in range(4):
            for degrees, preference in _PREFERENCE.items():
                gap = near + further * 1.3 * measures.pin
                places.append(_beside(name, place, math.radians(degrees), gap, measures.text))
                cost.append(preference + further * _FURTHER)
        found.append(Choice(tuple(places), tuple(cost)))
    return found


def _beside(name: str, place: complex, angle: float, gap: float, height: float) -> Text:
    """The name with its box just outside a circle of radius ``gap`` around the point."""
    cos, sin = round(math.cos(angle), 9), round(math.sin(angle), 9)
    align = -1 if cos > 0 else 1 if cos < 0 else 0
    below, above = 0.16 * height, 0.76 * height
    baseline = gap * sin + (below if sin > 0 else -above if sin < 0 else -(above - below) / 2)
    return Text(
        role=Role.LABEL,
        of=name,
        text=printed_name(name),
        anchor=xy(place),
        offset=(gap * cos, baseline),
        height=height,
        align=align,
    )


def link_names(pose: Pose, measures: Measures) -> list[Choice]:
    """Places for the name of every link: inside its plate, else beside its bar."""
    tone = tones(pose)
    height = 0.85 * measures.text
    spans: dict[str, list[complex]] = {
        bar.name: [pose.points[name] for name in bar.points] for bar in pose.skeleton.bars
    }
    spans |= {s.name: [pose.points[name] for name in s.between] for s in pose.skeleton.struts}
    found = []
    for name, points in spans.items():
        outline = convex_outline(points)
        if len(set(points)) < 2:
            continue
        spots = _beside_bar(outline, name, height, measures)
        if not in_line(outline):
            centre = sum(outline) / len(outline)
            spots = [(centre, 0.0), *((spot, cost + 2.0) for spot, cost in spots)]
        places = tuple(
            Text(
                role=Role.LINK_NAME,
                of=name,
                tone=tone.get(name, 1),
                text=printed_name(name),
                anchor=xy(spot),
                offset=(0.0, -0.3 * height),
                height=height,
            )
            for spot, _ in spots
        )
        found.append(Choice(places, tuple(cost for _, cost in spots)))
    return found


def _beside_bar(
    outline: list[complex], name: str, height: float, measures: Measures
) -> list[tuple[complex, float]]:
    """Middles of the name beside the longest side of an outline, with their penalties."""
    sides = list(zip(outline, outline[1:] + outline[:1], strict=True))
    start, end = max(sides, key=lambda side: abs(side[1] - side[0]))
    left = (end - start) / abs(end - start) * 1j
    half_width = text_width(printed_name(name), height) / 2
    clear = abs(left.real) * half_width + abs(left.imag) * 0.5 * height + 0.8 * measures.pin
    return [
        (
            start + share * (end - start) + side * (clear + further * 0.6 * height) * left,
            2 * abs(share - 0.5) + further * _FURTHER,
        )
        for further in range(4)
        for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
        for side in (1, -1)
    ]


def placed(choices: Sequence[Choice], drawn: Iterable[Primitive]) -> list[Text]:
    """The best place for every name over what is drawn already.

    Notes
    -----
    Each sweep gives every name, in order, the place that is best against the others where they
    stand; it ends when nothing moves, which is a local optimum. Four sweeps are enough in
    practice and bound the time.
    """
    if not choices:
        return []
    boxes = [[text.box.grown(_CLEAR * text.height) for text in choice.places] for choice in choices]
    obstacles = _Obstacles.of(drawn)
    fixed = [np.array(c.cost) + obstacles.cost(b) for c, b in zip(choices, boxes, strict=True)]
    # Most hemmed in first: they have the least choice.
    order = sorted(range(len(choices)), key=lambda k: -float(np.min(fixed[k])))
    taken: dict[int, int] = {}
    for _ in range(4):
        before = dict(taken)
        for k in order:
            others = [boxes[j][place] for j, place in taken.items() if j != k]
            cost = [
                fixed[k][place] + _NAME_ON_NAME * sum(box.overlap(other) > 0 for other in others)
                for place, box in enumerate(boxes[k])
            ]
            taken[k] = int(np.argmin(cost))
        if taken == before:
            break
    return [choices[k].places[taken[k]] for k in range(len(choices))]


@dataclass(frozen=True)
class _Obstacles:
    """What names should not cover: line pieces (m, 4), discs (d, 3), plates; with penalties."""

    pieces: Array
    piece_cost: Array
    discs: Array
    disc_cost: Array
    plates: tuple[Array, ...]

    @classmethod
    def of(cls, drawn: Iterable[Primitive]) -> _Obstacles:
        pieces: list[tuple[float, float, float, float]] = []
        piece_cost: list[float] = []
        discs: list[tuple[float, float, float]] = []
        disc_cost: list[float] = []
        plates: list[Array] = []
        for p in drawn:
            found = []
            if isinstance(p, Disc):
                discs.append((*p.centre, p.radius))
                disc_cost.append(_PENALTY.get(p.role, 0.0))
            elif isinstance(p, Polyline | Arc):
                found = list(zip(p.points, p.points[1:], strict=False))
            elif isinstance(p, Polygon):
                found = list(zip(p.points, p.points[1:] + p.points[:1], strict=True))
                if p.role is Role.PLATE:
                    plates.append(np.array(p.points))
            elif isinstance(p, Hatch):
                found = list(p.strokes)
            pieces += [(*a, *b) for a, b in found]
            piece_cost += [_PENALTY.get(p.role, 0.0)] * len(found)
        return cls(
            np.array(pieces).reshape(-1, 4), np.array(piece_cost),
            np.array(discs).reshape(-1, 3), np.array(disc_cost), tuple(plates),
        )  # fmt: skip

    def cost(self, boxes: Sequence[Box]) -> Array:
        """The penalty of every box, shape (number of boxes,)."""
        return np.array([self._cost(box) for box in boxes])

    def _cost(self, box: Box) -> float:
        x, y, r = self.discs.T
        dx = np.maximum(np.maximum(box.left - x, x - box.right), 0.0)
        dy = np.maximum(np.maximum(box.bottom - y, y - box.top), 0.0)
        hit = np.hypot(dx, dy) < r * (1 - 1e-9)
        covered = float(self.disc_cost @ hit)
        # A trace of many short pieces counts once per role's penalty, not once per piece.
        crossed = self.piece_cost[_crosses(self.pieces, box)]
        values, counts = np.unique(crossed, return_counts=True)
        covered += float(values @ (1 + np.log(counts)))
        inside = sum(_inside(plate, box.centre) for plate in self.plates)
        return covered + _INSIDE_PLATE * inside


def _crosses(pieces: Array, box: Box) -> BoolArray:
    """Which line pieces (m, 4) meet the box, shape (m,): the slab method."""
    start, end = pieces[:, :2], pieces[:, 2:]
    step = end - start
    low = np.array([box.left, box.bottom]) - start
    high = np.array([box.right, box.top]) - start
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = low / step, high / step
    flat = step == 0
    within = (low <= 0) & (high >= 0)
    enter = np.where(flat, np.where(within, -np.inf, np.inf), np.minimum(a, b))
    leave = np.where(flat, np.where(within, np.inf, -np.inf), np.maximum(a, b))
    return np.asarray(
        np.maximum(enter.max(axis=1, initial=0.0), 0.0)
        <= np.minimum(leave.min(axis=1, initial=1.0), 1.0)
    )


def _inside(corners: Array, point: tuple[float, float]) -> bool:
    """Whether a point lies in a convex polygon with counter-clockwise corners (n, 2)."""
    sides = np.roll(corners, -1, axis=0) - corners
    to_point = np.array(point) - corners
    return bool(np.all(sides[:, 0] * to_point[:, 1] - sides[:, 1] * to_point[:, 0] >= 0))
