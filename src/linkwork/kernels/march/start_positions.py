"""Where motions begin: every mechanism solved at the input of its guess."""

from __future__ import annotations

import math

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.kernels.march.step_trial import (
    GOOD,
    LIVE,
    TOPOLOGY,
    Topology,
    copy_lane,
    correct_slowly,
    load_all_lanes,
    predict_by_tangent,
)
from linkwork.kernels.program.compiling import compiled_for, types
from linkwork.kernels.program.interpreter import LANES

__all__ = ["begin"]


_PLAIN = types.Array(types.float64, 2, "C")


@compiled_for(
    types.void(TOPOLOGY, _PLAIN, _PLAIN, _PLAIN, _PLAIN, types.Array(types.boolean, 1, "C"))
)
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
