"""Where a branch ends: dead points with the loop that locks and the links that line up."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.status import Status
from linkwork.motion.model import Model
from linkwork.numerics.change_point import ChangePoint, locate_change_point
from linkwork.numerics.dead_point import DeadPoint, locate_dead_point
from linkwork.numerics.track import End, InputPath, Track
from linkwork.results.motion import Limit, LimitKind

__all__ = ["limits_of"]

_IN_LINE = 1e-6  # rad: links are in line at a dead point to the square root of rounding or better


def limits_of(model: Model, path: InputPath, track: Track, lead: int) -> tuple[Limit, ...]:
    """The ends that a track met before its goals, in everyday units, lower one first."""
    found = []
    for end, side in ((track.below, -1.0), (track.above, 1.0)):
        if end is not None:
            found.append(_limit(model, path, track, end, side, lead))
    return tuple(found)


def _limit(model: Model, path: InputPath, track: Track, end: End, side: float, lead: int) -> Limit:
    scale = model.input_scale[lead]
    last = track.nodes[-1] if side > 0 else track.nodes[0]
    solver = model.compiled.solver
    crossing = dead = None
    if end.status is not Status.START_SINGULAR:
        crossing = locate_change_point(solver, path, last, side)
        dead = locate_dead_point(solver, path, last, side) if crossing is None else None
    if crossing is not None:
        found = _located(model, crossing, LimitKind.CHANGE_POINT, Status.CHANGE_POINT, scale)
        return replace(
            found,
            onward=_rates(model, crossing.onward),
            other=_rates(model, crossing.other),
        )
    if dead is not None and (dead.located or end.status is Status.OUT_OF_REACH):
        return _located(model, dead, LimitKind.DEAD_POINT, Status.OUT_OF_REACH, scale)
    edges = sorted((end.reached, end.failed))
    return Limit(
        kind=LimitKind.UNKNOWN,
        input=float(end.reached / scale),
        bracket=(float(edges[0] / scale), float(edges[1] / scale)),
        located=False,
        status=end.status,
    )


def _located(
    model: Model, point: DeadPoint | ChangePoint, kind: LimitKind, status: Status, scale: float
) -> Limit:
    block = model.compiled.solver.blocks[point.block]
    low, high = (edge / scale for edge in point.bracket)
    short = round(point.t / scale, 9)
    return Limit(
        kind=kind,
        input=float(short if low <= short <= high else point.t / scale) + 0.0,
        bracket=(float(point.bracket[0] / scale), float(point.bracket[1] / scale)),
        located=bool(point.located),
        status=status,
        loops=tuple(model.equations.labels[e] for e in block.equations),
        in_line=_in_line(model, point, block.unknowns),
    )


def _rates(model: Model, rates: Array) -> dict[str, float]:
    """Derivatives of the unknowns that take part, by name."""
    return {
        variable.name: float(rate)
        for variable, rate in zip(model.equations.unknowns, rates, strict=False)
        if np.isfinite(rate)
    }


def _in_line(model: Model, point: DeadPoint | ChangePoint, unknowns: IndexArray) -> tuple[str, ...]:
    """The links of the locked block whose directions agree up to half turns."""
    equations = model.equations
    angles = [int(k) for k in unknowns if equations.unknowns[int(k)].kind == "angle"]
    names: list[str] = []
    for i, a in enumerate(angles):
        for b in angles[i + 1 :]:
            gap = math.remainder(float(point.v[a] - point.v[b]), math.pi)
            if abs(gap) < _IN_LINE:
                names += [equations.unknowns[k].name for k in (a, b)]
    return tuple(np.unique(names).tolist()) if names else ()
