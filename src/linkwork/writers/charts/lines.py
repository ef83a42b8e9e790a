"""Rows of a motion as lines: their gaps, ranges and whole turns, and which lines overlap."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from linkwork.circuits.results import Circuits
from linkwork.core.drawing.pose import printed_name
from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.writers.charts.axes import ChartAxes, round_ticks
from linkwork.writers.charts.chart import Chart, Column, Panel, usual_columns, with_unit

# ----------------------------------------------------------------------
# Lines are broken at missing positions, gaps and jumps of angles.


_DEAD = LimitKind.DEAD_POINT.word
_FURTHER = 1.5  # steps of the table: rows further apart are not neighbours
#: Limits at which rates have no value.
SINGULAR = (_DEAD, LimitKind.CHANGE_POINT.word, LimitKind.UNKNOWN.word)


def breaks(motion: Motion, lead: Array, *columns: Column) -> BoolArray:
    """Whether the line between neighbouring rows is interrupted, shape (N - 1,).

    It is between rows on different branches, between rows whose inputs differ by more than the
    table's step, and between two dead points without a row between them. An angle jumps if its
    change differs by more than half a turn from that predicted by its derivative.

    Parameters
    ----------
    lead : array (N,)
        The leading input, in file units.
    """
    branch = np.array(motion.branch)
    dead = np.array(motion.limit) == _DEAD
    broken: BoolArray = (branch[1:] != branch[:-1]) | (dead[1:] & dead[:-1])
    steps = np.abs(np.diff(lead[motion.asked]))
    if len(steps):
        broken |= np.abs(np.diff(lead)) > _FURTHER * steps.max()
    for column in columns:
        if column.turn and column.slope is not None:
            broken |= _jumps(column, column.slope, np.diff(lead))
    return broken


def _jumps(column: Column, slope: Array, dx: Array) -> BoolArray:
    dy = np.diff(column.values)
    # the first finite one of both ends; none at a dead point
    ahead, behind = slope[:-1], slope[1:]
    steady = np.where(np.isfinite(ahead), ahead, behind)
    expected = np.where(np.isfinite(steady), steady, 0.0) * dx
    half = 0.5 * column.turn
    jumps: BoolArray = (np.abs(dy) > half) & (np.abs(dy - expected) > half)
    return jumps


def broken(values: Array, where: BoolArray) -> Array:
    """Values (N,) with NaN inserted between the rows marked in ``where`` (N - 1,)."""
    return np.insert(values, np.flatnonzero(where) + 1, np.nan)


def limits_on(motion: Motion, column: Column) -> dict[str, BoolArray]:
    """Rows of the dead points, change points and extremes of a column, by their kind."""
    limits: dict[str, BoolArray] = {}
    for kind in dict.fromkeys(motion.limit):
        word, _, of = kind.partition(" of ")
        if kind and (not of or of == column.name):
            rows = np.array(motion.limit) == kind
            limits[word] = rows | limits.get(word, np.zeros_like(rows))
    return limits


# ----------------------------------------------------------------------
# Ranges of curves: rounding errors are not magnified, and unbounded curves leave their panel.


_LEVEL = 1e-9  # of its size: maximum variation of a constant quantity
_LEVEL_ROOM = 0.1  # of its size: range shown above and below a constant
_TAIL = 10.0  # percent of the input's range, excluded at either end of the values
_BEYOND = 4.0  # beyond this multiple of its usual range a curve runs to infinity


def level_ends(values: Array, size: float) -> tuple[float, float] | None:
    """The range around a quantity that is constant up to rounding; ``None`` if it varies.

    Parameters
    ----------
    values : array
        May include NaN.
    size : float
        The typical size of the quantity; rounding is a small fraction of it.
    """
    least, most = float(np.nanmin(values)), float(np.nanmax(values))
    size = max(size, abs(least), abs(most))
    if most - least > _LEVEL * size:
        return None
    middle = 0.5 * (least + most) if abs(least + most) > _LEVEL * size else 0.0
    room = _LEVEL_ROOM * (abs(middle) or size)
    return middle - room, middle + room


def bounded_ends(lines: Sequence[tuple[Array, Array]]) -> tuple[float, float] | None:
    """Twice the range of unbounded lines (x, y) over most of the input; ``None`` if all is near."""
    y = np.concatenate([0.5 * (y[1:] + y[:-1]) for _, y in lines])
    share = np.concatenate([np.abs(np.diff(x)) for x, _ in lines])
    there = np.isfinite(y + share) & (share > 0.0)
    if not there.any():
        return None
    ends = np.percentile(
        y[there], (_TAIL, 100.0 - _TAIL), weights=share[there], method="inverted_cdf"
    )
    low, high = ends.tolist()
    if high <= low or np.ptp(y[there]) <= 2.0 * _BEYOND * (high - low):
        return None
    return 1.5 * low - 0.5 * high, 1.5 * high - 0.5 * low


# ----------------------------------------------------------------------
# Lines of angles over one turn, repeated at whole turns: the axes cut them.


_ROUNDING = 1e-9  # in turns: tolerance of whole turns
_MARGIN = 0.02  # in turns, shown beyond the turn
_ORIGINS = (0.0, -0.25, -0.5, -0.75)  # in turns: possible starts of the turn shown


@dataclass(frozen=True, kw_only=True)
class Window:
    """The turn that is shown of a coordinate that is an angle.

    Parameters
    ----------
    turn : float
        A full turn; 0 for a coordinate that is not an angle, of which everything is shown.
    low : float
        Start of the turn.
    whole : bool
        Whether lines need the whole turn; then exactly one turn is shown.
    """

    turn: float = 0.0
    low: float = 0.0
    whole: bool = False

    @classmethod
    def around(cls, lines: Sequence[Array], turn: float) -> Window:
        """The turn that cuts the fewest lines."""
        if not turn:
            return cls()
        pieces = [y[part] for y in lines for part in finite_parts(y)]
        spans = [(piece.min() / turn, piece.max() / turn) for piece in pieces]
        cuts, _, back = min((*_cuts(spans, low), -low) for low in _ORIGINS)
        whole = cuts > 0 or any(b - a > 1.0 - _ROUNDING for a, b in spans)
        return cls(turn=turn, low=-back * turn, whole=whole)

    @property
    def ends(self) -> tuple[float, float]:
        """The ends of the axis that shows the whole turn."""
        return self.low - _MARGIN * self.turn, self.low + (1.0 + _MARGIN) * self.turn

    def shifts(self, values: Array) -> list[float]:
        """The whole turns less which a line is seen in this turn."""
        if not self.turn or not np.isfinite(values).any():
            return [0.0]
        least, most = (float(end) - self.low for end in (np.nanmin(values), np.nanmax(values)))
        if not self.whole:
            return [self.turn * math.floor(least / self.turn + _ROUNDING)]
        first = math.floor(least / self.turn + _ROUNDING)
        last = math.ceil(most / self.turn - _ROUNDING) - 1
        return [self.turn * k for k in range(first, max(first, last) + 1)]


def _cuts(spans: Sequence[tuple[float, float]], low: float) -> tuple[int, int]:
    """The numbers of cuts of ranges [turns] at whole turns from ``low``, and of ends there."""
    cuts = ends = 0
    for a, b in spans:
        first, last = math.floor(a - low + _ROUNDING), math.ceil(b - low - _ROUNDING)
        cuts += max(last - first - 1, 0)
        ends += sum(abs(end - low - round(end - low)) < _ROUNDING for end in (a, b))
    return cuts, ends


def finite_parts(values: Array) -> list[slice]:
    """The pieces of a line between NaN values."""
    return list(np.ma.clump_unmasked(np.ma.masked_invalid(values)))  # type: ignore[no-untyped-call]


def repeated(
    x: Array, y: Array, across: Window, along: Window, rows: BoolArray | slice = slice(None)
) -> tuple[Array, Array]:
    """Rows of a line (x, y) at all whole turns at which it is seen, with gaps between them."""
    copies = [
        np.array([np.append(x[rows] - dx, np.nan), np.append(y[rows] - dy, np.nan)])
        for dx in across.shifts(x)
        for dy in along.shifts(y)
    ]
    both = np.concatenate(copies, axis=1)
    return both[0, :-1], both[1, :-1]


# ----------------------------------------------------------------------
# Overlapping curves: the lower one is drawn wider, so that both are visible.


_NEAR = 0.004  # of the panel's sides: points in neighbouring squares of this size cover each other
_HIDDEN = 0.4  # a curve with a larger covered share is drawn wider
_COLUMN = 1_000_000  # number of a square: a million for each column


def covering(lines: Sequence[tuple[Array, Array]], groups: Sequence[int]) -> list[int]:
    """The number of later groups of lines (x, y) that cover much of each line."""
    every = np.concatenate([np.stack(line) for line in lines], axis=1)
    if not np.isfinite(every).all(axis=0).any():
        return [0] * len(lines)
    low, high = np.nanmin(every, axis=1), np.nanmax(every, axis=1)
    size = np.where(high > low, high - low, 1.0)
    squares = [_squares((np.stack(line, axis=1) - low) / size / _NEAR) for line in lines]
    around = np.add.outer((-_COLUMN, 0, _COLUMN), (-1, 0, 1)).ravel()
    near = [np.unique(np.add.outer(cells, around)) for cells in squares]
    return [
        len(
            {
                group
                for group, other in zip(groups, near, strict=True)
                if group > this and len(cells) and np.isin(cells, other).mean() > _HIDDEN
            }
        )
        for cells, this in zip(squares, groups, strict=True)
    ]


def _squares(points: Array) -> IndexArray:
    """The unit squares that a line (K, 2) passes."""
    sides = np.abs(np.diff(points, axis=0))
    pieces = max(1, math.ceil(float(np.nanmax(sides, initial=0.0))))
    rows = np.linspace(0, len(points) - 1, (len(points) - 1) * pieces + 1)
    column, row = (np.floor(np.interp(rows, np.arange(len(points)), one)) for one in points.T)
    numbers: IndexArray = np.unique((_COLUMN * column + row)[np.isfinite(column + row)].astype(int))
    return numbers


# ----------------------------------------------------------------------
# Charts of all circuits as closed curves over the input, and of a front of designs.


#: Maximum number of quantities shown by default.
MOST_PANELS = 6
_USUAL_COLUMNS, _MOST_COLUMNS = 3, 4


def circuit_chart(circuits: Circuits, names: Sequence[str] = ()) -> Chart:
    """Every circuit as a closed curve of each quantity over the input, limits marked.

    An angle input is shown over one turn. Other angles are shown over the turn that
    cuts the fewest curves, or over less if that shows all.

    Parameters
    ----------
    names : sequence of str
        The quantities to show; by default the first :data:`MOST_PANELS` of :func:`usual_columns`.

    Raises
    ------
    InputError
        If there is no circuit, or nothing to show by default.
    UnknownNameError
        If a quantity does not exist.
    """
    shown = _quantities(circuits, names)
    count = len(circuits)
    return Chart(
        title=circuits.mechanism,
        caption=f"{count} circuit{'' if count == 1 else 's'}",
        panels=tuple(_panel(circuits, name) for name in shown),
    )


def branch_chart(circuits: Circuits, names: Sequence[str] = ()) -> Chart:
    """One panel for every branch, with all other branches behind it in grey.

    Parameters
    ----------
    names : sequence of str
        The quantities to show, one below the other; by default the first of those of
        :func:`circuit_chart`.

    Raises
    ------
    InputError
        If there is no circuit, or too many branches for several quantities.
    UnknownNameError
        If a quantity does not exist.
    """
    every = circuit_chart(circuits, names)
    shown = _quantities(circuits, names)[: None if names else 1]
    branches = [branch for circuit in circuits for branch in circuit.branches]
    count = len(branches)
    if len(shown) > 1 and count > _MOST_COLUMNS:
        raise InputError(
            f'"{circuits.mechanism}" has {count} branches, too many for several '
            f"quantities: name one of {', '.join(names)}"
        )
    columns = count if len(shown) > 1 else _columns(count)
    titles = ["\n".join(filter(None, (b.name, b.configuration))) for b in branches]
    return replace(
        every,
        caption=f"{count} branch{'' if count == 1 else 'es'} in {every.caption}",
        panels=tuple(
            _panel(circuits, name, k, "" if row and count == columns else title)
            for row, name in enumerate(shown)
            for k, title in enumerate(titles)
        ),
        columns=columns,
    )


def _quantities(circuits: Circuits, names: Sequence[str]) -> tuple[str, ...]:
    """The quantities to show, without duplicates."""
    if not len(circuits):
        raise InputError(f'"{circuits.mechanism}" has no circuit to draw: {circuits.message}')
    motion = circuits[0].motion
    named = dict.fromkeys(motion.series(name).quantity.name for name in names)
    return tuple(named) or usual_columns(motion)[:MOST_PANELS]


def _columns(count: int) -> int:
    """The number of panels in a row."""
    if count == 4:
        return 2
    return max(1, min(count, _USUAL_COLUMNS if count <= _USUAL_COLUMNS**2 else _MOST_COLUMNS))


def _panel(circuits: Circuits, name: str, front: int | None = None, title: str = "") -> Panel:
    """One quantity along all circuits, with branch number ``front`` on top."""
    motion = circuits[0].motion
    quantity = motion.series(name).quantity
    label = with_unit(printed_name(name), motion.units.of(quantity.kind))
    return Panel(label=label, draw=partial(_draw, circuits, name, label, front, title))


def _draw(
    circuits: Circuits, name: str, label: str, front: int | None, title: str, axes: ChartAxes
) -> None:
    ax, motion = axes.ax, circuits[0].motion
    unit = motion.units.angle
    turning = circuits.input_unit == unit.value
    turn = unit.turn if motion.series(name).quantity.kind is Kind.ANGLE else 0.0
    tones: list[int] = []
    lines: list[tuple[Array, Array]] = []
    limits: list[Array] = []
    for tone, circuit in enumerate(circuits, start=1):
        for branch in circuit.branches:
            rows = np.array(circuit.motion.branch) == branch.name
            tones.append(tone)
            lines.append((circuit.motion[circuits.input][rows], circuit.motion[name][rows]))
            limits.append(np.array(circuit.motion.limit)[rows])
    across = Window(turn=unit.turn if turning else 0.0, whole=True)
    along = Window.around([y for _, y in lines], turn)
    shown = [repeated(x, y, across, along) for x, y in lines]
    below = covering(shown, tones) if front is None else [0] * len(lines)
    for k, (tone, line) in enumerate(zip(tones, shown, strict=True)):
        behind = front not in (None, k)
        of = circuits[tone - 1].name
        axes.curve(*line, of, tone, legend=front is None, below=below[k], quiet=behind)
        for kind in dict.fromkeys(filter(None, () if behind else limits[k].tolist())):
            axes.marks(*repeated(*lines[k], across, along, limits[k] == kind), kind, tone)
    axes.labels(with_unit(printed_name(circuits.input), circuits.input_unit), label, title)
    values = np.concatenate([y for _, y in shown])
    ends = along.ends if along.whole else level_ends(values, turn or 1.0)
    if not turn and any(c.end is CircuitEnd.RUNS_TO_INFINITY for c in circuits):
        ends = bounded_ends(shown)
    if ends is not None:
        ax.set_ylim(*ends)
    if turn:
        round_ticks(ax.yaxis, unit)
    if turning:
        axes.show_input(0.0, unit.turn)
        round_ticks(ax.xaxis, unit)


# ----------------------------------------------------------------------
# The chart of a front: how the other goals get worse as the first gets better.


_TEXTS = 24  # numbers of designs that are written
_UP_RIGHT = 0.7 + 0.7j


def front_chart(title: str, goals: Mapping[str, Sequence[float]], numbers: Sequence[int]) -> Chart:
    """The misses of the first goal against those of each other one.

    Parameters
    ----------
    title : str
    goals : Mapping[str, sequence of number]
        The misses of every goal, in the order of the designs.
    numbers : sequence of int
        The numbers of the designs.
    """
    count = len(numbers)
    first, *others = goals
    return Chart(
        title=title,
        caption=f"front of {count} design{'' if count == 1 else 's'}: "
        "no other one is better in every goal",
        panels=tuple(
            Panel(label=f"miss of {other}", draw=partial(_draw_front, goals, first, other, numbers))
            for other in others
        ),
    )


def _draw_front(
    goals: Mapping[str, Sequence[float]],
    first: str,
    other: str,
    numbers: Sequence[int],
    axes: ChartAxes,
) -> None:
    """Dots; of two goals with stairs through the designs, each the best one until the next."""
    places = np.array(goals[first]) + 1j * np.array(goals[other])
    if len(goals) == 2:
        colour = axes.theme.rule
        axes.ax.step(places.real, places.imag, where="post", color=colour, linewidth=1.0)
    axes.stations(places, 1)
    every = -(-len(numbers) // _TEXTS)
    for place, number in list(zip(places.tolist(), numbers, strict=True))[::every]:
        axes.station_text(str(number), place, _UP_RIGHT)
    axes.labels(f"miss of {first}", f"miss of {other}")
