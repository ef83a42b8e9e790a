"""March many mechanisms on a graphics card: each thread follows one, in one direction.

Each thread marches as :mod:`linkwork.families.march.independent` does, along one path of inputs. A
thread's state is a small array that is addressed by constants only, so that the compiler can keep
it in registers:

=======================  =====================================================================
``r S … r S + S - 1``    the position in role r, unknowns first and t last (:class:`Shape`)
from ``5 S``             weights a1, b1, …, b4; good; radius; live of each block
then                     coefficients, options, and further results of the trial
=======================  =====================================================================

The loop does one trial at a time, so a thread that repeats a step takes more rounds and delays no
other thread. Only code written by
:mod:`linkwork.families.gpu.kernel` imports this module, because it loads numba.cuda.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.numerics import marching
from linkwork.core.record.recorder import ROLES
from linkwork.families.compiled.interpreter import sin_cos as sine_sin_cos
from linkwork.families.gpu.kernel import kernel, numba_cuda, on_device
from linkwork.families.march.march_programs import NODES
from linkwork.families.march.step_trial import InputTable, MarchResult, row_from

__all__ = [
    "InputTable",
    "MarchResult",
    "Sections",
    "Shape",
    "Start",
    "begin",
    "cuda",
    "follow",
    "kernel",
    "on_device",
    "sin_cos",
]

cuda = numba_cuda()
sin_cos = on_device(sine_sin_cos.py_func)
_aim = on_device(marching.aim)
_stride = on_device(marching.stride)
_is_lost = on_device(marching.is_lost)
_grow = on_device(marching.grow)
_trusted_nodes = on_device(marching.trusted_nodes)
_hermite_weights = on_device(marching.hermite_weights)
_is_same_spacing = on_device(marching.is_same_spacing)
_keep_spacing = on_device(marching.keep_spacing)
_HALF = marching.HALF
_row_from = on_device(row_from.py_func)


class Sections(NamedTuple):
    """Programs of one topology as functions of a thread's state.

    ``predict`` the trial; ``correct`` it, or ``correct_slowly`` from a guess; ``judge`` it, with
    its proof.
    """

    predict: Callable[[Array], None]
    correct: Callable[[Array], None]
    correct_slowly: Callable[[Array], None]
    judge: Callable[[Array], None]


class Start(NamedTuple):
    """A mechanism and where it starts: column ``member`` of coefficients (C, M) and nodes (S, M);
    ``options`` (O,).
    """

    member: int
    design: Array
    options: Array
    node: Array


class Shape(NamedTuple):
    """How a thread's state is laid out.

    The first places of ``weights``, ``good``, ``radius`` and ``live``; ``unknowns``, and the
    ``size`` S of a position; how many ``blocks``, ``coefficients`` and ``options``; ``certified``:
    whether steps are proved.
    """

    weights: int
    good: int
    radius: int
    live: int
    unknowns: int
    size: int
    blocks: int
    coefficients: int
    options: int
    certified: bool


@on_device
def _load(shape: Shape, w: Array, start: Start) -> None:
    """A mechanism, with all nodes where it starts."""
    first = shape.live + shape.blocks
    for j in range(shape.coefficients):
        w[first + j] = start.design[j, start.member]
    for j in range(shape.options):
        w[first + shape.coefficients + j] = start.options[j]
    for role in range(ROLES):
        for j in range(shape.size):
            w[role * shape.size + j] = start.node[j, start.member]


@on_device
def _weigh(shape: Shape, w: Array, times: Array, step: float, known: int, spacing: Array) -> None:
    """The weights of the prediction, computed anew where the spacing has changed.

    ``times``: of the last nodes, of which ``known`` can be used.
    """
    if _is_same_spacing(step, times, spacing):
        return
    _keep_spacing(step, times, spacing)
    t = times[0] + step
    used = _trusted_nodes(t, times, known)
    for i in range(NODES):
        value, slope = 0.0, 0.0
        if i < used:
            value, slope = _hermite_weights(t, times, i, used)  # eq. (18)
        w[shape.weights + 2 * i] = value
        w[shape.weights + 2 * i + 1] = slope


@on_device
def begin(
    sections: Sections, shape: Shape, w: Array, start: Start, node: Array, begun: BoolArray
) -> None:
    """From a guess to a position, with small steps and its own proof; see
    :func:`linkwork.families.march.step_trial.correct_slowly`.

    ``node`` (S, M), ``begun`` (M,) bool: the node found, and whether it is a position.
    """
    _load(shape, w, start)
    for j in range(2 * NODES):
        w[shape.weights + j] = 0.0
    w[shape.weights] = 1.0
    w[shape.good] = 1.0
    sections.predict(w)
    sections.correct_slowly(w)
    if shape.certified:
        for _ in range(2):
            for j in range(shape.size):
                w[shape.size + j] = w[j]
            sections.judge(w)
    fine = w[shape.good] > 0.5
    for k in range(shape.blocks):
        fine = fine and w[shape.live + k] == 0.0
    for j in range(shape.size):
        fine = fine and math.isfinite(w[j])
        node[j, start.member] = w[j]
    begun[start.member] = fine


@on_device
def _note(shape: Shape, w: Array, row: int, found: MarchResult) -> None:
    """Store the position of a row that is reached."""
    found.reached[row, found.first] = True
    for j in range(shape.unknowns):
        found.unknowns[j, row, found.first] = w[j]
    if shape.certified:
        found.radius[row, found.first] = w[shape.radius]


@on_device
def _stop(shape: Shape, w: Array, way: int, found: MarchResult) -> None:
    """Note that a mechanism stops: its last node and the node before."""
    size = shape.size
    found.end[way, found.first] = w[2 * size - 1]
    for j in range(2 * size):
        found.last[way, j, found.first] = w[size + j]


@on_device
def follow(
    sections: Sections,
    shape: Shape,
    w: Array,
    start: Start,
    way: int,
    table: InputTable,
    found: MarchResult,
) -> None:
    """Follow a mechanism from row to row, upwards (way 1) or downwards (0).

    Parameters
    ----------
    sections : Sections
    shape : Shape
    w : thread's state
    start : Start
    way : int
    table : InputTable
    found : MarchResult
        ``first``: the mechanism.
    """
    size, rows, steps = shape.size, table.rows, table.steps
    _load(shape, w, start)
    times = cuda.local.array(NODES, "float64")
    spacing = cuda.local.array(NODES, "float64")
    for k in range(NODES):
        spacing[k] = math.inf  # equal to no spacing, so that weights are computed
    # the first row ahead of t, or at t where the way leads upwards
    row, known, h = _row_from(w[size - 1], rows), 1, steps[0]
    row = row if way == 1 else row - 1
    while 0 <= row < rows.shape[0]:
        goal, before = rows[row], w[2 * size - 1]
        step, t = _stride(goal, before, h), _aim(goal, before, h)
        for k in range(NODES):
            times[k] = w[(k + 2) * size - 1]
        _weigh(shape, w, times, step, known, spacing)
        w[size - 1] = t
        sections.predict(w)
        sections.correct(w)
        sections.judge(w)
        moved = abs(t - before)
        if w[shape.good] > 0.5 and not _is_lost(t, before, goal):
            if t == goal:
                _note(shape, w, row, found)
                row += 2 * way - 1
            h = _grow(h, moved, steps[1])  # eq. (22): doubled after a whole step
            known = min(known + 1, NODES)
            if moved == 0.0:  # the trial is no new node
                known = 1
            else:
                for j in range(NODES * size - 1, -1, -1):
                    w[size + j] = w[j]
        else:
            h = _HALF * moved  # eq. (22): halved after a failure
            if h < steps[2]:
                _stop(shape, w, way, found)
                return
