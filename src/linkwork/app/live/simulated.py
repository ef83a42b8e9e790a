"""Simulations that the page requests: motion in time, its events, and forms to correct it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from linkwork.app.live.events import FormOffered, SimulationEvent, SimulationFound
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.requests import Simulate
from linkwork.app.live.subject import Subject
from linkwork.app.pages.page_data import PageData
from linkwork.core.foundation.errors import ExpressionError, InputError, MechanismError
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.loaded import LoadedBodies
from linkwork.core.results.listing.motion_listing import whole_energy
from linkwork.core.results.motion import Motion

_SMOOTH = 0.04  # between rows [s]: twenty-five pictures per second
_USUAL_ROWS = 400
_MOST_ROWS = 3000

_LABELS = {
    "start": "Change the start",
    "masses": "Give masses to links",
    "motor": "Add a flywheel to the input",
    "stops": "Change the stops",
    "input": "Choose the input",
    "text": "Edit the text of the file",
}


def simulate(request: Simulate, subject: Subject, progress: Callable[[float], None]) -> Motion:
    """The motion in time.

    Raises
    ------
    InputError
        If an entry is not a number, or the mechanism cannot be simulated.
    """
    mechanism = subject.mechanism
    description = mechanism.description
    units = TypedUnits.of(description)
    until = _seconds(request.until, "until")
    step = None if request.step in (None, "") else _seconds(request.step, "step")
    if step is None and until > _USUAL_ROWS * _SMOOTH:
        step = max(_SMOOTH, until / _MOST_ROWS)
    elif step is not None and 0.0 < step < until / _MOST_ROWS:
        raise InputError(
            f"a step of {step:g} s makes more than {_MOST_ROWS} rows, which is too much for a "
            "page: the command linkwork simulate has no such limit"
        )
    at = {
        name: _number(description, units.number(typed, "", f"the start of {name}"), name)
        for name, typed in (request.at or {}).items()
        if typed != ""
    }
    return mechanism.simulate(
        until,
        step=step,
        at=at or None,
        start_speed={
            name: _speed(units.speed(typed))
            for name, typed in (request.start_speeds or {}).items()
            if typed != ""
        }
        or _speed(units.speed(request.start_speed)),
        change_points=request.change_points,
        progress=progress,
    )


def _seconds(typed: float | str | None, what: str) -> float:
    """A time [s]; "0.5 s" and "500 ms" are read as well."""
    text = str(typed).strip().replace(",", ".")
    for unit, factor in (("ms", 1e-3), ("s", 1.0), ("min", 60.0)):
        if text.endswith(unit) and not text[: -len(unit)].strip().endswith("m"):
            text, scale = text[: -len(unit)].strip(), factor
            break
    else:
        scale = 1.0
    try:
        seconds = scale * float(text)
    except ValueError:
        seconds = math.nan
    if not math.isfinite(seconds):
        raise InputError(f'{what} must be a time in seconds, such as 2, got "{typed}"')
    return seconds


def _number(description: Description, typed: float | str, name: str) -> float:
    try:
        return description.numbers(typed)
    except ExpressionError as error:
        raise InputError(f"the start of {name}: {error.message}") from None


def _speed(typed: float | str | None) -> float | str:
    """A speed: plain numbers are in the units of the file."""
    if typed is None or typed == "":
        return 0
    try:
        return float(typed)
    except ValueError:
        return typed


def simulation_found(motion: Motion, page: PageData | None, subject: Subject) -> SimulationFound:
    """A simulated motion as it is shown."""
    complete = bool(motion.found.all())
    times = motion["t"]
    return SimulationFound(
        message=motion.message[:1].upper() + motion.message[1:],
        complete=complete,
        rows=len(motion),
        certified=int(motion.certified.sum()),
        energy=_energy(motion),
        events=tuple(
            SimulationEvent(row=row, t=float(times[row]), text=word)
            for row, word in enumerate(motion.limit)
            if word and motion.found[row]
        ),
        forms=() if complete else tuple(_forms(subject.description, motion.message)),
        page=page,
    )


def not_simulated(error: InputError, subject: Subject) -> SimulationFound:
    """Why there is no simulation, and the forms that mend it."""
    message = str(error)
    if isinstance(error, MechanismError):
        message = "; ".join(problem.message for problem in error.problems)
    return SimulationFound(
        message=message[:1].upper() + message[1:],
        complete=False,
        rows=0,
        certified=0,
        energy="",
        events=(),
        forms=() if subject.solvable is None else tuple(_forms(subject.description, message)),
        page=None,
    )


def _energy(motion: Motion) -> str:
    """The energy at both ends, without a motor and loads the same."""
    if "load_power" not in motion.quantities.derived:
        return ""
    energy = whole_energy(motion)
    known = energy[np.isfinite(energy)]
    if not len(known):
        return ""
    unit = motion.quantity("kinetic_energy").unit
    return f"{known[0]:.10g} at first, {known[-1]:.10g} at last {unit}"


def _forms(description: Description, message: str) -> Iterator[FormOffered]:
    for form in _mending(description, message):
        yield FormOffered(form=form, label=_LABELS[form])


def _mending(description: Description, message: str) -> tuple[str, ...]:
    """The forms in which to correct the problem that a message of a simulation names."""
    if not isinstance(description, LoadedBodies) or description.timed:
        return ("text",)
    if not description.inputs:
        return ("input",)
    if "friction is simulated with one input" in message:
        return ("text",)
    nothing = not description.masses and all(each.inertia is None for each in description.inputs)
    if nothing:
        return "masses", "motor"
    if "no bound" in message:  # nothing has inertia there, or a load switches at rest
        return "masses", "motor", "start"
    if "stop" in message and "straight" not in message:
        return "stops", "start"
    return ("start",)
