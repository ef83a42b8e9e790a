"""One trial of 64 lanes: predict, correct block by block, prove, judge.

Positions have five places in a lane: the trial (role 0) and the last four nodes. The places change
roles when a trial is taken (``turn`` counts that), so nothing is copied: programs are at hand for
all five turns.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from linkwork.foundation.arrays import IndexArray
from linkwork.kernels.lanes.compiling import call_at, compiled, named_tuple, types
from linkwork.kernels.lanes.machine import LANES, run_part
from linkwork.kernels.lanes.march_programs import ROLES
from linkwork.kernels.lanes.stepping import START_STEPS, STEPS, hermite, trusted

__all__ = [
    "BLOCKS",
    "GOOD",
    "JUDGE",
    "LIVE",
    "PREDICT",
    "RADIUS",
    "TOPOLOGY",
    "Topology",
    "by_written",
    "copied",
    "extrapolated",
    "judged",
    "loaded",
    "proved",
    "settled",
    "solved_slowly",
    "tangent",
]

# where a program stands in the packed code; behind BLOCKS: begin, damped, iterate, prove
PREDICT, JUDGE, BLOCKS = 0, 1, 2
# what is noted of a trial; behind LIVE: block by block
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
    noted : (5, 2 + B) registers of good, radius, and live of each block
    height : P, registers of each place; places are the first ones of the workspace
    coefficients : (C,) registers of a design's coefficients
    trial : address of the trial written out (prediction, one correction, proof, judgement), see
        :func:`linkwork.kernels.lanes.printing.trial_source`; 0 where the machine does it
    """

    code: np.ndarray[tuple[int, int], np.dtype[np.uint32]]
    length: int
    spans: IndexArray
    weights: IndexArray
    nodes: IndexArray
    noted: IndexArray
    height: int
    coefficients: IndexArray
    trial: int


TOPOLOGY = named_tuple(
    [
        types.Array(types.uint32, 2, "C"),
        types.int64,
        types.Array(types.int64, 2, "C"),
        types.Array(types.int64, 1, "C"),
        types.Array(types.int64, 2, "C"),
        types.Array(types.int64, 2, "C"),
        types.int64,
        types.Array(types.int64, 1, "C"),
        types.int64,
    ],
    Topology,
)


@compiled
def _one(topology, turn, w, number):  # type: ignore[no-untyped-def]
    first = turn * topology.length
    run_part(topology.code, first + topology.spans[number, 0], first + topology.spans[number, 1], w)


@compiled
def _blocks(topology):  # type: ignore[no-untyped-def]
    return topology.noted.shape[1] - LIVE


@compiled
def proved(topology):  # type: ignore[no-untyped-def]
    """Whether its trials are proved."""
    return len(topology.spans) > BLOCKS + 3 * _blocks(topology)


@compiled
def _any(w, row, standing):  # type: ignore[no-untyped-def]
    """Whether a mask holds in a lane that counts."""
    found = 0
    for i in range(LANES):
        found += w[row, i] * standing[i] != 0.0
    return found > 0


@compiled
def _iterate(topology, turn, w, program, live, most, standing):  # type: ignore[no-untyped-def]
    """Newton-Raphson of one block until no lane iterates."""
    for _ in range(most):
        if not _any(w, live, standing):
            break
        _one(topology, turn, w, program)


@compiled
def judged(topology, turn, w):  # type: ignore[no-untyped-def]
    """Proofs, if there are any, and the judgement."""
    for program in range(BLOCKS + 3 * _blocks(topology), len(topology.spans)):
        _one(topology, turn, w, program)
    _one(topology, turn, w, JUDGE)


@compiled
def by_written(topology, turn, w, lanes):  # type: ignore[no-untyped-def]
    """The trial that is written out, in the first lanes."""
    place, first = 8 * LANES * topology.height, w.ctypes.data
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


@compiled
def settled(topology, turn, w, standing):  # type: ignore[no-untyped-def]
    """From the prediction to the judgement.

    Parameters
    ----------
    standing : (LANES,)
        1.0 in lanes that count, 0.0 in others.
    """
    blocks, live = _blocks(topology), topology.noted[-turn % ROLES, LIVE:]
    is_written = topology.trial != 0
    if is_written:
        by_written(topology, turn, w, LANES)
        again = False
        for k in range(blocks):
            again |= _any(w, live[k], standing)
        if not again:
            return
    else:
        _one(topology, turn, w, PREDICT)
    for k in range(blocks):
        if not is_written:
            _one(topology, turn, w, BLOCKS + k)
        elif _any(w, live[k], standing):  # what follows was computed with a worse position
            for later in range(k + 1, blocks):
                w[live[later], :] = 1.0
        _iterate(topology, turn, w, BLOCKS + 2 * blocks + k, live[k], STEPS - 1, standing)
    judged(topology, turn, w)


@compiled
def solved_slowly(topology, w):  # type: ignore[no-untyped-def]
    """From a guess in role 1 to a position, with small steps; its own proof.

    The first proof knows nothing of the node it compares with, the second that it is this position.
    """
    blocks, nodes = _blocks(topology), topology.nodes
    everywhere = np.ones(LANES)
    _one(topology, 0, w, PREDICT)
    for b in range(blocks):
        live = topology.noted[0, LIVE + b]
        w[live, :] = 1.0
        _iterate(topology, 0, w, BLOCKS + blocks + b, live, START_STEPS, everywhere)
    if proved(topology):
        for _ in range(2):
            for lane in range(LANES):
                copied(w, lane, nodes[1], nodes[0])
            judged(topology, 0, w)


@compiled
def loaded(w, lane, registers, data, member):  # type: ignore[no-untyped-def]
    """One column of data into a lane."""
    for j in range(len(registers)):
        w[registers[j], lane] = data[j, member]


@compiled
def copied(w, lane, to, source):  # type: ignore[no-untyped-def]
    """Registers of one lane into others."""
    for j in range(len(to)):
        w[to[j], lane] = w[source[j], lane]


@compiled
def tangent(w, lane, weights, h):  # type: ignore[no-untyped-def]
    """Predict from the last node alone."""
    for j in range(len(weights)):
        w[weights[j], lane] = 0.0
    w[weights[0], lane] = 1.0
    w[weights[1], lane] = h


@compiled
def extrapolated(w, lane, weights, t, times, known):  # type: ignore[no-untyped-def]
    """Predict at t by the polynomial through the last nodes with their derivatives.

    Parameters
    ----------
    times : (4,) of the last nodes
    known : how many of them there are; fewer are trusted far ahead
    """
    used = trusted(t, times, known)
    for j in range(len(weights)):
        w[weights[j], lane] = 0.0
    for i in range(used):
        a, b = hermite(t, times, i, used)
        w[weights[2 * i], lane], w[weights[2 * i + 1], lane] = a, b
