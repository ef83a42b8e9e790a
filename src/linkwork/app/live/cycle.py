"""The cycle in the form that the front end draws, updated quickly during a drag."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from linkwork.app.live.answers import GivenUpError, answered, check_quantities, nearest_closure
from linkwork.app.live.events import Event, MotionFound, SimulationFound, SketchShown
from linkwork.app.live.requests import SetSheet, Simulate, SolveAt
from linkwork.app.live.result_events import motion_found
from linkwork.app.live.simulated import not_simulated, simulate, simulation_found
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
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.dimensions import LARGEST
from linkwork.core.motion.iterating import moving_loops
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion


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


_MOST_ROWS = 3601  # rows of a cycle solved interactively
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
        if count <= _MOST_ROWS or len(rows) > 1:
            return mechanism.sweep(progress=self.go_on), ""
        step = (rows[0][-1] - rows[0][0]) / (_FEWER_ROWS - 1)
        message = f"shown at {_FEWER_ROWS} of the {count} rows of the file"
        return mechanism.sweep(step=float(step), progress=self.go_on), message
