"""Events that answer questions about a mechanism: its circuits, its quantities, files of it."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.app.live.file_state import (
    FileState,
    PaletteForm,
    PalettePart,
    Point,
    ProblemShown,
)
from linkwork.app.live.task_events import (
    CognatesFound,
    DesignFound,
    DesignOpened,
    DesignsSuggested,
    TaskSolved,
    TaskState,
    TaskUnsolved,
)
from linkwork.app.pages.page_data import PageData

Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class LimitFound:
    """An end of the motion: a dead point or change point of the input."""

    what: str
    input: float
    located: bool
    sentence: str


@dataclass(frozen=True, kw_only=True)
class BranchFound:
    """A branch of a circuit; ``start`` is the name that starts a motion there."""

    name: str
    start: str
    input_range: Range
    certified: bool


@dataclass(frozen=True, kw_only=True)
class CircuitFound:
    """A circuit: the range of the input, the turns until it closes, its dead points and branches.

    ``current``: it contains the motion of the file.
    """

    name: str
    current: bool
    end: str
    certified: bool
    input_range: Range
    turns: int | None
    limits: tuple[LimitFound, ...]
    branches: tuple[BranchFound, ...]


@dataclass(frozen=True, kw_only=True)
class CircuitsFound:
    """All circuits, and a page with the motion of each."""

    input: str
    input_unit: str
    circuits: tuple[CircuitFound, ...]
    message: str
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class QuantityListed:
    """A quantity that can be plotted, and how many of its derivatives are known."""

    name: str
    unit: str
    about: str
    derivatives: int


@dataclass(frozen=True, kw_only=True)
class QuantitiesListed:
    """All quantities that can be plotted."""

    quantities: tuple[QuantityListed, ...]


@dataclass(frozen=True, kw_only=True)
class Exported:
    """A file for the visitor; ``content`` is in base64."""

    name: str
    media_type: str
    content: str
    notices: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SimulationEvent:
    """What happens in a row of a simulation, at a time [s]."""

    row: int
    t: float
    text: str


@dataclass(frozen=True, kw_only=True)
class FormOffered:
    """A form of the page that mends something: ``start`` of a simulation, ``masses``, ``motor``,
    ``stops``, ``input``, ``text`` of the file; and the label of a button that leads to it.
    """

    form: str
    label: str


@dataclass(frozen=True, kw_only=True)
class SimulationFound:
    """A simulation: how it ended, its events, and its page.

    ``complete``: it reached the last time. ``forms``: where to mend what ended or refused it, which
    then has no ``page``.
    """

    message: str
    complete: bool
    rows: int
    certified: int
    energy: str
    events: tuple[SimulationEvent, ...]
    forms: tuple[FormOffered, ...]
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class Working:
    """The finished fraction of an answer that takes long, 0 to 1."""

    fraction: float


# ----------------------------------------------------------------------
# Events for the page: one frozen dataclass per event, ``kind`` is its name in snake case.
#
# Numbers are in the file's units; missing values are ``None``, never NaN.


@dataclass(frozen=True, kw_only=True)
class PaletteShown:
    """All kinds of parts that can be added, in the order of the tables of a file, and the forms of
    loads that are no parts.
    """

    parts: tuple[PalettePart, ...]
    forms: tuple[PaletteForm, ...]


@dataclass(frozen=True, kw_only=True)
class SketchShown:
    """The drawing of the points as sketched, or assembled at the start."""

    page: PageData


@dataclass(frozen=True, kw_only=True)
class MotionFound:
    """The whole cycle.

    ``live``: computed from the previous cycle during a drag, without proofs. ``missing``,
    ``certified``: numbers of rows. ``page``: all drawn rows with their numbers, with equations only
    if not ``live``; ``None`` if there is nothing to draw.
    """

    live: bool
    rows: int
    missing: int
    certified: int
    limits: tuple[LimitFound, ...]
    message: str
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class PositionFound:
    """One position, or the reason why there is none."""

    status: str
    message: str
    input: dict[str, float]
    unknowns: dict[str, float | None]
    links: dict[str, float | None]
    sliders: dict[str, float | None]
    outputs: dict[str, float | None]
    points: dict[str, Point]
    residual: float | None
    iterations: int
    condition: float | None
    certified: bool
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class OpenEnd:
    """An end of a link that does not reach its joint."""

    link: str
    point: str
    joint: Point
    end: Point


@dataclass(frozen=True, kw_only=True)
class CannotClose:
    """No position at these input values: the position nearest to closure, and its gap [length].

    ``elsewhere``: input values of the table at which it closes, if any were found.
    """

    message: str
    input: dict[str, float]
    gap: float
    gaps: dict[str, Point]
    unknowns: dict[str, float]
    points: dict[str, Point]
    open_ends: tuple[OpenEnd, ...]
    remedies: dict[str, float]
    elsewhere: dict[str, float]
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class Way:
    """One configuration: its name, unknowns and picture."""

    name: str
    unknowns: dict[str, float]
    points: dict[str, Point]


@dataclass(frozen=True, kw_only=True)
class ConfigurationsFound:
    """All assembly configurations, and whether the list is complete."""

    input: dict[str, float]
    ways: tuple[Way, ...]
    completeness: str


@dataclass(frozen=True, kw_only=True)
class NewtonIterate:
    """One iterate on one block of equations; see
    :class:`linkwork.core.results.position.Iterate`.
    """

    equations: tuple[str, ...]
    k: int
    unknowns: dict[str, float | None]
    residuals: tuple[float | None, ...]
    norm: float | None
    jacobian: tuple[tuple[float | None, ...], ...]
    step: float | None
    points: dict[str, Point]
    open_ends: tuple[OpenEnd, ...]


@dataclass(frozen=True, kw_only=True)
class NewtonShown:
    """Newton-Raphson from a guess: every iterate, the final status, and the kind of failure.

    ``guess``: the guess, after dragging; ``guessed``: points that can be dragged.
    ``trouble``: SINGULAR_DERIVATIVE, INFLECTION,
    ANOTHER_ROOT, LOCAL_EXTREMUM, or "".
    """

    guess: dict[str, float]
    guessed: tuple[str, ...]
    iterates: tuple[NewtonIterate, ...]
    status: str
    trouble: str
    message: str
    input: dict[str, float]
    unknowns: dict[str, float | None]
    points: dict[str, Point]


@dataclass(frozen=True, kw_only=True)
class PointMoved:
    """The dimensions that followed a moved point, and those that stayed."""

    point: str
    followed: tuple[str, ...]
    stayed: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class ProblemsFound:
    """Problems of a change or of the file on disk; the display does not change."""

    where: str
    problems: tuple[ProblemShown, ...]


@dataclass(frozen=True, kw_only=True)
class Refused:
    """A rejected request: problem, place and remedy."""

    message: str


@dataclass(frozen=True, kw_only=True)
class LinkMade:
    """The file as a link.

    ``embed``: HTML for another page; ``qr``: the QR code as SVG. Both are empty without the address
    of an app; without a QR code, ``note`` says why.
    """

    link: str
    embed: str
    qr: str
    note: str


@dataclass(frozen=True, kw_only=True)
class FileChanged:
    """Another program changed the file: ``reloaded``, unless there are ``unsaved`` changes."""

    message: str
    reloaded: bool
    unsaved: bool
    missing: bool


@dataclass(frozen=True, kw_only=True)
class FileOpened:
    """A file of the visitor was opened; of another program with its ``format`` and the numbers of
    what was carried over.

    ``renamed``: old and new names; ``left_out``: what was not carried over, with its place.
    """

    source: str
    format: str
    carried: dict[str, int]
    renamed: dict[str, str]
    left_out: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class StartOffered:
    """No file was named: the page offers the library and a blank sheet."""


@dataclass(frozen=True, kw_only=True)
class Saved:
    """The file was saved."""

    file: str


Event = (
    PaletteShown
    | FileState
    | SketchShown
    | MotionFound
    | PositionFound
    | CannotClose
    | ConfigurationsFound
    | CircuitsFound
    | QuantitiesListed
    | Exported
    | SimulationFound
    | Working
    | NewtonShown
    | PointMoved
    | ProblemsFound
    | Refused
    | LinkMade
    | FileChanged
    | FileOpened
    | Saved
    | StartOffered
    | TaskState
    | TaskSolved
    | TaskUnsolved
    | DesignFound
    | DesignOpened
    | DesignsSuggested
    | CognatesFound
)

EVENTS: tuple[type, ...] = Event.__args__
