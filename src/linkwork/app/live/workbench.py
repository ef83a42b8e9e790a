"""Edits of a mechanism as edits of its text; the file reader checks the result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import singledispatch, singledispatchmethod

from linkwork.app.live.cycle import Cycle
from linkwork.app.live.drawn_parts import edits_of_drawing
from linkwork.app.live.events import PaletteShown, PointMoved, Refused, StartOffered
from linkwork.app.live.file_state import FileState
from linkwork.app.live.force_entries import (
    FORMS,
    drop_lost_loads,
    entry_title,
    put_force_entry,
    put_mass,
)
from linkwork.app.live.history import History
from linkwork.app.live.messages import About, Query, answered, kind_of, reply
from linkwork.app.live.moving_points import (
    Before,
    add_entry,
    carry,
    check_point,
    drop_loose_dimensions,
    drop_lost_inputs,
    held_places,
    move_points,
    points_of,
    rounded,
)
from linkwork.app.live.number_edits import TypedUnits, set_input, set_number
from linkwork.app.live.opened_file import (
    FILE_REQUESTS,
    Drag,
    Events,
    MechanismFile,
    OpenedFile,
    goes_on,
    new_file,
    same_thing,
)
from linkwork.app.live.palette import PALETTE, alone_with, part_of, part_row, put_entry
from linkwork.app.live.requests import (
    EDITS,
    AddJoint,
    AddLink,
    AddOutput,
    AddPart,
    AddPoint,
    AssembleAt,
    Cancel,
    ChangeUnits,
    ChooseConfiguration,
    DrawPart,
    Duplicate,
    Edit,
    Export,
    Mirror,
    MovePoint,
    MovePoints,
    OpenExample,
    Question,
    Reload,
    RemoveJoint,
    RemoveLink,
    RemovePart,
    RemovePoint,
    Rename,
    Request,
    ReverseLink,
    SetEntry,
    SetGround,
    SetInput,
    SetMass,
    SetNumber,
    SetPart,
    SetSheet,
    SetText,
    ShowQuantities,
    Simulate,
    Together,
    TracePoint,
)
from linkwork.app.live.result_events import file_state, problems_found
from linkwork.app.live.subject import Read, Subject, read_subject, sketch_at
from linkwork.core.foundation.errors import (
    InputError,
    MechanismError,
    Problem,
    UnknownNameError,
    choices,
)
from linkwork.core.foundation.names import GROUND, canonical, find_spelling
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.entries import copy_selection, mirror_numbers, names_in_file, rename
from linkwork.design.edits.unit_change import change_units


@dataclass(frozen=True, kw_only=True)
class Followed:
    """The dimensions changed with a point, and those that stayed."""

    followed: tuple[str, ...] = ()
    stayed: tuple[str, ...] = ()


@singledispatch
def applied(edit: Edit, text: TextEdits, before: Before) -> Followed:
    """Apply a change to a text.

    Raises
    ------
    InputError, UnknownNameError
        If a name does not exist, or exists already; the text is then invalid.
    """
    raise TypeError(f"{type(edit).__name__} is not an edit of a file")


@applied.register
def _(edit: SetNumber, text: TextEdits, before: Before) -> Followed:
    set_number(edit, text, before)
    return Followed()


@applied.register
def _(edit: MovePoint, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    point = _known_point(linkage, edit.point)
    places = {point: complex(edit.x, edit.y)}
    followed, stayed = move_points(text, before, linkage, places, follow=edit.lengths_follow)
    return Followed(followed=followed, stayed=stayed)


@applied.register
def _(edit: MovePoints, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    targets = {_known_point(linkage, name): complex(*place) for name, place in edit.places.items()}
    places = held_places(linkage, before, targets, edit.keep)
    followed, stayed = move_points(text, before, linkage, places, keep=edit.keep)
    return Followed(followed=followed, stayed=stayed)


def _sketched(before: Before) -> Draft:
    if isinstance(before.description, Draft):
        return before.description
    raise InputError(
        "the points of this file follow from its equations: change a dimension instead"
    )


def _known_point(linkage: Draft, name: str) -> str:
    point = find_spelling(name, linkage.points)
    if point not in linkage.points:
        raise UnknownNameError(
            f'there is no point "{name}" {choices("points", linkage.points, name)}'
        )
    return point


@applied.register
def _(edit: SetInput, text: TextEdits, before: Before) -> Followed:
    set_input(edit, text, before)
    return Followed()


@applied.register
def _(edit: AddPoint, text: TextEdits, before: Before) -> Followed:
    units = TypedUnits.of(before.description)
    place = [units.number(c, "length", letter) for c, letter in ((edit.x, "x"), (edit.y, "y"))]
    for c in place:
        before.description.numbers(c)  # refuses a formula that has no value
    add_entry(text, "points", edit.name, [c if isinstance(c, str) else rounded(c) for c in place])
    for link in edit.links:
        carry(text, link, edit.name)
    return Followed()


@applied.register
def _(edit: AddLink, text: TextEdits, before: Before) -> Followed:
    for name in edit.points:
        check_point(text, name)
    add_entry(text, "links", edit.name, list(edit.points))
    return Followed()


@applied.register
def _(edit: SetGround, text: TextEdits, before: Before) -> Followed:
    fixed = points_of(text, GROUND) if text.has(("links", GROUND)) else []
    targets = {canonical(name): check_point(text, name) for name in edit.points}
    left = [point for point in fixed if canonical(point) not in targets]
    if on := [*left, *targets.values()] if edit.on else left:
        text.put(("links", GROUND), on)
    elif fixed:
        text.remove(("links", GROUND))
    drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: AddJoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.point)
    carry(text, edit.link, edit.point)
    return Followed()


@applied.register
def _(edit: RemoveJoint, text: TextEdits, before: Before) -> Followed:
    points = points_of(text, edit.link)
    left = [point for point in points if canonical(point) != canonical(edit.point)]
    if len(left) == len(points):
        message = f'"{edit.link}" does not carry "{edit.point}" {choices("points", points)}'
        raise UnknownNameError(message)
    text.put(("links", edit.link), left)
    drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: RemoveLink, text: TextEdits, before: Before) -> Followed:
    points_of(text, edit.name)
    text.remove(("links", edit.name))
    drop_loose_dimensions(text)
    drop_lost_inputs(text, edit.name)
    drop_lost_loads(text, edit.name)
    return Followed()


@applied.register
def _(edit: ReverseLink, text: TextEdits, before: Before) -> Followed:
    first, second, *rest = [*points_of(text, edit.name), "", ""]
    if not second:
        raise InputError(f'"{edit.name}" has no direction: it has one point')
    text.put(("links", edit.name), [second, first, *filter(None, rest)])
    return Followed()


@applied.register
def _(edit: RemovePoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.name)
    text.remove(("points", edit.name))
    for link in text.keys(("links",)):
        points = points_of(text, link)
        left = [point for point in points if canonical(point) != canonical(edit.name)]
        if not left:
            text.remove(("links", link))
        elif len(left) < len(points):
            text.put(("links", link), left)
    if traced := text.names(("trace", "points")):
        left = [point for point in traced if canonical(point) != canonical(edit.name)]
        text.put(("trace", "points"), left)
    drop_loose_dimensions(text)
    drop_lost_loads(text, edit.name)
    return Followed()


@applied.register
def _(edit: SetMass, text: TextEdits, before: Before) -> Followed:
    put_mass(edit, text)
    return Followed()


@applied.register
def _(edit: SetEntry, text: TextEdits, before: Before) -> Followed:
    put_force_entry(edit, text, before.description)
    return Followed()


@applied.register
def _(edit: AddPart, text: TextEdits, before: Before) -> Followed:
    units = TypedUnits.of(before.description)
    text.append(edit.table, part_of(edit.table, edit.typed, units))
    return Followed()


@applied.register
def _(edit: DrawPart, text: TextEdits, before: Before) -> Followed:
    for each in edits_of_drawing(edit, before):
        applied(each, text, before)
    return Followed()


@applied.register
def _(edit: SetPart, text: TextEdits, before: Before) -> Followed:
    put_entry(edit, text, TypedUnits.of(before.description))
    return Followed()


@applied.register
def _(edit: RemovePart, text: TextEdits, before: Before) -> Followed:
    text.remove(part_row(text, edit.name))
    drop_lost_inputs(text, edit.name)
    drop_lost_loads(text, edit.name)
    if edit.whole and isinstance(before.description, Draft):
        for each in alone_with(edit.name, before.description):
            applied(each, text, before)
    return Followed()


@applied.register
def _(edit: TracePoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.point)
    traced = text.names(("trace", "points"))
    left = [point for point in traced if canonical(point) != canonical(edit.point)]
    if edit.on:
        left.append(edit.point)
    if left:
        text.put(("trace", "points"), left)
    elif text.has(("trace",)):
        text.remove(("trace",))
    return Followed()


@applied.register
def _(edit: ChangeUnits, text: TextEdits, before: Before) -> Followed:
    change_units(text, length=edit.length, angle=edit.angle, convert=edit.convert)
    return Followed()


@applied.register
def _(edit: Rename, text: TextEdits, before: Before) -> Followed:
    rename(text, edit.of, edit.name, edit.new.strip())
    return Followed()


@applied.register
def _(edit: Duplicate, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    taken = names_in_file(text)
    for name, copy in edit.names.items():
        if canonical(name) != canonical(copy) and canonical(copy) in taken:
            raise InputError(f'"{copy}" is already in the file: choose another name')
    for point, place in edit.places.items():
        _known_point(linkage, point)
        if point not in edit.names:
            raise InputError(f'the copy of "{point}" needs a name')
        add_entry(text, "points", edit.names[point], [rounded(c) for c in place])
    copy_selection(text, edit.names, mirrored=edit.mirrored)
    return Followed()


@applied.register
def _(edit: Mirror, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    places = {_known_point(linkage, name): complex(*at) for name, at in edit.places.items()}
    mirror_numbers(text, set(map(canonical, places)))
    followed, stayed = move_points(text, before, linkage, places)
    return Followed(followed=followed, stayed=stayed)


@applied.register
def _(edit: AddOutput, text: TextEdits, before: Before) -> Followed:
    add_entry(text, "outputs", edit.name, edit.formula)
    return Followed()


@applied.register
def _(edit: ChooseConfiguration, text: TextEdits, before: Before) -> Followed:
    if edit.name:
        text.put(("configuration",), edit.name)
    elif text.has(("configuration",)):
        text.remove(("configuration",))
    return Followed()


def edit_title(edit: Edit) -> str:
    """A change in a few words, for the history."""
    match edit:
        case SetNumber():
            value = edit.value if isinstance(edit.value, str) else f"{edit.value:.12g}"
            return f"{edit.name} = {value}"
        case MovePoint():
            return f"move {edit.point}"
        case MovePoints():
            return f"move {', '.join(edit.places)}"
        case DrawPart():
            return f"add {PARTS[edit.table].title.lower()}"
        case SetMass():
            return f"mass of {edit.link}"
        case SetPart():
            return f"{edit.name}: {edit.key}"
        case SetEntry():
            return entry_title(edit)
        case ChangeUnits():
            units = " and ".join(filter(None, (edit.length, edit.angle)))
            return f"{'convert to' if edit.convert else 'relabel as'} {units}"
        case Rename():
            return f"rename {edit.name} as {edit.new.strip()}"
        case Duplicate():
            how = "mirror a copy of" if edit.mirrored else "duplicate"
            return f"{how} {', '.join(edit.names)}"
        case Mirror():
            return f"mirror {', '.join(edit.places)}"
        case ChooseConfiguration():
            return f"configuration {edit.name}".strip()
        case _:
            name = getattr(edit, "name", None) or getattr(edit, "point", "")
            return f"{kind_of(type(edit)).replace('_', ' ')} {name}".strip()


# ----------------------------------------------------------------------
# The problems with which an edit is refused.


Refusing = Callable[[Problem], bool]

#: Edits that change numbers or choices, not parts.
_OF_NUMBERS = (
    SetNumber, SetPart, SetEntry, MovePoint, MovePoints, SetInput,
    ChooseConfiguration, TracePoint, ChangeUnits, AddOutput,
)  # fmt: skip


def refusing(edit: Edit) -> Refusing:
    """The problems with which an edit is refused.

    An edit that only changes numbers or choices may not cause any, and a new part may not be wrong
    itself; other edits may leave a draft.
    """
    if isinstance(edit, _OF_NUMBERS):
        return lambda problem: True
    if isinstance(edit, AddPart | DrawPart):
        return lambda problem: problem.key[:1] == (edit.table,)
    return lambda problem: False


# ----------------------------------------------------------------------
# A mechanism file under edit: every change is read, solved, reported and kept in the history.


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
