"""Names of points that keep their place beside the point over a whole motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.label_placement import Choice, point_names
from linkwork.drawing.measures import Measures
from linkwork.drawing.obstacles import Obstacles
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Primitive, Text, xy
from linkwork.foundation.arrays import Array

__all__ = ["labels_as_before", "lasting_labels"]

_NAME_ON_NAME = 100.0
_CLEAR = 0.12  # left free around every name [em]
_WORST = 0.5  # share of the worst row in the penalty of a place, beside the mean of all


def lasting_labels(
    poses: Sequence[Pose],
    drawn: Sequence[Sequence[Primitive]],
    measures: Measures,
) -> list[Text]:
    """The names in the first pose, each in the place that is best over all poses.

    Parameters
    ----------
    poses, drawn
        Some rows of a motion, and what is drawn in each.

    Notes
    -----
    Names are placed one by one and moved until none can do better alone, as in
    :func:`~linkwork.drawing.label_placement.placed`; the penalty of a place is the mean of its
    penalties in all rows, and some of the worst.
    """
    rows = [point_names(pose, measures) for pose in poses]
    boxes = [_boxes([row[k] for row in rows]) for k in range(len(rows[0]))]
    # (rows, names, places): what every place of every name covers
    cost = np.array([
        _covered(Obstacles.of(shapes), [own[row] for own in boxes])
        for row, shapes in enumerate(drawn)
    ])  # fmt: skip
    fixed = [np.array(choice.cost) + _over_rows(cost[:, k]) for k, choice in enumerate(rows[0])]
    chosen = _settled(fixed, boxes)
    return [choice.places[place] for choice, place in zip(rows[0], chosen, strict=True)]


def labels_as_before(pose: Pose, measures: Measures, before: Sequence[Text]) -> list[Text]:
    """The names of a pose of the same mechanism, each in the direction that it had ``before``."""
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


def _covered(obstacles: Obstacles, boxes: Sequence[Array]) -> Array:
    """What the places (p, 4) of each of n names cover, (n, p)."""
    return np.array([obstacles.costs(own[:, None, :]) for own in boxes])


def _over_rows(cost: Array) -> Array:
    found: Array = (1 - _WORST) * cost.mean(axis=0) + _WORST * cost.max(axis=0)
    return found


def _settled(fixed: Sequence[Array], boxes: Sequence[Array]) -> list[int]:
    """The place of every name, against the others where they stand: a local optimum."""
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
    """Whether boxes (rows, places, 4) meet one box per row (rows, 4); shape (rows, places)."""
    other = others[:, None, :]
    return np.asarray(
        (boxes[..., 0] < other[..., 2])
        & (other[..., 0] < boxes[..., 2])
        & (boxes[..., 1] < other[..., 3])
        & (other[..., 1] < boxes[..., 3])
    )
