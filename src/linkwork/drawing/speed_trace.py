"""The paths of points coloured by speed, with a colour scale."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from linkwork.drawing.annotation import Annotation
from linkwork.drawing.box import Box
from linkwork.drawing.captions import printed_name
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.rate_arrows import rate_of, usual_most
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, Text, xy
from linkwork.drawing.smooth_path import UNSEEN, smoothed
from linkwork.foundation.arrays import Array
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["colour_scale", "speed_traces"]

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
    return [
        Polyline(
            role=Role.SPEED_TRACE,
            of=name,
            level=(int(level) + 0.5) / _CLASSES,
            points=tuple(map(xy, smoothed(path[run], unseen, first[run], second[run]))),
        )
        for run, level in runs
    ]


def colour_scale(
    motion: Motion, names: Sequence[str], most: float, more: bool, below: Box, measures: Measures
) -> Annotation:
    """A bar of all colours under the drawing, from 0 to the speed of the last colour."""
    height, length = 0.6 * measures.text, _LONG * measures.size
    left = below.left
    top = below.bottom - 1.2 * measures.text
    bottom = top - height
    step = length / _CLASSES
    bar: list[Primitive] = [
        Polygon(
            role=Role.SCALE,
            of="speed",
            level=(k + 0.5) / _CLASSES,
            points=(
                (left + k * step, bottom),
                (left + (k + 1) * step, bottom),
                (left + (k + 1) * step, top),
                (left + k * step, top),
            ),
        )
        for k in range(_CLASSES)
    ]
    rate = rate_of(1, motion.speed is not None)
    unit = rate.unit(Kind.LENGTH, motion.units, motion.derivative_unit)
    mark = "\u2265 " if more else ""
    said = f"{mark}{float(f'{most:.3g}'):g} {unit}  speed of "
    said += ", ".join(map(printed_name, names))
    size = 0.8 * measures.text
    base = bottom + 0.5 * height - 0.3 * size
    texts = [
        _text("0", (left - 0.4 * size, base), 1, size),
        _text(said, (left + length + 0.4 * size, base), -1, size),
    ]
    return Annotation(drawn=[*bar, *texts])


def _text(text: str, at: tuple[float, float], align: int, height: float) -> Text:
    return Text(
        role=Role.SCALE_NAME,
        of="speed",
        text=text,
        anchor=at,
        offset=(0.0, 0.0),
        height=height,
        align=align,
    )
