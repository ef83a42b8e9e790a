"""Questions about a mechanism and its motion: circuits, quantities, files, links."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import singledispatch

from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Group
from linkwork.results.quantities.registry import Call
from linkwork.viewer.live import events as tell, requests as ask, result_events as telling
from linkwork.viewer.live.circuit_events import circuits_found
from linkwork.viewer.live.exported_file import exported_file
from linkwork.viewer.live.link_making import link_made
from linkwork.viewer.live.subject import Subject

__all__ = ["About", "GivenUpError", "Hurry", "check_quantities", "reply"]

_MOST_QUANTITIES = 40  # shown besides the usual ones
_POSITION_DERIVATIVES = 2

Events = list[tell.Event]


class Hurry(IntEnum):
    """Whether work should end: for a cancellation, which keeps its best results, or a change."""

    NONE = 0
    STOP = 1
    CHANGE = 2


class GivenUpError(Exception):
    """A computation was cancelled because of a newer change."""


@dataclass(frozen=True, kw_only=True)
class About:
    """What is asked about: a text with its mechanism, its motion if it has one, and its file.

    ``progress`` receives the finished fraction and may raise :class:`GivenUpError`.
    """

    subject: Subject
    motion: Motion | None
    text: str
    file: str
    progress: Callable[[float], None]


@singledispatch
def reply(request: ask.Question, about: About) -> Events:
    """The events that answer a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism, or the answer was cancelled.
    """
    raise TypeError(f"{type(request).__name__} is not a question")


@reply.register
def _(request: ask.ListCircuits, about: About) -> Events:
    try:
        circuits = about.subject.mechanism.circuits(progress=about.progress)
    except GivenUpError:
        raise InputError("the search for circuits was ended by a change: list them again") from None
    return [circuits_found(circuits, about.motion)]


@reply.register
def _(request: ask.ListQuantities, about: About) -> Events:
    motion = about.motion
    if motion is None:
        return [tell.QuantitiesListed(quantities=())]
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
        )
    ]


def _derivatives(group: Group, needs: int) -> int:
    """How many derivatives of a quantity are known."""
    return 0 if group is Group.EVIDENCE else max(0, _POSITION_DERIVATIVES - needs)


@reply.register
def _(request: ask.Export, about: About) -> Events:
    if request.simulated and request.format != "csv":
        raise InputError(f"a simulation is written as csv, not as {request.format}")
    try:
        file = exported_file(
            request.format,
            about.subject,
            about.motion,
            about.text,
            row=request.row,
            dark=request.dark,
            progress=about.progress,
        )
    except GivenUpError:
        raise InputError(f"the {request.format} file was ended by a change: ask again") from None
    return [telling.exported(file, about.file, "-simulation" if request.simulated else "")]


@reply.register
def _(request: ask.MakeLink, about: About) -> Events:
    return [link_made(about.text, about.subject.description.name, request.app)]


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
