"""The data for the front end: plain dataclasses from which its TypeScript types are generated.

Every class here becomes an interface of ``frontend/src/page_data.ts`` (``scripts/frontend types``).
Angles of frames are in radians; all other numbers are in the unit of their column.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
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
    "RoleStyle",
    "RowEvidence",
    "ThemeData",
    "TurnData",
    "VectorData",
]


@dataclass(frozen=True, kw_only=True)
class PackedColumn:
    """Numbers of the found rows: multiples of ``step``, differenced ``order`` times, as zigzag
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
class LimitMark:
    """A row at a dead point or change point."""

    row: int
    text: str


@dataclass(frozen=True, kw_only=True)
class RowEvidence:
    """The evidence of every row; ``found`` is 1 or 0, statuses are indices into ``texts``."""

    found: PackedColumn
    status: PackedColumn
    status_texts: tuple[str, ...]
    certification: PackedColumn
    certification_texts: tuple[str, ...]
    certified: PackedColumn
    residual_log10: PackedColumn
    radius_log10: PackedColumn
    iterations: PackedColumn
    branch: PackedColumn
    branch_names: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class MotionData:
    """One displayed circuit or branch.

    ``order`` are the found rows in the order of the motion; ``closed``: the first follows the last.
    ``speed`` is that of the leading input, 0 if it has none; ``backwards``: its arrow points
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
    view: tuple[float, ...] = ()


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
    version: str
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
