"""The data for the front end: plain dataclasses from which its TypeScript types are generated.

Every class here becomes an interface of ``frontend/src/page_data.ts`` (``scripts/frontend types``).
Angles of frames are in radians; all other numbers are in the unit of their column.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "AnswerData",
    "Column",
    "Equation",
    "ForceData",
    "FrameData",
    "LimitMark",
    "MotionData",
    "MotionNumber",
    "PackedColumn",
    "PageData",
    "Part",
    "PointData",
    "QuestionData",
    "ReactionData",
    "RoleStyle",
    "RowEvidence",
    "SliderData",
    "SolverData",
    "StepRules",
    "ThemeData",
    "TrackData",
    "TurnData",
    "TurnSource",
    "VectorData",
]


@dataclass(frozen=True, kw_only=True)
class PackedColumn:
    """Numbers of the solved rows: multiples of ``step``, differenced ``order`` times, as zigzag
    integers of seven bits per byte, in base64. Order -1: plain little-endian floats of eight bytes;
    -2: of four. ``gaps`` are indices of rows without a number, such as derivatives at dead points;
    plain floats have NaN there.
    """

    step: float
    order: int
    content: str
    gaps: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Column:
    """A quantity over the rows: its printed name and unit; ``group`` is its list: ``input``,
    ``unknown``, ``output``, ``derived``, or ``asked`` for any other quantity or rate. ``band``:
    lowest and highest recommended value.
    """

    name: str
    shown: str
    unit: str
    group: str
    values: PackedColumn
    first: PackedColumn | None
    first_unit: str
    band: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class MotionNumber:
    """One number of the whole motion, such as ``stroke(s16)``; ``None`` if undefined."""

    name: str
    shown: str
    unit: str
    value: float | None


@dataclass(frozen=True, kw_only=True)
class PointData:
    """A point: its coordinates and their first and second derivatives with respect to the input."""

    name: str
    shown: str
    drawn: bool
    x: PackedColumn
    y: PackedColumn
    dx: PackedColumn
    dy: PackedColumn
    ddx: PackedColumn
    ddy: PackedColumn


@dataclass(frozen=True, kw_only=True)
class TurnData:
    """The angle [rad] of a link or line with which shapes rotate."""

    name: str
    angle: PackedColumn


@dataclass(frozen=True, kw_only=True)
class FrameData:
    """The frame of a shape: indices of a point and of a turn; -1 for none."""

    origin: int
    turn: int


@dataclass(frozen=True, kw_only=True)
class Part:
    """A shape: ``line``, ``area``, ``disc``, ``strokes`` or ``text``.

    ``points`` are x, y, x, y, … in its frame (``frame`` ≥ 0) or in the plane (-1); of a disc its
    centre, of a text its anchor. A deforming shape (``frame`` -2) has packed x and y of each
    corner, and ``shown`` (1 or 0) in every row. Lengths are in the mechanism's unit.
    """

    kind: str
    role: str
    of: str
    tone: int
    frame: int
    points: tuple[float, ...]
    radius: float
    head: tuple[float, ...]
    text: str
    offset: tuple[float, ...]
    height: float
    align: int
    course: tuple[PackedColumn, ...]
    shown: PackedColumn | None


@dataclass(frozen=True, kw_only=True)
class VectorData:
    """A vector of a loop equation with its name, between two points given by index. If it is not
    between points, these are -1, and ``course`` has x and y of its tail and tip.
    """

    name: str
    start: int
    end: int
    tone: int
    course: tuple[PackedColumn, ...]


@dataclass(frozen=True, kw_only=True)
class ForceData:
    """A force on a point, given by index."""

    point: int
    x: float
    y: float


@dataclass(frozen=True, kw_only=True)
class ReactionData:
    """A force on a point, given by index, of the link ``by`` on the link ``on``, "" for loads;
    ``x`` and ``y`` name the columns of its components.
    """

    point: int
    on: str
    by: str
    x: str
    y: str


@dataclass(frozen=True, kw_only=True)
class LimitMark:
    """A row at a dead point or change point."""

    row: int
    text: str


@dataclass(frozen=True, kw_only=True)
class RowEvidence:
    """The evidence of every row; ``found`` is 1 or 0, statuses are indices into ``texts``."""

    found: PackedColumn
    status: PackedColumn
    status_texts: tuple[str, ...]  # noqa: V107
    certification: PackedColumn
    certification_texts: tuple[str, ...]
    certified: PackedColumn
    residual_log10: PackedColumn
    radius_log10: PackedColumn
    iterations: PackedColumn
    branch: PackedColumn
    branch_names: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class QuestionData:
    """A question: the unit, tolerance and whole turn (0: none) of its answer, and what is hidden
    until it is answered.
    """

    text: str
    unit: str
    tolerance: float
    turn: float
    hide: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class AnswerData:
    """The right answers to a question, any one of which will do; none may be right, or none may be
    ``known``.
    """

    known: bool
    values: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class MotionData:
    """One displayed circuit or branch.

    ``order`` are the solved rows in the order of the motion; ``closed``: the first follows the
    last. ``speed`` is that of the leading input, 0 if it has none; ``backwards``: its arrow points
    towards smaller values. ``view`` is the extent of its drawing, as that of the page.
    """

    name: str
    summary: str
    rows: int
    order: PackedColumn
    closed: bool
    speed: float
    backwards: bool
    columns: tuple[Column, ...]
    points: tuple[PointData, ...]
    turns: tuple[TurnData, ...]
    frames: tuple[FrameData, ...]
    parts: tuple[Part, ...]
    vectors: tuple[VectorData, ...]
    driven: tuple[str, ...]
    evidence: RowEvidence
    limits: tuple[LimitMark, ...]
    numbers: tuple[MotionNumber, ...] = ()
    answers: tuple[AnswerData, ...] = ()
    view: tuple[float, ...] = ()
    reactions: tuple[ReactionData, ...] = ()


@dataclass(frozen=True, kw_only=True)
class RoleStyle:
    """The style of a role: colours (``tone``: that of the link; "" for none), widths in strokes."""

    role: str
    layer: int
    line: str
    width: float
    fill: str
    opacity: float
    dashes: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class ThemeData:
    """Colours of a page, light or dark."""

    background: str
    ink: str
    faint: str
    driven: str
    tones: tuple[str, ...]
    styles: tuple[RoleStyle, ...]


@dataclass(frozen=True, kw_only=True)
class Equation:
    """A loop equation: its label and its MathML."""

    label: str
    mathml: str


@dataclass(frozen=True, kw_only=True)
class PageData:
    """The complete data of a page. ``view`` is left, bottom, right, top of the drawing."""

    format: int
    title: str
    length_unit: str
    derivative_unit: str
    input_unit: str
    view: tuple[float, ...]
    stroke: float
    pin: float
    text: float
    motions: tuple[MotionData, ...]
    light: ThemeData
    dark: ThemeData
    forces: tuple[ForceData, ...]
    force_unit: str
    equations: tuple[Equation, ...]
    questions: tuple[QuestionData, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SliderData:
    """A number that can be changed in the page; ``unit`` is empty where it is unknown.

    ``hidden``: parts that are not drawn while it differs from ``value``.
    """

    name: str
    unit: str
    value: float
    hidden: tuple[int, ...]


@dataclass(frozen=True, kw_only=True)
class StepRules:
    """Constants of ``marching`` and of the programs; see there."""

    nodes: int
    growth: float
    half: float
    nearly_full: float
    far: float
    same: float
    newton_steps: int
    start_steps: int


@dataclass(frozen=True, kw_only=True)
class TurnSource:
    """Where the angle of a turn comes from: the number of a computed angle, or -1 and the points
    of a line, given by index.
    """

    angle: int
    start: int
    end: int


@dataclass(frozen=True, kw_only=True)
class TrackData:
    """A track: the point guided by it and its frame, given by index (-1: the ground), and its
    direction there. The ends of the point's path count as two more points, after the named ones.
    """

    point: int
    frame: int
    x: float
    y: float


@dataclass(frozen=True, kw_only=True)
class SolverData:
    """What a page needs to solve, besides its printed functions.

    ``unknowns`` to ``options``: layout of the functions' arrays, see ``batch.printed_solver``.
    ``steps``: first, largest and smallest step; ``turn``: a whole turn of the input, 0 where it
    does not turn freely; ``apart``: rounding of an input a turn away; ``path``: values of the
    table's line of inputs, ``rates`` and ``origins`` of all inputs on it, and their ``inputs`` in
    the unit of the file, row by row. ``columns``: names of computed columns. ``frames`` replace
    those of the motion; ``anchors``: points that the corners of each part move with, -1 for none.
    """

    title: str
    sliders: tuple[SliderData, ...]
    unknowns: int
    size: int
    blocks: int
    coefficients: int
    spread: tuple[int, ...]
    state: int
    design: int
    drawn: int
    options: tuple[float, ...]
    rules: StepRules
    steps: tuple[float, ...]
    turn: float
    apart: float
    path: PackedColumn
    origins: tuple[float, ...]
    rates: tuple[float, ...]
    inputs: tuple[PackedColumn, ...]
    input_unit: float
    columns: tuple[str, ...]
    turns: tuple[TurnSource, ...]
    tracks: tuple[TrackData, ...]
    frames: tuple[FrameData, ...]
    anchors: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, kw_only=True)
class SolvingPage:
    """The data of a page's solver, and its printed functions as a script."""

    data: SolverData
    script: str
