"""Events of the page of a task: its text, its designs, and the motion of one."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.app.live.file_state import Point, ProblemShown


@dataclass(frozen=True, kw_only=True)
class PositionShown:
    """A position of a task, in file units."""

    x: float
    y: float
    angle: float | None
    input: float | None
    tolerance: float
    angle_tolerance: float


@dataclass(frozen=True, kw_only=True)
class TaskState:
    """The edited task: its text, and what of it is shown on the canvas.

    ``entries``: all other entries, by their keys joined by dots. ``positions_from_file``: points
    of a curve's file, which cannot be moved here.
    """

    file: str
    title: str
    text: str
    unsaved: bool
    undo: str
    redo: str
    task: str
    length_unit: str
    angle_unit: str
    positions: tuple[PositionShown, ...]
    positions_from_file: bool  # noqa: V107
    fixed_pivots: tuple[Point, ...]
    moving_pivots: tuple[Point, ...]
    region: tuple[Point, ...]
    obstacles: tuple[tuple[float, float, float], ...]
    entries: dict[str, float | str]
    problems: tuple[ProblemShown, ...]


@dataclass(frozen=True, kw_only=True)
class DesignShown:
    """A design in the list: numbers in file units, and why it is refused or doubtful.

    ``index``: its place in the whole list, or below -1 for a suggested one, with its ``origin``
    ("atlas", "improved", "as given"; otherwise ""); ``transmission``: the smallest over the driven
    range.
    """

    index: int
    origin: str
    number: int
    mechanism: str
    drive: str
    sound: bool
    delivered: bool
    transmission: float | None
    size: float | None
    error: float | None
    score: float | None
    reason: str
    remark: str  # noqa: V107


@dataclass(frozen=True, kw_only=True)
class SkeletonShown:
    """What is drawn between the points of a mechanism, which are given by index.

    ``blocks``: a sliding point and two points of its line; ``discs``: centre and radius [length].
    """

    bars: tuple[tuple[int, ...], ...]
    driven: tuple[bool, ...]
    fixed: tuple[int, ...]
    pins: tuple[int, ...]
    blocks: tuple[tuple[int, int, int], ...]
    discs: tuple[tuple[int, float], ...]


@dataclass(frozen=True, kw_only=True)
class DesignFound:
    """A design at the positions and in between: x, y of A, B and P, one row after another.

    ``fixed``: of A and of B the fixed pivot, or two points of the line on which it slides.
    ``lines``: of couplers that slide through A0 or B0, the directions of their lines from that of
    AB [rad]. ``at``: a row for each position. ``rows``: the driven range, empty for a refused
    design. ``marks``: the row of each position in it. ``curve``: the points of P on the branch of
    the first position.

    Mechanisms of other kinds have a ``skeleton``: their rows are x, y of all its points, which are
    not told ``at`` the positions.
    """

    design: DesignShown
    skeleton: SkeletonShown | None
    fixed: tuple[tuple[Point, ...], ...]
    guided: str
    lines: tuple[float | None, float | None]
    at: tuple[tuple[float, ...], ...]
    rows: tuple[tuple[float, ...], ...]
    marks: tuple[float, ...]
    curve: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, kw_only=True)
class DesignsSuggested:
    """Designs that the search has not found, as the present task judges them: of the atlas,
    improved ones, and the mechanism that a task improves. ``note``: how they were compared.
    """

    designs: tuple[DesignShown, ...]
    note: str


@dataclass(frozen=True, kw_only=True)
class DyadShown:
    """A dyad through all poses: its kind, and its fixed pivot or a point of its line."""

    kind: str
    fixed: Point
    proved: bool


@dataclass(frozen=True, kw_only=True)
class TaskSolved:
    """The designs for the task, sound ones first.

    ``live``: during a drag, with the chosen design only. ``defects``: numbers of designs by defect.
    ``most_restrictive``: the requirement that rejects the most designs; ``costs``: their number.
    ``advice``: what to change where no requirement is to blame. ``left_out``: designs that are not
    in the list.
    ``centre_curve``: polylines x, y, x, y, … of possible fixed pivots.
    """

    live: bool
    solutions: str
    linkages: int
    count: int
    sound: int
    delivered: int
    completeness: str
    message: str
    interrupted: bool
    error_unit: str
    defects: dict[str, float]
    most_restrictive: str  # noqa: V107  # read by the page
    costs: int
    advice: str
    designs: tuple[DesignShown, ...]
    left_out: int  # noqa: V107
    dyads: tuple[DyadShown, ...]
    centre_curve: tuple[tuple[float, ...], ...]
    chosen: DesignFound | None


@dataclass(frozen=True, kw_only=True)
class TaskUnsolved:
    """Why there are no designs yet: the task is incomplete, or the search was ended.

    ``slow``: it is solved when the drag ends.
    """

    live: bool
    message: str
    problems: tuple[ProblemShown, ...]
    slow: bool
    ended: bool


@dataclass(frozen=True, kw_only=True)
class CognateShown:
    """A four-bar with the same coupler curve: its points at the first position.

    ``index``: its place in the list, with its verdict and driven link, or -1 if it is not there.
    """

    points: dict[str, Point]
    drive: str
    index: int
    sound: bool
    reason: str


@dataclass(frozen=True, kw_only=True)
class CognatesFound:
    """The cognates of a design, itself first, and their common curve."""

    design: int
    cognates: tuple[CognateShown, ...]
    curve: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, kw_only=True)
class DesignOpened:
    """The mechanism is a design of a task, to which one can go back."""

    task: str
