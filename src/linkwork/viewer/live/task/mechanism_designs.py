"""Designs of any kind of mechanism as the page shows them: a skeleton that moves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from linkwork.design.defects.judged_design import JudgedDesign
from linkwork.design.synthesis.advice import remark_on
from linkwork.design.synthesis.improved_mechanism import ImprovedMechanism
from linkwork.foundation.arrays import Array, ComplexArray, CountArray
from linkwork.mechanism.figures import Disc
from linkwork.mechanism.skeleton import Skeleton
from linkwork.results.motion import Motion
from linkwork.viewer.live import events as tell
from linkwork.viewer.live.task_events import DesignShown, SkeletonShown

__all__ = ["design_shown", "finite", "mechanism_found", "pieces"]

_ROWS = 181  # of a motion


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
    design: ImprovedMechanism,
    shown: DesignShown,
    point: str = "",
    inputs: tuple[float, ...] = (),
) -> tell.DesignFound:
    """A design with the rows of its table that have a position; ``point`` draws its path,
    ``inputs`` are those at the positions, by default the improved ones.
    """
    found = tell.DesignFound(
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
        return found
    own = np.flatnonzero(motion.found)
    rows = own[np.linspace(0, len(own) - 1, min(_ROWS, len(own))).round().astype(int)]
    names = list(motion.points)
    places = np.array([motion.trace(name)[rows] for name in names])
    table = np.stack([places.real, places.imag], axis=1).reshape(2 * len(names), len(rows))
    traced = point or next(iter(motion.skeleton.traced), "")
    return replace(
        found,
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
            if isinstance(disc, Disc)
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
