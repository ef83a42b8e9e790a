"""Predicting rows side by side in the lanes, from the nodes of a march or from earlier rows."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, CountArray
from linkwork.kernels.march.march_programs import NODES
from linkwork.kernels.march.step_trial import Topology
from linkwork.kernels.program.compiling import compiled_within, njit_no_refcount
from linkwork.kernels.program.program import ROLES

__all__ = [
    "KNOTS",
    "choose_knots",
    "hermite_weights_of_lanes",
    "predict_from_nodes",
    "predict_from_rows",
]

KNOTS = 6  # rows from which the next ones are predicted, at most
_APART = 0.2  # of a step: a node that is closer to another one adds rounding, not accuracy


@njit_no_refcount
def hermite_weights_of_lanes(
    times: AnyArray, count: int, t: AnyArray, lanes: int, cells: Array
) -> None:
    """Weights at t (lanes,) of values and derivatives at ``count`` times, (2 count, lanes), in
    Hermite's polynomial.
    """
    for j in range(count):
        scale, slope = 1.0, 0.0
        for k in range(count):
            if k != j:
                scale *= times[j] - times[k]
                slope += 1.0 / (times[j] - times[k])
        for i in range(lanes):
            basis = 1.0 / scale
            for k in range(count):
                if k != j:
                    basis *= t[i] - times[k]
            away, square = t[i] - times[j], basis * basis
            # eq. (18)
            cells[2 * j, i], cells[2 * j + 1, i] = (
                (1.0 - 2.0 * slope * away) * square,
                away * square,
            )


@compiled_within
def predict_from_nodes(
    topology: Topology, turn: int, w: Array, lanes: int, used: int, unknowns: int, cells: Array
) -> None:
    """Guesses for the first rows by the polynomial through the nodes behind them, which are the
    same in all lanes, in the place of the oldest one.

    A node close to a later one is left out.
    """
    nodes, last = topology.nodes, topology.nodes.shape[1] - 1
    times, places, count = np.zeros(NODES), np.zeros(NODES, np.int64), 0
    t, near = nodes[-turn % ROLES, last], nodes[(1 - turn) % ROLES, last]
    for k in range(used):
        time, apart = w[nodes[(k + 1 - turn) % ROLES, last], 0], True
        for j in range(count):
            # close nodes have huge weights of opposite signs, which magnify rounding
            apart &= abs(time - times[j]) > _APART * abs(w[t, 0] - w[near, 0])
        if apart:
            times[count], places[count] = time, (k + 1 - turn) % ROLES
            count += 1
    hermite_weights_of_lanes(times, count, w[t], lanes, cells)
    for k in range(unknowns):
        guess = nodes[(ROLES - 1 - turn) % ROLES, k]
        for i in range(lanes):
            w[guess, i] = 0.0
        for j in range(count):
            value, rate = w[nodes[places[j], k], 0], w[nodes[places[j], unknowns + k], 0]
            for i in range(lanes):
                w[guess, i] += cells[2 * j, i] * value + cells[2 * j + 1, i] * rate


@compiled_within
def choose_knots(width: int) -> CountArray:
    """The lanes of this many rows from which the next rows are predicted, the last one first."""
    count = min(KNOTS, width)
    knots = np.empty(count, np.int64)
    for j in range(count):
        knots[j] = width - 1 - j * (width // count)
    return knots


@njit_no_refcount
def predict_from_rows(
    topology: Topology,
    turn: int,
    w: Array,
    lanes: int,
    knots: CountArray,
    cells: Array,
    unknowns: int,
) -> None:
    """Guesses by the polynomial through rows before, in the place of the oldest node."""
    nodes = topology.nodes
    for k in range(unknowns):
        guess, x = nodes[(ROLES - 1 - turn) % ROLES, k], nodes[(1 - turn) % ROLES, k]
        d = nodes[(1 - turn) % ROLES, unknowns + k]
        for i in range(lanes):
            w[guess, i] = 0.0
        for j in range(len(knots)):
            value, rate = w[x, knots[j]], w[d, knots[j]]
            for i in range(lanes):
                w[guess, i] += cells[2 * j, i] * value + cells[2 * j + 1, i] * rate
