"""Names of points with constant positions relative to the points over a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.ground_symbols import DEPTH
from linkwork.drawing.label_placement import Choice, point_names
from linkwork.drawing.link_symbols import pin_radius
from linkwork.drawing.measures import Measures
from linkwork.drawing.obstacles import Obstacles
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Primitive, Text, xy
from linkwork.foundation.arrays import Array

__all__ = ["labels_as_before", "lasting_labels"]

_NAME_ON_NAME = 100.0
_BELOW = 0.4  # penalty for a position under the ground symbol
_CLEAR = 0.12  # margin of every name [em]
_WORST = 0.5  # weight of the worst row in a penalty, relative to the mean of all


def lasting_labels(
    poses: Sequence[Pose],
    drawn: Sequence[Sequence[Primitive]],
    measures: Measures,
) -> list[Text]:
    """The names in the first pose, each in its best position over all poses.

    Parameters
    ----------
    poses, drawn
        Some rows of a motion, and the drawn primitives of each.

    Notes
    -----
    Names are placed one by one and moved until no single move improves the result, as in
    :func:`~linkwork.drawing.label_placement.placed`; the penalty of a position is the mean
    of its penalties in all rows plus a share of the worst.
    """
    rows = [
        [_with_place_below(choice, pose, measures) for choice in point_names(pose, measures)]
        for pose in poses
    ]
    boxes = [_boxes([row[k] for row in rows]) for k in range(len(rows[0]))]
    obstacles = [Obstacles.of(shapes) for shapes in drawn]
    fixed = [
        np.array(choice.cost) + _over_rows(_covered(obstacles, own))
        for choice, own in zip(rows[0], boxes, strict=True)
    ]
    chosen = _settled(fixed, boxes)
    return [choice.places[place] for choice, place in zip(rows[0], chosen, strict=True)]


def labels_as_before(pose: Pose, measures: Measures, before: Sequence[Text]) -> list[Text]:
    """The names of another pose of the mechanism, each in its direction from ``before``."""
    height = measures.text
    return [
        replace(
            text,
            anchor=xy(pose.points[text.of]),
            offset=(text.offset[0] * height / text.height, text.offset[1] * height / text.height),
            height=height,
        )
        for text in before
    ]


def _boxes(choices: Sequence[Choice]) -> Array:
    """The boxes of one name, shape (rows, places, 4)."""
    return np.array([
        [
            text.box.grown(_CLEAR * text.height).edges
            for text in choice.places
        ]
        for choice in choices
    ])  # fmt: skip


def _with_place_below(choice: Choice, pose: Pose, measures: Measures) -> Choice:
    """Add the position under a pivot's ground symbol, which a crank rarely covers."""
    text = choice.places[0]
    if text.of not in pose.skeleton.fixed:
        return choice
    drop = DEPTH * pin_radius(pose, text.of, measures) + 0.5 * measures.pin + 0.76 * text.height
    below = replace(text, offset=(0.0, -drop), align=0)
    return Choice((*choice.places, below), (*choice.cost, _BELOW))


def _covered(obstacles: Sequence[Obstacles], boxes: Array) -> Array:
    """The penalties of a name's positions in every row: boxes (rows, places, 4), (rows, places)."""
    return np.array([o.costs(own[:, None, :]) for o, own in zip(obstacles, boxes, strict=True)])


def _over_rows(cost: Array) -> Array:
    found: Array = (1 - _WORST) * cost.mean(axis=0) + _WORST * cost.max(axis=0)
    return found


def _settled(fixed: Sequence[Array], boxes: Sequence[Array]) -> list[int]:
    """The position of every name given those of the others: a local optimum."""
    chosen: dict[int, int] = {}
    order = sorted(range(len(fixed)), key=lambda k: -float(fixed[k].min()))
    for _ in range(4):
        before = dict(chosen)
        for k in order:
            cost = fixed[k].copy()
            for other, place in chosen.items():
                if other != k:
                    cost += _NAME_ON_NAME * _overlapping(boxes[k], boxes[other][:, place]).mean(0)
            chosen[k] = int(cost.argmin())
        if chosen == before:
            break
    return [chosen[k] for k in range(len(fixed))]


def _overlapping(boxes: Array, others: Array) -> Array:
    """Whether boxes (rows, places, 4) overlap one box per row (rows, 4); shape (rows, places)."""
    other = others[:, None, :]
    return np.asarray(
        (boxes[..., 0] < other[..., 2])
        & (other[..., 0] < boxes[..., 2])
        & (boxes[..., 1] < other[..., 3])
        & (other[..., 1] < boxes[..., 3])
    )
