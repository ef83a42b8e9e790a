"""A mechanism file under edit: every change is read, solved, reported and kept in the history."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import singledispatchmethod

from linkwork.app.live.answers import About, Query, answered, reply
from linkwork.app.live.cycle import Cycle
from linkwork.app.live.edits import Followed, Refusing, applied, edit_title, refusing
from linkwork.app.live.events import PaletteShown, PointMoved, Refused, StartOffered
from linkwork.app.live.file_state import FileState
from linkwork.app.live.force_entries import FORMS
from linkwork.app.live.history import History
from linkwork.app.live.mechanism_file import MechanismFile, new_file
from linkwork.app.live.moving_points import Before
from linkwork.app.live.opened_file import (
    FILE_REQUESTS,
    Drag,
    Events,
    OpenedFile,
    goes_on,
    same_thing,
)
from linkwork.app.live.palette import PALETTE
from linkwork.app.live.requests import (
    EDITS,
    AddJoint,
    AddLink,
    AddPart,
    AddPoint,
    AssembleAt,
    Cancel,
    DrawPart,
    Edit,
    Export,
    MovePoint,
    OpenExample,
    Question,
    Reload,
    Request,
    SetSheet,
    SetText,
    ShowQuantities,
    Simulate,
    Together,
)
from linkwork.app.live.result_events import file_state, problems_found
from linkwork.app.live.subject import Read, Subject, read_subject, sketch_at
from linkwork.core.foundation.errors import InputError, MechanismError
from linkwork.core.textfile.text_edits import TextEdits
from linkwork.core.textfile.toml_text import data_of

#: Requests that add text: their problems are at lines that the file does not have.
_ADDING = (AddPoint, AddLink, AddJoint, AddPart, DrawPart, Together)


class Workbench(OpenedFile):
    """One mechanism file, its text, its history and its motion.

    Parameters
    ----------
    file : MechanismFile
    read : callable
        Builds a solvable mechanism from a text; ``linkwork.loads``.
    start : bool
        Offer the start page.

    Attributes
    ----------
    cycle : Cycle
        The subject and its motion.
    """

    def __init__(
        self,
        file: MechanismFile,
        read: Read,
        *,
        start: bool = False,
    ) -> None:
        super().__init__(file)
        self._read, self._begun = read, not start
        self.cycle = Cycle(self._read_whatever(file.text))
        self._drag: Drag | None = None

    @property
    def text(self) -> str:
        """The current text, including an intermediate change."""
        on_the_way = None if self._drag is None else self._drag.latest
        return self._history.text if on_the_way is None else on_the_way

    def opened(self) -> Events:
        """All events that a page needs at its start."""
        start: Events = [] if self._begun else [StartOffered()]
        return [PaletteShown(parts=PALETTE, forms=FORMS), *start, *self._everything()]

    def handle(self, request: Request) -> Events:
        """Process a request and send its events; invalid requests are answered, not raised."""
        try:
            if not goes_on(request, self._drag):
                self._end_drag()
            return self._handle(request)
        except MechanismError as error:
            problems = problems_found(error, lines=not isinstance(request, _ADDING))
            events: Events = [problems, *self._after_refusal(request)]
        except InputError as error:
            events = [Refused(message=str(error)), *self._after_refusal(request)]
        return [*events, *(self.cycle.events() if self.cycle.owed else [])]

    def listen(self, hurried: Callable[[], int], working: Callable[[float], None]) -> None:
        """Let long work end for a newer change, and report its progress."""
        self.cycle.hurried, self.cycle.working = hurried, working

    # Requests

    @singledispatchmethod
    def _handle(self, request: Request) -> Events:
        if isinstance(request, EDITS):
            return self._edited(request)  # type: ignore[arg-type]
        if isinstance(request, FILE_REQUESTS):
            return self._on_file(request)
        if isinstance(request, Query):
            return answered(request, self.cycle.subject.mechanism)
        if isinstance(request, Question):
            timed = getattr(request, "simulated", False)
            about = self._about(proved=isinstance(request, Export) and not timed)
            return reply(request, replace(about, motion=self.cycle.simulated) if timed else about)
        raise TypeError(f"{type(request).__name__} is not a request")

    def _edited(self, edit: Edit) -> Events:
        """Apply a change, intermediate or final."""
        live = bool(getattr(edit, "live", False))
        self.cycle.rates = bool(getattr(edit, "rates", True))
        drag = self._drag
        if drag is None:
            drag = Drag(kind=same_thing(edit), text=self._text_edits(), before=self._before())
        self._drag = drag
        try:
            followed = applied(edit, drag.text, drag.before)
            text = drag.text.text
            events = self._accepted(text, edit_title(edit), live=live, refused=refusing(edit))
        except InputError:
            drag.text = TextEdits(self.text)  # without traces of the failed change
            raise
        if live:
            drag.latest, drag.what = text, edit_title(edit)
        return [*_followed(edit, followed), *events]

    def _text_edits(self) -> TextEdits:
        """The text, for edits of its entries."""
        if not self.cycle.subject.readable:
            try:
                data_of(self.text, self._file.name)
            except MechanismError as error:
                (problem,) = error.problems
                place = f"line {problem.line} " if problem.line else "it "
                raise InputError(f"correct the text first: {place}{problem.message}") from None
        return TextEdits(self.text)

    def _after_refusal(self, request: Request) -> Events:
        """End a refused drag at its last accepted change, and report it."""
        drag = self._drag
        if drag is None or getattr(request, "live", False):
            return []
        self._end_drag()
        return [] if drag.latest is None else self._everything()

    @_handle.register
    def _(self, request: Together) -> Events:
        text, before = self._text_edits(), self._before()
        for edit in request.edits:
            applied(edit, text, before)
        return self._accepted(text.text, "; ".join(map(edit_title, request.edits)))

    @_handle.register
    def _(self, request: AssembleAt) -> Events:
        return self._handle(Together(edits=sketch_at(self.cycle.subject.mechanism, request.at)))

    @_handle.register
    def _(self, request: SetText) -> Events:
        return self._accepted(request.text, "text")

    @_handle.register
    def _(self, request: OpenExample) -> Events:
        if self.unsaved and not request.discard:
            raise InputError(
                f'changes of "{self._file.name}" are not saved: save them first, or discard them'
            )
        self._open(new_file(request.name))
        return self._everything()

    @_handle.register
    def _(self, request: Reload) -> Events:
        return self._reloaded()

    @_handle.register
    def _(self, request: SetSheet) -> Events:
        return self.cycle.on_sheet(request)

    @_handle.register
    def _(self, request: ShowQuantities) -> Events:
        if request.simulated:
            return self.cycle.simulated_quantities(request.names)
        return self.cycle.with_quantities(request.names)

    @_handle.register
    def _(self, request: Simulate) -> Events:
        return self.cycle.simulate(request)

    @_handle.register
    def _(self, request: Cancel) -> Events:
        return self.cycle.events() if self.cycle.owed else []  # it ended other work

    # The text and its results

    def _open(self, file: MechanismFile) -> None:
        """Another file, with a new history."""
        self._file, self._history, self._begun = file, History(file.text), True
        self._drag, self._conflict = None, None
        self.cycle.begin(self._read_whatever(file.text))

    def _everything(self) -> Events:
        """The file and its motion."""
        self._end_drag()
        conflict = [] if self._conflict is None else [self._conflict]
        return [self._state(), *self.cycle.events(), *conflict]

    def _before(self) -> Before:
        """The current mechanism, with its points at the assembled start."""
        subject = self.cycle.subject
        return Before(description=subject.description, places=subject.places())

    def _accepted(
        self, text: str, what: str, *, live: bool = False, refused: Refusing = lambda problem: False
    ) -> Events:
        """Read a text and adopt it if it is a mechanism or a draft; otherwise change nothing.

        ``refused``: whether a mechanism may not become a draft with this problem.
        """
        subject = read_subject(text, self._file.name, self._read)
        wrong = [problem for problem in subject.problems if refused(problem)]
        before = self.cycle.subject
        known = {problem.key for problem in before.problems}
        if wrong and (before.solvable is not None or not {w.key for w in wrong} <= known):
            raise MechanismError(wrong, self._file.name)
        self.cycle.take(subject)
        if live:
            return self.cycle.events(live=True)
        self._drag = None
        self._history.add(text, what)
        return [self._state(), *self.cycle.events()]

    def _end_drag(self) -> None:
        """Complete a drag that has not ended."""
        drag, self._drag = self._drag, None
        if drag is not None and drag.latest is not None:
            self._history.add(drag.latest, drag.what)
            self.cycle.take(self.cycle.subject)

    def _went(self) -> Events:
        self.cycle.take(self._read_whatever(self._history.text))
        return [self._state(), *self.cycle.events()]

    def _reloaded(self, refused: Refusing = lambda problem: False) -> Events:
        text = self._file.read()
        events = self._accepted(text, "reload", refused=refused)
        self._file.accept(text)
        self._conflict = None
        return [self._state(), *events[1:]]

    def _taken_over(self) -> Events:
        """Load the changed file on disk, without loss of changes."""
        self._end_drag()
        try:
            events = self._reloaded(refused=lambda problem: True)
        except MechanismError as error:
            return [problems_found(error)]
        return [self._changed(f'"{self._file.name}" has been read again', reloaded=True), *events]

    def _read_whatever(self, text: str) -> Subject:
        return read_subject(text, self._file.name, self._read, whatever=True)

    def _about(self, *, proved: bool) -> About:
        """What questions are about; with its ``proved`` motion, or the latest."""
        return About(
            subject=self.cycle.subject,
            motion=self.cycle.driven_motion(proved=proved),
            text=self.text,
            file=self._file.name,
            progress=self.cycle.go_on,
        )

    def _state(self) -> FileState:
        return file_state(
            self._file.name,
            self.cycle.subject,
            self._history,
            text=self.text,
            unsaved=self.unsaved,
        )


def _followed(edit: Edit, followed: Followed) -> Events:
    if not isinstance(edit, MovePoint):
        return []
    return [PointMoved(point=edit.point, followed=followed.followed, stayed=followed.stayed)]
