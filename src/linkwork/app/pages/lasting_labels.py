"""Names of points at constant distances from the points, or from their links, over a motion."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from linkwork.core.drawing.labels import Choice, Obstacles, point_names
from linkwork.core.drawing.links import DEPTH, pin_radius
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import Measures, Primitive, Text, text_width, xy
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray

_NAME_ON_NAME = 100.0
_BELOW = 0.4  # penalty for a position under the ground symbol
_CLEAR = 0.12  # margin of every name [em]
_TURNING = 1.2  # penalty for a position that turns with a link
_FURTHER = 2.0  # penalty for the larger of two distances
_WAYS = 8  # directions from the point relative to a link
_WORST = 0.5  # weight of the worst row in a penalty, relative to the mean of all


def lasting_labels(
    poses: Sequence[Pose],
    drawn: Sequence[Sequence[Primitive]],
    measures: Measures,
) -> list[tuple[Text, str]]:
    """The names in the first pose, each in its best position over all poses.

    Parameters
    ----------
    poses, drawn
        Some rows of a motion, and the drawn primitives of each.

    Returns
    -------
    list of (Text, str)
        Each name, and the link with which its position turns about the point; "" for none.

    Notes
    -----
    Names are placed one by one and moved until no single move improves the result, as in
    :func:`~linkwork.core.drawing.labels.placed`; the penalty of a position is the mean
    of its penalties in all rows plus a share of the worst.
    """
    pose = poses[0]
    names = [_with_more_positions(choice, pose, measures) for choice in point_names(pose, measures)]
    boxes = [_boxes(choice, turns, poses) for choice, turns in names]
    covered = _covered(drawn, boxes)
    fixed = [
        np.array(choice.cost) + _over_rows(cost)
        for (choice, _), cost in zip(names, covered, strict=True)
    ]
    chosen = _settled(fixed, boxes)
    return [
        (choice.places[place], turns[place])
        for (choice, turns), place in zip(names, chosen, strict=True)
    ]


def _boxes(choice: Choice, turns: Sequence[str], poses: Sequence[Pose]) -> Array:
    """The boxes of one name in all poses, shape (rows, places, 4)."""
    name = choice.places[0].of
    edges = np.array([t.box.grown(_CLEAR * t.height).edges for t in choice.places])
    way = np.array([pose.points[name] for pose in poses])
    turned = {turn: _directions(turn, poses) for turn in set(turns)}
    turn = np.stack([turned[turn] for turn in turns], axis=1)  # (rows, places)
    anchors = np.array([complex(*text.anchor) for text in choice.places])
    shift = way[:, None] - way[0] + (anchors - way[0]) * (turn / turn[0] - 1.0)
    moved: Array = edges + np.stack((shift.real, shift.imag, shift.real, shift.imag), axis=-1)
    return moved


def _directions(link: str, poses: Sequence[Pose]) -> ComplexArray:
    """The unit vectors of a link in all poses; constant without a link."""
    if not link:
        return np.ones(len(poses), dtype=complex)
    bar = next(bar for bar in poses[0].skeleton.bars if bar.name == link)
    start, end = list(dict.fromkeys(bar.points))[:2]
    along = np.array([pose.points[end] - pose.points[start] for pose in poses])
    return np.asarray(along / np.abs(along))


def _with_more_positions(
    choice: Choice, pose: Pose, measures: Measures
) -> tuple[Choice, tuple[str, ...]]:
    """More positions for a motion, and the link with which each one turns.

    The name of a pivot may be under its ground symbol, which a crank rarely covers; that of a
    moving point may turn with a link, which then never covers it.
    """
    text = choice.places[0]
    places, cost = list(choice.places), list(choice.cost)
    turns = [""] * len(places)
    if text.of in pose.skeleton.fixed:
        drop = DEPTH * pin_radius(pose, text.of, measures) + 0.5 * measures.pin + 0.76 * text.height
        for further in range(3):
            low = (0.0, -drop - further * text.height)
            places.append(replace(text, offset=low, align=0))
            cost.append(_BELOW + _FURTHER * further)
        return Choice(tuple(places), tuple(cost)), (*turns, "", "", "")
    point = pose.points[text.of]
    reach = math.hypot(text_width(text.text, text.height), 0.92 * text.height) / 2
    for bar in pose.skeleton.bars:
        ends = [pose.points[name] for name in dict.fromkeys(bar.points)]
        if text.of not in bar.points or len(ends) < 2 or ends[0] == ends[1]:
            continue
        along = (ends[1] - ends[0]) / abs(ends[1] - ends[0])
        for further, k in product(range(2), range(_WAYS)):
            away = (1.2 + 1.5 * further) * measures.pin + reach
            anchor = xy(point + away * along * cmath.exp(2j * cmath.pi * k / _WAYS))
            middle = (0.0, -0.3 * text.height)
            places.append(replace(text, anchor=anchor, offset=middle, align=0))
            cost.append(_TURNING + _FURTHER * further)
            turns.append(bar.name)
    return Choice(tuple(places), tuple(cost)), tuple(turns)


def _covered(drawn: Sequence[Sequence[Primitive]], boxes: Sequence[Array]) -> list[Array]:
    """The penalties of every name's positions in every row, each (rows, places)."""
    every = np.concatenate(boxes, axis=1)
    cost = [
        Obstacles.of(shapes).costs(candidates[:, None, :])
        for shapes, candidates in zip(drawn, every, strict=True)
    ]
    return np.split(np.array(cost), np.cumsum([b.shape[1] for b in boxes])[:-1], axis=1)


def _over_rows(cost: Array) -> Array:
    total: Array = (1 - _WORST) * cost.mean(axis=0) + _WORST * cost.max(axis=0)
    return total


def _settled(fixed: Sequence[Array], boxes: Sequence[Array]) -> list[int]:
    """The position of every label, the better of two local optima.

    Names with the fewest free positions are placed first, or last.
    """
    order = sorted(range(len(fixed)), key=lambda k: -float(fixed[k].min()))
    near = _neighbours(boxes)
    tried = [_descended(fixed, boxes, near, one) for one in (order, order[::-1])]
    return min(tried, key=lambda pair: pair[0])[1]


def _descended(
    fixed: Sequence[Array], boxes: Sequence[Array], near: BoolArray, order: Sequence[int]
) -> tuple[float, list[int]]:
    """The penalty and the positions of names placed in an order, then moved one by one."""
    chosen: dict[int, int] = {}
    total = 0.0
    for _ in range(4):
        before, total = dict(chosen), 0.0
        for k in order:
            cost = fixed[k].copy()
            for other, place in chosen.items():
                if near[k, other]:
                    shared = _overlapping(boxes[k], boxes[other][:, place])
                    cost += _NAME_ON_NAME * _over_rows(shared.astype(float))
            chosen[k] = int(cost.argmin())
            total += float(cost.min())
        if chosen == before:
            break
    return total, [chosen[k] for k in range(len(fixed))]


def _neighbours(boxes: Sequence[Array]) -> BoolArray:
    """Whether any positions of two different names can overlap in a row, (n, n)."""
    around = np.stack([
        np.concatenate((box[..., :2].min(axis=1), box[..., 2:].max(axis=1)), axis=-1)
        for box in boxes
    ], axis=1)  # fmt: skip
    near = np.stack([_overlapping(around, box).any(axis=0) for box in around.swapaxes(0, 1)])
    return np.asarray(near & ~np.eye(len(boxes), dtype=bool))


def _overlapping(boxes: Array, others: Array) -> BoolArray:
    """Whether boxes (rows, places, 4) overlap one box per row (rows, 4); shape (rows, places)."""
    other = others[:, None, :]
    return np.asarray(
        (boxes[..., 0] < other[..., 2])
        & (other[..., 0] < boxes[..., 2])
        & (boxes[..., 1] < other[..., 3])
        & (other[..., 1] < boxes[..., 3])
    )
