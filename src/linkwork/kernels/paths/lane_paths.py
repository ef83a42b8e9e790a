"""Following solution paths: every lane has a path of its own, with steps of its own.

A lane whose path has ended takes the next one, so that no lane waits for another.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from linkwork.foundation.arrays import Array, CountArray, IndexArray, StatusArray
from linkwork.kernels.paths.lane_elimination import solve_in_lanes
from linkwork.kernels.paths.path_program import Layout
from linkwork.kernels.program.compiling import compiled, compiled_for, named_tuple, types
from linkwork.kernels.program.interpreter import LANES, run_part
from linkwork.kernels.program.kernel_cache import PATH_LOOP, say_that_it_compiles
from linkwork.kernels.program.program import Code
from linkwork.marching import solution_path
from linkwork.marching.step_size import HALF

__all__ = ["Care", "PathEnds", "follow_paths"]

say_that_it_compiles(PATH_LOOP)

_cubic_weights = compiled(solution_path.cubic_weights)
_is_good = compiled(solution_path.is_good)
_step_factor = compiled(solution_path.step_factor)
_is_singular = compiled(solution_path.is_singular)
_FIRST_STEP, _NEAR = solution_path.FIRST_STEP, solution_path.NEAR
_ARRIVED, _SINGULAR, _LOST = solution_path.ARRIVED, solution_path.SINGULAR, solution_path.LOST
_SMALLEST = solution_path.SMALLEST_CHANGE
_NO_PATH = -1
_VECTOR = 8  # lanes that a processor computes at once


class PathLanes(NamedTuple):
    """The state of every lane.

    ``path`` (4, 2n, LANES): here, slope, the point before, slope there. (LANES,): ``step``, the
    next one; ``gone``, the last one; ``sigma`` here; ``error`` of an attempt; ``task``, the path's
    number; ``tried``, attempts; ``again``, whether the path was lost once; ``best``, ``row``: for
    the elimination.
    """

    path: Array
    step: Array
    gone: Array
    sigma: Array
    error: Array
    task: IndexArray
    tried: CountArray
    again: CountArray
    best: Array
    row: IndexArray


class PathEnds(NamedTuple):
    """Ends of B paths: ``w``, ``near`` (2n, B), ``state``, ``attempts`` (B,)."""

    w: Array
    near: Array
    state: StatusArray
    attempts: CountArray


class Care(NamedTuple):
    """The numbers of :class:`~linkwork.marching.solution_path.PathOptions`."""

    error: float
    contraction: float
    rounding: float
    floor: float
    attempts: float
    smallest: float


_NUMBERS, _WHOLE = types.Array(types.float64, 1, "C"), types.Array(types.int64, 1, "C")
_TABLE = types.Array(types.float64, 2, "C")
_LAYOUT = named_tuple([types.int64] * len(Layout._fields), Layout)
_CARE = named_tuple([types.float64] * len(Care._fields), Care)
_ENDS = named_tuple([_TABLE, _TABLE, types.Array(types.int8, 1, "C"), _WHOLE], PathEnds)


@compiled
def _take_path(lanes: PathLanes, i: int, task: int, start: Array, again: int) -> None:
    """Give a lane a path; its first attempt, without a step, finds the slope."""
    lanes.task[i], lanes.tried[i], lanes.again[i] = task, 0, again
    lanes.sigma[i], lanes.step[i], lanes.gone[i] = 1.0, 0.0, 0.0
    for k in range(start.shape[0]):
        lanes.path[0, k, i] = start[k, task]
        lanes.path[1, k, i] = 0.0


@compiled
def _predict(w: Array, at: Layout, lanes: PathLanes, width: int) -> None:
    """Put the predicted points and their σ into the registers."""
    path = lanes.path
    for i in range(width):
        here, step, gone = lanes.sigma[i], lanes.step[i], lanes.gone[i]
        h = min(step, here)
        # exactly 0: the last system is the one that was asked for
        w[at.sigma, i] = 0.0 if here <= step else here - h
        if gone > 0.0:
            a, b, c, d = _cubic_weights(h / gone)
            b, d = b * gone, d * gone
        else:  # a line
            a, b, c, d = 1.0, -h, 0.0, 0.0
        for k in range(2 * at.unknowns):
            w[at.point + k, i] = (
                a * path[0, k, i] + b * path[1, k, i] + c * path[2, k, i] + d * path[3, k, i]
            )


@compiled
def _correct(code: Code, w: Array, at: Layout, lanes: PathLanes, width: int) -> None:
    """Newton's step in all lanes; ∂H/∂σ becomes the slope."""
    run_part(code, 0, code.shape[0], w, width)
    solve_in_lanes(w, at.unknowns, at.jacobian, at.value, at.change, lanes.best, lanes.row, width)
    for k in range(2 * at.unknowns):
        for i in range(width):
            w[at.point + k, i] -= w[at.value + k, i]


@compiled
def _relative_size(w: Array, at: Layout, floor: float, i: int) -> float:
    """The last correction of a lane, relative to the size of the point."""
    largest, size = 0.0, 1.0
    for k in range(0, 2 * at.unknowns, 2):
        own = math.sqrt(w[at.point + k, i] ** 2 + w[at.point + k + 1, i] ** 2)
        error = math.sqrt(w[at.value + k, i] ** 2 + w[at.value + k + 1, i] ** 2)
        if floor > 0.0:
            error /= floor + own
        elif own + 1.0 > size:
            size = own + 1.0
        if error > largest or error != error:
            largest = error
    return largest / size


@compiled
def _take_step(w: Array, at: Layout, lanes: PathLanes, i: int, ends: PathEnds) -> None:
    """The corrected point becomes the point of the path."""
    path, task, goal = lanes.path, lanes.task[i], w[at.sigma, i]
    passes = lanes.sigma[i] > _NEAR and goal <= _NEAR
    for k in range(2 * at.unknowns):
        path[2, k, i], path[3, k, i] = path[0, k, i], path[1, k, i]
        path[0, k, i], path[1, k, i] = w[at.point + k, i], -w[at.change + k, i]  # eq. (49)
        if passes:
            ends.near[k, task] = path[0, k, i]
    lanes.gone[i], lanes.sigma[i] = lanes.sigma[i] - goal, goal


@compiled
def _judge(w: Array, at: Layout, lanes: PathLanes, i: int, care: Care, ends: PathEnds) -> None:
    """Take a lane's step or shorten it."""
    e1, e2 = lanes.error[i], _relative_size(w, at, care.floor, i)
    goal = w[at.sigma, i]
    if lanes.tried[i] == 0:
        _take_step(w, at, lanes, i, ends)
        lanes.step[i] = _FIRST_STEP
        return
    good = _is_good(e1, e2, goal == 0.0, care.error, care.contraction, care.rounding)
    factor = _step_factor(e1, care.error)
    if not factor > 0.0:
        # a singular Jacobian on the way: try a shorter step
        factor = _SMALLEST
    h = lanes.sigma[i] - goal
    lanes.step[i] = h * (factor if good else min(factor, HALF))
    if good:
        _take_step(w, at, lanes, i, ends)


@compiled
def _has_ended(lanes: PathLanes, i: int, care: Care, ends: PathEnds) -> bool:
    """Whether a lane's path has ended; its end is stored then."""
    sigma, task = lanes.sigma[i], lanes.task[i]
    arrived = sigma == 0.0
    stuck = not arrived and lanes.step[i] < care.smallest * sigma
    singular = not arrived and _is_singular(stuck, sigma)
    if not (arrived or stuck or singular or lanes.tried[i] >= care.attempts):
        return False
    ends.state[task] = _ARRIVED if arrived else _SINGULAR if singular else _LOST
    ends.attempts[task] = lanes.tried[i]
    for k in range(lanes.path.shape[1]):
        ends.w[k, task] = lanes.path[0, k, i]
    return True


@compiled
def _close_ranks(lanes: PathLanes, width: int) -> int:
    """Move the paths that are left into the first lanes; how many lanes they take."""
    first = 0
    for i in range(width):
        task = lanes.task[i]
        if task == _NO_PATH:
            continue
        if i != first:
            lanes.task[first], lanes.tried[first] = task, lanes.tried[i]
            lanes.again[first] = lanes.again[i]
            lanes.sigma[first], lanes.step[first] = lanes.sigma[i], lanes.step[i]
            lanes.gone[first] = lanes.gone[i]
            for j in range(4):
                for k in range(lanes.path.shape[1]):
                    lanes.path[j, k, first] = lanes.path[j, k, i]
        first += 1
    for i in range(first, width):
        lanes.task[i] = _NO_PATH
    return int(_VECTOR * ((first + _VECTOR - 1) // _VECTOR))


@compiled_for(
    types.void(
        types.Array(types.uint32, 2, "C"), _LAYOUT, _TABLE, _TABLE, _CARE, _CARE, _ENDS,
    )
)  # fmt: skip
def follow_paths(
    code: Code, at: Layout, w: Array, start: Array, care: Care, more: Care, ends: PathEnds
) -> None:
    """Follow all paths from their ``start`` (2n, B) at σ = 1 to σ = 0.

    ``w`` (R, LANES): a workspace with constants and parameters in place; ``more``: for paths that
    are lost with ``care``.
    """
    lanes = PathLanes(
        np.zeros((4, 2 * at.unknowns, LANES)),
        np.zeros(LANES), np.zeros(LANES), np.ones(LANES), np.zeros(LANES),
        np.full(LANES, _NO_PATH), np.zeros(LANES, np.int64), np.zeros(LANES, np.int64),
        np.zeros(LANES), np.zeros(LANES, np.int64),
    )  # fmt: skip
    following, busy = int(np.int64(0)), int(np.int64(0))
    width = min(LANES, _VECTOR * ((start.shape[1] + _VECTOR - 1) // _VECTOR))
    for i in range(width):
        # idle lanes compute with the first path
        _take_path(lanes, i, min(following, start.shape[1] - 1), start, 0)
        if following < start.shape[1]:
            following, busy = following + 1, busy + 1
        else:
            lanes.task[i] = _NO_PATH
    while busy > 0:
        _predict(w, at, lanes, width)
        _correct(code, w, at, lanes, width)
        for i in range(width):
            lanes.error[i] = _relative_size(w, at, care.floor, i)
        _correct(code, w, at, lanes, width)
        for i in range(width):
            if lanes.task[i] == _NO_PATH:
                continue
            own = more if lanes.again[i] else care
            _judge(w, at, lanes, i, own, ends)
            lanes.tried[i] += 1
            if _has_ended(lanes, i, own, ends):
                lost = ends.state[lanes.task[i]] == _LOST
                if lost and not lanes.again[i] and more.error < care.error:
                    # at once: later, few paths in many lanes would take long
                    _take_path(lanes, i, lanes.task[i], start, 1)
                elif following < start.shape[1]:
                    _take_path(lanes, i, following, start, 0)
                    following += 1
                else:
                    lanes.task[i], busy = _NO_PATH, busy - 1
        if busy <= width - _VECTOR:
            width = _close_ranks(lanes, width)
