"""Simulations that the page requests: motion in time, its events, and forms to correct it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from linkwork.app.live.events import (
    Event,
    FormOffered,
    MotionFound,
    SimulationEvent,
    SimulationFound,
    SketchShown,
)
from linkwork.app.live.messages import GivenUpError, answered, check_quantities, nearest_closure
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.requests import SetSheet, Simulate, SolveAt
from linkwork.app.live.result_events import motion_found
from linkwork.app.live.subject import Subject, closing_input
from linkwork.app.pages.moving_scene import MovingScene, moving_scene
from linkwork.app.pages.packing import shortened, still_shape, unpressed
from linkwork.app.pages.page_building import Loops, drawn_page
from linkwork.app.pages.page_data import PageData
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.labels import Kept
from linkwork.core.drawing.mechanism_scene import traced
from linkwork.core.drawing.paths import trace_symbols
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import Box, Measures
from linkwork.core.foundation.errors import ExpressionError, InputError, MechanismError
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import LARGEST
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.motion.iterating import moving_loops
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.listing import whole_energy
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


# ----------------------------------------------------------------------
# The cycle in the form that the front end draws, updated quickly during a drag.


class MotionPicture:
    """Draws successive motions with the layout of the preceding one as long as the shapes are
    equal, so that names keep their positions.
    """

    def __init__(self) -> None:
        self._scene: MovingScene | None = None

    def page(
        self,
        motion: Motion,
        equations: Sequence[tuple[str, str]] = (),
        loops: Loops | None = None,
        *,
        requested: Sequence[str] = (),
        brief: bool = False,
        rates: bool = True,
    ) -> PageData | None:
        """The data of a page; ``None`` without positions or points.

        ``requested``: further quantities by name. ``brief``: seven digits, no vectors and no
        numbers of the motion, for a picture that is replaced soon; vectors between points are kept.
        ``rates``: with rates of points.
        """
        if not motion.found.any() or not motion.points:
            return None
        try:
            self._scene = moving_scene(motion, like=self._scene, sampled=True)
        except InputError:
            return None
        name = next((branch for branch in motion.branch if branch), motion.mechanism)
        return drawn_page(
            {name: motion},
            [self._scene],
            equations,
            loops=None if brief else loops,
            pack=shortened if brief else unpressed,
            requested=requested,
            brief=brief,
            rates=rates,
        )


def paths_on(sketch: PageData, motion: Motion) -> PageData:
    """The page of a sketch with nothing but the paths of a motion, which has positions."""
    pose = Pose.at_row(motion, int(np.flatnonzero(motion.found)[0]))
    measures = Measures.of(Box(*sketch.view), pose.gaps)
    paths = trace_symbols(pose, traced(pose, None), measures)
    parts = tuple(still_shape(path, measures.size) for path in paths)
    return replace(sketch, motions=(replace(sketch.motions[0], parts=parts),))


# ----------------------------------------------------------------------
# The motion of the mechanism under edit: solved once, cancelled when a newer change waits.


_MOST_SHOWN = 3601  # rows of a cycle solved interactively
_FEWER_ROWS = 721

Events = list[Event]


class Cycle:
    """A mechanism or a draft, with the events that show its motion or its sketch.

    Parameters
    ----------
    subject : Subject

    Attributes
    ----------
    subject : Subject
    motion : Motion or None
        The latest motion, approximate during a drag.
    simulated : Motion or None
        The latest simulation of the current mechanism.
    owed : bool
        Whether a cycle was cancelled and no other has been sent since.
    rates : bool
        Whether rates of points are shown during a drag.
    hurried : callable
        Whether a newer change is waiting, which cancels a cycle.
    working : callable
        Called with the finished fraction of an answer that takes long.
    """

    def __init__(self, subject: Subject) -> None:
        self.hurried: Callable[[], int] = lambda: False
        self.working: Callable[[float], None] = lambda fraction: None
        self.rates = True
        self._shown: tuple[str, ...] = ()  # quantities that the page needs besides the usual ones
        self.begin(subject)

    def begin(self, subject: Subject) -> None:
        """Start with a subject of another file."""
        self.take(subject)
        self.motion: Motion | None = None
        self.owed = False
        self._picture, self._sheet = MotionPicture(), SetSheet(width=0.0)
        self._paths_only = False  # whether the last motion was sent without its parts and columns
        self._kept: Kept = {}  # names and arrows of the sketch stay in their places during a drag

    def take(self, subject: Subject) -> None:
        """Continue with a changed subject."""
        self.subject = subject
        self.simulated: Motion | None = None
        self._solution: Events = []  # of the current mechanism, once solved

    def events(self, *, live: bool = False) -> Events:
        """Solve the cycle; if it cannot be closed, the gap; without input, one position.

        ``live``: approximately, for a picture that is replaced soon.
        """
        if self._solution:
            return self._solution
        mechanism = self.subject.solvable
        if mechanism is None:
            self.motion, self.owed = None, False
            return list(self._sketch(live))
        if not mechanism.description.inputs:
            return answered(SolveAt(at={}), mechanism)
        try:
            motion, message = self._swept(mechanism, live)
        except GivenUpError:
            self.owed = True
            return []
        self.motion, self.owed = motion, False
        event = motion_found(motion, live=live, message=message)
        sketch = self._sketch(live)
        # in an edited sketch nothing else of the motion is seen
        self._paths_only = live and bool(sketch)
        if self._paths_only:
            page = paths_on(sketch[0].page, motion) if motion.found.any() else None
            events: Events = [*sketch, replace(event, page=page)]
        else:
            events = [*sketch, self._pictured(event, motion)]
        if not motion.found.any() and motion.limits:  # in addition to the rows of the table
            events += answered(SolveAt(at={}), mechanism)
        elif all(status is Status.NO_START for status in motion.status):
            failure = motion.failure
            remedies = {} if failure is None else {r.length: r.needed for r in failure.remedies}
            elsewhere = {} if live else closing_input(mechanism)
            events.append(nearest_closure(mechanism, None, motion.message, remedies, elsewhere))
        self._solution = [] if live else events
        return events

    def on_sheet(self, sheet: SetSheet) -> Events:
        """The sketch in a view of another width."""
        if not 0 <= sheet.width <= LARGEST:
            raise InputError(f"the width of the view must be from 0 to {LARGEST:g}")
        self._sheet = sheet
        if self._paths_only and not sheet.edited:
            return self.events()
        return list(self._sketch())

    def with_quantities(self, names: tuple[str, ...]) -> Events:
        """The motion with quantities besides the usual ones."""
        if self.motion is not None:
            check_quantities(self.motion, names)
        self._shown = names
        if self.motion is None or not self._solution:
            return self.events()
        self._solution = [self._pictured(event, self.motion) for event in self._solution]
        return self._solution

    def simulate(self, request: Simulate) -> Events:
        """The requested simulation, or why there is none.

        Raises
        ------
        InputError
            If it was cancelled.
        """
        try:
            self.simulated = simulate(request, self.subject, self.go_on)
        except GivenUpError:
            raise InputError("the simulation was cancelled: simulate again") from None
        except InputError as error:
            return [not_simulated(error, self.subject)]
        self._in_time = MotionPicture()
        return [self._simulation(self.simulated)]

    def simulated_quantities(self, names: tuple[str, ...]) -> Events:
        """The simulation with quantities besides the usual ones."""
        if self.simulated is None:
            return []
        check_quantities(self.simulated, names)
        return [self._simulation(self.simulated, names)]

    def _simulation(self, motion: Motion, names: tuple[str, ...] = ()) -> SimulationFound:
        page = self._in_time.page(motion, requested=names)
        return simulation_found(motion, page, self.subject)

    def driven_motion(self, *, proved: bool) -> Motion | None:
        """The latest motion of a mechanism with inputs, or its ``proved`` motion on request.

        Raises
        ------
        InputError
            If a newer change ended the proved motion.
        """
        mechanism = self.subject.solvable
        if mechanism is None or not mechanism.description.inputs:
            return None
        if proved and not self._solution and not self.events():
            raise InputError("the motion was ended by a change: ask again")
        return self.motion

    def go_on(self, fraction: float) -> None:
        """Report progress, or give up for a newer change.

        Raises
        ------
        GivenUpError
            If a newer change is waiting.
        """
        if self.hurried():
            raise GivenUpError
        self.working(fraction)

    def _sketch(self, live: bool = False) -> list[SketchShown]:
        """The points as sketched, if they are edited in the drawing or there is no motion."""
        if self.subject.solvable is not None and not self._sheet.edited:
            return []
        if not live:
            self._kept.clear()
        page = self.subject.page(self._sheet.width / 2, self._kept, certify=not live)
        return [] if page is None else [SketchShown(page=page)]

    def _pictured(self, event: Event, motion: Motion) -> Event:
        """A motion with the data of its page."""
        if not isinstance(event, MotionFound):
            return event
        mechanism, shown = self.subject.mechanism, self._shown
        equations = () if event.live else mechanism.equations().mathml()
        page = self._picture.page(
            motion,
            equations,
            partial(moving_loops, mechanism.model),
            requested=shown,
            brief=event.live,
            rates=self.rates or not event.live,
        )
        return replace(event, page=page)

    def _swept(self, mechanism: Mechanism, live: bool) -> tuple[Motion, str]:
        if live:
            return sweep(mechanism.model, certify=False, explained=False), ""
        description = mechanism.description
        rows = [description.rows(which) for which in description.inputs]
        count = max(map(len, rows))
        if count <= _MOST_SHOWN or len(rows) > 1:
            return mechanism.sweep(progress=self.go_on), ""
        step = (rows[0][-1] - rows[0][0]) / (_FEWER_ROWS - 1)
        message = f"shown at {_FEWER_ROWS} of the {count} rows of the file"
        return mechanism.sweep(step=float(step), progress=self.go_on), message
