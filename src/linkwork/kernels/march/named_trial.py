"""A trial as a function with a name, of which all loops over lanes share one compiled copy."""

from __future__ import annotations

from linkwork.foundation.arrays import Array
from linkwork.kernels.march.step_control import STEPS
from linkwork.kernels.march.step_trial import (
    Topology,
    any_live,
    evaluate_inputs,
    run_compiled_trial,
    run_trial,
)
from linkwork.kernels.program.compiling import called_by_name, carray, njit_no_refcount, types
from linkwork.kernels.program.interpreter import FIELDS, HIGH, LANES
from linkwork.kernels.program.program import ROLES

__all__ = ["correct_and_judge", "correct_from_guess"]

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
    return run_trial(topology, turn, w, carray(standing, (LANES,)), together != 0, lanes)


@njit_no_refcount
def correct_and_judge(
    topology: Topology, turn: int, w: Array, standing: Array, together: bool, lanes: int
) -> int:
    """:func:`run_trial`, called by name: one copy of it serves all marches."""
    return _correct_and_judge_at(
        (
            topology.code.ctypes.data, topology.length, topology.spans.ctypes.data,
            len(topology.spans), topology.nodes.ctypes.data, topology.nodes.shape[1],
            topology.noted.ctypes.data, len(topology.noted), topology.shared.ctypes.data,
            len(topology.shared), topology.trial,
            turn, w.ctypes.data, standing.ctypes.data, int(together), lanes,
        )
    )  # fmt: skip


@njit_no_refcount
def correct_from_guess(
    topology: Topology, turn: int, w: Array, standing: Array, lanes: int, unknowns: int
) -> int:
    """From a guess in the place of the oldest node, the only one that has weight, to a position:
    how many corrections that took, 0 if not all lanes have converged. The judgement is made, but
    need not be good.
    """
    nodes = topology.nodes
    if topology.trial == 0:
        count = correct_and_judge(topology, turn, w, standing, False, lanes)
        return 0 if any_live(topology, w, standing, lanes) else count
    evaluate_inputs(topology, turn, w, False, lanes)
    for k in range(STEPS):
        run_compiled_trial(topology, turn, w, lanes)
        if not any_live(topology, w, standing, lanes):
            return k + 1
        for k in range(unknowns):
            guess, trial = nodes[(ROLES - 1 - turn) % ROLES, k], nodes[-turn % ROLES, k]
            for i in range(lanes):
                w[guess, i] = w[trial, i]
    return 0
