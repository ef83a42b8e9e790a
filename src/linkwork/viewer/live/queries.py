"""Questions about a mechanism, which change nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import singledispatch
from types import MappingProxyType

from linkwork.foundation.errors import InputError
from linkwork.numerics.newton import NewtonOptions
from linkwork.viewer.live import events as tell, requests as ask, result_events as telling
from linkwork.viewer.live.solvable import Solvable

__all__ = ["Query", "answered", "nearest_closure"]

Query = ask.SolveAt | ask.ListConfigurations | ask.NewtonSteps

_MOST_ITERATIONS = 200


@singledispatch
def answered(query: Query, mechanism: Solvable) -> list[tell.Event]:
    """The answer to a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism.
    """
    raise TypeError(f"{type(query).__name__} is not a question")


@answered.register
def _(query: ask.SolveAt, mechanism: Solvable) -> list[tell.Event]:
    at = query.at or None
    position = mechanism.solve(at, configuration=query.configuration)
    events: list[tell.Event] = [telling.position_found(position)]
    if not position.status.ok:
        failure = position.failure
        remedies = {} if failure is None else {r.length: r.needed for r in failure.remedies}
        events.append(nearest_closure(mechanism, at, position.message, remedies))
    return events


@answered.register
def _(query: ask.ListConfigurations, mechanism: Solvable) -> list[tell.Event]:
    return [telling.configurations_found(mechanism.configurations(query.at or None))]


@answered.register
def _(query: ask.NewtonSteps, mechanism: Solvable) -> list[tell.Event]:
    if not 1 <= query.max_steps <= _MOST_ITERATIONS:
        raise InputError(f"max_steps must be from 1 to {_MOST_ITERATIONS}")
    options = NewtonOptions(max_steps=query.max_steps)
    if query.full_steps:
        options = replace(options, largest_turn=math.inf)
    guess, at = query.guess, query.at or None
    if query.pull:
        guess = mechanism.pulled_guess(query.pull, (query.x, query.y), guess, at)
    shown = mechanism.iterates(guess, at, options=options)
    return [telling.newton_shown(shown, guess, mechanism.guessed_points())]


def nearest_closure(
    mechanism: Solvable,
    at: Mapping[str, float] | None,
    message: str,
    remedies: Mapping[str, float],
    elsewhere: Mapping[str, float] = MappingProxyType({}),
) -> tell.CannotClose:
    """The position nearest to closure, with lengths and inputs that would close the loops."""
    return telling.cannot_close(mechanism.nearest_assembly(at), message, remedies, elsewhere)
