"""The link of an edited file, with its QR code and its HTML for other pages."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import singledispatch
from types import MappingProxyType

from linkwork.app.live.events import CannotClose, Event, LinkMade, QuantitiesListed, QuantityListed
from linkwork.app.live.requests import (
    Export,
    ListCircuits,
    ListConfigurations,
    ListQuantities,
    MakeLink,
    NewtonSteps,
    Question,
    SolveAt,
)
from linkwork.app.live.result_events import (
    cannot_close,
    circuits_found,
    configurations_found,
    exported,
    exported_file,
    newton_shown,
    position_found,
)
from linkwork.app.live.subject import Subject
from linkwork.app.pages.offline_page import embed_snippet, qr_svg
from linkwork.circuits.failure.remedies import nearest_assembly
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.motion.iterating import guessed_points, pulled_guess
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Group
from linkwork.core.results.quantities.registry import Call
from linkwork.core.textfile.link import link_of


def link_made(text: str, title: str, app: str) -> LinkMade:
    """The text of a file as a link to an app; with ``app`` empty as a fragment only.

    Raises
    ------
    InputError
        If the text is too long for a link, or ``app`` is not the address of a page.
    """
    if not app:
        return LinkMade(link=link_of(text), embed="", qr="", note="")
    link = link_of(text, app)
    try:
        qr, note = qr_svg(link), ""
    except InputError as error:  # too long, or segno is missing; a page in a browser has none
        qr, note = "", "" if sys.platform == "emscripten" else str(error)
    return LinkMade(link=link, embed=embed_snippet(link, title), qr=qr, note=note)


# ----------------------------------------------------------------------
# Questions about a mechanism and its motion: circuits, quantities, files, links.


_MOST_QUANTITIES = 40  # shown besides the usual ones
_POSITION_DERIVATIVES = 2

Events = list[Event]


class Hurry(IntEnum):
    """Whether work should end: for a cancellation, which keeps its best results, or a change."""

    NONE = 0
    STOP = 1
    CHANGE = 2


class GivenUpError(Exception):
    """A computation was cancelled because of a newer change."""


@dataclass(frozen=True, kw_only=True)
class About:
    """The subject of requests: a text with its mechanism, its motion if it has one, and its file.

    ``progress`` receives the finished fraction and may raise :class:`GivenUpError`.
    """

    subject: Subject
    motion: Motion | None
    text: str
    file: str
    progress: Callable[[float], None]


@singledispatch
def reply(request: Question, about: About) -> Events:
    """The events that answer a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism, or the answer was cancelled.
    """
    raise TypeError(f"{type(request).__name__} is not a question")


@reply.register
def _(request: ListCircuits, about: About) -> Events:
    try:
        circuits = about.subject.mechanism.circuits(progress=about.progress)
    except GivenUpError:
        raise InputError("the search for circuits was ended by a change: list them again") from None
    return [circuits_found(circuits, about.motion)]


@reply.register
def _(request: ListQuantities, about: About) -> Events:
    motion = about.motion
    if motion is None:
        return [QuantitiesListed(quantities=())]
    known = motion.quantities
    listed = list(known.listed(timed=motion.speed is not None))
    quantities = {**known.own, **known.derived, **known.evidence}
    return [
        QuantitiesListed(
            quantities=tuple(
                QuantityListed(
                    name=line.name,
                    unit=line.unit,
                    about=line.about,
                    derivatives=_derivatives(quantity.group, quantity.needs),
                )
                for line in listed
                if (quantity := quantities.get(line.name)) is not None
            ),
        )
    ]


def _derivatives(group: Group, needs: int) -> int:
    """How many derivatives of a quantity are known."""
    return 0 if group is Group.EVIDENCE else max(0, _POSITION_DERIVATIVES - needs)


@reply.register
def _(request: Export, about: About) -> Events:
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
    return [exported(file, about.file, "-simulation" if request.simulated else "")]


@reply.register
def _(request: MakeLink, about: About) -> Events:
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


# ----------------------------------------------------------------------
# Questions about a mechanism, which change nothing.


Query = SolveAt | ListConfigurations | NewtonSteps

_MOST_ITERATIONS = 200


@singledispatch
def answered(query: Query, mechanism: Mechanism) -> list[Event]:
    """The answer to a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism.
    """
    raise TypeError(f"{type(query).__name__} is not a question")


@answered.register
def _(query: SolveAt, mechanism: Mechanism) -> list[Event]:
    at = query.at or None
    position = mechanism.solve(at, configuration=query.configuration)
    events: list[Event] = [position_found(position)]
    if not position.status.ok:
        failure = position.failure
        remedies = {} if failure is None else {r.length: r.needed for r in failure.remedies}
        events.append(nearest_closure(mechanism, at, position.message, remedies))
    return events


@answered.register
def _(query: ListConfigurations, mechanism: Mechanism) -> list[Event]:
    return [configurations_found(mechanism.configurations(query.at or None))]


@answered.register
def _(query: NewtonSteps, mechanism: Mechanism) -> list[Event]:
    if not 1 <= query.max_steps <= _MOST_ITERATIONS:
        raise InputError(f"max_steps must be from 1 to {_MOST_ITERATIONS}")
    options = NewtonOptions(max_steps=query.max_steps)
    if query.full_steps:
        options = replace(options, largest_turn=math.inf)
    guess, at = query.guess, query.at or None
    if query.pull:
        guess = pulled_guess(mechanism.model, query.pull, (query.x, query.y), guess, at)
    shown = mechanism.iterates(guess, at, options=options)
    return [newton_shown(shown, guess, guessed_points(mechanism.model))]


def nearest_closure(
    mechanism: Mechanism,
    at: Mapping[str, float] | None,
    message: str,
    remedies: Mapping[str, float],
    elsewhere: Mapping[str, float] = MappingProxyType({}),
) -> CannotClose:
    """The position nearest to closure, with lengths and inputs that would close the loops."""
    return cannot_close(nearest_assembly(mechanism.model, at), message, remedies, elsewhere)
