"""Answers to questions about a mechanism, which change nothing."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import singledispatch

from linkwork.foundation.errors import InputError
from linkwork.numerics.newton import NewtonOptions
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Group
from linkwork.results.quantities.registry import Call
from linkwork.viewer.live import events as tell, requests as ask, result_events as telling
from linkwork.viewer.live.circuit_events import circuits_found
from linkwork.viewer.live.exported_file import exported_file
from linkwork.viewer.live.solvable import Solvable

__all__ = ["GivenUpError", "Subject", "answered", "check_quantities"]

_MOST_ITERATIONS = 200
_MOST_QUANTITIES = 40  # shown besides the usual ones
_POSITION_DERIVATIVES = 2

Events = list[tell.Event]


class GivenUpError(Exception):
    """A computation was cancelled because of a newer change."""


@dataclass(frozen=True, kw_only=True)
class Subject:
    """What is asked about: a mechanism, its proved motion if it has one, its text and file.

    ``progress`` is told the finished fraction and may raise :class:`GivenUpError`.
    """

    mechanism: Solvable
    motion: Motion | None
    text: str
    file: str
    progress: Callable[[float], None]


@singledispatch
def answered(request: ask.Request, subject: Subject) -> Events:
    """The events that answer a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism.
    """
    raise TypeError(f"{type(request).__name__} is not a question")


@answered.register
def _(request: ask.ListConfigurations, subject: Subject) -> Events:
    return [telling.configurations_found(subject.mechanism.configurations(request.at or None))]


@answered.register
def _(request: ask.NewtonSteps, subject: Subject) -> Events:
    if not 1 <= request.max_steps <= _MOST_ITERATIONS:
        raise InputError(f"max_steps must be from 1 to {_MOST_ITERATIONS}")
    options = NewtonOptions(max_steps=request.max_steps)
    if request.full_steps:
        options = replace(options, largest_turn=math.inf)
    mechanism, guess, at = subject.mechanism, request.guess, request.at or None
    if request.pull:
        guess = mechanism.pulled_guess(request.pull, (request.x, request.y), guess, at)
    shown = mechanism.iterates(guess, at, options=options)
    return [telling.newton_shown(shown, guess, mechanism.guessed_points())]


@answered.register
def _(request: ask.ListCircuits, subject: Subject) -> Events:
    try:
        circuits = subject.mechanism.circuits(progress=subject.progress)
    except GivenUpError:
        raise InputError("the search for circuits was ended by a change: list them again") from None
    return [circuits_found(circuits, subject.motion)]


@answered.register
def _(request: ask.ListQuantities, subject: Subject) -> Events:
    motion = subject.motion
    if motion is None:
        return [tell.QuantitiesListed(quantities=(), of_motion=())]
    known = motion.quantities
    listed = list(known.listed(timed=motion.speed is not None))
    own = {**known.own, **known.derived, **known.evidence}
    return [
        tell.QuantitiesListed(
            quantities=tuple(
                tell.QuantityListed(
                    name=line.name,
                    unit=line.unit,
                    about=line.about,
                    derivatives=_derivatives(asked.group, asked.needs),
                )
                for line in listed
                if (asked := own.get(line.name)) is not None
            ),
            of_motion=tuple(line.name for line in listed if line.kind == "of a motion"),
        )
    ]


def _derivatives(group: Group, needs: int) -> int:
    """How many derivatives of a quantity are known."""
    return 0 if group is Group.EVIDENCE else max(0, _POSITION_DERIVATIVES - needs)


@answered.register
def _(request: ask.Export, subject: Subject) -> Events:
    try:
        file = exported_file(
            request.format,
            subject.mechanism,
            subject.motion,
            subject.text,
            row=request.row,
            dark=request.dark,
            progress=subject.progress,
        )
    except GivenUpError:
        raise InputError(f"the {request.format} file was ended by a change: ask again") from None
    return [telling.exported(file, subject.file)]


def check_quantities(motion: Motion, names: Sequence[str]) -> None:
    """Check that a motion has these quantities, rates and numbers.

    Raises
    ------
    InputError, UnknownNameError
        If there are too many, or one does not exist; with the nearest names.
    """
    if len(names) > _MOST_QUANTITIES:
        raise InputError(f"at most {_MOST_QUANTITIES} quantities are shown, got {len(names)}")
    for name in names:
        if "(" in name:
            motion.quantities.find_of_motion(str(Call.read(name)))
        else:
            motion.quantity(name)
