"""A homotopy as a program over lanes: every lane is at a point of a path of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from linkwork.circuits.homotopy.path_tracking import (
    ARRIVED,
    FIRST_STEP,
    LOST,
    NEAR,
    SINGULAR,
    SMALLEST_CHANGE,
    PathOptions,
    cubic_weights,
    is_good,
    is_singular,
    step_factor,
)
from linkwork.core.foundation.arrays import Array, ComplexArray, CountArray, IndexArray, StatusArray
from linkwork.core.foundation.loading import share_out
from linkwork.core.numerics.marching import HALF
from linkwork.core.record.recorder import (
    LANES,
    Code,
    ComplexRecorder,
    Program,
    Recorder,
    Registers,
    lower_program,
    reserve,
)
from linkwork.families.compiled.code_cache import PATH_LOOP, say_that_it_compiles
from linkwork.families.compiled.compiling import (
    compiled,
    compiled_for,
    named_tuple,
    njit_no_refcount,
    numbers,
    types,
    wholes,
)
from linkwork.families.compiled.interpreter import run_part


class Recordable(Protocol):
    """A homotopy H(w, σ) = 0 that is computed with operators alone."""

    @property
    def unknowns(self) -> int:
        """n."""

    @property
    def parameters(self) -> int:
        """Complex numbers that all paths share."""

    def compute(
        self, w: Sequence[Any], sigma: Any, parameters: Sequence[Any]
    ) -> tuple[Sequence[Any], Sequence[Sequence[Any]], Sequence[Any]]:
        """H (n), ∂H/∂w (n rows of n) and ∂H/∂σ (n)."""


class Layout(NamedTuple):
    """Registers of a path program: σ, and the first of w, H, ∂H/∂σ and ∂H/∂w (row by row).

    Complex numbers take two registers each, one after the other.
    """

    unknowns: int
    sigma: int
    point: int
    value: int
    change: int
    jacobian: int


@dataclass(frozen=True, kw_only=True, eq=False)
class PathProgram:
    """The program of a homotopy; ``parameters`` (2 P,): their registers."""

    program: Program
    registers: Registers
    layout: Layout
    parameters: IndexArray


def record_homotopy(homotopy: Recordable) -> PathProgram:
    """Record a homotopy; the same program serves all values of its parameters."""
    n, count = homotopy.unknowns, homotopy.parameters
    rec, registers = Recorder(), Registers()
    numbers = ComplexRecorder(rec)
    sigma = registers.of("sigma")
    point, value, change = (_pairs(registers, name, n) for name in ("w", "h", "c"))
    jacobian = _pairs(registers, "j", n * n)
    given = _pairs(registers, "p", count)
    h, slopes, rates = homotopy.compute(
        [numbers.input(f"w{k}") for k in range(n)],
        numbers.real("sigma"),
        [numbers.input(f"p{k}") for k in range(count)],
    )
    for k in range(n):
        numbers.write(f"h{k}", h[k])
        numbers.write(f"c{k}", rates[k])
        for i in range(n):
            numbers.write(f"j{k * n + i}", slopes[k][i])
    reserve(rec, registers)
    return PathProgram(
        program=lower_program(rec, registers, registers.count),
        registers=registers,
        layout=Layout(n, sigma, point, value, change, jacobian),
        parameters=registers.all_of(f"p{k}.{part}" for k in range(count) for part in ("re", "im"))
        if count
        else registers.all_of(()) + given,
    )


def _pairs(registers: Registers, name: str, count: int) -> int:
    """Registers for complex numbers, one after the other; the first of them."""
    first = registers.count
    for k in range(count):
        registers.of(f"{name}{k}.re")
        registers.of(f"{name}{k}.im")
    return first


# ----------------------------------------------------------------------
# Complex linear systems side by side in the lanes: Gauss's elimination, pivots chosen by lane.


@njit_no_refcount
def _subtract(w: Array, target: int, factor: int, source: int, lanes: int) -> None:
    """target -= factor * source, complex."""
    for i in range(lanes):
        a, b, c, d = w[factor, i], w[factor + 1, i], w[source, i], w[source + 1, i]
        w[target, i] -= a * c - b * d
        w[target + 1, i] -= a * d + b * c


@njit_no_refcount
def _multiply(w: Array, target: int, factor: int, lanes: int) -> None:
    """target *= factor, complex."""
    for i in range(lanes):
        a, b, c, d = w[factor, i], w[factor + 1, i], w[target, i], w[target + 1, i]
        w[target, i] = a * c - b * d
        w[target + 1, i] = a * d + b * c


@njit_no_refcount
def _invert(w: Array, target: int, lanes: int) -> None:
    """target = 1 / target, complex."""
    for i in range(lanes):
        a, b = w[target, i], w[target + 1, i]
        size = 1.0 / (a * a + b * b)
        w[target, i], w[target + 1, i] = a * size, -b * size


@njit_no_refcount
def _choose_pivots(
    w: Array, n: int, matrix: int, k: int, best: Array, row: IndexArray, lanes: int
) -> None:
    """The row (LANES,) of the largest number in the column k, from the row k on."""
    for i in range(lanes):
        a, b = w[matrix + 2 * (k * n + k), i], w[matrix + 2 * (k * n + k) + 1, i]
        best[i], row[i] = a * a + b * b, k
    for j in range(k + 1, n):
        place = matrix + 2 * (j * n + k)
        for i in range(lanes):
            a, b = w[place, i], w[place + 1, i]
            size = a * a + b * b
            larger = size > best[i]
            best[i] = size if larger else best[i]
            row[i] = j if larger else row[i]


@njit_no_refcount
def _exchange(w: Array, one: int, other: int, count: int, lane: int) -> None:
    """Exchange numbers from two registers on in one lane."""
    for k in range(count):
        w[one + k, lane], w[other + k, lane] = w[other + k, lane], w[one + k, lane]


@njit_no_refcount
def solve_in_lanes(
    w: Array, n: int, matrix: int, right: int, other: int, best: Array, row: IndexArray, lanes: int
) -> None:
    """Solve for two right sides, which the solutions replace; the matrix is used up.

    Parameters
    ----------
    w : (R, LANES)
    matrix, right, other : int
        The first register of the matrix, row by row, and of both right sides.
    best, row : (LANES,)
        Work arrays.
    lanes : int
        The first lanes, in which there is something to solve.
    """
    for k in range(n):
        _choose_pivots(w, n, matrix, k, best, row, lanes)
        own = matrix + 2 * k * n
        for i in range(lanes):
            if row[i] != k:
                there = row[i]
                _exchange(w, own + 2 * k, matrix + 2 * (there * n + k), 2 * (n - k), i)
                _exchange(w, right + 2 * k, right + 2 * there, 2, i)
                _exchange(w, other + 2 * k, other + 2 * there, 2, i)
        _invert(w, own + 2 * k, lanes)
        for column in range(k + 1, n):
            _multiply(w, own + 2 * column, own + 2 * k, lanes)
        _multiply(w, right + 2 * k, own + 2 * k, lanes)
        _multiply(w, other + 2 * k, own + 2 * k, lanes)
        for j in range(k + 1, n):
            lower = matrix + 2 * (j * n + k)
            for column in range(k + 1, n):
                _subtract(w, matrix + 2 * (j * n + column), lower, own + 2 * column, lanes)
            _subtract(w, right + 2 * j, lower, right + 2 * k, lanes)
            _subtract(w, other + 2 * j, lower, other + 2 * k, lanes)
    for k in range(n - 1, -1, -1):
        for j in range(k):
            upper = matrix + 2 * (j * n + k)
            _subtract(w, right + 2 * j, upper, right + 2 * k, lanes)
            _subtract(w, other + 2 * j, upper, other + 2 * k, lanes)


# ----------------------------------------------------------------------
# Following solution paths: every lane has a path of its own, with steps of its own.
#
# A lane whose path has ended takes the next one, so that no lane waits for another.


say_that_it_compiles(PATH_LOOP)

_cubic_weights = compiled(cubic_weights)
_is_good = compiled(is_good)
_step_factor = compiled(step_factor)
_is_singular = compiled(is_singular)
_FIRST_STEP, _NEAR = FIRST_STEP, NEAR
_ARRIVED, _SINGULAR, _LOST = ARRIVED, SINGULAR, LOST
_SMALLEST = SMALLEST_CHANGE
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
    """The numbers of :class:`~linkwork.circuits.homotopy.path_tracking.PathOptions`."""

    error: float
    contraction: float
    rounding: float
    floor: float
    attempts: float
    smallest: float


_LAYOUT = named_tuple([types.int64] * len(Layout._fields), Layout)
_CARE = named_tuple([types.float64] * len(Care._fields), Care)
_ENDS = named_tuple([numbers(2), numbers(2), types.Array(types.int8, 1, "C"), wholes(1)], PathEnds)


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
        types.Array(types.uint32, 2, "C"), _LAYOUT, numbers(2), numbers(2), _CARE, _CARE, _ENDS
    )
)
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


# ----------------------------------------------------------------------
# The compiled tracker of one homotopy: it follows solution paths for any parameters.


class PathKernel:
    """The compiled tracker of one homotopy.

    Parameters
    ----------
    homotopy : Recordable
        Its arithmetic is recorded once.
    """

    def __init__(self, homotopy: Recordable) -> None:
        self.recorded = record_homotopy(homotopy)

    def follow(
        self,
        parameters: ComplexArray,
        start: ComplexArray,
        options: PathOptions,
        threads: int = 1,
        more: PathOptions | None = None,
    ) -> tuple[ComplexArray, ComplexArray, StatusArray, CountArray]:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0.

        Parameters
        ----------
        parameters : (P,)
            The numbers that all paths share.
        more : PathOptions, optional
            For paths that are lost with ``options``.

        Returns
        -------
        w, near : (B, n)
            Ends, and where singular paths were before them.
        state, attempts : (B,)
            ARRIVED, SINGULAR or LOST, and the steps that were tried.
        """
        count = len(start)
        care, second = (Care(*map(float, astuple(given))) for given in (options, more or options))
        w, near = (np.zeros_like(start, dtype=complex) for _ in range(2))
        state, attempts = np.full(count, LOST, dtype=np.int8), np.zeros(count, dtype=np.int64)
        recorded = self.recorded

        def follow_part(part: slice) -> None:
            given = _as_real(start[part])
            ends = PathEnds(
                np.zeros_like(given), np.zeros_like(given),
                np.full(given.shape[1], LOST, dtype=np.int8), np.zeros(given.shape[1], np.int64),
            )  # fmt: skip
            space = self._workspace(parameters)
            follow_paths(recorded.program.code, recorded.layout, space, given, care, second, ends)
            w[part], near[part] = _as_complex(ends.w), _as_complex(ends.near)
            state[part], attempts[part] = ends.state, ends.attempts

        if count:
            # neighbours may be equally long: every part takes each so-many-th path
            parts = max(1, min(threads, count // LANES))
            share_out(follow_part, [slice(k, None, parts) for k in range(parts)], threads)
        return w, near, state, attempts

    def _workspace(self, parameters: ComplexArray) -> Array:
        recorded = self.recorded
        space = recorded.registers.filled(recorded.program.height, LANES)
        space[recorded.parameters] = np.ascontiguousarray(parameters).view(float)[:, None]
        return space


def _as_real(w: ComplexArray) -> Array:
    """Complex (B, n) as real (2n, B)."""
    return np.ascontiguousarray(np.ascontiguousarray(w).view(float).T)


def _as_complex(w: Array) -> ComplexArray:
    """The inverse of :func:`_as_real`."""
    return np.ascontiguousarray(w.T).view(complex)
