"""Functions of a mechanism that find better numbers for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.values import as_told
from linkwork.synthesis.improvement.improving import improved_designs
from linkwork.synthesis.improvement.proved_design import ImprovedDesign
from linkwork.synthesis.improvement.settings import Improvement, read_goal


def improve(
    mechanism: Mechanism,
    goal: Mapping[str, Any] | Sequence[Mapping[str, Any]],
    *,
    vary: Sequence[str] = (),
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fit: str = "least squares",
    front: int = 0,
    starts: int = 16,
    spread: float = 0.05,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> tuple[ImprovedDesign, ...]:
    """Designs that meet goals best, from many starts.

    Parameters
    ----------
    goal : Mapping, or sequence of Mapping
        Points ``{"point": "F", "points": [(x, y), …], "inputs": […]}``, without inputs in their
        order or with ``"order": "any"``; a quantity at inputs ``{"of": "rocker", "at": […],
        "values": […]}``; a quantity, a number of the motion (``dwell(d, 2)``) or a formula of
        either, with ``target``, ``least`` or ``most``; each with ``weight``. File units.
    vary : sequence of str
        Numbers that vary; by default lengths, angles, offsets, dimensions and fixed pivots.
    bounds : Mapping[str, (number, number)], optional
        By default lengths change by a factor of four at most.
    fit : str
        "least squares", or "minimax": the largest miss counts.
    front : int
        Instead of a sum: the largest number of designs between the goals (points, targets and
        values, not bounds) of which no other one is better in every goal.
    starts, spread, seed : int, number, int
        Starts about the mechanism as it is, their relative spread, and their seed; the first
        one is the mechanism itself.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Returns
    -------
    tuple of ImprovedDesign
        Different fits: those with all rows proved first, then by their misses. Of a
        front its designs by rising miss of the first goal, then those that are not proved.
        Ctrl-C keeps the best so far.

    Raises
    ------
    InputError, MechanismError, UnknownNameError
        For a goal that contradicts itself, is not known, or whose derivatives are not known.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar")
    >>> goal = {"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}
    >>> best = lw.synthesis.improve(bar, goal, vary=["A B", "O4 B"], starts=4)[0]
    >>> best.sound
    True
    >>> crank = lw.example("slider-crank")
    >>> goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    >>> front = lw.synthesis.improve(crank, goals, vary=["O2 A"], front=2, starts=1)
    >>> [round(design.goals["stroke(d)"], 4) for design in front]
    [0.0, 49.7142]
    """
    goal_tables = (goal,) if isinstance(goal, Mapping) else tuple(goal)
    for one in goal_tables:
        if not isinstance(one, Mapping):
            raise InputError(
                f'a goal is a table, {{"of": "stroke(d)", "target": 40}}, got {as_told(goal)}; '
                'how misses count is fit = "least squares" or "minimax"'
            )
    settings = Improvement(
        vary=(vary,) if isinstance(vary, str) else tuple(vary),
        bounds=bounds or {},
        fit=fit,
        front=front,
        starts=starts,
        spread=spread,
        seed=seed,
    )
    goals = tuple(map(read_goal, goal_tables))
    return improved_designs(mechanism.model, goals, settings, progress)
