"""The chart of a front: what a better value of the first goal costs in the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from linkwork.drawing.charts.chart import Axis, Chart, Curve, Mark, Panel
from linkwork.foundation.arrays import Array

__all__ = ["front_chart"]

_TEXTS = 24  # numbers of designs that are written
_UP_RIGHT = (0.7, 0.7)


def front_chart(title: str, goals: Mapping[str, Sequence[float]], numbers: Sequence[int]) -> Chart:
    """The misses of the first goal against those of each other one.

    Parameters
    ----------
    title : str
    goals : Mapping[str, sequence of number]
        The misses of every goal, in the order of the designs.
    numbers : sequence of int
        The numbers of the designs.
    """
    (name, first), *others = ((name, np.array(own)) for name, own in goals.items())
    panels = tuple(
        Panel(
            axis=Axis(label=f"miss of {other}"),
            curves=(_curve(first, own, stairs=len(others) == 1),),
            marks=tuple(_marks(first, own, numbers)),
        )
        for other, own in others
    )
    count = len(numbers)
    return Chart(
        title=title,
        caption=f"front of {count} design{'' if count == 1 else 's'}: "
        "no other one is better in every goal",
        axis=Axis(label=f"miss of {name}"),
        panels=panels,
        legend=(),
    )


def _curve(x: Array, y: Array, *, stairs: bool) -> Curve:
    """Stairs through the designs, each of which is the best one until the next; or no line.

    Pieces of two points stay straight, and those of one point are dots.
    """
    if stairs:
        gap = np.full(len(x) - 1, np.nan)
        along = np.stack([x[:-1], x[1:], gap, x[1:], x[1:], gap], axis=1)
        across = np.stack([y[:-1], y[:-1], gap, y[:-1], y[1:], gap], axis=1)
    else:
        gap = np.full(len(x), np.nan)
        along, across = np.stack([x, gap], axis=1), np.stack([y, gap], axis=1)
    return Curve(x=along.ravel(), y=across.ravel(), tone=1, name="front", quiet=True)


def _marks(x: Array, y: Array, numbers: Sequence[int]) -> list[Mark]:
    every = -(-len(numbers) // _TEXTS)
    return [
        Mark(
            x=float(x[k]),
            y=float(y[k]),
            tone=1,
            kind="station",
            text="" if k % every else str(number),
            away=_UP_RIGHT,
        )
        for k, number in enumerate(numbers)
    ]
