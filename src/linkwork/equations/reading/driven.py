"""The joints driven by the inputs of loop equations, in the derived linkage."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.equations.model import LoopEquations, Variable
from linkwork.equations.reading.joints import Joints, NotRead
from linkwork.equations.reading.walk import FRAME, Phase

__all__ = ["driven_pair", "inputs_at_joints"]


def driven_pair(joints: Joints, variable: Variable) -> tuple[int, int, float]:
    """The two links whose relative angle is a multiple of an input angle, and the factor.

    Pairs of links with a common pin are preferred.

    Raises
    ------
    NotRead
        If it is not the angle between two links.
    """
    pairs = list(_pairs(joints, variable))
    if not pairs:
        raise NotRead(f'the input "{variable.name}" is not the angle between two links')
    return max(pairs, key=lambda pair: _pinned(joints, pair[0], pair[1]))


def _pairs(joints: Joints, variable: Variable) -> Iterator[tuple[int, int, float]]:
    others = sorted(joints.phases, key=lambda link: link != joints.ground)
    for other in others:
        if joints.phases[other] == FRAME and other != joints.ground:
            continue
        for link, phase in joints.phases.items():
            between = _difference(phase, joints.phases[other])
            if list(between) == [variable.symbol] and (
                between[variable.symbol] > 0 or other == joints.ground
            ):
                yield link, other, between[variable.symbol]


def _difference(phase: Phase, other: Phase) -> dict[str, float]:
    found = dict(phase)
    for name, weight in other:
        found[name] = found.get(name, 0.0) - weight
    return {name: weight for name, weight in found.items() if weight}


def _pinned(joints: Joints, link: int, other: int) -> bool:
    return any(link in corner.places and other in corner.places for corner in joints.corners)


def inputs_at_joints(equations: LoopEquations, joints: Joints) -> int:
    """The number of inputs that drive a joint."""
    count = 0
    for variable in equations.inputs:
        if variable.kind == "angle":
            link, other, _ = driven_pair(joints, variable)
            count += _pinned(joints, link, other)
        else:
            count += 1
    return count
