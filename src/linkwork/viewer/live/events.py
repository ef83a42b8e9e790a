"""Events for the page: one frozen dataclass per event, ``kind`` is its name in snake case.

Numbers are in the file's units; what does not exist is ``None``, never NaN.
"""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.viewer.page_data import PageData

__all__ = [
    "EVENTS",
    "CannotClose",
    "ChangeableNumber",
    "ConfigurationsFound",
    "Drive",
    "DrivenInput",
    "Event",
    "FileChanged",
    "FileState",
    "LimitFound",
    "Link",
    "MotionFound",
    "NewtonIterate",
    "NewtonShown",
    "OpenEnd",
    "PaletteField",
    "PalettePart",
    "PaletteShown",
    "PointMoved",
    "PositionFound",
    "ProblemShown",
    "ProblemsFound",
    "Refused",
    "Saved",
    "Unknown",
    "Way",
]

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class ChangeableNumber:
    """A number that can be changed by its name.

    ``table``: dimensions, lengths, angles, sliders, guess, points, or measured. ``formula`` is
    what stands in the file where that is no plain number: such a number follows others.
    """

    name: str
    value: float
    unit: str
    table: str
    formula: str = ""


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """An unknown of the equations with its guess."""

    name: str
    unit: str
    guess: float


@dataclass(frozen=True, kw_only=True)
class DrivenInput:
    """An input: what it drives, and its range as it stands in the file."""

    name: str
    unit: str
    drive: str
    start: float
    stop: float
    rows: int
    speed: str = ""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """What could be an input: link, slider, cylinder or variable, and its name."""

    kind: str
    name: str


@dataclass(frozen=True, kw_only=True)
class Link:
    """A link and the points it carries."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class PaletteField:
    """One thing to fill in: a key of a table, what it is for, and how it is entered.

    ``entry``: ``text``, ``number``, ``flag``, ``choice`` of some ``words``; the name of a
    ``point``, ``link`` or ``slider``; several ``points`` or ``links``; ``numbers`` in one line;
    ``lines`` of numbers, or of words that are ``named`` in this order.
    """

    name: str
    doc: str
    entry: str
    required: bool
    words: tuple[str, ...] = ()
    named: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class PalettePart:
    """A kind of part: the table of the file where it belongs."""

    table: str
    title: str
    doc: str
    fields: tuple[PaletteField, ...]


@dataclass(frozen=True, kw_only=True)
class PaletteShown:
    """Every kind of part that can be added, in the order of the tables of a file."""

    parts: tuple[PalettePart, ...]


@dataclass(frozen=True, kw_only=True)
class FileState:
    """The file as it is being edited.

    ``parts``: names of sliders, gears, cams, …; of a weld its two links. ``drives``: what could be
    an input. ``traceable``: points whose path can be shown.
    """

    file: str
    title: str
    text: str
    form: str
    unsaved: bool
    undo: str
    redo: str
    length_unit: str
    angle_unit: str
    configuration: str
    numbers: tuple[ChangeableNumber, ...]
    unknowns: tuple[Unknown, ...]
    inputs: tuple[DrivenInput, ...]
    points: dict[str, Point]
    links: tuple[Link, ...]
    parts: tuple[str, ...]
    drives: tuple[Drive, ...]
    traceable: tuple[str, ...]
    traced: tuple[str, ...]
    equations: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class LimitFound:
    """Where the motion ends: a dead point or change point of the input."""

    what: str
    input: float
    located: bool
    sentence: str


@dataclass(frozen=True, kw_only=True)
class MotionFound:
    """The whole cycle.

    ``live``: found from the cycle before while something is dragged, nothing proved. ``missing``,
    ``certified``: how many of the rows. ``page``: all rows with their numbers, as they are drawn,
    its equations only where the cycle is not ``live``; ``None`` where there is nothing to draw.
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
    """One position, or why there is none."""

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


@dataclass(frozen=True, kw_only=True)
class OpenEnd:
    """An end of a link that does not reach its joint."""

    link: str
    point: str
    joint: Point
    end: Point


@dataclass(frozen=True, kw_only=True)
class CannotClose:
    """No position at these input values: as near as it gets, and how much is missing [length].

    ``elsewhere``: input values of the table at which it closes, if some were looked for and found.
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


@dataclass(frozen=True, kw_only=True)
class Way:
    """One configuration: its name, unknowns and picture."""

    name: str
    unknowns: dict[str, float]
    points: dict[str, Point]


@dataclass(frozen=True, kw_only=True)
class ConfigurationsFound:
    """Every way to put the mechanism together, and whether these are all."""

    input: dict[str, float]
    ways: tuple[Way, ...]
    completeness: str


@dataclass(frozen=True, kw_only=True)
class NewtonIterate:
    """One iterate on one block of equations; see :class:`linkwork.results.iterates.Iterate`."""

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
    """Newton-Raphson from a guess: every iterate, where it ended, and which trouble it met.

    ``guess``: what was asked for, as it was dragged; ``guessed``: points that can be dragged.
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
    """What followed a point that was moved, and what stayed although it is between its points."""

    point: str
    followed: tuple[str, ...]
    stayed: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class ProblemShown:
    """One thing that is wrong: its line in the text, its key and what to do."""

    line: int | None
    key: str
    message: str


@dataclass(frozen=True, kw_only=True)
class ProblemsFound:
    """A change, or the file on disk, that is no mechanism; what was shown before stays."""

    where: str
    problems: tuple[ProblemShown, ...]


@dataclass(frozen=True, kw_only=True)
class Refused:
    """A request that could not be met: what, where and what to do."""

    message: str


@dataclass(frozen=True, kw_only=True)
class FileChanged:
    """Another program changed the file: ``reloaded``, or to be decided because of ``unsaved``."""

    message: str
    reloaded: bool
    unsaved: bool
    missing: bool


@dataclass(frozen=True, kw_only=True)
class Saved:
    """The file is written."""

    file: str


Event = (
    PaletteShown
    | FileState
    | MotionFound
    | PositionFound
    | CannotClose
    | ConfigurationsFound
    | NewtonShown
    | PointMoved
    | ProblemsFound
    | Refused
    | FileChanged
    | Saved
)

EVENTS: tuple[type, ...] = Event.__args__
