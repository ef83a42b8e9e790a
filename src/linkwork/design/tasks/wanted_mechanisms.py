"""The kinds of mechanisms that a task can ask for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from linkwork.design.loops.candidates import GUIDED
from linkwork.design.tasks.function_goal import ExactPairs, FunctionGoal
from linkwork.design.tasks.task_keys import KINDS
from linkwork.foundation.plain_numbers import as_told

__all__ = ["MECHANISMS", "WATT_II", "WATT_PAIRS", "mechanism_problems", "watt_pivot_problems"]

MECHANISMS = ("four-bar", "slider-crank", "inverted-slider-crank")
WATT_II = "watt-ii"  # two four-bars with a bell crank in common, for functions
#: Five pairs and fewer are met by four-bars.
WATT_PAIRS = ExactPairs(mechanism=WATT_II, least=6, fixed=9, free=9, fits=False)
_WATT_PIVOTS = 3  # A0, B0, C0

_Problems = Iterator[tuple[tuple[str | int, ...], str]]


def mechanism_problems(kind: str, mechanisms: Sequence[str]) -> _Problems:
    """Kinds of mechanisms that are not known, or not made for this kind of task."""
    known = (*MECHANISMS, WATT_II) if kind == "function" else (*MECHANISMS, *GUIDED)
    for k, name in enumerate(mechanisms):
        if name == WATT_II and kind in KINDS[:3]:
            yield ("mechanism", k), 'is made for functions only: task = "function"'
        elif name not in (*known, *GUIDED) and kind != "improve":
            made = (*MECHANISMS[:2], WATT_II) if kind == "function" else known
            told = " or ".join(f'"{one}"' for one in made)
            yield ("mechanism", k), f"must be {told}, got {as_told(name)}"
        of_poses = name in (MECHANISMS[2], *GUIDED) and tuple(mechanisms) != MECHANISMS
        if of_poses and kind not in ("motion", "improve"):
            yield ("mechanism", k), "is made from poses only: leave it out"
        if name == WATT_II and len(mechanisms) > 1 and kind == "function":
            yield ("mechanism", k), "meets more pairs than others: make it a task of its own"
    if kind == "function" and set(mechanisms) == set(MECHANISMS[:2]):
        told = "of a function is one kind: four-bars give angles, slider-cranks displacements"
        yield ("mechanism",), told


def watt_pivot_problems(
    fixed: Sequence[tuple[float, float]],
    moving: Sequence[tuple[float, float]],
    goal: FunctionGoal | None,
) -> _Problems:
    """Given pivots that a Watt-II six-bar cannot use."""
    if moving:
        yield ("given", "moving_pivots"), "has no effect on functions: leave it out"
    if not fixed:
        return
    if len(fixed) != _WATT_PIVOTS or fixed[1] in (fixed[0], fixed[2]):
        told = "must be three pivots, A0, B0 and C0, of which neighbours differ"
        yield ("given", "fixed_pivots"), told
    elif goal is not None and goal.starts_fixed:
        told = "leave the start angles no choice: leave out the pivots, or input and output"
        yield ("given", "fixed_pivots"), told
