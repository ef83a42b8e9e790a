"""Requests that change many entries of the file at once: units, names, copies."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.app.live.task_requests import TaskRequest


@dataclass(frozen=True, kw_only=True)
class ChangeUnits:
    """Another unit of lengths or angles; empty: as before.

    ``convert``: every number is converted, so that the mechanism stays as large as it is; otherwise
    the numbers stay.
    """

    convert: bool
    length: str = ""
    angle: str = ""


@dataclass(frozen=True, kw_only=True)
class Rename:
    """Another name for a point, link or part, in all of the file. ``of``: point, link or part."""

    of: str
    name: str
    new: str


@dataclass(frozen=True, kw_only=True)
class Duplicate:
    """Copy points and links, with the parts between them.

    By the names of points and links: ``names`` of the copies, the same for a point that is shared,
    and ``places`` of new points [length]. ``mirrored``: the copy is a mirror image.
    """

    names: dict[str, str]
    places: dict[str, tuple[float, float]]
    mirrored: bool = False


@dataclass(frozen=True, kw_only=True)
class Mirror:
    """Move points to mirrored places [length]; the dimensions between them stay."""

    places: dict[str, tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class AddOutput:
    """Add a named formula of results to the file."""

    name: str
    formula: str


# ----------------------------------------------------------------------
# Requests of the page about the file: another one, its history, saving, and its link.


@dataclass(frozen=True, kw_only=True)
class Undo:
    """Undo the last change."""


@dataclass(frozen=True, kw_only=True)
class Redo:
    """Redo the last undone change."""


@dataclass(frozen=True, kw_only=True)
class OpenExample:
    """Open a mechanism of the library as a new file, or a blank sheet with an empty name.

    ``discard``: even if changes of the present file are not saved.
    """

    name: str
    discard: bool = False


@dataclass(frozen=True, kw_only=True)
class OpenFile:
    """Open a file of the visitor as a new one: of Linkwork, or of another program, which is
    imported.

    ``content``: its bytes in base64; ``discard``: even if changes of the present file are not
    saved.
    """

    name: str
    content: str
    discard: bool = False


@dataclass(frozen=True, kw_only=True)
class Save:
    """Write the file; with ``overwrite`` even if another program has changed it."""

    overwrite: bool = False


@dataclass(frozen=True, kw_only=True)
class Reload:
    """Read the file again; unsaved changes stay in the history."""


@dataclass(frozen=True, kw_only=True)
class MakeLink:
    """Pack the text of the file into a link to the address of an app, or into a fragment only."""

    app: str = ""


# ----------------------------------------------------------------------
# Requests about motion: a simulation, its end, the quantities that are shown.


@dataclass(frozen=True, kw_only=True)
class ShowQuantities:
    """The quantities, rates and numbers of the motion that the page needs besides the usual ones;
    replaces those of the request before. ``simulated``: of the simulation.
    """

    names: tuple[str, ...]
    simulated: bool = False


@dataclass(frozen=True, kw_only=True)
class Simulate:
    """Compute the motion in time, from 0 s to ``until``.

    ``at``: input values at the start, in file units, by default those of the guess; ``start_speed``
    may have a unit, "60 rad/s"; ``start_speeds``: of several inputs by name; ``change_points``:
    stop or straight; ``step``: between rows [s].
    """

    until: float | str
    start_speed: float | str = 0
    start_speeds: dict[str, float | str] | None = None
    at: dict[str, float | str] | None = None
    change_points: str = "stop"
    step: float | str | None = None


@dataclass(frozen=True, kw_only=True)
class Cancel:
    """End the computation under way."""


# ----------------------------------------------------------------------
# Requests that add, change and remove parts.


#: User input of a field: one entry or several; a row of numbers or of a table is one line,
#: "10, 20".
Typed = str | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class AddPart:
    """Add an entry to a table of parts: sliders, gears, cams, …

    ``typed``: user input by key: text, a number, a formula, true or false; a list of names; a list
    of lines, each with the numbers or words of one row.
    """

    table: str
    typed: dict[str, str | tuple[str, ...]]


@dataclass(frozen=True, kw_only=True)
class Picked:
    """A place that was picked in the drawing [length], and the point or link there.

    ``size``: the radius that was drawn from it.
    """

    x: float
    y: float
    point: str = ""
    link: str = ""
    size: float = 0.0


@dataclass(frozen=True, kw_only=True)
class DrawPart:
    """Add a part from picks in the drawing, with the points and links that are missing.

    ``span``: half the length of a line that is made for it [length].
    """

    table: str
    picks: tuple[Picked, ...]
    span: float


@dataclass(frozen=True, kw_only=True)
class SetPart:
    """Change an entry of a part: user input as of :class:`AddPart`, "" removes the entry."""

    name: str
    key: str
    typed: str | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class RemovePart:
    """Remove a slider, slot, cylinder, gear, belt, rack, rolling wheel, cam or curve; a weld by the
    names of its two links.

    ``whole``: with the wheels, blocks and fixed points that serve nothing else.
    """

    name: str
    whole: bool = False


@dataclass(frozen=True, kw_only=True)
class SetMass:
    """Set the mass of a link; without ``mass`` it has none.

    ``x``, ``y``: its centre in the frame of the link; without them a link of two points is a
    uniform rod. ``inertia``: about the centre.
    """

    link: str
    mass: float | str | None = None
    x: float | str | None = None
    y: float | str | None = None
    inertia: float | str | None = None


@dataclass(frozen=True, kw_only=True)
class SetEntry:
    """Set or remove an entry that is no part, with all its keys: ``gravity``; ``friction`` ``of`` a
    joint; the ``motor`` and flywheel of an input; ``stops``, by number, or "" for new ones.

    ``typed``: user input as of :class:`AddPart`.
    """

    table: str
    of: str
    typed: dict[str, str | tuple[str, ...]]
    remove: bool = False


# ----------------------------------------------------------------------
# Requests of the page: one frozen dataclass per request.
#
# The name of a class in snake case is the ``kind`` of its message. ``live`` marks intermediate
# changes of a drag: they are displayed, and become one step of the history with the last change;
# without ``rates`` their answers lack rates of points.


@dataclass(frozen=True, kw_only=True)
class SetNumber:
    """Set a number of the mechanism to a value or formula.

    ``name``: as in a family: ``a2``, ``O2 A``, ``s16.offset``; a measured length becomes a
    dimension. A value may have a unit: "3 in". With ``any_formula`` a number replaces a formula.
    """

    name: str
    value: float | str
    any_formula: bool = False
    live: bool = False
    rates: bool = True


@dataclass(frozen=True, kw_only=True)
class MovePoint:
    """Move a point of the sketch [length].

    Measured lengths change with it, given ones stay unless ``lengths_follow``, formulas always.
    """

    point: str
    x: float
    y: float
    lengths_follow: bool = False
    live: bool = False


@dataclass(frozen=True, kw_only=True)
class MovePoints:
    """Move points of the drawing to other places [length]; lengths between them and others follow.

    ``keep``: lengths that stay: a single point then moves along the circles that they leave to it.
    """

    places: dict[str, tuple[float, float]]
    keep: tuple[str, ...] = ()
    live: bool = False
    rates: bool = True


@dataclass(frozen=True, kw_only=True)
class SetInput:
    """Set the driven quantity and its range; omitted fields do not change.

    ``drive``: link, joint, slider, cylinder or variable; ``speed`` may have a unit: "300 rpm".
    """

    number: int = 0
    drive: str | None = None
    name: str | None = None
    start: float | str | None = None
    stop: float | str | None = None
    step: float | str | None = None
    speed: float | str | None = None


@dataclass(frozen=True, kw_only=True)
class AddPoint:
    """Add a point to the sketch and to links; coordinates may have a unit: "3 in"."""

    name: str
    x: float | str
    y: float | str
    links: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class RemovePoint:
    """Remove a point, also from links, with the lengths and angles that use it."""

    name: str


@dataclass(frozen=True, kw_only=True)
class AddLink:
    """Add a rigid link through existing points."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class RemoveLink:
    """Remove a link, with the lengths and angles of this link only."""

    name: str


@dataclass(frozen=True, kw_only=True)
class ReverseLink:
    """Exchange the first two points of a link: its angle then has the opposite direction."""

    name: str


@dataclass(frozen=True, kw_only=True)
class SetGround:
    """Fix points to the ground, or release them."""

    points: tuple[str, ...]
    on: bool = True


@dataclass(frozen=True, kw_only=True)
class AddJoint:
    """Add a point to a link: a pin joint with the other links at the point."""

    link: str
    point: str


@dataclass(frozen=True, kw_only=True)
class RemoveJoint:
    """Remove a point from a link."""

    link: str
    point: str


@dataclass(frozen=True, kw_only=True)
class TracePoint:
    """Show or hide the path of a point."""

    point: str
    on: bool


@dataclass(frozen=True, kw_only=True)
class ChooseConfiguration:
    """Set the configuration or branch to start from; an empty name selects that of the guess."""

    name: str


#: A change of the file.
Edit = (
    SetNumber
    | MovePoint
    | MovePoints
    | SetInput
    | SetMass
    | SetEntry
    | AddPoint
    | RemovePoint
    | AddLink
    | RemoveLink
    | ReverseLink
    | SetGround
    | AddJoint
    | RemoveJoint
    | AddPart
    | DrawPart
    | SetPart
    | RemovePart
    | TracePoint
    | ChooseConfiguration
    | AddOutput
    | ChangeUnits
    | Rename
    | Duplicate
    | Mirror
)


@dataclass(frozen=True, kw_only=True)
class Together:
    """Apply several changes together: only their common result must be a valid mechanism."""

    edits: tuple[Edit, ...]


@dataclass(frozen=True, kw_only=True)
class AssembleAt:
    """Move the points of the sketch to their positions at input values that close the mechanism."""

    at: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class SetText:
    """Replace the whole text of the file."""

    text: str


@dataclass(frozen=True, kw_only=True)
class SetSheet:
    """Set the width of the visible part of the plane [length], by which symbols are sized: of a
    flat view, the width that its height allows.

    ``edited``: the mechanism is changed in the drawing, which is then sent at its start.
    """

    width: float
    edited: bool = False


@dataclass(frozen=True, kw_only=True)
class SolveAt:
    """Solve one position at input values in file units, by default at the input of the guess."""

    at: dict[str, float]
    configuration: str | None = None


@dataclass(frozen=True, kw_only=True)
class ListConfigurations:
    """List all configurations at input values, by default at the input of the guess."""

    at: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class ListCircuits:
    """List all circuits of the mechanism, with their motions."""


@dataclass(frozen=True, kw_only=True)
class ListQuantities:
    """List all quantities that can be plotted; with ``simulated`` those of the simulation."""

    simulated: bool = False


@dataclass(frozen=True, kw_only=True)
class Export:
    """A file for the visitor: ``toml``, ``svg``, ``csv``, ``xlsx``, ``html``, ``gif``, ``webp`` or
    ``mp4``. A picture shows a row of the motion, by default the first with a position.
    ``simulated``: the table of the simulation, a ``csv``.
    """

    format: str
    row: int | None = None
    dark: bool = False
    simulated: bool = False


@dataclass(frozen=True, kw_only=True)
class NewtonSteps:
    """Newton-Raphson from a guess of some or all unknowns, in file units, step by step.

    ``full_steps``: textbook method without a limit on the rotation of a step. ``pull``: a point of
    the guess dragged before: one unknown changes to move it as near as possible to ``x``, ``y``.
    """

    guess: dict[str, float]
    at: dict[str, float]
    full_steps: bool = False
    max_steps: int = 50
    pull: str = ""
    x: float = 0.0
    y: float = 0.0


#: Asks about the mechanism and its motion, and changes nothing.
Question = ListCircuits | ListQuantities | Export | MakeLink

Request = (
    Edit
    | Together
    | AssembleAt
    | SetText
    | SetSheet
    | SolveAt
    | ShowQuantities
    | Simulate
    | Cancel
    | ListConfigurations
    | NewtonSteps
    | Question
    | OpenExample
    | OpenFile
    | Undo
    | Redo
    | Save
    | Reload
    | TaskRequest
)

EDITS: tuple[type, ...] = Edit.__args__
REQUESTS: tuple[type, ...] = Request.__args__
