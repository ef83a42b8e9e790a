"""Drawn parts as obstacles for labels, with penalties for covering them."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.core.drawing.links import convex_outline, in_line, tones
from linkwork.core.drawing.pose import Pose, printed_name
from linkwork.core.drawing.scene import (
    XY,
    Arc,
    Box,
    Disc,
    Hatch,
    Measures,
    Polygon,
    Polyline,
    Primitive,
    Role,
    Text,
    drawn_text,
    text_width,
    xy,
)
from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.mechanism.bodies import Contour, DiscFigure

#: Penalty for covering a line or disc of a role; highest for pins.
_PENALTY = {
    Role.FRAME: 6.0, Role.WHEEL: 6.0, Role.PITCH: 1.5, Role.MARK: 8.0, Role.BELT: 14.0,
    Role.PLATE: 9.0, Role.HATCH: 6.0, Role.GROUND: 10.0, Role.TRACE: 2.5, Role.SLOT: 12.0,
    Role.SLIDER: 12.0, Role.LINK: 14.0, Role.CYLINDER: 14.0, Role.PIN: 60.0, Role.POINT: 40.0,
    Role.WELD: 30.0, Role.TRACED: 40.0, Role.LIMIT: 40.0, Role.INPUT: 14.0, Role.SPEED_TRACE: 4.0,
    Role.FIXED_CENTRODE: 4.0, Role.MOVING_CENTRODE: 4.0, Role.EXTENSION: 4.0, Role.DIMENSION: 12.0,
    Role.VECTOR: 14.0, Role.VELOCITY: 14.0, Role.ACCELERATION: 14.0, Role.FORCE: 14.0,
    Role.CENTRE: 30.0, Role.SPRING: 12.0, Role.POSITION: 30.0,
}  # fmt: skip
_INSIDE_PLATE = 1.5
_TEXT = 100.0  # penalty for covering text
_OPEN = (Role.FRAME, Role.WHEEL, Role.PITCH)  # discs inside which names and arrows may be placed


@dataclass(frozen=True)
class Obstacles:
    """Line pieces (m, 4), discs (d, 3) and sides of plates (n, s, 4), with penalties for covering
    them.

    ``levels`` (l,): the penalties of pieces; ``level`` (m,): the index of each piece's penalty.
    """

    pieces: Array
    level: IndexArray
    levels: Array
    discs: Array
    disc_cost: Array
    plates: Array

    @classmethod
    def of(cls, drawn: Iterable[Primitive]) -> Obstacles:
        """The obstacles of a drawing."""
        pieces: list[tuple[float, float, float, float]] = []
        piece_cost: list[float] = []
        discs: list[tuple[float, float, float]] = []
        disc_cost: list[float] = []
        plates: list[tuple[XY, ...]] = []
        for p in drawn:
            found: list[tuple[XY, XY]] = []
            # covering a faded position has a smaller penalty
            penalty = _PENALTY.get(p.role, 0.0) * (1.0 - p.fade) ** 2
            if isinstance(p, Disc) and p.role in _OPEN:
                found = list(pairwise(p.rim))
            elif isinstance(p, Disc):
                discs.append((*p.centre, p.radius))
                disc_cost.append(penalty)
            elif isinstance(p, Polyline | Arc):
                found = list(pairwise(p.points))
            elif isinstance(p, Polygon):
                found = list(zip(p.points, p.points[1:] + p.points[:1], strict=True))
                if p.role is Role.PLATE and not p.fade:
                    plates.append(p.points)
            elif isinstance(p, Hatch):
                found = list(p.strokes)
            elif isinstance(p, Text):
                found, penalty = list(pairwise(_frame(p.box))), _TEXT
            if penalty:
                pieces += [(*a, *b) for a, b in found]
                piece_cost += [penalty] * len(found)
        levels = sorted(set(piece_cost))
        number = {penalty: k for k, penalty in enumerate(levels)}
        level = np.array([number[penalty] for penalty in piece_cost], dtype=np.intp)
        return cls(
            np.array(pieces).reshape(-1, 4), level, np.array(levels),
            np.array(discs).reshape(-1, 3), np.array(disc_cost), _sides(plates),
        )  # fmt: skip

    def cost(self, boxes: Sequence[Box]) -> float:
        """The penalty of an object made of these boxes."""
        return float(self.costs(np.array([[box.edges for box in boxes]]))[0])

    def costs(self, boxes: Array) -> Array:
        """The penalties (k,) of objects made of b boxes each.

        Parameters
        ----------
        boxes : array (k, b, 4)
            Left, bottom, right, top.
        """
        # A trace of many short pieces counts once per penalty, not once per piece.
        found = np.zeros(len(boxes))
        box, piece = np.nonzero(_near(self.pieces, boxes))
        crossed = _crosses(self.pieces[piece], boxes[box])
        box, level = box[crossed], self.level[piece[crossed]]
        for k, penalty in enumerate(self.levels):
            count = np.bincount(box[level == k], minlength=len(boxes))
            found += np.where(count, penalty * (1.0 + np.log(np.maximum(count, 1))), 0.0)
        inside = np.count_nonzero(_inside(self.plates, boxes), axis=1)
        total: Array = found + _covers(self.discs, boxes) @ self.disc_cost + _INSIDE_PLATE * inside
        return total


def _frame(box: Box) -> list[tuple[float, float]]:
    """The outline and the diagonals of a box."""
    (left, bottom), (right, top) = box.corners
    around = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
    return [*around, (right, top)]


def _sides(plates: Sequence[Sequence[XY]]) -> Array:
    """The sides of convex polygons, (n, s, 4), padded by repeating the last side."""
    most = max(map(len, plates), default=0)
    found = np.empty((len(plates), most, 4))
    for k, corners in enumerate(plates):
        around = np.array([*corners, corners[0]])
        sides = np.hstack((around[:-1], around[1:]))
        found[k, : len(sides)], found[k, len(sides) :] = sides, sides[-1]
    return found


def _near(pieces: Array, boxes: Array) -> BoolArray:
    """Whether pieces (m, 4) may intersect boxes (k, b, 4): those around both do, (k, m)."""
    low, high = boxes[..., :2].min(axis=1), boxes[..., 2:].max(axis=1)
    first = np.minimum(pieces[:, :2], pieces[:, 2:])
    last = np.maximum(pieces[:, :2], pieces[:, 2:])
    near = (first[:, 0] <= high[:, None, 0]) & (last[:, 0] >= low[:, None, 0])
    near &= (first[:, 1] <= high[:, None, 1]) & (last[:, 1] >= low[:, None, 1])
    return np.asarray(near)


def _covers(discs: Array, boxes: Array) -> BoolArray:
    """Whether discs (d, 3) intersect one of the boxes (k, b, 4), (k, d)."""
    x, y, r = discs.T
    left, bottom, right, top = np.moveaxis(boxes, -1, 0)[..., None]
    dx = np.maximum(np.maximum(left - x, x - right), 0.0)
    dy = np.maximum(np.maximum(bottom - y, y - top), 0.0)
    return np.asarray(np.any(np.hypot(dx, dy) < r * (1 - 1e-9), axis=1))


def _crosses(pieces: Array, boxes: Array) -> BoolArray:
    """Whether each line piece (n, 4) intersects one of its boxes (n, b, 4), (n,).

    It does unless x, y or the normal of the piece is a separating axis.
    """
    half = 0.5 * (pieces[:, None, 2:] - pieces[:, None, :2])
    middle = 0.5 * (pieces[:, None, 2:] + pieces[:, None, :2])
    size = 0.5 * (boxes[..., 2:] - boxes[..., :2])
    away = 0.5 * (boxes[..., 2:] + boxes[..., :2]) - middle
    turned = np.abs(half[..., 0] * away[..., 1] - half[..., 1] * away[..., 0])
    apart = np.any(np.abs(away) > size + np.abs(half), axis=-1)
    apart |= turned > size[..., 0] * np.abs(half[..., 1]) + size[..., 1] * np.abs(half[..., 0])
    return np.asarray(np.any(~apart, axis=1))


def _inside(plates: Array, boxes: Array) -> BoolArray:
    """Whether the middle of a box lies in convex plates (n, s, 4), counter-clockwise, (k, n)."""
    middle = 0.5 * (boxes[..., :2] + boxes[..., 2:])[:, :, None, None, :]  # (k, b, 1, 1, 2)
    side, away = plates[..., 2:] - plates[..., :2], middle - plates[..., :2]
    left = side[..., 0] * away[..., 1] - side[..., 1] * away[..., 0] >= 0
    return np.asarray(np.any(np.all(left, axis=-1), axis=1))


# ----------------------------------------------------------------------
# Placement of the names of points and links where they cover least.
#
# A point's name has 32 possible positions (eight directions, four distances), a link's name some
# more along its bar. Each position has a penalty for the parts it covers; names are placed one by
# one and moved until no single move improves the result.


_NAME_ON_NAME = 100.0  # penalty, larger than for any line: names must stay legible
_FURTHER = 2.0  # penalty for each step away from the named part
_ACROSS = 13  # positions of a text across an area, and as many vertically
_CLEAR = 0.12  # margin of every name [em]: half a thick line and some space
#: The first position tried is above right.
_PREFERENCE = {45: 0.0, 135: 0.3, 90: 0.5, 0: 0.6, 180: 0.7, 315: 0.8, 225: 0.9, 270: 1.0}


#: The chosen places of names and arrows by role and part, for further pictures of a drag.
Kept = dict[tuple[Role, str], int]


@dataclass(frozen=True)
class Choice:
    """The possible positions of a name, with penalties that exclude other names."""

    places: tuple[Text, ...]
    cost: tuple[float, ...]


def point_names(pose: Pose, measures: Measures) -> list[Choice]:
    """Positions for the names of all drawn points."""
    return [
        places_beside(Role.LABEL, name, printed_name(name), place, measures.text, measures)
        for name, place in pose.points.items()
        if name not in pose.construction
    ]


def places_beside(
    role: Role,
    of: str,
    text: str,
    place: complex,
    height: float,
    measures: Measures,
    tone: int = 0,
) -> Choice:
    """Positions for a text near a point: just outside circles around it."""
    places, cost = [], []
    for further in range(4):
        gap = (1.6 + 1.3 * further) * measures.pin
        for degrees, preference in _PREFERENCE.items():
            angle = math.radians(degrees)
            # rounded, so that 90° is exactly upright and the name is centred there
            cos, sin = round(math.cos(angle), 9), round(math.sin(angle), 9)
            # descenders and ascenders of a printed line, as in the box of a text
            below, above = 0.16 * height, 0.76 * height
            rise = below if sin > 0 else -above if sin < 0 else -(above - below) / 2
            offset = (gap * cos, gap * sin + rise)
            align = -1 if cos > 0 else 1 if cos < 0 else 0
            places.append(drawn_text(role, of, text, place, offset, height, tone, align))
            cost.append(preference + further * _FURTHER)
    return Choice(tuple(places), tuple(cost))


def link_names(pose: Pose, measures: Measures) -> list[Choice]:
    """Positions for the names of all links: inside the plate, otherwise next to the bar."""
    tone = tones(pose)
    height = 0.85 * measures.text
    spans: dict[str, list[complex]] = {
        bar.name: [pose.points[name] for name in bar.points] for bar in pose.skeleton.bars
    }
    spans |= {s.name: [pose.points[name] for name in s.between] for s in pose.skeleton.struts}
    found = []
    for name, points in spans.items():
        rounds = _rounds(pose, name)
        if len(set(points)) < 2 and not rounds:
            continue
        outline = convex_outline(points)
        if rounds:
            spots = list(_about_round(rounds, name, height, measures))
        else:
            spots = _beside_bar(outline, name, height, measures)
        if not rounds and not in_line(outline):
            centre = sum(outline) / len(outline)
            spots = [(centre, 0.0), *((spot, cost + 2.0) for spot, cost in spots)]
        text = printed_name(name)
        found.append(places_at(Role.LINK_NAME, name, text, tone.get(name, 1), height, spots))
    return found


def places_along(
    role: Role,
    of: str,
    text: str,
    line: tuple[complex, complex],
    tone: int,
    measures: Measures,
) -> Choice:
    """Positions for a text next to a line."""
    height = 0.85 * measures.text
    spots = _beside_line(*line, text, height, measures)
    return places_at(role, of, text, tone, height, spots)


def places_within(
    role: Role, of: str, text: str, corners: Sequence[complex], tone: int, measures: Measures
) -> Choice:
    """Positions for a text on and around an area; the best is the middle of the given points."""
    height = 0.85 * measures.text
    middle = sum(corners) / len(corners)
    box = Box.around(map(xy, corners))
    shares = [1.5 * k / (_ACROSS - 1) - 0.25 for k in range(_ACROSS)]
    spots = [middle] + [
        complex(box.left + x * box.width, box.bottom + y * box.height)
        for x in shares
        for y in shares
    ]
    reach = max(box.width, box.height) or 1.0
    costs = [2.0 * _FURTHER * abs(spot - middle) / reach for spot in spots]
    return places_at(role, of, text, tone, height, list(zip(spots, costs, strict=True)))


def places_at(
    role: Role, of: str, text: str, tone: int, height: float, spots: Sequence[tuple[complex, float]]
) -> Choice:
    """Positions for a text with its middle at given points, each with its penalty."""
    below = (0.0, -0.3 * height)
    places = tuple(drawn_text(role, of, text, spot, below, height, tone) for spot, _ in spots)
    return Choice(places, tuple(cost for _, cost in spots))


def _rounds(pose: Pose, link: str) -> list[tuple[complex, float]]:
    """Centres and radii of a link's wheels and cams, the largest first."""
    of = pose.skeleton.of
    found = [(d.center, d.radius) for d in of(DiscFigure) if d.link == link and d.kind != "roller"]
    found += [
        (c.center, float(np.abs(np.array(c.points)).max()))
        for c in of(Contour)
        if c.link == link and c.filled
    ]
    return [(pose.points[name], radius) for name, radius in sorted(found, key=lambda r: -r[1])]


def _about_round(
    rounds: list[tuple[complex, float]], name: str, height: float, measures: Measures
) -> Iterator[tuple[complex, float]]:
    """Middles of the name inside the largest wheel or cam of a link, otherwise just outside."""
    centre, radius = rounds[0]
    half_width = text_width(printed_name(name), height) / 2
    for k in range(16):
        way = cmath.exp(1j * math.pi * (k / 8 - 0.5))
        for share in (0.6, 0.45, 0.75):
            if half_width < (1 - share) * radius or 1.2 * half_width < share * radius:
                yield centre + share * radius * way, 0.1 * k
        # extent of a box in a direction: its support function
        clear = abs(way.real) * half_width + abs(way.imag) * 0.5 * height + 1.6 * measures.pin
        yield centre + (radius + clear) * way, _FURTHER + 0.1 * k


def _beside_bar(
    outline: list[complex], name: str, height: float, measures: Measures
) -> list[tuple[complex, float]]:
    """Middles of the name beside the longest side of an outline, with their penalties."""
    sides = list(zip(outline, outline[1:] + outline[:1], strict=True))
    start, end = max(sides, key=lambda side: abs(side[1] - side[0]))
    return _beside_line(start, end, printed_name(name), height, measures)


def _beside_line(
    start: complex, end: complex, text: str, height: float, measures: Measures
) -> list[tuple[complex, float]]:
    """Middles of a text beside a line from start to end, with their penalties."""
    left = (end - start) / abs(end - start) * 1j
    half_width = text_width(text, height) / 2
    clear = abs(left.real) * half_width + abs(left.imag) * 0.5 * height + 0.8 * measures.pin
    return [
        (
            start + share * (end - start) + side * (clear + further * 0.6 * height) * left,
            2 * abs(share - 0.5) + further * _FURTHER,
        )
        for further in range(5)
        for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9)
        for side in (1, -1)
    ]


def placed(
    choices: Sequence[Choice], drawn: Iterable[Primitive], kept: Kept | None = None
) -> list[Text]:
    """The best position for every name, given the drawn parts; as before if all are in ``kept``.

    Notes
    -----
    Each sweep moves every name, in order, to its best position relative to the current others; it
    ends when nothing moves, a local optimum. Four sweeps suffice in practice and bound the time.
    """
    if not choices:
        return []
    kept = {} if kept is None else kept
    keys = [(choice.places[0].role, choice.places[0].of) for choice in choices]
    if kept.keys() >= set(keys):
        return [choice.places[kept[key]] for choice, key in zip(choices, keys, strict=True)]
    obstacles = Obstacles.of(drawn)
    edges = [
        np.array([text.box.grown(_CLEAR * text.height).edges for text in choice.places])
        for choice in choices
    ]
    fixed = [
        np.array(c.cost) + obstacles.costs(e[:, None, :])
        for c, e in zip(choices, edges, strict=True)
    ]
    # Names with the fewest free positions first.
    order = sorted(range(len(choices)), key=lambda k: -float(np.min(fixed[k])))
    taken: dict[int, int] = {}
    for _ in range(4):
        before = dict(taken)
        for k in order:
            # in the first sweep only names placed so far are obstacles
            others = np.array([edges[j][place] for j, place in taken.items() if j != k])
            cost = fixed[k] + _NAME_ON_NAME * _overlaps(edges[k], others.reshape(-1, 4))
            taken[k] = int(np.argmin(cost))
        if taken == before:
            break
    kept.update({key: taken[k] for k, key in enumerate(keys)})
    return [choices[k].places[taken[k]] for k in range(len(choices))]


def _overlaps(boxes: Array, others: Array) -> Array:
    """The number of other boxes (k, 4) that overlap each box (n, 4); left, bottom, right, top."""
    low = np.maximum(boxes[:, None, :2], others[None, :, :2])
    high = np.minimum(boxes[:, None, 2:], others[None, :, 2:])
    shared: Array = np.sum(np.all(high > low, axis=2), axis=1, dtype=float)
    return shared
