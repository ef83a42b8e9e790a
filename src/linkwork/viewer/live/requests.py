"""Requests of the page: one frozen dataclass per request.

The name of a class in snake case is the ``kind`` of its message. ``live`` marks changes on the way
(a slider being dragged): they are shown, and become one step of the history when the last change
comes without it.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "EDITS",
    "REQUESTS",
    "AddJoint",
    "AddLink",
    "AddPart",
    "AddPoint",
    "AssembleAt",
    "ChooseConfiguration",
    "Edit",
    "ListConfigurations",
    "MovePoint",
    "NewtonSteps",
    "Redo",
    "Reload",
    "RemoveJoint",
    "RemoveLink",
    "RemovePart",
    "RemovePoint",
    "Request",
    "Save",
    "SetInput",
    "SetNumber",
    "SetText",
    "SolveAt",
    "Together",
    "TracePoint",
    "Undo",
]


@dataclass(frozen=True, kw_only=True)
class SetNumber:
    """Another value, or formula, for a number of the mechanism.

    ``name``: as in a family: ``a2``, ``O2 A``, ``B A P``, ``s16.offset``, ``O4.x``; a measured
    length becomes a given one. A number takes the place of a formula only with ``any_formula``.
    """

    name: str
    value: float | str
    any_formula: bool = False
    live: bool = False


@dataclass(frozen=True, kw_only=True)
class MovePoint:
    """A point of the sketch goes elsewhere [length].

    Measured lengths change with it. Those that are given stay as they are unless
    ``lengths_follow``; formulas always stay.
    """

    point: str
    x: float
    y: float
    lengths_follow: bool = False
    live: bool = False


@dataclass(frozen=True, kw_only=True)
class SetInput:
    """What is driven and over which values; what is left out stays.

    ``drive`` is link, joint, slider, cylinder or variable, ``name`` which of them; ``speed`` may
    carry a unit, "300 rpm".
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
    """A point of the sketch, and the links that carry it."""

    name: str
    x: float
    y: float
    links: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class RemovePoint:
    """A point goes, with its place in links, and the lengths and angles that name it."""

    name: str


@dataclass(frozen=True, kw_only=True)
class AddLink:
    """A rigid link through points that exist."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class RemoveLink:
    """A link goes, with the lengths and angles that only it had."""

    name: str


@dataclass(frozen=True, kw_only=True)
class AddJoint:
    """A link carries one more point: a pin joint with the links that carry it already."""

    link: str
    point: str


@dataclass(frozen=True, kw_only=True)
class RemoveJoint:
    """A link lets go of a point."""

    link: str
    point: str


@dataclass(frozen=True, kw_only=True)
class AddPart:
    """An entry of a table of parts: sliders, gears, cams, …

    ``typed``: by key, as people type it: text, a number, a formula, true or false; a list of names;
    a list of lines, each with the numbers or words of one row.
    """

    table: str
    typed: dict[str, str | tuple[str, ...]]


@dataclass(frozen=True, kw_only=True)
class RemovePart:
    """A slider, slot, cylinder, gear, belt, rack, rolling wheel, cam or curve goes; a weld by the
    names of its two links.
    """

    name: str


@dataclass(frozen=True, kw_only=True)
class TracePoint:
    """The path of a point is shown, or not."""

    point: str
    on: bool


@dataclass(frozen=True, kw_only=True)
class ChooseConfiguration:
    """The configuration or branch to start from; an empty name: the one at the guess."""

    name: str


#: A change of the file.
Edit = (
    SetNumber
    | MovePoint
    | SetInput
    | AddPoint
    | RemovePoint
    | AddLink
    | RemoveLink
    | AddJoint
    | RemoveJoint
    | AddPart
    | RemovePart
    | TracePoint
    | ChooseConfiguration
)


@dataclass(frozen=True, kw_only=True)
class Together:
    """Several changes applied together: only the result of all of them must be a mechanism."""

    edits: tuple[Edit, ...]


@dataclass(frozen=True, kw_only=True)
class AssembleAt:
    """The points of the sketch go where they are at input values at which the mechanism closes."""

    at: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class SetText:
    """The whole file, typed by hand."""

    text: str


@dataclass(frozen=True, kw_only=True)
class SolveAt:
    """One position at input values in file units; without values, at the input of the guess."""

    at: dict[str, float]
    configuration: str | None = None


@dataclass(frozen=True, kw_only=True)
class ListConfigurations:
    """All configurations at input values; without values, at the input of the guess."""

    at: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class NewtonSteps:
    """Newton-Raphson from a guess of some or all unknowns, in file units, step by step.

    ``full_steps``: the textbook's bare method, whose steps may turn a link as far as they like.
    ``pull``: a point by which the guess is dragged before: one unknown changes so that it comes as
    near as it can to ``x``, ``y``.
    """

    guess: dict[str, float]
    at: dict[str, float]
    full_steps: bool = False
    max_steps: int = 50
    pull: str = ""
    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Undo:
    """Undo the last change."""


@dataclass(frozen=True, kw_only=True)
class Redo:
    """Redo the last undone change."""


@dataclass(frozen=True, kw_only=True)
class Save:
    """Write the file; ``overwrite`` also if another program has changed it meanwhile."""

    overwrite: bool = False


@dataclass(frozen=True, kw_only=True)
class Reload:
    """Read the file again; changes that were not saved stay in the history."""


Request = (
    Edit
    | Together
    | AssembleAt
    | SetText
    | SolveAt
    | ListConfigurations
    | NewtonSteps
    | Undo
    | Redo
    | Save
    | Reload
)

EDITS: tuple[type, ...] = Edit.__args__
REQUESTS: tuple[type, ...] = Request.__args__
