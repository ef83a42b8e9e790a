"""The verbs of marching, compiled for lanes, and the bounds of a kernel's iterations."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.numerics import marching
from linkwork.core.record.recorder import LANES, ROLES, Code
from linkwork.families.compiled.compiling import (
    call_at,
    called_by_name,
    carray,
    compiled_for,
    inlined,
    named_tuple,
    njit_no_refcount,
    numbers,
    truths,
    types,
    wholes,
)
from linkwork.families.compiled.interpreter import FIELDS, HIGH, run_part
from linkwork.families.march.march_programs import START_STEPS, STEPS

aim = njit_no_refcount(marching.aim)
stride = njit_no_refcount(marching.stride)
is_lost = njit_no_refcount(marching.is_lost)
grow = njit_no_refcount(marching.grow)
trusted_nodes = njit_no_refcount(marching.trusted_nodes)
hermite_weights = njit_no_refcount(marching.hermite_weights)
is_same_spacing = njit_no_refcount(marching.is_same_spacing)
keep_spacing = njit_no_refcount(marching.keep_spacing)


@njit_no_refcount
def row_from(t: float, rows: Array) -> int:
    """The first of the increasing rows that is not below t; how many there are if none is."""
    # NumPy's search would take the compiler a second
    low, high = 0, len(rows)
    while low < high:
        middle = (low + high) // 2
        if rows[middle] < t:
            low = middle + 1
        else:
            high = middle
    return low


# ----------------------------------------------------------------------
# The tasks of a march, and the arrays of its results.


class InputTable(NamedTuple):
    """``rows`` (R,): increasing values of t. ``steps``: the first, largest and smallest step.

    ``unknowns``: how many a position has.
    """

    rows: Array
    steps: Array
    unknowns: int


class Tasks(NamedTuple):
    """Ways to go: each a mechanism, a direction (1 upwards, 0 downwards) and a node to start from.

    ``member``, ``way`` (T,); ``node`` (S, T).
    """

    member: IndexArray
    way: IndexArray
    node: Array

    @classmethod
    def room(cls, count: int, size: int) -> Tasks:
        """For this many tasks with nodes of S numbers."""
        return cls(np.empty(count, np.int64), np.empty(count, np.int64), np.empty((size, count)))


class MarchResult(NamedTuple):
    """Results of M mechanisms; the mechanism k of a part has the column ``first + k``.

    Parameters
    ----------
    first : int
    unknowns : (n, R, M)
    radius : (R, M), (0, M) without proofs
    reached : (R, M)
    end : (2, M)
        Where a mechanism could go no further, downwards and upwards: the value of t last reached;
        NaN where it went through all rows.
    last : (2, 2 S, M)
        The last node there and the node before.
    """

    first: int
    unknowns: Array
    radius: Array
    reached: BoolArray
    end: Array
    last: Array


CODE = types.Array(types.uint32, 2, "C")
INPUT_TABLE = named_tuple([numbers(1), numbers(1), types.int64], InputTable)
TASKS = named_tuple([wholes(1), wholes(1), numbers(2)], Tasks)
MARCH_RESULT = named_tuple(
    [types.int64, numbers(3), numbers(2), truths(2), numbers(2), numbers(3)], MarchResult
)


# ----------------------------------------------------------------------
# One trial of 64 lanes: predict, correct block by block, prove, judge.
#
# Positions have five places in a lane: the trial (role 0) and the last four nodes. The places
# change roles when a trial is taken (``turn`` counts that), so nothing is copied: there are
# programs for all five turns.


# places of programs in the packed code; behind BLOCKS: begin, damped, iterate, prove
PREDICT, GIVEN, JUDGE, BLOCKS = 0, 1, 2, 3
# results of a trial; behind LIVE: block by block
GOOD, RADIUS, LIVE = 0, 1, 2


class Topology(NamedTuple):
    """Programs and registers of one topology.

    Parameters
    ----------
    code : (5 K, 5) all programs, in all five turns
    length : K
    spans : (Q, 2) where each program begins and ends in the first turn
    weights : registers of a1, b1, …, b4
    nodes : (5, S) registers of positions, t last
    noted : (2 + B,) registers of good, radius, and live of each block
    shared : registers of inputs and their phasors at t, if these are the same for every design
    coefficients : (C,) registers of a design's coefficients
    trial : address of the trial written out (prediction, one correction, proof, judgement), see
        :func:`linkwork.core.record.printing.trial_source`; 0 where the interpreter does it
    """

    code: Code
    length: int
    spans: IndexArray
    weights: IndexArray
    nodes: IndexArray
    noted: IndexArray
    shared: IndexArray
    coefficients: IndexArray
    trial: int


TOPOLOGY = named_tuple(
    [
        CODE, types.int64, wholes(2), wholes(1), wholes(2), wholes(1), wholes(1), wholes(1),
        types.int64,
    ],
    Topology,
)  # fmt: skip


@inlined
def _run_program(topology: Topology, turn: int, w: Array, number: int, lanes: int) -> None:
    first, spans = turn * topology.length, topology.spans
    run_part(topology.code, first + spans[number, 0], first + spans[number, 1], w, lanes)


@inlined
def _blocks(topology: Topology) -> int:
    return len(topology.noted) - LIVE


@inlined
def proves_trials(topology: Topology) -> bool:
    """Whether its trials are proved."""
    return len(topology.spans) > BLOCKS + 3 * _blocks(topology)


@njit_no_refcount
def _any(w: Array, row: int, standing: Array, lanes: int) -> bool:
    """Whether a mask holds in a lane that counts."""
    found = 0
    for i in range(lanes):
        found += w[row, i] * standing[i] != 0.0
    return found > 0


@njit_no_refcount
def any_live(topology: Topology, w: Array, standing: Array, lanes: int) -> bool:
    """Whether a lane that counts has not converged."""
    found = False
    for k in range(_blocks(topology)):
        found |= _any(w, topology.noted[LIVE + k], standing, lanes)
    return found


@inlined
def _iterate(
    topology: Topology,
    turn: int,
    w: Array,
    program: int,
    live: int,
    most: int,
    standing: Array,
    lanes: int,
) -> None:
    """Newton-Raphson of one block until no lane iterates."""
    for _ in range(most):
        if not _any(w, live, standing, lanes):
            break
        _run_program(topology, turn, w, program, lanes)


@inlined
def judge(topology: Topology, turn: int, w: Array, lanes: int) -> None:
    """Proofs, if there are any, and the judgement."""
    for program in range(BLOCKS + 3 * _blocks(topology), len(topology.spans)):
        _run_program(topology, turn, w, program, lanes)
    _run_program(topology, turn, w, JUDGE, lanes)


@njit_no_refcount
def run_compiled_trial(topology: Topology, turn: int, w: Array, lanes: int) -> None:
    place, first = 8 * LANES * topology.nodes.shape[1], w.ctypes.data
    call_at(
        topology.trial,
        first + -turn % ROLES * place,
        first + (1 - turn) % ROLES * place,
        first + (2 - turn) % ROLES * place,
        first + (3 - turn) % ROLES * place,
        first + (4 - turn) % ROLES * place,
        first + ROLES * place,
        lanes,
    )


@njit_no_refcount
def evaluate_inputs(topology: Topology, turn: int, w: Array, together: bool, lanes: int) -> None:
    """Compute the inputs and their phasors at the trial."""
    shared = topology.shared
    if together and len(shared):
        _run_program(topology, turn, w, GIVEN, 1)
        for register in shared:
            w[register, 1:lanes] = w[register, 0]
    else:
        _run_program(topology, turn, w, GIVEN, lanes)


@njit_no_refcount
def run_trial(
    topology: Topology, turn: int, w: Array, standing: Array, together: bool, lanes: int
) -> None:
    """From the prediction to the judgement.

    Parameters
    ----------
    standing : (LANES,)
        1.0 in lanes that count, 0.0 in others.
    together : bool
        Whether all lanes are at the same t.
    lanes : int
        How many of them are computed.
    """
    blocks, live = _blocks(topology), topology.noted[LIVE:]
    is_written = topology.trial != 0
    evaluate_inputs(topology, turn, w, together, lanes)
    if is_written:
        run_compiled_trial(topology, turn, w, lanes)
        if not any_live(topology, w, standing, lanes):
            return
    else:
        _run_program(topology, turn, w, PREDICT, lanes)
    for k in range(blocks):
        if not is_written:
            _run_program(topology, turn, w, BLOCKS + k, lanes)
        elif _any(w, live[k], standing, lanes):  # later blocks were computed with a worse position
            for later in range(k + 1, blocks):
                w[live[later], :lanes] = 1.0
        program = BLOCKS + 2 * blocks + k
        _iterate(topology, turn, w, program, live[k], STEPS - 1, standing, lanes)
    judge(topology, turn, w, lanes)


@inlined
def correct_slowly(topology: Topology, w: Array, lanes: int) -> None:
    """From a guess in role 1 to a position, with small steps; its own proof.

    The first proof knows nothing of the node it compares with, the second that it is this position.
    """
    blocks, nodes = _blocks(topology), topology.nodes
    everywhere = np.ones(LANES)
    _run_program(topology, 0, w, PREDICT, lanes)
    _run_program(topology, 0, w, GIVEN, lanes)
    for b in range(blocks):
        live = topology.noted[LIVE + b]
        w[live, :] = 1.0
        _iterate(topology, 0, w, BLOCKS + blocks + b, live, START_STEPS, everywhere, lanes)
    if proves_trials(topology):
        # the second proof compares the position with itself, and knows its error
        for _ in range(2):
            for lane in range(lanes):
                copy_lane(w, lane, nodes[1], nodes[0])
            judge(topology, 0, w, lanes)


@njit_no_refcount
def load_all_lanes(w: Array, registers: IndexArray, data: Array, base: int, count: int) -> None:
    """Load columns of data from ``base`` on into the lanes; the last one fills further lanes."""
    for j in range(len(registers)):
        register = registers[j]
        for lane in range(count):
            w[register, lane] = data[j, base + lane]
        w[register, count:] = data[j, base + count - 1]


@njit_no_refcount
def load_lane(w: Array, lane: int, registers: IndexArray, data: Array, member: int) -> None:
    """One column of data into a lane."""
    for j in range(len(registers)):
        w[registers[j], lane] = data[j, member]


@njit_no_refcount
def copy_lane(w: Array, lane: int, to: IndexArray, source: IndexArray) -> None:
    """Registers of one lane into others."""
    for j in range(len(to)):
        w[to[j], lane] = w[source[j], lane]


@njit_no_refcount
def predict_by_tangent(w: Array, lane: int, weights: IndexArray, h: float) -> None:
    """Predict from the last node alone."""
    for j in range(len(weights)):
        w[weights[j], lane] = 0.0
    w[weights[0], lane] = 1.0
    w[weights[1], lane] = h


@njit_no_refcount
def extrapolate(
    w: Array, lane: int, weights: IndexArray, t: float, times: Array, known: int
) -> None:
    """Predict at t by the polynomial through the last nodes with their derivatives.

    Parameters
    ----------
    times : (4,) of the last nodes
    known : how many of them there are; fewer are trusted far ahead
    """
    used = trusted_nodes(t, times, known)
    for j in range(len(weights)):
        w[weights[j], lane] = 0.0
    for i in range(used):
        a, b = hermite_weights(t, times, i, used)  # eq. (18)
        w[weights[2 * i], lane], w[weights[2 * i + 1], lane] = a, b


@njit_no_refcount
def update_weights(
    w: Array, lane: int, weights: IndexArray, times: Array, step: float, known: int, spacing: Array
) -> bool:
    """The weights of a lane's prediction, computed anew where its spacing has changed; whether it
    has.

    Parameters
    ----------
    times : (4,) of the last nodes
    step : from the last one
    known : how many of them there are
    spacing : (4,) for which the weights were computed; updated
    """
    if is_same_spacing(step, times, spacing):
        return False
    keep_spacing(step, times, spacing)
    extrapolate(w, lane, weights, times[0] + step, times, known)
    return True


# ----------------------------------------------------------------------
# A trial as a function with a name, of which all loops over lanes share one compiled copy.


_WHOLE, _WHOLES = types.int64, types.CPointer(types.int64)
_NUMBERS = types.CPointer(types.float64)


@called_by_name(
    "linkwork_trial",
    types.CPointer(types.uint32), _WHOLE, _WHOLES, _WHOLE, _WHOLES, _WHOLE, _WHOLES, _WHOLE,
    _WHOLES, _WHOLE, _WHOLE,
    _WHOLE, _NUMBERS, _NUMBERS, _WHOLE, _WHOLE,
)  # fmt: skip
def _correct_and_judge_at(
    code: Array,
    length: int,
    spans: Array,
    programs: int,
    nodes: Array,
    size: int,
    noted: Array,
    notes: int,
    shared: Array,
    inputs: int,
    trial: int,
    turn: int,
    workspace: Array,
    standing: Array,
    together: int,
    lanes: int,
) -> int:
    """The parts of a topology that a trial needs, and its arguments, at addresses."""
    none = carray(shared, (0,))
    topology = Topology(
        carray(code, (ROLES * length, FIELDS)),
        length,
        carray(spans, (programs, 2)),
        none,
        carray(nodes, (ROLES, size)),
        carray(noted, (notes,)),
        carray(shared, (inputs,)),
        none,
        trial,
    )
    w = carray(workspace, (HIGH, LANES))
    run_trial(topology, turn, w, carray(standing, (LANES,)), together != 0, lanes)
    return 0


@njit_no_refcount
def correct_and_judge(
    topology: Topology, turn: int, w: Array, standing: Array, together: bool, lanes: int
) -> None:
    """:func:`run_trial`, called by name: one copy of it serves all marches."""
    _correct_and_judge_at(
        (
            topology.code.ctypes.data, topology.length, topology.spans.ctypes.data,
            len(topology.spans), topology.nodes.ctypes.data, topology.nodes.shape[1],
            topology.noted.ctypes.data, len(topology.noted), topology.shared.ctypes.data,
            len(topology.shared), topology.trial,
            turn, w.ctypes.data, standing.ctypes.data, int(together), lanes,
        )
    )  # fmt: skip


# ----------------------------------------------------------------------
# Where motions begin: every mechanism solved at the input of its guess.


@compiled_for(types.void(TOPOLOGY, numbers(2), numbers(2), numbers(2), numbers(2), truths(1)))
def begin(
    topology: Topology, w: Array, design: Array, guess: Array, node: Array, found: BoolArray
) -> None:
    """Solve every mechanism at its guess's input value.

    Parameters
    ----------
    topology : Topology
    w : (registers, LANES) workspace with constants and options in place
    design : (C, M) coefficients
    guess, node : (S, M) the guess, and the node found from it
    found : (M,) bool, set
    """
    count, nodes, good = design.shape[1], topology.nodes, topology.noted[GOOD]
    for base in range(0, count, LANES):
        width = min(LANES, count - base)
        load_all_lanes(w, topology.coefficients, design, base, width)
        load_all_lanes(w, nodes[1], guess, base, width)
        for lane in range(LANES):
            for role in range(len(nodes)):
                copy_lane(w, lane, nodes[role], nodes[1])
            predict_by_tangent(w, lane, topology.weights, 0.0)
            w[good, lane] = 1.0
        correct_slowly(topology, w, 1 if width == 1 else LANES)
        for lane in range(width):
            member = base + lane
            fine = w[good, lane] > 0.5
            for live in topology.noted[LIVE:]:
                fine &= w[live, lane] == 0.0
            for j in range(nodes.shape[1]):
                node[j, member] = w[nodes[0, j], lane]
                fine &= math.isfinite(node[j, member])
            found[member] = fine
