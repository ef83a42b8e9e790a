"""Lists of circuits of random mechanisms: no dead point and no configuration is left over."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

import linkwork as lw
from linkwork.circuits.dead_inputs import DeadPointInputs, dead_point_inputs
from linkwork.core.motion.model import leading_input
from linkwork.core.numerics.branch_tracking import InputPath
from tests.campaigns.motion import FAMILIES, random_mechanism
from tests.oracles.cranked import cranked_truss

__all__ = ["CRANKED", "circuit_campaign", "dead_inputs_of", "judge_circuits"]

#: Trusses with a crank, and how many complex dead points they have: six-bars, then eight-bars.
CRANKED = {"Ds[": 24, "FEhf?": 72, "FCpv?": 80, "F?o~_": 96}

_TURN = 360.0
_MET = 1e-8  # in the input's unit: the same dead point,
_MET_MULTIPLE = 1e-3  # near a change point, where dead points are steep
_BESIDE = 1e-5


def dead_inputs_of(mechanism: lw.Mechanism) -> DeadPointInputs:
    """All dead points of a mechanism driven as its file says."""
    model = mechanism.model
    lead, rate = leading_input(model.rows)
    own = model.start_inputs
    path = InputPath(origin=own - rate * own[lead], rate=rate)
    return dead_point_inputs(model, path, lead)


def _gap(a: float, b: float, turns: bool) -> float:
    return abs(math.remainder(a - b, _TURN)) if turns else abs(a - b)


def _on_circuits(circuits: lw.circuits.Circuits, at: float, turns: bool) -> int:
    """How many positions all circuits have at an input value."""
    count = 0
    for circuit in circuits:
        if circuit.turns and not circuit.dead_points and not circuit.change_points:
            count += circuit.turns
            continue
        for branch in circuit.branches:
            low, high = branch.input_range
            if turns:
                count += math.floor((high - at) / _TURN) - math.ceil((low - at) / _TURN) + 1
            else:
                count += low <= at <= high
    return count


def judge_circuits(mechanism: lw.Mechanism, rng: np.random.Generator, looks: int = 3) -> list[str]:
    """What is wrong with the list of circuits of a mechanism with one input."""
    model = mechanism.model
    turns = model.equations.inputs[0].kind == "angle"
    dead, circuits = dead_inputs_of(mechanism), mechanism.circuits(certify=False)
    listed = (dead.values / model.input_scale[0]).tolist()
    limits = [limit for c in circuits for limit in (*c.dead_points, *c.change_points)]
    wrong = []
    if not dead.cover_all or not circuits.completeness.complete:
        wrong.append(f"not complete: {circuits.message}")
    for value, multiple in zip(listed, dead.multiple, strict=True):
        near = min((_gap(value, limit.input, turns) for limit in limits), default=math.inf)
        if near > (_MET_MULTIPLE if multiple else _MET):
            # a block locks there, but those behind it cannot be closed: nothing ends there
            beside = [len(mechanism.configurations(at=value + e)) for e in (-_BESIDE, _BESIDE)]
            if beside[0] != beside[1]:
                wrong.append(f"the dead point at {value} lies on no circuit")
    for limit in limits:
        within = _MET_MULTIPLE if dead.multiple.any() else _MET
        if min((_gap(value, limit.input, turns) for value in listed), default=9.0) > within:
            wrong.append(f"the dead point at {limit.input} is not in the list")
    for _ in range(looks):
        at = float(rng.uniform(-180.0, 180.0))
        if not turns:
            at = float(model.start_inputs[0] / model.input_scale[0] * rng.uniform(0.5, 1.5))
        found, passed = len(mechanism.configurations(at=at)), _on_circuits(circuits, at, turns)
        if found != passed:
            wrong.append(f"at {at} {found} configurations, but circuits pass {passed} times")
    return wrong


def circuit_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """``count`` mechanisms: in turn random ones of the sweeps, and trusses with a crank."""
    tally: Counter[str] = Counter()
    false: list[str] = []
    graphs = tuple(CRANKED)
    for number in range(part * count, (part + 1) * count):
        rng = np.random.default_rng([12, number])
        if number % 2:
            graph = graphs[number // 2 % len(graphs)]
            name, mechanism = f"crank and {graph}", cranked_truss(graph, rng)
            (found,) = dead_inputs_of(mechanism).counts
            if found.finite != CRANKED[graph]:
                false.append(f"{name}, number {number}: {found.finite} dead points")
        else:
            name = FAMILIES[number // 2 % len(FAMILIES)]
            mechanism = random_mechanism(name, rng)
        false += [f"{name}, number {number}: {what}" for what in judge_circuits(mechanism, rng)]
        tally[name] += 1
    return tally, false
